"""Everything that is decided without Blender: numpy and saddleback only, never bpy."""
