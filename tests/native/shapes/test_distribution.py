# SPDX-License-Identifier: MIT
"""Distribution: nothing collides, and what was asked for is what lies there."""

from __future__ import annotations

import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cancelling import seconds_to_stop
from tests.native.laid_shapes import (
    CRESCENT,
    DISK,
    FRAME,
    NEEDLE,
    SQUARE,
    STAR,
    collisions,
    laid_flat,
    plane,
    ring,
    same,
)


@pytest.mark.parametrize(("shape", "least"), [(STAR, 1.2), (DISK, 1.2)])
def test_packed_is_denser(shape, least) -> None:
    mesh, field = ring()
    loose = sb.distribute(mesh, shape, field=field, size=0.16, maximal=True, tolerance=0.05)
    packed = sb.distribute(mesh, shape, field=field, size=0.16, mode="packed", maximal=True, tolerance=0.05)
    assert len(packed) > least * len(loose)


@pytest.mark.parametrize("case", [c for c in meshes.good() if c.name != "needles"], ids=str)
def test_the_checker_finds_nothing(case) -> None:
    radius = 0.15 * np.sqrt(case.mesh.area)
    result = sb.distribute(case.mesh, [STAR, DISK, FRAME], size=radius, size_range=(0.4, 1), mirror=True, seed=3)
    assert len(result) >= 1
    report = sb.check_distribution(case.mesh, result, samples=20_000)
    assert report.ok, report


def test_the_result_does_not_depend_on_threads() -> None:
    mesh, field = ring()
    results = [
        sb.distribute(
            mesh,
            [STAR, NEEDLE],
            field=field,
            size=0.3,
            size_range=(0.5, 1),
            threads=threads,
            maximal=True,
            tolerance=0.2,
        )
        for threads in (1, 2, 3)
    ]
    assert same(results[0], results[1]) and same(results[0], results[2]) and len(results[0]) > 50
    again = sb.distribute(mesh, [STAR, NEEDLE], field=field, size=0.3, size_range=(0.5, 1), seed=1)
    assert not same(results[0], again)


def test_counts_are_met_and_kept() -> None:
    mesh, field = ring()
    result = sb.distribute(mesh, [STAR, NEEDLE, DISK], [30, 50, 0], field, size=0.1)
    assert np.bincount(result.placements.shape, minlength=3).tolist() == [30, 50, 0]
    assert result.stop_reason == "counts" and result.certificate is None
    too_many = sb.distribute(mesh, DISK, 10_000, field, size=0.2, maximal=True, tolerance=0.05)
    assert too_many.stop_reason == "full" and len(too_many) < 200 and too_many.certificate.cells > 0


@pytest.mark.parametrize("counts", [None, 200, 100_000])
def test_shares_are_kept_even_where_room_runs_out(counts) -> None:
    mesh, field = ring()
    shares = np.array([5.0, 3.0, 2.0])
    result = sb.distribute(mesh, [STAR, NEEDLE, DISK], counts, field, size=0.1, shares=shares)
    found = np.bincount(result.placements.shape, minlength=3)
    assert np.abs(found / found.sum() - shares / 10).max() < 0.02 and found.sum() >= 150

    if counts == 200:
        assert found.tolist() == [100, 60, 40] and result.stop_reason == "counts"
    else:
        assert result.stop_reason == "tired"


def test_long_copies_bend_along_the_field() -> None:
    mesh, field = plane(True)
    strap = sb.Shape(np.array([[-1, -0.1], [1, -0.1], [1, 0.1], [-1, 0.1]]))
    for gap in (0.0, 0.004):
        result = sb.distribute(mesh, strap, 60, field, size=0.11, bend=True, gap=gap, seed=3)
        assert len(result) > 40 and result.field is field
        report = sb.check_distribution(mesh, result, samples=50_000)
        assert report.ok, report
        alone = sb.map_shapes(mesh, result.shapes, result.placements, field)
        assert all(np.array_equal(result.outline(i)[0], alone.outline(i)[0]) for i in range(0, len(result), 7))
    straight = sb.distribute(mesh, strap, 60, field, size=0.11, seed=3)
    bent = sb.map_shapes(mesh, straight.shapes, straight.placements, field)
    assert straight.field is None and not sb.check_distribution(mesh, bent, samples=10_000).ok


