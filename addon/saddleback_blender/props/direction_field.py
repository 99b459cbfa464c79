# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.direction_field`."""

from __future__ import annotations

from typing import Any

from bpy.props import FloatProperty, IntProperty

from .kinds import choice, length, lengths, name_of, share, switch, use_modifiers
from .region import REGION
from .tessellate import TESSELLATE

SYMMETRIES = (
    ("1", "Vectors", "One direction everywhere, with a head and a tail: scales, feathers, hair"),
    ("2", "Lines", "A direction and its opposite alike: planks, grain, fibers"),
    ("4", "Crosses", "Four directions at right angles alike: tiles, bricks, quads"),
)
ALIGNMENTS = (
    ("NONE", "None", "As smooth as strokes and singularities allow"),
    ("CURVATURE", "Curvature", "Lines along the least bent direction, crosses along both principal ones"),
    ("BOUNDARY", "Border", "Along every border of the surface"),
)
STROKES = (
    ("NONE", "None", "No strokes"),
    ("ANNOTATIONS", "Annotations", "What is drawn on the surface with the Annotate tool"),
    ("OBJECT", "Object", "The strokes of one curve or grease pencil object"),
    ("COLLECTION", "Collection", "The curves and grease pencils of a collection, or those parented to the object"),
)
PAINTED = (
    ("NONE", "None", "Nothing that is painted"),
    ("ATTRIBUTE", "Attribute", "A vector attribute of vertices or faces; zero where nothing is said"),
    ("COLOR", "Color Attribute", "A painted flow map: red points to the right of the UV map, green upwards"),
    ("IMAGE", "Image", "A flow map, seen through the active UV map"),
)
SINGULARITIES = (
    ("AUTO", "Automatic", "The field is singular where it is smoothest so"),
    ("EMPTIES", "Empties", "Where empties are: the index is their property 'index' or a number in their name"),
)
DOMAINS = (
    ("POINT", "Vertex", "One direction for each vertex"),
    ("FACE", "Face", "One direction for each face"),
)

DIRECTION_FIELD: dict[str, Any] = {
    "symmetry": choice("Kind", "What the field is made of", SYMMETRIES, "1"),
    "align": choice("Align", "What the field follows besides strokes", ALIGNMENTS, "NONE"),
    "align_weight": FloatProperty(
        name="Weight", description="How much the curvature counts against smoothness", default=1.0, min=1e-3,
        soft_max=100.0, options={"SKIP_SAVE"},
    ),
    "strokes": choice("Strokes", "What is drawn for the field to follow", STROKES, "NONE"),
    "strokes_object": name_of("Strokes Object", "The curve or grease pencil object whose strokes the field follows"),
    "strokes_collection": name_of("Collection", "Its strokes are followed; empty means those parented to the object"),
    "hard_strokes": switch(
        "Exact", "Follow strokes exactly; without it only those with 'hard' in their layer's or object's name", False
    ),
    "stroke_weight": FloatProperty(
        name="Strength", description="How much strokes count against smoothness", default=1.0, min=1e-3, soft_max=100.0,
        options={"SKIP_SAVE"},
    ),
    "stroke_reach": length(
        "Reach", "What of a stroke is farther from the surface is left out; 0 means a twentieth of its extent", 0.0
    ),
    "painted": choice("Painted", "Directions that the field follows where there are any", PAINTED, "NONE"),
    "painted_attribute": name_of("Attribute", "The vectors that the field follows"),
    "painted_color": name_of("Color Attribute", "The flow map that the field follows; empty means the active one"),
    "painted_image": name_of("Image", "The flow map that the field follows"),
    "painted_weight": FloatProperty(
        name="Weight", description="How much painted directions count against smoothness", default=1.0, min=1e-3,
        soft_max=100.0, options={"SKIP_SAVE"},
    ),
    "singularities": choice("Singularities", "Where the field turns about a point", SINGULARITIES, "AUTO"),
    "singularities_collection": name_of(
        "Empties", "The collection of the empties; empty means those parented to the object"
    ),
    "turn": FloatProperty(
        name="Turn", description="Turns the whole field, counter-clockwise seen from outside", default=0.0,
        subtype="ANGLE", soft_min=-3.1416, soft_max=3.1416, options={"SKIP_SAVE"},
    ),
    "use_modifiers": use_modifiers(),
    "domain": choice("On", "What the attribute is written on", DOMAINS, "POINT"),
    "direction_attribute": name_of("Attribute", "Where directions are written", "saddleback_direction"),
    "make_arrows": switch("Arrows", "Make an object of arrows that shows the field and its singularities", True),
    "arrow_count": IntProperty(
        name="Count", description="About so many arrows", default=1500, min=1, max=100000, soft_max=10000,
        options={"SKIP_SAVE"},
    ),
    "arrow_length": length("Length", "Length of the arrows; 0 means by their number", 0.0),
    "make_streamlines": switch("Streamlines", "Make a curve object of lines along the field", False),
    "streamline_spacing": length(
        "Spacing", "Distance between lines; 0 means a fiftieth of the surface's extent", 0.0
    ),
    "streamline_length": length("Longest", "Length of the longest lines; 0 means thirty times their distance", 0.0),
    "lengths": lengths("the model's extent"),
    "streamline_radius": length("Radius", "Half the thickness of the lines", 0.005),
    "streamline_radius_share": share("Radius", "Half the thickness of the lines, in percent of the extent", 0.2),
    "seed": TESSELLATE["seed"],
    **REGION,
}  # fmt: skip
DIRECTION_FIELD_BEGIN: dict[str, Any] = {"use_modifiers": True, "lengths": "RELATIVE"}
