# SPDX-License-Identifier: GPL-3.0-or-later
"""Node groups that work on our attributes without the add-on, kept as assets in a file of the artist's own Blender.

The file is written by the Blender that will read it: one that ships with us would have to suit every version.
"""
