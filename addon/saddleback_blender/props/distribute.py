# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.distribute`."""

from __future__ import annotations

import math
from typing import Any

from bpy.props import FloatProperty, IntProperty

from .density import DENSITY, DENSITY_BEGIN
from .kinds import choice, length, lengths, look, name_of, share, switch, use_modifiers
from .region import PATTERN
from .tessellate import TESSELLATE

SHAPES = (
    ("SCALES", "Scales", "Shields with a keel, their tips along the field"),
    ("STUDS", "Studs", "Round heads with a rim"),
    ("FEATHERS", "Feathers", "Long vanes along the field"),
    ("LEAVES", "Leaves", "Leaves of two sizes"),
    ("MOSAIC", "Mosaic", "Square, long and three-cornered tiles"),
    (
        "COLLECTION",
        "Collection",
        "Its meshes, closed curves, texts and images. Properties of each say what it has of its own: 'share', "
        "'density', 'direction', 'size'",
    ),
    ("IMAGE", "Image", "Where an image is opaque or, without transparency, dark"),
)
FIELD_SOURCES = (
    ("PANEL", "Direction Field", "The field that the panel Direction Field says, made anew where that has changed"),
    ("ATTRIBUTE", "Attribute", "A vector attribute of vertices or faces"),
    ("COLOR", "Color Attribute", "A painted flow map: red points to the right of the UV map, green upwards"),
    ("IMAGE", "Image", "A flow map, seen through the active UV map"),
    ("NONE", "Smoothest", "Lines as smooth as can be, without strokes"),
)

DISTRIBUTE: dict[str, Any] = {
    "shapes": choice("Shapes", "What is laid on the surface", SHAPES, "SCALES"),
    "shapes_collection": name_of("Shapes Collection", "The collection whose objects are laid on the surface"),
    "shapes_image": name_of("Shape Image", "The image whose mask is laid on the surface"),
    "count": IntProperty(
        name="Count", description="Number of shapes; about so many where they fill the surface and Size is 0",
        default=500, min=1, soft_max=20000, options={"SKIP_SAVE"},
    ),
    "size": length("Size", "Radius of the circle around the largest shapes; 0 means as large as so many may be", 0.0),
    "size_variation": FloatProperty(
        name="Variation", description="By which share of the largest the smallest are smaller", default=0.0, min=0.0,
        max=0.95, subtype="FACTOR", options={"SKIP_SAVE"},
    ),
    "size_by_density": switch("Size by Density", "Shapes are small where the density is high", False),
    "lengths": lengths("the size of the place that a shape has"),
    "gap": length("Gap", "Least distance from shape to shape", 0.0),
    "gap_share": share("Gap", "Least distance from shape to shape, in percent of the place that one has", 0.0),
    "overlap": FloatProperty(
        name="Overlap", description="Share of their length by which shapes with a mesh reach over those before them, "
        "like scales or roof tiles; what is not covered touches no other", default=0.0, min=0.0, max=0.9,
        soft_max=0.75, subtype="FACTOR", options={"SKIP_SAVE"},
    ),
    "tilt": FloatProperty(
        name="Tilt", description="How steeply shapes that overlap rise from the surface to their tips",
        default=math.radians(14.0), min=0.0, max=math.radians(80.0), soft_max=math.radians(45.0), subtype="ANGLE",
        options={"SKIP_SAVE"},
    ),
    "no_crossings": switch(
        "No Crossings", "Draw shapes that overlap flatter and narrower, and smaller where they would still "
        "pass through others", False,
    ),
    "fill_gaps": switch(
        "Fill Gaps", "Lay small copies where shapes that overlap without crossings leave skin bare", False
    ),
    "packing": FloatProperty(
        name="Packing", description="0 scatters shapes by chance, 1 lays them side by side, which makes room for more",
        default=1.0, min=0.0, max=1.0, subtype="FACTOR", options={"SKIP_SAVE"},
    ),
    "maximal": switch("Fill", "Go on until nothing more fits, whatever the count, and prove it", False),
    "mirror": switch("Mirror", "Mirror half of the shapes, by chance", False),
    "bend": switch("Bend", "Long shapes bend along the field", False),
    "seed": TESSELLATE["seed"],
    "field_source": choice("Field", "Which way shapes point", FIELD_SOURCES, "PANEL"),
    "direction_attribute": name_of("Attribute", "The vectors that shapes point along", "saddleback_direction"),
    "direction_color": name_of("Color Attribute", "The flow map that shapes point along; empty means the active one"),
    "direction_image": name_of("Image", "The flow map that shapes point along"),
    "forbidden_group": name_of("Keep Off", "No shape lies where this vertex group's weights are above one half"),
    "keep": switch(
        "Keep", "The points of the output Instances stay as they lie, whatever was deleted, moved or turned by hand; "
        "the others are laid anew around them", False,
    ),
    **DENSITY,
    "use_modifiers": use_modifiers(),
    "make_bent": switch("Bent Copies", "Make one mesh of all shapes, bent onto the surface", True),
    "fit": FloatProperty(
        name="Fit", description="How far faces of bent copies may leave the surface, as a share of the shape's radius: "
        "those that cross its edges are divided. 0 leaves them as they are", default=0.01, min=0.0, soft_max=0.1,
        max=1.0, precision=3, options={"SKIP_SAVE"},
    ),
    "thickness": length("Thickness", "Of shapes without a mesh: how far they rise; 0 means by their size", 0.0),
    "make_instances": switch("Instances", "Make a mesh of points that carry rigid copies of the shapes", False),
    "follow_surface": switch(
        "Follow", "Shapes go with the mesh when it is deformed by an armature, shape keys or other modifiers", True
    ),
    "make_outlines": switch("Outlines", "Make a curve object of the shapes' outlines", False),
    "outline_radius": length("Radius", "Half the thickness of the outlines", 0.005),
    "outline_radius_share": share(
        "Radius", "Half the thickness of the outlines, in percent of the place that a shape has", 3.0
    ),
    "make_cut": switch(
        "Cut Mesh", "Make a copy of the mesh with the outlines cut in; its faces know their shape, show its material",
        False,
    ),
    "write_attributes": switch(
        "Attributes", "Write on the mesh whose outline is nearest, how far it is, and where in the shape one is", False
    ),
    "look": look("distribute"),
    **PATTERN,
}  # fmt: skip
DISTRIBUTE_BEGIN: dict[str, Any] = {"use_modifiers": True, "lengths": "RELATIVE", **DENSITY_BEGIN}
