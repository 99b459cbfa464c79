# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.path`."""

from __future__ import annotations

from typing import Any

from .distance import DISTANCE_SOURCES
from .kinds import (
    EXACT_QUALITY,
    QUALITIES,
    choice,
    detail,
    length,
    lengths,
    name_of,
    on_disk,
    quality,
    share,
    switch,
    use_modifiers,
)
from .region import BARRIERS, REGION

PATH_POINTS = (
    *DISTANCE_SOURCES[:3],
    ("CURSOR", "3D Cursor", "From the point nearest to the 3D cursor to the one that is farthest from it"),
)
PATH_CONNECTIONS = (
    ("CHAIN", "Chain", "From each point to the next: in the order of selection where it is known, empties by name"),
    ("LOOP", "Closed Chain", "From each point to the next, and from the last back to the first"),
    ("PAIRS", "All Pairs", "From every point to every other"),
)

PATH: dict[str, Any] = {
    "points": choice("Through", "What the paths connect", PATH_POINTS, "SELECTED"),
    "points_group": name_of("Vertex Group", "The group whose vertices are connected; empty means the active one"),
    "points_collection": name_of("Collection", "Its empties are connected; empty means those parented to the object"),
    "from_cursor": switch("From Cursor", "Begin at the point of the surface nearest to the 3D cursor", False),
    "connect": choice("Connect", "Which points a path joins", PATH_CONNECTIONS, "CHAIN"),
    "smooth": switch("Smooth", "Let a chain pass its points without corners", False),
    "tighten": switch(
        "Pull Tight", "Pull a closed chain tight around what it encircles, until it is a closed geodesic", False
    ),
    "shorten": switch("Shorten", "Pull each path straight where the distance graph bends it a little", True),
    "quality": quality((*QUALITIES, EXACT_QUALITY)),
    "k": detail(),
    "cache_on_disk": on_disk(),
    "use_modifiers": use_modifiers(),
    "lengths": lengths("the model's extent"),
    "path_radius": length("Radius", "Half the thickness of the paths", 0.01),
    "path_radius_share": share("Radius", "Half the thickness of the paths, in percent of the extent", 0.4),
    "lift": length("Lift", "How far the paths run above the surface", 0.0),
    "lift_share": share("Lift", "How far the paths run above the surface, in percent of the extent", 0.0),
    **REGION,
    **BARRIERS,
}
PATH_BEGIN: dict[str, Any] = {"points": "CURSOR", "use_modifiers": True, "lengths": "RELATIVE"}
