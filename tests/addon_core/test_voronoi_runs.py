# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane diagrams without Blender: planes, polygons with common corners, darkness, the sweep's radii, the cache."""

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs, voronoi_runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.fields.darkness import darkness, places_by_density, shrunk
from saddleback_blender.core.requests import Surface, Voronoi2dRequest
from saddleback_blender.core.settings import Voronoi2dSettings
from saddleback_blender.core.solids.cell_mesh import CellShape
from saddleback_blender.core.solids.flat_cells import flat_cells
from saddleback_blender.core.solids.flat_solid import raised_cells
from saddleback_blender.core.surfaces.plane_frame import PlaneFrame, plane_of
from tests import meshes

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
FRAME = PlaneFrame(np.zeros(3), np.eye(3))


def surface_of(arrays, name="Shape"):
    return Surface(name, *arrays, len(arrays[0]))


def voronoi_2d(surface, cache=None, given=None, **settings):
    request = Voronoi2dRequest(
        surface, Voronoi2dSettings(**settings), np.arange(len(surface.triangles), dtype=np.int32), **(given or {})
    )
    return voronoi_runs.voronoi_2d(request, runs.new_progress(), cache or Cache(2**30))


def polygon_areas(cells):
    flat = cells.vertices[cells.corners]
    onward = np.arange(1, len(flat) + 1)
    onward[cells.offsets[1:] - 1] = cells.offsets[:-1]
    cross = flat[:, 0] * flat[onward, 1] - flat[:, 1] * flat[onward, 0]
    return 0.5 * np.add.reduceat(cross, cells.offsets[:-1])


def test_the_plane_of_a_turned_mesh():
    vertices, triangles = meshes.grid(5, 7)
    turn = np.linalg.qr(np.random.default_rng(0).normal(size=(3, 3)))[0]
    surface = surface_of((vertices @ turn.T + (3, 4, 5), triangles))
    frame = plane_of(surface)
    np.testing.assert_allclose(frame.axes @ frame.axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame.axes) == pytest.approx(1) and abs(frame.axes[0] @ frame.axes[2]) < 1e-12
    places = frame.to_plane(surface.vertices)
    np.testing.assert_allclose(frame.to_space(places), surface.vertices, atol=1e-12)
    a, b, c = (places[triangles[:, k]] for k in range(3))
    assert ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] > 0).all()


