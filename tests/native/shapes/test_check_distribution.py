# SPDX-License-Identifier: MIT
"""The independent checker: nothing found where there is nothing, and every planted collision found, no other."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import saddleback as sb
from saddleback import check
from tests import meshes
from tests.native.plane_collisions import last_contact

DISK, STAR, LEAF, NEEDLE = sb.Shape.disk(48), sb.Shape.star(5), sb.Shape.leaf(), sb.Shape.needle(8)
RING = sb.Shape([DISK.loops[0], 0.6 * DISK.loops[0]])
SHAPES = [DISK, STAR, LEAF, NEEDLE, RING]
Floats = NDArray[np.float64]
Copy = tuple[int, sb.SurfacePoints, float, float]  # shape, center, angle, scale


def surfaces() -> dict[str, sb.Mesh]:
    return {
        "plane": sb.Mesh(*meshes.grid(40, 40, 0.3)),
        "coarse plane": sb.Mesh(*meshes.grid(4, 4)),
        "cylinder": sb.Mesh(*meshes.cylinder(60, 40)),
        "sphere": sb.Mesh(*meshes.icosphere(5)),
        "torus": sb.Mesh(*meshes.torus(120, 48)),
    }


def placed(copies: list[Copy]) -> sb.Placements:
    shape, centers, angle, scale = zip(*copies, strict=True)
    faces, weights = [c.faces[0] for c in centers], [c.barycentric[0] for c in centers]
    mirrored = np.arange(len(copies)) % 3 == 0
    return sb.Placements(shape, sb.SurfacePoints(faces, weights), angle, scale, mirrored)


def rim(mesh: sb.Mesh) -> Floats:
    """Points all along the boundary; one far away where there is none."""
    steps = np.linspace(0, 1, 20)[:, None, None]
    sides = [
        mesh.vertices[loop] * (1 - steps) + np.roll(mesh.vertices[loop], -1, 0) * steps for loop in mesh.boundary_loops
    ]
    return np.concatenate([side.reshape(-1, 3) for side in sides]) if sides else np.full((1, 3), np.inf)


def spots(mesh: sb.Mesh, scale: float, apart: float) -> sb.SurfacePoints:
    """Places so far from each other, and half as far from the boundary, in units of scale."""
    points, ends = sb.sample(mesh, 2000, seed=3), rim(mesh)
    xyz = points.positions(mesh)
    kept: list[int] = []
    for i, place in enumerate(xyz):
        far = np.linalg.norm(ends - place, axis=1).min() > 0.51 * apart * scale
        if far and all(np.linalg.norm(place - xyz[j]) > apart * scale for j in kept):
            kept.append(i)
    return sb.SurfacePoints(points.faces[kept], points.barycentric[kept])


@pytest.mark.parametrize("name", ["plane", "coarse plane", "cylinder", "sphere", "torus"])
def test_nothing_is_found_where_there_is_nothing(name: str) -> None:
    mesh = surfaces()[name]
    scale = 0.04 * mesh.area**0.5
    rng = np.random.default_rng(1)
    copies: list[Copy] = [
        (k % len(SHAPES), center, float(rng.uniform(0, 6)), scale) for k, center in enumerate(spots(mesh, scale, 2.05))
    ]
    # A star in the hole of each ring: it lies in its outline, but not in the shape.
    copies += [(1, c, 0.0, 0.5 * scale) for shape, c, _, _ in copies if shape == 4]
    assert len(copies) > 30
    mapped = sb.map_shapes(mesh, SHAPES, placed(copies))
    report = sb.check_distribution(mesh, mapped, samples=200_000)
    assert report and report.ok and report.faults == [] and "no fault" in str(report)
    assert report.coverage == pytest.approx(report.patch_coverage, abs=4 * report.coverage_error + 1e-6)
    covered = sum(SHAPES[shape].area * size**2 for shape, _, _, size in copies) / mesh.area
    assert report.patch_coverage == pytest.approx(covered, rel=1e-6 if name[-5:] in ("plane", "inder") else 0.02)
    assert (
        np.nanmin(mapped.stretch) <= report.stretch[0] + 1e-6 and report.stretch[1] <= np.nanmax(mapped.stretch) + 1e-6
    )


def overlap(mesh: sb.Mesh, center: sb.SurfacePoints, scale: float, rng: np.random.Generator) -> tuple[Copy, Copy]:
    """A tip that reaches into a disk by 2 % of its radius."""
    angle, kind = float(rng.uniform(0, 6)), int(rng.integers(1, 4))
    line = sb.trace(mesh, center, angle, 1.98 * scale)
    return (kind, center, angle, scale), (0, line.surface[-1:], line.end_angle + np.pi, scale)


def nested(mesh: sb.Mesh, center: sb.SurfacePoints, scale: float, rng: np.random.Generator) -> tuple[Copy, Copy]:
    angle, kind = float(rng.uniform(0, 6)), int(rng.integers(0, 5))
    line = sb.trace(mesh, center, angle, 0.5 * scale)
    return (kind, line.surface[-1:], angle, 0.3 * scale), (0, center, 0.0, scale)


def crossed(mesh: sb.Mesh, center: sb.SurfacePoints, scale: float, rng: np.random.Generator) -> tuple[Copy, Copy]:
    angle = float(rng.uniform(0, 6))
    return (3, center, angle, scale), (int(rng.integers(1, 4)), center, angle + float(rng.uniform(0.5, 2.5)), scale)


@pytest.mark.parametrize("name", ["plane", "coarse plane", "cylinder", "sphere", "torus"])
def test_every_planted_collision_is_found(name: str) -> None:
    mesh = surfaces()[name]
    scale = 0.016 * mesh.area**0.5
    rng = np.random.default_rng(7)
    plants = (overlap, nested, crossed)
    pairs = [plants[k % 3](mesh, center, scale, rng) for k, center in enumerate(spots(mesh, scale, 6.2)[:42])]
    copies = [copy for pair in pairs for copy in pair]
    assert len(pairs) == 42
    report = sb.check_distribution(mesh, sb.map_shapes(mesh, SHAPES, placed(copies)), samples=300_000)
    wanted = {(2 * i, 2 * i + 1) for i in range(len(pairs))}
    found = {kind: {fault[1:3] for fault in report.faults if fault[0] == kind} for kind, *_ in report.faults}
    assert found.keys() == {"crossing", "nesting", "covered_twice"}
    assert found["crossing"] | found["nesting"] == wanted
    assert found["crossing"] >= {(2 * i, 2 * i + 1) for i in range(len(pairs)) if i % 3 != 1}
    assert found["nesting"] >= {(2 * i, 2 * i + 1) for i in range(1, len(pairs), 3)}
    # The samples alone find most of those that are not too small for them.
    assert found["covered_twice"] <= wanted and len(found["covered_twice"]) > 20


@pytest.mark.parametrize("name", ["plane", "cylinder"])
def test_every_pair_pushed_together_by_two_percent_is_found(name: str) -> None:
    """Where polygons of the plane touch last is known from their corners and edges; these lie 2 % of r nearer.

    Half of the pairs overlap so, a quarter lie one in the other, a quarter across each other. As many that are 2 % of r
    apart are no fault.
    """
    mesh, rng = surfaces()[name], np.random.default_rng(11)
    scale = 0.008 * mesh.area**0.5
    centers = spots(mesh, scale, 6.3)
    kinds = ["overlap", "nesting", "overlap", "crossing"] * 25
    pairs: list[tuple[Copy, Copy]] = []
    for kind, near, center in zip(kinds * 2, [True] * 100 + [False] * 100, centers, strict=False):
        one, other = (3, 3) if kind == "crossing" else (0, 2) if kind == "nesting" else rng.integers(0, 4, 2).tolist()
        small = scale * float(rng.uniform(0.1, 0.4) if kind == "nesting" else rng.uniform(0.5, 1))
        angle, turn, towards = rng.uniform(0, 2 * np.pi, 3)
        reach = last_contact(
            SHAPES[one], SHAPES[other], *(np.array([x]) for x in (towards - angle, turn, scale, small))
        )
        distance = float(reach[0]) + (-0.02 if near else 0.02) * small
        if near and kind != "overlap":
            distance = rng.uniform(0, 0.5) * scale if kind == "nesting" else 0.0
            turn = angle - towards + (np.pi / 2 if kind == "crossing" else 0.3)  # needles across each other
        line = sb.trace(mesh, center, float(towards), max(distance, 1e-9 * scale))
        pairs.append(
            (
                (one, center, float(angle), scale),
                (other, line.surface[-1:], float(line.end_angle + np.pi - turn), small),
            )
        )
    copies = [copy for pair in pairs for copy in pair]
    assert len(pairs) == 200
    shape, points, angles, scales = zip(*copies, strict=True)
    faces, weights = [p.faces[0] for p in points], [p.barycentric[0] for p in points]
    placements = sb.Placements(shape, sb.SurfacePoints(faces, weights), angles, scales)
    report = sb.check_distribution(mesh, sb.map_shapes(mesh, SHAPES, placements), samples=0)
    found = {kind: {fault[1:3] for fault in report.faults if fault[0] == kind} for kind, *_ in report.faults}
    planted = {kind: {(2 * i, 2 * i + 1) for i in range(100) if kinds[i] == kind} for kind in set(kinds)}
    assert found.keys() == {"crossing", "nesting"}
    assert found["crossing"] == planted["overlap"] | planted["crossing"]
    assert found["nesting"] - found["crossing"] == planted["nesting"]


def in_the_plane(mesh: sb.Mesh, poses: list[tuple[int, float, float, float]]) -> sb.Placements:
    """(shape, x, y, scale) on a mesh of the plane z = 0, all pointing along x."""
    centers = sb.project(mesh, [(x, y, 0) for _, x, y, _ in poses])
    corners = mesh.vertices[mesh.triangles[centers.faces]]
    along = corners[:, 1] - corners[:, 0]
    shape, _, _, scale = zip(*poses, strict=True)
    return sb.Placements(shape, centers, -np.arctan2(along[:, 1], along[:, 0]), scale)


def disk_at(x: float, y: float, radius: float) -> Floats:
    return radius * sb.Shape.disk(12).loops[0] + (x, y)


TWO = sb.Shape(disk_at(0, 0, 0.5), disk_at(2, 0, 0.1))  # two parts


@pytest.mark.parametrize("cells", [2, 12, 101])
@pytest.mark.parametrize("is_turned", [False, True])
def test_a_part_of_a_shape_within_another(cells: int, is_turned: bool) -> None:
    """Whichever part it is, and whichever of the two shapes comes first."""
    mesh = sb.Mesh(*meshes.grid(cells, cells))
    shapes = [TWO, DISK, RING]
    for shape, x, scale, is_guilty in (
        (1, 0.7, 0.05, True),  # about the second part
        (1, 0.3, 0.15, True),  # about the first
        (2, 0.7, 0.06, False),  # the second lies in the hole of a ring
        (2, 0.82, 0.15, True),  # and in its band
        (1, 0.5, 0.04, False),  # between the two
    ):
        poses = [(0, 0.3, 0.5, 0.2), (shape, x, 0.5, scale)]
        mapped = sb.map_shapes(mesh, shapes, in_the_plane(mesh, poses[::-1] if is_turned else poses))
        report = sb.check_distribution(mesh, mapped, samples=0)
        assert {fault[:3] for fault in report.faults} == ({("nesting", 0, 1)} if is_guilty else set())
        if is_guilty:
            with pytest.raises(sb.InputError, match="shapes 0 and 1 overlap in face"):
                mapped.cut()
        else:
            assert (mapped.cut().triangle_shape == 1).any()


def test_every_guilty_pair_is_named_and_no_innocent_one() -> None:
    """Three disks one in the other, beside them a ring about a disk, and one that keeps away from all."""
    mesh = sb.Mesh(*meshes.grid(30, 30))
    poses = [(0, 0.3, 0.3, 0.2), (4, 0.7, 0.7, 0.2), (0, 0.3, 0.3, 0.1), (0, 0.7, 0.7, 0.1), (0, 0.3, 0.3, 0.05)]
    poses += [(0, 0.2, 0.8, 0.1), (0, 0.46, 0.3, 0.1)]  # the last crosses one and only reaches the largest beside
    report = sb.check_distribution(mesh, sb.map_shapes(mesh, SHAPES, in_the_plane(mesh, poses)), samples=0)
    assert {fault[1:3] for fault in report.faults} == {(0, 2), (0, 4), (2, 4), (0, 6), (2, 6)}


@pytest.mark.parametrize("cells", [2, 40])
def test_cut_refuses_what_overlaps_and_names_it(cells: int) -> None:
    mesh = sb.Mesh(*meshes.grid(cells, cells))
    innocent = (0, 0.2, 0.2, 0.1)
    # The same again, one within, a ring whose band holds the rim, one that crosses.
    for second in ((0, 0.6, 0.6, 0.2), (0, 0.6, 0.6, 0.03), (4, 0.6, 0.6, 0.3), (0, 0.75, 0.6, 0.2)):
        mapped = sb.map_shapes(mesh, SHAPES, in_the_plane(mesh, [innocent, (0, 0.6, 0.6, 0.2), second]))
        with pytest.raises(sb.InputError, match="shapes 1 and 2 overlap in face"):
            mapped.cut()


def test_a_face_with_thousands_of_shapes_is_quick() -> None:
    """Every sample was compared with all shapes of its face, and every piece of an outline with all others."""
    mesh = sb.Mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 2, 3)])
    at = (np.arange(50) + 0.5) / 50
    poses = [(0, x + 0.003, y, 0.004) for x in at for y in at if abs(x + 0.003 - y) > 0.006]
    mapped = sb.map_shapes(mesh, SHAPES, in_the_plane(mesh, poses))
    began = time.process_time()
    report = sb.check_distribution(mesh, mapped, samples=200_000)
    assert report.ok
    assert len(poses) > 2300
    assert time.process_time() - began < 6  # minutes, before


def test_what_could_not_be_laid_is_a_fault() -> None:
    mesh = sb.Mesh(*meshes.grid())
    copies: list[Copy] = [
        (0, sb.SurfacePoints([0], [[1, 0, 0]]), 0.0, 0.2),
        (0, sb.SurfacePoints([100], [[1, 0, 0]]), 0.0, 0.1),
    ]
    report = sb.check_distribution(mesh, sb.map_shapes(mesh, SHAPES, placed(copies)), samples=0)
    assert [fault[:3] for fault in report.faults] == [("not_laid", 0, None)] and report.fault_count == 1
    assert report.faults[0][3] == pytest.approx((0, 0, 0)) and not report


def test_a_distribution_is_anything_with_placements_and_shapes() -> None:
    class Distribution:
        shapes = SHAPES

        def __init__(self, placements: sb.Placements) -> None:
            self.placements = placements

    mesh = sb.Mesh(*meshes.icosphere(3))
    center = sb.SurfacePoints([3], [[0.3, 0.3, 0.4]])
    report = sb.check_distribution(mesh, Distribution(placed([(0, center, 0.0, 0.2), (1, center, 0.0, 0.2)])))
    assert not report.ok
    with pytest.raises(sb.InputError, match="wanted a MappedShapes or a distribution"):
        sb.check_distribution(mesh, center)


def test_shapes_that_are_laid_first_are_watched() -> None:
    """A distribution's are laid before they are checked, which may take longer than the check."""
    mesh = sb.Mesh(*meshes.icosphere(5))
    laid = sb.distribute(mesh, sb.Shape.disk(2000), 400, size=0.05)
    job, texts = sb.Job(), set()
    worker = threading.Thread(target=lambda: sb.check_distribution(mesh, laid, samples=0, job=job))
    worker.start()
    while worker.is_alive():
        texts.add(job.text.rstrip("."))
    assert len(texts - {""}) == 2 and job.fraction == 1


