# SPDX-License-Identifier: MIT
"""Shapes laid on the surface: closed forms where it unrolls, invariants where it does not, and every product of it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.cancelling import check_progress_and_cancel

Floats = NDArray[np.float64]

FRAME = sb.Shape([[(-1, -1), (1, -1), (1, 1), (-1, 1)], [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]])
TWO_PARTS = sb.Shape([(-1, -0.4), (-0.2, -0.3), (-0.3, 0.5)], [(0.2, -0.5), (1, 0.1), (0.2, 0.6)])
STAR_OF_FIVE = sb.Shape.star(5)
SHAPES = [STAR_OF_FIVE, sb.Shape.crescent(), sb.Shape.disk(32), FRAME, sb.Shape.needle(6), TWO_PARTS]
LOOPS = [1, 1, 1, 2, 1, 2]
PARTS = [1, 1, 1, 1, 1, 2]


def scattered(mesh: sb.Mesh, count: int, scale: float, seed: int = 0) -> sb.Placements:
    """Copies anywhere and anyhow; most of them overlap others."""
    rng = np.random.default_rng(seed)
    shape = rng.integers(0, len(SHAPES), count)
    turn, flip = rng.uniform(0, 2 * np.pi, count), rng.random(count) < 0.5
    return sb.Placements(shape, sb.sample(mesh, count, seed=seed), turn, np.full(count, scale), flip)


def one(center: sb.SurfacePoints, angle: float = 0.0, scale: float = 1.0, mirrored: bool = False) -> sb.Placements:
    return sb.Placements([0], center, [angle], [scale], [mirrored])


def triangle_areas(vertices: Floats, triangles: NDArray[np.int32]) -> Floats:
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))


def shape_area(mapped: sb.MappedShapes, i: int) -> float:
    return SHAPES[mapped.placements.shape[i]].area * float(mapped.placements.scale[i]) ** 2


def laid(mapped: sb.MappedShapes) -> list[int]:
    return [i for i in range(len(mapped)) if i not in mapped.failures]


def in_plane(mesh: sb.Mesh, points: Floats, placements: sb.Placements, i: int = 0) -> Floats:
    """Points of a shape's plane on a mesh in the plane z = 0, by the definition of a placement."""
    center, angle = placements.center[i : i + 1], float(placements.angle[i])
    a, b = mesh.vertices[mesh.triangles[center.faces[0], :2]]
    angle += np.arctan2(*(b - a)[[1, 0]])
    flipped = points * [1, -1 if placements.mirrored[i] else 1]
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.asarray(center.positions(mesh)[0, :2] + float(placements.scale[i]) * flipped @ turn)


@pytest.mark.parametrize("jitter", [0.0, 0.35])
def test_in_the_plane_they_are_rigid(jitter: float) -> None:
    mesh = sb.Mesh(*meshes.grid(20, 20, jitter))
    mapped = sb.map_shapes(mesh, SHAPES, scattered(mesh, 60, 0.06))
    assert set(mapped.failures.values()) == {"boundary"} and 30 < len(laid(mapped)) < 60
    for i in laid(mapped):
        loops = SHAPES[mapped.placements.shape[i]].loops
        assert len(mapped.outline(i)) == len(loops)
        for loop in loops:
            bent = mapped.conform(loop, i)
            assert np.abs(bent.points[:, :2] - in_plane(mesh, loop, mapped.placements, i)).max() < 1e-9
            assert len(bent.lost) == 0
        patch = mapped.patch(i)
        assert triangle_areas(patch.vertices, patch.triangles).sum() == pytest.approx(shape_area(mapped, i), rel=1e-9)
        assert np.abs(patch.vertices[:, :2] - in_plane(mesh, patch.uv, mapped.placements, i)).max() < 1e-9
    assert np.abs(mapped.stretch[laid(mapped)] - 1).max() < 1e-9


def test_a_cylinder_unrolls() -> None:
    mesh = sb.Mesh(*meshes.cylinder(60, 30))
    placements = scattered(mesh, 40, 0.3)
    mapped = sb.map_shapes(mesh, SHAPES, placements)
    assert len(laid(mapped)) > 20
    assert np.abs(mapped.stretch[laid(mapped)] - 1).max() < 1e-9
    for i in laid(mapped):
        patch = mapped.patch(i)
        assert triangle_areas(patch.vertices, patch.triangles).sum() == pytest.approx(shape_area(mapped, i), rel=1e-9)


