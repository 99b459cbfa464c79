# SPDX-License-Identifier: MIT
"""Damaged graph files: each is refused by one sentence or loaded as a graph with which all goes well.

Half of the cases get the right checksum for their damage, so that what lies behind it is reached.
"""

from __future__ import annotations

import functools
import tempfile
from pathlib import Path

import meshes
import numpy as np
from native.graph_files import HEADER, GraphFile, with_checksum

import saddleback as sb

STRANGE_BYTES = (0x00, 0x01, 0x7F, 0x80, 0xFF)
STRANGE_REALS = (np.nan, np.inf, -np.inf, 0.0, -0.0, -1.0, 0.5, 1.0, 1e-308, 5e-324, 1e308)
STRANGE_INTEGERS = (0, 1, 2, 3, 7, 127, 128, 255, 256, 2**31 - 1, 2**31, 2**32 - 1, 2**61, 2**63, 2**64 - 1)


@functools.cache
def folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="saddleback-fuzz-"))


@functools.cache
def seedlings() -> list[tuple[sb.Mesh, bytes]]:
    """Small meshes of all kinds, and the files of their graphs."""
    made = []
    for case in meshes.good():
        if len(case.vertices) > 300:
            continue
        for k in {1, min(10, len(case.vertices)), len(case.vertices)}:
            path = folder() / "seedling"
            sb.SaddleVertexGraph(case.mesh, k=k, threads=1).save(path)
            made.append((case.mesh, path.read_bytes()))
    return made


def mutated(contents: bytes, rng: np.random.Generator) -> bytes:
    """Bytes changed, swapped, cut out, put in, cut off; the first ones more often, for there lies the header."""
    data = bytearray(contents)
    for _ in range(int(rng.integers(1, 5))):
        size = len(data)
        at = int(rng.integers(min(size, HEADER.size) if rng.random() < 0.3 else size)) if size else 0
        length = int(rng.integers(1, 17))
        accident = rng.integers(7)
        if accident == 0:
            data[at : at + 1] = bytes([data[at] ^ (1 << int(rng.integers(8)))]) if size else b""
        elif accident == 1:
            data[at : at + 1] = bytes([STRANGE_BYTES[rng.integers(len(STRANGE_BYTES))]])
        elif accident == 2:
            data[at : at + length] = rng.bytes(min(length, size - at))
        elif accident == 3:
            other = int(rng.integers(size)) if size else 0
            data[at : at + length] = data[other : other + min(length, size - at)]
        elif accident == 4:
            del data[at : at + length]
        elif accident == 5:
            data[at:at] = rng.bytes(length)
        else:
            del data[at:]
    return bytes(data)


def rewritten(contents: bytes, rng: np.random.Generator) -> bytes:
    """Fields of the header and of the arrays changed one by one, lengths and checksum right."""
    parts = GraphFile.of(contents)
    for _ in range(int(rng.integers(1, 4))):
        what = rng.integers(6)
        if what == 0:
            name = str(rng.choice(list(parts.header)[1:]))
            strange = STRANGE_REALS if isinstance(parts.header[name], float) else STRANGE_INTEGERS
            value = strange[rng.integers(len(strange))]
            limit = {"target_bits": 2**31, "least_exponent": 2**31, "k": 2**32, "flags": 2**32, "version": 2**32}
            parts.fixed[name] = value if isinstance(value, float) else value % limit.get(name, 2**64)
            if name == "header_bytes":
                parts.fixed[name] = int(value) % 2**32
        elif what == 1:
            i, j = rng.integers(len(parts.vertices), size=2)
            parts.vertices[i] = parts.vertices[j] if rng.random() < 0.5 else rng.integers(-(2**31), 2**31)
        elif what == 2:
            i, j = rng.integers(len(parts.degrees), size=2)
            parts.degrees[i] += np.uint32(1)
            parts.degrees[j] -= np.uint32(1)
        elif what == 3:
            parts.arcs[rng.integers(len(parts.arcs))] ^= np.uint64(1 << int(rng.integers(64)))
        elif what == 4:
            i, j = rng.integers(len(parts.arcs), size=2)
            parts.arcs[i] = parts.arcs[j]
        else:
            change_edge(parts, rng)
    with np.errstate(all="ignore"):
        return parts.bytes()


def change_edge(parts: GraphFile, rng: np.random.Generator) -> None:
    """An arc and its reverse changed alike: a graph still, though not of this surface."""
    if parts.degrees.sum() != len(parts.arcs):
        return
    rows = np.repeat(np.arange(len(parts.degrees)), parts.degrees)
    targets = parts.targets()
    arc = int(rng.integers(len(parts.arcs)))
    pair = (rows == rows[arc]) & (targets == targets[arc]) | (rows == targets[arc]) & (targets == rows[arc])
    parts.arcs[pair] ^= np.uint64(1 << int(rng.integers(parts.target_bits, 64)))


def use(graph: sb.SaddleVertexGraph, mesh: sb.Mesh, rng: np.random.Generator) -> None:
    """What a loaded graph promises even if it was not built for this surface."""
    a, b = (int(v) for v in rng.integers(len(mesh.vertices), size=2))
    there, back = graph.distances([a]), graph.distances([b])
    assert there[b] == back[a]
    assert (there >= 0).all()
    assert np.array_equal(there, graph.distances([a], method="dijkstra"))
    assert np.array_equal(np.isfinite(there), mesh.components == mesh.components[a])
    graph.distances(sb.SurfacePoints([len(mesh.triangles) - 1], [[0.2, 0.3, 0.5]]))


def case(seed: int) -> str:
    """Outcome of one case in a word."""
    rng = np.random.default_rng(seed)
    mesh, contents = seedlings()[rng.integers(len(seedlings()))]
    kind = rng.integers(4)
    if kind < 2:
        damaged = mutated(contents, rng)
    elif kind == 2:
        damaged = with_checksum(mutated(contents[:-4], rng))
    else:
        damaged = rewritten(contents, rng)
    path = folder() / "damaged"
    path.write_bytes(damaged)
    try:
        graph = sb.SaddleVertexGraph.load(path, mesh)
    except sb.InputError as error:
        text = str(error)
        assert text.startswith(f"path: {path} "), text
        assert "\n" not in text, text
        assert damaged != contents
        return "refused"
    if damaged == contents:
        return "unharmed"
    assert kind >= 2, "damage passed the checksum"
    use(graph, mesh, rng)
    return "graph"
