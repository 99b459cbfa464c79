# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances, paths and cells around barriers: seams, sharp edges, selected edges and faces."""

import bmesh
import bpy
import numpy as np
import pytest
from scenes import attribute, fingerprint, grid, positions, select

QUICK = {"iterations": 2, "k": 30}


def wall(item, until=0.3):
    """(edges,) those of the grid at x = 0 with y below `until`: a wall from the border into the middle."""
    places = positions(item.data)
    ends = np.array([edge.vertices for edge in item.data.edges])
    return (np.abs(places[ends][:, :, 0]) < 1e-6).all(axis=1) & (places[ends][:, :, 1] < until).all(axis=1)


def select_edges(item, marked):
    """By BMesh, since Blender 5.0 crashes in edges.foreach_set("select")."""
    mesh = bmesh.new()
    mesh.from_mesh(item.data)
    for edge, is_marked in zip(mesh.edges, marked.tolist(), strict=True):
        edge.select_set(is_marked)
    mesh.to_mesh(item.data)
    mesh.free()


def square(kind):
    """A grid of one unit with a wall, as barriers of that kind; and the settings."""
    item = grid(n=10)
    places = positions(item.data)
    item.data.vertices.foreach_set("co", (places - (*places.mean(axis=0)[:2], 0)).astype(np.float32).ravel())
    marked = wall(item)
    assert 0 < marked.sum() < 10
    if kind in ("SEAMS", "SHARP"):
        item.data.edges.foreach_set("use_seam" if kind == "SEAMS" else "use_edge_sharp", marked)
        return item, {"barriers": kind}
    select(item, [])
    if kind == "FACES":
        bpy.context.tool_settings.mesh_select_mode = (False, False, True)
        middles = np.array([polygon.center for polygon in item.data.polygons])
        marked = (np.abs(middles[:, 0]) < 0.06) & (middles[:, 1] < 0.25)
        item.data.polygons.foreach_set("select", marked)
    else:
        bpy.context.tool_settings.mesh_select_mode = (False, True, False)
        select_edges(item, marked)
    bpy.ops.saddleback.barriers_from_selection()
    assert item.saddleback.barriers_name == "saddleback_barriers"
    return item, {}


def corner(item, x, y):
    return int(np.linalg.norm(positions(item.data)[:, :2] - (x, y), axis=1).argmin())


@pytest.mark.parametrize("kind", ["SEAMS", "SHARP", "EDGES", "FACES"])
def test_distances_lead_around_barriers(kind):
    item, settings = square(kind)
    places = positions(item.data)[:, :2].astype(float)
    low, high = (
        corner(item, places[:, 0].min(), places[:, 1].min()),
        corner(item, places[:, 0].max(), places[:, 1].min()),
    )
    select(item, [low])
    bpy.ops.saddleback.distance(sources="SELECTED", quality="EXACT", **settings)
    found = attribute(item, "saddleback_distance")
    assert found[low] == 0
    assert found[high] > np.linalg.norm(places[high] - places[low]) * 1.1
    if kind != "FACES":
        y = places[np.abs(places[:, 0]) < 1e-6, 1]
        tip = np.array([0.0, y[y < 0.3].max()])
        around = np.linalg.norm(places[low] - tip) + np.linalg.norm(places[high] - tip)
        assert found[high] == pytest.approx(around, rel=1e-6)
        foot = corner(item, 0.0, places[:, 1].min())  # on the wall: the nearer side counts
        assert found[foot] == pytest.approx(np.linalg.norm(places[foot] - places[low]), rel=1e-6)


def test_paths_lead_around_barriers():
    item, settings = square("SEAMS")
    places = positions(item.data)
    low, high = (
        corner(item, places[:, 0].min(), places[:, 1].min()),
        corner(item, places[:, 0].max(), places[:, 1].min()),
    )
    select(item, [low, high])
    bpy.ops.saddleback.path(quality="EXACT", **settings)
    line = next(item for item in bpy.data.objects if item.name.endswith("Paths"))
    straight = np.linalg.norm(places[high] - places[low])
    assert line["saddleback_length"] > 1.1 * straight


