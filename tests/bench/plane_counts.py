# SPDX-License-Identifier: MIT
"""Vertices and edges of plane diagrams by CGAL's count: `python -m tests.bench plane_counts [LARGEST [KIND...]]`; 1e6.

For every kind of sites and 1,000 to LARGEST of them: `voronoi_2d` by as many circles as are good and by a single one,
and the visible sweep circle from a center among the sites and from one outside, event by event, where triangles on one
circle are taken together by the exact predicate. Needs a compiler and CGAL's headers (Debian: g++, libcgal-dev).
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np

import saddleback as sb
from saddleback._saddleback import predicates
from tests.bench.voronoi_2d import KINDS, build_peers, plane_sites, run_peers

Counts = list[int]


def swept_counts(sites: plane_sites.Points, center: plane_sites.Points) -> Counts:
    """Vertices and edges of one sweep, whose events come in an order that is rounded."""
    sweep, found = sb.SweepCircle(sites, center), []
    while (event := sweep.step()) is not None:
        if event.kind == "vanish":
            found.append(event.sites)
    triangles = np.array(found, dtype=np.int64)
    halves, opposite = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), triangles[:, [2, 0, 1]].ravel()
    key, twin_key = halves @ [len(sites), 1], halves @ [1, len(sites)]
    order = np.argsort(key)
    twin = order[np.minimum(np.searchsorted(key[order], twin_key), len(key) - 1)]
    once = (key[twin] == twin_key) & (key < twin_key)
    a, b = halves[once].T
    signs = predicates.in_circle(*(sites[i] for i in (a, b, opposite[once], opposite[twin[once]])))
    if (signs > 0).any():
        print(f"  from {center}: {np.count_nonzero(signs > 0)} edges are not Delaunay's, by rounding", flush=True)
    flat = np.count_nonzero(signs == 0)
    edges = len(key) - np.count_nonzero(key[twin] == twin_key) // 2
    return [len(triangles) - flat, edges - flat]


def all_counts(sites: plane_sites.Points) -> dict[str, Counts]:
    low, high = sites.min(axis=0), sites.max(axis=0)
    centers = {"center inside": low + [0.4, 0.6] * (high - low), "center outside": low + [3.0, -2.0] * (high - low)}
    result = {}
    for circles in (0, 1):
        diagram = sb.voronoi_2d(sites, circles=circles)
        result[f"circles={circles}"] = [len(diagram.vertices), len(diagram.edges)]
    return result | {name: swept_counts(sites, center) for name, center in centers.items()}


def main(arguments: list[str]) -> int:
    largest = int(float(arguments[0])) if arguments else 10**6
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        peers = build_peers(Path(folder))
        if peers is None:
            print("This needs g++ and CGAL's headers.", file=sys.stderr)
            return 2
        for kind in arguments[1:] or KINDS:
            n = 1000
            while n <= largest:
                sites = plane_sites.KINDS[kind](n, np.random.default_rng(1000 * n))
                wanted = [int(count) for count in run_peers(peers, sites, "cgal")["cgal"][1:]]
                found = all_counts(sites)
                differ = {name: counts for name, counts in found.items() if counts != wanted}
                wrong += len(differ)
                print(f"{kind:17s}{n:9,d}{wanted[0]:10,d}{wanted[1]:10,d}  {differ or 'all equal'}", flush=True)
                n *= 10
    return 1 if wrong else 0
