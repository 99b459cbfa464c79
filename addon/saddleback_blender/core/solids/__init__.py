"""Cells, ribs and plates as meshes with thickness: cut, raised, closed."""
