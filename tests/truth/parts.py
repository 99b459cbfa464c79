# SPDX-License-Identifier: MIT
"""Truths of graphs found in parts: a graph built at once, which neither lays tables for ranges nor joins any."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

import saddleback as sb
from tests.truth.distances import Random
from tests.truth.graph import random_rule
from tests.truth.registry import guards


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