def test_the_plane_of_a_level_mesh_is_the_worlds():
    np.testing.assert_allclose(plane_of(surface_of(meshes.grid(4, 4))).axes, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("arrays", [meshes.saddle(), meshes.icosphere(1)], ids=["saddle", "sphere"])
def test_what_is_not_flat(arrays):
    with pytest.raises(BadInputError, match="'Shape' is not flat"):
        plane_of(surface_of(arrays))


@pytest.mark.parametrize(
    "domain", [SQUARE, [SQUARE, [(0.4, 0.4), (0.4, 0.7), (0.6, 0.7), (0.6, 0.4)]]], ids=["square", "hole"]
)
def test_polygons_share_their_corners(domain):
    sites = np.random.default_rng(1).random((300, 2))
    clipped = sb.voronoi_2d(sites, domain=domain).clipped
    cells = flat_cells(clipped, FRAME)
    np.testing.assert_allclose(np.bincount(cells.polygon_cell, polygon_areas(cells)), clipped.areas, atol=1e-13)
    holes = len(domain) == 2
    # Euler: a disk, or a ring, cut into polygons; borders have one cell, all others two.
    assert len(cells.vertices) - len(cells.edges) + len(cells.offsets) - 1 == (0 if holes else 1)
    border = cells.edges[cells.edge_cells[:, 1] < 0]
    length = np.linalg.norm(cells.vertices[border[:, 0]] - cells.vertices[border[:, 1]], axis=1).sum()
    assert length == pytest.approx(5.0 if holes else 4.0) and not cells.has_holes
    a, b = (cells.vertices[cells.edges[:, k], :2] for k in range(2))
    middle, (left, right) = 0.5 * (a + b), cells.edge_cells.T
    inner = right >= 0
    far = [np.linalg.norm(middle[inner] - sites[side[inner]], axis=1) for side in (left, right)]
    np.testing.assert_allclose(far[0], far[1], rtol=1e-9)
    to_left = sites[left[inner]] - middle[inner]
    along = (b - a)[inner]
    assert (along[:, 0] * to_left[:, 1] - along[:, 1] * to_left[:, 0] > 0).all()


def test_a_cell_around_a_hole_is_told():
    hole = [(0.4, 0.4), (0.4, 0.6), (0.6, 0.6), (0.6, 0.4)]
    cells = flat_cells(sb.voronoi_2d([(0.1, 0.1)], domain=[SQUARE, hole]).clipped, FRAME)
    assert cells.has_holes and polygon_areas(cells).sum() == pytest.approx(0.96)


def volume_and_edges(polygons):
    """Volume of each cell by fans of its polygons, and how often each directed edge is met from the other side."""
    volumes, edges = np.zeros(polygons.polygon_cell.max() + 1), {}
    for number, cell in enumerate(polygons.polygon_cell):
        loop = polygons.corners[polygons.offsets[number] : polygons.offsets[number + 1]]
        points = polygons.vertices[loop]
        for k in range(1, len(loop) - 1):
            volumes[cell] += np.linalg.det(points[[0, k, k + 1]]) / 6
        for a, b in zip(loop, np.roll(loop, -1), strict=True):
            edges[int(a), int(b)] = edges.get((int(a), int(b)), 0) + 1
    return volumes, edges


NOTCHED = [(0, 0), (2, 0), (2, 1), (1.2, 0.4), (0.7, 1.6), (0, 1)]


@pytest.mark.parametrize("domain", [SQUARE, NOTCHED], ids=["square", "notched"])
@pytest.mark.parametrize("inset", [0.0, 0.02, 0.2])
def test_raised_cells_are_closed_solids(domain, inset):
    sites = np.random.default_rng(4).random((40, 2))
    diagram, shape = sb.voronoi_2d(sites), CellShape(0.01, inset, 0.1, True)
    base = diagram.clip(domain, gap=0.01)
    plateau = diagram.clip(domain, gap=0.01 + 2 * inset) if inset else None
    volumes, edges = volume_and_edges(raised_cells(base, plateau, FRAME, shape))
    assert set(edges.values()) == {1} and all((b, a) in edges for a, b in edges)
    feet = base.areas[: len(volumes)]
    if not inset:
        np.testing.assert_allclose(volumes, 0.1 * feet, atol=1e-12)
        return
    tops = plateau.areas[: len(volumes)]
    assert (volumes <= 0.1 * feet + 1e-12).all() and (volumes >= 0.1 * tops - 1e-12).all()
    assert (volumes[feet > 0] > 0).all()


def test_no_cells_at_all():
    cells = flat_cells(sb.voronoi_2d(np.zeros((0, 2)), domain=SQUARE).clipped, FRAME)
    assert len(cells.offsets) == 1 and len(cells.edges) == 0


def test_darkness_is_missing_light():
    gray = np.array([[[0, 0, 0, 1], [1, 1, 1, 1], [0.5, 0.5, 0.5, 1], [0, 0, 0, 0.25]]], np.float32)
    np.testing.assert_allclose(darkness(gray, False, False), [[1, 0, 0.5, 0.25]], atol=1e-6)
    np.testing.assert_allclose(darkness(gray, False, True), [[0, 1, 0.5, 0]], atol=1e-6)
    assert darkness(gray, True, False)[0, 2] == pytest.approx(1 - 0.2140, abs=1e-3)


def test_pixels_that_are_no_numbers_are_left_white():
    """One of them in a render took all sites into the last pixel of the image."""
    gray = np.full((8, 8, 4), 0.5, np.float32)
    gray[2, 3, 1], gray[..., 3] = np.nan, 1.0
    for invert in (False, True):
        dark = darkness(gray, False, invert)
        assert dark[2, 3] == 0 and np.delete(dark.ravel(), 19) == pytest.approx(0.5)
    places = places_by_density(dark, np.zeros(2), np.ones(2), 400, 7, lambda p: np.ones(len(p), bool))
    assert places.mean(axis=0) == pytest.approx([0.5, 0.5], abs=0.05)


def test_large_images_are_averaged():
    pixels = np.zeros((2050, 3, 4))
    pixels[:1026] = 1
    small = shrunk(pixels)
    assert small.shape == (683, 1, 4) and small.mean() == pytest.approx(0.5, abs=1e-3)


def test_places_follow_a_density():
    density = np.array([[0.0, 1.0], [0.0, 3.0]])
    box = np.array([-1.0, 0.0]), np.array([1.0, 1.0])
    places = places_by_density(density, *box, 4000, 7, lambda p: np.ones(len(p), bool))
    assert places.shape == (4000, 2) and (places[:, 0] >= 0).all()
    assert (places[:, 1] > 0.5).mean() == pytest.approx(0.75, abs=0.03)
    again = places_by_density(density, *box, 4000, 7, lambda p: np.ones(len(p), bool))
    assert again.tobytes() == places.tobytes()
    assert (places_by_density(density, *box, 100, 7, lambda p: p[:, 1] < 0.2)[:, 1] < 0.2).all()


def test_the_sweep_uncovers_what_the_circle_has_passed():
    surface = shapes.grid(6)
    result = voronoi_2d(surface, count=80, animate=True, frame_start=1, frame_end=40)
    sweep, sites = result.sweep, result.cells.sites_position
    center = sweep.center
    nearest = np.linalg.norm(sweep.edge_vertices[:, None] - sites, axis=2).min(axis=1)
    np.testing.assert_allclose(sweep.edge_radius, nearest + np.linalg.norm(sweep.edge_vertices - center, axis=1))
    assert sweep.rings.shape == (40, 1, 512, 3) and sweep.last_radius == sweep.edge_radius.max()
    for number in (9, 24, 39):
        radius = sweep.last_radius * (number + 1) / 40
        ring = sweep.rings[number, 0]
        near = np.linalg.norm(ring[:, None] - sites, axis=2).min(axis=1)
        np.testing.assert_allclose(near + np.linalg.norm(ring - center, axis=1), radius, rtol=1e-9)
    steps = np.linalg.norm(np.diff(sweep.edge_vertices[sweep.edges], axis=1)[:, 0], axis=1)
    assert steps.max() < 1.2 * np.ptp(surface.vertices, axis=0).max() / 150


def test_heavier_sites_are_met_earlier():
    rng = np.random.default_rng(3)
    sites = np.column_stack([rng.random((50, 2)), np.zeros(50)])
    weights = 0.05 * rng.random(50)
    given = {"sites": sites, "weights": weights}
    sweep = voronoi_2d(shapes.grid(6), given=given, sites_source="OBJECT", animate=True, frame_end=30).sweep
    near = (np.linalg.norm(sweep.edge_vertices[:, None] - sites, axis=2) - weights).min(axis=1)
    passed = near + np.linalg.norm(sweep.edge_vertices - sweep.center, axis=1)
    # Between the corners of their polylines curved edges lie beside them.
    np.testing.assert_allclose(sweep.edge_radius, passed, atol=2e-3)
    ring = sweep.rings[19, 0]
    near = (np.linalg.norm(ring[:, None] - sites, axis=2) - weights).min(axis=1)
    np.testing.assert_allclose(
        near + np.linalg.norm(ring - sweep.center, axis=1), 20 / 30 * sweep.last_radius, rtol=1e-9
    )


@pytest.mark.parametrize("weighted", [False, True])
@pytest.mark.parametrize("circles", [1, 2, 9])
def test_several_circles_share_the_sweep(circles, weighted):
    """Edges are uncovered where a circle has passed them that has not stopped; none is left; each stops by itself."""
    rng = np.random.default_rng(5)
    sites = np.column_stack([rng.random((80, 2)), np.zeros(80)])
    weights = 0.03 * rng.random(80) if weighted else None
    lead = 0.0 if weights is None else weights
    places = np.column_stack([rng.random((circles, 2)), np.ones(circles)])
    given = {"sites": sites, "weights": weights, "circles": places}
    settings = {"sites_source": "OBJECT", "animate": True, "frame_end": 40, "circles": "EMPTIES"}
    sweep = voronoi_2d(shapes.grid(6), given=given, **settings).sweep
    centers = places * (1, 1, 0)
    alone = [voronoi_2d(shapes.grid(6), given={**given, "circles": place[None]}, **settings).sweep for place in places]
    np.testing.assert_allclose(sweep.center, centers[0], atol=1e-12)
    assert sweep.rings.shape == (40, 1 if circles == 1 else 2 * circles, {9: 227}.get(circles, 512), 3)
    near = (np.linalg.norm(sweep.edge_vertices[:, None] - sites, axis=2) - lead).min(axis=1)
    passed = near[:, None] + np.linalg.norm(sweep.edge_vertices[:, None] - centers, axis=2)
    assert (sweep.edge_radius >= passed.min(axis=1) - 2e-3).all()
    assert (sweep.edge_radius <= passed.max(axis=1) + 2e-3).all()
    assert np.isfinite(sweep.edge_radius).all() and len(sweep.edge_vertices) == len(alone[0].edge_vertices)
    if circles == 1:
        return
    assert sweep.last_radius <= (1 + 1e-12) * min(one.last_radius for one in alone)
    radius = np.linalg.norm(sweep.rings[:, circles:] - centers[None, :, None], axis=3)
    assert np.ptp(radius, axis=2).max() < 1e-9
    radius = radius[:, :, 0]
    assert (np.diff(radius, axis=0) >= -1e-12).all() and (radius <= sweep.last_radius * (1 + 1e-12)).all()
    assert radius[-1].min() < 0.99 * sweep.last_radius or circles == 2
    for number, circle in np.argwhere(radius > 0.2):  # beach curves of circles that have come to a site
        ring = sweep.rings[number, circle]
        depth = (np.linalg.norm(ring[:, None] - sites, axis=2) - lead).min(axis=1)
        whole = depth + np.linalg.norm(ring - centers[circle], axis=1)
        np.testing.assert_allclose(whole, radius[number, circle], rtol=1e-6)


def test_a_count_of_circles_is_spread():
    sweep = voronoi_2d(shapes.grid(6), count=60, animate=True, circles="COUNT", circle_count=4).sweep
    assert sweep.rings.shape[1] == 8
    centers = sweep.rings[-1, 4:].mean(axis=1)
    apart = np.linalg.norm(centers[:, None] - centers, axis=2)[np.triu_indices(4, 1)]
    assert apart.min() > 0.3 * np.ptp(shapes.grid(6).vertices[:, 0])


def test_one_site_has_a_sweep_too():
    sweep = voronoi_2d(shapes.grid(3), count=1, animate=True).sweep
    assert len(sweep.edges) == 0 and sweep.last_radius > 0 and np.isfinite(sweep.rings).all()


def test_only_what_changed_is_computed():
    cache, surface = Cache(2**30), surface_of(meshes.saddle(15))
    voronoi_2d(surface, cache, space="DISK", count=30, iterations=2)
    cells = {"cell pieces": 1, "cell mesh": 1}
    assert cache.builds == {"mesh": 1, "space": 1, "sites 2d": 1, **cells}
    voronoi_2d(surface, cache, space="DISK", count=30, iterations=2, edge_radius=0.5)
    assert cache.builds == {"mesh": 1, "space": 1, "sites 2d": 1, **cells}
    voronoi_2d(surface, cache, space="DISK", count=31, iterations=2, make_cells=False)
    assert cache.builds == {"mesh": 1, "space": 1, "sites 2d": 2, **cells}


def test_cells_of_a_disk_cover_the_surface():
    surface = surface_of(meshes.saddle(15))
    result = voronoi_2d(surface, space="DISK", count=25, iterations=20)
    assert result.flat is None and result.cells.cell_area.sum() == pytest.approx(sb.Mesh(*meshes.saddle(15)).area)
    even = result.cells.cell_area
    assert even.std() / even.mean() < 0.3
    heights = result.cells.sites_position @ np.array([0, 0, 1])
    on = result.cells.sites_position[:, 0] ** 2 - result.cells.sites_position[:, 1] ** 2
    np.testing.assert_allclose(heights, on, atol=0.02)  # as near as the mesh is to x^2 - y^2


def test_a_run_can_be_stopped():
    progress = runs.new_progress()
    progress.cancel()
    request = Voronoi2dRequest(shapes.grid(5), Voronoi2dSettings(), np.arange(50, dtype=np.int32))
    with pytest.raises(sb.Cancelled):
        voronoi_runs.voronoi_2d(request, progress, Cache(2**30))


def test_names_of_faces_are_blenders():
    vertices, triangles = meshes.grid(2, 2)
    uv = np.tile([(0, 0), (1, 0), (0, 1)], (2, 1)).astype(float)
    request = Voronoi2dRequest(
        surface_of((vertices, triangles)), Voronoi2dSettings(space="UV"), np.array([7, 9], np.int32), uv=uv
    )
    with pytest.raises(BadInputError, match="'Shape': faces 7 and 9 overlap in the map"):
        voronoi_runs.voronoi_2d(request, runs.new_progress(), Cache(2**30))
