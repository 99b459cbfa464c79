# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of the cells: closed forms on planes, invariants on spheres."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core.results import CellMesh
from saddleback_blender.core.solids.boundary_distance import boundary_distance, find_boundary
from saddleback_blender.core.solids.cell_mesh import CellShape
from tests import synthetic_cells
from tests.made_cells import build_cell_mesh
from tests.synthetic_cells import SplitCells, split_cells, triangle_areas


def strips(columns: int = 41, width: float = 4.0, count: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A rectangle of height 1 in `count` upright strips whose boundaries are mesh lines."""
    vertices, triangles = synthetic_cells.grid(columns, 11, width, 1.0)
    cell = np.floor(vertices[triangles, 0].mean(axis=1) * count / width).astype(np.int32)
    return vertices, triangles, cell


def squares(per_cell: int = 20, count: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A board of count x count unit squares, each of per_cell x per_cell mesh squares."""
    side = per_cell * count + 1
    vertices, triangles = synthetic_cells.grid(side, side, count, count)
    column, row = np.floor(vertices[triangles, :2].mean(axis=1)).astype(np.int32).T
    return vertices, triangles, (row * count + column).astype(np.int32)


def sphere_cells(levels: int = 4, count: int = 30, seed: int = 1) -> SplitCells:
    vertices, triangles = synthetic_cells.sphere(levels)
    sites = np.random.default_rng(seed).choice(len(vertices), count, replace=False)
    return split_cells(vertices, triangles, sites.astype(np.int32))


def build(cells: SplitCells, **lengths: float) -> CellMesh:
    return build_cell_mesh(cells.split_vertices, cells.split_triangles, cells.split_cell, CellShape(**lengths))


def cell_areas(mesh: CellMesh, count: int) -> np.ndarray:
    return np.bincount(mesh.triangle_cell, triangle_areas(mesh.vertices, mesh.triangles), minlength=count)


def edge_uses(triangles: np.ndarray) -> np.ndarray:
    """How many triangles use each edge."""
    pairs = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0, return_counts=True)[1]


def directed_uses(triangles: np.ndarray) -> np.ndarray:
    pairs = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return np.unique(pairs, axis=0, return_counts=True)[1]


def assert_islands(mesh: CellMesh) -> None:
    """No vertex belongs to two cells."""
    owner = np.full(len(mesh.vertices), -1)
    owner[mesh.triangles.ravel()] = np.repeat(mesh.triangle_cell, 3)
    assert (owner[mesh.triangles] == mesh.triangle_cell[:, None]).all()


def signed_volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_without_lengths_the_split_mesh_comes_back_with_shared_vertices() -> None:
    cells = sphere_cells()
    mesh = build(cells)
    assert len(mesh.vertices) == len(cells.split_vertices)
    np.testing.assert_array_equal(mesh.triangles, cells.split_triangles)
    np.testing.assert_array_equal(mesh.triangle_cell, cells.split_cell)
    assert mesh.vanished.size == 0


@pytest.mark.parametrize("gap", [0.003, 0.1, 0.25, 0.6])
def test_gap_takes_half_from_each_side_of_straight_boundaries(gap: float) -> None:
    mesh = build_cell_mesh(*strips(), CellShape(gap=gap))
    # The outer strips lose one side only: the border of the mesh is no boundary of a cell.
    expected = [1 - gap / 2, 1 - gap, 1 - gap, 1 - gap / 2]
    np.testing.assert_allclose(cell_areas(mesh, 4), expected, rtol=1e-12)
    assert_islands(mesh)


def test_gap_on_square_cells_leaves_squares() -> None:
    vertices, triangles, cell = squares(40)
    for gap in (0.1, 0.35):
        mesh = build_cell_mesh(vertices, triangles, cell, CellShape(gap=gap))
        # Interpolation rounds each corner over one mesh square at most, of side 1/40.
        center = cell_areas(mesh, 9)[4]
        assert (1 - gap) ** 2 - 4 / 40**2 <= center <= (1 - gap) ** 2 + 1e-12


def test_distance_is_the_distance_to_the_own_boundary() -> None:
    vertices, triangles, cell = squares(10)
    distance = boundary_distance(vertices, triangles, cell)
    x, y = vertices[:, 0], vertices[:, 1]
    lines = np.stack([abs(x - 1), abs(x - 2), abs(y - 1), abs(y - 2)])
    np.testing.assert_allclose(distance, lines.min(axis=0), atol=1e-12)


