# SPDX-License-Identifier: MIT
"""Makes power.svg, seamless.svg and one-mass.svg, diagrams of the plane with weights: python make_plane_plots.py."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

SIZE, GAP = 300, 12
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
BLUE = 'fill="none" stroke="#2a6fdb" stroke-width="1.3"'
Floats = NDArray[np.float64]


def polygon(places: Floats, style: str) -> str:
    points = " ".join(f"{SIZE * x:.1f},{SIZE * (1 - y):.1f}" for x, y in places)
    return f'<polygon points="{points}" {style}/>'


def disk(place: Floats, radius: float, style: str) -> str:
    return f'<circle cx="{SIZE * place[0]:.1f}" cy="{SIZE * (1 - place[1]):.1f}" r="{SIZE * radius:.1f}" {style}/>'


def save(name: str, parts: list[str]) -> None:
    size = SIZE + 2 * GAP
    head = f'width="{size}" height="{size}" viewBox="{-GAP} {-GAP} {size} {size}"'
    text = "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {head}>', *parts, "</svg>\n"])
    Path(__file__).with_name(name).write_text(text)


def cells(sites: Floats, weights: Floats, style: str) -> list[str]:
    clipped = sb.power_diagram_2d(sites, weights, SQUARE).clipped
    assert clipped is not None
    return [polygon(loop, style) for loop in np.split(clipped.points, clipped.loop_offsets[1:-1])]


def power() -> list[str]:
    """Circles of several radii, and cells whose sides run through where they cross."""
    rng = np.random.default_rng(6)
    sites, radii = rng.random((40, 2)), rng.uniform(0.02, 0.12, 40)
    hidden = set(sb.power_diagram_2d(sites, radii**2).hidden.tolist())
    circles = [
        disk(site, radius, f'fill="{"#d9822b" if i in hidden else "#8a8a8a"}" fill-opacity="0.2"')
        for i, (site, radius) in enumerate(zip(sites, radii, strict=True))
    ]
    return circles + cells(sites, radii**2, BLUE)


def seamless() -> list[str]:
    """Two by two tiles: cells of the same color are one."""
    rng = np.random.default_rng(4)
    diagram = sb.periodic_voronoi_2d(rng.random((24, 2)))
    offsets, places = diagram.cells
    parts = []
    for i in range(24):
        color = f'fill="hsl({137 * i % 360},45%,{62 + i % 3 * 9}%)" stroke="#fff" stroke-width="1.5"'
        loop = places[offsets[i] : offsets[i + 1]]
        parts += [polygon((loop + (x, y)) / 2, color) for x in range(-1, 3) for y in range(-1, 3)]
    frame = 'fill="none" stroke="#222" stroke-width="1.5" stroke-dasharray="5 4"'
    return [*parts, *(polygon((SQUARE + (x, y)) / 2, frame) for x in (0, 1) for y in (0, 1))]


def one_mass() -> list[str]:
    """A round shade: dots with cells that each hold as much of it."""
    side = (np.arange(128) + 0.5) / 128
    x, y = np.meshgrid(side, side)
    shade = 0.08 + np.exp(-12 * ((x - 0.4) ** 2 + (y - 0.6) ** 2))
    found = sb.balance_2d(sb.relax_2d(np.random.default_rng(1).random((400, 2)), SQUARE, shade).sites, SQUARE, shade)
    print(f"masses off by {found.capacity_error:.1e} of each")
    dots = [disk(site, 0.0055, 'fill="#222"') for site in found.sites]
    return cells(found.sites, found.weights, BLUE.replace("1.3", "0.7")) + dots


save("power.svg", power())
save("seamless.svg", seamless())
save("one-mass.svg", one_mass())
