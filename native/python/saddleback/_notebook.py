# SPDX-License-Identifier: MIT
"""What a notebook shows of an object: pictures of diagrams and qualities, tables of the rest."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from saddleback._saddleback import (
    CentroidalVoronoi,
    ClippedCells,
    Distribution,
    GeodesicVoronoi,
    Mesh,
    Quality,
    SaddleVertexGraph,
    Voronoi2d,
)
from saddleback.quality_plot import quality_plot

_MOST_SITES = 20_000  # a picture of more is slow in a browser, and shows nothing
_WIDTH = 600
_ROWS: dict[type[Any], tuple[str, ...]] = {
    Mesh: ("vertex_count", "face_count", "area", "component_count", "genus", "is_closed"),
    SaddleVertexGraph: ("arc_count", "mean_degree", "k", "accuracy", "is_exact", "nbytes", "build_seconds"),
    GeodesicVoronoi: ("sites", "device"),
    CentroidalVoronoi: ("sites", "iterations", "stop_reason", "normalized_energy"),
    Distribution: ("shapes", "placements", "stop_reason", "rejections"),
}


def picture(cells: ClippedCells, sites: NDArray[np.float64]) -> str:
    """Cells and sites of the plane as the text of an SVG file; y grows upwards."""
    corners = cells.points if len(cells.points) else np.zeros((1, 2))
    low, high = corners.min(axis=0), corners.max(axis=0)
    scale = _WIDTH / max(float((high - low).max()), 1e-300)
    flip = np.array([scale, -scale])
    at = (corners - (low[0], high[1])) * flip
    loops = zip(cells.loop_offsets, cells.loop_offsets[1:], strict=False)
    outlines = " ".join("M" + " ".join(f"{x:.2f},{y:.2f}" for x, y in at[a:b]) + "z" for a, b in loops)
    width, height = (high - low) * scale
    dots = "".join(f'<circle cx="{x:.2f}" cy="{y:.2f}" r="1.5"/>' for x, y in (sites - (low[0], high[1])) * flip)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.2f} {height:.2f}" width="{width:.0f}" '
        f'height="{height:.0f}">\n<path d="{outlines}" fill="none" stroke="#000"/>\n<g>{dots}</g>\n</svg>\n'
    )


def _picture_of_diagram(self: Voronoi2d) -> str | None:
    if len(self.sites) > _MOST_SITES or not len(self.sites):
        return None
    if self.clipped is not None:
        return picture(self.clipped, self.sites)
    low, high = self.sites.min(axis=0), self.sites.max(axis=0)
    margin = 0.05 * float((high - low).max()) or 1.0
    (x0, y0), (x1, y1) = low - margin, high + margin
    return picture(self.clip([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), self.sites)


def _table(self: Any) -> str:
    parts = [(name.replace("_", " "), escape(_words(self, name))) for name in _ROWS[type(self)]]
    rows = "".join(f"<tr><th style='text-align:left'>{name}</th><td>{value}</td></tr>" for name, value in parts)
    return f"<table><caption>saddleback.{type(self).__name__}</caption>{rows}</table>"


def _words(self: Any, name: str) -> str:
    value = getattr(self, name)
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(len(value)) if hasattr(value, "__len__") and not isinstance(value, str | dict) else str(value)


def _give(kind: Any, name: str, show: Any) -> None:
    setattr(kind, name, show)


_give(Quality, "_repr_svg_", quality_plot)
_give(Voronoi2d, "_repr_svg_", _picture_of_diagram)
for _kind in _ROWS:
    _give(_kind, "_repr_html_", _table)
