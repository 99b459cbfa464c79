# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.tessellate`."""

from __future__ import annotations

import math
from typing import Any

from bpy.props import EnumProperty, FloatProperty, IntProperty

from .density import DENSITY, DENSITY_BEGIN
from .kinds import (
    choice,
    detail,
    length,
    lengths,
    look,
    name_of,
    on_disk,
    painted_names,
    quality,
    share,
    switch,
    use_modifiers,
)
from .region import LAYER_SETTINGS

SITES_SOURCES = (
    ("COUNT", "Count", "Place this many sites, by the density"),
    ("SIZE", "Cell Size", "Place as many sites as make cells of this size, in the mean"),
    ("SELECTED", "Selected", "One cell for each vertex selected in Edit Mode"),
    ("OBJECT", "Object", "One cell for each vertex of another object, brought to the nearest point of the surface"),
)
METHODS = (
    ("LBFGS", "L-BFGS", "Each step learns from those before it: even cells in a third of the steps"),
    ("LLOYD", "Lloyd", "Each step moves every site to the middle of its cell"),
)
DUAL_POLICIES = (
    ("REPAIR", "Repair", "Add vertices where cells are too large, until the mesh has the surface's holes and handles"),
    ("STRICT", "Strict", "One vertex a cell; where cells are too large the mesh has faults, which are told"),
)
CELL_FACES = (
    ("SURFACE", "Many", "As many as the surface has there, with a gap, a height and a bevel"),
    ("ONE", "One", "One polygon for each cell, with the materials and layers of the surface: a mesh to go on with"),
    (
        "PATCHES",
        "Patches",
        "As few polygons as the error needs, whatever the count: flat parts are one, and sharp edges stay",
    ),
)
DUAL_FACES = (
    ("TRIANGLES", "Triangles", "One for each place where three cells meet"),
    (
        "QUADS",
        "Quads",
        "Each triangle cut into three quads, with all vertices on the surface; they follow no direction",
    ),
)
EDGE_KINDS = (
    ("MESH", "Mesh", "A mesh of edges, made into tubes by a modifier"),
    ("CURVE", "Curve", "A curve object with a bevel"),
)

RIB_PROFILES = (
    ("SQUARE", "Square", "As thick at the sides as in the middle"),
    ("ROUND", "Round", "Rounded to both sides of the surface; thick as asked in the middle"),
)
INSTANCE_SIZES = (
    ("EQUAL", "Equal", "All alike: of dots placed by an image, their number makes its tone"),
    ("CELL", "By Cell", "As large as their cells"),
    ("TONE", "By Tone", "Large where the image is dark, or the density high, within their cells"),
)


def _millimeters(label: str, description: str, default: float) -> Any:
    return FloatProperty(
        name=label, description=description, default=default, min=0.0, soft_max=50.0, precision=2, step=10,
        options={"SKIP_SAVE"},
    )  # fmt: skip


# How even cells become: iterations, annealing, starts.
EVENNESSES = {"QUICK": (5, 0, 1), "EVEN": (15, 0, 1), "PERFECT": (60, 200, 1)}
EVENNESS_ITEMS = (
    ("QUICK", "Quick", "A few steps: to see where cells come to lie"),
    ("EVEN", "Even", "As even as most work needs"),
    ("PERFECT", "Perfect", "Nearly all cells hexagons, where the surface lets them; takes some ten times as long"),
    ("CUSTOM", "Custom", "As Iterations, Annealing and Starts under Advanced say"),
)


def _evenness(group: Any) -> int:
    found = (group.iterations, group.annealing, group.starts)
    return [*EVENNESSES.values(), found].index(found)


def _set_evenness(group: Any, number: int) -> None:
    if number < len(EVENNESSES):
        group.iterations, group.annealing, group.starts = list(EVENNESSES.values())[number]


# Of the panel only: it stands for three others.
EVENNESS = EnumProperty(
    name="Evenness", description="How even the cells become, and how long that takes", items=EVENNESS_ITEMS,
    get=_evenness, set=_set_evenness, options={"SKIP_SAVE"},
)  # fmt: skip

BY = "The vertex group, attribute or color attribute that says of each cell by what to multiply"

