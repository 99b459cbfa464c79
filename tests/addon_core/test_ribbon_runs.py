# SPDX-License-Identifier: GPL-3.0-or-later
"""Ribbons: where they are known by hand they are there; what cannot be laid is refused."""

import math
import threading
import time
from collections import Counter

import meshes_of_core as shapes
import numpy as np
import pytest

from saddleback_blender.core import native, ribbon_runs, runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.requests import Polyline, RibbonRequest, Surface
from saddleback_blender.core.settings import RibbonSettings
from saddleback_blender.core.shapes.divided_solids import divided
from saddleback_blender.core.shapes.shape_templates import Solid, box_uv
from tests import meshes

LINE = Polyline(np.array([[0.1, 0.5, 0.3], [0.9, 0.5, 0.3]]), False)  # above the middle of the unit square
WIDTH, LIFT = 0.2, 0.03


def cube(scale=(3.0, 1.0, 1.0)):
    """A box about the origin of six quads, each of its own material; the sides are not smooth."""
    corner = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) - 0.5
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [3, 2, 6, 7], [1, 3, 7, 5], [2, 0, 4, 6]])
    vertices = corner * scale
    corners = quads.ravel().astype(np.int32)
    return Solid(
        vertices, corners, np.arange(0, 25, 4, dtype=np.int32), box_uv(vertices)[corners],
        np.array([True] * 2 + [False] * 4), np.arange(6, dtype=np.int32),
    )  # fmt: skip


def lay(surface=None, curves=(LINE,), solid=None, aspect=1.0, cache=None, **settings):
    chosen = RibbonSettings(**{"width": WIDTH, "lift": LIFT, **settings})
    request = RibbonRequest(surface or shapes.grid(9), chosen, curves, aspect, solid)
    return ribbon_runs.ribbons(request, runs.new_progress(), cache or Cache(2**30))


def surface_of(arrays):
    return Surface("Shape", *arrays, len(arrays[0]))


def area_vectors(solid):
    """(polygons, 3) normals as long as the areas."""
    found = []
    for begin, end in zip(solid.offsets[:-1], solid.offsets[1:], strict=True):
        places = solid.vertices[solid.corners[begin:end]]
        found.append(0.5 * np.cross(places, np.roll(places, -1, axis=0)).sum(axis=0))
    return np.array(found)


def directed_edges(solid):
    edges = Counter()
    for begin, end in zip(solid.offsets[:-1], solid.offsets[1:], strict=True):
        loop = solid.corners[begin:end].tolist()
        edges.update(zip(loop, [*loop[1:], loop[0]], strict=True))
    return edges


def is_closed(solid):
    edges = directed_edges(solid)
    return all(count == 1 and edges[b, a] == 1 for (a, b), count in edges.items())


def test_a_band_on_a_plane_is_a_raised_rectangle_with_walls():
    result = lay()
    solid = result.solid
    normals = area_vectors(solid)
    top = solid.smooth
    assert normals[top, 2].sum() == pytest.approx(0.8 * WIDTH, rel=1e-9) and (normals[top, 2] > 0).all()
    walls = np.linalg.norm(normals[~top], axis=1).sum()
    assert walls == pytest.approx(2 * (0.8 + WIDTH) * LIFT, rel=1e-9)
    np.testing.assert_allclose(normals.sum(axis=0), [0, 0, 0.8 * WIDTH], atol=1e-12)  # closed but for the bottom
    assert set(np.round(solid.vertices[:, 2], 12)) == {0.0, LIFT}
    places = solid.vertices[solid.corners]
    expected = np.column_stack([(places[:, 0] - 0.1) / 0.8 * 4, 0.5 + (places[:, 1] - 0.5) / WIDTH])
    np.testing.assert_allclose(solid.uv[:, 1], expected[:, 1], atol=1e-8)
    off = np.abs(solid.uv[:, 0] - expected[:, 0])  # the map is exact on the curve, and smooth beside it
    assert off[np.abs(expected[:, 1] - 0.5) < 1e-9].max() < 1e-8 and off.max() < 0.2 and off.mean() < 0.03
    assert (result.lengths, result.repeats.tolist()) == (pytest.approx([0.8], rel=1e-9), [4])
    assert result.coverage == pytest.approx(1.0, rel=1e-9)
    feet = np.einsum("ni,nij->nj", result.anchors.barycentric, shapes.grid(9).vertices[result.anchors.corners])
    np.testing.assert_allclose(feet + result.anchors.offset, solid.vertices, atol=1e-12)
    np.testing.assert_allclose(feet, solid.vertices * [1, 1, 0], atol=1e-12)


