# SPDX-License-Identifier: GPL-3.0-or-later
"""The looks: what one click makes of an object, an entry each. Plain data: nothing here knows Blender.

A look is the settings of one operator that differ from what the panel begins with, and a finish: the colors and the
material of what is made. What another look of the same operator sets and this one does not name goes back to what the
panel begins with; all else, such as paint, strokes and the seed, stays as the artist has it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

NO_LOOK = "NONE"
# Of new meshes: borders and the edges of boxes and machines stay, the many lesser creases of scans do not hold sites.
LINES = {"hold_boundary": True, "hold_sharp": True, "sharp_angle": math.radians(60.0)}


@dataclass(frozen=True)
class Finish:
    """A material, called "Saddleback" and its name. Each cell or shape has one of the colors, unlike its neighbors'."""

    name: str
    colors: tuple[str, ...]  # sRGB, "#rrggbb"; what is named twice is twice as frequent
    roughness: float = 0.5
    metallic: float = 0.0
    coat: float = 0.0  # how much clear varnish there is
    contrast: float = 0.15  # by how much colors are lighter or darker by chance


@dataclass(frozen=True)
class Look:
    """One entry of the list: its button, the operator that makes it, what is set."""

    label: str
    description: str
    icon: str
    operator: str
    settings: dict[str, Any] = field(default_factory=dict)
    finish: Finish | None = None
    ground: str = ""  # sRGB: the body's color between what lies on it, where it has no material of its own
    beside: str = ""  # the look whose button it stands beside, as an icon
    hides_source: bool = False  # which would lie in or on what is made


LOOKS: dict[str, Look] = {
    "PANELS": Look(
        "Panels", "Plates with fine joints, like the hull of a ship", "MOD_EXPLODE", "tessellate",
        {
            "count": 200, "iterations": 40, "make_edges": False, "make_cells": True, "gap_share": 5.0,
            "inset_share": 4.0, "thickness_share": 6.0,
        },
        Finish(
            "Panels", (
                "#d8d4ca", "#cfcabf", "#c6c2b8", "#e4e0d5", "#dad7cf", "#bcbab3", "#ece8dd", "#d2cdc0", "#98a0a5",
                "#7f878d", "#d9692f",
            ), 0.35, coat=0.5, contrast=0.04,
        ), ground="#26282a",
    ),
    "PEBBLES": Look(
        "Pebbles", "Round stones side by side, like leather or a riverbed", "MESH_ICOSPHERE", "tessellate",
        {
            "count": 800, "iterations": 12, "make_edges": False, "make_cells": True, "gap_share": 8.0,
            "inset_share": 24.0, "thickness_share": 24.0, "dome": 1.0,
        },
        Finish("Pebbles", ("#6f675d", "#8c8273", "#a59a88", "#574f49", "#7d6a58", "#949087"), 0.55, contrast=0.2),
        ground="#2b2622",
    ),
    "SCALES": Look(
        "Scales", "Scales that overlap along the strokes, like those of a fish or a roof's tiles", "MOD_FLUID",
        "distribute",
        {
            "shapes": "SCALES", "count": 1000, "overlap": 0.73, "tilt": math.radians(14.0), "no_crossings": True,
            "fill_gaps": True, "fit": 0.04,
        },
        Finish("Scales", ("#2a6d5c", "#1f5a4e", "#3b8266", "#184741", "#57926a"), 0.3, coat=0.5),
        ground="#12302a",
    ),
    "FEATHERS": Look(
        "Feathers", "Plumage along the strokes", "FORCE_WIND", "distribute",
        {
            "shapes": "FEATHERS", "count": 700, "overlap": 0.65, "tilt": math.radians(12.0), "no_crossings": True,
            "fill_gaps": True, "fit": 0.04,
        },
        Finish("Feathers", ("#2b3f5c", "#35557a", "#24344c", "#4a7296", "#1c2a3d"), 0.6),
        ground="#161f2c",
    ),
    "STUDS": Look(
        "Studs", "Brass heads side by side", "MESH_CYLINDER", "distribute",
        {"shapes": "STUDS", "count": 400, "fit": 0.03},
        Finish("Studs", ("#c9a15a", "#bd9350", "#d2ae6c"), 0.3, metallic=1.0, contrast=0.05),
        ground="#3a2418",
    ),
    "MOSAIC": Look(
        "Mosaic", "Small tiles of stone and glass", "MOD_LATTICE", "distribute",
        {"shapes": "MOSAIC", "count": 900, "fit": 0.03},
        Finish("Mosaic", ("#1f5a94", "#2a9d8f", "#e9c46a", "#e2714f", "#f1ecdd", "#264653"), 0.25, coat=0.4),
        ground="#4a463f",
    ),
    "LAMP": Look(
        "Lamp", "A lattice of ribs, closed and thick enough to print", "LIGHT", "tessellate",
        {"count": 150, "iterations": 40, "make_edges": False, "make_shell": True},
        Finish("Lamp", ("#e0ae62",), 0.45, contrast=0.0), hides_source=True,
    ),
    "STIPPLE": Look(
        "Stipple", "Ink dots on paper, close together where the density is high", "STICKY_UVS_DISABLE", "tessellate",
        {
            "count": 3000, "iterations": 20, "make_edges": False, "make_centers": True, "instance_dots": True,
            "instance_size": "EQUAL", "instance_scale": 0.5,
        },
        ground="#f2eee3",
    ),
    "REMESH": Look(
        "Remesh", "A new mesh of even triangles with the same layers and materials", "MOD_REMESH", "tessellate",
        {"count": 2000, "iterations": 60, "make_edges": False, "make_dual": True, **LINES}, hides_source=True,
    ),
    "QUADS": Look(
        "Quads", "A new mesh of quads: triangles cut into three each, with all vertices on the surface", "MESH_GRID",
        "tessellate",
        {"count": 700, "iterations": 60, "make_edges": False, "make_dual": True, "dual_faces": "QUADS", **LINES},
        beside="REMESH", hides_source=True,
    ),
    "BANDS": Look(
        "Bands", "Colors and lines by the distance along the surface", "IPO_ELASTIC", "distance",
        {"make_isolines": True, "make_preview": True, "isolines_by": "COUNT", "isoline_count": 24},
    ),
}  # fmt: skip


def of_operator(name: str) -> dict[str, Look]:
    """The looks that one operator makes."""
    return {key: look for key, look in LOOKS.items() if look.operator == name}


def finish_of(look: str) -> Finish | None:
    """The finish of a look, None where there is none."""
    return LOOKS[look].finish if look in LOOKS else None
