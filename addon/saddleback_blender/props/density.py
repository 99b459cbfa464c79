# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds how dense cells and shapes are to be: for all panels that ask."""

from __future__ import annotations

from typing import Any

from bpy.props import FloatProperty

from .kinds import choice, length, name_of, switch

DENSITY_SOURCES = (
    ("UNIFORM", "Uniform", "Cells of equal size everywhere"),
    ("VERTEX_GROUP", "Vertex Group", "Painted weights"),
    ("ATTRIBUTE", "Attribute", "A number attribute of vertices, edges, faces or face corners"),
    ("COLOR", "Color Attribute", "Painted colors"),
    ("MASK", "Sculpt Mask", "The sculpt mask"),
    ("IMAGE", "Image", "An image seen through a UV map"),
    ("CURVATURE", "Curvature", "High where the surface bends much"),
    ("DISTANCE", "Distance to Curves", "High at curves, falling with the distance from them"),
    ("SPREAD", "Spread", "The weights of a few painted vertices, spread smoothly over all of the surface"),
)
CHANNELS = (
    ("LUMINANCE", "Luminance", "Brightness of the linear color (Rec. 709)"),
    ("R", "Red", "Linear red"),
    ("G", "Green", "Linear green"),
    ("B", "Blue", "Linear blue"),
    ("A", "Alpha", "Alpha"),
)

DENSITY: dict[str, Any] = {
    "density_source": choice("Density", "What says where cells and shapes are small", DENSITY_SOURCES, "UNIFORM"),
    "density_name": name_of("Density Name", "The vertex group, attribute or UV map; empty means the active one"),
    "density_channel": choice("Channel", "Which part of the color counts", CHANNELS, "LUMINANCE"),
    "density_image": name_of("Density Image", "The density is high where the image is light"),
    "density_object": name_of(
        "Density Curve", "The density is high at this curve; empty means those of the collection"
    ),
    "density_collection": name_of("Collection", "Its curves are used; empty means those parented to the object"),
    "density_reach": length("Reach", "How far from a curve the density falls; 0 means a tenth of the extent", 0.0),
    "density_beyond": FloatProperty(
        name="Beyond", description="The density far from curves, when it is 1 at them", default=0.1, min=0.0,
        max=100.0, soft_max=1.0, options={"SKIP_SAVE"},
    ),
    "density_invert": switch("Invert", "High where little is painted, and low where much is", False),
    "density_smaller_by": FloatProperty(
        name="Smaller By",
        description="Cells are so many times smaller where the paint is full, and as they are without it where nothing "
        "is painted; 0 makes cells per area proportional to the paint, and none where nothing is painted",
        default=0.0, min=0.0, max=100.0, soft_max=20.0, precision=1, step=10, options={"SKIP_SAVE"},
    ),
    "density_contrast": FloatProperty(
        name="Contrast",
        description="Exponent of the density: 1 makes cells per area proportional to the paint, 0 ignores the paint",
        default=1.0,
        min=0.0,
        max=8.0,
        options={"SKIP_SAVE"},
    ),
}  # fmt: skip
DENSITY_BEGIN: dict[str, Any] = {"density_smaller_by": 4.0}