@pytest.mark.parametrize(("repeat", "aspect", "times"), [("REPEAT", 2.0, 2), ("REPEAT", 9.0, 1), ("STRETCH", 1.0, 1)])
def test_a_picture_is_there_so_often_and_has_no_walls(repeat, aspect, times):
    result = lay(aspect=aspect, show="IMAGE", repeat=repeat)
    assert result.repeats.tolist() == [times] and result.solid.smooth.all()
    uv = result.solid.uv
    np.testing.assert_allclose([uv.min(axis=0), uv.max(axis=0)], [[0, 0], [times, 1]], atol=1e-8)
    np.testing.assert_allclose(result.solid.vertices[:, 2], LIFT, rtol=1e-12)


@pytest.mark.parametrize(("repeat", "times"), [("REPEAT", 2), ("STRETCH", 1)])
def test_an_object_on_a_plane_is_where_it_belongs(repeat, times):
    box = cube((2.0, 1.0, 1.0))
    result = lay(solid=box, show="OBJECT", repeat=repeat)
    solid = result.solid
    assert result.repeats.tolist() == [times]
    assert np.einsum("ij,ij->", area_vectors(solid), middles(solid)) / 3 == pytest.approx(0.8 * WIDTH**2, rel=1e-3)
    low, high = solid.vertices.min(axis=0), solid.vertices.max(axis=0)
    np.testing.assert_allclose([low, high], [[0.1, 0.4, LIFT - WIDTH / 2], [0.9, 0.6, LIFT + WIDTH / 2]], atol=1e-9)
    one = divided(box, (1 / 8 * 2 / (0.8 / times) * WIDTH, 1 / 8), runs.new_progress())
    expected = np.concatenate([one.vertices + [2 * i + 1, 0, 0] for i in range(times)])
    expected = expected * [0.4 / times, WIDTH, WIDTH] + [0.1, 0.5, LIFT]
    off = np.abs(solid.vertices - expected)
    assert off[:, 1:].max() < 1e-9 and off[:, 0].max() < 0.2 * WIDTH and off[:, 0].mean() < 0.03 * WIDTH
    assert off[np.abs(expected[:, 1] - 0.5) < 1e-9].max() < 1e-9
    np.testing.assert_array_equal(solid.uv, np.tile(one.uv, (times, 1)))
    assert set(solid.material[solid.smooth]) == {0, 1} and set(solid.material[~solid.smooth]) == {2, 3, 4, 5}
    flat = [(a, b) for a, b in directed_edges(solid) if expected[a, 2] == expected[b, 2]]
    assert max(math.dist(expected[a], expected[b]) for a, b in flat) < 1.5 * WIDTH / 8


def middles(solid):
    return np.array([
        solid.vertices[solid.corners[a:b]].mean(axis=0)
        for a, b in zip(solid.offsets[:-1], solid.offsets[1:], strict=True)
    ])  # fmt: skip


def test_copies_follow_each_other():
    result = lay(solid=cube((1.0, 1.0, 0.2)), show="OBJECT")
    assert result.repeats.tolist() == [4]
    count = len(result.solid.vertices) // 4
    copies = result.solid.vertices.reshape(4, count, 3)
    for i in range(1, 4):
        step = copies[i] - copies[0]
        np.testing.assert_allclose(step[:, 1:], 0.0, atol=1e-9)
        assert np.abs(step[:, 0] - i * 0.2).max() < 0.2 * WIDTH


