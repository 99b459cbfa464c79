# SPDX-License-Identifier: MIT
"""
Distances and a shortest path
=============================

A graph is built once and then asked: lines of equal distance from a point of a torus, and the shortest path to
another one.
"""

import matplotlib.pyplot as plt
import numpy as np

import saddleback as sb

# A torus of 100 x 50 vertices, with bumps.
around, across = (part.ravel() for part in np.mgrid[0:100, 0:50])
u, v = 2 * np.pi * around / 100, 2 * np.pi * across / 50
tube = 0.4 + 0.05 * np.sin(5 * u) * np.cos(3 * v)
ring = 1 + tube * np.cos(v)
vertices = np.column_stack([ring * np.cos(u), ring * np.sin(u), tube * np.sin(v)])
right, up = (around + 1) % 100, (across + 1) % 50
corners = [around * 50 + across, right * 50 + across, right * 50 + up, around * 50 + up]
triangles = np.concatenate([np.column_stack(corners)[:, [0, 1, 2]], np.column_stack(corners)[:, [0, 2, 3]]])

mesh = sb.Mesh(vertices, triangles)
graph = sb.SaddleVertexGraph(mesh, accuracy=1e-3)
distance = graph.distances([660])
path = graph.path(660, 3333, shorten=True)
print(f"{path.length:.3f} long; the farthest vertex is {distance.max():.3f} away")

# %%
# Faces are colored by the distance, in bands of 0.2.
figure = plt.figure(figsize=(7, 5))
axes = figure.add_subplot(projection="3d", computed_zorder=False, box_aspect=np.ptp(vertices, axis=0))
surface = axes.plot_trisurf(*vertices.T, triangles=triangles, antialiased=False)
surface.set_array(np.floor(distance[triangles].mean(axis=1) / 0.2))
surface.set_cmap("viridis")
axes.plot(*(1.01 * path.points).T, color="white", linewidth=2, zorder=10)
axes.view_init(55, 40)
axes.set_axis_off()