def test_placement_files_keep_what_copies_bend_along(tmp_path) -> None:
    mesh, field = plane(True)
    result = sb.distribute(mesh, NEEDLE, 20, field, size=0.1, bend=True)
    bent, straight = tmp_path / "bent.json", tmp_path / "straight.json"
    sb.write_placements(bent, mesh, result.shapes, result.placements, result.field)
    sb.write_placements(straight, mesh, result.shapes, result.placements)
    read = sb.read_placement_field(bent, mesh)
    assert np.array_equal(read.angles, field.angles) and np.array_equal(read.turns, field.turns)
    assert read.symmetry == 1 and read.singularities == field.singularities
    shapes, placements = sb.read_placements(bent, mesh)
    again = sb.map_shapes(mesh, shapes, placements, read)
    assert all(np.array_equal(again.outline(i)[0], result.outline(i)[0]) for i in range(len(result)))
    assert sb.read_placement_field(straight, mesh) is None
    turns = field.turns.copy()
    turns[3, 1] += 0.1
    with pytest.raises(sb.InputError, match="not opposite"):
        sb.DirectionField.from_turns(mesh, field.angles, turns)
    with pytest.raises(sb.InputError, match="symmetry: wanted 1, 2 or 4"):
        sb.DirectionField.from_turns(mesh, field.angles, field.turns, 3)
    with pytest.raises(sb.InputError, match=r"turns: value 2000 at .* is not finite or beyond 1000"):
        sb.DirectionField.from_turns(mesh, field.angles, opposite_turns(mesh, 2e3))
    with pytest.raises(sb.InputError, match=r"angles: value 1e\+30 at \[0\] is not finite or beyond 1e6"):
        sb.DirectionField.from_turns(mesh, field.angles * 0 + 1e30, field.turns)
    with pytest.raises(
        sb.InputError, match=r"across edge 1 of face 6 the field turns to 0[.]2 radians beside that of face 9"
    ):
        sb.DirectionField.from_turns(mesh, field.angles + 0.2 * (np.arange(len(field.angles)) == 9), field.turns)


def opposite_turns(mesh: sb.Mesh, size: float) -> np.ndarray:
    """(F, 3) turns of one size across every edge between two faces, 0 on the boundary."""
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=-1)
    count = np.bincount((ends.min(axis=-1) * len(mesh.vertices) + ends.max(axis=-1)).ravel())
    inner = count[ends.min(axis=-1) * len(mesh.vertices) + ends.max(axis=-1)] == 2
    return np.where(inner, np.where(ends[..., 0] < ends[..., 1], size, -size), 0.0)


def test_copies_point_along_the_field() -> None:
    mesh, field = ring()
    placements = sb.distribute(mesh, CRESCENT, field=field, size=0.1).placements
    corners = mesh.vertices[mesh.triangles[placements.center.faces]]
    x = corners[:, 1] - corners[:, 0]
    x /= np.linalg.norm(x, axis=1)[:, None]
    normal = np.cross(x, corners[:, 2] - corners[:, 0])
    y = np.cross(normal / np.linalg.norm(normal, axis=1)[:, None], x)
    axis = x * np.cos(placements.angle)[:, None] + y * np.sin(placements.angle)[:, None]
    along = (axis * field.directions(placements.center)).sum(axis=1)
    assert np.abs(along) == pytest.approx(1, abs=1e-9)
    assert 0.2 < (along > 0).mean() < 0.8  # lines have two ends, the crescent one


def test_strands_that_are_narrower_than_the_shapes_are_soon_given_up() -> None:
    vertices, triangles = meshes.grid(2, 25)
    strands = np.concatenate([vertices * (0.004, 0.6, 1) + (0.01 * i, 0, 0) for i in range(50)])
    mesh = sb.Mesh(strands, np.concatenate([triangles + i * len(vertices) for i in range(50)]))
    for mode in (0.0, 1.0):
        result = sb.distribute(mesh, sb.Shape.disk(), 100, size=0.0021, mode=mode)  # 0.0042 wide
        assert not len(result.placements) and result.stop_reason == "tired"
        places = mesh.area / (sb.Shape.disk().area * 0.0021**2)
        assert sum(result.rejections.values()) <= 11 * places  # without a bound it is 200
    assert len(sb.distribute(mesh, sb.Shape.disk(), 100, size=0.0019).placements) == 100


