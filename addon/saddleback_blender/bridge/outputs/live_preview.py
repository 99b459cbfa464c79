# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws what a run shows while it goes on: lines over the 3D views, which are nothing in the file.

An object would be in undo steps, files and renders, and Undo would leave others pointing at it.
"""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ... import compat
from ...core.solids.edge_network import EdgeNetwork

COLOR = (1.0, 0.62, 0.1, 1.0)
WIDTH = 2.5  # pixels
LIFT = 4.0  # hairs that lines are drawn nearer to the eye, so that the surface does not hide them

shown: list[LivePreview] = []  # those that draw


class LivePreview:
    """Lines as seen from `place`. `remove` must be called."""

    def __init__(self, place: Matrix, hair: float) -> None:
        self.ends: NDArray[np.float32] = np.empty((0, 3), np.float32)  # two for each piece
        self._place, self._lift = place, LIFT * hair
        self._batch: Any = None
        self._handler = (
            None
            if bpy.app.background  # which has no graphics
            else bpy.types.SpaceView3D.draw_handler_add(self._draw, (), "WINDOW", "POST_VIEW")
        )
        shown.append(self)

    def show(self, lines: EdgeNetwork) -> None:
        """Shows these lines instead of those before."""
        segments, _ = lines.segments()
        self.ends = lines.vertices[segments.ravel()].astype(np.float32)
        self._batch = None
        _redraw()

    def remove(self) -> None:
        """Takes the lines away. Once."""
        shown.remove(self)
        if self._handler is not None:
            bpy.types.SpaceView3D.draw_handler_remove(self._handler, "WINDOW")
        _redraw()

    def _draw(self) -> None:
        import gpu
        from gpu_extras.batch import batch_for_shader

        view = bpy.context.region_data
        if not len(self.ends) or view is None:
            return
        shader = compat.line_shader()
        if self._batch is None:
            self._batch = batch_for_shader(shader, "LINES", {"pos": self.ends})
        to_eye = view.view_matrix.to_3x3().inverted_safe().col[2].normalized() * self._lift
        gpu.state.depth_test_set("LESS_EQUAL")
        gpu.state.blend_set("ALPHA")
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(Matrix.Translation(to_eye) @ self._place)
            shader.bind()
            shader.uniform_float("color", COLOR)
            shader.uniform_float("lineWidth", WIDTH)
            shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
            self._batch.draw(shader)
        gpu.state.depth_test_set("NONE")
        gpu.state.blend_set("NONE")


def _redraw() -> None:
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()
