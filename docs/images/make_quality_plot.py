# SPDX-License-Identifier: MIT
"""Makes tessellation-quality.svg, 2,000 cells as they start and become even: python make_quality_plot.py MESH."""

from __future__ import annotations

import sys
from pathlib import Path

import saddleback as sb

graph = sb.SaddleVertexGraph(sb.read_mesh(sys.argv[1]))
series = {}
for name, iterations in (("random", 0), ("5 iterations", 5), ("100 iterations", 100)):
    cells = sb.centroidal_voronoi(graph, count=2000, max_iterations=iterations, start="sample", seed=1).cells
    dual = cells.dual("strict")
    series[name] = sb.triangle_quality(dual.vertices, dual.triangles)
Path(__file__).with_name("tessellation-quality.svg").write_text(sb.quality_plot(series))
