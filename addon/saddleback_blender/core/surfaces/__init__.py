# SPDX-License-Identifier: GPL-3.0-or-later
"""Places on surfaces and what they carry: frames, normals, walks, grids."""