def test_distance_matches_brute_force_on_a_plane_of_voronoi_cells() -> None:
    vertices, triangles = synthetic_cells.grid(30, 30)
    sites = np.random.default_rng(3).choice(len(vertices), 12, replace=False).astype(np.int32)
    cells = split_cells(vertices, triangles, sites)
    segments, beside = find_boundary(len(cells.split_vertices), cells.split_triangles, cells.split_cell)
    found = boundary_distance(cells.split_vertices, cells.split_triangles, cells.split_cell)
    owner = np.zeros(len(found), dtype=int)
    owner[cells.split_triangles.ravel()] = np.repeat(cells.split_cell, 3)
    a, b = (cells.split_vertices[segments[:, i]] for i in range(2))
    error = []
    for v in np.setdiff1d(np.arange(len(found)), segments):
        own = (beside == owner[v]).any(axis=1)
        p, along = cells.split_vertices[v] - a[own], (b - a)[own]
        t = np.clip((p * along).sum(axis=1) / (along * along).sum(axis=1), 0, 1)
        error.append(found[v] / np.linalg.norm(p - t[:, None] * along, axis=1).min() - 1)
    assert min(error) > -1e-12  # never too short
    assert np.mean(np.array(error) < 1e-12) > 0.98
    assert max(error) < 0.02


def test_distance_beyond_the_limit_is_left_out_and_within_it_complete() -> None:
    vertices, triangles, cell = strips()
    whole = boundary_distance(vertices, triangles, cell)
    part = boundary_distance(vertices, triangles, cell, 0.25)
    assert np.isinf(part).any()
    np.testing.assert_array_equal(part[whole <= 0.25], whole[whole <= 0.25])


@pytest.mark.parametrize(("levels", "count"), [(1, 40), (2, 60), (3, 200)])
def test_a_gap_takes_its_share_of_cells_as_large_as_the_triangles(levels: int, count: int) -> None:
    """What is left of each, by the gap, its area and the length of its boundary, on 80 to 1,280 triangles."""
    vertices, triangles = synthetic_cells.sphere(levels)
    mesh = sb.Mesh(vertices, triangles)
    graph = sb.SaddleVertexGraph(mesh)
    split = sb.centroidal_voronoi(graph, count=count, max_iterations=15).cells.split()
    parts = split.vertices, split.triangles, split.triangle_cell
    whole = cell_areas(build_cell_mesh(*parts, CellShape()), count)
    size = np.sqrt(whole.mean())
    left = cell_areas(build_cell_mesh(*parts, CellShape(gap=0.1 * size)), count) / whole
    # Of a hexagon 0.82 is left, of a square 0.81, of one a half as large as the mean 0.74.
    assert left.min() > 0.7 and 0.78 < np.median(left) < 0.84
    both = build_cell_mesh(*parts, CellShape(gap=0.1 * size, inset=0.1 * size, thickness=0.05 * size))
    assert not len(both.vanished)
    assert_islands(both)


@pytest.mark.parametrize("inset", [0.05, 0.2])
def test_plateau_height_is_the_thickness_exactly(inset: float) -> None:
    gap, thickness = 0.1, 0.3
    mesh = build_cell_mesh(*strips(), CellShape(gap=gap, inset=inset, thickness=thickness))
    x, z = mesh.vertices[:, 0], mesh.vertices[:, 2]
    depth = np.abs(x[:, None] - np.array([1.0, 2.0, 3.0])).min(axis=1) - gap / 2
    on_border = np.isin(mesh.vertices[:, 1], [0, 1]) | np.isin(x, [0, 4])
    inner = ~on_border
    plateau = inner & (depth >= inset - 1e-12)
    assert plateau.any()
    np.testing.assert_array_equal(z[plateau], thickness)
    np.testing.assert_allclose(z[inner & ~plateau], thickness * depth[inner & ~plateau] / inset, atol=1e-12)


