# SPDX-License-Identifier: MIT
"""Truths about the parts that cells come in: boundaries, split meshes, duals and their faults, by recount."""

from __future__ import annotations

from collections import Counter

import numpy as np

import saddleback as sb
from tests import meshes
from tests.truth.cells_exact import edges_of, exact_cells
from tests.truth.distances import Floats, Random, longest_edge
from tests.truth.plane import box_about, exact, some_of, squared
from tests.truth.registry import guards


def is_usual(mesh: sb.Mesh) -> bool:
    """Whether no edge is short and no face is a needle."""
    longest = mesh.edge_lengths.max()
    return bool(mesh.edge_lengths.min() > 1e-4 * longest and mesh.face_areas.min() > 0.01 * longest**2)


def far_sites(mesh: sb.Mesh, rng: Random) -> sb.SurfacePoints:
    """Sites that do not coincide."""
    return sb.sample(mesh, mesh.component_count + int(rng.integers(0, 6)), seed=int(rng.integers(1 << 30)),
                     one_per_component=True)  # fmt: skip


@guards("VoronoiEdge", "GeodesicVoronoi")
def boundaries_are_midway(mesh: sb.Mesh, rng: Random) -> None:
    """Points of boundaries between exact cells are as far from one site as from the other, one by one the same as in
    the flat arrays; loops close, others end at branch points or at the border.
    """
    if is_usual(mesh):
        check_boundaries(mesh, rng)


@guards("VoronoiEdge")
def boundaries_among_needles(mesh: sb.Mesh, rng: Random) -> None:
    """The same where faces are needles."""
    if not is_usual(mesh) and mesh.edge_lengths.min() > 1e-4 * longest_edge(mesh):
        check_boundaries(mesh, rng)


def check_boundaries(mesh: sb.Mesh, rng: Random) -> None:
    sites = far_sites(mesh, rng)
    cells = exact_cells(mesh, sites)
    fields = [sb.ExactField(mesh, sites[i]) for i in range(len(sites))]
    edges, size = cells.edges, longest_edge(mesh)
    assert len(edges) == len(cells.edge_cells) == len(cells.edge_offsets) - 1
    branches = cells.branch_points.positions(mesh)
    for k, edge in enumerate(edges):
        mine = slice(int(cells.edge_offsets[k]), int(cells.edge_offsets[k + 1]))
        assert edge.points.tobytes() == cells.edge_points[mine].tobytes()
        assert edge.cells == tuple(cells.edge_cells[k])
        assert edge.closed == cells.edge_closed[k]
        np.testing.assert_allclose(edge.surface.positions(mesh), edge.points, atol=1e-9 * size + 1e-13)
        left, right = (fields[i].distance_to(edge.surface) for i in edge.cells)
        assert abs(left - right).max() <= 1e-3 * size, f"{abs(left - right).max()} nearer to one of {edge.cells}"
        if edge.closed:
            np.testing.assert_allclose(edge.points[0], edge.points[-1], atol=1e-9 * size)
            continue
        for end in (0, -1):
            corners = mesh.triangles[edge.surface.faces[end]][edge.surface.barycentric[end] > 1e-9]
            on_border = np.isin(corners, mesh.boundary_vertices).all() and len(corners) < 3
            to_branch = np.linalg.norm(branches - edge.points[end], axis=1).min(initial=np.inf)
            assert on_border or to_branch <= 1e-6 * size, f"boundary {k} ends in the middle of nowhere"


def faces_at(mesh: sb.Mesh, point: Floats, share: float = 1e-3) -> int:
    """How many faces there are within a share of an edge."""
    slack = share * longest_edge(mesh)
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    square = (normal * normal).sum(axis=1)
    near = abs(((point - a) * normal).sum(axis=1)) <= slack * np.sqrt(square)
    for p, q in ((a, b), (b, c), (c, a)):
        near &= (np.cross(q - p, point - p) * normal).sum(axis=1) >= -share * square
    return int(near.sum())


