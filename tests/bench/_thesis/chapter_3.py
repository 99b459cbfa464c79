# SPDX-License-Identifier: MIT
"""Chapter 3 of [ying2014]: Voronoi diagrams of the plane by untransformed sweep circles."""

from __future__ import annotations

from collections import Counter

import numpy as np
from matplotlib.patches import Circle, Polygon
from scipy import spatial

import saddleback as sb
from tests.bench._thesis.drawing import BLUE, GREEN, RED, draw, draw_values, picture, plane
from tests.bench._thesis.items import Answer, Floats, item, percent, seconds, surface

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def random_sites(count: int, seed: int = 1) -> Floats:
    return np.random.default_rng(seed).random((count, 2))


def draw_diagram(axes, diagram: sb.Voronoi2d, extent: float = 3.0) -> None:
    for edge in range(len(diagram.edges)):
        axes.plot(*diagram.edge_polyline(edge, 1e-3, extent).T, color="black", linewidth=0.8)


def draw_sweep(axes, sweep: sb.SweepCircle, sites: Floats) -> None:
    """Draw circle, beach curve, edges as far as they are known, and sites."""
    axes.add_patch(Circle(sweep.center, sweep.radius, fill=False, color=GREEN))
    if len(sweep.arcs):
        curve = sweep.beach_curve(720)
        axes.plot(*np.r_[curve, curve[:1]].T, color=BLUE)
    for line in sweep.edge_polylines(1e-3):
        axes.plot(*line.T, color=RED, linewidth=0.8)
    axes.plot(*sites.T, "o", color="black", markersize=2.5)
    plane(axes, (-0.1, -0.1), (1.1, 1.1))


def counted(sweep: sb.SweepCircle) -> Counter:
    """Count the events of a whole sweep by kind."""
    return Counter(event.kind for event in iter(sweep.step, None))


@item("Figure 3.1", "A Voronoi diagram with its dual; Fortune's sweep line and beach line.")
def figure_3_1() -> Answer:
    sites = random_sites(200)
    diagram = sb.voronoi_2d(sites)
    qhull = {tuple(sorted(t)) for t in spatial.Delaunay(sites).simplices.tolist()}
    ours = {tuple(sorted(t)) for t in diagram.delaunay.tolist()}
    near, far = counted(sb.SweepCircle(sites, (0.5, 0.5))), counted(sb.SweepCircle(sites, (-1e9, 0.5)))
    with picture("3/1.png", 2) as (left, right):
        few = random_sites(40, 4)
        draw_diagram(left, sb.voronoi_2d(few))
        left.triplot(*few.T, sb.voronoi_2d(few).delaunay, color=BLUE, linewidth=0.8)
        plane(left)
        sweep = sb.SweepCircle(few, (-40, 0.5))
        sweep.grow(40.5)
        draw_sweep(right, sweep, few)
        plane(right)
    return Answer(
        f"200 sites: {len(ours & qhull)} of {len(qhull)} triangles are SciPy's (Qhull). A circle from a billion away "
        f"is a sweep line, by theorem 3.1: {far.total()} events, from the middle {near.total()}; the same diagram.",
        "Nothing. The sweep line is drawn as a circle from 40 away.",
        ("3/1.png",),
    )


@item(
    "Figure 3.2",
    "An argument: a sweep line for one square has to sweep 4√2 + 2π + 1 = 12.9 times its area and be trimmed, 92.3 % "
    "in vain.",
)
def figure_3_2() -> Answer:
    whole = 4 * 2**0.5 + 2 * np.pi + 1
    return Answer(
        f"1 - 1/{whole:.1f} = {percent(1 - 1 / whole)}. Ours trims nothing: tiles of about 2,000 sites are swept each "
        f"to its own end and joined side by side, so that each site is swept once.",
        "Joining, as in divide and conquer [guibas1985], wastes less than circles that overlap do.",
    )


@item("Figure 3.3", "The circle sweeps over two sites; the beach curve's vertices trace their bisector.")
def figure_3_3() -> Answer:
    sites, center = np.array([[0.35, 0.6], [0.75, 0.35]]), np.array([0.45, 0.4])
    worst = 0.0
    with picture("3/3.png", 4) as panels:
        for axes, radius in zip(panels, (0.15, 0.25, 0.4, 0.7), strict=True):
            sweep = sb.SweepCircle(sites, center)
            sweep.grow(radius)
            draw_sweep(axes, sweep, sites)
            if len(sweep.arcs):
                curve = sweep.beach_curve(1000)
                to_circle = radius - np.linalg.norm(curve - center, axis=1)
                to_site = np.linalg.norm(curve[:, None] - sites, axis=2).min(axis=1)
                worst = max(worst, float(np.abs(to_circle - to_site).max()))
    return Answer(
        f"The same. Lemma 3.1, that the curve is as far from the circle as from the site, holds to {worst:.0e}.",
        "Nothing.",
        ("3/3.png",),
    )


