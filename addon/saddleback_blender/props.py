"""Every setting once: as a property of its operator and, for the panel and the next session, kept on the object."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, TypeVar

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .core.settings import (
    DirectionFieldSettings,
    DistanceSettings,
    DistributeSettings,
    PathSettings,
    RepairSettings,
    TessellateSettings,
    Voronoi2dSettings,
)

Settings = TypeVar(
    "Settings",
    TessellateSettings,
    DistanceSettings,
    PathSettings,
    Voronoi2dSettings,
    DirectionFieldSettings,
    DistributeSettings,
    RepairSettings,
)

# An operator names objects by strings, so that scripts and presets can; the object itself keeps pointers, which survive
# renaming. These names are pointers on the object and strings on the operator.
OBJECT_NAMES = ("sites_object", "instance_object", "sources_object", "strokes_object", "density_object")
COLLECTION_NAMES = (
    "sources_collection",
    "points_collection",
    "strokes_collection",
    "singularities_collection",
    "density_collection",
    "shapes_collection",
)
IMAGE_NAMES = ("image_name", "density_image", "shapes_image")

SITES_SOURCES = (
    ("COUNT", "Count", "Place this many sites, by the density"),
    ("SELECTED", "Selected Vertices", "One cell for each vertex selected in Edit Mode"),
    ("OBJECT", "Object", "One cell for each vertex of another object, brought to the nearest point of the surface"),
)
METHODS = (
    ("LBFGS", "L-BFGS", "Each step learns from those before it: even cells in a third of the steps"),
    ("LLOYD", "Lloyd", "Each step moves every site to the middle of its cell"),
)
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
DUAL_POLICIES = (
    ("REPAIR", "Repair", "Add vertices where cells are too large, until the mesh has the surface's holes and handles"),
    ("STRICT", "Strict", "One vertex a cell; where cells are too large the mesh has faults, which are told"),
)
EDGE_KINDS = (
    ("MESH", "Mesh", "A mesh of edges, made into tubes by a modifier"),
    ("CURVE", "Curve", "A curve object with a bevel"),
)
DISTANCE_SOURCES = (
    ("SELECTED", "Selected Vertices", "Vertices selected in Edit Mode"),
    ("VERTEX_GROUP", "Vertex Group", "Vertices whose weight in the group is above one half"),
    ("EMPTIES", "Empties", "Empties of a collection, or those parented to the object, brought to the nearest point"),
    (
        "CURVES",
        "Curves",
        "A curve, those of a collection or those parented to the object, brought to the surface",
    ),
    ("CURSOR", "3D Cursor", "The point of the surface nearest to the 3D cursor"),
)
PATH_POINTS = DISTANCE_SOURCES[:3]
PATH_CONNECTIONS = (
    ("CHAIN", "Chain", "From each point to the next: in the order of selection where it is known, empties by name"),
    ("LOOP", "Closed Chain", "From each point to the next, and from the last back to the first"),
    ("PAIRS", "All Pairs", "From every point to every other"),
)
ISOLINES_BY = (
    ("COUNT", "Count", "So many lines between the sources and the farthest point"),
    ("SPACING", "Spacing", "A line at every multiple of a distance"),
)
SPACES = (
    ("OUTLINE", "Outline", "The plane of a flat mesh, within its outline and around its holes"),
    ("UV", "UV Map", "The plane of a UV map; cells and edges are brought back to the surface"),
    ("DISK", "Disk", "A disk that the surface is laid into; for surfaces with one border and without a UV map"),
)
PLANE_SITES = (
    ("COUNT", "Count", "Place this many sites evenly on the surface"),
    SITES_SOURCES[1],
    SITES_SOURCES[2],
    ("IMAGE", "Image", "Place this many sites by how dark an image is: stippling"),
)
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
SINGULARITIES = (
    ("AUTO", "Automatic", "The field is singular where it is smoothest so"),
    ("EMPTIES", "Empties", "Where empties are: the index is their property 'index' or a number in their name"),
)
DOMAINS = (
    ("POINT", "Vertex", "One direction for each vertex"),
    ("FACE", "Face", "One direction for each face"),
)
SHAPES = (
    ("SCALES", "Scales", "Shields with a keel, their tips along the field"),
    ("STUDS", "Studs", "Round heads with a rim"),
    ("FEATHERS", "Feathers", "Long vanes along the field"),
    ("LEAVES", "Leaves", "Leaves of two sizes"),
    ("MOSAIC", "Mosaic", "Square, long and three-cornered tiles"),
    ("COLLECTION", "Collection", "Its meshes, closed curves and images; their property 'share' says how many of each"),
    ("IMAGE", "Image", "Where an image is opaque or, without transparency, dark"),
)
FIELD_SOURCES = (
    ("PANEL", "Direction Field", "The field that the panel Direction Field says, made anew where that has changed"),
    ("ATTRIBUTE", "Attribute", "A vector attribute of vertices or faces"),
    ("NONE", "Smoothest", "Lines as smooth as can be, without strokes"),
)
QUALITIES = (
    ("FAST", "Fast", "Distances at most 2 % too long"),
    ("NORMAL", "Normal", "Distances at most 0.5 % too long"),
    ("FINE", "Fine", "Distances at most 0.2 % too long"),
)
EXACT_QUALITY = ("EXACT", "Exact", "Exact distances, with nothing kept for the next run")


def _quality(items: tuple[tuple[str, str, str], ...] = QUALITIES) -> Any:
    return _choice("Quality", "How exact distances are, and how long the first run on a mesh takes", items, "NORMAL")


def _detail() -> Any:
    return IntProperty(
        name="Detail",
        description="Vertices in each neighborhood of the distance graph; 0 means as the quality needs",
        default=0,
        min=0,
        max=10000,
        soft_max=500,
        options={"SKIP_SAVE"},
    )


def _on_disk() -> Any:
    return _switch("Keep on Disk", "Keep the distance graph of this mesh in the folder of the preferences", False)


def _use_modifiers() -> Any:
    return BoolProperty(
        name="Use Modifiers",
        description="Work on what the modifiers make of the object; where they add vertices, a new object is made",
        default=False,
        options={"SKIP_SAVE"},
    )


def _name(label: str, description: str, default: str = "") -> Any:
    return StringProperty(name=label, description=description, default=default, options={"SKIP_SAVE"})


def _length(label: str, description: str, default: float, least: float = 0.0) -> Any:
    return FloatProperty(
        name=label, description=description, default=default, min=least, soft_max=10.0, precision=4, step=1,
        subtype="DISTANCE", options={"SKIP_SAVE"},
    )  # fmt: skip


def _switch(label: str, description: str, default: bool) -> Any:
    return BoolProperty(name=label, description=description, default=default, options={"SKIP_SAVE"})


def _choice(label: str, description: str, items: tuple[tuple[str, str, str], ...], default: str) -> Any:
    return EnumProperty(name=label, description=description, items=items, default=default, options={"SKIP_SAVE"})


DENSITY: dict[str, Any] = {
    "density_source": _choice("Density", "What says where cells and shapes are small", DENSITY_SOURCES, "UNIFORM"),
    "density_name": _name("Density Name", "The vertex group, attribute or UV map; empty means the active one"),
    "density_channel": _choice("Channel", "Which part of the color counts", CHANNELS, "LUMINANCE"),
    "density_image": _name("Density Image", "The density is high where the image is light"),
    "density_object": _name("Density Curve", "The density is high at this curve; empty means those of the collection"),
    "density_collection": _name("Collection", "Its curves are used; empty means those parented to the object"),
    "density_reach": _length("Reach", "How far from a curve the density falls; 0 means a tenth of the extent", 0.0),
    "density_beyond": FloatProperty(
        name="Beyond", description="The density far from curves, when it is 1 at them", default=0.1, min=0.0,
        max=100.0, soft_max=1.0, options={"SKIP_SAVE"},
    ),
    "density_invert": _switch("Invert", "High where little is painted, and low where much is", False),
    "density_contrast": FloatProperty(
        name="Contrast",
        description="Exponent of the density: 1 makes cells per area proportional to the paint, 0 ignores the paint",
        default=1.0,
        min=0.0,
        max=8.0,
        options={"SKIP_SAVE"},
    ),
}  # fmt: skip

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
    "method": _choice("Method", "How the sites find their places", METHODS, "LBFGS"),
    "sites_source": _choice("Sites", "Where the cells' centres come from", SITES_SOURCES, "COUNT"),
    "sites_object": _name("Sites Object", "The object whose vertices become sites"),
    "relax_sites": _switch("Relax Sites", "Move the chosen sites to even the cells out", False),
    **DENSITY,
    "quality": _quality(),
    "k": _detail(),
    "cache_on_disk": _on_disk(),
    "use_modifiers": _use_modifiers(),
    "make_edges": _switch("Edges", "Make an object of the lines between cells", True),
    "edge_kind": _choice("Edge Object", "What the lines between cells become", EDGE_KINDS, "MESH"),
    "edge_radius": _length("Radius", "Half the thickness of the lines between cells", 0.01),
    "make_cells": _switch("Cells", "Make a mesh of the cells", False),
    "gap": _length("Gap", "Width of the gap between neighbouring cells", 0.0),
    "inset": _length("Bevel", "Width of the sloping rim of each cell; it rises by the thickness", 0.0),
    "thickness": _length("Thickness", "How far the cells stand out of the surface", 0.0),
    "underside": _switch("Closed Below", "Close each cell from below, as a 3D printer needs it", False),
    "local_uv": _switch("Local UV", "Give each cell of the mesh a UV map of its own, for materials that repeat", False),
    "make_centres": _switch("Centres", "Make an object of points at the cells' centres", False),
    "instance_object": _name("Instance", "The object to put on every centre"),
    "instance_scale": FloatProperty(
        name="Instance Scale",
        description="Size of the instances, times the size of their cells",
        default=1.0,
        min=0.0,
        soft_max=10.0,
        options={"SKIP_SAVE"},
    ),
    "make_dual": _switch("Dual Mesh", "Make a triangle mesh with one vertex for each cell: a remesh", False),
    "dual_policy": _choice("Policy", "What to do where cells are too large for a mesh", DUAL_POLICIES, "REPAIR"),
    "make_shell": _switch(
        "Lamp Shell", "Make the lines between cells into one closed solid that can be printed", False
    ),
    "rib_width": _length("Rib Width", "How wide the ribs of the lamp shell are, along the surface", 0.03, least=1e-6),
    "rib_thickness": _length(
        "Rib Thickness", "How thick the lamp shell is, half of it to either side of the surface", 0.03, least=1e-6
    ),
    "cell_attribute": _name("Cell Attribute", "Where each vertex's cell is written", "saddleback_cell"),
    "distance_attribute": _name("Distance Attribute", "Where distances are written", "saddleback_distance"),
    "density_attribute": _name("Density Attribute", "Where the density used is written", "saddleback_density"),
    "write_edge_distance": _switch("Distance to Edge", "Write how far each vertex is from the edge of its cell", False),
    "edge_distance_attribute": _name(
        "Edge Distance Attribute", "Where distances to the cells' edges are written", "saddleback_edge_distance"
    ),
}

DISTANCE: dict[str, Any] = {
    "sources": _choice("From", "Where distances are measured from", DISTANCE_SOURCES, "SELECTED"),
    "sources_group": _name("Vertex Group", "The group whose vertices are sources; empty means the active one"),
    "sources_collection": _name(
        "Collection", "Its empties or curves are sources; empty means those parented to the object"
    ),
    "sources_object": _name("Curve", "The curve object to measure from; empty means those of the collection"),
    "limit": _length("Limit", "Measure no farther than this; 0 means everywhere", 0.0),
    "quality": _quality((*QUALITIES, EXACT_QUALITY)),
    "k": _detail(),
    "cache_on_disk": _on_disk(),
    "use_modifiers": _use_modifiers(),
    "make_isolines": _switch("Isolines", "Make a curve object of the lines of equal distance", False),
    "isolines_by": _choice("By", "What says how many isolines there are", ISOLINES_BY, "COUNT"),
    "isoline_count": IntProperty(
        name="Count",
        description="Number of isolines",
        default=10,
        min=1,
        max=1000,
        soft_max=100,
        options={"SKIP_SAVE"},
    ),
    "isoline_spacing": _length("Spacing", "Distance from one isoline to the next", 0.1, least=1e-6),
    "isoline_radius": _length("Radius", "Half the thickness of the isolines", 0.005),
    "make_preview": _switch("Preview", "Show the distances in colors; the object's own materials are kept", False),
    "preview_lines": _switch("Lines", "Show lines of equal distance in the preview, too", True),
    "distance_attribute": _name("Attribute", "Where distances are written", "saddleback_distance"),
}

PATH: dict[str, Any] = {
    "points": _choice("Through", "What the paths connect", PATH_POINTS, "SELECTED"),
    "points_group": _name("Vertex Group", "The group whose vertices are connected; empty means the active one"),
    "points_collection": _name("Collection", "Its empties are connected; empty means those parented to the object"),
    "from_cursor": _switch("From Cursor", "Begin at the point of the surface nearest to the 3D cursor", False),
    "connect": _choice("Connect", "Which points a path joins", PATH_CONNECTIONS, "CHAIN"),
    "shorten": _switch("Shorten", "Pull each path straight where the distance graph bends it a little", True),
    "quality": _quality(),
    "k": _detail(),
    "cache_on_disk": _on_disk(),
    "use_modifiers": _use_modifiers(),
    "path_radius": _length("Radius", "Half the thickness of the paths", 0.01),
    "lift": _length("Lift", "How far the paths run above the surface", 0.0),
}

VORONOI_2D: dict[str, Any] = {
    "space": _choice("Space", "The plane that the diagram is made in", SPACES, "OUTLINE"),
    "uv_name": _name("UV Map", "The UV map; empty means the active one"),
    "sites_source": _choice("Sites", "Where the cells' sites come from", PLANE_SITES, "COUNT"),
    "count": TESSELLATE["count"],
    "seed": TESSELLATE["seed"],
    "sites_object": TESSELLATE["sites_object"],
    "image_name": _name("Image", "Sites are close together where it is dark; it fills the outline or the UV square"),
    "image_invert": _switch("Invert", "Sites are close together where the image is light", False),
    "weights_name": _name("Weights", "A number attribute of the sites' vertices: cells of heavier sites are larger"),
    "iterations": IntProperty(
        name="Iterations",
        description="Steps that make the cells even, or follow the image; 0 leaves the sites where they are",
        default=0,
        min=0,
        soft_max=200,
        options={"SKIP_SAVE"},
    ),
    "use_modifiers": _use_modifiers(),
    "make_edges": TESSELLATE["make_edges"],
    "edge_kind": TESSELLATE["edge_kind"],
    "edge_radius": TESSELLATE["edge_radius"],
    "make_cells": _switch("Cells", "Make a mesh of the cells", True),
    "gap": TESSELLATE["gap"],
    "inset": TESSELLATE["inset"],
    "thickness": TESSELLATE["thickness"],
    "underside": TESSELLATE["underside"],
    "make_centres": _switch("Centres", "Make an object of points at the sites", False),
    "instance_object": TESSELLATE["instance_object"],
    "instance_scale": TESSELLATE["instance_scale"],
    "animate": _switch("Animate", "Make a sweep circle that grows and uncovers the edges, frame by frame", False),
    "frame_start": IntProperty(
        name="Start", description="Frame in which the sweep begins", default=1, options={"SKIP_SAVE"}
    ),
    "frame_end": IntProperty(
        name="End", description="Frame in which all edges are there", default=120, options={"SKIP_SAVE"}
    ),
}

DIRECTION_FIELD: dict[str, Any] = {
    "symmetry": _choice("Kind", "What the field is made of", SYMMETRIES, "1"),
    "align": _choice("Align", "What the field follows besides strokes", ALIGNMENTS, "NONE"),
    "align_weight": FloatProperty(
        name="Weight", description="How much the curvature counts against smoothness", default=1.0, min=1e-3,
        soft_max=100.0, options={"SKIP_SAVE"},
    ),
    "strokes": _choice("Strokes", "What is drawn for the field to follow", STROKES, "NONE"),
    "strokes_object": _name("Strokes Object", "The curve or grease pencil object whose strokes the field follows"),
    "strokes_collection": _name("Collection", "Its strokes are followed; empty means those parented to the object"),
    "hard_strokes": _switch(
        "Exact", "Follow strokes exactly; without it only those with 'hard' in their layer's or object's name", False
    ),
    "stroke_weight": FloatProperty(
        name="Strength", description="How much strokes count against smoothness", default=1.0, min=1e-3, soft_max=100.0,
        options={"SKIP_SAVE"},
    ),
    "stroke_reach": _length(
        "Reach", "What of a stroke is farther from the surface is left out; 0 means a twentieth of its extent", 0.0
    ),
    "singularities": _choice("Singularities", "Where the field turns about a point", SINGULARITIES, "AUTO"),
    "singularities_collection": _name(
        "Empties", "The collection of the empties; empty means those parented to the object"
    ),
    "turn": FloatProperty(
        name="Turn", description="Turns the whole field, counter-clockwise seen from outside", default=0.0,
        subtype="ANGLE", soft_min=-3.1416, soft_max=3.1416, options={"SKIP_SAVE"},
    ),
    "use_modifiers": _use_modifiers(),
    "domain": _choice("On", "What the attribute is written on", DOMAINS, "POINT"),
    "direction_attribute": _name("Attribute", "Where directions are written", "saddleback_direction"),
    "make_arrows": _switch("Arrows", "Make an object of arrows that shows the field and its singularities", True),
    "arrow_count": IntProperty(
        name="Count", description="About so many arrows", default=1500, min=1, max=100000, soft_max=10000,
        options={"SKIP_SAVE"},
    ),
    "arrow_length": _length("Length", "Length of the arrows; 0 means by their number", 0.0),
    "make_streamlines": _switch("Streamlines", "Make a curve object of lines along the field", False),
    "streamline_spacing": _length(
        "Spacing", "Distance between lines; 0 means a fiftieth of the surface's extent", 0.0
    ),
    "streamline_length": _length("Longest", "Length of the longest lines; 0 means thirty times their distance", 0.0),
    "streamline_radius": _length("Radius", "Half the thickness of the lines", 0.005),
    "seed": TESSELLATE["seed"],
}  # fmt: skip

DISTRIBUTE: dict[str, Any] = {
    "shapes": _choice("Shapes", "What is laid on the surface", SHAPES, "SCALES"),
    "shapes_collection": _name("Shapes Collection", "The collection whose objects are laid on the surface"),
    "shapes_image": _name("Shape Image", "The image whose mask is laid on the surface"),
    "count": IntProperty(
        name="Count", description="Number of shapes", default=500, min=1, soft_max=20000, options={"SKIP_SAVE"}
    ),
    "size": _length("Size", "Radius of the circle around the largest shapes; 0 means by their number", 0.0),
    "size_variation": FloatProperty(
        name="Variation", description="By which share of the largest the smallest are smaller", default=0.0, min=0.0,
        max=0.95, subtype="FACTOR", options={"SKIP_SAVE"},
    ),
    "size_by_density": _switch("Size by Density", "Shapes are small where the density is high", False),
    "gap": _length("Gap", "Least distance from shape to shape", 0.0),
    "packing": FloatProperty(
        name="Packing", description="0 lays shapes in a random order, 1 side by side, which makes room for more",
        default=0.0, min=0.0, max=1.0, subtype="FACTOR", options={"SKIP_SAVE"},
    ),
    "maximal": _switch("Fill", "Go on until nothing more fits, whatever the count, and prove it", False),
    "mirror": _switch("Mirror", "Mirror half of the shapes, by chance", False),
    "bend": _switch("Bend", "Long shapes bend along the field; not with Fill", False),
    "seed": TESSELLATE["seed"],
    "field_source": _choice("Field", "Which way shapes point", FIELD_SOURCES, "PANEL"),
    "direction_attribute": _name("Attribute", "The vectors that shapes point along", "saddleback_direction"),
    "forbidden_group": _name("Keep Off", "No shape lies where this vertex group's weights are above one half"),
    **DENSITY,
    "use_modifiers": _use_modifiers(),
    "make_bent": _switch("Bent Copies", "Make one mesh of all shapes, bent onto the surface", True),
    "thickness": _length("Thickness", "Of shapes without a mesh: how far they rise; 0 means by their size", 0.0),
    "make_instances": _switch("Instances", "Make a mesh of points that carry rigid copies of the shapes", False),
    "follow_surface": _switch(
        "Follow", "Instances go with the mesh when it is deformed by an armature, shape keys or other modifiers", True
    ),
    "make_outlines": _switch("Outlines", "Make a curve object of the shapes' outlines", False),
    "outline_radius": _length("Radius", "Half the thickness of the outlines", 0.005),
    "write_attributes": _switch(
        "Attributes", "Write on the mesh whose outline is nearest, how far it is, and where in the shape one is", False
    ),
}  # fmt: skip

REPAIR: dict[str, Any] = {
    "weld_distance": _length("Weld Distance", "Join vertices closer than this; 0 joins those at the same place", 0.0),
}

PROPERTIES = {
    "tessellate": TESSELLATE,
    "distance": DISTANCE,
    "path": PATH,
    "voronoi_2d": VORONOI_2D,
    "direction_field": DIRECTION_FIELD,
    "distribute": DISTRIBUTE,
    "repair": REPAIR,
}


def _kept(properties: dict[str, Any]) -> dict[str, Any]:
    """The same properties for an object to keep: named objects, collections and images become pointers."""
    pointers = (
        dict.fromkeys(OBJECT_NAMES, bpy.types.Object)
        | dict.fromkeys(COLLECTION_NAMES, bpy.types.Collection)
        | dict.fromkeys(IMAGE_NAMES, bpy.types.Image)
    )
    kept = {}
    for name, prop in properties.items():
        if name in pointers:
            kept[name] = PointerProperty(
                type=pointers[name], name=prop.keywords["name"], description=prop.keywords["description"]
            )
        else:
            kept[name] = prop
    return kept


class SaddlebackTessellateProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.tessellate`."""

    __annotations__ = _kept(TESSELLATE)


class SaddlebackDistanceProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distance`."""

    __annotations__ = _kept(DISTANCE)


class SaddlebackPathProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.path`."""

    __annotations__ = _kept(PATH)


class SaddlebackVoronoi2dProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.voronoi_2d`."""

    __annotations__ = _kept(VORONOI_2D)


class SaddlebackDirectionFieldProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.direction_field`."""

    __annotations__ = _kept(DIRECTION_FIELD)


class SaddlebackDistributeProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.distribute`."""

    __annotations__ = _kept(DISTRIBUTE)


class SaddlebackRepairProps(bpy.types.PropertyGroup):
    """Settings of `saddleback.repair`."""

    __annotations__ = _kept(REPAIR)


class SaddlebackObjectProps(bpy.types.PropertyGroup):
    """`Object.saddleback`: the settings of each operator, as last used or set in the panel."""

    __annotations__ = {
        "tessellate": PointerProperty(type=SaddlebackTessellateProps),
        "distance": PointerProperty(type=SaddlebackDistanceProps),
        "path": PointerProperty(type=SaddlebackPathProps),
        "voronoi_2d": PointerProperty(type=SaddlebackVoronoi2dProps),
        "direction_field": PointerProperty(type=SaddlebackDirectionFieldProps),
        "distribute": PointerProperty(type=SaddlebackDistributeProps),
        "repair": PointerProperty(type=SaddlebackRepairProps),
    }


CLASSES = (
    SaddlebackTessellateProps,
    SaddlebackDistanceProps,
    SaddlebackPathProps,
    SaddlebackVoronoi2dProps,
    SaddlebackDirectionFieldProps,
    SaddlebackDistributeProps,
    SaddlebackRepairProps,
    SaddlebackObjectProps,
)


def fill_operator(operator: bpy.types.Operator, source: bpy.types.Object, settings_name: str) -> None:
    """Gives each property of the operator that the caller did not set the value that the object keeps.

    Asks before it looks: reading a group or a pointer for the first time stores an empty one in the file.
    """
    if not source.is_property_set("saddleback") or not source.saddleback.is_property_set(settings_name):
        return
    group = getattr(source.saddleback, settings_name)
    for name in PROPERTIES[settings_name]:
        if not operator.properties.is_property_set(name) and group.is_property_set(name):
            value = getattr(group, name)
            if name in OBJECT_NAMES + COLLECTION_NAMES + IMAGE_NAMES:
                value = value.name if value is not None else ""
            setattr(operator, name, value)


def keep_settings(settings: Settings, group: bpy.types.PropertyGroup) -> None:
    """Writes the settings of a run to the object, so that tomorrow's run is the same."""
    for field in fields(settings):
        value = getattr(settings, field.name)
        if field.name in OBJECT_NAMES:
            value = bpy.data.objects.get(value)
        elif field.name in COLLECTION_NAMES:
            value = bpy.data.collections.get(value)
        elif field.name in IMAGE_NAMES:
            value = bpy.data.images.get(value)
        # Default values stay unset, so that an object carries no more than what was chosen for it.
        if getattr(group, field.name) != value:
            setattr(group, field.name, value)


def kept_settings(source: bpy.types.Object, settings_name: str, kind: type[Settings]) -> Settings:
    """The settings that the object keeps, or the defaults; asks before it looks, as `fill_operator` does."""
    if not source.is_property_set("saddleback") or not source.saddleback.is_property_set(settings_name):
        return kind()
    group = getattr(source.saddleback, settings_name)
    values = {}
    for field in fields(kind):
        if group.is_property_set(field.name):
            value = getattr(group, field.name)
            if field.name in OBJECT_NAMES + COLLECTION_NAMES + IMAGE_NAMES:
                value = value.name if value is not None else ""
            values[field.name] = value
    return kind(**values)


def settings_of(operator: bpy.types.Operator, kind: type[Settings]) -> Settings:
    """The operator's properties as the core's dataclass."""
    return kind(**{field.name: getattr(operator, field.name) for field in fields(kind)})


def register() -> None:
    """Makes everything of this module known to Blender."""
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Object.saddleback = PointerProperty(type=SaddlebackObjectProps)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    del bpy.types.Object.saddleback
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
