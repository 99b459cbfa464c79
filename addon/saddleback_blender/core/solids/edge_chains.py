# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges of lines, in any order -> the lines."""

from __future__ import annotations

from collections.abc import Iterator

from ..results import Indices


def chains(count: int, edges: Indices) -> list[tuple[list[int], bool]]:
    """Vertices of each line of two or more, and whether it is closed, for edges (n, 2) between `count` vertices.

    A line runs from its end of lower number, a closed one from its lowest vertex to the lower of that one's neighbors.
    Where more than two edges meet lines end.
    """
    around: list[list[int]] = [[] for _ in range(count)]
    for a, b in sorted({(min(edge), max(edge)) for edge in edges.tolist() if edge[0] != edge[1]}):
        around[a].append(b)
        around[b].append(a)
    used: set[tuple[int, int]] = set()
    found = []
    for first in [vertex for vertex in range(count) if len(around[vertex]) != 2]:
        for second in around[first]:
            line = [first, *_walk(around, first, second, used)]
            if len(line) > 1:
                found.append((line, False))
    for first in range(count):
        if len(around[first]) == 2:
            line = list(_walk(around, first, min(around[first]), used))
            if line:
                found.append(([first, *line[:-1]], True))
    return sorted(found)


def _walk(around: list[list[int]], first: int, second: int, used: set[tuple[int, int]]) -> Iterator[int]:
    """The vertices from the second on until the line ends or is back at the first; none where it was walked before."""
    before, here = first, second
    while (min(before, here), max(before, here)) not in used:
        used.add((min(before, here), max(before, here)))
        yield here
        if here == first or len(around[here]) != 2:
            return
        here, before = sum(around[here]) - before, here
