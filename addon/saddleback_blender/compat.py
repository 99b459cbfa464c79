# SPDX-License-Identifier: GPL-3.0-or-later
"""Differences between Blender 3.4 and 5.x, each behind one function: the only file that tests features or versions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bmesh
import bpy
import numpy as np
from numpy.typing import NDArray


def read_positions(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(V, 3) object-space positions. The attribute (3.5 on) is one memory copy, `co` a loop over elements."""
    positions = np.empty(3 * len(mesh.vertices), np.float32)
    attribute = mesh.attributes.get("position")
    if attribute is not None:
        attribute.data.foreach_get("vector", positions)
    else:
        mesh.vertices.foreach_get("co", positions)
    return positions.reshape(-1, 3)


def read_floats(elements: Any, name: str, width: int) -> NDArray[np.float32]:
    """(n, width) numbers that n elements have."""
    numbers = np.empty(width * len(elements), np.float32)
    elements.foreach_get(name, numbers)
    return numbers.reshape(-1, width)


def write_positions(mesh: bpy.types.Mesh, positions: NDArray[np.float32]) -> None:
    """Sets the (V, 3) object-space positions."""
    mesh.vertices.foreach_set("co", np.ascontiguousarray(positions, np.float32).ravel())


def as_copied(values: NDArray[Any]) -> NDArray[Any]:
    """The same memory in the kind of array that `foreach_get` and `foreach_set` copy in one go, not in a Python loop.

    For attributes that hold integers that is C's int. Under Windows NumPy's int32 is another kind, a long, and stays
    one through `astype`, since both are equal to NumPy.
    """
    return values.view(np.intc) if values.dtype == np.int32 else values


def read_numbers(elements: Any, name: str, width: int = 1) -> NDArray[np.int32]:
    """(n * width,) numbers of other elements, or counts, that n elements of a mesh have. Blender's own are unsigned."""
    numbers = np.empty(width * len(elements), np.int32)
    elements.foreach_get(name, numbers.view(np.uintc))
    return numbers


def write_numbers(elements: Any, name: str, numbers: NDArray[np.integer]) -> None:
    """Sets what `read_numbers` reads; of any shape."""
    elements.foreach_set(name, np.ascontiguousarray(numbers, np.int32).ravel().view(np.uintc))


