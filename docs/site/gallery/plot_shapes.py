# SPDX-License-Identifier: MIT
"""
Shapes along a field
====================

Leaves follow a field that turns once about one vertex of a torus and back about another; none meets another.
"""

import matplotlib.pyplot as plt
import numpy as np

import saddleback as sb

# A torus of 90 x 45 vertices.
around, across = (part.ravel() for part in np.mgrid[0:90, 0:45])
u, v = 2 * np.pi * around / 90, 2 * np.pi * across / 45
vertices = np.column_stack([(1 + 0.45 * np.cos(v)) * np.cos(u), (1 + 0.45 * np.cos(v)) * np.sin(u), 0.45 * np.sin(v)])
right, up = (around + 1) % 90, (across + 1) % 45
corners = np.column_stack([around * 45 + across, right * 45 + across, right * 45 + up, around * 45 + up])
mesh = sb.Mesh(vertices, np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]))

top, left = int(mesh.vertices[:, 2].argmax()), int(mesh.vertices[:, 0].argmin())
field = sb.direction_field(mesh, 1, {top: 1, left: -1})
result = sb.distribute(mesh, sb.Shape.leaf(), 400, field, size=0.08, seed=2)
print(f"{len(result)} leaves, none meets another: {sb.check_distribution(mesh, result).ok}")

# %%
# `cut` has all outlines as edges of the surface.
cut = result.mapped.cut()
axes = plt.figure(figsize=(7, 5)).add_subplot(projection="3d", box_aspect=np.ptp(vertices, axis=0))
surface = axes.plot_trisurf(*cut.vertices.T, triangles=cut.triangles, antialiased=False)
surface.set_array((cut.triangle_shape >= 0).astype(float))
surface.set_cmap("summer_r")
axes.view_init(60, 40)
axes.set_axis_off()
