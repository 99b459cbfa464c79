# SPDX-License-Identifier: GPL-3.0-or-later
"""The properties of `saddleback.voronoi_2d`."""

from __future__ import annotations

from typing import Any

from bpy.props import IntProperty

from .kinds import choice, name_of, switch, use_modifiers
from .region import REGION
from .tessellate import SITES_SOURCES, TESSELLATE

SPACES = (
    ("AUTO", "Automatic", "The outline of a flat mesh; of others the UV map where there is one, else a disk"),
    ("OUTLINE", "Outline", "The plane of a flat mesh, within its outline and around its holes"),
    ("UV", "UV Map", "The plane of a UV map; cells and edges are brought back to the surface"),
    ("DISK", "Disk", "A disk that the surface is laid into; for surfaces with one border and without a UV map"),
)
PLANE_SITES = (
    ("COUNT", "Count", "Place this many sites evenly on the surface"),
    *SITES_SOURCES[2:],
    ("IMAGE", "Image", "Place this many sites by how dark an image is: stippling"),
)

CIRCLES = (
    ("MIDDLE", "Middle", "One circle, from the middle"),
    ("CURSOR", "3D Cursor", "One circle, from the 3D cursor"),
    ("EMPTIES", "Empties", "A circle from each empty; each stops when its own cells are found"),
    ("COUNT", "Count", "This many circles, spread evenly; each stops when its own cells are found"),
)

VORONOI_2D: dict[str, Any] = {
    "space": choice("Space", "The plane that the diagram is made in", SPACES, "OUTLINE"),
    "uv_name": name_of("UV Map", "The UV map; empty means the active one"),
    "sites_source": choice("Sites", "Where the cells' sites come from", PLANE_SITES, "COUNT"),
    "count": TESSELLATE["count"],
    "seed": TESSELLATE["seed"],
    "sites_object": TESSELLATE["sites_object"],
    "image_name": name_of("Image", "Sites are close together where it is dark; it fills the outline or the UV square"),
    "image_invert": switch("Invert", "Sites are close together where the image is light", False),
    "weights_name": name_of("Weights", "A number attribute of the sites' vertices: cells of heavier sites are larger"),
    "iterations": IntProperty(
        name="Iterations",
        description="Steps that make the cells even, or follow the image; 0 leaves the sites where they are",
        default=0,
        min=0,
        soft_max=200,
        options={"SKIP_SAVE"},
    ),
    "relax_sites": switch("Relax Sites", "Move the chosen sites to even the cells out", True),
    "equal_cells": switch(
        "Equal Cells", "Give all cells just the same area, or as much of the image's tone: sides move, too", False
    ),
    "seamless": switch(
        "Seamless", "Cells of a rectangle go on from each side to the opposite one: a tile that repeats", False
    ),
    "use_modifiers": use_modifiers(),
    "lengths": TESSELLATE["lengths"],
    "make_edges": TESSELLATE["make_edges"],
    "edge_kind": TESSELLATE["edge_kind"],
    "edge_radius": TESSELLATE["edge_radius"],
    "edge_radius_share": TESSELLATE["edge_radius_share"],
    "make_cells": switch("Cells", "Make a mesh of the cells", True),
    "gap": TESSELLATE["gap"],
    "gap_share": TESSELLATE["gap_share"],
    "inset": TESSELLATE["inset"],
    "inset_share": TESSELLATE["inset_share"],
    "thickness": TESSELLATE["thickness"],
    "thickness_share": TESSELLATE["thickness_share"],
    "underside": TESSELLATE["underside"],
    "make_centers": switch("Centers", "Make an object of points at the sites", False),
    "instance_object": TESSELLATE["instance_object"],
    "instance_dots": TESSELLATE["instance_dots"],
    "instance_size": TESSELLATE["instance_size"],
    "instance_scale": TESSELLATE["instance_scale"],
    "animate": switch("Animate", "Make a sweep circle that grows and uncovers the edges, frame by frame", False),
    "circles": choice("Circles", "Where the circles of the sweep grow from", CIRCLES, "MIDDLE"),
    "circles_collection": name_of(
        "Collection", "Circles grow from its empties; empty means those parented to the object"
    ),
    "circle_count": IntProperty(
        name="Circles",
        description="How many circles share the sweep, spread evenly",
        default=9,
        min=1,
        max=100,
        soft_max=25,
        options={"SKIP_SAVE"},
    ),
    "frame_start": IntProperty(
        name="Start", description="Frame in which the sweep begins", default=1, options={"SKIP_SAVE"}
    ),
    "frame_end": IntProperty(
        name="End", description="Frame in which all edges are there", default=120, options={"SKIP_SAVE"}
    ),
    **REGION,
}
VORONOI_2D_BEGIN: dict[str, Any] = {
    "space": "AUTO",
    "iterations": 15,
    "relax_sites": False,
    "use_modifiers": True,
    "lengths": "RELATIVE",
    "instance_dots": True,
    "instance_size": "TONE",
}
