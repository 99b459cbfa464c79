# SPDX-License-Identifier: MIT
"""Cells stretched along a field: how long and which way they are, in space, and what is refused."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.cell_checks import check
from tests.native.exact import random_points

MESH = sb.Mesh(*meshes.icosphere(2))
FIELD = sb.direction_field(MESH, 2)


def hills() -> meshes.Arrays:
    vertices, triangles = meshes.grid(80, 80, jitter=0.3)
    vertices[:, 2] = 0.1 * np.sin(5 * vertices[:, 0]) * np.cos(4 * vertices[:, 1])
    return vertices, triangles


def second_moments(mesh: sb.Mesh, field: sb.DirectionField, cells: sb.GeodesicVoronoi) -> np.ndarray:
    """(n, 2, 2) of the cells in space about their middles, along the field at their sites and across it."""
    split, count = cells.split(), len(cells.areas)
    cell, corners = split.triangle_cell, split.vertices[split.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    middles = [np.bincount(cell, area * corners.mean(axis=1)[:, k], count) for k in range(3)]
    middle = np.stack(middles, axis=1) / np.bincount(cell, area, count)[:, None]
    along = field.vectors[cells.sites.faces]
    face = mesh.vertices[mesh.triangles[cells.sites.faces]]
    normal = np.cross(face[:, 1] - face[:, 0], face[:, 2] - face[:, 0])
    across = np.cross(normal / np.linalg.norm(normal, axis=1)[:, None], along)
    offset = corners - middle[cell][:, None]
    flat = np.stack([np.einsum("tij,tj->ti", offset, axis[cell]) for axis in (along, across)], axis=2)
    mean = flat.mean(axis=1)
    of_triangles = np.einsum("tia,tib->tab", flat, flat) + 9 * np.einsum("ta,tb->tab", mean, mean)
    of_triangles *= (area / 12)[:, None, None]
    moments = np.zeros((count, 2, 2))
    np.add.at(moments, cell, of_triangles)
    return moments


@pytest.mark.parametrize("stretch", [2.0, 5.0])
@pytest.mark.parametrize(
    ("arrays", "count"), [(meshes.icosphere(5), 400), (meshes.torus(120, 60), 250), (hills(), 250)]
)
def test_cells_are_as_long_and_lie_as_asked(arrays, count, stretch):
    mesh = sb.Mesh(*arrays)
    field = sb.direction_field(mesh, 2)
    metric = sb.Mesh(mesh.vertices, mesh.triangles, lengths=sb.anisotropic_metric(mesh, field, stretch))
    assert abs(metric.area / mesh.area - 1) < 0.01
    cells = sb.centroidal_voronoi(sb.SaddleVertexGraph(metric), count=count, max_iterations=60).cells
    moments = second_moments(mesh, field, cells)
    ratios = np.sqrt(moments[:, 0, 0] / moments[:, 1, 1])
    assert abs(np.exp(np.log(ratios).mean()) / stretch - 1) < 0.1
    longest = np.linalg.eigh(moments)[1][:, :, 1]
    turned = np.degrees(np.arctan2(longest[:, 1], longest[:, 0]))
    assert abs((turned + 90) % 180 - 90).mean() < 5


def test_lengths_in_the_plane_are_the_stretched_ones():
    vertices, triangles = meshes.grid(7, 5, jitter=0.3)
    mesh = sb.Mesh(vertices, triangles)
    way = np.array([np.cos(0.4), np.sin(0.4)])
    found = sb.anisotropic_metric(mesh, np.tile([*way, 0.7], (mesh.face_count, 1)), 3)
    sides = (np.roll(vertices[triangles], -1, axis=1) - vertices[triangles])[..., :2]
    along, across = sides @ way, sides @ [-way[1], way[0]]
    np.testing.assert_allclose(found, np.sqrt(along**2 / 3 + across**2 * 3), rtol=1e-12)
    isotropic = sb.anisotropic_metric(mesh, np.zeros((mesh.face_count, 3)), 3)
    np.testing.assert_allclose(isotropic, np.linalg.norm(sides, axis=2), rtol=1e-12)
    denser = sb.anisotropic_metric(mesh, np.zeros((mesh.face_count, 3)), 1, density=np.full(mesh.vertex_count, 7.0))
    np.testing.assert_allclose(denser, isotropic, rtol=1e-12)


@pytest.mark.parametrize("seed", range(20))
def test_wild_fields_still_make_a_metric(seed):
    rng = np.random.default_rng(seed)
    arrays = [meshes.needles(3, 20), meshes.icosphere(2), meshes.graded_disk(1e-4), meshes.cube()][seed % 4]
    mesh = sb.Mesh(*arrays)
    density = np.exp(rng.normal(size=mesh.vertex_count, scale=3))
    lengths = sb.anisotropic_metric(mesh, rng.normal(size=(mesh.face_count, 3)), np.exp(rng.normal(scale=3)), density)
    assert sb.Mesh(mesh.vertices, mesh.triangles, lengths=lengths).is_intrinsic


def test_density_is_in_the_areas():
    mesh = sb.Mesh(*meshes.icosphere(4))
    density = np.exp(mesh.vertices[:, 0])
    lengths = sb.anisotropic_metric(mesh, sb.direction_field(mesh, 2), 2, density)
    areas = sb.Mesh(mesh.vertices, mesh.triangles, lengths=lengths).face_areas / mesh.face_areas
    wanted = density[mesh.triangles].mean(axis=1)
    ratio = areas / wanted * (mesh.face_areas @ wanted) / mesh.area
    assert np.quantile(abs(ratio - 1), 0.99) < 0.1


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((FIELD, 0), "stretch: wanted positive numbers, got 0.0 at"),
        ((FIELD, np.inf), "stretch: wanted positive numbers, got inf at"),
        ((FIELD, np.ones(3)), r"stretch: wanted one number or shape \(162,\), got \(3,\)"),
        ((FIELD, 2, np.zeros(162)), r"density: wanted positive numbers, got 0.0 at \[0\]"),
        ((FIELD, 2, np.ones((162, 1))), r"density: wanted one number or shape \(162,\)"),
        ((np.ones((5, 3)), 2), r"field: wanted shape \(320, 3\), got \(5, 3\)"),
        ((np.full((320, 3), np.nan), 2), "field: the vector of face 0 is not finite"),
        ((sb.direction_field(MESH, 4), 2), "field: of symmetry 4"),
        ((sb.direction_field(sb.Mesh(*meshes.cube()), 2), 2), r"field: wanted shape \(320, 3\)"),
    ],
)
def test_bad_input_is_refused(arguments, says):
    with pytest.raises(sb.InputError, match=says):
        sb.anisotropic_metric(MESH, *arguments)


def test_where_it_is_flat_nothing_bends():
    mesh = sb.Mesh(*meshes.grid(9, 7, jitter=0.3))
    corners = mesh.vertices[mesh.triangles]
    in_space = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    np.testing.assert_allclose(sb.curvature_metric(mesh, 5.0), in_space, rtol=1e-12)


def test_around_a_tube_lengths_grow_by_the_turn_of_its_normals_and_along_it_by_nothing():
    count, radius, weight = 40, 0.5, 0.2
    mesh = sb.Mesh(*meshes.cylinder(count, 12, radius=radius, height=3.0))
    found = sb.curvature_metric(mesh, weight)
    corners = mesh.vertices[mesh.triangles]
    ways = np.roll(corners, -1, axis=1) - corners
    inside = (abs(corners[..., 2] - corners[..., 2].mean()) < 1.2).all(axis=1)
    level = inside[:, None] & (abs(ways[..., 2]) < 1e-12)
    upright = inside[:, None] & (np.linalg.norm(ways[..., :2], axis=2) < 1e-12)
    assert level.any() and upright.any()
    np.testing.assert_allclose(found[upright], np.linalg.norm(ways, axis=2)[upright], rtol=1e-12)
    longer = np.hypot(1, weight * np.sqrt(mesh.area) / radius)
    np.testing.assert_allclose(found[level], longer * np.linalg.norm(ways, axis=2)[level], rtol=1e-12)


def test_a_dual_mesh_that_follows_curvature_is_nearer_to_the_surface():
    vertices, triangles = meshes.icosphere(5)
    mesh = sb.Mesh(vertices * [1.0, 0.25, 0.25], triangles)

    def off(surface: sb.Mesh) -> float:
        dual = sb.centroidal_voronoi(sb.SaddleVertexGraph(surface), count=150).cells.dual()
        return sb.hausdorff_distance(mesh, sb.Mesh(dual.vertices, dual.triangles)).distance

    bent = sb.Mesh(mesh.vertices, mesh.triangles, lengths=sb.curvature_metric(mesh))
    assert off(bent) < 0.6 * off(mesh)


@pytest.mark.parametrize("weight", [-0.1, np.nan, np.inf])
def test_a_weight_that_is_none_is_refused(weight):
    with pytest.raises(sb.InputError, match="weight: wanted 0 or more, got"):
        sb.curvature_metric(MESH, weight)


def bent_tube(turn: float) -> np.ndarray:
    """Vertices of a tube whose upper half is bent aside by `turn`, smoothly."""
    x, y, z = meshes.cylinder(48, 72, radius=0.2, height=2.0)[0].T
    at = np.linspace(0, 2, 2001)
    angles = turn * np.clip((at - 0.7) / 0.6, 0, 1)
    across, up = np.cumsum(np.sin(angles)) / 1000, np.cumsum(np.cos(angles)) / 1000
    angle = np.interp(z, at, angles)
    return np.column_stack([np.interp(z, at, across) + x * np.cos(angle), y, np.interp(z, at, up) - x * np.sin(angle)])


def test_sites_of_several_poses_suit_each_better_than_those_of_one():
    triangles = meshes.cylinder(48, 72, radius=0.2, height=2.0)[1]
    poses = [sb.Mesh(bent_tube(turn), triangles) for turn in (0.0, 0.8, 1.6)]
    graphs = [sb.SaddleVertexGraph(pose) for pose in poses]
    together = sb.SaddleVertexGraph(sb.Mesh(np.hstack([pose.vertices for pose in poses]), triangles))

    def worst(graph: sb.SaddleVertexGraph) -> tuple[float, float]:
        """The largest spread of areas in any pose, and the least share of vertices that stay in their cells."""
        cvt = sb.centroidal_voronoi(graph, count=120, annealing=100)
        kept = [sb.geodesic_voronoi(other, cvt.sites) for other in graphs]
        spread = max(float(cells.areas.std() / cells.areas.mean()) for cells in kept)
        return spread, min(float((cells.vertex_cell == cvt.cells.vertex_cell).mean()) for cells in kept)

    of_all, of_one = worst(together), worst(graphs[0])
    assert of_all[0] < of_one[0] and of_all[1] > of_one[1]


def exact_cells(mesh: sb.Mesh, sites: sb.SurfacePoints) -> sb.GeodesicVoronoi:
    return sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, k=3), sites, exact=True)


def shown_nowhere(mesh: sb.Mesh) -> sb.Mesh:
    """The surface by its lengths alone: all vertices in one place."""
    return sb.Mesh(0 * mesh.vertices, mesh.triangles, lengths=mesh.edge_lengths)


@pytest.mark.parametrize("arrays", [meshes.tetrahedron(), meshes.cube(), meshes.icosphere(2), meshes.torus(24, 12)])
def test_exact_cells_are_those_of_the_lengths_wherever_the_surface_is_shown(arrays):
    mesh = sb.Mesh(*arrays)
    sites = random_points(mesh, 9, seed=4)
    own = sb.Mesh(mesh.vertices, mesh.triangles, lengths=mesh.edge_lengths)
    wanted = exact_cells(mesh, sites)
    for surface in (own, shown_nowhere(mesh)):
        cells = exact_cells(surface, sites)
        np.testing.assert_array_equal(cells.vertex_cell, wanted.vertex_cell)
        np.testing.assert_allclose(cells.vertex_distance, wanted.vertex_distance, rtol=1e-12)
        np.testing.assert_allclose(cells.areas, wanted.areas, rtol=0, atol=1e-6 * mesh.area)
        assert len(cells.branch_points) == len(wanted.branch_points)
    check(mesh, exact_cells(own, sites))


@pytest.mark.parametrize("total", [1.0, 5.0, 8.0])
def test_exact_cells_about_a_tip_are_its_sectors(total):
    """Cones that need no place, of less than a full turn and of more: sites all round have equal sectors."""
    around, count = 36, 9
    i = np.arange(around)
    triangles = np.stack([0 * i, 1 + i, 1 + (i + 1) % around], axis=1)
    mesh = sb.Mesh(
        np.zeros((around + 1, 3)), triangles, lengths=np.tile([1, 2 * np.sin(total / around / 2), 1], (around, 1))
    )
    assert mesh.total_angles[0] == pytest.approx(total)
    cells = exact_cells(mesh, sb.SurfacePoints(i[:: around // count], np.tile([0.5, 0.25, 0.25], (count, 1))))
    np.testing.assert_allclose(cells.areas, mesh.area / count, rtol=1e-4)


def test_of_sites_at_one_place_the_first_has_the_exact_cell():
    """On both sides of an edge, of surfaces that are shown in one place and where they are."""
    mesh = sb.Mesh(*meshes.icosphere(2))
    a, b = mesh.triangles[0], next(t for t in mesh.triangles[1:] if len(set(t) & set(mesh.triangles[0])) == 2)
    shared = sorted(set(a) & set(b))
    faces = np.array([0, np.flatnonzero((mesh.triangles == b).all(axis=1))[0], 200], dtype=np.int32)
    weights = [np.isin(t, shared[0]) * 0.3 + np.isin(t, shared[1]) * 0.7 for t in (a, b)]
    sites = sb.SurfacePoints(faces, np.array([*weights, [0.2, 0.3, 0.5]]))
    for surface in (mesh, shown_nowhere(mesh)):
        areas = exact_cells(surface, sites).areas
        assert areas[1] == 0
        assert areas[[0, 2]].min() > 0.1 * mesh.area


def rim(mesh: sb.Mesh, places: np.ndarray) -> list[sb.SurfaceCurve]:
    """The sides of the unit square, whose vertices are at `places`, as curves on a mesh of the same triangles."""
    loop = mesh.boundary_loops[0]
    corners = np.flatnonzero(np.isin(places[loop, :2], [0, 1]).all(axis=1))
    loop, corners = np.roll(loop, -corners[0]), corners - corners[0]
    ends = [*corners, len(loop)]
    return [sb.SurfaceCurve(mesh, np.append(loop, loop[0])[a : b + 1]) for a, b in pairwise(ends)]


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_sites_on_curves_slide_by_lengths_as_in_the_plane(method):
    vertices, triangles = meshes.grid(30, 30, jitter=0.3)
    plane = sb.Mesh(vertices, triangles)
    own = sb.Mesh(vertices, triangles, lengths=plane.edge_lengths)
    options = {"count": 90, "max_iterations": 25, "method": method}
    found = []
    for mesh in (plane, own, shown_nowhere(plane)):
        relaxed = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh), curves=rim(mesh, vertices), **options)
        places = relaxed.sites.positions(plane)[:, :2]
        on_rim = np.isin(places, [0, 1]).any(axis=1)
        np.testing.assert_array_equal(on_rim, relaxed.held >= 0)
        assert np.isin(places, [0, 1]).all(axis=1).sum() == 4
        assert (np.diff(relaxed.energy) <= 0).all()
        assert not relaxed.cells.dual("strict").issues
        found.append(relaxed)
    np.testing.assert_array_equal(found[0].held, found[1].held)
    np.testing.assert_allclose(found[1].sites.positions(plane), found[0].sites.positions(plane), atol=1e-9)
    assert found[2].normalized_energy == pytest.approx(found[0].normalized_energy, rel=0.05)


def test_held_sites_begin_at_their_feet_by_lengths():
    vertices, triangles = meshes.grid(20, 20)
    plane = sb.Mesh(vertices, triangles)
    row = np.flatnonzero(abs(vertices[:, 1] - vertices[:, 1][np.argmin(abs(vertices[:, 1] - 0.5))]) < 1e-12)
    row = row[np.argsort(vertices[row, 0])]
    mesh, sites = shown_nowhere(plane), random_points(plane, 20, seed=3)
    relaxed = sb.centroidal_voronoi(
        sb.SaddleVertexGraph(mesh), sites=sites, curves=[sb.SurfaceCurve(mesh, row)], held=[0] * 20, max_iterations=0
    )
    feet = sites.positions(plane)
    feet[:, 1] = vertices[row[0], 1]
    np.testing.assert_allclose(relaxed.sites.positions(plane), feet, atol=1e-7)


def test_a_mesh_with_lengths_of_its_own_is_refused():
    metric = sb.Mesh(MESH.vertices, MESH.triangles, lengths=MESH.edge_lengths)
    with pytest.raises(sb.InputError, match="mesh: a field stretches lengths of space, but"):
        sb.anisotropic_metric(metric, FIELD, 2)
    with pytest.raises(sb.InputError, match="mesh: normals are those of space, but"):
        sb.curvature_metric(metric)
