"""Shapes on a surface into Blender: bent copies, instances, outlines, what the surface's vertices know of them."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Matrix

from ... import compat, nodes
from ...blocks import find
from ...core.errors import BadInputError
from ...core.results import Anchors, DistributeResult, Indices, PlacedShapes, Reals
from ...core.settings import DistributeSettings
from ...core.shapes.shape_colors import random_of, shape_colors
from ...core.shapes.shape_templates import ShapeTemplate
from ...core.surfaces.local_frames import in_frames, triangle_frames
from ...core.surfaces.quaternions import euler_of, quaternions_of, turned
from ...shape_nodes import (
    CORNER_ATTRIBUTES,
    SHIFT_ATTRIBUTE,
    WEIGHTS_ATTRIBUTE,
    X_ATTRIBUTE,
    Z_ATTRIBUTE,
    Host,
    Tubes,
    set_following,
    set_shapes,
    stop_following,
)
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import modified
from ..tokens import SOURCE, source_token
from .out_attributes import set_attribute, write_vertex_attributes
from .out_collection import (
    NAME,
    ROLE,
    directions_to_place,
    find_output,
    level_place,
    outputs_of,
    remove_object,
    remove_output,
    replace_object,
    to_place,
)
from .out_curves import new_curve
from .rest_places import read_rest, write_rest

BENT_ROLE, INSTANCES_ROLE, OUTLINES_ROLE = "shapes", "shape instances", "shape outlines"
KEEPER_ROLE = "shape outline anchors"
TEMPLATE_ROLE = "shape template"  # and a number: objects of ours that instances show, in no collection
SHAPE_ATTRIBUTE, RANDOM_ATTRIBUTE, UV_NAME = "saddleback_shape", "saddleback_random", "UVMap"
OUTLINE_DISTANCE, SHAPE_UV = "saddleback_outline_distance", "saddleback_shape_uv"
# Of the points: the triangle of the source on which each stands.
FACE_ATTRIBUTE = "saddleback_triangle"
FAR = 1e10  # instead of infinity, which shaders do not like


def write_bent(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: DistributeResult,
    templates: Sequence[ShapeTemplate],
    settings: DistributeSettings,
) -> bpy.types.Object:
    """Makes or replaces the source's shapes object: all bent copies as one mesh, which may follow the source.

    Faces know their shape, its class and a random number of its own; corners have UV places and a color.
    """
    bent = result.bent
    assert bent is not None
    place = level_place(source)
    mesh = bpy.data.meshes.new("Saddleback Shapes")
    _fill(mesh, to_place(place, bent.vertices), bent.corners, bent.offsets, bent.uv, bent.smooth)
    random = random_of(len(result.placed.shape), settings.seed)
    set_attribute(mesh, SHAPE_ATTRIBUTE, "FACE", bent.polygon_copy)
    set_attribute(mesh, nodes.CLASS_ATTRIBUTE, "FACE", bent.polygon_shape)
    set_attribute(mesh, RANDOM_ATTRIBUTE, "FACE", random[bent.polygon_copy])
    color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "CORNER")
    rgb = shape_colors(bent.polygon_shape, random[bent.polygon_copy])
    rgba = np.column_stack([rgb, np.ones(len(rgb))]).astype(np.float32)
    color.data.foreach_set("color", np.repeat(rgba, np.diff(bent.offsets), axis=0).ravel())
    compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)
    firsts = add_materials(mesh, templates)
    compat.write_numbers(mesh.polygons, "material_index", bent.material + firsts[bent.polygon_shape])
    rest = read_rest(context, source, settings.use_modifiers, result.vertex_count) if settings.follow_surface else None
    if result.bent_anchors is not None:
        write_anchors(mesh, result.bent_anchors, rest)
    mesh.update()
    item = replace_object(context, source, BENT_ROLE, mesh, place)
    if result.bent_anchors is not None:
        set_following(item, Host.of(source, place, result.vertex_count, rest is not None))
    else:
        stop_following(item)
    return item


def write_anchors(mesh: bpy.types.Mesh, anchors: Anchors, rest: Reals | None) -> None:
    """Writes what `set_following` asks of a mesh: where its vertices stand on the source."""
    for i, name in enumerate(CORNER_ATTRIBUTES):
        set_attribute(mesh, name, "POINT", np.ascontiguousarray(anchors.corners[:, i]))
    set_attribute(mesh, WEIGHTS_ATTRIBUTE, "POINT", anchors.barycentric)
    set_attribute(mesh, SHIFT_ATTRIBUTE, "POINT", anchors.shift)
    write_rest(mesh, rest, anchors.corners, anchors.barycentric)


def write_instances(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: DistributeResult,
    templates: Sequence[ShapeTemplate],
    settings: DistributeSettings,
) -> bpy.types.Object:
    """Makes or replaces the source's instances object: a point for each shape, and a node group that shows it there."""
    placed, place = result.placed, level_place(source)
    own = [templates[shape] for shape in placed.shape.tolist()]
    units = np.array([template.scale for template in own]).reshape(-1, 1)
    shifts = np.array([template.shift for template in own]).reshape(-1, 3)
    points = placed.points + turned(placed.rotations, placed.scales * units * shifts)
    scales = placed.scales * units * np.array([template.own_scale for template in own]).reshape(-1, 3)
    mesh = bpy.data.meshes.new("Saddleback Shapes")
    mesh.vertices.add(len(points))
    mesh.vertices.foreach_set("co", to_place(place, points).astype(np.float32).ravel())
    columns = {
        nodes.CLASS_ATTRIBUTE: placed.shape,
        nodes.ROTATION_ATTRIBUTE: euler_of(_to_place(place, placed.rotations)),
        nodes.SCALE_ATTRIBUTE: scales,
        RANDOM_ATTRIBUTE: random_of(len(points), settings.seed),
        FACE_ATTRIBUTE: placed.faces,
        WEIGHTS_ATTRIBUTE: placed.barycentric,
        **_by_triangles(place, placed, points),
    }
    for name, values in columns.items():
        set_attribute(mesh, name, "POINT", values)
    rest = read_rest(context, source, settings.use_modifiers, result.vertex_count) if settings.follow_surface else None
    write_rest(mesh, rest, placed.corners, placed.barycentric)
    mesh.update()
    item = replace_object(context, source, INSTANCES_ROLE, mesh, place)
    remove_templates(source)
    host = Host.of(source, place, result.vertex_count, rest is not None) if settings.follow_surface else None
    shown = [_shown_object(source, number, template) for number, template in enumerate(templates)]
    set_shapes(item, shown, host)
    return item


