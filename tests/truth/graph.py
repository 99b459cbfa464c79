# SPDX-License-Identifier: MIT
"""Truths about the distance graph: Euclid where a mesh lies flat, its own rules elsewhere, parts beside others.

Neither windows nor arcs are looked at: only distances, paths and what they must obey.
"""

from __future__ import annotations

import heapq
import tempfile
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import ConvexHull

import saddleback as sb
from tests.truth.registry import guards

Floats = NDArray[np.float64]
Random = np.random.Generator

# Of distances: arcs keep 22 bits of their lengths or more, and are rounded up.
ROUNDING = 2.5e-7


def shortness(mesh: sb.Mesh) -> float:
    """What a distance may fall short of the truth by, relative: what lies behind a short edge is placed by it."""
    ends = mesh.vertices[mesh.edges]
    shortest = float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).min())
    return 1e-12 + 1e-16 * float(np.ptp(mesh.vertices, axis=0).max()) / shortest


def random_rule(mesh: sb.Mesh, rng: Random) -> dict[str, Any]:
    """How to build a graph: by accuracy, by k, or exact."""
    kind = rng.integers(4)
    if kind == 0:
        return {"k": int(rng.integers(1, len(mesh.vertices) + 1))}
    if kind == 1:
        return {"exact": True}
    return {"accuracy": float(rng.choice([2e-2, 5e-3, 1e-3]))}


def promised(rule: dict[str, Any]) -> float:
    """The largest relative error that a graph of this rule may have; infinite where none is promised."""
    return 0.0 if rule.get("exact") else rule.get("accuracy", np.inf)


def edge_distances(mesh: sb.Mesh, source: int) -> Floats:
    """Dijkstra along mesh edges: no geodesic is longer."""
    beside: list[list[tuple[int, float]]] = [[] for _ in mesh.vertices]
    for a, b in mesh.edges.tolist():
        length = float(np.linalg.norm(mesh.vertices[a] - mesh.vertices[b]))
        beside[a].append((b, length))
        beside[b].append((a, length))
    found = np.full(len(mesh.vertices), np.inf)
    queue = [(0.0, source)]
    while queue:
        distance, vertex = heapq.heappop(queue)
        if distance >= found[vertex]:
            continue
        found[vertex] = distance
        for other, length in beside[vertex]:
            heapq.heappush(queue, (distance + length, other))
    return found


def is_flat_and_convex(mesh: sb.Mesh) -> bool:
    """Whether geodesics are straight lines of the plane z = const."""
    flat = mesh.vertices[:, :2]
    if np.ptp(mesh.vertices[:, 2]) > 0 or mesh.component_count != 1 or len(mesh.boundary_loops) != 1:
        return False
    u, v = (flat[mesh.triangles[:, i]] - flat[mesh.triangles[:, 0]] for i in (1, 2))
    turned = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    if turned.min() <= 0 <= turned.max():  # folded over itself
        return False
    hull = ConvexHull(flat).volume  # in the plane, its area
    return abs(mesh.area - hull) <= 1e-12 * hull


@guards("SaddleVertexGraph", "SaddleVertexGraph.distances", "SaddleVertexGraph.fields", "SaddleVertexGraph.distance")
def flat_distances(mesh: sb.Mesh, rng: Random) -> None:
    """On flat convex meshes distances are Euclid's, within the accuracy and never below."""
    if not is_flat_and_convex(mesh):
        return
    rule = random_rule(mesh, rng)
    graph = sb.SaddleVertexGraph(mesh, **rule)
    for source in rng.integers(0, len(mesh.vertices), 3).tolist():
        right = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
        found = graph.distances(source)
        least = np.flatnonzero(found < right * (1 - shortness(mesh)))
        assert not len(least), f"{rule} {source} to {least[0]}: {found[least[0]]:.17g} below {right[least[0]]:.17g}"
        most = np.flatnonzero(found > right * (1 + min(promised(rule), 1e9)) * (1 + ROUNDING))
        assert not len(most), f"{rule} {source} to {most[0]}: {found[most[0]]:.17g} for {right[most[0]]:.17g}"


@guards("SaddleVertexGraph.distances", "SaddleVertexGraph.distance", "SaddleVertexGraph.distances_to")
def metric(mesh: sb.Mesh, rng: Random) -> None:
    """Finite within a part alone, no shorter than the bird flies, no longer than along edges, the same both ways."""
    graph = sb.SaddleVertexGraph(mesh, **random_rule(mesh, rng))
    source = int(rng.integers(len(mesh.vertices)))
    found, along = graph.distances(source), edge_distances(mesh, source)
    bird = np.linalg.norm(mesh.vertices - mesh.vertices[source], axis=1)
    assert (np.isfinite(found) == np.isfinite(along)).all()
    reached = np.isfinite(along)
    assert (found[reached] >= bird[reached] * (1 - shortness(mesh))).all()
    assert (found[reached] <= along[reached] * (1 + ROUNDING)).all()
    for target in rng.integers(0, len(mesh.vertices), 3).tolist():
        assert graph.distance(source, target) == found[target]
        if reached[target]:
            assert abs(graph.distances(target)[source] - found[target]) <= 1e-14 * found[target]
        assert graph.distances_to(source, [target])[0] == found[target]
    assert (graph.distances(source, method="dijkstra") == found).all()


