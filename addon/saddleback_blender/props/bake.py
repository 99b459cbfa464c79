# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.bake`."""

from __future__ import annotations

from typing import Any

from bpy.props import IntProperty, StringProperty

from .kinds import choice, name_of, switch

BITS = (
    ("8", "8 Bits", "Small files: enough for colors"),
    ("16", "16 Bits", "Files for heights and distances, from 0 to 1"),
    ("32", "32 Bits", "Floats: distances and places in world units"),
)
CELL_KINDS = (
    ("COLOR", "Colors", "A color for each cell, unlike its neighbors'"),
    ("NUMBER", "Numbers", "The number of the cell, as the attribute has it"),
)
PROFILES = (
    ("PANELS", "Panels", "Plates with fine joints, as the look has them"),
    ("PEBBLES", "Pebbles", "Round from the joint to the middle, as the look has them"),
    ("CELLS", "As Cells", "Gap, bevel and dome as they are set for the output Cells"),
)
SPACES = (
    ("TANGENT", "Tangent", "Along the UV map: red to its right, green upwards"),
    ("WORLD", "World", "Along the axes of the world"),
)

BAKE: dict[str, Any] = {
    "uv_name": name_of("UV Map", "The UV map that images are seen through; empty means the active one"),
    "resolution": IntProperty(
        name="Resolution", description="Width and height of each image, in pixels", default=2048, soft_min=64,
        soft_max=8192, options={"SKIP_SAVE"},
    ),
    "use_tiles": switch("UDIM Tiles", "Bake all tiles in which faces lie, instead of the first alone", False),
    "margin": IntProperty(
        name="Margin", description="As many pixels beside the faces get what is nearest", default=16, min=0, max=1024,
        soft_max=64, options={"SKIP_SAVE"},
    ),
    "bits": choice("Depth", "How exact the numbers in the images are", BITS, "16"),
    "bake_cell": switch("Cell", "Which cell is where", True),
    "cell_as": choice("Cells As", "What stands for a cell", CELL_KINDS, "COLOR"),
    "bake_edge_distance": switch("Edge Distance", "How far along the surface the edge of the cell is", True),
    "bake_height": switch("Height", "How high cells are raised, 1 where they are highest", True),
    "profile": choice("Profile", "How cells rise from their edges", PROFILES, "PANELS"),
    "bake_local_uv": switch(
        "Place in Cell", "Where each place is as seen from its cell's center, to the right and upwards", False
    ),
    "bake_direction": switch("Direction", "Where the directions of the field point", False),
    "direction_attribute": name_of("Directions", "The vector attribute that is baked", "saddleback_direction"),
    "direction_space": choice("Space", "The axes that directions are told by", SPACES, "TANGENT"),
    "image_prefix": name_of("Name", "What images are called, before what they show; empty means as the object"),
    "folder": StringProperty(
        name="Folder", description="Where the files go; empty means into the .blend file", default="",
        subtype="DIR_PATH", options={"SKIP_SAVE"},
    ),
}  # fmt: skip
