# SPDX-License-Identifier: MIT
"""Super-patches: a polygon a cell, sharp edges among their sides, as many as an error needs."""

from __future__ import annotations

import threading
import time
from collections import Counter
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from saddleback import patches
from tests import meshes


def lid_with_hole() -> sb.Mesh:
    """A box through which a square hole leads: its lids are rings."""
    occupied = np.ones((3, 3, 1), bool)
    occupied[1, 1, 0] = False
    return sb.Mesh(*meshes.voxels(occupied))


def closed_cylinder(around: int = 48) -> sb.Mesh:
    """A round tin: two fans and a ring."""
    angle = 2 * np.pi * np.arange(around) / around
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    vertices = np.vstack([ring, ring + [0, 0, 2], [[0, 0, 0], [0, 0, 2]]])
    i, n = np.arange(around), (np.arange(around) + 1) % around
    below, above = np.full(around, 2 * around), np.full(around, 2 * around + 1)
    fans = [np.stack([n, i, below], axis=1), np.stack([i + around, n + around, above], axis=1)]
    wall = [np.stack([i, n, n + around], axis=1), np.stack([i, n + around, i + around], axis=1)]
    return sb.Mesh(vertices, np.vstack(fans + wall))


def scratched(length: int, at_rim: bool = False) -> tuple[sb.Mesh, NDArray[np.int32]]:
    """A flat square and edges that lie within it, or begin at its rim, and are barriers."""
    size = 12
    mesh = sb.Mesh(*meshes.grid(size, size))
    first = 6 * size + (0 if at_rim else 4)
    line = np.arange(first, first + length + 1, dtype=np.int32)
    return mesh, np.stack([line[:-1], line[1:]], axis=1)


def faces_of(polygons: sb.CellPolygons) -> list[list[int]]:
    return [part.tolist() for part in np.split(polygons.corners, polygons.offsets[1:-1])]


def check_closed(mesh: sb.Mesh, polygons: sb.CellPolygons) -> None:
    """Sides run once in each direction, but at the border; the topology is the surface's."""
    faces = faces_of(polygons)
    sides = Counter((a, b) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True))
    assert max(sides.values()) == 1
    assert all(len(set(face)) == len(face) >= 3 for face in faces)
    assert bool(mesh.boundary_loops) == any(side[::-1] not in sides for side in sides)
    edges = {(min(side), max(side)) for side in sides}
    chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
    assert len(polygons.vertices) - len(edges) + len(faces) == chi


def length_along(polygons: sb.CellPolygons) -> float:
    """Length of all sides along barriers, those between two polygons counted twice."""
    corners = polygons.vertices[polygons.corners]
    after = np.arange(1, len(corners) + 1)
    after[polygons.offsets[1:] - 1] = polygons.offsets[:-1]
    return float(np.linalg.norm(corners[after] - corners, axis=1)[polygons.is_barrier].sum())


def check_sharp(mesh: sb.Mesh, patches: sb.SuperPatches) -> None:
    """Sides along sharp edges are as long as those: each twice, or once at the border."""
    ends = mesh.vertices[patches.sharp_edges]
    times = np.where(np.array([mesh_is_border(mesh, *edge) for edge in patches.sharp_edges.tolist()], bool), 1, 2)
    wanted = (times * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)).sum()
    assert length_along(patches.polygons) == pytest.approx(wanted, rel=1e-6)


def mesh_is_border(mesh: sb.Mesh, a: int, b: int) -> bool:
    return any(a in loop and b in loop for loop in (set(loop.tolist()) for loop in mesh.boundary_loops))


def test_a_cube_is_six_squares() -> None:
    mesh = sb.Mesh(*meshes.subdivide(*meshes.subdivide(*meshes.cube())))
    patches = sb.super_patches(mesh, error=1e-3)
    assert sorted(len(face) for face in patches.faces) == [4] * 6
    for values in (patches.deviation, patches.corner_distance, patches.region_distance):
        np.testing.assert_allclose(values, 0, atol=1e-9)
    assert patches.hausdorff(mesh, 1e-3).distance < 1e-6
    spread = {tuple(np.round(normal, 9) + 0.0) for normal in patches.normals.tolist()}
    assert spread == {tuple(sign * axis) for axis in np.eye(3) for sign in (1, -1)}
    outside = ((patches.centers - mesh.vertices.mean(axis=0)) * patches.normals).sum(axis=1)
    assert (outside > 0).all()
    check_closed(mesh, patches.polygons)
    check_sharp(mesh, patches)


