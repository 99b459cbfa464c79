"""Shapes that are laid on surfaces: templates, presets, copies, their colors and sizes."""
