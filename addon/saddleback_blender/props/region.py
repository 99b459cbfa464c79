# SPDX-License-Identifier: GPL-3.0-or-later
"""The part of the object that a layer covers: settings of the layer, which all operators that run in it share."""

from __future__ import annotations

from typing import Any

from .kinds import choice, name_of, switch

REGIONS = (
    ("WHOLE", "Whole Surface", "All faces"),
    ("VERTEX_GROUP", "Vertex Group", "Faces whose weights are above one half in the mean"),
    ("ATTRIBUTE", "Painted", "Faces whose values of an attribute, or lightness of its colors, are above one half"),
    ("FACES", "Selected Faces", "Faces that were selected in Edit Mode, kept as an attribute"),
    ("MATERIAL", "Material", "Faces that show a material"),
)

REGION: dict[str, Any] = {
    "region": choice("On", "Which part of the object the layer covers", REGIONS, "WHOLE"),
    "region_name": name_of("Region", "The vertex group, attribute or material of the part that the layer covers"),
}
BARRIER_KINDS = (
    ("NONE", "None", "Nothing but the surface's own border"),
    ("SEAMS", "Seams", "Edges that are marked as seams"),
    ("SHARP", "Sharp Edges", "Edges that are marked sharp"),
    ("ATTRIBUTE", "Attribute", "Edges whose values are above one half, or faces, which are left out"),
)
# Of the operators that measure distances.
BARRIERS: dict[str, Any] = {
    "barriers": choice("Barriers", "What distances, paths and cells do not cross", BARRIER_KINDS, "NONE"),
    "barriers_name": name_of("Barriers", "The attribute of the edges or faces that are not crossed"),
}
# Of the operators that make patterns.
MIRROR: dict[str, Any] = {"mirror_x": switch("X Mirror", "The same pattern to both sides of the object's own X", False)}
PATTERN = REGION | MIRROR
LAYER_SETTINGS = PATTERN | BARRIERS