SOLIDS = {
    "cylinder": closed_cylinder(),
    "lid with a hole": lid_with_hole(),
    "stairs": sb.Mesh(*meshes.voxels(np.array([[[1, 1, 1]], [[1, 1, 0]], [[1, 0, 0]]], bool))),
    "sphere": sb.Mesh(*meshes.icosphere(3)),
    "torus": sb.Mesh(*meshes.torus()),
    "two parts": sb.Mesh(*meshes.two_components()),
    "open": sb.Mesh(*meshes.cylinder()),
    "saddle": sb.Mesh(*meshes.saddle()),
}


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("share", [0.05, 0.02])
def test_patches_keep_to_the_error(name: str, share: float) -> None:
    mesh = SOLIDS[name]
    error = share * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    patches = sb.super_patches(mesh, error=error)
    check_closed(mesh, patches.polygons)
    check_sharp(mesh, patches)
    assert patches.hausdorff(mesh, 1e-3).distance <= error
    assert patches.deviation.max() <= error
    assert patches.corner_distance.max() <= error
    assert (patches.corner_distance <= patches.region_distance + 1e-9).all()
    assert len(patches.triangles) == len(patches.polygons.corners) - 2 * len(patches)
    areas = np.linalg.norm(
        np.cross(*np.diff(patches.regions.vertices[patches.regions.triangles], axis=1).transpose(1, 0, 2)), axis=1
    )
    assert areas.sum() / 2 == pytest.approx(mesh.area, rel=1e-9)
    assert set(patches.region_patch.tolist()) == set(range(len(patches)))


def test_flat_faces_are_one_patch_and_a_smaller_error_needs_more() -> None:
    assert len(sb.super_patches(SOLIDS["stairs"], error=0.01)) == 10  # 3 treads, 3 risers, 2 sides, below, behind
    counts = [len(sb.super_patches(SOLIDS["sphere"], error=error)) for error in (0.2, 0.1, 0.05)]
    assert counts[0] < counts[1] < counts[2]


@pytest.mark.parametrize("count", [6, 40])
def test_a_count_gives_even_cells(count: int) -> None:
    mesh = sb.Mesh(*meshes.subdivide(*meshes.subdivide(*meshes.cube())))
    patches = sb.super_patches(mesh, count)
    assert len(patches) == count
    check_closed(mesh, patches.polygons)
    check_sharp(mesh, patches)


@pytest.mark.parametrize("length", [1, 2, 4])
@pytest.mark.parametrize("at_rim", [False, True])
@pytest.mark.parametrize("count", [9, 30])
def test_barriers_that_end_within_a_cell_are_sides_all_the_same(length: int, at_rim: bool, count: int) -> None:
    mesh, edges = scratched(length, at_rim)
    barred = sb.add_barriers(mesh, edges=edges)
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(barred.mesh), count=count, max_iterations=10).cells
    polygons, split = barred.polygons(cells)
    assert len(polygons.missing) == 0
    check_closed(mesh, polygons)
    border = 2 * np.ptp(mesh.vertices, axis=0)[:2].sum()
    ends = mesh.vertices[edges]
    assert length_along(polygons) == pytest.approx(border + 2 * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum())
    added = np.unique(split.triangle_cell[split.triangle_cell >= count])
    np.testing.assert_array_equal(polygons.polygon_cell, np.arange(count + len(added)))


def test_thousands_of_loose_barriers_take_no_longer_than_their_cells() -> None:
    """Each end looks at the smaller side of its cut alone."""
    mesh = sb.Mesh(*meshes.icosphere(6))
    barred = sb.add_barriers(mesh, edges=mesh.edges[::7])
    begin = time.process_time()
    graph = sb.SaddleVertexGraph(barred.mesh, threads=1)
    cells = sb.geodesic_voronoi(graph, sb.sample(barred.mesh, 60, one_per_component=True), threads=1)
    between = time.process_time()
    polygons, _ = barred.polygons(cells)
    assert len(polygons.polygon_cell) > 1000
    assert time.process_time() - between < 3 * (between - begin)


def test_without_barriers_the_polygons_are_those_of_the_cells() -> None:
    mesh = SOLIDS["torus"]
    barred = sb.add_barriers(mesh)
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(barred.mesh), count=60, max_iterations=10).cells
    polygons, split = barred.polygons(cells)
    plain = cells.polygons("strict")
    np.testing.assert_array_equal(polygons.corners, plain.corners)
    np.testing.assert_array_equal(polygons.vertices, plain.vertices)
    np.testing.assert_array_equal(split.triangles, cells.split().triangles)
    assert not plain.is_barrier.any()


