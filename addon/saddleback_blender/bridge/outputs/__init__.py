"""Writes into Blender: attributes, curves, meshes and instances."""
