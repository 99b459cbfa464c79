# SPDX-License-Identifier: MIT
"""``saddleback graph``, ``distance`` and ``path``."""

from __future__ import annotations

import re
from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback.command_line import runs
from saddleback.command_line.runs import GRAPH, Run, Summary, output, verb


@verb(
    output("-o", "--output", formats=("graph", "arcs"), help="The graph, for --graph of other verbs, or a part's arcs"),
    click.option("--part", metavar="I/N", help="Only the arcs of part I of N, from 1 on, for --merge."),
    click.option("--merge", is_flag=True, help="Make the graph of all PARTS, the same bytes as at once."),
    click.argument("parts", metavar="[PARTS]...", nargs=-1),
    *GRAPH[1:],
    click.option("--exact", is_flag=True, help="All straight geodesics: exact between vertices, and much larger."),
)
def graph(run: Run, exact: bool, part: str | None, merge: bool, parts: tuple[str, ...]) -> Summary:
    """Build the distance graph of a mesh, whole or in parts, to be used again by --graph."""
    if merge != bool(parts) or (part and (merge or exact)):
        raise click.UsageError(
            "wanted --merge PARTS..., --part I/N, or neither; parts are of graphs that are not exact"
        )
    if part:
        return _part(run, part)
    built = _merged(run, parts) if merge else run.graph
    if run.out["output"]:
        built.save(run.out["output"], job=run.job)
    return {
        "vertices": built.mesh.vertex_count,
        "arcs": built.arc_count,
        "k": built.k,
        "accuracy": built.accuracy,
        "exact": built.is_exact,
        "device": built.device,
        "seconds": built.build_seconds,
        "bytes": built.nbytes,
    }


def _part(run: Run, part: str) -> Summary:
    match = re.fullmatch(r"(\d+)/(\d+)", part)
    if not match or not 1 <= int(match[1]) <= int(match[2]):
        raise click.UsageError(f"--part: wanted I/N with I from 1 to N, got {part}")
    given = {key: run.options[key] for key in ("accuracy", "k", "threads") if run.options[key] is not None}
    arcs = sb.find_arcs(run.mesh, int(match[1]) - 1, int(match[2]), **given, job=run.job)
    if run.out["output"]:
        runs.save(run.out["output"], arcs)
    return {"part": part, "bytes": len(arcs)}


def _merged(run: Run, names: tuple[str, ...]) -> sb.SaddleVertexGraph:
    found = []
    for name in names:
        with open(runs.fill(name, run.options["frame"]), "rb") as file:
            found.append(file.read())
    return sb.SaddleVertexGraph.from_parts(run.mesh, found, threads=run.options["threads"], job=run.job)


def _from(what: str) -> tuple[runs.Option, runs.Option]:
    return (
        click.option(f"--{what}", metavar="VERTICES", help="Vertex numbers, parted by commas."),
        click.option(
            f"--{what}-place", metavar="X,Y,Z", multiple=True, help="A place; its nearest point of the surface."
        ),
    )


@verb(
    *_from("from"),
    output("-o", "--output", formats=("ply", "npz", "npy", "json"), help="Distances of the vertices"),
    click.option("--limit", type=click.FloatRange(0), help="Vertices farther than this stay at infinity."),
    click.option("--exact", is_flag=True, help="By windows instead of the graph, exactly."),
    *GRAPH,
)
def distance(run: Run, limit: float | None, exact: bool) -> Summary:
    """Geodesic distances of all vertices from points.

    In a ply file they are the vertices' property `distance`, which viewers show.
    """
    sources = run.points(run.options["from"], run.options["from_place"], "from")
    far = float("inf") if limit is None else limit
    if exact:
        found = sb.exact_distances(run.mesh, sources, far, job=run.job)
    else:
        found = run.graph.distances(sources, far, job=run.job)
    _save_field(run.out["output"], run.mesh, found)
    reached = found[np.isfinite(found)]
    is_any = len(reached) > 0  # within a limit there may be no vertex
    return {
        "reached": len(reached),
        "vertices": len(found),
        "farthest": float(reached.max()) if is_any else None,
        "farthest_vertex": int(np.argmax(np.where(np.isfinite(found), found, -1))) if is_any else None,
        "mean": float(reached.mean()) if is_any else None,
    }


def _save_field(name: str | None, mesh: sb.Mesh, found: Any) -> None:
    if name is None:
        return
    if name.lower().endswith((".ply", ".ply.gz")):
        sb.write_mesh(name, mesh, {"distance": found})
    else:
        runs.save_numbers(name, {"distance": found})


@verb(
    *_from("from"),
    *_from("to"),
    output("-o", "--output", formats=("obj", "ply", "npz", "npy", "json"), help="The path's points"),
    click.option("--exact", is_flag=True, help="By windows instead of the graph, exactly."),
    *GRAPH,
)
def path(run: Run, exact: bool) -> Summary:
    """The shortest path between two points."""
    ends = [run.points(run.options[end], run.options[f"{end}_place"], end) for end in ("from", "to")]
    for end, name in zip(ends, ("from", "to"), strict=True):
        if len(end) != 1:
            raise click.UsageError(f"--{name}: wanted one point, got {len(end)}")
    begin, target = (end if isinstance(end, sb.SurfacePoints) else int(end[0]) for end in ends)
    if exact:
        source = begin if isinstance(begin, sb.SurfacePoints) else [begin]
        found = sb.ExactField(run.mesh, source, job=run.job).path(target)
    else:
        found = run.graph.path(begin, target, job=run.job)
    if not len(found.points):
        raise runs.Failure(f"{run.source}: no way leads from one point to the other; they lie on separate parts")
    file = run.out["output"]
    if file and file.lower().endswith((".npz", ".npy", ".json")):
        arrays = {"points": found.points, "faces": found.surface.faces, "barycentric": found.surface.barycentric}
        runs.save_numbers(file, arrays)
    elif file:
        sb.write_curves(file, [found])
    straight = float(np.linalg.norm(found.points[-1] - found.points[0]))
    return {"length": found.length, "straight": straight, "points": len(found.points)}
