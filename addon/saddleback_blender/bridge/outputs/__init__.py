"""Into Blender: attributes, curves, meshes and instances."""