def assert_is_split(mesh: sb.Mesh, split: sb.SplitMesh, areas: Floats) -> None:
    """A split mesh has the mesh's vertices where they were, and triangles of the cells' areas within its faces."""
    of_mesh = split.vertex_origin >= 0
    kept = split.vertex_origin[of_mesh]
    assert set(kept.tolist()) == set(range(mesh.vertex_count))
    assert (split.vertices[of_mesh] == mesh.vertices[kept]).all()
    a, b, c = (split.vertices[split.triangles[:, i]] for i in range(3))
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert abs(sizes.sum() - mesh.area) <= 1e-9 * mesh.area
    np.testing.assert_allclose(
        np.bincount(split.triangle_cell, sizes, minlength=len(areas)), areas, atol=1e-7 * mesh.area
    )


@guards("SplitMesh", "GeodesicVoronoi.split")
def split_triangles_are_nearest(mesh: sb.Mesh, rng: Random) -> None:
    """The middle of every triangle of a split mesh is nowhere nearer to another site than to its own."""
    if not is_usual(mesh):
        return
    sites = far_sites(mesh, rng)
    cells = exact_cells(mesh, sites)
    split = cells.split()
    assert_is_split(mesh, split, cells.areas)
    some = rng.permutation(len(split.triangles))[:60]
    middles = split.vertices[split.triangles[some]].mean(axis=1)
    alone = np.array([faces_at(mesh, middle) == 1 for middle in middles])  # not on a sheet that lies on another
    some, middles = some[alone], middles[alone]
    if len(some) == 0:
        return
    places = sb.project(mesh, middles)
    there = np.linalg.norm(places.positions(mesh) - middles, axis=1)
    table = np.array([sb.ExactField(mesh, sites[i]).distance_to(places) for i in range(len(sites))])
    behind = table[split.triangle_cell[some], np.arange(len(some))] - table.min(axis=0)
    assert behind.max() <= 1e-3 * longest_edge(mesh) + 2 * there.max(), f"{behind.max()} nearer to another site"


KINDS = {"not_a_disk", "two_borders", "closed_boundary", "double_boundary", "cell_meets_itself", "few_corners"}


@guards("DualMesh", "DualIssue", "GeodesicVoronoi.dual")
def duals_by_count(mesh: sb.Mesh, rng: Random) -> None:
    """A dual has an edge for each boundary and is a triangulation of the surface unless issues tell why not: cells that
    meet twice, or themselves, or in a loop, are counted from the boundaries.
    """
    if not is_usual(mesh):
        return
    cells = exact_cells(mesh, far_sites(mesh, rng))
    dual = cells.dual("strict")
    vertices, triangles, issues = dual
    assert vertices is not triangles
    assert dual.added == 0
    assert (dual.sites.barycentric == cells.sites.barycentric).all()
    np.testing.assert_allclose(vertices, cells.sites.positions(mesh), atol=1e-12 * np.abs(mesh.vertices).max())
    assert dual.euler_characteristic == len(vertices) - len(dual.edges) + len(triangles)
    met = Counter((min(a, b), max(a, b)) for a, b in cells.edge_cells.tolist())  # by pairs
    open_ones = cells.edge_cells[~cells.edge_closed].tolist()  # of loops tells an issue
    assert Counter(map(tuple, map(sorted, dual.edges.tolist()))) == Counter(map(tuple, map(sorted, open_ones)))
    told = Counter(issue.kind for issue in issues)
    assert set(told) <= KINDS
    for issue in issues:
        assert 0 <= issue.cell < len(vertices)
        assert issue.other is None or (0 <= issue.other < len(vertices) and issue.other != issue.cell)
        assert len(issue.place) == 1
        assert 0 <= issue.place.faces[0] < mesh.face_count
    twice = {pair for pair, count in met.items() if count > 1 and pair[0] != pair[1]}
    named = {(min(i.cell, i.other), max(i.cell, i.other)) for i in issues if i.other is not None}
    assert twice <= named, f"cells that meet twice: {twice}, named {named}"
    own = {a for a, b in met if a == b}
    assert own <= {issue.cell for issue in issues}, f"cells that meet themselves: {own}"
    if cells.edge_closed.any() or (mesh.is_closed and len(vertices) < 4):
        assert issues
    if not issues:
        counts = edges_of(triangles)
        assert max(counts.values(), default=2) <= 2
        assert set(counts) <= set(met)
        chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
        assert dual.euler_characteristic == chi, f"{dual.euler_characteristic}, not {chi}"


