# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that is decided without Blender: numpy and saddleback only, never bpy."""
