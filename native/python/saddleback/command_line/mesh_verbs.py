# SPDX-License-Identifier: MIT
"""``saddleback info`` and ``saddleback repair``."""

from __future__ import annotations

import click
import numpy as np

import saddleback as sb
from saddleback.command_line import runs
from saddleback.command_line.runs import Run, Summary, output, verb


@click.command("info", no_args_is_help=True)
@click.argument("meshes", metavar="MESH...", nargs=-1, required=True)
@runs.JSON
def info(meshes: tuple[str, ...], as_json: bool) -> int:
    """Tell size, topology and faults of meshes.

    A mesh with faults is described as far as it goes; the exit code is 1 then.
    """
    worst = 0
    for number, name in enumerate(meshes):
        if number and not as_json:
            click.echo()
        vertices, triangles = sb.read_arrays(name)
        summary = {"mesh": name, "vertices": len(vertices), "faces": len(triangles)}
        try:
            summary |= _of_mesh(sb.Mesh(vertices, triangles))
        except sb.MeshError as error:
            worst = 1
            summary |= {
                "valid": False,
                "fault": runs.fault_of("", error),
                "remedy": f"saddleback repair {name} -o FILE",
            }
        runs.say(summary, as_json)
    return worst


def _of_mesh(mesh: sb.Mesh) -> Summary:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    return {
        "edges": mesh.edge_count,
        "valid": True,
        "closed": mesh.is_closed,
        "components": mesh.component_count,
        "genus": mesh.genus,
        "boundary_loops": len(mesh.boundary_loops),
        "area": mesh.area,
        "size": (high - low).tolist(),
        "least_corner": low.tolist(),
        "mean_edge": mesh.mean_edge_length,
        "least_angle_degrees": float(np.degrees(mesh.corner_angles.min())),
        "saddle_vertices": len(mesh.saddle_vertices),
        "fingerprint": f"{mesh.fingerprint:016x}",
    }


@verb(
    output("-o", "--output", formats=("ply", "obj"), help="The mended mesh"),
    click.option("--weld", type=click.FloatRange(0), default=0.0, help="Vertices within this distance become one."),
    click.option("--stitch", is_flag=True, help="Divide border edges where vertices of other borders lie on them."),
    click.option("--fill-holes", type=click.IntRange(0), default=0, help="Fill holes of up to so many edges."),
)
def repair(run: Run, weld: float, stitch: bool, fill_holes: int) -> Summary:
    """Make a valid mesh of nearly anything."""
    vertices, triangles = sb.read_arrays(run.source, job=run.job)
    mesh, report = sb.repair(vertices, triangles, weld, stitch=stitch, fill_holes=fill_holes, job=run.job)
    if run.out["output"]:
        sb.write_mesh(run.out["output"], mesh)
    return {
        "changes": report.changes,
        "vertices": mesh.vertex_count,
        "faces": mesh.face_count,
        "boundary_loops": len(mesh.boundary_loops),
        "said": str(report),
    }
