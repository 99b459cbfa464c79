# SPDX-License-Identifier: GPL-3.0-or-later
"""The shapes to lay on a surface: meshes, curves and images of a collection, one image, or those of the add-on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import bpy
import numpy as np

from ... import compat
from ...blocks import find, name_of
from ...core import native
from ...core.distribute_texts import outline_refusal
from ...core.errors import BadInputError
from ...core.fields.image_colors import to_linear
from ...core.results import Indices, Reals
from ...core.settings import DistributeSettings
from ...core.shapes.mask_shapes import MOST_GRAY, grayness, parts_of_image, silhouette, whole_image
from ...core.shapes.outline_loops import border_loops, is_seen_once, parts_of_loops
from ...core.shapes.shape_presets import PRESETS, preset
from ...core.shapes.shape_templates import Parts, Picture, ShapeTemplate, Solid, box_uv, fitted, joined
from ..tokens import SOURCE
from .curves_in import polylines_of
from .evaluated import evaluated
from .images_in import read_pixels
from .materials_in import shown_materials
from .mesh_in import modified, read_triangles

SHARE = "share"  # custom property of a shape's object: how many there shall be, to those of others
FLAT = 1e-9  # of a curve's extent: what is thinner is a line
FACES = ("MESH", "CURVE", "SURFACE", "META", "FONT")  # kinds of objects that may have some
REC_709 = np.array([0.2126, 0.7152, 0.0722])


def read_templates(
    context: bpy.types.Context, source: bpy.types.Object, settings: DistributeSettings
) -> tuple[ShapeTemplate, ...]:
    """The chosen shapes. Raises BadInputError naming what cannot be one."""
    if settings.shapes in PRESETS:
        return tuple(preset(settings.shapes))
    if settings.shapes == "IMAGE":
        return (_of_image(source, _image(source, settings.shapes_image)),)
    items = items_of(source, settings.shapes_collection)
    found = [(_template(context, source, item), item) for item in items]
    with evaluated(context, items) as shown:
        scales = [(float(x), float(y), float(z)) for x, y, z in map(_own_scale, shown)]
    largest = max(1.0 / template.scale for template, _ in found)
    return tuple(
        replace(
            template,
            size=1.0 / template.scale / largest,
            share=_share(source, item),
            source="" if item.type == "EMPTY" else name_of(bpy.data.objects, item),
            own_scale=(1.0, 1.0, 1.0) if item.type == "EMPTY" else scale,
        )
        for (template, item), scale in zip(found, scales, strict=True)
    )


def items_of(source: bpy.types.Object, name: str) -> list[bpy.types.Object]:
    """The objects of a collection that are laid on the surface, by name. Raises BadInputError where there is none."""
    group = find(bpy.data.collections, name)
    if group is None:
        missing = f"there is no collection '{name}'" if name else "no collection is chosen"
        raise BadInputError(f"'{source.name}': {missing} to take shapes from; choose one, or shapes of the list")
    items = [item for item in group.all_objects if item != source and SOURCE not in item and _may_be_shape(item)]
    if not items:
        raise BadInputError(
            f"'{source.name}': collection '{name}' has no mesh, curve, text or image to lay on the surface; add one"
        )
    return sorted(items, key=lambda item: item.name_full)


def _may_be_shape(item: bpy.types.Object) -> bool:
    is_picture = item.type == "EMPTY" and isinstance(item.data, bpy.types.Image)
    return item.type in ("MESH", "CURVE", "FONT") or is_picture or _is_instance(item)


def _is_instance(item: bpy.types.Object) -> bool:
    """Tells whether an empty shows a collection."""
    return item.type == "EMPTY" and item.instance_type == "COLLECTION" and item.instance_collection is not None


def _own_scale(item: bpy.types.Object) -> Reals:
    """An object's scale in the world. A mirrored one is so along the axes of its own scale or, without such, along X:
    Blender's `to_scale` mirrors all three and turns the object to match, and how a shape is turned does not count.
    """
    scale: Reals = np.abs(item.matrix_world.to_scale()[:])
    if item.matrix_world.determinant() < 0:
        signs = np.sign(item.scale[:])
        scale *= signs if signs.prod() < 0 else (-1.0, 1.0, 1.0)
    return scale


def _share(source: bpy.types.Object, item: bpy.types.Object) -> float:
    try:
        share = float(item.get(SHARE, 1.0))
    except (TypeError, ValueError):
        share = -1.0
    if not (share >= 0.0 and np.isfinite(share)):
        raise BadInputError(
            f"'{source.name}': the share of shape '{item.name}' is {item[SHARE]!r}; write a number of 0 or more"
        )
    return share


def _template(context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object) -> ShapeTemplate:
    materials: tuple[str, ...] = ()
    solid: Solid | None
    if item.type == "EMPTY" and not _is_instance(item):
        return replace(_of_image(source, item.data), name=item.name)
    try:
        if _is_instance(item):
            parts, solid, materials = _of_instance(context, source, item)
        else:
            parts, solid = _of_curve(context, source, item) if item.type == "CURVE" else _of_mesh(context, source, item)
        native.load().Shape(*[list(part) for part in parts])
    except native.load().InputError as error:
        raise BadInputError(f"'{source.name}': '{item.name}' is no shape: {outline_refusal(str(error))}") from error
    return replace(fitted(item.name, parts, _center(parts), solid), materials=materials)


def _center(parts: Parts) -> Reals:
    """The origin where it is within the outlines' box, else the middle of that."""
    corners = np.concatenate([loop for part in parts for loop in part])
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle: Reals = np.zeros(2) if (low < 0).all() and (high > 0).all() else (low + high) / 2
    return middle


