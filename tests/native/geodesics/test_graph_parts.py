# SPDX-License-Identifier: MIT
"""Graphs found in parts: the bytes of the graph built at once, however many parts there are, and whatever does not
belong together is refused by a sentence.
"""

from __future__ import annotations

import functools
import pickle
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.geodesics.test_border_strips import between, circle, fan

# Thousands of vertices each, so that parts have halos and windows leave them: flat places, where they go far, borders
# and strips along them, needles, saddles, several components.
SURFACES: dict[str, Callable[[], meshes.Arrays]] = {
    "icosphere": lambda: meshes.icosphere(4),
    "torus": lambda: meshes.torus(90, 50),
    "plane": lambda: meshes.grid(70, 70),
    "uneven plane": lambda: meshes.grid(64, 64, jitter=0.3),
    "spikes": lambda: meshes.spikes(50),
    "cylinder": lambda: meshes.cylinder(600, 5),
    "fan": lambda: fan(3000, 0.4, 0.2),
    "ring of needles": lambda: between(circle(1500, 1.0, 0.0), circle(1500, 1.0, 2.0, 0.3), closed=True),
    "graded disk": lambda: meshes.graded_disk(1e-5, 150, 24),
    "several": lambda: meshes.merge(meshes.icosphere(3), meshes.grid(40, 40), meshes.needles(4, 300)),
}
RULES = ({"k": 30}, {"accuracy": 5e-3})
COUNTS = (1, 2, 7, 64)


@functools.cache
def surface(name: str) -> sb.Mesh:
    return sb.Mesh(*SURFACES[name]())


def file_of(graph: sb.SaddleVertexGraph, folder: Path) -> bytes:
    graph.save(folder / "graph")
    return (folder / "graph").read_bytes()


def united(found: list[bytes]) -> list[bytes]:
    return [
        sb.unite_arcs(arcs, [sb.arcs_across(other, part) for other in found if other is not arcs])
        for part, arcs in enumerate(found)
    ]


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("rule", RULES, ids=lambda rule: next(iter(rule)))
def test_the_same_bytes_as_at_once(name: str, rule: dict[str, float], tmp_path: Path) -> None:
    mesh = surface(name)
    right = file_of(sb.SaddleVertexGraph(mesh, **rule), tmp_path)
    for count in COUNTS:
        found = [sb.find_arcs(mesh, part, count, **rule) for part in range(count)]
        for parts in (found, united(found)) if count <= 7 else (found,):
            assert file_of(sb.SaddleVertexGraph.from_parts(mesh, parts[::-1]), tmp_path) == right, count


def test_parts_do_not_depend_on_threads_or_instructions() -> None:
    mesh = surface("torus")
    first = sb.find_arcs(mesh, 1, 3, threads=1)
    assert first == sb.find_arcs(mesh, 1, 3, threads=3) == sb.find_arcs(mesh, 1, 3, instructions="plain")
    others = [sb.arcs_across(sb.find_arcs(mesh, part, 3), 1) for part in (0, 2)]
    assert sb.unite_arcs(first, others, threads=1) == sb.unite_arcs(first, others[::-1], threads=3)


def test_the_accuracy_is_the_usual_one_unless_it_is_said(tmp_path: Path) -> None:
    mesh = surface("torus")
    joined = sb.SaddleVertexGraph.from_parts(mesh, [sb.find_arcs(mesh, part, 2) for part in range(2)])
    assert (joined.accuracy, joined.k, joined.device, joined.is_exact) == (5e-3, None, "cpu", False)
    assert joined.build_seconds > 0
    assert file_of(joined, tmp_path) == file_of(sb.SaddleVertexGraph(mesh), tmp_path)


def test_parts_are_about_equal_and_some_may_be_empty() -> None:
    mesh = surface("icosphere")
    sizes = [len(sb.find_arcs(mesh, part, 4, k=10)) for part in range(4)]
    assert max(sizes) < 1.3 * min(sizes)
    small = sb.Mesh(*meshes.tetrahedron())
    parts = [sb.find_arcs(small, part, 3) for part in range(3)]
    assert np.isfinite(sb.SaddleVertexGraph.from_parts(small, united(parts)).distances([0])).all()


ELSEWHERE = """
import sys, pickle
import saddleback as sb
mesh, part, parts = pickle.load(sys.stdin.buffer)
sys.stdout.buffer.write(pickle.dumps(sb.find_arcs(mesh, part, parts, threads=1)))
"""