@guards("SaddleVertexGraph.nearest", "SaddleVertexGraph.fields")
def nearest_sources(mesh: sb.Mesh, rng: Random) -> None:
    """The least of the fields of each source, and the first that has it."""
    graph = sb.SaddleVertexGraph(mesh, **random_rule(mesh, rng))
    sources = rng.integers(0, len(mesh.vertices), int(rng.integers(1, 6))).astype(np.int32)
    fields = np.array([graph.distances(int(source)) for source in sources])
    assert (graph.fields(sources) == fields).all()
    distance, which = graph.nearest(sources)
    assert (distance == fields.min(axis=0)).all()
    assert (which == np.where(np.isfinite(distance), fields.argmin(axis=0), -1)).all()


def polyline_length(points: Floats) -> float:
    return float(sum(np.linalg.norm(b - a) for a, b in pairwise(points)))


@guards("SaddleVertexGraph.path", "SaddleVertexGraph.paths", "GeodesicPath")
def path_lengths(mesh: sb.Mesh, rng: Random) -> None:
    """A path leads from end to end over the surface and is as long as its polyline, and as the distance."""
    graph = sb.SaddleVertexGraph(mesh, **random_rule(mesh, rng))
    source = int(rng.integers(len(mesh.vertices)))
    found = graph.distances(source)
    targets = np.flatnonzero(np.isfinite(found))
    targets = rng.choice(targets, min(len(targets), 20), replace=False).astype(np.int32)
    extent = float(np.abs(mesh.vertices).max())  # positions are sums of coordinates
    paths = list(graph.paths([source], targets)) + [graph.path(source, int(targets[0]))]
    for path, target in zip(paths, [*targets.tolist(), int(targets[0])], strict=True):
        slack = ROUNDING * found[target] + 1e-14 * extent * len(path.points)
        assert abs(path.length - found[target]) <= slack, f"{source} to {target}: {path.length} for {found[target]}"
        assert abs(polyline_length(path.points) - path.length) <= slack
        assert (path.points[0] == mesh.vertices[source]).all()
        assert (path.points[-1] == mesh.vertices[target]).all()
        assert np.abs(path.surface.positions(mesh) - path.points).max() <= 1e-14 * extent


@guards("SaddleVertexGraph", "SaddleVertexGraph.distances", "geodesic_voronoi")
def small_part_beside_large(mesh: sb.Mesh, rng: Random) -> None:
    """A part is measured beside a much larger or smaller one as it is alone."""
    rule = random_rule(mesh, rng)
    ratio = 10.0 ** rng.uniform(-12, 0)
    size = float(np.ptp(mesh.vertices, axis=0).max())
    large = sb.Mesh(*_sphere(size / ratio)) if rng.random() < 0.8 else sb.Mesh(*_sphere(size * ratio))
    count = len(mesh.vertices)
    both = sb.Mesh(np.vstack([mesh.vertices, large.vertices]), np.vstack([mesh.triangles, large.triangles + count]))
    alone, beside = sb.SaddleVertexGraph(mesh, **rule), sb.SaddleVertexGraph(both, **rule)
    for source in rng.integers(0, count, 2).tolist():
        a, b = alone.distances(source), beside.distances(source)[:count]
        assert (np.isfinite(a) == np.isfinite(b)).all()
        error = promised(rule) if np.isfinite(promised(rule)) else 0.5
        reached = np.isfinite(a)
        assert (b[reached] <= a[reached] * (1 + error) * (1 + ROUNDING)).all(), (rule, source)
        assert (a[reached] <= b[reached] * (1 + error) * (1 + ROUNDING)).all(), (rule, source)
    sites = [*(int(np.flatnonzero(mesh.components == c)[0]) for c in range(mesh.component_count)), count]
    cells = sb.geodesic_voronoi(beside, sites)
    np.testing.assert_allclose(cells.areas[-1], large.area, rtol=1e-9)
    np.testing.assert_allclose(cells.areas[:-1].sum(), mesh.area, rtol=1e-9)


def _sphere(radius: float) -> tuple[Floats, NDArray[np.int32]]:
    """An octahedron far from nowhere: about the origin."""
    vertices = np.vstack([np.eye(3), -np.eye(3)]) * radius
    octants = [(0, 1, 2), (1, 3, 2), (3, 4, 2), (4, 0, 2), (1, 0, 5), (3, 1, 5), (4, 3, 5), (0, 4, 5)]
    return vertices, np.array(octants, dtype=np.int32)


