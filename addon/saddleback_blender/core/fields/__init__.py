# SPDX-License-Identifier: GPL-3.0-or-later
"""Densities and directions, from what was painted, drawn or found in images."""