def read_corner_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(L,) vertex of each face corner."""
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is None:
        return read_numbers(mesh.loops, "vertex_index")
    vertices = np.empty(len(mesh.loops), np.int32)
    attribute.data.foreach_get("value", as_copied(vertices))
    return vertices


def read_edge_vertices(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """(E, 2) vertices of each edge."""
    attribute = mesh.attributes.get(".edge_verts")
    if attribute is None:
        return read_numbers(mesh.edges, "vertices", 2).reshape(-1, 2)
    vertices = np.empty(2 * len(mesh.edges), np.int32)
    attribute.data.foreach_get("value", as_copied(vertices))
    return vertices.reshape(-1, 2)


CREASE = "crease_edge"  # the attribute that has been the creases of edges since 4.0


def read_creases(mesh: bpy.types.Mesh) -> NDArray[np.float32]:
    """(E,) how sharp each edge stays when the mesh is subdivided, 0 to 1."""
    creases = np.zeros(len(mesh.edges), np.float32)
    if "crease" in bpy.types.MeshEdge.bl_rna.properties:
        mesh.edges.foreach_get("crease", creases)
    elif CREASE in mesh.attributes:
        mesh.attributes[CREASE].data.foreach_get("value", creases)
    return creases


def write_creases(mesh: bpy.types.Mesh, creases: NDArray[np.float32]) -> None:
    """Sets what `read_creases` reads."""
    if "crease" in bpy.types.MeshEdge.bl_rna.properties:
        mesh.edges.foreach_set("crease", creases)
    else:
        (mesh.attributes.get(CREASE) or mesh.attributes.new(CREASE, "FLOAT", "EDGE")).data.foreach_set("value", creases)


def read_selected_vertices(mesh: bpy.types.Mesh) -> NDArray[np.bool_]:
    """(V,) selected in Edit Mode, as last left."""
    selected = np.zeros(len(mesh.vertices), bool)
    mesh.vertices.foreach_get("select", selected)
    return selected


def read_sculpt_mask(mesh: bpy.types.Mesh) -> NDArray[np.float32] | None:
    """(V,) sculpt mask, 0 to 1; None where the mesh has none. An attribute from 4.1 on, a layer of its own before."""
    values = np.zeros(len(mesh.vertices), np.float32)
    if hasattr(mesh, "vertex_paint_masks"):
        if not mesh.vertex_paint_masks:
            return None
        mesh.vertex_paint_masks[0].data.foreach_get("value", values)
        return values
    attribute = mesh.attributes.get(".sculpt_mask")
    if attribute is None:
        return None
    attribute.data.foreach_get("value", values)
    return values


def active_color_name(mesh: bpy.types.Mesh) -> str:
    """Name of the color attribute that is painted on, "" where there is none."""
    active = mesh.color_attributes.active_color
    return active.name if active is not None else ""


def identity(data: bpy.types.ID) -> int:
    """A number of its own for each data-block of a session, where Blender has one; else 0."""
    return int(getattr(data, "session_uid", 0))


def draw_progress(layout: bpy.types.UILayout, manager: bpy.types.WindowManager) -> None:
    """A progress bar of the run: `layout.progress` from 4.0 on, a slider in percent before."""
    if hasattr(layout, "progress"):
        layout.progress(factor=manager.saddleback_fraction, text=f"{100 * manager.saddleback_fraction:.0f} %")
    else:
        layout.prop(manager, "saddleback_percent", slider=True)


def write_corners(mesh: bpy.types.Mesh, triangles: NDArray[np.int32]) -> None:
    """Gives a mesh that has vertices but no faces yet its (T, 3) triangles; edges come with `mesh.update`."""
    write_polygons(mesh, triangles.ravel(), np.arange(0, 3 * len(triangles) + 1, 3, dtype=np.int32))


def write_edges(mesh: bpy.types.Mesh, ends: NDArray[np.int32], corner_edges: NDArray[np.int32]) -> None:
    """Gives a mesh that has polygons its edges (E, 2), and each corner (L,) the one to the next corner."""
    mesh.edges.add(len(ends))
    write_numbers(mesh.edges, "vertices", ends)
    write_numbers(mesh.loops, "edge_index", corner_edges)


def write_polygons(mesh: bpy.types.Mesh, corners: NDArray[np.int32], offsets: NDArray[np.int32]) -> None:
    """Gives a mesh that has vertices but no faces yet its polygons; edges come with `mesh.update`.

    Polygon i of p has the vertices corners[offsets[i]:offsets[i + 1]].
    """
    mesh.loops.add(len(corners))
    mesh.polygons.add(len(offsets) - 1)
    write_numbers(mesh.loops, "vertex_index", corners)
    write_numbers(mesh.polygons, "loop_start", offsets[:-1])
    if not mesh.bl_rna.properties["polygons"].fixed_type.properties["loop_total"].is_readonly:
        write_numbers(mesh.polygons, "loop_total", np.diff(offsets))


def is_shaded_smooth(mesh: bpy.types.Mesh) -> bool:
    """Tells whether any face is."""
    smooth = np.zeros(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    return bool(smooth.any())


def shade_flat(mesh: bpy.types.Mesh) -> None:
    """Makes the faces of a new mesh flat: from 4.1 on they are smooth, before they are not."""
    if hasattr(mesh, "use_auto_smooth"):
        return
    mesh.polygons.foreach_set("use_smooth", np.zeros(len(mesh.polygons), bool))


def shade_smooth_by_angle(mesh: bpy.types.Mesh, angle: float) -> None:
    """Smooth faces, creased where they meet at more than `angle` (radians)."""
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    if hasattr(mesh, "set_sharp_from_angle"):  # 4.1 on
        mesh.set_sharp_from_angle(angle=angle)
    else:
        mesh.use_auto_smooth = True
        mesh.auto_smooth_angle = angle


def shading(data: bpy.types.Mesh | bpy.types.Curve) -> str:
    """Tells how faces are drawn, "" where some are smooth and some are not: smooth, creased, at which angle."""
    parts = data.splines if isinstance(data, bpy.types.Curve) else data.polygons
    smooth = np.zeros(len(parts), bool)
    parts.foreach_get("use_smooth", smooth)
    if not len(smooth) or smooth.any() != smooth.all():
        return ""
    return f"{smooth[0]} {getattr(data, 'use_auto_smooth', False)} {getattr(data, 'auto_smooth_angle', 0.0):.6f}"


def set_shading(data: bpy.types.Mesh | bpy.types.Curve, told: str) -> None:
    """Draws all faces as `shading` told of others; "" changes nothing."""
    if not told or told == shading(data):
        return
    is_smooth, is_creased, angle = told.split()
    parts = data.splines if isinstance(data, bpy.types.Curve) else data.polygons
    parts.foreach_set("use_smooth", np.full(len(parts), is_smooth == "True"))
    if hasattr(data, "use_auto_smooth"):
        data.use_auto_smooth, data.auto_smooth_angle = is_creased == "True", float(angle)


def copy_auto_smooth(source: bpy.types.Mesh, mesh: bpy.types.Mesh) -> None:
    """Gives a mesh the angle at which another is creased; from 4.1 on creases are edges, and there is no angle."""
    if hasattr(mesh, "use_auto_smooth"):
        mesh.use_auto_smooth, mesh.auto_smooth_angle = source.use_auto_smooth, source.auto_smooth_angle


def show_color(mesh: bpy.types.Mesh, name: str) -> None:
    """Makes a color attribute the one that is shown and rendered."""
    index = mesh.color_attributes.find(name)
    mesh.color_attributes.active_color_index = index
    mesh.color_attributes.render_color_index = index


def let_through(material: bpy.types.Material) -> None:
    """Lets a transparent material show what lies behind it, as it does by itself from 4.2 on."""
    if not hasattr(material, "surface_render_method"):
        material.blend_method = material.shadow_method = "HASHED"


def remove_material_slots(mesh: bpy.types.Mesh) -> None:
    """Removes all materials; faces keep their numbers. `materials.pop` would leave the objects' slots behind."""
    numbers = read_numbers(mesh.polygons, "material_index")
    mesh.materials.clear()
    if numbers.any():
        write_numbers(mesh.polygons, "material_index", numbers)