def test_centers_at_vertices_and_on_edges_of_a_regular_grid() -> None:
    """Every corner of the square lies on an edge or at a vertex: no decision may fall between two stools."""
    mesh = sb.Mesh(*meshes.grid(9, 9))
    square = sb.Shape([(-2, -2), (2, -2), (2, 2), (-2, 2)])
    faces = [h // 3 for h in (np.flatnonzero(mesh.triangles.ravel() == 40))]
    for face in faces:
        for corner in np.eye(3)[mesh.triangles[face] == 40]:
            for turn in (0.0, np.pi / 2, -np.pi / 4):
                mapped = sb.map_shapes(mesh, square, one(sb.SurfacePoints([face], [corner]), turn, 0.125))
                patch = mapped.patch(0)
                assert triangle_areas(patch.vertices, patch.triangles).sum() == pytest.approx(0.25, rel=1e-9)
    for barycentric in ([0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]):
        mapped = sb.map_shapes(mesh, square, one(sb.SurfacePoints([70], [barycentric]), 0.0, 0.0625))
        assert mapped.failures == {}


@pytest.mark.parametrize("name", ["icosphere", "torus", "double_torus"])
def test_patches_are_what_the_shapes_are(name: str) -> None:
    """Their topology is the shape's, their area nearly so, and they are manifold: which a fold would not leave."""
    made = {"icosphere": meshes.icosphere(4), "torus": meshes.torus(60, 24), "double_torus": meshes.double_torus()}
    mesh = sb.Mesh(*made[name])
    mapped = sb.map_shapes(mesh, SHAPES, scattered(mesh, 50, 0.04 * mesh.area**0.5))
    assert len(laid(mapped)) > (20 if name == "double_torus" else 48)
    for i in laid(mapped):
        patch = mapped.patch(i)
        piece = sb.Mesh(patch.vertices, patch.triangles)
        kind = int(mapped.placements.shape[i])
        assert piece.genus == 0 and len(piece.boundary_loops) == LOOPS[kind]
        assert piece.components.max() + 1 == PARTS[kind]
        smallest, largest = mapped.stretch[i]
        assert smallest**2 - 1e-9 <= piece.area / shape_area(mapped, i) <= largest**2 + 1e-9
        assert np.allclose(patch.surface.positions(mesh), patch.vertices)
        rims = [len(loop) for loop in mapped.outline(i)]
        assert sorted(rims) == sorted(len(loop) for loop in piece.boundary_loops)


def test_the_map_is_the_exponential_map() -> None:
    """Against straightest geodesics; on an octahedral-like fine sphere the error falls with the mesh."""
    errors = []
    for level in (3, 4, 5):
        mesh = sb.Mesh(*meshes.icosphere(level))
        center = sb.SurfacePoints([11], [[0.2, 0.3, 0.5]])
        mapped = sb.map_shapes(mesh, sb.Shape.disk(40), one(center, 0.3, 0.7))
        points = sb.Shape.disk(40).loops[0] * np.linspace(0.2, 1, 40)[:, None]
        bent = mapped.conform(points, 0).points
        angles = np.arctan2(points[:, 1], points[:, 0]) + 0.3
        lengths = 0.7 * np.linalg.norm(points, axis=1)
        exact = [sb.trace(mesh, center, float(a), float(r)).points[-1] for a, r in zip(angles, lengths, strict=True)]
        errors.append(np.abs(bent - exact).max())
        smallest, largest = mapped.stretch[0]
        assert smallest == pytest.approx(np.sin(0.7) / 0.7, abs=0.25 / 2 ** (level - 1)) and largest < 1.05
    assert errors[2] < 0.004 and errors[2] < errors[0] / 3


def test_along_a_field_shapes_bend() -> None:
    """Circles about the middle of a plane: x becomes the angle and y the radius."""
    mesh = sb.Mesh(*meshes.grid(80, 80, 0.2))
    middle = mesh.vertices[mesh.triangles].mean(axis=1) - 0.5
    around = np.cross([0, 0, 1.0], middle)
    around /= np.linalg.norm(around, axis=1)[:, None]
    field = sb.DirectionField.from_vectors(mesh, around, 1)
    start = np.array([0.8, 0.53, 0.0])
    center = sb.project(mesh, start[None])
    edge = np.diff(mesh.vertices[mesh.triangles[center.faces[0], :2]], axis=0)[0]
    direction = np.cross([0, 0, 1.0], start - [0.5, 0.5, 0])
    angle = np.arctan2(direction[1], direction[0]) - np.arctan2(edge[1], edge[0])
    strap = sb.Shape([(-2, -0.3), (2, -0.3), (2, 0.3), (-2, 0.3)])
    for mirrored in (False, True):
        mapped = sb.map_shapes(mesh, strap, one(center, float(angle), 0.2, mirrored), field)
        assert mapped.failures == {}
        points = np.column_stack([np.linspace(-1.9, 1.9, 25), np.linspace(-0.25, 0.25, 25)])
        bent = mapped.conform(points, 0).points[:, :2] - 0.5
        radius = np.hypot(0.3, 0.03)
        wanted = radius - 0.2 * points[:, 1] * (-1 if mirrored else 1)
        assert np.abs(np.linalg.norm(bent, axis=1) - wanted).max() < 0.003
        turned = np.unwrap(np.arctan2(bent[:, 1], bent[:, 0])) - np.arctan2(0.03, 0.3)
        assert np.abs(turned - 0.2 * points[:, 0] / radius).max() < 0.013
        smallest, largest = mapped.stretch[0]
        assert 0.7 < smallest < 0.82 and 1.18 < largest < 1.3  # 1 - y / radius: 0.8 to 1.2
    straight = sb.map_shapes(mesh, strap, one(center, float(angle), 0.2))
    assert np.abs(np.linalg.norm(straight.conform([(1.9, 0.0)], 0).points[0, :2] - 0.5) - radius) > 0.1


def test_why_shapes_cannot_be_laid() -> None:
    disk = sb.Shape.disk(24)
    sphere, cone = sb.Mesh(*meshes.icosphere(3)), sb.Mesh(*meshes.cone(40, 20, 0.3, 2.0))
    tube, plane = sb.Mesh(*meshes.cylinder(40, 60, 0.2, 6.0)), sb.Mesh(*meshes.grid())
    outside = sb.map_shapes(plane, disk, one(sb.SurfacePoints([0], [[1, 0, 0]]), scale=0.1))
    assert outside.failures == {0: "boundary"}
    assert outside.failures is outside.failures  # loops ask for every shape
    for mesh, scale in ((tube, 0.8), (sphere, 3.5)):
        center = sb.project(mesh, mesh.vertices[[len(mesh.vertices) // 2]])
        reason = sb.map_shapes(mesh, disk, one(center, scale=scale)).failures[0]
        assert reason in ("fold", "stretched")
    tip = int(cone.vertices[:, 2].argmax())
    face = int(np.flatnonzero((cone.triangles == tip).any(axis=1))[0])
    beside = sb.SurfacePoints([face], [[1 / 3, 1 / 3, 1 / 3]])
    assert sb.map_shapes(cone, disk, one(beside, scale=0.3)).failures[0] in ("fold", "stretched")
    mapped = sb.map_shapes(sphere, disk, one(beside, scale=0.9), limits=(0.95, 1.05))
    assert mapped.failures == {0: "stretched"} and np.isnan(mapped.stretch[0]).all()
    with pytest.raises(sb.InputError, match=r"shape 0 could not be laid on the surface \(stretched\)"):
        mapped.outline(0)


def apart(mesh: sb.Mesh, count: int, scale: float) -> sb.Placements:
    """Copies whose circles do not meet."""
    points, kept = sb.sample(mesh, 40 * count, seed=1), []
    positions = points.positions(mesh)
    for i, position in enumerate(positions):
        if all(np.linalg.norm(position - positions[j]) > 2.9 * scale for j in kept) and len(kept) < count:
            kept.append(i)
    center = sb.SurfacePoints(points.faces[kept], points.barycentric[kept])
    rng = np.random.default_rng(0)
    order = np.arange(len(kept))
    turn, size = rng.uniform(0, 6, len(kept)), np.full(len(kept), scale)
    return sb.Placements(order % len(SHAPES), center, turn, size, order % 2 == 0)


@pytest.mark.parametrize("level", [1, 3])
def test_the_cut_surface_is_the_surface(level: int) -> None:
    """Coarse faces with many shapes each, and fine ones: closed, manifold, as large, each shape's part as its patch."""
    mesh = sb.Mesh(*meshes.icosphere(level))
    placements = apart(mesh, 60, 0.12)
    mapped = sb.map_shapes(mesh, SHAPES, placements)
    cut = mapped.cut()
    whole = sb.Mesh(cut.vertices, cut.triangles)
    assert whole.genus == 0 and not whole.boundary_loops and whole.area == pytest.approx(mesh.area, rel=1e-12)
    assert np.array_equal(cut.vertices[: len(mesh.vertices)], mesh.vertices)
    assert np.array_equal(cut.vertex_origin[: len(mesh.vertices)], np.arange(len(mesh.vertices)))
    areas = triangle_areas(cut.vertices, cut.triangles)
    by_face = np.bincount(cut.triangle_face, areas)
    assert np.allclose(by_face, triangle_areas(mesh.vertices, mesh.triangles), rtol=1e-9)
    for i in laid(mapped):
        patch = mapped.patch(i)
        assert areas[cut.triangle_shape == i].sum() == pytest.approx(
            triangle_areas(patch.vertices, patch.triangles).sum(), rel=1e-9
        )
    patches = mapped.patches()
    assert np.array_equal(np.unique(patches.triangle_shape), laid(mapped))
    assert len(patches.triangles) == (cut.triangle_shape >= 0).sum()


def test_cutting_tells_its_progress_and_stops() -> None:
    mesh = sb.Mesh(*meshes.icosphere(8))  # coarser, and the calls are over in less than ten milliseconds
    mapped = sb.map_shapes(mesh, SHAPES, apart(mesh, 60, 0.15))
    check_progress_and_cancel(lambda job: mapped.cut(job=job), 0.2)
    check_progress_and_cancel(lambda job: mapped.patches(job=job), 0.1)


def test_overlapping_shapes_cannot_be_cut_together() -> None:
    mesh = sb.Mesh(*meshes.grid(8, 8))
    twice = sb.Placements([0, 0], sb.SurfacePoints([48, 48], [[0.3, 0.3, 0.4], [0.2, 0.3, 0.5]]), [0, 1.0], [0.2, 0.2])
    mapped = sb.map_shapes(mesh, sb.Shape.star(), twice)
    with pytest.raises(sb.InputError, match="shapes 0 and 1 overlap in face"):
        mapped.cut()
    assert len(mapped.patch(0).triangles) > 0


def test_what_vertices_know() -> None:
    mesh = sb.Mesh(*meshes.grid(50, 50, 0.2))
    placements = apart(mesh, 12, 0.08)
    mapped = sb.map_shapes(mesh, SHAPES, placements)
    inside, wide = mapped.attributes(), mapped.attributes(0.05)
    for i in laid(mapped):
        shape = SHAPES[placements.shape[i]]
        mine = np.flatnonzero(wide.placement == i)
        assert np.abs(mesh.vertices[mine, :2] - in_plane(mesh, wide.uv[mine], placements, i)).max() < 1e-9
        assert np.array_equal(shape.contains(wide.uv[mine]), wide.distance[mine] < 0)
        assert np.array_equal(mine[wide.distance[mine] < 0], np.flatnonzero(inside.placement == i))
        corners = np.concatenate([in_plane(mesh, loop, placements, i) for loop in shape.loops])
        nearest = np.linalg.norm(mesh.vertices[mine, None, :2] - corners, axis=2).min(axis=1)
        assert (np.abs(wide.distance[mine]) <= nearest + 1e-9).all()
    assert np.isinf(wide.distance[wide.placement < 0]).all()
    assert (np.abs(wide.distance[wide.placement >= 0]) < 0.09).all()
    covered = sum(shape_area(mapped, i) for i in laid(mapped))
    assert (inside.placement >= 0).mean() == pytest.approx(covered, rel=0.1)


def test_objects_and_frames_follow_the_surface() -> None:
    vertices, triangles = meshes.icosphere(4)
    mesh, grown = sb.Mesh(vertices, triangles), sb.Mesh(vertices * [1, 1, 2], triangles)
    placements = scattered(mesh, 20, 0.2)
    mapped = sb.map_shapes(mesh, SHAPES, placements)
    points = np.array([[0, 0, 0], [0.3, 0.1, 0.5], [-0.2, 0.2, -0.25]])
    for i in laid(mapped):
        bent = mapped.conform(points, i)
        assert np.allclose(bent.heights, 0.2 * points[:, 2])
        assert np.linalg.norm(bent.points, axis=1) == pytest.approx(1 + bent.heights, abs=0.003)
        assert np.allclose(bent.positions(mesh), bent.points, atol=1e-12)
        assert np.abs(bent.positions(grown)[0] - bent.points[0] * [1, 1, 2]).max() < 1e-9
    centers, turns, scales = mapped.frames()
    assert np.allclose(centers, placements.center.positions(mesh)) and np.allclose(np.linalg.norm(turns, axis=1), 1)
    w, x, y, z = turns.T
    up = np.column_stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
    ahead = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
    assert (up * centers).sum(axis=1).min() > 0.99
    assert np.array_equal(np.sign(scales[:, 1]) < 0, placements.mirrored)
    for i in range(20):
        step = sb.trace(mesh, placements.center[i], float(placements.angle[i]), 0.01).points[-1] - centers[i]
        assert step @ ahead[i] > 0.0099
    assert np.allclose(mapped.frames(grown)[0], placements.center.positions(grown))


def test_any_number_of_threads() -> None:
    mesh = sb.Mesh(*meshes.torus(40, 16))
    placements = scattered(mesh, 40, 0.15)
    mapped = [sb.map_shapes(mesh, SHAPES, placements, threads=n) for n in (1, 2, 8)]
    for other in mapped[1:]:
        assert other.failures == mapped[0].failures and np.array_equal(other.stretch, mapped[0].stretch, equal_nan=True)
        for i in laid(other):
            assert all(np.array_equal(a, b) for a, b in zip(other.outline(i), mapped[0].outline(i), strict=True))


def test_bad_input() -> None:
    mesh, other = sb.Mesh(*meshes.grid()), sb.Mesh(*meshes.icosphere(1))
    placement = one(sb.SurfacePoints([40], [[0.3, 0.3, 0.4]]), scale=0.05)
    with pytest.raises(sb.InputError, match="another mesh"):
        sb.map_shapes(mesh, SHAPES, placement, sb.direction_field(other, 2))
    with pytest.raises(sb.InputError, match="limits"):
        sb.map_shapes(mesh, SHAPES, placement, limits=(1.5, 2.0))
    mapped = sb.map_shapes(mesh, SHAPES, placement)
    with pytest.raises(IndexError, match="copy 1 is out of range, there are 1"):
        mapped.patch(1)
    with pytest.raises(sb.InputError, match="not finite"):
        mapped.conform([[0.0, np.nan, 0.0]], 0)
    with pytest.raises(sb.InputError, match="reach"):
        mapped.attributes(-1.0)


def test_a_distribution_hands_out_its_shapes() -> None:
    mesh = sb.Mesh(*meshes.icosphere(4))
    result = sb.distribute(mesh, [STAR_OF_FIVE, FRAME], [20, 10], size=0.15)
    mapped = result.mapped
    assert mapped is result.mapped and len(mapped) == len(result) == 30 and mapped.failures == {}
    points = [(0.0, 0.0, 0.2), (0.3, 0.1, 0.0)]
    assert np.array_equal(result.conform(points, 4), mapped.conform(points, 4).points)
    assert np.array_equal(result.outline(-1)[0], mapped.outline(29)[0])
    whole = mapped.cut()
    assert set(whole.triangle_shape) == set(range(-1, 30))
    assert sb.check_distribution(mesh, result, samples=50_000).ok
