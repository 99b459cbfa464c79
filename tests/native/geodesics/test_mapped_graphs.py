# SPDX-License-Identifier: MIT
"""Graphs in mapped files: the same bits as loaded ones, opened at once, and whatever is damaged is found when it is
read or when `check` is asked, never by a crash.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.graph_files import HEADER, GraphFile, with_checksum


def mapped(path: Path, mesh: sb.Mesh) -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph.load(path, mesh, mmap=True)


@pytest.fixture(scope="module")
def mesh() -> sb.Mesh:
    return sb.Mesh(*meshes.torus(16, 8))


@pytest.fixture(scope="module")
def saved(mesh: sb.Mesh, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("graph") / "torus.graph"
    sb.SaddleVertexGraph(mesh, k=20).save(path)
    return path.read_bytes()


def ask_all(graph: sb.SaddleVertexGraph) -> list[np.ndarray]:
    """What each kind of query answers: all of them read rows in ways of their own."""
    last = int(np.flatnonzero(graph.mesh.components == graph.mesh.components[0])[-1])
    point = sb.SurfacePoints([len(graph.mesh.triangles) // 2], [[0.2, 0.3, 0.5]])
    one_a_part = np.unique(graph.mesh.components, return_index=True)[1]
    cells = sb.centroidal_voronoi(graph, count=2, max_iterations=3, seed=1)
    return [
        graph.distances([0]),
        graph.distances(point),
        graph.distances([1, last], method="dijkstra"),
        *graph.nearest([0, last]),
        graph.fields([0, 1]),
        np.array([graph.distance(0, last)]),
        graph.distances_to([0], point),
        graph.path(last, 0).points,
        graph.log_map(point, 1.0).uv,
        cells.sites.barycentric,
        sb.geodesic_voronoi(graph, one_a_part).areas,
    ]


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_the_same_bits(case: meshes.Case, tmp_path: Path) -> None:
    sb.SaddleVertexGraph(case.mesh, k=min(20, len(case.vertices))).save(tmp_path / "a")
    loaded, graph = sb.SaddleVertexGraph.load(tmp_path / "a", case.mesh), mapped(tmp_path / "a", case.mesh)
    for name in ("arc_count", "mean_degree", "nbytes", "k", "accuracy", "device", "build_seconds"):
        assert getattr(graph, name) == getattr(loaded, name)
    for here, there in zip(ask_all(graph), ask_all(loaded), strict=True):
        assert np.array_equal(here, there)
    graph.check()
    graph.save(tmp_path / "b")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_mapped_graph_keeps_its_mesh_and_its_bytes(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / "g"
    path.write_bytes(saved)
    graph = mapped(path, sb.Mesh(*meshes.torus(16, 8)))
    try:
        path.unlink()
    except PermissionError:
        assert os.name == "nt"  # which may keep such files in their places
    assert np.array_equal(graph.distances([3]), sb.SaddleVertexGraph(mesh, k=20).distances([3]))


@pytest.mark.parametrize("name", ["g", "möbel 猫.graph"])
def test_a_file_may_be_replaced(name: str, mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(saved)
    graph, newer = mapped(path, mesh), sb.SaddleVertexGraph(mesh, k=5)
    if os.name == "nt":  # not as long as it is mapped
        with pytest.raises(sb.InputError, match=r"cannot be written: Permission denied; close what has it open"):
            newer.save(path)
        assert path.read_bytes() == saved
    else:
        newer.save(path)
        assert mapped(path, mesh).k == 5
    assert os.listdir(tmp_path) == [name]
    assert graph.k == 20
    graph.check()
    del graph
    newer.save(path)
    assert mapped(path, mesh).k == 5


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"file_bytes": 2**63}, "cut off after"),
        ({"vertex_count": 129}, "do not hold 129 vertices"),
        ({"fingerprint": 1}, "another mesh"),
        ({"k": 0}, "claims k = 0"),
        ({"target_bits": 8}, "another unit"),
        ({"quantum": float("nan")}, "another unit"),
        ({"longest_path": -1.0}, "another unit"),
        ({"longest_arc": 1e300}, "another unit"),
        ({"longest_arc": float("nan")}, "another unit"),
    ],
)
def test_headers_that_lie(fields: dict[str, object], says: str, mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / "g"
    path.write_bytes(GraphFile.of(saved).with_header(**fields).bytes())
    with pytest.raises(sb.InputError, match=says):
        mapped(path, mesh)


def test_files_that_are_none(mesh: sb.Mesh, tmp_path: Path) -> None:
    for contents in (b"", b"x", bytes(1000)):
        (tmp_path / "g").write_bytes(contents)
        with pytest.raises(sb.InputError, match="is no saddleback graph"):
            mapped(tmp_path / "g", mesh)
    for path, says in ((tmp_path, "is a folder"), (tmp_path / "none", "No such file")):
        with pytest.raises(sb.InputError, match=says):
            mapped(path, mesh)


def damage_longest(parts: GraphFile) -> None:
    parts.fixed["longest_arc"] = parts.header["longest_path"]


def damage_unit(parts: GraphFile) -> None:
    parts.fixed["least_exponent"] = int(parts.header["least_exponent"]) - 1


def damage_length(parts: GraphFile) -> None:
    parts.arcs[parts.row(7).start] ^= np.uint64(1 << max(parts.target_bits + 8, 26))


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (damage_longest, "it claims a longest arc"),
        (damage_unit, "another unit"),
        (damage_length, "no reverse of the same length"),
    ],
)
def test_check_finds_what_only_the_whole_tells(
    damage: Callable[[GraphFile], None], says: str, mesh: sb.Mesh, saved: bytes, tmp_path: Path
) -> None:
    parts = GraphFile.of(saved)
    damage(parts)
    (tmp_path / "g").write_bytes(parts.bytes())
    with pytest.raises(sb.InputError, match=f"is a damaged graph file: .*{says}"):
        mapped(tmp_path / "g", mesh).check()


def test_check_sums_the_file(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    for place in (-1, -5, -1000, len(saved) // 2):
        contents = bytearray(saved)
        contents[place] ^= 1
        (tmp_path / "g").write_bytes(contents)
        with pytest.raises(sb.InputError, match="its checksum is wrong"):
            mapped(tmp_path / "g", mesh).check()


def test_check_has_nothing_to_do_elsewhere(mesh: sb.Mesh) -> None:
    graph, job = sb.SaddleVertexGraph(mesh, k=5), sb.Job()
    job.cancel()
    graph.check(job=job)


def test_check_is_cancelled(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    (tmp_path / "g").write_bytes(saved)
    graph, job = mapped(tmp_path / "g", mesh), sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        graph.check(job=job)
    again = sb.Job()
    graph.check(job=again)
    assert (again.fraction, again.text) == (1.0, "Checking the graph")


def test_targets_out_of_range_are_refused_by_each_query(tmp_path: Path) -> None:
    """With 128 + 1 vertices eight bits of target can name nodes that there are not."""
    vertices, triangles = meshes.torus(16, 9)
    mesh, path = sb.Mesh(vertices, triangles), tmp_path / "g"
    sb.SaddleVertexGraph(mesh, k=20).save(path)
    parts = GraphFile.read(path)
    parts.arcs[parts.row(3).start] |= np.uint64(255)
    path.write_bytes(parts.bytes())
    says = "path: .* is a damaged graph file: an arc of the nodes 0 to 143 is no arc"
    for ask in (
        lambda graph: graph.distances([0]),
        lambda graph: graph.nearest([0, 1]),
        lambda graph: graph.fields([0, 1]),
        lambda graph: graph.distance(0, 1),
        lambda graph: graph.path(0, 100),
        lambda graph: sb.geodesic_voronoi(graph, [0, 100]),
        lambda graph: sb.centroidal_voronoi(graph, count=8),
    ):
        graph = mapped(path, mesh)
        for _ in range(2):
            with pytest.raises(sb.InputError, match=says):
                ask(graph)


def test_damage_never_crashes(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    """Right checksums: refused by a sentence, when it is opened or read, or answered with numbers."""
    rng = np.random.default_rng(3)
    refused = 0
    for i in range(400):
        contents = bytearray(saved[:-4])
        for _ in range(rng.integers(1, 5)):
            where = int(rng.integers(HEADER.size, len(contents) - 8))
            contents[where : where + 4] = rng.bytes(4)
        path = tmp_path / str(i)
        path.write_bytes(with_checksum(bytes(contents)))
        try:
            graph = mapped(path, mesh)
            graph.distances([0])
            graph.nearest([0, 5])
            graph.distance(0, 9)
            graph.path(0, 77)
        except sb.Error as error:
            refused += 1
            assert str(error).startswith((f"path: {path} ", "the arc from vertex "))
    assert refused > 200


def test_a_header_has_its_own_checksum(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    """Of what it says all else depends, and no query would tell."""
    for place in range(12, HEADER.size):
        contents = bytearray(saved)
        contents[place] ^= 4
        (tmp_path / str(place)).write_bytes(with_checksum(bytes(contents[:-4])))
        with pytest.raises(sb.InputError, match=r"is a damaged graph file: .*header"):
            mapped(tmp_path / str(place), mesh)