@guards("DualMesh", "GeodesicVoronoi.dual", on="nothing")
def mended_duals(rng: Random) -> None:
    """Repair adds sites until a torus is triangulated: every edge between two triangles, Euler characteristic 0."""
    around, tube = int(rng.integers(8, 20)), int(rng.integers(5, 9))
    mesh = sb.Mesh(*meshes.torus(around, tube, 1.0, float(rng.uniform(0.2, 0.5))))
    sites = sb.sample(mesh, int(rng.integers(1, 12)), seed=int(rng.integers(1000)))
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh, threads=1), sites, threads=1)
    dual = cells.dual(threads=1)
    assert dual.added == len(dual.vertices) - len(sites)
    assert not dual.issues
    assert set(edges_of(dual.triangles).values()) == {2}
    assert dual.euler_characteristic == 0
    assert (dual.sites.faces[: len(sites)] == sites.faces).all()


@guards("LiftedVoronoi", "LiftedVoronoi.locate", "LiftedVoronoi.split", on="plane")
def lifted_parts(sites: Floats, rng: Random) -> None:
    """On a flat mesh: the nearest site of its points in fractions, and triangles of the right areas."""
    sites = some_of(sites, rng, 10)
    corner, side = box_about(sites, rng)
    if side < 1e-6 * max(np.abs(sites).max(), np.abs(corner).max()):
        return  # what lies where is a matter of rounding
    vertices, triangles = meshes.grid(
        int(rng.integers(2, 6)), int(rng.integers(2, 6)), jitter=0.2, seed=int(rng.integers(99))
    )
    uv = corner + side * vertices[:, :2]
    mesh = sb.Mesh(np.column_stack([uv, np.zeros(len(uv))]), triangles)
    lifted = sb.Chart(mesh, uv).lift(sb.voronoi_2d(sites, threads=1), threads=1)
    points = sb.sample(mesh, 12, seed=int(rng.integers(1 << 30)))
    size = max(np.abs(uv).max(), np.abs(sites).max())
    for place, found in zip(exact(points.positions(mesh)[:, :2]), lifted.locate(points).tolist(), strict=True):
        distances = [float(squared(place, site)) ** 0.5 for site in exact(sites)]
        assert distances[found] <= min(distances) + 1e-14 * size, f"{found} for {int(np.argmin(distances))}"
    split = lifted.split()
    assert_is_split(mesh, split, lifted.areas)
    whole = np.flatnonzero(lifted.face_cell >= 0)
    middles = mesh.vertices[mesh.triangles[whole]].mean(axis=1)[:, :2]
    nearest = np.linalg.norm(middles[:, None] - sites, axis=2)
    behind = nearest[np.arange(len(whole)), lifted.face_cell[whole]] - nearest.min(axis=1)
    assert behind.max(initial=0) <= 1e-14 * size


def assert_nearest(mesh: sb.Mesh, cells: sb.GeodesicVoronoi, points: sb.SurfacePoints, owners: list[set[int]]) -> None:
    """To the owners of each point no other site is nearer, by exact distances."""
    table = np.array([sb.ExactField(mesh, cells.sites[i]).distance_to(points) for i in range(len(cells.sites))])
    for point, own in enumerate(owners):
        behind = table[sorted(own), point] - table[:, point].min()
        assert behind.max(initial=0) <= 1e-3 * longest_edge(mesh), f"{behind.max()} nearer to another site"


