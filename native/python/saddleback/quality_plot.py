# SPDX-License-Identifier: MIT
"""The quality of triangles as a picture that any browser shows."""

from collections.abc import Mapping
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from saddleback._saddleback import InputError, Quality

_Floats = NDArray[np.float64]

# Colors that people of every color vision tell apart [okabe2002].
_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442")
_WIDTH, _HEIGHT, _MARGIN, _LEGEND = 260, 150, 30, 22


class _Panel(NamedTuple):
    title: str
    edges: _Floats  # of the bins
    ticks: tuple[float, ...]
    centered: bool  # ticks stand under the bins' middles

    def shares(self, values: _Floats) -> _Floats:
        """Returns the shares of all values, in each bin; those beyond the ends count with the first and the last."""
        inside = np.clip(values, self.edges[0], self.edges[-1])
        shares: _Floats = np.histogram(inside, self.edges)[0] / max(len(values), 1)
        return shares


_PANELS = (
    _Panel("quality of triangles", np.linspace(0, 1, 41), (0, 0.25, 0.5, 0.75, 1), False),
    _Panel("least angle, degrees", np.linspace(0, 60, 41), (0, 15, 30, 45, 60), False),
    _Panel("neighbors of vertices", np.arange(2.5, 11), (3, 4, 5, 6, 7, 8, 9, 10), True),
)


def quality_plot(qualities: Quality | Mapping[str, Quality]) -> str:
    """Draw histograms of how good triangles are: their quality, their least angles, the valences of vertices.

    Args:
        qualities: as `triangle_quality` gives them; several, by name, are drawn over each other with a legend.

    Returns
    -------
        A picture as the text of an SVG file. Shares of all triangles or vertices; what lies beyond an axis counts with
        its end. O(T + V).

    Raises
    ------
        InputError: nothing to draw, or more than eight series.
    """
    series = {"": qualities} if isinstance(qualities, Quality) else dict(qualities)
    if not 1 <= len(series) <= len(_COLORS):
        raise InputError(f"qualities: wanted 1 to {len(_COLORS)} of them, got {len(series)}")
    top = _LEGEND if any(series) else 0
    parts = [_legend(list(series))] if top else []
    for number, panel in enumerate(_PANELS):
        shares = [panel.shares(_values(quality, number)) for quality in series.values()]
        parts.append(f'<g transform="translate({number * (_WIDTH + _MARGIN) + _MARGIN},{top + _MARGIN})">')
        parts += [*_frame(panel), *_curves(panel, shares), "</g>"]
    width, height = len(_PANELS) * (_WIDTH + _MARGIN) + _MARGIN, top + _HEIGHT + 2 * _MARGIN
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
    body = "\n".join(parts)
    return f'{head}font-size="11">\n<rect width="{width}" height="{height}" fill="#fff"/>\n{body}\n</svg>\n'


def _values(quality: Quality, number: int) -> _Floats:
    if number == 0:
        return quality.quality
    if number == 1:
        return np.degrees(quality.least_angle)
    valence = quality.valence[quality.valence > 0]  # vertices in use
    return valence.astype(np.float64)


def _legend(names: list[str]) -> str:
    entries, left = [], float(_MARGIN)
    for name, color in zip(names, _COLORS, strict=False):
        entries.append(
            f'<rect x="{left:g}" y="8" width="12" height="12" fill="{color}"/>'
            f'<text x="{left + 17:g}" y="18">{escape(name)}</text>'
        )
        left += 40 + 6.5 * len(name)
    return "\n".join(entries)


def _frame(panel: _Panel) -> list[str]:
    low, high = panel.edges[0], panel.edges[-1]
    lines = [
        f'<text x="{_WIDTH / 2:g}" y="-8" text-anchor="middle">{panel.title}</text>',
        f'<path d="M0,{_HEIGHT} H{_WIDTH}" stroke="#888" fill="none"/>',
    ]
    for tick in panel.ticks:
        x = _WIDTH * (tick - low) / (high - low)
        if not panel.centered:
            lines.append(f'<path d="M{x:g},{_HEIGHT} v4" stroke="#888"/>')
        lines.append(f'<text x="{x:g}" y="{_HEIGHT + 16}" text-anchor="middle">{tick:g}</text>')
    return lines


def _curves(panel: _Panel, shares: list[_Floats]) -> list[str]:
    """Steps over the bins, all to one scale."""
    tallest = max(float(share.max()) for share in shares) or 1.0
    x = _WIDTH * (panel.edges - panel.edges[0]) / (panel.edges[-1] - panel.edges[0])
    curves = []
    for share, color in zip(shares, _COLORS, strict=False):
        y = _HEIGHT * (1 - share / tallest)
        steps = " ".join(f"V{level:.1f} H{right:.1f}" for level, right in zip(y, x[1:], strict=True))
        curves.append(f'<path d="M0,{_HEIGHT} {steps} V{_HEIGHT}" fill="{color}" fill-opacity="0.2" stroke="{color}"/>')
    curves.append(f'<text x="0" y="8" fill="#888">{100 * tallest:.0f} %</text>')
    return curves
