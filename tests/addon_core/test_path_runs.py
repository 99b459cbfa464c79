# SPDX-License-Identifier: GPL-3.0-or-later
"""Chains, loops and pairs of shortest paths; what cannot be joined is refused."""

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import path_runs, runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.requests import PathRequest, Surface
from saddleback_blender.core.settings import PathSettings
from tests import meshes

PLACES = np.array([[0.1, 0.1, 0.0], [0.9, 0.2, 0.3], [0.5, 0.8, -0.1]])
FLAT = PLACES * [1, 1, 0]


def paths(surface, points, cache=None, **settings):
    request = PathRequest(surface, PathSettings(**settings), points)
    return path_runs.paths(request, runs.new_progress(), cache or Cache(2**30))


def lines_of(result):
    return [result.points[a:b] for a, b in zip(result.offsets[:-1], result.offsets[1:], strict=True)]


def length_of(points, closed=False):
    return np.linalg.norm(np.diff(points, axis=0, append=points[:1] if closed else points[-1:]), axis=1).sum()


def gap(a, b):
    return float(np.linalg.norm(a - b))


def test_a_chain_is_one_line_through_all_points():
    result = paths(shapes.grid(15), PLACES)
    (line,) = lines_of(result)
    assert result.closed.tolist() == [False]
    np.testing.assert_allclose([line[0], line[-1]], FLAT[[0, 2]], atol=1e-12)
    assert np.linalg.norm(line - FLAT[1], axis=1).min() < 1e-12
    assert result.lengths[0] == pytest.approx(gap(FLAT[0], FLAT[1]) + gap(FLAT[1], FLAT[2]), rel=1e-9)
    assert length_of(line) == pytest.approx(result.lengths[0], rel=1e-9)
    assert (np.linalg.norm(np.diff(line, axis=0), axis=1) > 0).all()
    np.testing.assert_allclose(result.normals, np.tile([0.0, 0.0, 1.0], (len(line), 1)), atol=1e-12)


def test_a_loop_comes_back():
    result = paths(shapes.grid(15), PLACES, connect="LOOP")
    (line,) = lines_of(result)
    assert result.closed.tolist() == [True]
    round_trip = sum(gap(FLAT[i], FLAT[(i + 1) % 3]) for i in range(3))
    assert result.lengths[0] == pytest.approx(round_trip, rel=1e-9)
    assert length_of(line, closed=True) == pytest.approx(round_trip, rel=1e-9)
    assert gap(line[0], line[-1]) > 0
    there_and_back = paths(shapes.grid(15), PLACES[:2], connect="LOOP")
    assert there_and_back.closed.tolist() == [False]  # the same way back: one line


def test_all_pairs():
    result = paths(shapes.grid(15), PLACES, connect="PAIRS")
    wanted = [gap(FLAT[a], FLAT[b]) for a, b in ((0, 1), (0, 2), (1, 2))]
    np.testing.assert_allclose(result.lengths, wanted, rtol=1e-9)
    for line, (a, b) in zip(lines_of(result), ((0, 1), (0, 2), (1, 2)), strict=True):
        ends = {tuple(np.round(line[0], 9)), tuple(np.round(line[-1], 9))}
        assert ends == {tuple(np.round(FLAT[a], 9)), tuple(np.round(FLAT[b], 9))}


def test_vertices_of_the_blender_mesh():
    result = paths(shapes.grid(10, loose=4), np.array([4, 14, 124], np.int32))
    (line,) = lines_of(result)
    np.testing.assert_allclose([line[0], line[-1]], [[0, 0, 0], [1, 1, 0]], atol=1e-12)
    assert result.lengths[0] == pytest.approx(2.0)


def test_repeated_points_count_once():
    surface = shapes.grid(10)
    doubled = paths(surface, np.array([0, 0, 10, 10, 120, 0], np.int32), connect="LOOP")
    single = paths(surface, np.array([0, 10, 120], np.int32), connect="LOOP")
    np.testing.assert_array_equal(doubled.points, single.points)
    assert doubled.closed.tolist() == [True]


@pytest.mark.parametrize("shorten", [False, True])
def test_no_path_is_shorter_than_the_distance(shorten):
    vertices, triangles = meshes.icosphere(3)
    surface = Surface("Ball", vertices, triangles, len(vertices))
    points = np.array([0, 40, 300], np.int32)
    result = paths(surface, points, connect="PAIRS", shorten=shorten, quality="FAST")
    for length, (a, b) in zip(result.lengths, ((0, 40), (0, 300), (40, 300)), strict=True):
        angle = np.arccos(np.clip(vertices[a] @ vertices[b], -1, 1))
        assert 0.99 * angle <= length <= 1.02 * angle


@pytest.mark.parametrize("connect", ["CHAIN", "LOOP", "PAIRS"])
def test_exact_paths_are_exact_and_need_no_graph(connect):
    vertices, triangles = meshes.torus()
    surface = Surface("Shape", vertices, triangles, len(vertices))
    points, cache = np.array([0, 40, 300], np.int32), Cache(2**30)
    result = paths(surface, points, cache, connect=connect, quality="EXACT")
    assert cache.builds == {"mesh": 1, "paths": 1}
    mesh = sb.Mesh(vertices, triangles)
    far = {(a, b): sb.exact_distances(mesh, np.array([a], np.int32))[b] for a, b in ((0, 40), (40, 300), (0, 300))}
    wanted = {
        "CHAIN": [far[0, 40] + far[40, 300]],
        "LOOP": [sum(far.values())],
        "PAIRS": [far[0, 40], far[0, 300], far[40, 300]],
    }[connect]
    np.testing.assert_allclose(result.lengths, wanted, rtol=1e-12)
    drawn = [length_of(line, closed=connect == "LOOP") for line in lines_of(result)]
    np.testing.assert_allclose(drawn, wanted, rtol=1e-9)
    assert paths(surface, points, cache, connect=connect, quality="EXACT", shorten=False) is result