@pytest.mark.parametrize("steps", [(0.31, 0.27), (0.5, 9.0), (9.0, 9.0)])
def test_cutting_changes_nothing_that_is_seen(steps):
    """A round solid with triangles and quads: closed, as large, UV places as they were, nothing across a line."""
    arrays = meshes.torus()
    both = cube((1.0, 1.0, 1.0)) if steps == (0.5, 9.0) else Solid(
        arrays[0], arrays[1].ravel().astype(np.int32), np.arange(0, 3 * len(arrays[1]) + 1, 3, dtype=np.int32),
        box_uv(arrays[0])[arrays[1].ravel()], np.ones(len(arrays[1]), bool), np.zeros(len(arrays[1]), np.int32),
    )  # fmt: skip
    cut = divided(both, steps, runs.new_progress())
    assert is_closed(both) and is_closed(cut)
    np.testing.assert_allclose(
        np.linalg.norm(area_vectors(cut), axis=1).sum(), np.linalg.norm(area_vectors(both), axis=1).sum(), rtol=1e-9
    )
    np.testing.assert_allclose(cut.uv, uv_of(both, cut.vertices[cut.corners]), atol=1e-9)
    if steps == (9.0, 9.0):
        assert len(cut.vertices) == len(both.vertices) and np.array_equal(cut.corners, both.corners)
    for axis, step in enumerate(steps):
        low, size = both.vertices[:, axis].min(), np.ptp(both.vertices[:, axis])
        lines = low + size * np.arange(1, max(round(size / step), 1)) / max(round(size / step), 1)
        for begin, end in zip(cut.offsets[:-1], cut.offsets[1:], strict=True):
            values = cut.vertices[cut.corners[begin:end], axis]
            across = (lines > values.min() + 1e-5) & (lines < values.max() - 1e-5)
            assert not across.any()


def uv_of(solid, places):
    """What box_uv gave to places of the solid."""
    low, high = solid.vertices[:, :2].min(axis=0), solid.vertices[:, :2].max(axis=0)
    return 0.5 + (places[:, :2] - (low + high) / 2) / (high - low).max()


def ring(height=0.0, radius=1.2, count=30):
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return Polyline(np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height)]), True)


def test_a_ring_joins_at_its_seam():
    surface = surface_of(meshes.cylinder(48, 20))
    middle = surface.vertices[:, 2].mean()
    band = lay(surface, (ring(middle),), show="IMAGE").solid
    edges = directed_edges(band)
    rim = [pair for pair in edges if pair[::-1] not in edges]
    faces, vertices = len(band.offsets) - 1, len(band.vertices)
    assert vertices - len({tuple(sorted(pair)) for pair in edges}) + faces == 0  # an annulus: sewn
    heights = band.vertices[[a for a, _ in rim], 2]
    np.testing.assert_allclose(np.abs(heights - middle), 0.1, atol=0.01)  # the curve is smooth, not a circle
    tile = cube((1.0, 1.0, 0.1))
    result = lay(surface, (ring(middle),), solid=tile, show="OBJECT")
    places = result.solid.vertices.reshape(result.repeats[0], -1, 3)
    one = divided(tile, (0.125, 0.125), runs.new_progress()).vertices
    on_rim = np.abs(one[:, 2]) > 0.0499  # not within the ends, whose diagonals are not each other's
    last, first = on_rim & (one[:, 0] > 0.499), on_rim & (one[:, 0] < -0.499)
    for i in range(len(places)):
        end, begin = (np.round(part, 6) + 0.0 for part in (places[i][last], places[i - len(places) + 1][first]))
        assert set(map(tuple, end)) == set(map(tuple, begin))


@pytest.mark.parametrize("apart", [0.0, 1e-7])
def test_an_open_curve_that_ends_where_it_starts_is_a_ring(apart):
    """A ribbon had a gap of half a width there, or was refused where the ends were off by a rounding."""
    surface = surface_of(meshes.cylinder(48, 20))
    closed = ring(surface.vertices[:, 2].mean())
    opened = Polyline(np.concatenate([closed.points, closed.points[:1] + apart]), False)
    one, other = lay(surface, (opened,), width=0.5), lay(surface, (closed,), width=0.5)
    assert one.lengths == pytest.approx(other.lengths, rel=1e-5)
    assert one.solid.vertices == pytest.approx(other.solid.vertices, abs=1e-5)


def test_a_ribbon_follows_a_curve_that_is_cut_off_where_the_surface_ends_in_parts():
    arrays = meshes.merge(meshes.grid(9, 9), (meshes.grid(9, 9)[0] + [2, 0, 0], meshes.grid(9, 9)[1]))
    low, high = arrays[0].min(axis=0), arrays[0].max(axis=0)
    y = (low[1] + high[1]) / 2
    line = Polyline(np.array([[low[0], y, 0.1], [high[0], y, 0.1]]), False)
    result = lay(surface_of(arrays), (line,), width=0.1)
    assert len(result.lengths) == 2 and (result.lengths > 0.5).all()
    short = Polyline(line.points - [[0, 0, 0], [0.95 * np.ptp(meshes.grid(9, 9)[0][:, 0]), 0, 0]], False)
    passing = lay(surface_of(arrays), (short,), width=0.3)
    assert len(passing.lengths) == 1 and passing.lengths[0] > 0.5  # the other piece is shorter than wide
    alone = lay(curves=(Polyline(np.array([[0.5, 0.5, 0.0], [0.55, 0.5, 0.0]]), False),))
    assert alone.lengths == pytest.approx([0.05], rel=1e-9)  # and this one is wanted so