def test_walls_close_raised_cells_without_an_inset() -> None:
    gap, thickness = 0.2, 0.5
    mesh = build_cell_mesh(*strips(), CellShape(gap=gap, thickness=thickness))
    # A box without a floor: top and four walls.
    width = np.array([1 - gap / 2, 1 - gap, 1 - gap, 1 - gap / 2])
    np.testing.assert_allclose(cell_areas(mesh, 4), width + 2 * thickness * (width + 1), rtol=1e-12)
    assert_islands(mesh)


@pytest.mark.parametrize("inset", [0.0, 0.1])
def test_underside_makes_solids_of_known_volume(inset: float) -> None:
    gap, thickness = 0.2, 0.5
    vertices, triangles, cell = strips()
    mesh = build_cell_mesh(vertices, triangles, cell, CellShape(gap, inset, thickness, underside=True))
    assert (edge_uses(mesh.triangles) == 2).all()
    assert (directed_uses(mesh.triangles) == 1).all()
    inner = mesh.triangles[mesh.triangle_cell == 1]  # a rim on two sides, upright ends at the border of the mesh
    expected = thickness * (1 - gap - inset)
    assert signed_volume(mesh.vertices, inner) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("lengths", [(0.02, 0, 0.1), (0.02, 0.03, 0.1), (0, 0.05, 0.1), (0.15, 0.1, 0.02)])
def test_undersides_are_watertight_on_a_sphere(lengths: tuple[float, float, float]) -> None:
    cells = sphere_cells()
    gap, inset, thickness = lengths
    mesh = build(cells, gap=gap, inset=inset, thickness=thickness, underside=True)
    assert (directed_uses(mesh.triangles) == 1).all()
    assert (edge_uses(mesh.triangles) == 2).all()
    assert signed_volume(mesh.vertices, mesh.triangles) > 0


def test_open_cells_on_a_sphere_are_disks_with_one_border() -> None:
    cells = sphere_cells()
    mesh = build(cells, gap=0.05, inset=0.03, thickness=0.05)
    assert_islands(mesh)
    assert edge_uses(mesh.triangles).max() == 2
    for cell in np.unique(mesh.triangle_cell):
        part = mesh.triangles[mesh.triangle_cell == cell]
        euler = len(np.unique(part)) - len(edge_uses(part)) + len(part)
        assert euler == 1


def test_without_gap_the_raised_surface_has_no_crack() -> None:
    mesh = build(sphere_cells(), inset=0.05, thickness=0.1)
    assert (edge_uses(mesh.triangles) == 2).all()
    radius = np.linalg.norm(mesh.vertices, axis=1)
    assert radius.max() == pytest.approx(1.1, abs=2e-3)


def test_every_gap_leaves_less_area_and_never_a_turned_triangle() -> None:
    cells = sphere_cells()
    last = 4 * np.pi
    for gap in (0.01, 0.05, 0.1, 0.2, 0.4):
        mesh = build(cells, gap=gap)
        areas = triangle_areas(mesh.vertices, mesh.triangles)
        assert areas.sum() < last
        last = areas.sum()
        a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
        outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c)
        assert (outward >= 0).all()


def test_vanished_cells_are_reported() -> None:
    cells = sphere_cells()
    mesh = build(cells, gap=0.5)
    left = np.unique(mesh.triangle_cell)
    assert 0 < len(mesh.vanished) < 30
    np.testing.assert_array_equal(np.sort(np.concatenate([left, mesh.vanished])), np.arange(30))
    everything = build(cells, gap=10.0, inset=0.1, thickness=0.1, underside=True)
    assert len(everything.vanished) == 30
    assert len(everything.triangles) == 0
    assert len(everything.vertices) == 0


@pytest.mark.parametrize("levels", [1, 2])
def test_cells_of_a_coarse_mesh_survive_a_narrow_gap(levels: int) -> None:
    """Cells of a few triangles have hardly a vertex off their boundary; the cut gives them one."""
    vertices, triangles = synthetic_cells.sphere(levels)
    cells = split_cells(vertices, triangles, np.arange(0, len(vertices), 2, dtype=np.int32))
    mesh = build(cells, gap=0.02)
    assert mesh.vanished.size == 0
    assert_islands(mesh)
    lost = 1 - cell_areas(mesh, len(cells.cell_area)) / cells.cell_area
    assert (lost > 0).all()
    assert (lost < 0.5).all()


