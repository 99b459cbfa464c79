# SPDX-License-Identifier: MIT
"""
Even cells that follow a density
================================

A centroidal Voronoi tessellation of a hilly square, four times as dense at its right as at its left, and the triangles
between its sites.
"""

import matplotlib.pyplot as plt
import numpy as np

import saddleback as sb

x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, 60), np.linspace(0, 1, 60)))
corner = (np.arange(59)[:, None] * 60 + np.arange(59)).ravel()
triangles = np.concatenate(
    [np.column_stack([corner, corner + 1, corner + 61]), np.column_stack([corner, corner + 61, corner + 60])]
)
mesh = sb.Mesh(np.column_stack([x, y, 0.15 * np.sin(6 * x) * np.cos(6 * y)]), triangles)
graph = sb.SaddleVertexGraph(mesh)
result = sb.centroidal_voronoi(graph, count=150, density=1 + 3 * x, seed=1)
cells = result.cells
print(
    f"{result.iterations} iterations; {len(cells.areas)} cells, areas sum to {cells.areas.sum() / mesh.area:.9f} of all"
)

# %%
# The boundaries of cells are polylines on the surface, seen here from above; `dual` has the triangles.
dual = cells.dual()
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 4.5))
for edge in cells.edges:
    left.plot(edge.points[:, 0], edge.points[:, 1], color="black", linewidth=0.8)
left.plot(*result.sites.positions(mesh)[:, :2].T, "o", color="tab:red", markersize=2)
right.triplot(dual.vertices[:, 0], dual.vertices[:, 1], dual.triangles, color="tab:blue", linewidth=0.8)
for axes in (left, right):
    axes.set_aspect("equal")
    axes.set_axis_off()
