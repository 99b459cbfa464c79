# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes on a surface into Blender: bent copies, instances, outlines, what the surface's vertices know of them."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ... import compat, nodes
from ...blocks import find
from ...core.errors import BadInputError
from ...core.results import Anchors, DistributeResult, Indices, PlacedShapes, Reals
from ...core.settings import DistributeSettings
from ...core.shapes.shape_colors import palette_colors, random_of, shape_colors
from ...core.shapes.shape_templates import ShapeTemplate
from ...core.surfaces.quaternions import axes_of, euler_of, turned
from ...finishes import material_of, palette_of
from ...follow_nodes import WEIGHTS_ATTRIBUTE, stop_following
from ...image_materials import image_material
from ...looks import NO_LOOK, finish_of
from ...shape_nodes import set_shapes
from ..inputs.materials_in import shown_materials
from ..inputs.mesh_in import level_place, modified
from ..tokens import NAME, ROLE, layer_of
from .following import Follower
from .hand_edits import make_ordinary
from .out_attributes import set_attribute, write_vertex_attributes
from .out_collection import (
    mark,
    outputs_of,
    remove_object,
    replace_object,
)
from .out_curves import Lines, write_lines

BENT_ROLE, INSTANCES_ROLE, OUTLINES_ROLE = "shapes", "shape instances", "shape outlines"
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
    follower: Follower,
) -> bpy.types.Object:
    """Makes or replaces the source's shapes object: all bent copies as one mesh, which may follow the source.

    Faces know their shape, its class and a random number of its own; corners have UV places and a color.
    """
    bent = result.bent
    assert bent is not None
    place = level_place(source)
    mesh = bpy.data.meshes.new("Saddleback Shapes")
    fill(mesh, bent.vertices, bent.corners, bent.offsets, bent.uv, bent.smooth)
    random = random_numbers(result, settings.seed, int(bent.polygon_copy.max(initial=-1)) + 1)
    set_attribute(mesh, SHAPE_ATTRIBUTE, "FACE", bent.polygon_copy)
    set_attribute(mesh, nodes.CLASS_ATTRIBUTE, "FACE", bent.polygon_shape)
    set_attribute(mesh, RANDOM_ATTRIBUTE, "FACE", random[bent.polygon_copy])
    color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "CORNER")
    rgb = _colors(bent.polygon_shape, random[bent.polygon_copy], settings.look)
    rgba = np.column_stack([rgb, np.ones(len(rgb))]).astype(np.float32)
    color.data.foreach_set("color", np.repeat(rgba, np.diff(bent.offsets), axis=0).ravel())
    compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)
    firsts = add_materials(mesh, templates, settings.look)
    compat.write_numbers(mesh.polygons, "material_index", bent.material + firsts[bent.polygon_shape])
    mesh.update()
    item = replace_object(context, source, BENT_ROLE, mesh, place)
    if result.bent_anchors is not None:
        follower.take_anchored(item, place, result.bent_anchors)
    else:
        stop_following(item)
    return item


