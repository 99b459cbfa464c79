# SPDX-License-Identifier: MIT
"""Makes voronoi-growth.svg, processor time a site on one thread: python make_growth_plot.py. Takes half a minute."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import saddleback as sb

WIDTH, HEIGHT, MOST = 480, 240, 500
LEFT, RIGHT, TOP, BOTTOM = 50, 470, 20, 200
MARGIN = 35


def median_of(count: int, times: int) -> float:
    """Nanoseconds a site, of fresh uniform sites each time; the first call of all lays memory and does not count."""
    rng = np.random.default_rng(count)
    took = []
    for _ in range(times + 1):
        sites = rng.random((count, 2))
        start = time.process_time()
        sb.voronoi_2d(sites, threads=1)
        took.append(time.process_time() - start)
    return float(np.median(took[1:])) / count * 1e9


figures = {10**power: median_of(10**power, times) for power, times in ((3, 500), (4, 100), (5, 15), (6, 5), (7, 2))}
places = {
    count: (
        LEFT + MARGIN + (np.log10(count) - 3) / 4 * (RIGHT - LEFT - 2 * MARGIN),
        BOTTOM - value / MOST * (BOTTOM - TOP),
    )
    for count, value in figures.items()
}
lines = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{HEIGHT}" font-family="sans-serif">']
for value in range(0, MOST + 1, 100):
    y = BOTTOM - value / MOST * (BOTTOM - TOP)
    lines.append(f'<line x1="{LEFT}" y1="{y:.0f}" x2="{RIGHT}" y2="{y:.0f}" stroke="#ddd"/>')
    lines.append(f'<text x="{LEFT - 8}" y="{y + 4:.0f}" font-size="12" text-anchor="end">{value}</text>')
points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places.values())
lines.append(f'<polyline points="{points}" fill="none" stroke="#2a6fdb" stroke-width="2"/>')
for count, (x, y) in places.items():
    lines.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="#2a6fdb"/>')
    lines.append(f'<text x="{x:.1f}" y="{y - 10:.1f}" font-size="12" text-anchor="middle">{figures[count]:.0f}</text>')
    lines.append(f'<text x="{x:.1f}" y="{BOTTOM + 18}" font-size="12" text-anchor="middle">{count:,}</text>')
lines.append(f'<text x="{LEFT}" y="{HEIGHT - 4}" font-size="12">sites; nanoseconds a site, one thread</text></svg>')
Path(__file__).with_name("voronoi-growth.svg").write_text("\n".join(lines) + "\n")
print(figures)
