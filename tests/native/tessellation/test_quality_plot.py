# SPDX-License-Identifier: MIT
"""The picture of triangles' quality: its steps are the shares of a histogram."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

SVG = "{http://www.w3.org/2000/svg}"


def steps_of(path: str, height: float = 150) -> np.ndarray:
    """Heights of a curve's steps, the tallest 1."""
    levels = [float(level) for level in re.findall(r"V([-0-9.]+) H", path)]
    return 1 - np.array(levels) / height


def curves(text: str) -> list[list[str]]:
    """Of each panel, one a series."""
    return [
        [p.get("d", "") for p in g.iter(f"{SVG}path") if p.get("fill-opacity")]
        for g in ElementTree.fromstring(text).iter(f"{SVG}g")
    ]


def test_steps_are_shares() -> None:
    quality = sb.triangle_quality(*meshes.torus(30, 12))
    panels = curves(sb.quality_plot(quality))
    assert [len(panel) for panel in panels] == [1, 1, 1]
    wanted = (
        np.histogram(quality.quality, np.linspace(0, 1, 41))[0],
        np.histogram(np.degrees(quality.least_angle), np.linspace(0, 60, 41))[0],
        np.bincount(quality.valence, minlength=11)[3:11],
    )
    for (path,), counts in zip(panels, wanted, strict=True):
        np.testing.assert_allclose(steps_of(path), counts / counts.max(), atol=1e-3)


def test_series_share_a_scale_and_are_named() -> None:
    even, skew = sb.triangle_quality(*meshes.icosphere(2)), sb.triangle_quality(*meshes.grid(6, 6))
    text = sb.quality_plot({"even <1>": even, "skew": skew})
    names = [t.text for t in ElementTree.fromstring(text).findall(f"{SVG}text")]
    assert names == ["even <1>", "skew"]
    for panel in curves(text):
        heights = [steps_of(path).max() for path in panel]
        assert max(heights) == pytest.approx(1, abs=1e-3)
        assert min(heights) < 1 - 1e-3
    # What lies beyond an axis counts with its end: corners of the grid with two neighbors.
    assert steps_of(curves(text)[2][1])[0] > 0


def test_bad_input() -> None:
    quality = sb.triangle_quality(*meshes.icosphere(1))
    with pytest.raises(sb.InputError, match="got 0"):
        sb.quality_plot({})
    with pytest.raises(sb.InputError, match="got 9"):
        sb.quality_plot({str(i): quality for i in range(9)})