def write_instances(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: DistributeResult,
    templates: Sequence[ShapeTemplate],
    settings: DistributeSettings,
    follower: Follower,
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
    mesh.vertices.foreach_set("co", points.astype(np.float32).ravel())
    rotations = euler_of(placed.rotations)
    columns = {
        nodes.CLASS_ATTRIBUTE: placed.shape,
        nodes.ROTATION_ATTRIBUTE: rotations,
        nodes.NORMAL_ATTRIBUTE: axes_of(rotations)[1],
        nodes.SCALE_ATTRIBUTE: scales,
        RANDOM_ATTRIBUTE: random_numbers(result, settings.seed),
        FACE_ATTRIBUTE: placed.faces,
        WEIGHTS_ATTRIBUTE: placed.barycentric,
    }
    for name, values in columns.items():
        set_attribute(mesh, name, "POINT", values)
    mesh.update()
    item = replace_object(context, source, INSTANCES_ROLE, mesh, place)
    remove_templates(source)
    set_shapes(
        item, [_shown_object(source, number, template, settings.look) for number, template in enumerate(templates)]
    )
    if settings.follow_surface:
        follower.take_anchored(item, place, _anchors(placed, points), rotations)
    else:
        stop_following(item)
    return item


def _anchors(placed: PlacedShapes, points: Reals) -> Anchors:
    """Where points (n, 3) that belong to the shapes stand."""
    feet = np.einsum("ni,nij->nj", placed.barycentric, placed.corner_points)
    return Anchors(placed.corners, placed.barycentric, points - feet)


def write_outlines(
    context: bpy.types.Context,
    source: bpy.types.Object,
    result: DistributeResult,
    settings: DistributeSettings,
    follower: Follower,
) -> bpy.types.Object:
    """Makes or replaces the source's outlines object, which may follow the source; radii are in world units."""
    assert result.outlines is not None
    lines = Lines.between(result.outlines.points, result.outlines)
    item = write_lines(context, source, OUTLINES_ROLE, lines, settings.outline_radius, nodes.edges_material())
    if result.outline_anchors is not None:
        follower.take_anchored(item, level_place(source), result.outline_anchors)
    else:
        stop_following(item)
    return item


def write_shape_values(surface: bpy.types.Object, result: DistributeResult, suffix: str) -> None:
    """Writes on the surface's vertices whose outline is nearest, how far it is, and where in the shape they are."""
    values = result.values
    assert values is not None
    distance = np.where(np.isfinite(values.distance), values.distance, FAR)
    write_vertex_attributes(
        surface,
        {
            SHAPE_ATTRIBUTE + suffix: values.shape,
            OUTLINE_DISTANCE + suffix: distance.astype(np.float32),
            SHAPE_UV + suffix: values.uv,
        },
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
        make_ordinary(other)
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
    for item in outputs_of(source, layer_of(source)):
        if str(item[ROLE]).startswith(TEMPLATE_ROLE):
            remove_object(item)


def _shown_object(source: bpy.types.Object, number: int, template: ShapeTemplate, look: str) -> bpy.types.Object:
    """Returns what an instance shows: the artist's own object, or a new one of ours."""
    if template.source:
        return find(bpy.data.objects, template.source)
    mesh = bpy.data.meshes.new(template.name)
    if template.solid is not None:
        solid = template.solid
        fill(mesh, solid.vertices, solid.corners, solid.offsets, solid.uv, solid.smooth)
        color = mesh.color_attributes.new(nodes.COLOR_ATTRIBUTE, "BYTE_COLOR", "CORNER")
        rgba = np.append(_colors(np.array([number], np.int32), np.array([0.5]), look), 1.0)
        color.data.foreach_set("color", np.tile(rgba, len(solid.corners)).astype(np.float32))
        compat.show_color(mesh, nodes.COLOR_ATTRIBUTE)
    else:
        _fill_flat(mesh, template)
    for material in _own_materials(template) or [material_of(look, nodes.shapes_material)]:
        mesh.materials.append(material)
    if template.materials and template.solid is not None:
        compat.write_numbers(mesh.polygons, "material_index", template.solid.material)
    item = bpy.data.objects.new(template.name, mesh)
    item[NAME] = item.name
    mark(item, source, f"{TEMPLATE_ROLE} {number}")
    return item


def fill(
    mesh: bpy.types.Mesh, vertices: Reals, corners: Indices, offsets: Indices, uv: Reals, smooth: np.ndarray
) -> None:
    """Gives a new mesh its faces: polygon i runs through corners[offsets[i]:offsets[i + 1]]."""
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
    fill(mesh, vertices, corners, offsets, template.uv_of(flat), np.zeros(len(loops), bool))


def random_numbers(result: DistributeResult, seed: int, all_of: int = 0) -> Reals:
    """(n,) a number of each shape, 0 to 1; a mirrored one has its twin's. `all_of`: with those that fill gaps."""
    count = len(result.placed.shape)
    fillers = max(0, all_of - count)
    if result.twin is None:
        return random_of(count + fillers, seed)
    half = count // 2 + np.arange(fillers // 2)
    found: Reals = random_of(len(half) + count // 2, seed)[np.concatenate([result.twin, half, half])]
    return found


def _colors(classes: Indices, random: Reals, look: str) -> Reals:
    finish = finish_of(look)
    if finish is None:
        return shape_colors(classes, random)
    return palette_colors(random, palette_of(finish), finish.contrast)


def add_materials(
    mesh: bpy.types.Mesh, templates: Sequence[ShapeTemplate], look: str = NO_LOOK, is_cut: bool = False
) -> np.ndarray:
    """Adds the materials of all classes; returns (classes,) the slot at which those of each begin."""
    firsts = []
    for template in templates:
        firsts.append(len(mesh.materials))
        own = _own_materials(template, is_cut)
        for material in own if any(own) else [material_of(look, nodes.shapes_material)]:
            mesh.materials.append(material)
    return np.array(firsts, np.int32)


def _own_materials(template: ShapeTemplate, is_cut: bool = False) -> list[bpy.types.Material | None]:
    """Those of the object that it was read from, of what a collection instance shows, or of its picture.

    A picture has one for SIDES, too, which is not transparent, as it would be along its border; cut into the surface
    all of it is so, or one would look into the body.
    """
    picture = template.picture
    image = find(bpy.data.images, picture.name) if picture else None
    if picture and image:
        opaque = image_material(image, SHAPE_UV if is_cut else UV_NAME, picture.color, is_transparent=False)
        if is_cut or not picture.is_transparent:
            return [opaque, opaque]
        return [image_material(image, UV_NAME, picture.color, is_transparent=True), opaque]
    if template.materials:
        return [find(bpy.data.materials, name) for name in template.materials]
    return materials_of(find(bpy.data.objects, template.source))


def materials_of(item: bpy.types.Object | None) -> list[bpy.types.Material | None]:
    """The materials that the faces of an object show, by their index; none where it has no faces."""
    if item is None or item.type not in ("MESH", "FONT"):
        return []
    with modified(bpy.context, item) as (shown, mesh):
        return shown_materials(shown, mesh)