def test_what_is_kept_is_not_made_again():
    cache = Cache(2**30)
    lay(cache=cache)
    lay(cache=cache, lift=0.01)
    lay(cache=cache, show="OBJECT", solid=cube())
    assert (cache.builds["strips"], cache.builds["graph"]) == (1, 1)
    lay(cache=cache, width=0.1)
    assert (cache.builds["strips"], cache.builds["graph"]) == (2, 1)


def eight():
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    return Polyline(np.column_stack([0.5 + 0.35 * np.sin(t), 0.5 + 0.3 * np.sin(2 * t), 0 * t]), True)


@pytest.mark.parametrize(("curve", "settings", "sentence"), [
    (LINE, {"width": 0.0}, "'Shape': ribbons of width 0 are no ribbons; choose another width"),
    (LINE, {"width": 3.0}, r"'Shape': ribbons of width 3 are wider than the whole surface, 1\.41; choose another"),
    (Polyline(LINE.points + [0, 0, 9], False), {}, r"'Shape': curve 1 is nowhere nearer to the surface than 9\.3; m"),
    (Polyline(LINE.points[:1].repeat(3, axis=0), False), {}, "'Shape': the curves are single points on the surface"),
    (eight(), {"width": 0.02}, r"'Shape': ribbon 1: curve: it crosses or touches itself at \(0\.5.*, 0\.5.*, 0.*\)"),
    (LINE, {"width": 1e-4}, "'Shape': ribbon 1 would be 8,000 times as long as wide, more than the 300 that are"),
])  # fmt: skip
def test_what_cannot_be_laid_is_refused(curve, settings, sentence):
    with pytest.raises(BadInputError, match=sentence):
        lay(curves=(curve,), **settings)


def test_too_many_copies_are_refused(monkeypatch):
    monkeypatch.setattr(ribbon_runs, "MOST_VERTICES", 31)
    lay(solid=cube((1.5, 1.0, 1.0)), show="OBJECT", width=0.18)
    with pytest.raises(BadInputError, match="'Shape': the object would be laid 4 times, with 32 vertices, more th"):
        lay(solid=cube((1.0, 1.0, 1.0)), show="OBJECT")


def test_a_run_ends_when_it_is_asked_to():
    surface = surface_of(meshes.icosphere(5))
    t = np.linspace(0, 1, 2000)
    turn = np.sin(np.pi * t)
    spiral = np.column_stack([turn * np.cos(12 * t), turn * np.sin(12 * t), np.cos(np.pi * t)])
    request = RibbonRequest(
        surface, RibbonSettings(width=0.06, lift=0.0, show="OBJECT"), (Polyline(spiral[20:-20], False),), 1.0, cube()
    )
    for wait in (0.0, 0.3, 0.8):
        progress = runs.new_progress()
        ended = []

        def run(progress=progress, ended=ended):
            with pytest.raises(native.load().Cancelled):
                while True:
                    ribbon_runs.ribbons(request, progress, Cache(2**30))
            ended.append(time.perf_counter())

        thread = threading.Thread(target=run)
        thread.start()
        time.sleep(wait)
        asked = time.perf_counter()
        progress.cancel()
        thread.join(10.0)
        assert ended and ended[0] - asked < 0.25


@pytest.mark.parametrize(("height", "width", "reach"), [(0.5, 0.2, 1.0), (0.05, 0.2, 0.5), (0.5, 1.4, 0.5 / 0.7)])
def test_how_far_the_surface_reaches_is_told(height, width, reach):
    """Where a border ends it, coverage does not say so."""
    line = Polyline(np.array([[0.1, height, 0.0], [0.9, height, 0.0]]), False)
    result = lay(curves=(line,), width=width)
    assert result.coverage == pytest.approx(1.0, rel=1e-6)
    assert result.reach == pytest.approx(reach, rel=1e-6)
