# SPDX-License-Identifier: MIT
"""Graphs on disk: what was saved comes back to the bit, anything else is refused by a sentence, old files stay."""

from __future__ import annotations

import base64
import os
import stat
import subprocess
import sys
import threading
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import saddleback as sb
from tests import meshes
from tests.native.graph_files import HEADER, MAGIC, GraphFile, with_checksum

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no such names, modes, limits or devices")


@pytest.fixture(scope="module")
def torus() -> sb.SaddleVertexGraph:
    return sb.SaddleVertexGraph(sb.Mesh(*meshes.torus(16, 8)), k=20)


@pytest.fixture(scope="module")
def mesh() -> sb.Mesh:
    return sb.Mesh(*meshes.torus(16, 8))


@pytest.fixture(scope="module")
def saved(torus: sb.SaddleVertexGraph, tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("graph") / "torus.graph"
    torus.save(path)
    return path.read_bytes()


@pytest.mark.parametrize("case", meshes.good(), ids=str)
def test_round_trip(case: meshes.Case, tmp_path: Path) -> None:
    graph = sb.SaddleVertexGraph(case.mesh, k=min(20, len(case.vertices)))
    graph.save(tmp_path / "a")
    loaded = sb.SaddleVertexGraph.load(tmp_path / "a", sb.Mesh(case.vertices, case.triangles))
    for name in ("arc_count", "mean_degree", "nbytes", "k", "device"):
        assert getattr(loaded, name) == getattr(graph, name)
    assert loaded.build_seconds == 0 < graph.build_seconds
    point = sb.SurfacePoints([len(case.triangles) // 2], [[0.2, 0.3, 0.5]])
    for sources in ([0], [1, len(case.vertices) - 1], point):
        assert np.array_equal(loaded.distances(sources), graph.distances(sources))
    assert [*map(list, loaded.nearest([0, 2]))] == [*map(list, graph.nearest([0, 2]))]
    loaded.save(tmp_path / "b")
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_a_loaded_graph_keeps_its_mesh(saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / "g"
    path.write_bytes(saved)
    graph = sb.SaddleVertexGraph.load(path, sb.Mesh(*meshes.torus(16, 8)))
    assert graph.distances([3])[3] == 0


def test_the_format_is_what_it_says(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, saved: bytes) -> None:
    parts = GraphFile.of(saved)
    assert parts.bytes() == saved
    header = parts.header
    assert (header["magic"], header["version"], header["header_bytes"]) == (MAGIC, 2, HEADER.size)
    assert (header["vertex_count"], header["face_count"]) == (len(mesh.vertices), len(mesh.triangles))
    assert (header["arc_count"], header["k"], header["flags"]) == (torus.arc_count, 20, 0)
    assert header["file_bytes"] == len(saved)
    assert sorted(parts.vertices) == list(range(len(mesh.vertices)))
    assert parts.degrees.sum() == torus.arc_count == len(parts.arcs)
    assert saved[-4:] == zlib.crc32(saved[:-4]).to_bytes(4, "little")


@pytest.mark.parametrize("name", ["grüße 漢字 .graph", "-", "x" * 255, pytest.param("a\nb", marks=posix)])
def test_names(name: str, torus: sb.SaddleVertexGraph, mesh: sb.Mesh, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    for path in (name, os.fsencode(name), Path(name), tmp_path / name):
        torus.save(path)
        assert sb.SaddleVertexGraph.load(path, mesh).arc_count == torus.arc_count
        assert os.listdir(tmp_path) == [name]
        os.remove(name)


@posix
def test_bytes_that_are_no_text(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, tmp_path: Path) -> None:
    path = os.path.join(os.fsencode(tmp_path), b"\xff\xfe.graph")
    with pytest.raises(sb.InputError, match=r"\\xff\\xfe.graph cannot be opened"):
        sb.SaddleVertexGraph.load(path, mesh)
    torus.save(path)
    assert sb.SaddleVertexGraph.load(path, mesh).k == 20


def test_a_new_file_has_the_usual_permissions(torus: sb.SaddleVertexGraph, tmp_path: Path) -> None:
    torus.save(tmp_path / "g")
    (tmp_path / "other").touch()
    assert stat.S_IMODE((tmp_path / "g").stat().st_mode) == stat.S_IMODE((tmp_path / "other").stat().st_mode)


@posix
def test_a_link_stays_a_link(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to("there/file")
    for _ in range(2):  # to a file that is not there yet, and to one that is
        torus.save(tmp_path / "link")
        assert (tmp_path / "link").is_symlink()
        assert os.listdir(tmp_path / "there") == ["file"]
    assert sb.SaddleVertexGraph.load(tmp_path / "there/file", mesh).k == 20


def test_places_that_cannot_be_written(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, tmp_path: Path) -> None:
    for path, says in (
        (tmp_path / "none" / "g", "g cannot be written: No such file or directory; make its folder or choose"),
        (tmp_path / ("x" * 256), "cannot be written: File ?name too long; shorten it or choose"),
        (tmp_path, "is a folder; give the name of a file"),
        ("", "'' names no file"),
        (f"{tmp_path}/g/", "g/' names no file"),
        ("a\0b", "path: wanted a file's name"),
        (3, "path: wanted a str or os.PathLike, got a int"),
    ):
        with pytest.raises(sb.InputError, match=says):
            torus.save(path)
    for path, says in ((tmp_path, "is a folder"), (tmp_path / "g", "No such file")):
        with pytest.raises(sb.InputError, match=says):
            sb.SaddleVertexGraph.load(path, mesh)
    assert os.listdir(tmp_path) == []


@posix
def test_devices_are_no_files(torus: sb.SaddleVertexGraph, mesh: sb.Mesh) -> None:
    with pytest.raises(sb.InputError, match="/dev/full is no regular file"):
        torus.save("/dev/full")
    with pytest.raises(sb.InputError, match="no regular file"):
        sb.SaddleVertexGraph.load("/dev/null", mesh)
    assert stat.S_ISCHR(os.stat("/dev/full").st_mode)


def test_a_file_that_must_not_be_written_stays(torus: sb.SaddleVertexGraph, as_anyone: Path) -> None:
    path = as_anyone / "g"
    path.write_bytes(b"old")
    path.chmod(0o400)
    with pytest.raises(sb.InputError, match=r"g cannot be written: Permission denied; .*allow it or choose"):
        torus.save(path)
    assert (path.read_bytes(), os.listdir(as_anyone)) == (b"old", ["g"])
    path.chmod(0o600)


FULL_DISK = """
import resource, sys
import saddleback as sb
from tests import meshes
graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus(16, 8)), k=20)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    graph.save(sys.argv[1])
except sb.InputError as error:
    sys.exit(str(error))
"""


@posix
@pytest.mark.parametrize("room", [0, 50, 5000, -1])
def test_a_full_disk_leaves_the_old_file(room: int, saved: bytes, tmp_path: Path) -> None:
    """The limit on a file's size stands for the disk's end; -1: one byte too few."""
    room = room if room >= 0 else len(saved) - 1
    path = tmp_path / "g"
    path.write_bytes(b"old")
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, path, str(room)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 1
    assert f"path: {path} cannot be written: File too large; make room" in done.stderr
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["g"]


def test_cancelling(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path, job = tmp_path / "g", sb.Job()
    path.write_bytes(saved)
    job.cancel()
    for call in (lambda: torus.save(path, job=job), lambda: sb.SaddleVertexGraph.load(path, mesh, job=job)):
        with pytest.raises(sb.Cancelled):
            call()
    assert path.read_bytes() == saved
    assert os.listdir(tmp_path) == ["g"]


def test_cancelling_in_the_middle_leaves_nothing(tmp_path: Path) -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(150, 150)), k=60)
    path = tmp_path / "g"
    path.write_bytes(b"old")
    for moment in np.linspace(0, 0.02, 8):
        job, outcome = sb.Job(), []

        def work(job: sb.Job = job, outcome: list[object] = outcome) -> None:
            try:
                while True:
                    graph.save(tmp_path / "other", job=job)
                    (tmp_path / "other").unlink()
            except sb.Cancelled:
                outcome.append("cancelled")

        thread = threading.Thread(target=work)
        thread.start()
        time.sleep(moment)
        job.cancel()
        thread.join(60)
        assert outcome == ["cancelled"]
        assert os.listdir(tmp_path) == ["g"]


def test_progress(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, tmp_path: Path) -> None:
    job = sb.Job()
    torus.save(tmp_path / "g", job=job)
    assert (job.fraction, job.text) == (1.0, "Saving the graph")
    sb.SaddleVertexGraph.load(tmp_path / "g", mesh, job=job)
    assert (job.fraction, job.text) == (1.0, "Loading the graph")


def refusal(contents: bytes, mesh: sb.Mesh, path: Path) -> str:
    path.write_bytes(contents)
    with pytest.raises(sb.InputError) as error:
        sb.SaddleVertexGraph.load(path, mesh)
    text = str(error.value)
    assert text.startswith(f"path: {path} ")
    assert "\n" not in text
    return text.removeprefix(f"path: {path} ")


def test_foreign_files(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / "g"
    for contents in (b"", b"x", b"ply\nformat ascii 1.0\n" * 20, bytes(1000), saved[8:], saved.replace(b"\r\n", b"\n")):
        assert refusal(contents, mesh, path).startswith("is no saddleback graph; ")
    newer = refusal(GraphFile.of(saved).with_header(version=3).bytes(), mesh, path)
    assert newer.startswith("has version 3 of the graph format, newer than the 2 that this library reads")


def test_bytes_depend_on_the_graph_alone(torus: sb.SaddleVertexGraph, mesh: sb.Mesh, saved: bytes, tmp_path) -> None:
    again = sb.SaddleVertexGraph(mesh, k=20, threads=1)
    again.save(tmp_path / "g")
    assert again.build_seconds != torus.build_seconds
    assert (tmp_path / "g").read_bytes() == saved


# The graph of a tetrahedron, k=3, as version 0.1.0 saved it.
OLD_FILE = (
    "iVNWR3INChoBAAAAYAAAAOQAAAAAAAAAYPzowXfPwdMEAAAAAAAAAAQAAAAAAAAADAAAAAAAAAADAAAAAAAAAAAAAAAAAAAA/XHuu5GVmz8CAA"
    "AA2f///wAAAAAAAOA8AwAAAAIAAAAAAAAAAQAAAAMAAAADAAAAAwAAAAMAAAACAACgmSeooVUBAKCZJ6ihqwIAoJknqKECAACgmSeooVcBAKCZ"
    "J6ihqAIAoJknqKEDAACgmSeooVUBAKCZJ6ihqAIAoJknqKEBAACgmSeooVYBAKCZJ6ihqAIAoJknqKHNEQ8o"
)


def test_old_files_still_open(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path, tetrahedron = tmp_path / "g", sb.Mesh(*meshes.tetrahedron())
    for contents, surface, graph in (
        (base64.b64decode(OLD_FILE), tetrahedron, sb.SaddleVertexGraph(tetrahedron, k=3)),
        (GraphFile.of(saved).bytes_of_version_1(), mesh, sb.SaddleVertexGraph(mesh, k=20)),
    ):
        path.write_bytes(contents)
        graph.save(tmp_path / "new")
        for mmap in (False, True):
            old = sb.SaddleVertexGraph.load(path, surface, mmap=mmap)
            old.check()
            assert old.build_seconds == 0
            old.save(tmp_path / "again")
            assert (tmp_path / "again").read_bytes() == (tmp_path / "new").read_bytes()


def test_graphs_of_other_meshes(saved: bytes, tmp_path: Path) -> None:
    vertices, triangles = meshes.torus(16, 8)
    path = tmp_path / "g"
    other = refusal(saved, sb.Mesh(*meshes.torus(16, 9)), path)
    assert other.startswith("holds the graph of another mesh (128 vertices and 256 faces; this mesh has 144 and 288)")
    moved = vertices.copy()
    moved[5] += 1e-9
    assert "other positions or triangles" in refusal(saved, sb.Mesh(moved, triangles), path)
    assert "other positions or triangles" in refusal(saved, sb.Mesh(vertices, triangles[:, [1, 2, 0]]), path)


def test_cut_off_and_drawn_out(mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    path = tmp_path / "g"
    for size in (8, 12, 95, 96, 111, 112, 116, len(saved) // 2, len(saved) - 4, len(saved) - 1):
        assert refusal(saved[:size], mesh, path).startswith("is a damaged graph file: it is cut off after ")
    assert "goes on for 1 bytes behind its end" in refusal(saved + b"\0", mesh, path)
    parts = GraphFile.of(saved)
    parts.behind = bytes(8)
    assert f"its {len(saved) + 8} bytes do not hold 128 vertices" in refusal(parts.bytes(), mesh, path)


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"version": 0}, "claims version 0"),
        ({"header_bytes": 97}, "claims version 2 with 97 bytes instead of 112"),
        ({"version": 1}, "claims version 1 with 112 bytes instead of 96"),
        ({"file_bytes": 2**63}, "cut off after"),
        ({"vertex_count": 129}, "do not hold 129 vertices"),
        ({"vertex_count": 2**64 - 1, "arc_count": 2**61}, "do not hold"),
        ({"arc_count": 2**61 + 1}, "do not hold 128 vertices and 2305843009213693953 arcs"),
        ({"face_count": 1}, "another mesh"),
        ({"fingerprint": 1}, "another mesh"),
        ({"k": 0}, "claims k = 0, accuracy = 0"),
        ({"k": 129}, "claims k = 129"),
        ({"k": 2**32 - 1}, "claims k = 4294967295"),
        ({"flags": 2}, "the flags 2"),
        ({"accuracy": 0.01}, "accuracy = 0.01"),
        ({"accuracy": float("nan")}, "accuracy = nan"),
        ({"longest_path": -1.0}, "another unit"),
        ({"longest_path": float("inf")}, "another unit"),
        ({"longest_arc": 0.0}, "a longest arc of 0 instead of"),
        ({"longest_arc": float("nan")}, "a longest arc of nan instead of"),
        ({"target_bits": 8}, "another unit"),
        ({"least_exponent": -2000}, "another unit"),
        ({"quantum": float("nan")}, "another unit"),
    ],
)
def test_headers_that_lie(fields: dict[str, object], says: str, mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    assert says in refusal(GraphFile.of(saved).with_header(**fields).bytes(), mesh, tmp_path / "g")


def damage_order(parts: GraphFile) -> None:
    parts.vertices[3] = parts.vertices[4]


def damage_order_out_of_range(parts: GraphFile) -> None:
    parts.vertices[3] = -2


def damage_degrees(parts: GraphFile) -> None:
    parts.degrees[5] += 1


def damage_degrees_hugely(parts: GraphFile) -> None:
    parts.degrees[:] = 2**32 - 1


def damage_target(parts: GraphFile) -> None:
    """Own node."""
    arc = parts.row(7).start
    parts.arcs[arc] = parts.arcs[arc] - np.uint64(parts.targets()[arc]) + np.uint64(7)


def damage_twice(parts: GraphFile) -> None:
    parts.arcs[1] = parts.arcs[0]


def damage_length(parts: GraphFile) -> None:
    """The last bit that is kept of a length, in one direction."""
    parts.arcs[parts.row(7).start] ^= np.uint64(1 << max(parts.target_bits + 8, 26))


def damage_exponent(parts: GraphFile) -> None:
    """Thousands of millions of times shorter."""
    parts.arcs[parts.row(7).start] &= ~np.uint64(3 << 62)


def damage_spare_bits(parts: GraphFile) -> None:
    parts.arcs[parts.row(7).start] ^= np.uint64(1 << (parts.target_bits + 8))


def damage_reverse(parts: GraphFile) -> None:
    """An arc goes missing in one row only."""
    row = parts.row(7)
    parts.arcs = np.delete(parts.arcs, row.start)
    parts.degrees[7] -= 1


def damage_rows(parts: GraphFile) -> None:
    """Two rows change places."""
    parts.degrees[[7, 8]] = parts.degrees[[8, 7]]
    a, b = parts.row(7), parts.row(8)
    parts.arcs[a.start : b.stop] = np.roll(parts.arcs[a.start : b.stop], a.stop - a.start)


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        (damage_order, "node 4 is vertex"),
        (damage_order_out_of_range, "node 3 is vertex -2, which is out of range"),
        (damage_degrees, "its rows hold"),
        (damage_degrees_hugely, "its rows hold"),
        (damage_target, "leads back to it"),
        (damage_twice, "a second time"),
        (damage_length, "no reverse of the same length"),
        (damage_exponent, "no multiple of the unit"),
        (damage_spare_bits, "no multiple of the unit"),
        (damage_reverse, "without their reverses|has no reverse"),
        (damage_rows, "an arc of node"),
    ],
)
def test_contents_that_lie(damage, says: str, mesh: sb.Mesh, saved: bytes, tmp_path: Path) -> None:
    """The checksum is right: only a look at the numbers themselves tells."""
    parts = GraphFile.of(saved)
    damage(parts)
    text = refusal(parts.bytes(), mesh, tmp_path / "g")
    assert text.startswith("is a damaged graph file: ")
    assert any(part in text for part in says.split("|")), text


def test_arcs_between_components(tmp_path: Path) -> None:
    """Two components may not be joined: their distance is infinite, whatever a file says."""
    mesh = sb.Mesh(*meshes.merge(meshes.tetrahedron(), meshes.tetrahedron()))
    sb.SaddleVertexGraph(mesh, k=3).save(tmp_path / "g")
    parts = GraphFile.read(tmp_path / "g")
    is_first = mesh.components[parts.vertices] == 0
    arc = parts.row(int(np.flatnonzero(is_first)[0])).start
    stranger = int(np.flatnonzero(~is_first)[0])
    parts.arcs[arc] ^= np.uint64(parts.targets()[arc] ^ stranger)
    assert "of another component" in refusal(parts.bytes(), mesh, tmp_path / "g")


def test_targets_out_of_range(tmp_path: Path) -> None:
    """With five vertices three bits of target can name nodes that there are not."""
    turn = np.arange(4) * 0.6
    vertices = np.vstack([[0, 0, 0], np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])])
    mesh = sb.Mesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 4]])
    sb.SaddleVertexGraph(mesh, k=2).save(tmp_path / "g")
    parts = GraphFile.read(tmp_path / "g")
    parts.arcs[0] |= np.uint64(7)
    assert "leads to node 7, which there is not" in refusal(parts.bytes(), mesh, tmp_path / "g")