@item("Figure 3.4", "Five sites, event by event, until the queue is empty.")
def figure_3_4() -> Answer:
    sites = np.array([[0.3, 0.35], [0.7, 0.3], [0.75, 0.7], [0.35, 0.75], [0.52, 0.97]])
    with picture("3/4.png", 4) as panels:
        for axes, radius in zip(panels, (0.3, 0.42, 0.6, 1.2), strict=True):
            sweep = sb.SweepCircle(sites, (0.5, 0.5))
            sweep.grow(radius)
            draw_sweep(axes, sweep, sites)
    events, vertices = counted(sb.SweepCircle(sites, (0.5, 0.5))), len(sb.voronoi_2d(sites).vertices)
    return Answer(
        f"{events['touch']} touches and {events['vanish']} arcs that vanish, one for each of the {vertices} vertices.",
        "Nothing; in Blender *Voronoi 2D* animates it.",
        ("3/4.png",),
    )


@item(
    "Figure 3.5",
    "Out-of-date events: arcs whose vanishing is called off by a site between. Up to 3n are made, n are used.",
)
def figure_3_5() -> Answer:
    sites = random_sites(1000)
    events = counted(sb.SweepCircle(sites, (0.5, 0.5)))
    hull = len(spatial.ConvexHull(sites).vertices)
    return Answer(
        f"1,000 sites: {events['touch']} touches and {events['vanish']} vanishings = 2n - 2 - {hull} sites of the "
        f"hull.",
        "Events that are out of date are dropped inside and never shown: `step` returns those that count.",
    )


def containment(sites: Floats, center: Floats, apothem: float) -> float:
    """Return the radius at which the beach curve about a center contains the hexagon there."""
    sweep, radius = sb.SweepCircle(sites, center), apothem
    while True:
        sweep.grow(radius)
        if len(sweep.arcs):
            curve = sweep.beach_curve(360) - center
            angle = np.arctan2(curve[:, 1], curve[:, 0])
            hexagon = apothem / np.cos((angle + np.pi / 6) % (np.pi / 3) - np.pi / 6)
            if (np.linalg.norm(curve, axis=1) >= hexagon).all():
                return radius
        radius *= 1.01


@item("Figure 3.6", "Hexagons over 1,000 random sites: of the sites in a circle at its end 71.9 % lie in its hexagon.")
def figure_3_6() -> Answer:
    said = []
    for wanted in (37, 150):
        apothem = float(np.sqrt(wanted / 1000 / (2 * 3**0.5)))
        ratios = []
        for seed in range(10):
            sites, center = random_sites(1000, seed), np.array([0.5, 0.5])
            radius = containment(sites, center, apothem)
            away = sites - center
            inside = np.abs(away @ [[1, 0.5, -0.5], [0, 3**0.5 / 2, 3**0.5 / 2]]).max(axis=1) <= apothem
            ratios.append(inside.sum() / (np.linalg.norm(away, axis=1) <= radius).sum())
        said.append(f"{percent(float(np.mean(ratios)))} with {wanted} sites a hexagon")
    return Answer(
        "; ".join(said) + " (10 runs each).",
        "The thesis does not say how large its hexagons are; the share grows with them. Ours are in the middle of the "
        "domain.",
    )


@item(
    "Figure 3.7",
    "Numbers of events: circle and line alike; for each of several circles in parallel far fewer.",
)
def figure_3_7() -> Answer:
    sites = random_sites(1000)
    circle, line = counted(sb.SweepCircle(sites, (0.5, 0.5))), counted(sb.SweepCircle(sites, (-1e9, 0.5)))
    said = []
    for m in (1, 2, 3, 5):
        places = (np.arange(m) + 0.5) / m
        centers = np.array([(x, y) for x in places for y in places])
        sweep, events = sb.SweepCircles(sites, centers, domain=SQUARE), np.zeros(m * m, dtype=int)
        for i, _ in iter(sweep.step, None):
            events[i] += 1
        said.append(f"{m * m} circles {events.mean():,.0f}")
    return Answer(
        f"1,000 sites: circle {circle.total()} events, line {line.total()}. Each of " + ", ".join(said) + ".",
        "Theorem 3.3 bounds the radius at which a circle may stop; ours stop where their beach curve is "
        "around their cells.",
    )


@item("Figure 3.8", "Time against CGAL's and Triangle's, 25 circles on a GPU of 2011: 1.63 and 1.73 times as fast.")
def figure_3_8() -> Answer:
    said = []
    for count in (10_000, 100_000):
        sites = random_sites(count)
        ours = seconds(lambda sites=sites: sb.voronoi_2d(sites, threads=1))
        theirs = seconds(lambda sites=sites: spatial.Voronoi(sites), 1)
        said.append(f"{count:,} sites: {theirs / ours:.0f} times as fast as SciPy's `Voronoi` (Qhull), on one thread")
    return Answer(
        "; ".join(said) + ". CGAL and a CUDA device: [performance](performance.md#plane-diagrams).",
        "A ratio of processor times in one run. On CUDA devices we find cells by warps, not by sweeping; the bits are "
        "the same.",
    )


