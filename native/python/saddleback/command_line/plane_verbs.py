# SPDX-License-Identifier: MIT
"""``saddleback voronoi2d``."""

from __future__ import annotations

from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback._notebook import picture
from saddleback.command_line import runs
from saddleback.command_line.runs import Summary

_FORMATS = ("svg", "npz", "json")


@click.command("voronoi2d", no_args_is_help=True)
@click.argument("sites", metavar="SITES", required=False)
@click.option("--count", type=click.IntRange(1), help="So many random sites in the domain, instead of a file.")
@click.option("--seed", type=click.IntRange(0), default=0, help="Of the random sites.")
@click.option("--weights", metavar="FILE", help="A weight a site: additively weighted cells.")
@click.option(
    "--domain", metavar="X0,Y0,X1,Y1", help="The rectangle that cells are cut to.  [default: about the sites]"
)
@click.option(
    "--relax", type=click.IntRange(0), default=0, metavar="N", help="Even cells, by so many iterations at most."
)
@click.option("-o", "--output", metavar="FILE", help=f"A picture, or all numbers ({', '.join(_FORMATS)})")
@runs.THREADS
@runs.FORCE
@runs.JSON
@runs.QUIET
def voronoi2d(
    sites: str | None,
    count: int | None,
    seed: int,
    weights: str | None,
    domain: str | None,
    relax: int,
    output: str | None,
    threads: int,
    force: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Voronoi diagrams of the plane.

    SITES is a file of places (n, 2): npy, npz, csv or txt.
    """
    if (sites is None) == (count is None):
        raise click.UsageError("wanted either SITES or --count N")
    if output:
        runs.check_output(output, _FORMATS, force)
    box = runs.reals(domain, 4, "--domain") if domain else None
    places = runs.read_numbers(sites, "SITES") if sites else _random(count or 0, seed, box or [0, 0, 1, 1])
    if places.ndim != 2 or places.shape[1] != 2:
        raise runs.Failure(f"SITES: {sites} holds {places.shape} numbers; wanted places (n, 2)")
    corners = _corners(box or _about(places))
    given = runs.read_numbers(weights, "--weights") if weights else None
    summary: Summary = {"sites": len(places)}
    with runs.watched(quiet or as_json) as job:
        if relax:
            even = sb.relax_2d(places, corners, max_iterations=relax, threads=threads, job=job)
            places = even.sites
            summary |= {"iterations": even.iterations, "stopped_by": even.stop_reason}
        diagram = sb.voronoi_2d(places, given, corners, threads=threads, job=job)
    clipped = diagram.clipped
    assert clipped is not None
    if output and output.lower().endswith(".svg"):
        runs.save(output, picture(clipped, places))
    elif output:
        runs.save_numbers(output, _numbers(diagram, clipped))
    summary |= {"vertices": len(diagram.vertices), "edges": len(diagram.edges), "hidden": len(diagram.hidden)}
    runs.say(summary | ({"written": [output]} if output else {}), as_json)


def _random(count: int, seed: int, box: list[float]) -> Any:
    low, high = np.array(box[:2]), np.array(box[2:])
    return low + (high - low) * np.random.default_rng(seed).random((count, 2))


def _about(places: Any) -> list[float]:
    if not len(places) or not np.isfinite(places).all():
        raise runs.Failure("SITES: wanted at least one place, and finite numbers")
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.05 * float((high - low).max()) or 1.0
    return [*(low - margin), *(high + margin)]


def _corners(box: list[float]) -> Any:
    x0, y0, x1, y1 = box
    if not (x0 < x1 and y0 < y1):
        raise click.UsageError(f"--domain: wanted X0 below X1 and Y0 below Y1, got {box}")
    return np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])


def _numbers(diagram: sb.Voronoi2d, clipped: sb.ClippedCells) -> dict[str, Any]:
    return {
        "sites": diagram.sites,
        "vertices": diagram.vertices,
        "edges": diagram.edges,
        "edge_sites": diagram.edge_sites,
        "delaunay": diagram.delaunay,
        "areas": clipped.areas,
        "loop_points": clipped.points,
        "loop_offsets": clipped.loop_offsets,
        "loop_sites": clipped.loop_sites,
    }