def attempt(contents: bytes, mesh: sb.Mesh, path: Path) -> None:
    """Refused by a sentence, or a graph with which all goes well."""
    path.write_bytes(contents)
    try:
        graph = sb.SaddleVertexGraph.load(path, mesh)
    except sb.InputError as error:
        assert str(error).startswith(f"path: {path} ")
        return
    distances = graph.distances([0])
    assert (distances >= 0).all()
    assert graph.distances([5])[0] == distances[5]


@settings(max_examples=200, deadline=None)
@given(position=st.integers(0, 2**20), flip=st.integers(1, 255))
def test_every_flipped_byte_is_seen(position: int, flip: int, mesh: sb.Mesh, saved: bytes, tmp_path_factory) -> None:
    contents = bytearray(saved)
    contents[position % len(saved)] ^= flip
    refusal(bytes(contents), mesh, tmp_path_factory.getbasetemp() / "flipped")


@settings(max_examples=200, deadline=None)
@given(data=st.data())
def test_damage_behind_a_right_checksum(data: st.DataObject, mesh: sb.Mesh, saved: bytes, tmp_path_factory) -> None:
    contents = bytearray(saved[:-4])
    for _ in range(data.draw(st.integers(1, 4))):
        where = data.draw(st.integers(8, len(contents) - 8) | st.integers(8, HEADER.size))
        new = data.draw(st.binary(min_size=1, max_size=8))
        contents[where : where + len(new)] = new
    attempt(with_checksum(bytes(contents)), mesh, tmp_path_factory.getbasetemp() / "damaged")


@settings(max_examples=100, deadline=None)
@given(size=st.integers(0, 2**20))
def test_every_truncation_is_seen(size: int, mesh: sb.Mesh, saved: bytes, tmp_path_factory) -> None:
    refusal(saved[: size % len(saved)], mesh, tmp_path_factory.getbasetemp() / "cut")


def test_a_size_beyond_the_file_takes_no_memory(saved: bytes, mesh: sb.Mesh, tmp_path: Path) -> None:
    """A small file that claims a thousand million arcs is refused before memory is taken for them."""
    resource = pytest.importorskip("resource", reason="what memory a program took is told by POSIX alone")
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    contents = GraphFile.of(saved).with_header(arc_count=10**9, file_bytes=96 + 8 * 128 + 8 * 10**9 + 4).bytes()
    assert "cut off" in refusal(contents, mesh, tmp_path / "g")
    assert "do not hold" in refusal(GraphFile.of(saved).with_header(arc_count=10**9).bytes(), mesh, tmp_path / "g")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 64 * 1024