def test_parts_of_other_processes(tmp_path: Path) -> None:
    mesh = surface("uneven plane")
    tasks = [
        subprocess.Popen([sys.executable, "-c", ELSEWHERE], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        for _ in range(3)
    ]
    answers = [task.communicate(pickle.dumps((mesh, part, 3)), timeout=120)[0] for part, task in enumerate(tasks)]
    joined = sb.SaddleVertexGraph.from_parts(mesh, [pickle.loads(answer) for answer in answers])
    assert file_of(joined, tmp_path) == file_of(sb.SaddleVertexGraph(mesh), tmp_path)


def test_bytes_of_any_kind_and_place(tmp_path: Path) -> None:
    mesh = surface("icosphere")
    parts = [sb.find_arcs(mesh, part, 2, k=10) for part in range(2)]
    shifted = memoryview(b"x" + parts[1])[1:]  # at an odd address
    joined = sb.SaddleVertexGraph.from_parts(mesh, iter([bytearray(parts[0]), shifted]))
    assert file_of(joined, tmp_path) == file_of(sb.SaddleVertexGraph(mesh, k=10), tmp_path)


def test_a_joined_graph_keeps_its_mesh_but_not_its_parts() -> None:
    parts = [sb.find_arcs(sb.Mesh(*meshes.torus()), part, 2) for part in range(2)]
    graph = sb.SaddleVertexGraph.from_parts(sb.Mesh(*meshes.torus()), parts)
    del parts
    assert graph.distances([3])[3] == 0


def test_cancelling_and_progress() -> None:
    mesh, job = surface("icosphere"), sb.Job()
    parts = [sb.find_arcs(mesh, part, 2, job=job) for part in range(2)]
    assert (job.fraction, job.text) == (1.0, "Finding arcs")
    united_part = sb.unite_arcs(parts[0], [sb.arcs_across(parts[1], 0)], job=job)
    assert (job.fraction, job.text, type(united_part)) == (1.0, "Uniting arcs", bytes)
    sb.SaddleVertexGraph.from_parts(mesh, parts, job=job)
    assert (job.fraction, job.text) == (1.0, "Joining the graph")
    job = sb.Job()
    job.cancel()
    for call in (
        lambda: sb.find_arcs(mesh, 0, 2, job=job),
        lambda: sb.unite_arcs(parts[0], [sb.arcs_across(parts[1], 0)], job=job),
        lambda: sb.SaddleVertexGraph.from_parts(mesh, parts, job=job),
    ):
        with pytest.raises(sb.Cancelled):
            call()


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((0, 0), "parts: wanted at least 1, got 0"),
        ((-1, 3), "part: wanted 0 to 2, since there are 3 parts, got -1"),
        ((3, 3), "part: wanted 0 to 2"),
        ((0.5, 3), "part: wanted an? int"),
        ((0, "3"), "parts: wanted an? int"),
    ],
)
def test_parts_that_are_none(arguments: tuple[int, int], says: str) -> None:
    with pytest.raises(sb.InputError, match=says):
        sb.find_arcs(surface("icosphere"), *arguments)


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"k": 0}, "k: wanted at least 1"),
        ({"k": 10**6}, "k: 1000000 vertices"),
        ({"accuracy": 1.0}, "accuracy: wanted a relative error above 0 and below 1"),
        ({"accuracy": float("nan")}, "accuracy: wanted"),
        ({"k": 3, "accuracy": 0.1}, "give one of them"),
        ({"threads": -1}, "threads: wanted 0"),
        ({"instructions": "mmx"}, "instructions"),
    ],
)
def test_options_as_of_graphs(options: dict[str, float], says: str) -> None:
    with pytest.raises(sb.InputError, match=says):
        sb.find_arcs(surface("icosphere"), 0, 2, **options)


MESH = sb.Mesh(*meshes.icosphere(3))
OTHER = sb.Mesh(*meshes.icosphere(3, radius=2.0))
PARTS = [sb.find_arcs(MESH, part, 3, k=10) for part in range(3)]


def rewritten(part: bytes, position: int, value: bytes) -> bytes:
    """With other bytes in the header, and the right checksum."""
    changed = part[:position] + value + part[position + len(value) : -4]
    return changed + struct.pack("<I", zlib.crc32(changed))


