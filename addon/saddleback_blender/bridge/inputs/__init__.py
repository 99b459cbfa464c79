# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads from Blender: meshes, curves, images, groups and empties as arrays."""