def test_a_cell_of_one_triangle_keeps_its_middle() -> None:
    vertices, triangles = synthetic_cells.sphere(0)
    mesh = build_cell_mesh(vertices, triangles, np.arange(8, dtype=np.int32), CellShape(gap=0.1))
    assert mesh.vanished.size == 0
    inradius = np.sqrt(2) * np.sqrt(3) / 6
    np.testing.assert_allclose(cell_areas(mesh, 8), np.sqrt(3) / 2 * (1 - 0.05 / inradius) ** 2, rtol=1e-12)


def test_one_cell_on_everything_is_untouched_by_gap_and_inset() -> None:
    vertices, triangles = synthetic_cells.sphere(2)
    mesh = build_cell_mesh(
        vertices, triangles, np.zeros(len(triangles), dtype=np.int32), CellShape(gap=0.3, inset=0.2, thickness=0.1)
    )
    assert len(mesh.triangles) == len(triangles)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices - vertices, axis=1), 0.1, rtol=1e-12)


def test_the_answer_does_not_depend_on_the_order_of_the_triangles() -> None:
    cells = sphere_cells()
    order = np.random.default_rng(0).permutation(len(cells.split_triangles))
    shape = CellShape(gap=0.05, inset=0.05, thickness=0.05)
    first = build_cell_mesh(cells.split_vertices, cells.split_triangles, cells.split_cell, shape)
    other = build_cell_mesh(cells.split_vertices, cells.split_triangles[order], cells.split_cell[order], shape)
    np.testing.assert_allclose(cell_areas(first, 30), cell_areas(other, 30), rtol=1e-3)


def test_an_empty_mesh_gives_an_empty_mesh() -> None:
    none = np.empty((0, 3))
    mesh = build_cell_mesh(none, none.astype(np.int32), np.empty(0, dtype=np.int32), CellShape(0.1, 0.1, 0.1, True))
    assert len(mesh.vertices) == len(mesh.triangles) == 0


@pytest.mark.parametrize(("name", "value"), [("gap", -1.0), ("inset", np.nan), ("thickness", np.inf)])
def test_a_length_that_is_none_is_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"^{name} is {value}"):
        CellShape(**{name: value})


def test_domes_are_round_from_the_rim_to_the_middle():
    """A cell's dome is half an ellipse across, as high as the thickness in the middle; the rim stands on the ground."""
    vertices, triangles, cell = squares()
    made = build_cell_mesh(vertices, triangles, cell, CellShape(gap=0.1, thickness=0.2, dome=1.0))
    x, y, z = made.vertices[np.unique(made.triangles[made.triangle_cell == 4])].T
    away = np.maximum(np.minimum(0.45 - abs(x - 1.5), 0.45 - abs(y - 1.5)), 0.0) / 0.45
    assert z.max() == pytest.approx(0.2, rel=0.05) and z[away < 1e-9].max() < 1e-9
    side = (abs(y - 1.5) < 0.11) & (abs(x - 1.5) > 0.25)  # off the ridges, which are rounded
    np.testing.assert_allclose(z[side], 0.2 * np.sqrt(away * (2.0 - away))[side], atol=0.02)
    flat = build_cell_mesh(vertices, triangles, cell, CellShape(gap=0.1, inset=0.1, thickness=0.2, dome=0.5))
    assert 0.15 < np.median(flat.vertices[:, 2]) <= 0.2 + 1e-9
    for wrong in (-0.1, 1.5, np.nan):
        with pytest.raises(ValueError, match="between 0 and 1"):
            CellShape(dome=wrong)


def test_no_line_is_cut_where_a_round_cell_has_no_plateau():
    vertices, triangles, cell = squares()
    plain, bevelled = (
        build_cell_mesh(vertices, triangles, cell, CellShape(gap=0.1, inset=inset, thickness=0.2, dome=1.0))
        for inset in (0.0, 0.1)
    )
    np.testing.assert_array_equal(plain.vertices, bevelled.vertices)
    np.testing.assert_array_equal(plain.triangles, bevelled.triangles)


def test_domes_of_a_sphere_do_not_cross_and_are_closed():
    cells = sphere_cells()
    made = build(cells, gap=0.05, thickness=0.1, dome=1.0, underside=True)
    assert (edge_uses(made.triangles) == 2).all() and not len(made.crossing)
    height = np.linalg.norm(made.vertices, axis=1) - 1.0
    tallest = np.full(30, -1.0)
    np.maximum.at(tallest, np.repeat(made.triangle_cell, 3), height[made.triangles].ravel())
    assert tallest.min() > 0.07 and tallest.max() < 0.101