VERSION = 120  # where a header has the library's version
PACKED = 136  # where its first word begins


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([], "parts: wanted the arcs of all parts, got none"),
        (PARTS[:2], "parts: part 2 of 3 is missing; give the arcs of all parts"),
        ([*PARTS, PARTS[1]], r"parts: part 1 of 3 is given twice, as parts\[1\] and parts\[3\]; give each once"),
        ([PARTS[0], PARTS[1], sb.find_arcs(OTHER, 2, 3, k=10)], r"parts\[2\]: its arcs are of another mesh than those"),
        ([sb.find_arcs(OTHER, part, 3, k=10) for part in range(3)], "parts: these are the arcs of another mesh"),
        ([PARTS[0], sb.find_arcs(MESH, 1, 3, k=11)], r"parts\[1\]: its arcs were found with k=11, those of .* k=10"),
        ([PARTS[0], sb.find_arcs(MESH, 1, 3)], r"parts\[1\]: its arcs were found with accuracy=0.005, those of"),
        ([PARTS[0], sb.find_arcs(MESH, 1, 2, k=10)], r"parts\[1\]: it is one of 2 parts, parts\[0\] one of 3"),
        ([PARTS[0], PARTS[1][:-1]], r"parts\[1\]: these bytes are cut off after .* find the arcs of that part again"),
        ([PARTS[0], PARTS[1] + b"x"], r"parts\[1\]: these .* bytes do not hold"),
        ([PARTS[0], PARTS[1][:50]], r"parts\[1\]: these bytes are cut off after 50"),
        ([PARTS[0][:-5] + b"?" + PARTS[0][-4:]], r"parts\[0\]: these bytes are damaged: their checksum is wrong"),
        ([rewritten(PARTS[0], PACKED, b"\xff" * 8)], r"parts\[0\]: these bytes are damaged: they hold numbers out of"),
        ([b"", PARTS[1]], r"parts\[0\]: these bytes are no part of a graph; give arcs that find_arcs returned"),
        ([b"ply\nformat ascii 1.0\n" * 99], "no part of a graph"),
        ([PARTS[0], 3], r"parts\[1\]: wanted bytes, got a int"),
        ([PARTS[0], "text"], r"parts\[1\]: wanted bytes, got a str"),
        (PARTS[0], "parts: wanted a list of bytes, got a bytes"),
        (3, "parts: wanted a list of bytes, got a int"),
        ([sb.arcs_across(PARTS[0], 1)], r"parts\[0\]: these are arcs that arcs_across returned; give arcs that find_"),
        ([*PARTS[:2], united(PARTS)[2]], r"parts\[2\]: found and united arcs do not go together"),
    ],
)
def test_parts_that_do_not_belong_together(parts: object, says: str) -> None:
    with pytest.raises(sb.InputError, match=says):
        sb.SaddleVertexGraph.from_parts(MESH, parts)


def test_parts_of_other_versions() -> None:
    older = rewritten(PARTS[1], VERSION, b"0.0.7".ljust(16, b"\0"))
    says = rf"parts\[1\]: found by version 0.0.7 of the library, and this is {sb.__version__}, which may find other"
    with pytest.raises(sb.VersionError, match=says):
        sb.SaddleVertexGraph.from_parts(MESH, [PARTS[0], older, PARTS[2]])
    newer = rewritten(PARTS[1], 8, struct.pack("<I", 2))
    with pytest.raises(sb.VersionError, match=r"parts\[1\]: these bytes have version 2 of the format, newer than"):
        sb.SaddleVertexGraph.from_parts(MESH, [PARTS[0], newer, PARTS[2]])


@pytest.mark.parametrize(
    ("arcs", "across", "says"),
    [
        (PARTS[0], [], "across: the arcs from part 1 of 3 are missing"),
        (PARTS[0], [sb.arcs_across(PARTS[1], 0)] * 2, "across: the arcs from part 1 are given twice"),
        (PARTS[0], [sb.arcs_across(PARTS[1], 2)], r"across\[0\]: its arcs lead into part 2, and this is part 0"),
        (PARTS[0], [PARTS[1]], r"across\[0\]: these are arcs that find_arcs returned; give arcs that arcs_across"),
        (PARTS[0], [sb.arcs_across(sb.find_arcs(OTHER, 1, 3, k=10), 0)], r"across\[0\]: its arcs are of another mesh"),
        (sb.arcs_across(PARTS[1], 0), [], "arcs: these are arcs that arcs_across returned; give arcs that find_arcs"),
        (7, [], "arcs: wanted bytes, got a int"),
    ],
)
def test_arcs_that_do_not_lead_here(arcs: bytes, across: list[bytes], says: str) -> None:
    with pytest.raises(sb.InputError, match=says):
        sb.unite_arcs(arcs, across)


def test_arcs_across_lead_elsewhere() -> None:
    for part in (0, -1, 3):
        with pytest.raises(sb.InputError, match=f"part: wanted one of the 3 parts other than .*, got {part}"):
            sb.arcs_across(PARTS[0], part)


def test_damage_never_crashes() -> None:
    """Right checksums: what is used as an index is looked at before."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        part = bytearray(PARTS[1])
        for _ in range(rng.integers(1, 4)):
            where = int(rng.integers(8, 136) if rng.random() < 0.4 else rng.integers(8, len(part) - 4))
            part[where : where + 4] = rng.bytes(4)
        changed = bytes(part[: len(PARTS[1]) - 4])
        changed += struct.pack("<I", zlib.crc32(changed))
        try:
            sb.SaddleVertexGraph.from_parts(MESH, [PARTS[0], changed, PARTS[2]]).distances([0])
        except sb.InputError as refusal:
            assert str(refusal).startswith("parts")


def test_sizes_that_no_graph_has() -> None:
    """A simulated size: such a mesh would take 18 GB. docs/scale.md tells the same number."""
    most = (2**31 - 1) // 8 // 3
    assert f"{most:,}" in (Path(__file__).parents[3] / "docs" / "scale.md").read_text(encoding="utf-8")
    sb._saddleback._check_graph_size(most)
    says = f"mesh: {most + 1} triangles are more than a graph can be built for .{most}.; exact_distances needs no graph"
    with pytest.raises(sb.InputError, match=says):
        sb._saddleback._check_graph_size(most + 1)
