"""Densities and directions, from what was painted, drawn or found in images."""
