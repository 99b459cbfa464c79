# SPDX-License-Identifier: GPL-3.0-or-later
"""The only border between Blender's data and numpy arrays."""
