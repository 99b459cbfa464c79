# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells, ribs and plates as meshes with thickness: cut, raised, closed."""