TESSELLATE: dict[str, Any] = {
    "count": IntProperty(
        name="Count", description="Number of cells", default=200, min=1, soft_max=20000, options={"SKIP_SAVE"}
    ),
    "seed": IntProperty(
        name="Seed", description="Another number gives another pattern", default=0, min=0, options={"SKIP_SAVE"}
    ),
    "iterations": IntProperty(
        name="Iterations",
        description="Steps that make the cells even; 0 leaves the sites where chance put them",
        default=15,
        min=0,
        soft_max=200,
        options={"SKIP_SAVE"},
    ),
    "stretch": FloatProperty(
        name="Stretch",
        description="How many times as long the cells are along the object's direction field as they are wide",
        default=1.0,
        min=0.1,
        max=10.0,
        soft_min=1.0,
        soft_max=5.0,
        options={"SKIP_SAVE"},
    ),
    "follow_curvature": FloatProperty(
        name="Follow Curvature",
        description="How much smaller the cells are where the surface bends, and shorter across ridges than along them",
        default=0.0,
        min=0.0,
        max=3.0,
        soft_max=1.0,
        options={"SKIP_SAVE"},
    ),
    "starts": IntProperty(
        name="Starts",
        description="Make the cells so many times, from seeds that follow one another, and take the most even ones",
        default=1,
        min=1,
        soft_max=10,
        options={"SKIP_SAVE"},
    ),
    "annealing": IntProperty(
        name="Annealing",
        description="Steps in which the sites are shaken, less and less, before the iterations: triangles more even "
        "than any number of iterations makes them, for a remesh that may take a while (300)",
        default=0,
        min=0,
        soft_max=400,
        options={"SKIP_SAVE"},
    ),
    "method": choice("Method", "How the sites find their places", METHODS, "LBFGS"),
    "sites_source": choice("Sites", "Where the cells' centers come from", SITES_SOURCES, "COUNT"),
    "cell_size": length("Cell Size", "The side of a square as large as the cells are in the mean", 0.1, least=1e-6),
    "sites_object": name_of("Sites Object", "The object whose vertices become sites"),
    "relax_sites": switch("Relax Sites", "Move the chosen sites to even the cells out", False),
    "hold_sharp": switch(
        "Sharp Edges",
        "Keep sites on edges at which the surface bends much: a remesh has them. "
        "Lines shorter than two cells are left out",
        False,
    ),
    "sharp_angle": FloatProperty(
        name="Sharp Angle",
        description="Edges at which the surface bends by more than this are kept",
        default=math.radians(40.0),
        min=math.radians(1.0),
        max=math.pi,
        subtype="ANGLE",
        options={"SKIP_SAVE"},
    ),
    "hold_marked": switch(
        "Marked Edges",
        "Keep sites on edges that are marked sharp or as seams, or creased: a remesh has them, marked alike",
        False,
    ),
    "hold_boundary": switch("Border", "Keep sites on the border of an open mesh, so that a remesh has it", False),
    **DENSITY,
    "quality": quality(),
    "k": detail(),
    "cache_on_disk": on_disk(),
    "use_modifiers": use_modifiers(),
    "lengths": lengths("a cell's size: the side of a square of its area"),
    "make_edges": switch("Edges", "Make an object of the lines between cells", True),
    "edge_kind": choice("Edge Object", "What the lines between cells become", EDGE_KINDS, "MESH"),
    "edge_radius": length("Radius", "Half the thickness of the lines between cells", 0.01),
    "edge_radius_share": share("Radius", "Half the thickness of the lines, in percent of a cell's size", 4.0),
    "make_cells": switch("Cells", "Make a mesh of the cells", False),
    "gap": length("Gap", "Width of the gap between neighboring cells", 0.0),
    "gap_share": share("Gap", "Width of the gap between neighboring cells, in percent of a cell's size", 8.0),
    "inset": length("Bevel", "Width of the sloping rim of each cell; it rises by the thickness", 0.0),
    "inset_share": share("Bevel", "Width of the sloping rim of each cell, in percent of a cell's size", 10.0),
    "thickness": length("Thickness", "How far the cells stand out of the surface", 0.0),
    "thickness_share": share("Thickness", "How far the cells stand out, in percent of a cell's size", 8.0),
    "dome": FloatProperty(
        name="Dome",
        description="How round the cells are: 0 flat within the bevel, 1 like pebbles from the rim to the middle",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
        options={"SKIP_SAVE"},
    ),
    "gap_by": name_of("Gap By", f"{BY} the gap where its center is", search=painted_names),
    "inset_by": name_of("Bevel By", f"{BY} the bevel where its center is", search=painted_names),
    "thickness_by": name_of("Thickness By", f"{BY} the thickness where its center is", search=painted_names),
    "underside": switch("Closed Below", "Close each cell from below, as a 3D printer needs it", False),
    "local_uv": switch("Local UV", "Give each cell of the mesh a UV map of its own, for materials that repeat", False),
    "cell_faces": choice("Cell Faces", "How many faces a cell has", CELL_FACES, "SURFACE"),
    "patch_error": FloatProperty(
        name="Error",
        description="How far the patches may be from the surface, and their corners from a plane, in percent of the "
        "object's size: the diagonal of its box",
        default=1.0,
        min=0.01,
        max=100.0,
        soft_max=10.0,
        precision=2,
        step=10,
        subtype="PERCENTAGE",
        options={"SKIP_SAVE"},
    ),
    "make_centers": switch("Centers", "Make an object of points at the cells' centers", False),
    "instance_object": name_of("Instance", "The object to put on every center"),
    "instance_dots": switch("Dots", "Put a flat round dot on every center, where no object is chosen", False),
    "instance_size": choice("Size", "What says how large the instances are", INSTANCE_SIZES, "CELL"),
    "instance_scale": FloatProperty(
        name="Instance Scale",
        description="Makes all instances larger or smaller; 1: a dot has the area of its cell or, by tone, its ink",
        default=1.0,
        min=0.0,
        soft_max=10.0,
        options={"SKIP_SAVE"},
    ),
    "make_dual": switch("Dual Mesh", "Make a triangle mesh with one vertex for each cell: a remesh", False),
    "dual_faces": choice("Dual Faces", "What the dual mesh is made of", DUAL_FACES, "TRIANGLES"),
    "dual_policy": choice("Policy", "What to do where cells are too large for a mesh", DUAL_POLICIES, "REPAIR"),
    "keep_count": switch(
        "Keep Count",
        "One vertex for each cell: cells move from where they are needed least to where the dual mesh would have "
        "faults. Where that is not enough, the policy says what to do",
        True,
    ),
    "make_shell": switch("Lamp Shell", "Make the lines between cells into one closed solid that can be printed", False),
    "rib_width": length(
        "Rib Width", "How wide the ribs of the lamp shell are, along the surface; 0: by the cells' size", 0.0
    ),
    "rib_width_share": share("Rib Width", "How wide the ribs are, in percent of a cell's size", 12.5),
    "rib_thickness": length(
        "Rib Thickness",
        "How thick the lamp shell is, half of it to either side of the surface; 0: as thick as wide",
        0.0,
    ),
    "rib_thickness_share": share("Rib Thickness", "How thick the lamp shell is, in percent of a cell's size", 12.5),
    "base_height": length("Base", "All is solid up to this height above the lowest point: a ring to stand on", 0.0),
    "base_height_share": share("Base", "The height up to which all is solid, in percent of a cell's size", 0.0),
    "in_millimeters": switch("Millimeters", "Give the lengths of the lamp shell in millimeters of the scene", False),
    "rib_width_mm": _millimeters("Rib Width", "How wide the ribs are, in millimeters", 2.0),
    "rib_thickness_mm": _millimeters("Rib Thickness", "How thick the lamp shell is, in millimeters", 2.0),
    "base_height_mm": _millimeters("Base", "The height up to which all is solid, in millimeters", 0.0),
    "rib_profile": choice("Ribs", "What ribs are like across", RIB_PROFILES, "SQUARE"),
    "shell_faces": IntProperty(
        name="Faces",
        description="About so many triangles at most: the shell is simplified, stays closed and does not pass through "
        "itself; 0: as many as there are",
        default=0,
        min=0,
        soft_max=500_000,
        options={"SKIP_SAVE"},
    ),
    "cell_attribute": name_of("Cell Attribute", "Where each vertex's cell is written", "saddleback_cell"),
    "distance_attribute": name_of("Distance Attribute", "Where distances are written", "saddleback_distance"),
    "density_attribute": name_of("Density Attribute", "Where the density used is written", "saddleback_density"),
    "write_edge_distance": switch("Distance to Edge", "Write how far each vertex is from the edge of its cell", False),
    "edge_distance_attribute": name_of(
        "Edge Distance Attribute", "Where distances to the cells' edges are written", "saddleback_edge_distance"
    ),
    "look": look("tessellate"),
    **LAYER_SETTINGS,
}
TESSELLATE_BEGIN: dict[str, Any] = {
    "use_modifiers": True,
    "lengths": "RELATIVE",
    "instance_dots": True,
    **DENSITY_BEGIN,
}