def test_a_gap_is_kept() -> None:
    mesh, field = plane(True)
    for gap in (0.01, 0.05):
        result = sb.distribute(mesh, STAR, field=field, size=0.07, gap=gap, size_range=(0.5, 1))
        copies = laid_flat(result)
        corners = [np.concatenate(s.loops) for s in copies]
        edges = [np.concatenate([np.roll(loop, -1, axis=0) for loop in s.loops]) for s in copies]
        nearest = np.inf
        for i, own in enumerate(corners):
            for j, begin in enumerate(corners):
                if i != j:
                    along = edges[j] - begin
                    arm = own[:, None] - begin
                    share = np.clip((arm * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
                    nearest = min(nearest, np.linalg.norm(arm - share[..., None] * along, axis=2).min())
        assert gap <= nearest < 1.5 * gap + 0.02
        assert len(result) > 20


def test_forbidden_faces_and_rims_are_kept_free() -> None:
    mesh, field = plane()
    centers = mesh.vertices[mesh.triangles].mean(axis=1)
    forbidden = np.hypot(centers[:, 0] - 0.4, centers[:, 1] - 0.5) < 0.25
    result = sb.distribute(mesh, DISK, field=field, size=0.06, forbidden=forbidden, maximal=True)
    places = result.placements.center.positions(mesh)[:, :2]
    assert (np.hypot(places[:, 0] - 0.4, places[:, 1] - 0.5) > 0.25 + 0.02).all()
    assert (np.abs(places - 0.5) <= 0.44).all() and len(result) > 20
    assert result.rejections["boundary"] + result.rejections["forbidden"] > 0
    free = sb.distribute(mesh, DISK, field=field, size=0.06, maximal=True)
    assert len(free) > len(result)


def test_many_shapes_in_one_face() -> None:
    mesh = sb.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    field = sb.direction_field(mesh, 1, {})
    result = sb.distribute(mesh, [STAR, FRAME, DISK], field=field, size=0.06, size_range=(0.5, 1))
    copies = laid_flat(result)
    assert len(result) > 60 and collisions(copies) == 0


def test_small_ones_lie_in_holes_of_large_ones() -> None:
    mesh, field = plane()
    ring_shape = sb.Shape([SQUARE * 0.7, SQUARE * 0.65])
    result = sb.distribute(mesh, [ring_shape, DISK.moved(0.1)], [6, 400], field, size=0.25, seed=2)
    copies = laid_flat(result)
    assert collisions(copies) == 0
    kinds = result.placements.shape
    middles = result.placements.center.positions(mesh)[:, :2]
    inside = sum(
        (np.abs(middles[kinds == 1] - middle).max(axis=1) < 0.7 * 0.25 / np.sqrt(2)).sum()
        for middle in middles[kinds == 0]
    )
    assert inside > 5


def test_sizes_follow_a_field_of_sizes() -> None:
    mesh, field = plane()
    size = 0.02 + 0.06 * mesh.vertices[:, 0]
    result = sb.distribute(mesh, STAR, field=field, size=size, maximal=True, tolerance=0.05)
    places = result.placements.center.positions(mesh)
    assert result.placements.scale == pytest.approx(0.02 + 0.06 * places[:, 0])
    assert collisions(laid_flat(result)) == 0
    left, right = (places[:, 0] < 0.3).sum(), (places[:, 0] > 0.7).sum()
    assert left > 2.5 * right


def test_numbers_follow_a_density() -> None:
    mesh, field = plane()
    density = 1 + 7 * mesh.vertices[:, 0]
    result = sb.distribute(mesh, [STAR, DISK], [450, 150], field, density, size=0.007)
    assert np.bincount(result.placements.shape).tolist() == [450, 150]
    x = result.placements.center.positions(mesh)[:, 0]
    found = np.histogram(x, 10, (0, 1))[0]
    edges = np.linspace(0, 1, 11)
    wanted = np.diff(edges + 3.5 * edges**2) / 4.5 * 600
    assert np.abs(found - wanted).max() < 10
    quiet = sb.distribute(mesh, DISK, 100, field, np.where(mesh.vertices[:, 0] < 0.5, 0.0, 1.0), size=0.01)
    assert (quiet.placements.center.positions(mesh)[:, 0] > 0.45).all()


def test_coverage_follows_a_ramp() -> None:
    mesh, field = plane()
    result = sb.distribute(mesh, sb.Shape.disk(12), 1150, field, 1 + 7 * mesh.vertices[:, 0], size=0.007)
    assert len(result) == 1150
    x, y = result.placements.center.positions(mesh)[:, :2].T
    angle, radius = np.arange(12) * np.pi / 6, 0.006
    x = x[:, None] + radius * np.cos(angle)
    y = y[:, None] + radius * np.sin(angle)
    found = np.histogram2d(x.ravel(), y.ravel(), [20, 10], [[0, 1], [0, 1]])[0]
    wanted = np.repeat(1 + 7 * (np.arange(20)[:, None] + 0.5) / 20, 10, axis=1)
    assert np.corrcoef(found.ravel(), wanted.ravel())[0, 1] > 0.95


def test_sheets_that_lie_close_do_not_know_each_other() -> None:
    vertices, triangles = meshes.grid(20, 20)
    below = vertices + [0, 0, -1e-4]
    both = sb.Mesh(np.concatenate([vertices, below]), np.concatenate([triangles, triangles[:, ::-1] + len(vertices)]))
    alone = sb.Mesh(vertices, triangles)
    options = {"size": 0.08, "maximal": True, "tolerance": 0.05, "seed": 4}
    one = sb.distribute(alone, STAR, field=sb.direction_field(alone, 1, {}), **options).placements
    two = sb.distribute(both, STAR, field=sb.direction_field(both, 1, {}), **options).placements
    upper = two.center.faces < len(triangles)
    assert np.array_equal(one.center.faces, two.center.faces[upper])
    assert np.array_equal(one.center.barycentric, two.center.barycentric[upper]) and (~upper).sum() > 20


def test_triangulations_of_one_surface_agree() -> None:
    counts = []
    for around, tube in ((40, 20), (70, 35), (140, 70)):
        mesh = sb.Mesh(*meshes.torus(around, tube))
        field = sb.direction_field(mesh, 1, {})
        counts.append(
            np.mean(
                [
                    len(sb.distribute(mesh, DISK, field=field, size=0.1, maximal=True, seed=s, tolerance=0.1))
                    for s in range(3)
                ]
            )
        )
    assert max(counts) < 1.03 * min(counts)


def test_a_graph_stands_for_its_mesh() -> None:
    mesh, field = ring()
    graph = sb.SaddleVertexGraph(mesh, k=10)
    assert same(sb.distribute(graph, STAR, field=field, size=0.2), sb.distribute(mesh, STAR, field=field, size=0.2))


def test_outlines_are_closed_curves_on_the_surface() -> None:
    mesh, field = ring()
    result = sb.distribute(mesh, FRAME, 5, field, size=0.1)
    loops = result.outline(2)
    assert len(loops) == 2 and all(np.isfinite(loop).all() and len(loop) >= 4 for loop in loops)
    lengths = [np.linalg.norm(loop - np.roll(loop, -1, axis=0), axis=1).sum() for loop in loops]
    assert lengths == pytest.approx([0.1 * 8 * 0.7, 0.1 * 8 * 0.4], rel=0.05)
    assert np.array_equal(result.outline(-1)[0], result.outline(4)[0])
    laid = result.conform(FRAME.loops[0], 2)
    assert max(np.linalg.norm(loops[0] - corner, axis=1).min() for corner in laid) < 1e-6
    with pytest.raises(IndexError):
        result.outline(5)


REFUSED = {
    "no shape": ({"shapes": []}, "at least one Shape"),
    "counts of another number": ({"counts": [1, 2, 3]}, "counts has 3 values"),
    "negative count": ({"counts": [-1]}, "negative"),
    "shares of another number": ({"shares": [1, 2]}, "shares has 2 values"),
    "shares all zero": ({"shares": [0]}, "shares: all are zero"),
    "shares negative": ({"shapes": [STAR, DISK], "shares": [1, -1]}, r"shares: -1 at \[1\]"),
    "shares and maximal": ({"shares": [1], "maximal": True}, "shares: a surface that is full"),
    "shares and counts": ({"shapes": [STAR, DISK], "shares": [1, 1], "counts": [1, 1]}, "counts has a value"),
    "bend without a field": ({"bend": True, "field": None}, "bend: wanted a field"),
    "size of another length": ({"size": [1.0, 2.0]}, "size has 2 values"),
    "size zero": ({"size": 0.0}, "size is 0"),
    "larger than the surface": ({"size": 100.0}, "larger than the surface"),
    "range upside down": ({"size_range": (2, 1)}, "no range"),
    "density without counts": ({"density": np.ones(625)}, "counts must tell"),
    "density zero": ({"density": np.zeros(625), "counts": [1]}, "zero everywhere"),
    "density zero, maximal": ({"density": np.zeros(625), "maximal": True}, "zero everywhere"),
    "density not finite": ({"density": np.full(625, np.nan), "counts": [1]}, "not finite"),
    "negative gap": ({"gap": -1}, "gap is -1"),
    "gap wider than the surface": ({"gap": 50.0}, "gap is 50: shape 0 .* larger than the surface, which has 1"),
    "such a gap, maximal": ({"gap": 50.0, "maximal": True}, "gap is 50: shape 0 .* larger than the surface"),
    "unknown mode": ({"mode": "dense"}, "mode: wanted"),
    "packing beyond 1": ({"mode": 1.5}, "mode is 1.5, but must be"),
    "everything forbidden": ({"forbidden": np.ones(1152, bool)}, "no face is left"),
    "forbidden of another length": ({"forbidden": np.ones(3, bool)}, "forbidden has 3"),
    "tolerance": ({"tolerance": 0}, "tolerance is 0"),
    "no field": ({"field": 3}, "field: wanted"),
    "too many kinds": ({"shapes": [STAR] * 70}, "more than the 64"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_bad_input_is_refused(case) -> None:
    mesh, field = plane()
    given, words = REFUSED[case]
    with pytest.raises(sb.InputError, match=words):
        sb.distribute(mesh, **{"shapes": STAR, "field": field, "size": 0.1, **given})


def test_a_field_of_another_mesh_is_refused() -> None:
    with pytest.raises(sb.InputError, match="another mesh"):
        sb.distribute(plane()[0], STAR, field=ring()[1], size=0.1)


def test_a_job_is_cancelled_and_tells_how_far_it_is() -> None:
    mesh, field = ring()
    job = sb.Job()
    sb.distribute(mesh, STAR, field=field, size=0.1, job=job)
    assert job.fraction == 1
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.distribute(mesh, STAR, field=field, size=0.1, maximal=True, job=job)


@pytest.mark.parametrize("options", [{"maximal": True}, {}, {"mode": "packed"}], ids=str)
def test_tiny_shapes_can_be_cancelled_at_once(options: dict[str, object]) -> None:
    """Millions of them: neither are all places held at a time, nor is anything done to all at once."""
    mesh = sb.Mesh(*meshes.icosphere(3))
    field = sb.direction_field(mesh, 2)
    asked = time.perf_counter()
    waited = seconds_to_stop(
        lambda job: sb.distribute(mesh, STAR, field=field, size=1e-3, job=job, **options),  # type: ignore[arg-type]
        lambda job: time.perf_counter() > asked + 0.5,
    )
    assert 0 < waited < 0.5


@pytest.mark.parametrize("options", [{}, {"density": np.arange(162.0)}, {"counts": [500, 500]}])
def test_few_tiny_copies_take_no_longer_the_tinier_they_are(options: dict[str, object]) -> None:
    """By number they need a few candidates each, not as many as cover the surface: a thousand took 10 s."""
    mesh = sb.Mesh(*meshes.icosphere(2))
    shapes = [sb.Shape.disk()] * (2 if "counts" in options else 1)
    began = time.process_time()
    laid = sb.distribute(mesh, shapes, size=1e-5, threads=1, **{"counts": 1000, **options})
    assert len(laid.placements) == 1000
    assert time.process_time() - began < 2


@pytest.mark.parametrize("unit", [1e-323, 1e308])
def test_only_ratios_of_shares_count(unit: float) -> None:
    mesh = sb.Mesh(*meshes.icosphere(2))
    result = sb.distribute(mesh, [STAR, DISK], 8, size=0.05, shares=[unit, unit])
    assert np.bincount(result.placements.shape).tolist() == [4, 4]


@pytest.mark.parametrize("unit", [1e200, 1e-300, 1e-310])
def test_only_ratios_of_densities_count(unit: float) -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    density = 1 + mesh.vertices[:, 2]
    density[density < 0.1] = 0
    wanted, found = (sb.distribute(mesh, STAR, 30, density=density * u, size=0.1) for u in (1.0, unit))
    np.testing.assert_allclose(
        found.placements.center.positions(mesh), wanted.placements.center.positions(mesh), atol=1e-9
    )
