# SPDX-License-Identifier: MIT
"""
Plane diagrams, weighted ones, and the sweep circle
===================================================

The Voronoi diagram of points, that of disks, whose edges are hyperbolas, and the circle that finds diagrams event by
event: inside of the beach curve nothing changes any more.
"""

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

import saddleback as sb

rng = np.random.default_rng(3)
sites = rng.random((60, 2))
square = [(0, 0), (1, 0), (1, 1), (0, 1)]


def frame(axes: plt.Axes) -> None:
    axes.plot(*sites.T, "o", color="tab:red", markersize=2)
    axes.set(xlim=(0, 1), ylim=(0, 1), aspect="equal")
    axes.set_axis_off()


axes = plt.figure(figsize=(4, 4)).add_subplot()
cells = sb.voronoi_2d(sites).clip(square)
for begin, end in pairwise(cells.loop_offsets):
    axes.fill(*cells.points[begin:end].T, facecolor="none", edgecolor="black", linewidth=0.8)
frame(axes)

# %%
# Disks: the edge between two of them is where both are equally far away.
axes = plt.figure(figsize=(4, 4)).add_subplot()
radii = 0.05 * rng.random(60)
diagram = sb.voronoi_2d(sites, radii)
for edge in range(len(diagram.edges)):
    axes.plot(*diagram.edge_polyline(edge, tolerance=1e-3, extent=3).T, color="black", linewidth=0.8)
for site, radius in zip(sites, radii, strict=True):
    axes.add_patch(plt.Circle(site, radius, color="tab:orange"))
frame(axes)

# %%
# A circle that has grown to a radius of 0.45, the beach curve, and edges as far as they are known.
axes = plt.figure(figsize=(4, 4)).add_subplot()
sweep = sb.SweepCircle(sites, (0.5, 0.5))
sweep.grow(0.45)
axes.add_patch(plt.Circle((0.5, 0.5), 0.45, fill=False, color="tab:green"))
axes.plot(*sweep.beach_curve(720).T, color="tab:blue")
for line in sweep.edge_polylines(1e-3):
    axes.plot(*line.T, color="black", linewidth=0.8)
frame(axes)