def _by_triangles(place: Matrix, placed: PlacedShapes, points: Reals) -> dict[str, np.ndarray]:
    """Returns where the shapes stand and how they are turned, as seen from the triangles that they stand on."""
    frames = triangle_frames(placed.corner_points)
    feet = np.einsum("ni,nij->nj", placed.barycentric, placed.corner_points)
    x, z = (turned(placed.rotations, np.tile(axis, (len(points), 1))) for axis in ([1.0, 0, 0], [0, 0, 1.0]))
    columns: dict[str, np.ndarray] = {
        name: np.ascontiguousarray(placed.corners[:, i]) for i, name in enumerate(CORNER_ATTRIBUTES)
    }
    # Lengths are those of the world: an output's place has no scale.
    for name, vectors in ((SHIFT_ATTRIBUTE, points - feet), (X_ATTRIBUTE, x), (Z_ATTRIBUTE, z)):
        columns[name] = in_frames(frames, vectors)
    return columns


def write_outlines(
    context: bpy.types.Context, source: bpy.types.Object, result: DistributeResult, settings: DistributeSettings
) -> bpy.types.Object:
    """Makes or replaces the source's outlines object, which may follow the source; radii are in world units."""
    lines = result.outlines
    assert lines is not None
    place, radius = level_place(source), settings.outline_radius
    points = to_place(place, lines.points)
    ends = zip(lines.offsets[:-1], lines.offsets[1:], strict=True)
    is_followed, material = result.outline_anchors is not None, nodes.edges_material()
    own_radius = 0.0 if is_followed else radius
    curve = new_curve("Saddleback Outlines", ((points[begin:end], True) for begin, end in ends), own_radius)
    curve.materials.append(material)
    item = replace_object(context, source, OUTLINES_ROLE, curve, place)
    _remove_keeper(source)
    if result.outline_anchors is not None:
        rest = read_rest(context, source, settings.use_modifiers, result.vertex_count)
        tubes = Tubes(_keeper(source, result.outline_anchors, rest), radius, material)
        set_following(item, Host.of(source, place, result.vertex_count, rest is not None), tubes)
    else:
        stop_following(item)
    return item


def _keeper(source: bpy.types.Object, anchors: Anchors, rest: Reals | None) -> bpy.types.Object:
    """An object in no collection that knows where the points of the outlines stand, which curves cannot."""
    mesh = bpy.data.meshes.new("Saddleback Outline Anchors")
    mesh.vertices.add(len(anchors.corners))
    write_anchors(mesh, anchors, rest)
    item = bpy.data.objects.new(mesh.name, mesh)
    item[ROLE], item[NAME], item[SOURCE] = KEEPER_ROLE, item.name, source_token(source)
    return item


def _remove_keeper(source: bpy.types.Object) -> None:
    item = find_output(source, KEEPER_ROLE)
    if item is not None:
        remove_object(item)


def remove_outlines(source: bpy.types.Object) -> None:
    """Removes the outlines object, if there is one, and what belongs to it."""
    remove_output(source, OUTLINES_ROLE)
    _remove_keeper(source)


def write_shape_values(surface: bpy.types.Object, result: DistributeResult) -> None:
    """Writes on the surface's vertices whose outline is nearest, how far it is, and where in the shape they are."""
    values = result.values
    assert values is not None
    distance = np.where(np.isfinite(values.distance), values.distance, FAR)
    write_vertex_attributes(
        surface, {SHAPE_ATTRIBUTE: values.shape, OUTLINE_DISTANCE: distance.astype(np.float32), SHAPE_UV: values.uv}
    )


