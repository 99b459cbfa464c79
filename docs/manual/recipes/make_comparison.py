# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of the page "how it compares": cells along the surface and through the air, of the same sites.

.cache/bpy-4.5/bin/python docs/manual/recipes/make_comparison.py [hand] [tail]
"""

from __future__ import annotations

import sys

import bpy
import make_recipes as recipes  # first: it knows where the other modules are
import models
import numpy as np
import palette
import studio
import subject
from mathutils import kdtree

FOLDER = recipes.HERE / "images" / "comparison"
HUES = ["#3c6e8f", "#8fb8a8", "#e3d5ac", "#5b8c6a", "#c4a36a", "#a9c4d4", "#6f6a8a", "#d9c9c0", "#42606a", "#b7b58a"]
JUMPED = "#e0301e"
COLOR = "shown"


def pieces(labels: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """For each vertex the least number of a vertex in its piece: joined by edges (E, 2) within one label."""
    inside = ends[labels[ends[:, 0]] == labels[ends[:, 1]]]
    found = np.arange(len(labels))
    while True:
        before = found.copy()
        least = np.minimum(found[inside[:, 0]], found[inside[:, 1]])
        np.minimum.at(found, inside[:, 0], least)
        np.minimum.at(found, inside[:, 1], least)
        found = found[found]
        if np.array_equal(found, before):
            return found


def jumped(labels: np.ndarray, ends: np.ndarray, homes: np.ndarray) -> np.ndarray:
    """Tells of each vertex whether its piece of the cell is another than that of the vertex at the site (`homes`)."""
    piece = pieces(labels, ends)
    return piece != piece[homes][labels]


def paint(item: bpy.types.Object, labels: np.ndarray, strange: np.ndarray) -> None:
    """A color for each cell, another one for what has jumped."""
    colors = palette.linear(HUES)[labels % len(HUES)]
    colors[strange] = palette.linear([JUMPED])[0]
    layer = item.data.color_attributes.get(COLOR) or item.data.color_attributes.new(COLOR, "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", np.column_stack([colors, np.ones(len(colors))]).astype(np.float32).ravel())


def material() -> bpy.types.Material:
    """Shows the colors."""
    made = studio.principled("Cells", (0.5, 0.5, 0.5), Roughness=0.6)
    node = made.node_tree.nodes.new("ShaderNodeAttribute")
    node.attribute_name = COLOR
    made.node_tree.links.new(node.outputs["Color"], made.node_tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


def areas(item: bpy.types.Object) -> np.ndarray:
    """The area around each vertex."""
    places, corners = subject.positions(item), subject.triangles(item)
    a, b, c = (places[corners[:, i]] for i in range(3))
    face = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6
    return np.bincount(corners.ravel(), np.repeat(face, 3), len(places))


def compare(name: str, item: bpy.types.Object, count: int, view: tuple[float, float, float], box: tuple) -> None:
    """Two pictures of one model, and what was measured; `box` is the part of it that is seen."""
    bpy.ops.saddleback.tessellate(count=count, seed=3, iterations=10, make_edges=False, make_centers=True)
    places = subject.positions(item)
    centers = subject.positions(next(child for child in item.children if child.get("saddleback_role") == "centers"))
    tree, surface = kdtree.KDTree(len(centers)), kdtree.KDTree(len(places))
    for points, into in ((centers, tree), (places, surface)):
        for i, point in enumerate(points):
            into.insert(point, i)
        into.balance()
    homes = np.array([surface.find(center)[1] for center in centers])
    ends = np.array([edge.vertices[:] for edge in item.data.edges])
    along = np.array([value.value for value in item.data.attributes["saddleback_cell"].data])
    through = np.array([tree.find(place)[1] for place in places])
    for child in item.children:
        child.hide_render = True
    item.data.materials.append(material())
    low, high = np.array(box)
    seen = places[np.all((places >= low) & (places <= high), axis=1)]
    recipes.stage(seen, view)
    area = areas(item)
    for kind, labels in (("along", along), ("through", through)):
        strange = jumped(labels, ends, homes)
        share = 100 * area[strange].sum() / area.sum()
        print(
            f"-- {name} {kind}: {len(np.unique(labels[strange]))} of {count} cells in pieces, {share:.1f} % of the area"
        )
        paint(item, labels, strange)
        recipes.render(FOLDER / f"{name}-{kind}.jpg", recipes.STEP_SIZE, recipes.STEP_SAMPLES)


def main() -> None:
    """The hand, and the chameleon's tail."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    fingers = ((-9.0, -9.0, -0.15), (9.0, 9.0, 9.0))
    tail = ((-9.0, -9.0, -9.0), (-0.6, 9.0, 9.0))
    for name, model, count, view, box in (
        ("hand", lambda: models.hand(0.018), 60, (0.3, -1.0, 0.15), fingers),
        ("tail", recipes.chameleon, 120, (0.3, -1.0, 0.1), tail),
    ):
        if sys.argv[1:] and name not in sys.argv[1:]:
            continue
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        bpy.ops.preferences.addon_enable(module="saddleback_blender")
        compare(name, model(), count, view, box)


if __name__ == "__main__":
    main()
