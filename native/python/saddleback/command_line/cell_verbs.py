# SPDX-License-Identifier: MIT
"""``saddleback cells``."""

from __future__ import annotations

from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback.command_line import runs
from saddleback.command_line.runs import GRAPH, Run, Summary, output, verb


@verb(
    click.option("--count", type=click.IntRange(1), help="So many even cells."),
    click.option("--sites", metavar="FILE", help="Or the cells of these sites: vertices (n), or places (n, 3)."),
    click.option("--relax", is_flag=True, help="Make the cells of --sites even."),
    click.option("--density", metavar="FILE", help="Wanted cells per area, a number a vertex (npy, npz, txt)."),
    click.option(
        "--iterations", type=click.IntRange(0), default=100, show_default=True, help="Of the relaxation, at most."
    ),
    click.option("--seed", type=click.IntRange(0), default=0, help="Of the sites to begin with."),
    output("-o", "--output", formats=("ply", "npz", "json"), help="The mesh with each vertex's cell, or all numbers"),
    output("--dual", formats=("ply", "obj"), help="The triangulation of the sites"),
    output("--split", formats=("ply", "obj"), help="The mesh cut along the cells' edges, and each triangle's cell"),
    output("--edges", formats=("ply", "obj"), help="The cells' edges as lines"),
    *GRAPH,
)
def cells(
    run: Run,
    count: int | None,
    sites: str | None,
    relax: bool,
    density: str | None,
    iterations: int,
    seed: int,
) -> Summary:
    """Even cells, or the cells of given sites: with their dual, split mesh and edges."""
    if (count is None) == (sites is None):
        raise click.UsageError("wanted either --count N or --sites FILE")
    given = _sites(run, sites) if sites else None
    summary: Summary = {}
    if given is not None and not relax:
        found = sb.geodesic_voronoi(run.graph, given, threads=run.options["threads"], job=run.job)
    else:
        weights = runs.read_numbers(density, "--density") if density else None
        how: dict[str, Any] = {"count": count} if given is None else {"sites": given}
        even = sb.centroidal_voronoi(
            run.graph,
            **how,
            density=weights,
            max_iterations=iterations,
            seed=seed,
            threads=run.options["threads"],
            job=run.job,
        )
        found = even.cells
        summary = {"iterations": even.iterations, "stopped_by": even.stop_reason, "energy": float(even.energy[-1])}
    return summary | {"cells": len(found.sites)} | _areas(found) | _write(run, found)


def _sites(run: Run, name: str) -> Any:
    numbers = runs.read_numbers(name, "--sites")
    if numbers.ndim == 2 and numbers.shape[1] == 3:
        return sb.project(run.mesh, numbers)
    if numbers.ndim != 1 or not np.array_equal(numbers, np.round(numbers)):
        raise runs.Failure(f"--sites: {name} holds {numbers.shape} numbers; wanted vertices (n) or places (n, 3)")
    return numbers.astype(np.int64)


def _areas(found: sb.GeodesicVoronoi) -> Summary:
    areas = found.areas
    return {"mean_area": float(areas.mean()), "area_deviation": float(areas.std() / areas.mean())}


def _write(run: Run, found: sb.GeodesicVoronoi) -> Summary:
    summary: Summary = {}
    if run.out["split"]:
        split = found.split()
        sb.write_mesh(run.out["split"], split, face_attributes={"cell": split.triangle_cell})
    if run.out["edges"]:
        sb.write_curves(run.out["edges"], found.edges)
    if run.out["dual"]:
        dual = found.dual(job=run.job)
        sb.write_mesh(run.out["dual"], dual)
        summary = {"dual_vertices": len(dual.vertices), "dual_triangles": len(dual.triangles)}
        summary |= {"sites_added": dual.added, "issues": len(dual.issues)}
    if name := run.out["output"]:
        if name.lower().endswith((".npz", ".json")):
            runs.save_numbers(name, _numbers(run.mesh, found))
        else:
            sb.write_mesh(name, run.mesh, {"cell": found.vertex_cell, "distance": found.vertex_distance})
    return summary


def _numbers(mesh: sb.Mesh, found: sb.GeodesicVoronoi) -> dict[str, Any]:
    return {
        "site_faces": found.sites.faces,
        "site_barycentric": found.sites.barycentric,
        "site_places": found.sites.positions(mesh),
        "areas": found.areas,
        "vertex_cell": found.vertex_cell,
        "vertex_distance": found.vertex_distance,
        "edge_points": found.edge_points,
        "edge_offsets": found.edge_offsets,
        "edge_cells": found.edge_cells,
    }