def coat_input(shader: Any) -> Any:
    """How much clear varnish a principled shader has: "Coat Weight" from 4.0 on, "Clearcoat" before."""
    return shader.inputs["Coat Weight" if "Coat Weight" in shader.inputs else "Clearcoat"]


def new_group_socket(group: bpy.types.NodeTree, name: str, in_out: str, socket_type: str) -> Any:
    """Adds an INPUT or OUTPUT to a node group; returns what its default and limits are set on."""
    if hasattr(group, "interface"):  # 4.0 on
        return group.interface.new_socket(name=name, in_out=in_out, socket_type=socket_type)
    return (group.inputs if in_out == "INPUT" else group.outputs).new(socket_type, name)


def group_input_identifiers(group: bpy.types.NodeTree) -> dict[str, str]:
    """Identifiers of a node group's inputs by name."""
    if hasattr(group, "interface"):
        items = [item for item in group.interface.items_tree if item.item_type == "SOCKET" and item.in_out == "INPUT"]
    else:
        items = list(group.inputs)
    return {item.name: item.identifier for item in items}


def set_modifier_input(modifier: bpy.types.Modifier, name: str, value: Any) -> None:
    """Sets an input of a Geometry Nodes modifier by its name, unless an artist has renamed it or taken it away."""
    identifier = group_input_identifiers(modifier.node_group).get(name)
    if identifier is None:
        return
    inputs = getattr(getattr(modifier, "properties", None), "inputs", None)
    if inputs is not None:  # 5.2 on
        getattr(inputs, identifier).value = value
    else:
        modifier[identifier] = value
    if value is None or isinstance(value, bpy.types.Object):  # what depends on what is seen anew
        modifier.node_group = modifier.node_group
    modifier.id_data.update_tag()


def modifier_input(modifier: bpy.types.Modifier, name: str) -> Any:
    """The value of an input of a Geometry Nodes modifier; None where an artist has renamed it or taken it away."""
    identifier = group_input_identifiers(modifier.node_group).get(name)
    if identifier is None:
        return None
    inputs = getattr(getattr(modifier, "properties", None), "inputs", None)
    return getattr(inputs, identifier).value if inputs is not None else modifier[identifier]