@guards("CellPolygons", "GeodesicVoronoi.polygons")
def polygons_by_recount(mesh: sb.Mesh, rng: Random) -> None:
    """Corners of polygons are as near to their own cells as to any; sides are shared by two, of the cells that meet;
    where no polygon is missing, they are the surface over again.
    """
    if not is_usual(mesh):
        return
    cells = exact_cells(mesh, far_sites(mesh, rng))
    polygons = cells.polygons("strict", bend=float(rng.choice([0.0, 0.15, np.inf])))
    with_area = np.flatnonzero(cells.areas > 0)
    assert polygons.added == 0
    assert sorted([*polygons.polygon_cell.tolist(), *polygons.missing.tolist()]) == with_area.tolist()
    faces = [part.tolist() for part in np.split(polygons.corners, polygons.offsets[1:-1])] if len(polygons) else []
    owners: list[set[int]] = [set() for _ in polygons.vertices]
    sides: dict[tuple[int, int], int] = {}
    for cell, face in zip(polygons.polygon_cell.tolist(), faces, strict=True):
        assert len(set(face)) == len(face) >= 3
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            assert (a, b) not in sides, f"a side of cells {sides[a, b]} and {cell}"
            sides[a, b] = cell
            owners[a].add(cell)
    met = {(min(a, b), max(a, b)) for a, b in cells.edge_cells.tolist()}
    joined = {(min(c, sides[b, a]), max(c, sides[b, a])) for (a, b), c in sides.items() if (b, a) in sides}
    whole = set(polygons.polygon_cell.tolist())
    assert joined == {pair for pair in met if pair[0] != pair[1] and set(pair) <= whole}
    if len(owners):
        assert_nearest(mesh, cells, polygons.points, owners)
    if not len(polygons.missing):
        edges = {(min(side), max(side)) for side in sides}
        chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
        assert len(polygons.vertices) - len(edges) + len(polygons) == chi
        assert mesh.is_closed == all(side[::-1] in sides for side in sides)


@guards("DualMesh.quads", "DualMesh")
def quads_by_recount(mesh: sb.Mesh, rng: Random) -> None:
    """Corners of quads are as near to their own sites as to any; where the dual mesh is whole, so are they, with three
    for each triangle.
    """
    if not is_usual(mesh):
        return
    dual = exact_cells(mesh, far_sites(mesh, rng)).dual("strict")
    points, quads = dual.quads()
    sites, edges = len(dual.sites), dual.edges
    assert len(points) == sites + len(edges) + len(dual.cells.branch_points)
    owners: list[set[int]] = [set() for _ in range(len(points))]
    for i, (a, b) in enumerate(edges.tolist()):
        owners[sites + i] = {a, b}
    for center, before, site, after in quads.tolist():
        assert center >= sites + len(edges) > min(before, after) >= sites > site
        assert {site} <= owners[before] & owners[after]
        owners[center].add(site)
    assert_nearest(mesh, dual.cells, points, owners)
    if not dual.issues and len(quads):
        counts = edges_of(quads)
        assert max(counts.values()) <= 2
        if len(quads) == 3 * len(dual.triangles):  # but at a border through a branch point
            vertices = len(np.unique(quads))
            assert vertices - len(counts) + len(quads) == dual.euler_characteristic - (
                sites - len(np.unique(quads[:, 2]))
            )


