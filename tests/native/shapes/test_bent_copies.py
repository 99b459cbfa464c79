# SPDX-License-Identifier: MIT
"""Meshes bent onto the surface: they lie on it, hang together, and know what they are pieces of."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

Floats = NDArray[np.float64]
Indices = NDArray[np.int32]
Solid = tuple[Floats, Indices]

SHAPES = [sb.Shape.disk(24), sb.Shape.star(5), sb.Shape.leaf()]


def flat(shape: sb.Shape) -> Solid:
    """A fan about the center."""
    outline = shape.loops[0]
    count = len(outline)
    vertices = np.zeros((count + 1, 3))
    vertices[:count, :2] = outline
    here = np.arange(count)
    return vertices, np.stack([here, (here + 1) % count, np.full(count, count)], axis=1).astype(np.int32)


def cushion(shape: sb.Shape, height: float = 0.3) -> Solid:
    """A closed solid: a bottom, walls, and a top that is drawn in."""
    outline = shape.loops[0]
    count = len(outline)
    rings = [outline, outline, 0.5 * outline]
    heights = (0.0, height / 2, height)
    vertices = np.concatenate([np.column_stack([r, np.full(count, z)]) for r, z in zip(rings, heights, strict=True)])
    vertices = np.concatenate([vertices, [[0, 0, 0], [0, 0, height]]])
    here, onward = np.arange(count), (np.arange(count) + 1) % count
    triangles = [np.stack([onward, here, np.full(count, 3 * count)], axis=1)]
    for below in (0, count):
        triangles.append(np.stack([below + here, below + onward, below + count + onward], axis=1))
        triangles.append(np.stack([below + here, below + count + onward, below + count + here], axis=1))
    triangles.append(np.stack([2 * count + here, 2 * count + onward, np.full(count, 3 * count + 1)], axis=1))
    return vertices, np.concatenate(triangles).astype(np.int32)


@functools.cache
def rough() -> sb.Mesh:
    """A bumpy torus: creases at every edge."""
    vertices, triangles = meshes.torus(60, 24)
    rng = np.random.default_rng(0)
    return sb.Mesh(vertices * (1 + 0.02 * rng.standard_normal((len(vertices), 1))), triangles)


def placed(mesh: sb.Mesh, count: int, scale: float, seed: int = 0) -> sb.MappedShapes:
    rng = np.random.default_rng(seed)
    turn, flip = rng.uniform(0, 2 * np.pi, count), rng.random(count) < 0.5
    placements = sb.Placements(
        rng.integers(0, len(SHAPES), count), sb.sample(mesh, count, seed=seed), turn, np.full(count, scale), flip
    )
    return sb.map_shapes(mesh, SHAPES, placements)


def test_normals_are_those_of_the_mesh_that_shapes_were_laid_on() -> None:
    """Which others may have been laid on another since, or before on one that is gone."""
    sphere, torus = sb.Mesh(*meshes.icosphere(3)), sb.Mesh(*meshes.torus(60, 24))
    solids = [cushion(shape) for shape in SHAPES]
    alone = [placed(mesh, 4, 0.1).bend(solids).vertices.copy() for mesh in (sphere, torus)]
    first, second = placed(sphere, 4, 0.1), placed(torus, 4, 0.1)
    for mapped, expected in ((second, alone[1]), (first, alone[0]), (placed(torus, 4, 0.1), alone[1])):
        np.testing.assert_array_equal(mapped.bend(solids).vertices, expected)


def samples(bent: sb.BentCopies, count: int) -> Floats:
    """Even over the area."""
    rng = np.random.default_rng(1)
    corners = bent.vertices[bent.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    which = rng.choice(len(corners), count, p=areas / areas.sum())
    return np.asarray(np.einsum("ni,nij->nj", rng.dirichlet([1, 1, 1], count), corners[which]))


def off_the_surface(mesh: sb.Mesh, points: Floats) -> Floats:
    return np.asarray(np.linalg.norm(sb.project(mesh, points).positions(mesh) - points, axis=1))


@pytest.mark.parametrize("case", [c for c in meshes.good() if c.components == 1 and c.name != "needles"], ids=str)
def test_flat_ones_lie_on_the_surface(case: meshes.Case) -> None:
    """The 99th percentile is within 1 % of the radius, which without dividing it is not."""
    mesh, scale = case.mesh, 0.12 * np.sqrt(case.mesh.area)
    mapped = placed(mesh, 30, scale)
    assert len(mapped.failures) <= 25  # there is something to look at
    solids = [flat(shape) for shape in SHAPES]
    bent = mapped.bend(solids)
    found = off_the_surface(mesh, samples(bent, 4000)) / scale
    assert np.percentile(found, 99) < 0.01 and found.max() < 0.03
    laid = [i for i in range(30) if i not in mapped.failures]
    assert np.isnan(np.delete(bent.deviations, laid)).all()
    assert found.max() < max(0.01, 2.5 * bent.deviations[laid].max())


def test_corners_lie_on_the_outline_where_the_plane_covers_the_surface_twice() -> None:
    """Around the rim of a thin ellipsoid the plane meets itself beside narrow shapes."""
    vertices, triangles = meshes.icosphere(3)
    mesh = sb.Mesh(vertices * [1, 0.15, 0.08], triangles)
    shapes = [sb.Shape.needle(10), sb.Shape.star(), sb.Shape.crescent()]
    count, size, rng = 500, 0.3, np.random.default_rng(1)
    kinds = rng.integers(0, 3, count)
    placements = sb.Placements(
        kinds, sb.sample(mesh, count, seed=3), rng.uniform(0, 2 * np.pi, count), np.full(count, size)
    )
    mapped = sb.map_shapes(mesh, shapes, placements)
    bent = mapped.bend([flat(shape) for shape in shapes], 0)
    laid = [i for i in range(count) if i not in mapped.failures]
    assert len(laid) > 200 and len(bent.lost) == 0
    for i in laid:
        corners = shapes[kinds[i]].loops[0]
        outline = mapped.outline(i)[0]
        edge = np.roll(outline, -1, axis=0) - outline
        for own in (bent.vertices[bent.begins[i] :][: len(corners)], mapped.conform(corners, i).points):
            away = own[:, None] - outline
            along = np.clip((away * edge).sum(axis=2) / np.maximum((edge**2).sum(axis=1), 1e-300), 0, 1)
            off = np.linalg.norm(away - along[..., None] * edge, axis=2).min(axis=1)
            assert off.max() < 1e-9 * size


def test_without_a_tolerance_chords_leave_the_surface() -> None:
    mesh, scale = rough(), 0.25
    solids = [flat(shape) for shape in SHAPES]
    mapped = placed(mesh, 30, scale)
    found = [
        np.percentile(off_the_surface(mesh, samples(mapped.bend(solids, t), 4000)) / scale, 99)
        for t in (0.0, 0.1, 0.02, 0.005)
    ]
    assert found[0] > 0.08
    assert found[1] < 0.1 and found[2] < 0.02 and found[3] < 0.005


def test_in_the_plane_nothing_is_divided() -> None:
    mesh = sb.Mesh(*meshes.grid(20, 20, 0.3))
    mapped = placed(mesh, 20, 0.1)
    solids = [cushion(shape) for shape in SHAPES]
    bent = mapped.bend(solids)
    for i in range(20):
        begin, end = bent.begins[i : i + 2]
        solid = solids[mapped.placements.shape[i]]
        mine = bent.triangle_copy == i
        if i in mapped.failures:
            assert begin == end and not mine.any()
            continue
        own = mapped.conform(solid[0], i)
        assert np.abs(bent.vertices[begin:end] - own.points).max() < 1e-12
        triangles = bent.triangles[mine] - begin
        expected = solid[1][:, [0, 2, 1]] if mapped.placements.mirrored[i] else solid[1]
        assert np.array_equal(triangles, expected)
        assert bent.deviations[i] < 1e-9


def test_a_crease_splits_edges_where_they_cross_it() -> None:
    """Two half planes at right angles: every edge that crosses is split once, and nothing is off."""
    vertices = np.array([(x, max(y, 0), max(-y, 0)) for y in (-2.0, 0.0, 2.0) for x in (-2.0, 0.0, 2.0)])
    faces = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (3, 4, 7), (3, 7, 6), (4, 5, 8), (4, 8, 7)]
    mesh = sb.Mesh(vertices, np.array(faces))
    center = sb.project(mesh, [[0.1, 0.3, 0.0]])
    shape = sb.Shape([(-1, -1), (1, -1), (1, 1), (-1, 1)])
    mapped = sb.map_shapes(mesh, shape, sb.Placements([0], center, [0.0], [0.9]))
    square = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0.0)]), np.array([(0, 1, 2), (0, 2, 3)])
    bent = mapped.bend([square], 1e-3)
    assert 4 < len(bent.vertices) < 12
    _x, y, z = samples(bent, 2000).T
    assert np.minimum(np.abs(z), np.abs(y)).max() < 2e-3


def edge_counts(triangles: Indices) -> NDArray[np.int64]:
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    return np.asarray(np.unique(edges, axis=0, return_counts=True)[1])


def test_closed_solids_stay_closed() -> None:
    mesh = rough()
    mapped = placed(mesh, 25, 0.25)
    bent = mapped.bend([cushion(shape) for shape in SHAPES])
    assert len(bent.triangles) > 2 * sum(len(cushion(SHAPES[s])[1]) for s in mapped.placements.shape)
    assert (edge_counts(bent.triangles) == 2).all()
    for i in range(25):
        if i in mapped.failures:
            continue
        begin, end = bent.begins[i : i + 2]
        mine = bent.triangles[bent.triangle_copy == i]
        assert mine.min() == begin and mine.max() == end - 1
        assert (end - begin) - 3 * len(mine) // 2 + len(mine) == 2  # a sphere
        corners = bent.vertices[mine]
        volume = np.einsum("ni,ni->n", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
        assert volume > 0  # mirrored or not, the outside is outside


def test_pieces_know_where_in_the_solid_they_lie() -> None:
    mesh = rough()
    mapped = placed(mesh, 12, 0.25)
    solids = [cushion(shape) for shape in SHAPES]
    bent = mapped.bend(solids)
    for i in range(12):
        mine = bent.triangle_copy == i
        if i in mapped.failures:
            continue
        vertices, triangles = solids[mapped.placements.shape[i]]
        source, weights = bent.triangle_source[mine], bent.weights[mine]
        given = np.einsum("tck,tkj->tcj", weights, vertices[triangles[source]])
        found = mapped.conform(given.reshape(-1, 3), i).points
        assert np.abs(found - bent.vertices[bent.triangles[mine]].reshape(-1, 3)).max() < 1e-9
        shares = np.bincount(source, np.abs(np.linalg.det(weights)), len(triangles))
        np.testing.assert_allclose(shares, 1, rtol=1e-9)  # all of each triangle, once


def test_edges_that_are_not_split_any_more_are_told() -> None:
    """The middles of all edges are as near to the surface as `deviations` says, also where that is not near enough."""
    mapped = sb.map_shapes(
        sb.Mesh(*meshes.icosphere(3)),
        sb.Shape.disk(8),
        sb.Placements([0], sb.SurfacePoints([5], [[0.3, 0.3, 0.4]]), [0.0], [0.5]),
    )
    corners = np.array([[0.5, 0, 0], [-0.5, 0.1, 5], [0.1, 0.5, 0]])
    bent = mapped.bend([(corners, [[0, 1, 2]])], 1e-5)
    given = bent.weights @ corners
    middles = mapped.conform(((given + np.roll(given, -1, axis=1)) / 2).reshape(-1, 3), 0).points
    begins, ends = (bent.vertices[np.roll(bent.triangles, -i, axis=1)].reshape(-1, 3) for i in range(2))
    along = (ends - begins) / np.linalg.norm(ends - begins, axis=1)[:, None]
    left = np.linalg.norm(np.cross(middles - begins, along), axis=1).max() / 0.5
    assert 1e-5 < left <= bent.deviations[0] * (1 + 1e-9)


def test_they_follow_a_surface_that_moves() -> None:
    mesh = rough()
    bent = placed(mesh, 12, 0.25).bend([flat(shape) for shape in SHAPES])
    turn = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    moved = sb.Mesh(2 * mesh.vertices @ turn.T + [1, 2, 3], mesh.triangles)
    np.testing.assert_allclose(bent.positions(moved), 2 * bent.vertices @ turn.T + [1, 2, 3], atol=1e-12)


def test_threads_change_nothing() -> None:
    mapped = placed(rough(), 25, 0.25)
    solids = [cushion(shape) for shape in SHAPES]
    one, other = mapped.bend(solids, threads=1), mapped.bend(solids, threads=3)
    for name in ("vertices", "triangles", "triangle_copy", "triangle_source", "weights", "begins", "deviations"):
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()


def test_shapes_without_a_solid_have_no_vertices() -> None:
    mapped = placed(rough(), 12, 0.2)
    bent = mapped.bend([None, flat(SHAPES[1]), None])
    counts = np.diff(bent.begins)
    assert ((counts > 0) <= (mapped.placements.shape == 1)).all() and (counts > 0).any()


@pytest.mark.parametrize(
    ("solids", "tolerance", "sentence"),
    [
        ([None], 0.01, "solids: wanted a sequence of one .* for each of the 3 shapes"),
        (None, 0.01, "solids: wanted a sequence"),
        ([None, 3, None], 0.01, r"solids: wanted \(vertices, triangles\) or None at \[1\]"),
        ([None, (np.zeros((3, 3)), [[0, 1, 3]]), None], 0.01, "triangle 0 of solid 1 has corner 3, but there are 3"),
        ([None, ([[0, 0, np.nan]], np.zeros((0, 3), int)), None], 0.01, "vertex 0 of solid 1 is not finite"),
        ([None, None, None], -1.0, "tolerance is -1, but must be finite and not negative"),
        ([None, None, None], np.inf, "tolerance is inf"),
    ],
)
def test_bad_input_is_named(solids: object, tolerance: float, sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence):
        placed(rough(), 3, 0.1).bend(solids, tolerance)  # type: ignore[arg-type]


def test_progress_rises_and_cancel_is_quick() -> None:
    mapped = placed(rough(), 600, 0.25)
    solids = [cushion(shape) for shape in SHAPES]
    check_progress_and_cancel(lambda job: mapped.bend(solids, 0.002, job=job), 0.3)
