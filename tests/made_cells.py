# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's mesh of cells from a split mesh that has no surface behind it: raised along its own normals."""

from __future__ import annotations

import numpy as np

from saddleback_blender.core import runs
from saddleback_blender.core.results import CellMesh
from saddleback_blender.core.solids.cell_mesh import CellShape, cell_pieces, raise_cells
from saddleback_blender.core.solids.cell_solid import vertex_normals


def build_cell_mesh(
    vertices: np.ndarray, triangles: np.ndarray, triangle_cell: np.ndarray, shape: CellShape
) -> CellMesh:
    """Vertices (V, 3), triangles (T, 3) and the cell of each (T,)."""
    normals = vertex_normals(vertices, triangles)
    return raise_cells(cell_pieces(vertices, triangles, triangle_cell, normals, shape), shape, runs.new_progress())
