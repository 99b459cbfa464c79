"""Draws what a run shows while it goes on: lines that no undo step and no file keeps."""

from __future__ import annotations

import bpy
import numpy as np

from ... import compat, nodes
from ...core.solids.edge_network import EdgeNetwork
from .out_collection import level_place, remove_object, to_place

NAME = "Saddleback Live"


class LivePreview:
    """An object of tubes beside the source, which it leaves alone. `remove` must be called."""

    def __init__(self, context: bpy.types.Context, source: bpy.types.Object, radius: float) -> None:
        self._place = level_place(source)
        self._name = self._make(context, radius).name

    def _make(self, context: bpy.types.Context, radius: float) -> bpy.types.Object:
        item = bpy.data.objects.new(NAME, bpy.data.meshes.new(NAME))
        item.matrix_world = self._place
        item.hide_select = item.hide_render = True
        context.scene.collection.objects.link(item)
        material = nodes.edges_material()
        item.data.materials.append(material)
        nodes.set_tubes(item, radius, material)
        return item

    def show(self, lines: EdgeNetwork) -> None:
        """Shows these lines, in the world, instead of those before."""
        item = bpy.data.objects.get(self._name)
        if item is None:  # the user took it away
            return
        mesh = item.data
        mesh.clear_geometry()
        segments, _ = lines.segments()
        mesh.vertices.add(len(lines.vertices))
        mesh.vertices.foreach_set("co", to_place(self._place, lines.vertices).astype(np.float32).ravel())
        mesh.edges.add(len(segments))
        compat.write_numbers(mesh.edges, "vertices", segments)
        mesh.update()

    def remove(self) -> None:
        """Takes the lines away. Once."""
        item = bpy.data.objects.get(self._name)
        if item is not None:
            remove_object(item)
        nodes.remove_unused()
