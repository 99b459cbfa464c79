"""Reads from Blender: meshes, curves, images, groups and empties as arrays."""