def test_cells_do_not_cross_barriers():
    item, _ = square("SEAMS")
    item.data.edges.foreach_set("use_seam", wall(item, until=2.0))  # from border to border
    bpy.ops.saddleback.tessellate(count=12, barriers="SEAMS", make_cells=True, make_edges=True, **QUICK)
    cells, places = attribute(item, "saddleback_cell"), positions(item.data)
    left, right = set(cells[places[:, 0] < -1e-3].tolist()), set(cells[places[:, 0] > 1e-3].tolist())
    assert not left & right and left | right == set(range(12))


def test_a_source_on_a_barrier_reaches_both_sides():
    item, settings = square("SEAMS")
    places = positions(item.data)
    foot = corner(item, 0.0, places[:, 1].min())
    select(item, [foot])
    bpy.ops.saddleback.distance(sources="SELECTED", quality="EXACT", **settings)
    row = np.abs(places[:, 1] - places[foot, 1]) < 1e-6
    np.testing.assert_allclose(
        attribute(item, "saddleback_distance")[row], np.abs(places[row, 0]), rtol=1e-5, atol=1e-6
    )


def test_what_is_enclosed_is_told_as_not_reached():
    item, _ = square("SEAMS")
    item.data.edges.foreach_set("use_seam", wall(item, until=2.0))
    places = positions(item.data)
    select(item, [corner(item, places[:, 0].min(), 0.0)])
    bpy.ops.saddleback.distance(sources="SELECTED", barriers="SEAMS")
    found = attribute(item, "saddleback_distance")
    assert np.isinf(found[places[:, 0] > 1e-3]).all() and np.isfinite(found[places[:, 0] < 1e-3]).all()
    assert f"{int(np.isfinite(found).sum())} vertices reached" in item.saddleback.distance.told
    assert "no way to the other" in item.saddleback.distance.told


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"barriers": "SEAMS"}, "has no edge that is marked as a seam; mark some, or choose other barriers"),
        ({"barriers": "ATTRIBUTE"}, "needs the name of an attribute for barriers; select edges or faces in Edit Mode"),
        ({"barriers": "ATTRIBUTE", "barriers_name": "Way"}, "the attribute 'Way' is none"),
        ({"barriers": "ATTRIBUTE", "barriers_name": "All"}, "the barriers leave no face; choose other barriers"),
        (
            {"barriers": "ATTRIBUTE", "barriers_name": "One"},
            "is a single edge, which parts nothing; mark an edge beside",
        ),
    ],
)
def test_bad_barriers_are_told_and_change_nothing(settings, sentence):
    item = grid(n=10)
    everything = item.data.attributes.new("All", "BOOLEAN", "FACE")
    everything.data.foreach_set("value", np.ones(len(item.data.polygons), bool))
    inner = next(edge.index for edge in item.data.edges if set(edge.vertices) <= {48, 49, 59, 60, 50, 61})
    item.data.attributes.new("One", "BOOLEAN", "EDGE").data[inner].value = True
    item.data.attributes.new("Way", "FLOAT_VECTOR", "POINT")
    select(item, [0])
    before = fingerprint(item)
    with pytest.raises(RuntimeError, match=sentence):
        bpy.ops.saddleback.distance(sources="SELECTED", **settings)
    assert fingerprint(item) == before


def test_a_site_on_both_sides_is_refused():
    item, settings = square("SEAMS")
    select(item, [corner(item, 0.0, positions(item.data)[:, 1].min()), 5])
    with pytest.raises(RuntimeError, match="is on both sides of a barrier; choose one beside it"):
        bpy.ops.saddleback.tessellate(sites_source="SELECTED", **settings, **QUICK)


def test_nothing_is_mirrored_over_barriers():
    _, settings = square("SEAMS")
    with pytest.raises(RuntimeError, match="barriers are not mirrored; switch X Mirror off"):
        bpy.ops.saddleback.tessellate(count=10, mirror_x=True, **settings)
