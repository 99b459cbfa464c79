"""The only border between Blender's data and numpy arrays."""
