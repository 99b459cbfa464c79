# SPDX-License-Identifier: MIT
"""Direction fields: `python -m tests.bench fields FOLDER [FACTOR] [LARGE_MESH ...]`.

Whether indices are those that were asked for (told from the vectors alone), how well strokes are met, and how long
fields, edits and streamlines take (CPU time of the process). LARGE_MESH: files to time besides the torus that is made
here. FACTOR: how many times slower than the reference this machine is; bars are multiplied by it.
"""

from __future__ import annotations

import re
import resource
import time
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.native.field_indices import euler_characteristic, indices

Floats = NDArray[np.float64]
CHECKED = (
    "icosphere-10k",
    "max-planck-13k",
    "spot-3k",
    "rocker-arm-10k",
    "double-torus-14k",
    "five-torus-3k",
    "turbine-9k-genus11",
    "tube-lattice-genus22",
    "face-17k-open",
    "bunny-35k-holes",
    "cylinder-open-12k",
    "camelhead-11k-open",
)
SYMMETRIES = (1, 2, 4)
INPUTS = 200


def row(measure: str, value: str, bar: str = "") -> None:
    print(f"{measure:<84} {value:>24}  {bar}", flush=True)


def seconds(work: Callable[[], object], times: int = 3) -> float:
    """The shortest of a few, CPU time of the whole process."""
    best = np.inf
    for _ in range(times):
        start = time.process_time()
        work()
        best = min(best, time.process_time() - start)
    return float(best)


# --- indices ----------------------------------------------------------------------------------------------------------


def random_indices(mesh: sb.Mesh, symmetry: int, total: Fraction, rng: np.random.Generator) -> dict[int, float]:
    """Up to ten pairs of single units besides those that make the sum, at any inner vertices."""
    needed = int(total * symmetry)
    units = [int(np.sign(needed))] * abs(needed) + [1, -1] * int(rng.integers(0, 11))
    inner = np.setdiff1d(np.arange(mesh.vertex_count), mesh.boundary_vertices)
    vertices = rng.choice(inner, len(units), replace=False)
    return {int(v): unit / symmetry for v, unit in zip(vertices, units, strict=True)}