def _of_mesh(context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object) -> tuple[Parts, Solid]:
    """The outline of what is seen from above, in the object's scale, and the mesh itself."""
    solid = read_solid(context, source, item)
    return _outline(solid.vertices, solid.corners[solid.parted()]), solid


def read_solid(
    context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object, what: str = "shape"
) -> Solid:
    """The faces of an object of whatever kind, in its own space and scale. Raises BadInputError without any."""
    with modified(context, item) as (shown, mesh):
        scale = _own_scale(shown)
        vertices = compat.read_positions(mesh).astype(np.float64) * scale
        triangles = read_triangles(mesh)
        if not len(triangles) or not np.isfinite(vertices).all():
            raise BadInputError(f"'{source.name}': {what} '{item.name}' has no faces; give it some, or take it away")
        return _solid(mesh, vertices, scale.prod() < 0)


def _of_instance(
    context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object
) -> tuple[Parts, Solid, tuple[str, ...]]:
    """All meshes of a collection that an empty shows, as one, in the empty's scale; the names of their materials."""
    solids: list[Solid] = []
    lists: list[list[str]] = []
    with evaluated(context, [item]) as (shown,):
        back = np.linalg.inv(np.array(shown.matrix_world, np.float64))
        scale = _own_scale(shown)
        for instance in context.evaluated_depsgraph_get().object_instances:
            if not instance.is_instance or instance.parent != shown or instance.object.type not in FACES:
                continue
            matrix = back @ np.array(instance.matrix_world, np.float64)
            mesh = instance.object.to_mesh()
            if mesh is not None and len(mesh.polygons):  # Blender makes none of a curve without splines
                places = compat.read_positions(mesh).astype(np.float64)
                is_mirrored = np.linalg.det(matrix[:3, :3]) * scale.prod() < 0
                solids.append(_solid(mesh, (places @ matrix[:3, :3].T + matrix[:3, 3]) * scale, is_mirrored))
                materials = shown_materials(instance.object, mesh)
                lists.append([name_of(bpy.data.materials, material) for material in materials] or [""])
            instance.object.to_mesh_clear()
    if not solids or not all(np.isfinite(solid.vertices).all() for solid in solids):
        raise BadInputError(
            f"'{source.name}': shape '{item.name}' shows no faces; put a mesh into '{item.instance_collection.name}'"
        )
    solid = joined(solids, [len(names) for names in lists])
    names = tuple(name for names in lists for name in names)
    return _outline(solid.vertices, solid.corners[solid.parted()]), solid, names if any(names) else ()


def _outline(vertices: Reals, triangles: Indices) -> Parts:
    """The border of a mesh that is seen from one side only; of any other all that it covers."""
    places = vertices[:, :2]
    if is_seen_once(places, triangles):
        loops = border_loops(triangles)
        if loops is not None:
            parts = parts_of_loops([places[loop] for loop in loops])
            try:
                native.load().Shape(*[list(part) for part in parts])
                return parts
            except native.load().InputError:
                pass  # it covers some place twice
    return silhouette(vertices, triangles)