def test_the_same_for_any_number_of_threads() -> None:
    mesh = surfaces()["torus"]
    rng = np.random.default_rng(0)
    copies: list[Copy] = [
        (int(rng.integers(0, 5)), c, float(rng.uniform(0, 6)), 0.25) for c in sb.sample(mesh, 60, seed=1)
    ]
    mapped = sb.map_shapes(mesh, SHAPES, placed(copies))
    reports = [sb.check_distribution(mesh, mapped, samples=50_000, threads=n) for n in (1, 2, 8)]
    assert reports[0].fault_count > 10
    for report in reports[1:]:
        assert report.faults == reports[0].faults and report.coverage == reports[0].coverage


def test_bad_input() -> None:
    mesh, other = sb.Mesh(*meshes.grid()), sb.Mesh(*meshes.grid(13, 13))
    mapped = sb.map_shapes(mesh, SHAPES, placed([(0, sb.SurfacePoints([60], [[0.3, 0.3, 0.4]]), 0.0, 0.1)]))
    with pytest.raises(sb.InputError, match="another mesh"):
        sb.check_distribution(other, mapped)
    with pytest.raises(sb.InputError, match="samples"):
        sb.check_distribution(mesh, mapped, samples=-1)


def test_as_a_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    vertices, triangles = meshes.icosphere(3)
    mesh_file, good, bad = tmp_path / "sphere.obj", tmp_path / "good.json", tmp_path / "bad.json"
    lines = ["v " + " ".join(repr(float(x)) for x in v) for v in vertices]
    lines += ["f " + " ".join(str(i + 1) for i in t) for t in triangles]
    mesh_file.write_text("\n".join(lines) + "\n", encoding="ascii")
    mesh = sb.read_mesh(str(mesh_file))
    a, b = sb.SurfacePoints([3], [[0.3, 0.3, 0.4]]), sb.SurfacePoints([700], [[0.3, 0.3, 0.4]])
    for file, second in ((good, b), (bad, a)):
        sb.write_placements(file, mesh, SHAPES, placed([(4, a, 0.1, 0.3), (3, second, 0.3, 0.3)]))
        shapes, placements = sb.read_placements(file, mesh)
        assert [shape.loops[-1].tolist() for shape in shapes] == [shape.loops[-1].tolist() for shape in SHAPES]
        assert placements.angle.tolist() == [0.1, 0.3] and placements.mirrored.tolist() == [True, False]
        assert placements.center.barycentric.tolist() == [[0.3, 0.3, 0.4]] * 2
    assert check.main([str(mesh_file), str(good), "--samples", "1000"]) == 0
    assert "2 shapes" in capsys.readouterr().out
    assert check.main([str(mesh_file), str(bad), "--samples", "1000"]) == 1
    assert "crossing: 0 and 1" in capsys.readouterr().out
    assert check.main([str(mesh_file), str(mesh_file)]) == 2 and "not a file" in capsys.readouterr().err
    with pytest.raises(sb.InputError, match="for a mesh of 642 vertices and 1280 faces, this one has 144 and 242"):
        sb.read_placements(good, sb.Mesh(*meshes.grid()))
