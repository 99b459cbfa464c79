# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.distance`."""

from __future__ import annotations

from typing import Any

from bpy.props import IntProperty

from .kinds import (
    EXACT_QUALITY,
    QUALITIES,
    choice,
    detail,
    length,
    lengths,
    look,
    name_of,
    on_disk,
    quality,
    share,
    switch,
    use_modifiers,
)
from .region import BARRIERS, REGION

DISTANCE_SOURCES = (
    ("SELECTED", "Selected", "Vertices selected in Edit Mode"),
    ("VERTEX_GROUP", "Vertex Group", "Vertices whose weight in the group is above one half"),
    ("EMPTIES", "Empties", "Empties of a collection, or those parented to the object, brought to the nearest point"),
    (
        "CURVES",
        "Curves",
        "A curve, those of a collection or those parented to the object, brought to the surface",
    ),
    ("CURSOR", "3D Cursor", "The point of the surface nearest to the 3D cursor"),
    ("CURSOR_PARTS", "3D Cursor, Each Part", "Of each part of the surface the point nearest to the 3D cursor"),
)
ISOLINES_BY = (
    ("COUNT", "Count", "So many lines between the sources and the farthest point"),
    ("SPACING", "Spacing", "A line at every multiple of a distance"),
)

DISTANCE: dict[str, Any] = {
    "sources": choice("From", "Where distances are measured from", DISTANCE_SOURCES, "SELECTED"),
    "sources_group": name_of("Vertex Group", "The group whose vertices are sources; empty means the active one"),
    "sources_collection": name_of(
        "Collection", "Its empties or curves are sources; empty means those parented to the object"
    ),
    "sources_object": name_of("Curve", "The curve object to measure from; empty means those of the collection"),
    "limit": length("Limit", "Measure no farther than this; 0 means everywhere", 0.0),
    "quality": quality((*QUALITIES, EXACT_QUALITY)),
    "k": detail(),
    "cache_on_disk": on_disk(),
    "use_modifiers": use_modifiers(),
    "make_isolines": switch("Isolines", "Make a curve object of the lines of equal distance", False),
    "isolines_by": choice("By", "What says how many isolines there are", ISOLINES_BY, "COUNT"),
    "isoline_count": IntProperty(
        name="Count",
        description="Number of isolines",
        default=10,
        min=1,
        max=1000,
        soft_max=100,
        options={"SKIP_SAVE"},
    ),
    "isoline_spacing": length("Spacing", "Distance from one isoline to the next", 0.1, least=1e-6),
    "lengths": lengths("the model's extent"),
    "isoline_radius": length("Radius", "Half the thickness of the isolines", 0.005),
    "isoline_radius_share": share("Radius", "Half the thickness of the isolines, in percent of the extent", 0.25),
    "make_preview": switch("Preview", "Show the distances in colors; the object's own materials are kept", False),
    "preview_lines": switch("Lines", "Show lines of equal distance in the preview, too", True),
    "distance_attribute": name_of("Attribute", "Where distances are written", "saddleback_distance"),
    "look": look("distance"),
    **REGION,
    **BARRIERS,
}
DISTANCE_BEGIN: dict[str, Any] = {
    "sources": "CURSOR_PARTS",
    "use_modifiers": True,
    "make_isolines": True,
    "make_preview": True,
    "lengths": "RELATIVE",
}