def _solid(mesh: bpy.types.Mesh, vertices: Reals, is_mirrored: bool) -> Solid:
    """The mesh with its vertices elsewhere; mirrored, its polygons turn the other way round."""
    totals = compat.read_numbers(mesh.polygons, "loop_total")
    material = compat.read_numbers(mesh.polygons, "material_index")
    smooth = np.empty(len(mesh.polygons), bool)
    mesh.polygons.foreach_get("use_smooth", smooth)
    corners = compat.read_corner_vertices(mesh)
    layer = mesh.uv_layers.active
    uv = box_uv(vertices)[corners]
    if layer is not None:
        flat = np.empty(2 * len(corners), np.float32)
        layer.data.foreach_get("uv", flat)
        uv = flat.reshape(-1, 2).astype(np.float64)
    mesh.calc_loop_triangles()
    triangles = compat.read_numbers(mesh.loop_triangles, "loops", 3).reshape(-1, 3)
    offsets = np.concatenate([[0], np.cumsum(totals)]).astype(np.int32)
    if is_mirrored:
        back = np.repeat(offsets[:-1] + offsets[1:] - 1, totals) - np.arange(len(corners))
        corners, uv, triangles = corners[back], uv[back], back[triangles][:, ::-1].astype(np.int32)
    return Solid(vertices, corners, offsets, uv, smooth, material, triangles)


def _of_curve(context: bpy.types.Context, source: bpy.types.Object, item: bpy.types.Object) -> tuple[Parts, None]:
    """The closed splines of a curve in its own plane."""
    with evaluated(context, [item]) as (shown,):
        back = np.linalg.inv(np.array(shown.matrix_world, np.float64))
        scale = _own_scale(shown)[:2]
    loops = [
        (line.points @ back[:3, :3].T + back[:3, 3])[:, :2] * scale
        for line in polylines_of(item)
        if line.closed and len(line.points) > 2
    ]
    if not loops:
        raise BadInputError(f"'{source.name}': shape '{item.name}' has no closed spline; close one (Alt C)")
    if all(np.linalg.matrix_rank(loop - loop.mean(axis=0), FLAT * np.ptp(loop)) < 2 for loop in loops):
        raise BadInputError(
            f"'{source.name}': shape '{item.name}' is a line seen from above; lay it in its own X and Y"
        )
    return parts_of_loops(loops), None


def _image(source: bpy.types.Object, name: str) -> bpy.types.Image:
    image = find(bpy.data.images, name)
    if image is None:
        missing = f"there is no image '{name}'" if name else "no image is chosen"
        raise BadInputError(f"'{source.name}': {missing} to make a shape from; choose one")
    return image


def _of_image(source: bpy.types.Object, image: bpy.types.Image) -> ShapeTemplate:
    """Returns where the image is opaque; of one without transparency where it is dark, or all of it where much of it is
    neither dark nor light, as of a photograph.
    """
    pixels, is_encoded = read_pixels(source, image)
    rows, columns = pixels.shape[:2]
    mask = pixels[:, :, 3].astype(np.float64)
    colors = pixels[:, :, :3].astype(np.float64)
    colors = to_linear(colors) if is_encoded else colors
    is_transparent = bool(mask.min() < 0.5)
    if not is_transparent:
        mask = 1.0 - colors @ REC_709
    try:
        is_whole = not is_transparent and grayness(mask) > MOST_GRAY
        parts = whole_image(rows, columns) if is_whole else parts_of_image(mask)
    except native.load().InputError as error:
        raise BadInputError(
            f"'{source.name}': image '{image.name}' makes no shape: {outline_refusal(str(error))}"
        ) from error
    seen = np.ones_like(mask, bool) if is_whole else mask >= 0.5
    color = tuple(colors[seen].mean(axis=0).tolist())
    picture = Picture(name_of(bpy.data.images, image), columns, rows, is_transparent, color)
    return replace(fitted(image.name, parts, _center_of_box(parts)), picture=picture)


def _center_of_box(parts: Sequence[Sequence[Reals]]) -> Reals:
    corners = np.concatenate([loop for part in parts for loop in part])
    middle: Reals = (corners.min(axis=0) + corners.max(axis=0)) / 2
    return middle