def test_polygons_become_triangles_with_their_area() -> None:
    patches = sb.super_patches(SOLIDS["lid with a hole"], error=1e-3)
    corners = patches.polygons.vertices[patches.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    along = (areas * patches.normals[patches.triangle_patch]).sum(axis=1)
    assert (along > -1e-12).all()
    assert along.sum() == pytest.approx(SOLIDS["lid with a hole"].area)


def test_threads_do_not_matter() -> None:
    first, second = (sb.super_patches(SOLIDS["torus"], error=0.05, threads=threads) for threads in (1, 2))
    np.testing.assert_array_equal(first.polygons.vertices, second.polygons.vertices)
    np.testing.assert_array_equal(first.polygons.corners, second.polygons.corners)


def test_a_tolerance_is_a_length_that_no_side_leaves() -> None:
    mesh = SOLIDS["sphere"]
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh), count=12, max_iterations=10).cells
    coarse, fine = cells.polygons(bend=np.inf), cells.polygons(bend=np.inf, tolerance=0.01)
    assert len(fine.corners) > 2 * len(coarse.corners)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({}, "count, error: give either one of them"),
        ({"count": 8, "error": 0.1}, "count, error: give either one of them"),
        ({"error": 0.0}, "error: wanted a positive length, got 0.0"),
        ({"error": float("nan")}, "error: wanted a positive length, got nan"),
        ({"count": 3}, "count: 3 cells for 6 parts between sharp edges; use more, or a larger `sharp`"),
        ({"count": 8, "sharp": -1.0}, "sharp: wanted radians from 0 to pi"),
        ({"count": 8, "bend": -1.0}, "bend: wanted a number of 0 or more"),
    ],
)
def test_what_makes_no_sense_is_refused_with_a_sentence(arguments: dict[str, float], sentence: str) -> None:
    with pytest.raises(sb.InputError, match=sentence.replace("(", r"\(")):
        sb.super_patches(sb.Mesh(*meshes.cube()), **arguments)  # type: ignore[arg-type]


def test_an_error_below_what_faces_allow_is_refused() -> None:
    with pytest.raises(sb.InputError, match="needs more patches than the mesh has faces"):
        sb.super_patches(sb.Mesh(*meshes.icosphere(1)), error=1e-9)


def test_cells_of_another_mesh_are_refused() -> None:
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(SOLIDS["sphere"]), np.array([0, 1], np.int32))
    with pytest.raises(sb.InputError, match="cells: of a mesh of"):
        sb.add_barriers(SOLIDS["torus"]).polygons(cells)


def test_a_cancelled_job_is_heard() -> None:
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.super_patches(SOLIDS["sphere"], error=0.01, job=job)


def test_projections_are_watched_and_take_the_threads_that_they_are_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a large mesh they take seconds between two relaxations."""
    asked: list[dict[str, object]] = []

    def project(*arguments: Any, **how: Any) -> sb.SurfacePoints:
        asked.append(how)
        return sb.project(*arguments, **how)

    monkeypatch.setattr(patches, "project", project)
    sb.super_patches(sb.Mesh(*meshes.icosphere(3)), error=0.2, threads=1, job=sb.Job())
    measuring = [how for how in asked if how]
    assert measuring and all(how["threads"] == 1 and isinstance(how["job"], sb.Job) for how in measuring)


def test_the_job_never_goes_back_and_ends_at_1() -> None:
    job, seen, done = sb.Job(), [0.0], threading.Event()

    def watch() -> None:
        while not done.is_set():
            seen.append(job.fraction)
            time.sleep(2e-4)

    watcher = threading.Thread(target=watch)
    watcher.start()
    try:
        sb.super_patches(SOLIDS["sphere"], error=0.02, job=job)
    finally:
        done.set()
        watcher.join()
    assert (np.diff(seen) >= 0).all() and len(set(seen)) > 20
    assert job.fraction == 1


def test_cells_along_a_winding_edge_become_ever_smaller() -> None:
    """A roof whose ridge bends back and forth."""
    size = 24
    vertices, triangles = meshes.grid(size, size)
    x, y = vertices[:, 0], vertices[:, 1]
    vertices[:, 2] = 0.4 * np.abs(x - 0.5 - 0.08 * np.sin(9 * y)) + 0.1 * np.cos(7 * x) * y
    mesh = sb.Mesh(vertices, triangles)
    patches = sb.super_patches(mesh, error=0.004, sharp=0.4)
    check_closed(mesh, patches.polygons)
    assert patches.hausdorff(mesh, 1e-3).distance <= 0.004 and len(patches) < 200