def test_each_cell_has_its_own_gap_inset_and_thickness() -> None:
    by = np.linspace(0.0, 2.0, 9)
    lengths = {"gap": 0.2, "inset": 0.1, "thickness": 0.3}
    for name in lengths:
        factor = {f"{other}_by": by if other == name else np.ones(9) for other in lengths}
        mesh = build_cell_mesh(*squares(), CellShape(**lengths, **factor))
        assert_islands(mesh)
        assert not len(mesh.thinner) and not len(mesh.crossing) and not len(mesh.vanished)
        for cell in range(9):
            gap, inset, thickness = (length * factor[f"{of}_by"][cell] for of, length in lengths.items())
            places = mesh.vertices[np.unique(mesh.triangles[mesh.triangle_cell == cell])]
            # The board's border is no boundary: a cell has as many sides as it has neighbors.
            sides = np.array([2 - (cell // axis % 3 != 1) for axis in (1, 3)])
            np.testing.assert_allclose(np.ptp(places[:, :2], axis=0), 1.0 - 0.5 * gap * sides, atol=1e-9)
            np.testing.assert_allclose(places[:, 2].max(), thickness, atol=1e-9)
            top = places[places[:, 2] > thickness - 1e-9]
            if thickness > 0.0:
                np.testing.assert_allclose(np.ptp(top[:, :2], axis=0), 1.0 - (0.5 * gap + inset) * sides, atol=1e-9)


def test_cells_without_a_gap_of_different_heights_have_walls_between_them() -> None:
    by = np.arange(1.0, 5.0)
    mesh = build_cell_mesh(*strips(), CellShape(thickness=0.1, thickness_by=by, underside=True))
    assert_islands(mesh)
    assert (edge_uses(mesh.triangles) == 2).all()
    np.testing.assert_allclose(signed_volume(mesh.vertices, mesh.triangles), 0.1 * by.sum(), rtol=1e-9)


def test_paint_too_faint_to_be_seen_is_none() -> None:
    shape = {"gap": 0.2, "inset": 0.1, "thickness": 0.3}
    faint, none = (
        build_cell_mesh(*squares(), CellShape(**shape, **{f"{name}_by": np.full(9, by) for name in shape}))
        for by in (1e-9, 0.0)
    )
    np.testing.assert_array_equal(faint.vertices, none.vertices)
    assert not np.ptp(faint.vertices[:, 2])


def test_domes_of_cells_with_heights_of_their_own() -> None:
    by = np.linspace(0.5, 1.5, 9)
    shape = CellShape(gap=0.1, thickness=0.2, dome=1.0, gap_by=by, thickness_by=by)
    mesh = build_cell_mesh(*squares(), shape)
    for cell in range(9):
        places = mesh.vertices[np.unique(mesh.triangles[mesh.triangle_cell == cell])]
        assert 0.95 * 0.2 * by[cell] <= places[:, 2].max() <= 0.2 * by[cell] + 1e-12


def test_a_cell_that_is_all_of_its_part_is_as_high_all_over_beside_domes_of_others() -> None:
    vertices, triangles, cells = strips()
    lone, lone_triangles = synthetic_cells.grid(5, 5, 1.0, 1.0)
    mesh = build_cell_mesh(
        np.concatenate([vertices, lone + (9.0, 0.0, 0.0)]),
        np.concatenate([triangles, lone_triangles + len(vertices)]),
        np.concatenate([cells, np.full(len(lone_triangles), 4, np.int32)]),
        CellShape(gap=0.1, inset=0.1, thickness=0.2, dome=1.0),
    )
    assert np.isfinite(mesh.vertices).all()
    corners = mesh.vertices[mesh.triangles[mesh.triangle_cell == 4]].reshape(-1, 3)
    up = corners[corners[:, 2] > 0.0]
    np.testing.assert_allclose(up[:, 2], 0.2, atol=1e-9)
    others = mesh.vertices[mesh.triangles[mesh.triangle_cell < 4]]
    assert 0.15 < others[..., 2].max() <= 0.2 + 1e-12