@item("Figure 3.9", "250 sites in an irregular domain by m² circles, m = 2 to 5.")
def figure_3_9() -> Answer:
    angle = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    domain = 0.5 + (0.32 + 0.13 * np.sin(3 * angle))[:, None] * np.c_[np.cos(angle), np.sin(angle)]
    within = [p for p in random_sites(2000, 5) if inside_polygon(p, domain)][:250]
    sites = np.array(within)
    first = sb.voronoi_2d(sites, domain=domain, circles=1)
    same = all(
        sb.voronoi_2d(sites, domain=domain, circles=m * m).vertices.tobytes() == first.vertices.tobytes()
        for m in range(2, 6)
    )
    with picture("3/9.png", 4) as panels:
        for axes, m in zip(panels, (2, 3, 4, 5), strict=True):
            places = 0.05 + 0.9 * (np.arange(m) + 0.5) / m
            sweep = sb.SweepCircles(sites, [(x, y) for x in places for y in places])
            sweep.grow(0.4 / m)
            for i, center in enumerate(sweep.centers):
                axes.add_patch(Circle(center, sweep.radii[i], fill=False, color=GREEN, linewidth=0.7))
                if len(sweep.arcs(i)):
                    axes.plot(*sweep.beach_curve(i, 360).T, color=BLUE, linewidth=0.7)
                for line in sweep.edge_polylines(i, 1e-3):
                    axes.plot(*line.T, color="black", linewidth=0.6)
            axes.add_patch(Polygon(domain, fill=False, color="gray"))
            plane(axes)
    return Answer(
        f"m = 1 to 5 give {'the same bytes' if same else 'DIFFERENT bytes'}, {len(first.vertices)} vertices.",
        "Ours run on the processor's threads; any number of circles may be asked for, and none is needed.",
        ("3/9.png",),
    )


def inside_polygon(point: Floats, polygon: Floats) -> bool:
    (x, y), a, b = point, polygon, np.roll(polygon, -1, axis=0)
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    at = a[:, 0] + (y - a[:, 1]) / np.where(crosses, b[:, 1] - a[:, 1], 1) * (b[:, 0] - a[:, 0])
    return bool((crosses & (at > x)).sum() % 2)


OPEN = "camelhead-11k-open"


@item(
    "Figure 3.10", "A face and a sheep mapped conformally to a disk (harmonic map) and a square (holomorphic 1-form)."
)
def figure_3_10() -> Answer:
    mesh = surface(OPEN)
    uv = sb.harmonic_map(mesh)
    corners = uv[mesh.triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    flipped = int((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] <= 0).sum())
    with picture("3/10.jpg", 2) as (left, right):
        draw_values(left, mesh, np.linalg.norm(uv, axis=1))
        right.triplot(*uv.T, mesh.triangles, linewidth=0.1, color="black")
        plane(right, (-1, -1), (1, 1))
    return Answer(
        f"A harmonic map of an open mesh of {mesh.face_count:,} faces to the disk: {flipped} triangles are flipped.",
        "Another open mesh. For the square any UV map serves (`Chart`); we make no holomorphic 1-form.",
        ("3/10.jpg",),
    )


@item("Figure 3.11", "Diagrams of 200 and 600 sites in the map, carried to the surface.")
def figure_3_11() -> Answer:
    mesh = surface(OPEN)
    chart = sb.Chart(mesh, sb.harmonic_map(mesh))
    said = []
    with picture("3/11.jpg", 2) as panels:
        for axes, count in zip(panels, (200, 600), strict=True):
            lifted = chart.lift(sb.voronoi_2d(chart.places(sb.sample(mesh, count))))
            said.append(f"{count} cells: areas sum to the mesh's but for {abs(lifted.areas.sum() / mesh.area - 1):.0e}")
            cut = lifted.split()
            colors = 0.45 + 0.5 * np.random.default_rng(0).random((count, 3))
            draw(axes, cut.vertices, cut.triangles, colors[cut.triangle_cell])
    return Answer("; ".join(said) + ".", "As above.", ("3/11.jpg",))


@item("Figure 3.12", "The additively weighted diagram: hyperbolas, and circles that sweep it.")
def figure_3_12() -> Answer:
    rng = np.random.default_rng(7)
    sites, radii = rng.random((60, 2)), 0.07 * rng.random(60)
    diagram = sb.voronoi_2d(sites, radii)
    probes = rng.random((100_000, 2))
    nearest = (np.linalg.norm(probes[:, None] - sites, axis=2) - radii).argmin(axis=1)
    with picture("3/12.png", 3) as panels:
        for axes, radius in zip(panels, (0.25, 0.5, None), strict=True):
            if radius is None:
                draw_diagram(axes, diagram)
            else:
                sweep = sb.SweepCircle(sites, (0.5, 0.5), radii)
                sweep.grow(radius)
                draw_sweep(axes, sweep, sites)
            for site, size in zip(sites, radii, strict=True):
                axes.add_patch(Circle(site, size, color="#f2a33a", alpha=0.7, linewidth=0))
            plane(axes)
    agree = int((diagram.locate(probes) == nearest).sum())
    return Answer(
        f"60 disks, {len(diagram.hidden)} of them hidden by others; `locate` is right at {agree:,} of 100,000 random "
        f"places.",
        "Nothing.",
        ("3/12.png",),
    )