@guards("SaddleVertexGraph.arcs", "SaddleVertexGraph.neighbors", "SaddleVertexGraph.tiers", "Mesh.vertex_kinds")
def arcs_are_the_graph(mesh: sb.Mesh, rng: Random) -> None:
    """Another program's Dijkstra over the arcs finds the graph's distances; neighbors are rows; tiers, by angles."""
    graph = sb.SaddleVertexGraph(mesh, **random_rule(mesh, rng))
    offsets, targets, lengths = graph.arcs()
    count = mesh.vertex_count
    matrix = csr_matrix((lengths, targets, offsets), shape=(count, count))
    assert (matrix != matrix.T).nnz == 0
    assert matrix.nnz == graph.arc_count
    source = int(rng.integers(count))
    found, other = graph.distances(source), dijkstra(matrix, indices=source)
    reached = np.isfinite(found)
    assert np.array_equal(reached, np.isfinite(other))
    np.testing.assert_allclose(other[reached], found[reached], rtol=1e-12)
    row = slice(offsets[source], offsets[source + 1])
    vertices, ways, angles = graph.neighbors(source)
    assert np.array_equal(vertices, targets[row])
    assert np.array_equal(ways, lengths[row])
    assert (angles >= -1e-4).all()
    assert (angles <= mesh.total_angles[source] + 1e-4).all()
    turns = np.zeros(count)
    for i in range(3):
        u, v = (mesh.vertices[mesh.triangles[:, (i + k) % 3]] - mesh.vertices[mesh.triangles[:, i]] for k in (1, 2))
        cosines = np.einsum("ij,ij->i", u, v) / np.linalg.norm(u, axis=1) / np.linalg.norm(v, axis=1)
        np.add.at(turns, mesh.triangles[:, i], np.arccos(np.clip(cosines, -1, 1)))
    kinds = np.sign(2 * np.pi - turns)
    border = np.isin(np.arange(count), sb.border_edges(mesh.triangles, count)[0])
    kinds[border] = -1
    clear = (np.abs(turns - 2 * np.pi) > 1e-6) | border
    assert np.array_equal(mesh.vertex_kinds[clear], kinds[clear])
    assert np.isin(np.arange(count)[mesh.vertex_kinds == -1], mesh.saddle_vertices).all()
    ends = (mesh.vertex_kinds[np.repeat(np.arange(count), np.diff(offsets))] == -1).astype(int)
    ends += mesh.vertex_kinds[targets] == -1
    assert graph.tiers == {"S-S": (ends == 2).sum() // 2, "N-S": (ends == 1).sum() // 2, "N-N": (ends == 0).sum() // 2}


def file_of(graph: sb.SaddleVertexGraph) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        graph.save(Path(folder) / "graph")
        return (Path(folder) / "graph").read_bytes()


@guards("find_arcs", "arcs_across", "unite_arcs", "SaddleVertexGraph.from_parts")
def graphs_of_parts(mesh: sb.Mesh, rng: Random) -> None:
    """Parts in any number and order, found or united, make the very file of the graph built at once."""
    rule = random_rule(mesh, rng)
    if rule.pop("exact", False):  # which has no parts
        rule["k"] = len(mesh.vertices)
    rule["threads"] = 1
    right = file_of(sb.SaddleVertexGraph(mesh, **rule))
    count = int(rng.integers(1, 9))
    found = [sb.find_arcs(mesh, part, count, **rule) for part in range(count)]
    united = [
        sb.unite_arcs(arcs, [sb.arcs_across(other, part) for other in found if other is not arcs], threads=1)
        for part, arcs in enumerate(found)
    ]
    for parts in (found, united):
        shuffled = [parts[i] for i in rng.permutation(count)]
        joined = sb.SaddleVertexGraph.from_parts(mesh, shuffled, threads=1)
        assert file_of(joined) == right, f"{rule} in {count} parts"


@guards("SaddleVertexGraph.load", "SaddleVertexGraph.check")
def graphs_in_mapped_files(mesh: sb.Mesh, rng: Random) -> None:
    """A mapped graph gives the bits of the one saved; any byte that is changed is found by a check, or before."""
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    source = int(rng.integers(mesh.vertex_count))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "graph"
        graph.save(path)
        mapped = sb.SaddleVertexGraph.load(path, mesh, mmap=True)
        assert np.array_equal(mapped.distances([source]), graph.distances([source]))
        mapped.check()
        del mapped  # some systems change no mapped file
        content = bytearray(path.read_bytes())
        content[rng.integers(len(content))] ^= 1 << int(rng.integers(8))
        path.write_bytes(content)
        try:
            sb.SaddleVertexGraph.load(path, mesh, mmap=True).check()
        except sb.InputError as refusal:
            assert str(path) in str(refusal), str(refusal)
            return
        raise AssertionError("a damaged file passed")