def modifier_inputs(modifier: bpy.types.Modifier) -> dict[str, Any]:
    """The values of all inputs of a Geometry Nodes modifier by name, but for the geometry."""
    names = list(group_input_identifiers(modifier.node_group))[1:]
    return {name: modifier_input(modifier, name) for name in names}


def remove_modifier(item: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Removes a Geometry Nodes modifier of ours.

    Its inputs let go first of the data-blocks that they hold: with the modifier Blender 5.2 removes them from what
    `user_map` tells and not from `users`, so that materials would never be purged before the file is opened anew.
    """
    if hasattr(modifier, "properties") and modifier.node_group is not None:  # 5.2 on
        for name, value in modifier_inputs(modifier).items():
            if isinstance(value, bpy.types.ID):
                set_modifier_input(modifier, name, None)
    item.modifiers.remove(modifier)


def unit_scale(scene: bpy.types.Scene) -> float:
    """Meters in a world unit. Blender takes no scale into account where a scene has no units, and shows none."""
    units = scene.unit_settings
    return 1.0 if units.system == "NONE" else float(units.scale_length)


def user_folder(name: str = "graphs") -> str:
    """Tells where this add-on may keep files of its own; an extension has a place of its own from 4.2 on."""
    is_extension = __package__.startswith("bl_ext.")
    if is_extension and hasattr(bpy.utils, "extension_path_user"):
        return str(bpy.utils.extension_path_user(__package__, path=name))
    return str(bpy.utils.user_resource("DATAFILES", path=f"saddleback_{name}"))


def in_order_of_selection(mesh: bpy.types.Mesh, vertices: NDArray[np.int32]) -> NDArray[np.int32]:
    """Returns the same vertices in the order in which they were selected; as they are where Blender does not know it of
    all.

    Blender keeps the order with the mesh, but shows it to scripts through bmesh only, which costs seconds for a million
    vertices.
    """
    loaded = bmesh.new()
    try:
        loaded.from_mesh(mesh)
        history = [item.index for item in loaded.select_history if isinstance(item, bmesh.types.BMVert)]
    finally:
        loaded.free()
    is_known = len(history) == len(vertices) and set(history) == set(vertices.tolist())
    return np.array(history, np.int32) if is_known else vertices


def annotation_strokes(scene: bpy.types.Scene) -> list[tuple[str, NDArray[np.float32]]]:
    """Returns what was drawn in the scene with the annotation tool and is shown now: layer, places (n, 3) in the world.

    The scene's annotation is called so from 5.0 on, grease pencil before. Strokes that lie on the screen are left out.
    """
    data = scene.annotation if hasattr(scene, "annotation") else scene.grease_pencil
    found = []
    for layer in data.layers if data is not None else ():
        if layer.annotation_hide or not len(layer.frames):
            continue
        frame = layer.active_frame or layer.frames[-1]
        drawn = [stroke for stroke in frame.strokes if getattr(stroke, "display_mode", "3DSPACE") == "3DSPACE"]
        found += [(layer.info, _stroke_places(stroke)) for stroke in drawn]
    return found


def grease_pencil_strokes(item: bpy.types.Object) -> list[tuple[str, NDArray[np.float32], bool]]:
    """The strokes of a grease pencil object that are shown now: layer, places (n, 3) in its space, whether closed.

    Up to 4.2 strokes have points of their own; from 4.3 on a drawing has attributes like a curve.
    """
    found = []
    for layer in item.data.layers:
        if layer.hide or not len(layer.frames):
            continue
        if hasattr(layer, "info"):
            frame, matrix = layer.active_frame or layer.frames[-1], np.array(layer.matrix_layer)
            strokes = [(_stroke_places(stroke), bool(stroke.use_cyclic)) for stroke in frame.strokes]
        else:
            frame, matrix = layer.current_frame() or layer.frames[-1], np.array(layer.matrix_local)
            strokes = _drawing_strokes(frame.drawing)
        name = layer.info if hasattr(layer, "info") else layer.name
        found += [(name, places @ matrix[:3, :3].T + matrix[:3, 3], closed) for places, closed in strokes]
    return found


def is_grease_pencil(item: bpy.types.Object) -> bool:
    """Tells whether an object holds grease pencil strokes, of the older or the newer kind."""
    return item.type in ("GPENCIL", "GREASEPENCIL")


def _stroke_places(stroke: Any) -> NDArray[np.float32]:
    places = np.empty(3 * len(stroke.points), np.float32)
    stroke.points.foreach_get("co", places)
    return places.reshape(-1, 3)


def _drawing_strokes(drawing: Any) -> list[tuple[NDArray[np.float32], bool]]:
    offsets = np.empty(len(drawing.curve_offsets), np.int32)
    drawing.curve_offsets.foreach_get("value", as_copied(offsets))
    if len(offsets) < 2:
        return []
    places = np.empty(3 * offsets[-1], np.float32)
    drawing.attributes["position"].data.foreach_get("vector", places)
    closed = np.zeros(len(offsets) - 1, bool)
    cyclic = drawing.attributes.get("cyclic")
    if cyclic is not None:
        cyclic.data.foreach_get("value", closed)
    parts = np.split(places.reshape(-1, 3), offsets[1:-1])
    return [(part, bool(is_closed)) for part, is_closed in zip(parts, closed, strict=True)]


def make_keys_linear(item: bpy.types.Object) -> None:
    """Straight lines between the keyframes of an object. From 4.4 on an action's curves belong to slots."""
    data = item.animation_data
    if hasattr(data.action, "fcurves"):
        curves = data.action.fcurves
    else:
        curves = data.action.layers[0].strips[0].channelbag(data.action_slot).fcurves
    for curve in curves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def move_modifier_first(item: bpy.types.Object, modifier: bpy.types.Modifier) -> None:
    """Puts a modifier before all others; `modifiers.move` comes with 3.5."""
    if hasattr(item.modifiers, "move"):
        item.modifiers.move(item.modifiers.find(modifier.name), 0)
        return
    with bpy.context.temp_override(object=item):
        bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)


