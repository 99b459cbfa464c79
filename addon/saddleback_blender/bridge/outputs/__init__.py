# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes into Blender: attributes, curves, meshes and instances."""