def check_indices(folder: Path) -> None:
    editors: dict[tuple[str, int], tuple[sb.Mesh, sb.DirectionFieldEditor]] = {}
    kept = told = crowded = refused = 0
    for i in range(INPUTS):
        name, symmetry = CHECKED[i % len(CHECKED)], SYMMETRIES[i // len(CHECKED) % 3]
        if (name, symmetry) not in editors:
            mesh = sb.read_mesh(folder / f"{name}.ply")
            editors[name, symmetry] = mesh, sb.DirectionFieldEditor(mesh, symmetry)
        mesh, editor = editors[name, symmetry]
        rng = np.random.default_rng(i)
        closed = len(mesh.boundary_loops) == 0
        wanted = random_indices(mesh, symmetry, Fraction(euler_characteristic(mesh) if closed else 0), rng)
        field = editor.field(wanted)
        kept += field.singularities == wanted
        told += indices(mesh, field.vectors, symmetry) == wanted
        crowded += field.largest_turn >= np.pi / symmetry
        refused += is_refused(mesh, editor, symmetry, rng)
    row("indices of the field equal to the given ones", f"{kept} of {INPUTS}", f"{INPUTS}")
    row("    told from the vectors alone", f"{told} of {INPUTS}", f"{INPUTS}")
    row("    fields that turn by pi / symmetry between two faces", f"{crowded}")
    row("wrong sums refused with what is missing", f"{refused} of {INPUTS}", f"{INPUTS}")


def is_refused(mesh: sb.Mesh, editor: sb.DirectionFieldEditor, symmetry: int, rng: np.random.Generator) -> bool:
    """Indices of another sum than the Euler characteristic, every boundary followed."""
    lacking = Fraction(int(rng.integers(1, 9)) * int(rng.choice([-1, 1])), symmetry)
    wanted = random_indices(mesh, symmetry, euler_characteristic(mesh) - lacking, rng)
    try:
        editor.field(wanted, loop_indices=dict.fromkeys(range(len(mesh.boundary_loops)), 0))
    except sb.InputError as error:
        return re.search(rf": {re.escape(str(lacking))} is missing$", str(error)) is not None
    return False


# --- strokes and time -------------------------------------------------------------------------------------------------


def ten_pairs(mesh: sb.Mesh, rng: np.random.Generator) -> dict[int, float]:
    """Ten singularities, of whole indices that sum to the Euler characteristic."""
    inner = np.setdiff1d(np.arange(mesh.vertex_count), mesh.boundary_vertices)
    vertices = rng.choice(inner, 10, replace=False)
    wanted = [1, -1] * 5
    lacking = euler_characteristic(mesh) if not mesh.boundary_loops else 0
    for i in range(abs(lacking)):
        wanted[(1 if lacking > 0 else 0) + 2 * (i // 2 % 5)] += int(np.sign(lacking))
    return {int(v): float(k) for v, k in zip(vertices, wanted, strict=True) if k}


def strokes_of(mesh: sb.Mesh, count: int, rng: np.random.Generator) -> list[sb.SurfaceCurve]:
    """Straight curves of forty edges' length."""
    starts = rng.choice(np.setdiff1d(np.arange(mesh.vertex_count), mesh.boundary_vertices), count, replace=False)
    length = 40 * mesh.mean_edge_length
    return [sb.SurfaceCurve(mesh, sb.trace(mesh, int(v), float(rng.uniform(0, 6)), length).surface) for v in starts]


def angles_to_strokes(mesh: sb.Mesh, field: sb.DirectionField, curves: list[sb.SurfaceCurve]) -> Floats:
    """Radians between the field and each piece of the curves in the face of the piece."""
    vectors, found = field.vectors, []
    for curve in curves:
        positions = curve.points.positions(mesh)
        pieces = np.diff(positions, axis=0)
        length = np.linalg.norm(pieces, axis=1)
        keep = length > 1e-6 * length.max()
        faces = sb.project(mesh, (positions[:-1] + positions[1:])[keep] / 2).faces
        pieces = pieces[keep] / length[keep, None]
        sine = np.linalg.norm(np.cross(pieces, vectors[faces]), axis=1)
        found.append(np.arctan2(sine, (pieces * vectors[faces]).sum(axis=1)))
    return np.concatenate(found)


def apart(mesh: sb.Mesh, curves: list[sb.SurfaceCurve]) -> list[sb.SurfaceCurve]:
    """The curves that share no face with an earlier one, or come back to one: no field can follow two at once."""
    taken: set[int] = set()
    chosen = []
    for curve in curves:
        positions = curve.points.positions(mesh)
        along = sb.project(mesh, (positions[:-1] + positions[1:]) / 2).faces
        faces = set(along.tolist())
        if not faces & taken and len(faces) == 1 + np.count_nonzero(np.diff(along)):
            chosen.append(curve)
        taken |= faces
    return chosen


def time_fields(name: str, mesh: sb.Mesh, factor: float, bars: bool) -> None:
    rng = np.random.default_rng(1)
    wanted, curves = ten_pairs(mesh, rng), apart(mesh, strokes_of(mesh, 40, rng))[:11]
    soft, hard = ([sb.Stroke(curve, is_hard) for curve in curves[:10]] for is_hard in (False, True))
    label = f"{name}, {mesh.face_count} faces: "
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    first = seconds(lambda: sb.direction_field(mesh, 1, wanted, soft))
    peak = 1024 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / mesh.face_count
    row(f"{label}10 singularities, 10 strokes, s", f"{first:.2f}", f"{1.5 * factor:.2f} ({factor:.2f})" * bars)
    row("    more memory at its peak, bytes a face", f"{peak:.0f}", "2000 (1500)" * bars)
    editor = sb.DirectionFieldEditor(mesh, 1)
    editor.field(wanted, soft)
    edits = [
        seconds(lambda strokes=strokes: editor.field(wanted, strokes), 1)
        for strokes in ([*soft[:9], sb.Stroke(curves[10])], soft, [*soft[:9], sb.Stroke(curves[10])])
    ]
    row("    edit of one stroke, s", f"{min(edits):.2f}", f"{0.7 * factor:.2f} ({0.3 * factor:.2f})" * bars)
    moved = {**wanted, **dict(zip([v + 1 for v in list(wanted)[:1]], list(wanted.values())[:1], strict=True))}
    moved.pop(next(iter(wanted)))
    row("    edit of one singularity, s", f"{seconds(lambda: editor.field(moved, soft), 1):.2f}")
    for kind, strokes in (("hard, most", hard), ("soft, mean", soft)):
        off = angles_to_strokes(mesh, sb.direction_field(mesh, 1, wanted, strokes), curves[:10])
        value = f"{off.max():.1e} rad" if strokes is hard else f"{np.degrees(off.mean()):.2f} degrees"
        row(f"    angle to strokes, {kind}", value, "1e-6 rad" if strokes is hard else "2 degrees")
    for symmetry in SYMMETRIES:
        start = time.process_time()
        field = sb.direction_field(mesh, symmetry)
        spent = time.process_time() - start
        row(f"    smoothest field, symmetry {symmetry}, s", f"{spent:.2f}", f"{len(field.singularities)} singularities")
    start = time.process_time()
    lines = [sb.streamline(mesh, field, int(v), 200 * mesh.mean_edge_length, True) for v in range(0, 1000, 5)]
    spent = time.process_time() - start
    points = sum(len(line.points) for line in lines)
    row("    a point of a streamline, us", f"{1e6 * spent / points:.2f}")


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0])
    factor = float(arguments[1]) if len(arguments) > 1 else 1.0
    row("measure", "found", "bar (goal)")
    time_fields("torus", sb.Mesh(*meshes.torus(800, 250)), factor, True)
    for path in arguments[2:]:
        time_fields(Path(path).stem, sb.read_mesh(path), factor, False)
    check_indices(folder)
    return 0
