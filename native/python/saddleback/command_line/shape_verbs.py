# SPDX-License-Identifier: MIT
"""``saddleback field``, ``distribute`` and ``check``."""

from __future__ import annotations

from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback.command_line import runs
from saddleback.command_line.runs import Run, Summary, output, verb

_PRESETS = ("disk", "star", "needle", "leaf", "drop", "crescent")


@verb(
    click.option(
        "--symmetry", type=click.Choice(["1", "2", "4"]), default="1", help="1: vectors, 2: lines, 4: crosses."
    ),
    click.option(
        "--singularity", metavar="VERTEX:INDEX", multiple=True, help="A singular vertex and its index; all of them."
    ),
    click.option("--align", type=click.Choice(["none", "curvature", "boundary"]), default="none"),
    output("-o", "--output", formats=("ply", "npz", "json"), help="A direction for each face"),
)
def field(run: Run, symmetry: str, singularity: tuple[str, ...], align: Any) -> Summary:
    """Smooth directions all over the surface."""
    found = sb.direction_field(run.mesh, int(symmetry), _singularities(singularity), align=align, job=run.job)
    name = run.out["output"]
    if name and name.lower().endswith((".npz", ".json")):
        arrays = {"vectors": found.vectors, "angles": found.angles, "turns": found.turns}
        arrays["singular_vertices"] = np.array(list(found.singularities), dtype=np.int32)
        arrays["singular_indices"] = np.array(list(found.singularities.values()))
        runs.save_numbers(name, arrays)
    elif name:
        sb.write_mesh(name, run.mesh, face_attributes={"direction": found.vectors})
    return {"symmetry": found.symmetry, "singularities": found.singularities, "largest_turn": found.largest_turn}


def _singularities(texts: tuple[str, ...]) -> dict[int, float] | None:
    try:
        pairs = [text.split(":") for text in texts]
        return {int(vertex): float(index) for vertex, index in pairs} or None
    except ValueError:
        raise click.UsageError(f"--singularity: wanted VERTEX:INDEX, got {', '.join(texts)}") from None


@verb(
    click.option(
        "--shape", type=click.Choice(_PRESETS), multiple=True, help="A shape; several for a mixture.  [default: disk]"
    ),
    click.option(
        "--count", type=click.IntRange(1), multiple=True, help="Copies of each shape; else as many as find room."
    ),
    click.option(
        "--size", type=click.FloatRange(0, min_open=True), required=True, help="Mesh units for the shapes' radius."
    ),
    click.option("--gap", type=click.FloatRange(0), default=0.0, help="Least distance between copies."),
    click.option("--packed", is_flag=True, help="One beside the other, instead of at random."),
    click.option("--maximal", is_flag=True, help="Until nothing more fits, and prove it."),
    click.option("--seed", type=click.IntRange(0), default=0),
    output("-o", "--output", formats=("json",), help="Shapes and placements, for check and read_placements"),
    output("--outlines", formats=("ply", "obj"), help="Outlines on the surface as lines"),
    output("--cut", formats=("ply", "obj"), help="The mesh cut along the outlines, and each triangle's copy"),
    runs.THREADS,
)
def distribute(
    run: Run,
    shape: tuple[str, ...],
    count: tuple[int, ...],
    size: float,
    gap: float,
    packed: bool,
    maximal: bool,
    seed: int,
    threads: int,
) -> Summary:
    """Copies of shapes on the surface that never collide."""
    kinds = [getattr(sb.Shape, name)() for name in shape or ("disk",)]
    laid = sb.distribute(
        run.mesh,
        kinds,
        list(count) or None,
        size=size,
        gap=gap,
        mode="packed" if packed else "random",
        maximal=maximal,
        seed=seed,
        threads=threads,
        job=run.job,
    )
    if run.out["output"]:
        sb.write_placements(run.out["output"], run.mesh, kinds, laid.placements)
    if run.out["outlines"]:
        outlines = (outline for i in range(len(laid)) for outline in laid.outline(i))
        sb.write_curves(run.out["outlines"], (np.vstack([loop, loop[:1]]) for loop in outlines))
    if run.out["cut"]:
        cut = laid.mapped.cut(job=run.job)
        sb.write_mesh(run.out["cut"], cut, face_attributes={"copy": cut.triangle_shape})
    return {"copies": len(laid), "stopped_by": laid.stop_reason, "rejections": laid.rejections}


@verb(
    click.option("--placements", metavar="FILE", required=True, help="What `saddleback distribute -o` wrote."),
    click.option(
        "--samples", type=click.IntRange(1), default=1_000_000, show_default=True, help="Places that are looked at."
    ),
    runs.THREADS,
)
def check(run: Run, placements: str, samples: int, threads: int) -> Summary:
    """Check what distribute wrote: do no two copies collide? The exit code is 3 where they do."""
    name = runs.fill(placements, run.options["frame"])
    kinds, places = sb.read_placements(name, run.mesh)
    laid = sb.map_shapes(run.mesh, kinds, places, sb.read_placement_field(name, run.mesh), threads=threads, job=run.job)
    report = sb.check_distribution(run.mesh, laid, samples=samples, threads=threads, job=run.job)
    shown = [
        f"{kind} {first}" + ("" if second is None else f" and {second}") for kind, first, second, _ in report.faults
    ]
    return {
        "ok": report.ok,
        "copies": len(places),
        "fault_count": report.fault_count,
        "faults": shown[:20],
        "coverage": report.coverage,
        "stretch": report.stretch,
        "exit_code": 0 if report.ok else 3,
    }