def make_real(context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object) -> int:
    """Turns instances into objects beside them, which are the artist's from then on; returns how many.

    Raises BadInputError where they cannot be shown, and so not be found.
    """
    active, selected = context.view_layer.objects.active, list(context.selected_objects)
    _show(context, source, item)
    before = set(bpy.data.objects.keys())
    for other in selected:
        other.select_set(False)
    item.select_set(True)
    context.view_layer.objects.active = item
    bpy.ops.object.duplicates_make_real()
    made = [other for name, other in bpy.data.objects.items() if name not in before]
    for other in made:
        other.select_set(False)
        for key in (ROLE, NAME, SOURCE):
            if key in other:
                del other[key]
    remove_object(item)
    remove_templates(source)
    for other in selected:
        if other != item:
            other.select_set(True)
    context.view_layer.objects.active = active
    return len(made)


def _show(context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object) -> None:
    """Makes instances visible, which Blender leaves out otherwise."""
    if item.name in context.view_layer.objects:
        was_hidden = item.hide_viewport, item.hide_get()
        item.hide_viewport = False
        item.hide_set(False)
        context.view_layer.update()
        if item.visible_get():
            return
        item.hide_viewport = was_hidden[0]
        item.hide_set(was_hidden[1])
    raise BadInputError(f"'{source.name}': '{item.name}' is hidden with its collection; show that first")


def remove_templates(source: bpy.types.Object) -> None:
    """Removes the objects of ours that instances showed."""
    for item in outputs_of(source):
        if str(item[ROLE]).startswith(TEMPLATE_ROLE):
            remove_object(item)


def _shown_object(source: bpy.types.Object, number: int, template: ShapeTemplate) -> bpy.types.Object:
    """Returns what an instance shows: the artist's own object, or a new one of ours."""
    if template.source:
        return find(bpy.data.objects, template.source)
    mesh = bpy.data.meshes.new(template.name)
    if template.solid is not None:
        solid = template.solid
        _fill(mesh, solid.vertices, solid.corners, solid.offsets, solid.uv, solid.smooth)
        color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "CORNER")
        rgba = np.append(shape_colors(np.array([number], np.int32), np.array([0.5])), 1.0)
        color.data.foreach_set("color", np.tile(rgba, len(solid.corners)).astype(np.float32))
        compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)
    else:
        _fill_flat(mesh, template)
    mesh.materials.append(nodes.shapes_material())
    item = bpy.data.objects.new(template.name, mesh)
    item[ROLE], item[NAME], item[SOURCE] = f"{TEMPLATE_ROLE} {number}", item.name, source_token(source)
    return item


def _fill(
    mesh: bpy.types.Mesh, vertices: Reals, corners: Indices, offsets: Indices, uv: Reals, smooth: np.ndarray
) -> None:
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    compat.write_polygons(mesh, corners, offsets)
    mesh.polygons.foreach_set("use_smooth", smooth)
    mesh.update(calc_edges=True)
    mesh.uv_layers.new(name=UV_NAME).data.foreach_set("uv", uv.astype(np.float32).ravel())


def _fill_flat(mesh: bpy.types.Mesh, template: ShapeTemplate) -> None:
    """A shape without a solid: its outlines as polygons; holes are left out, which one polygon cannot have."""
    loops = [part[0] for part in template.parts]
    offsets = np.concatenate([[0], np.cumsum([len(loop) for loop in loops])]).astype(np.int32)
    flat = np.concatenate(loops)
    vertices = np.column_stack([flat, np.full(len(flat), 0.02)])
    corners = np.arange(len(flat), dtype=np.int32)
    _fill(mesh, vertices, corners, offsets, 0.5 + 0.5 * flat, np.zeros(len(loops), bool))


def add_materials(mesh: bpy.types.Mesh, templates: Sequence[ShapeTemplate]) -> np.ndarray:
    """Adds the materials of all classes; returns (classes,) the slot at which those of each begin."""
    firsts = []
    for template in templates:
        firsts.append(len(mesh.materials))
        own = _materials(find(bpy.data.objects, template.source))
        for material in own if any(own) else [nodes.shapes_material()]:
            mesh.materials.append(material)
    return np.array(firsts, np.int32)


def _materials(item: bpy.types.Object | None) -> list[bpy.types.Material | None]:
    if item is None or item.type not in ("MESH", "FONT"):
        return []
    with modified(bpy.context, item) as (shown, mesh):
        return shown_materials(shown, mesh)


def _to_place(place: object, rotations: Reals) -> Reals:
    """The turns as seen from an object whose world matrix is `place`, a turn without scale."""
    x = directions_to_place(place, turned(rotations, np.tile([1.0, 0, 0], (len(rotations), 1))))
    z = directions_to_place(place, turned(rotations, np.tile([0, 0, 1.0], (len(rotations), 1))))
    return quaternions_of(x, np.cross(z, x), z)