def interpolate_corner(loop: Any, face: Any) -> None:
    """Gives a BMesh corner what the face has at its place; the data of its vertex stays."""
    arguments = face, False, False
    try:
        loop.copy_from_face_interp(*arguments)
    except TypeError:  # Blender 3 wants all of them in one tuple
        loop.copy_from_face_interp(arguments)


def add_swept_curve(wiring: Any, curve: Any, profile: Any, radius: Any) -> Any:
    """Adds nodes that sweep a profile of radius 1 along curves, scaled by a field; an input of the node from 5.0 on."""
    swept = wiring.node("GeometryNodeCurveToMesh")
    swept.inputs["Fill Caps"].default_value = True
    wiring.link(profile, swept.inputs["Profile Curve"])
    if "Scale" in swept.inputs:
        wiring.link(radius, swept.inputs["Scale"])
    else:
        thick = wiring.node("GeometryNodeSetCurveRadius")
        wiring.link(curve, thick.inputs["Curve"])
        wiring.link(radius, thick.inputs["Radius"])
        curve = thick.outputs["Curve"]
    wiring.link(curve, swept.inputs["Curve"])
    return swept.outputs["Mesh"]


def add_asset_library(name: str, folder: Path) -> None:
    """Adds a folder to the asset libraries of the preferences; from 3.6 on without an operator."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if hasattr(libraries, "new"):
        libraries.new(name=name, directory=str(folder))
        return
    bpy.ops.preferences.asset_library_add(directory=str(folder))
    libraries[-1].name = name


def line_shader() -> Any:
    """Blender's own shader for wide lines of one color: its name lost a prefix in 4.0."""
    import gpu

    return gpu.shader.from_builtin(
        "3D_POLYLINE_UNIFORM_COLOR" if bpy.app.version < (4, 0) else "POLYLINE_UNIFORM_COLOR"
    )


def strokes_going_on(window: bpy.types.Window) -> bool:
    """Tells whether a brush or a transform is under way in a window; from 4.2 on Blender says so."""
    kinds = ("PAINT_", "SCULPT_", "TRANSFORM_", "GPENCIL_", "GREASE_PENCIL_", "CURVES_")
    return any(operator.bl_idname.startswith(kinds) for operator in getattr(window, "modal_operators", ()))
