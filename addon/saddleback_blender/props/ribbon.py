# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.ribbon`."""

from __future__ import annotations

from typing import Any

from .kinds import choice, length, lengths, name_of, share, use_modifiers
from .region import BARRIERS, REGION

SHOWN = (
    ("BAND", "Band", "A plain raised band"),
    ("IMAGE", "Image", "An image, as a decal"),
    ("OBJECT", "Object", "A mesh, a text or what else has faces: X along the curve, Z away from the surface"),
)
REPEATS = (
    ("REPEAT", "Repeat", "As often, one after the other, as keeps the proportions"),
    ("STRETCH", "Stretch", "Once, over the whole length"),
)

RIBBON: dict[str, Any] = {
    "curves_object": name_of("Curve", "The curve object to lay ribbons along; empty means those of the collection"),
    "curves_collection": name_of(
        "Collection", "Ribbons are laid along its curves; empty means those parented to the object"
    ),
    "show": choice("Show", "What is laid along the curves", SHOWN, "BAND"),
    "image_name": name_of("Image", "The image that is laid along the curves"),
    "ribbon_object": name_of("Object", "The object whose faces are laid along the curves"),
    "repeat": choice("Fill", "How the length of a curve is filled", REPEATS, "REPEAT"),
    "use_modifiers": use_modifiers(),
    "lengths": lengths("the model's extent"),
    "width": length("Width", "Width of the ribbons, one half on each side of the curve", 0.2),
    "width_share": share("Width", "Width of the ribbons, in percent of the extent", 6.0),
    "lift": length("Lift", "How far the ribbons lie above the surface", 0.005),
    "lift_share": share("Lift", "How far the ribbons lie above the surface, in percent of the extent", 0.15),
    **REGION,
    **BARRIERS,
}
RIBBON_BEGIN: dict[str, Any] = {"use_modifiers": True, "lengths": "RELATIVE"}