def test_a_second_run_computes_nothing():
    cache, surface = Cache(2**30), shapes.grid(10)
    first = paths(surface, PLACES, cache)
    assert paths(surface, PLACES, cache, path_radius=1.0, lift=0.5) is first
    assert cache.builds == {"mesh": 1, "graph": 1, "paths": 1}
    paths(surface, PLACES, cache, connect="LOOP")
    assert cache.builds == {"mesh": 1, "graph": 1, "paths": 2}


def test_what_cannot_be_joined_is_refused():
    surface = shapes.grid(10, loose=1)
    for points, says in (
        (np.array([1], np.int32), "needs two points at different places, and there is only one"),
        (np.array([1, 1, 1], np.int32), "one place only"),
        (np.array([1, 0], np.int32), "the point at vertex 0 belongs to no face"),
    ):
        with pytest.raises(BadInputError, match="'Shape'.*" + says):
            paths(surface, points)
    with pytest.raises(BadInputError, match=r"all pairs of 441 points are 97,020 paths, more than the 20,000"):
        paths(shapes.grid(20), np.arange(441, dtype=np.int32), connect="PAIRS")
    arrays = meshes.merge(meshes.grid(4, 4), (meshes.grid(4, 4)[0] + [0, 0, 5], meshes.grid(4, 4)[1]))
    two = Surface("Two", *arrays, len(arrays[0]))
    for points in (np.array([0, 3, len(arrays[0]) - 1], np.int32), np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0, 5]])):
        for connect in ("CHAIN", "PAIRS"):
            with pytest.raises(BadInputError, match=r"'Two': points 1 and 3 lie on parts .* that do not hang together"):
                paths(two, points, connect=connect)


def hourglass():
    vertices, triangles = meshes.cylinder(48, 41, 1.0, 3.0)
    vertices[:, 2] -= vertices[:, 2].mean()
    vertices[:, :2] *= 1.0 + 0.3 * vertices[:, 2:] ** 2
    return Surface("Glass", vertices, triangles, len(vertices))


@pytest.mark.parametrize("smooth", [False, True])
def test_a_closed_chain_is_pulled_tight_around_the_waist(smooth):
    surface = hourglass()
    angle = np.linspace(0, 2 * np.pi, 5, endpoint=False)
    places = np.column_stack([2 * np.cos(angle), 2 * np.sin(angle), 0.5 * np.sin(2 * angle) + 0.3])
    loose, tight = (
        paths(surface, places, connect="LOOP", smooth=smooth, tighten=tighten).lengths[0] for tighten in (False, True)
    )
    waist = 48 * 2 * np.sin(np.pi / 48)  # of the regular polygon at the narrowest height
    assert tight == pytest.approx(waist, rel=1e-9) and loose > 1.05 * tight
    result = paths(surface, places, connect="LOOP", smooth=smooth, tighten=True)
    np.testing.assert_allclose(result.points[:, 2], 0.0, atol=1e-9)
    assert length_of(result.points, closed=True) == pytest.approx(waist, rel=1e-9) and result.closed.all()


def test_a_chain_that_nothing_holds_cannot_be_pulled_tight():
    with pytest.raises(BadInputError, match=r"'Shape': nothing holds the closed chain, .* neck, a handle or a hole"):
        paths(shapes.grid(15), PLACES, connect="LOOP", tighten=True)


@pytest.mark.parametrize("quality", ["NORMAL", "EXACT"])
def test_a_smooth_chain_passes_its_points_without_corners(quality):
    (line,) = lines_of(paths(shapes.grid(15), PLACES, smooth=True, quality=quality))
    assert max(np.linalg.norm(line - place, axis=1).min() for place in FLAT) < 1e-9
    steps = np.diff(line, axis=0)
    steps = steps[np.linalg.norm(steps, axis=1) > 1e-6]
    steps /= np.linalg.norm(steps, axis=1)[:, None]
    sharpest = np.einsum("ij,ij->i", steps[1:], steps[:-1]).min()
    (corners,) = lines_of(paths(shapes.grid(15), PLACES, quality=quality))
    assert sharpest > 0.9 and length_of(line) > length_of(corners)


def test_cancelled_on_the_way():
    progress = runs.new_progress()
    progress.cancel()
    from saddleback_blender.core import native

    with pytest.raises(native.load().Cancelled):
        path_runs.paths(PathRequest(shapes.grid(10), PathSettings(), PLACES), progress, Cache(2**30))


def test_more_points_than_memory_has_room_for_are_refused(monkeypatch):
    monkeypatch.setattr(path_runs, "MOST_LINE_POINTS", 20)
    with pytest.raises(BadInputError, match="'Shape': the paths would have more than 20 points; choose fewer places"):
        paths(shapes.grid(15), PLACES)
