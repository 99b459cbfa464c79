"""Image files as bytes."""
