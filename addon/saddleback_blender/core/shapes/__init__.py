# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that are laid on surfaces: templates, presets, copies, their colors and sizes."""
