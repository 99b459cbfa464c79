# SPDX-License-Identifier: GPL-3.0-or-later
"""Says what a run tells about its cells, in words."""

from __future__ import annotations

import math
from collections.abc import Callable

from .results import CellMesh, Dual, Figures, LampShell, SurfacePolygons

# Faults told one by one; of more only the number.
MOST_TOLD = 3
JOIN = "give the object a Remesh modifier (Voxel) first"  # Repair joins no parts that pass through each other
LEAST_TOLD = 0.01  # of a shell's thickness: units would say 0 of thinner places


def lines_of(figures: Figures | None) -> list[str]:
    """Lines for the panel."""
    if figures is None:
        return []
    lines = [
        f"Triangles of the sites: quality {figures.triangle_quality:.3f}, "
        f"least angle {math.degrees(figures.least_angle):.1f}\N{DEGREE SIGN}, {100 * figures.irregular:.0f} % irregular"
    ]
    if figures.energy is not None:
        lines.append(f"Energy: {figures.energy:.3f} times that of regular hexagons in a plane")
    return lines


def faults_of(dual: Dual, policy: str) -> list[str]:
    """One sentence where the mesh has faults. One of a look has some though the policy is REPAIR: that was in vain."""
    if not dual.issues:
        return []
    told = "; ".join(dual.issues[:MOST_TOLD])
    rest = len(dual.issues) - MOST_TOLD
    more = f"; and {rest} more" if rest > 0 else ""
    how = f"ask for more cells{_or_repair(policy)}, or {JOIN}"
    return [f"The dual mesh has faults where cells are too large ({told}{more}): {how}"]


def shell_of(shell: LampShell, length: Callable[[float], str], volume: Callable[[float], str]) -> str:
    """Says how thick a lamp shell is and how much a printer fills; both numbers as the file's units want them."""
    text = f", walls {length(shell.thickness)} thick"
    if shell.thinner:
        thinnest = float(shell.wall.min())
        least = length(thinnest) if thinnest >= LEAST_TOLD * shell.thickness else "next to nothing"
        text += f" ({least} at the least, {100 * shell.thinner:.2g} % thinned for want of room)"
    if shell.added:
        text += f", {shell.added} {'cells' if shell.added > 1 else 'cell'} added so that it hangs together"
    return text + f", volume {volume(shell.volume)}, {len(shell.triangles):,} faces"


def shell_faults_of(shell: LampShell) -> list[str]:
    """Sentences about what a printer would stumble over."""
    faults = []
    if shell.pieces > 1:
        told = f"The lamp shell is in {shell.pieces} pieces"
        several = f"{told}, since the mesh is in {shell.parts} parts: join those first to print one lamp"
        faults.append(several if shell.parts > 1 else f"{told}: ask for more cells")
    if shell.crossing:
        faults.append(
            f"{shell.crossing} faces of the lamp shell pass through others: make it thinner or, where the mesh passes "
            f"through itself, {JOIN}"
        )
    return faults


def cell_faults_of(cells: CellMesh) -> list[str]:
    """One sentence where cells pass through each other."""
    count = len(cells.crossing)
    if not count:
        return []
    told = "1 cell passes" if count == 1 else f"{count} cells pass"
    where = "through others or itself" if count == 1 else "through others or themselves"
    return [f"{told} {where}, as the mesh does there or nearly does: no harm in a picture; for a print {JOIN}"]


def polygon_faults_of(polygons: SurfacePolygons, policy: str) -> list[str]:
    """One sentence where cells have no polygon."""
    count = len(polygons.missing)
    if not count:
        return []
    told = ", ".join(str(cell) for cell in polygons.missing[:MOST_TOLD]) + (", ..." if count > MOST_TOLD else "")
    what = "1 cell has no face" if count == 1 else f"{count} cells have no face"
    return [f"{what}, since none can be as large ({told}): ask for more cells{_or_repair(policy)}"]


def _or_repair(policy: str) -> str:
    """What else helps where it has not been tried."""
    return "" if policy == "REPAIR" else ", or choose Repair"


def lost_of(lost: int, thinner: int = 0) -> str:
    """Says of how many cells something is missing, where there are any."""
    left_out = f", {lost} narrower than the gap left out" if lost else ""
    return left_out + (f", {thinner} made thinner where there was no room" if thinner else "")