@guards("BarredMesh.polygons", "CellPolygons.triangles")
def polygons_beside_barriers(mesh: sb.Mesh, rng: Random) -> None:
    """Whatever edges are barriers: each is covered by sides, once from either of its faces; all sides are shared; the
    parts of the surface that polygons stand for are all of it, and have no open edge but at the border.
    """
    if not is_usual(mesh):
        return
    edges = mesh.edges[rng.random(mesh.edge_count) < rng.choice([0.05, 0.3])]
    barred = sb.add_barriers(mesh, edges=edges)
    count = barred.mesh.component_count + int(rng.integers(0, 12))
    sites = sb.sample(barred.mesh, count, seed=int(rng.integers(1 << 30)), one_per_component=True)
    cells = sb.geodesic_voronoi(sb.SaddleVertexGraph(barred.mesh, k=min(60, barred.mesh.vertex_count)), sites)
    polygons, split = barred.polygons(cells)
    parts = np.unique(split.triangle_cell).tolist()
    assert sorted([*polygons.polygon_cell.tolist(), *polygons.missing.tolist()]) == parts
    check_whole(mesh, split)
    faces = [part.tolist() for part in np.split(polygons.corners, polygons.offsets[1:-1])] if len(polygons) else []
    sides: dict[tuple[int, int], bool] = {}
    for face, barred_sides in zip(faces, np.split(polygons.is_barrier, polygons.offsets[1:-1]), strict=bool(faces)):
        assert len(set(face)) == len(face) >= 3
        for a, b, is_barrier in zip(face, face[1:] + face[:1], barred_sides.tolist(), strict=True):
            assert (a, b) not in sides
            sides[a, b] = is_barrier
    assert all(sides[side[::-1]] == barrier for side, barrier in sides.items() if side[::-1] in sides)
    triangles = polygons.triangles()
    assert len(triangles) == len(polygons.corners) - 2 * len(faces)
    if not len(polygons.missing):
        assert mesh.is_closed == all(side[::-1] in sides for side in sides)
        check_covered(mesh, polygons, edges, [side for side, barrier in sides.items() if barrier])
        chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
        assert len(polygons.vertices) - len({frozenset(side) for side in sides}) + len(faces) == chi


def check_whole(mesh: sb.Mesh, split: sb.SplitMesh) -> None:
    """Triangles that each have two neighbors across a side at most, as much area, and the border of the surface."""
    corners = split.vertices[split.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    np.testing.assert_allclose(areas.sum(), mesh.area, rtol=1e-9)
    sides = Counter((a, b) for t in split.triangles.tolist() for a, b in zip(t, t[1:] + t[:1], strict=True))
    assert max(sides.values()) == 1
    open_sides = np.array([side for side in sides if side[::-1] not in sides], dtype=int).reshape(-1, 2)
    ends = split.vertices[open_sides]
    border = sum(
        np.linalg.norm(mesh.vertices[loop] - mesh.vertices[np.roll(loop, -1)], axis=1).sum()
        for loop in mesh.boundary_loops
    )
    np.testing.assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum(), border, rtol=1e-9)


def check_covered(mesh: sb.Mesh, polygons: sb.CellPolygons, edges: np.ndarray, sides: list[tuple[int, int]]) -> None:
    """Between any two corners next to each other on a barrier it lies on a side, of one polygon on the border, of two
    elsewhere.
    """
    ends = polygons.vertices[np.array(sides, dtype=int).reshape(-1, 2)]
    begin, way = ends[:, 0], ends[:, 1] - ends[:, 0]
    of_mesh, within = mesh.vertices[mesh.edges], 1e-5 * longest_edge(mesh)
    for a, b in edges.tolist():
        start, along = mesh.vertices[a], mesh.vertices[b] - mesh.vertices[a]
        shares = np.clip((begin - start) @ along / (along @ along), 0, 1)
        on_it = np.linalg.norm(start + shares[:, None] * along - begin, axis=1) < within
        corners = np.unique([0.0, *shares[on_it], 1.0])
        # In a middle no side ends: of two that meet at a corner, both would be near it.
        for share in ((corners[1:] + corners[:-1]) / 2)[np.diff(corners) * np.linalg.norm(along) > 2 * within]:
            point = start + share * along
            found, wanted = count_near(point, begin, way, within), 1 if is_border(mesh, a, b) else 2
            # Where the surface lies on itself, sides along other edges are there, too.
            is_alone = count_near(point, of_mesh[:, 0], of_mesh[:, 1] - of_mesh[:, 0], within) == 1
            assert found == wanted or (not is_alone and found > wanted), f"edge {a}, {b} at {share}: {found} sides"


def count_near(point: Floats, begin: Floats, way: Floats, within: float) -> int:
    """The number of segments that pass a point."""
    along = np.clip(((point - begin) * way).sum(axis=1) / (way**2).sum(axis=1), 0, 1)
    return int((np.linalg.norm(begin + along[:, None] * way - point, axis=1) < within).sum())


def is_border(mesh: sb.Mesh, a: int, b: int) -> bool:
    """Whether one face alone has the edge."""
    return int(((mesh.triangles == a).any(axis=1) & (mesh.triangles == b).any(axis=1)).sum()) == 1


@guards("super_patches", "SuperPatches", "SuperPatches.hausdorff")
def patches_by_recount(mesh: sb.Mesh, rng: Random) -> None:
    """Planes by singular values of samples, distances of corners and regions to them, sharp edges by angles of faces,
    and distances of points of the regions from the polygons' triangles, one by one.
    """
    if not is_usual(mesh) or mesh.face_count > 100:
        return
    sharp = float(rng.uniform(0.4, 1.2))
    error = 0.1 * float(np.linalg.norm(np.ptp(mesh.vertices, axis=0)))
    try:
        patches = sb.super_patches(mesh, error=error, sharp=sharp)
    except sb.InputError as refusal:
        assert "more patches than the mesh has faces" in str(refusal)
        return
    assert not len(patches.polygons.missing)
    assert {frozenset(edge) for edge in patches.sharp_edges.tolist()} == sharp_by_normals(mesh, sharp)
    polygons, regions = patches.polygons, patches.regions
    for i, face in enumerate(patches.faces):
        corners = regions.vertices[regions.triangles[patches.region_patch == i]]
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        # The middles of the sides, each a third of the area, have the second moments of a triangle.
        middles = ((corners + np.roll(corners, -1, axis=1)) / 2).reshape(-1, 3)
        weights = np.repeat(areas, 3)
        center = (weights[:, None] * middles).sum(axis=0) / weights.sum()
        values, axes = np.linalg.svd(np.sqrt(weights)[:, None] * (middles - center))[1:]
        if len(values) < 3 or values[1] - values[2] < 1e-6 * values[0]:
            continue  # any plane through a line is as near
        off = abs((corners.reshape(-1, 3) - center) @ axes[2]).max()
        np.testing.assert_allclose(patches.region_distance[i], off, atol=1e-6 * longest_edge(mesh))
        off = abs((polygons.vertices[face] - center) @ axes[2]).max()
        np.testing.assert_allclose(patches.corner_distance[i], off, atol=1e-6 * longest_edge(mesh))
    assert patches.corner_distance.max() <= error
    triangles = polygons.vertices[patches.triangles]
    told = patches.hausdorff(mesh, 1e-3).distance
    assert told <= error
    for point in np.vstack([mesh.vertices, mesh.vertices[mesh.triangles].mean(axis=1)]):
        assert distance_to_triangles(point, triangles) <= error * (1 + 1e-9)


def sharp_by_normals(mesh: sb.Mesh, sharp: float) -> set[frozenset[int]]:
    """Edges of one face, or of two whose normals differ by more."""
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    owners: dict[frozenset[int], list[int]] = {}
    for f, t in enumerate(mesh.triangles.tolist()):
        for a, b in zip(t, t[1:] + t[:1], strict=True):
            owners.setdefault(frozenset((a, b)), []).append(f)
    turned = {
        edge: np.arctan2(np.linalg.norm(np.cross(*normals[own])), np.dot(*normals[own])) if len(own) == 2 else np.pi
        for edge, own in owners.items()
    }
    return {edge for edge, angle in turned.items() if angle > sharp}


def distance_to_triangles(point: Floats, triangles: Floats) -> float:
    """From the nearest of them: to the foot within, else to the sides."""
    a, b, c = triangles.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    best = np.inf
    inside = size > 0
    for p, q in ((a, b), (b, c), (c, a)):
        way = q - p
        along = np.clip(((point - p) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-300), 0, 1)
        best = min(best, float(np.linalg.norm(p + along[:, None] * way - point, axis=1).min()))
        inside &= (np.cross(way, point - p) * normal).sum(axis=1) >= 0
    if inside.any():
        best = min(best, float((abs(((point - a) * normal).sum(axis=1))[inside] / size[inside]).min()))
    return best
