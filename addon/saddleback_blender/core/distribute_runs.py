# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes on a surface: from templates, a field and a density to placements, and to what is made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from operator import itemgetter
from typing import Any

import numpy as np

from . import cache as cache_module
from . import native
from .cache import Cache
from .density_runs import density_of
from .distribute_texts import (
    MOST_FAULTS,
    fault,
    figures,
    filled,
    left_out,
    made_smaller,
    no_room,
    refusal,
    told,
    too_small,
    unfilled,
    warnings_of,
)
from .errors import BadInputError
from .field_runs import MadeField, field_of
from .fields.given_fields import given_field
from .graphs import GraphChoice, graph_of_surface, mesh_of_surface
from .progress import Progress
from .requests import DirectionFieldRequest, DistributeRequest, content_of
from .results import CheckResult, DistributeResult, Indices, PathsResult, PlacedShapes, Reals, ShapeValues
from .settings import DistributeSettings
from .shapes.bent_copies import bent_copies
from .shapes.cut_shapes import cut_shapes
from .shapes.overlapping import ROUND, THIN, Order, Whole, footprints, map_whole, tilted, tilted_frames
from .shapes.shape_classes import class_densities, class_fields, class_sizes, kept_placements
from .shapes.shape_sizes import (
    MOST_ROOM,
    PLACES_EACH,
    ROUGH,
    Laid,
    Placed,
    crowding,
    fitted_to_count,
    laid_out,
    painted_share,
    room,
    size_of,
    sizes,
)
from .shapes.shape_templates import ShapeTemplate, sized, uv_of_classes
from .surfaces.local_frames import anchored

BYTES_PER_SHAPE = 4000  # of a placement and its outline
MOST_FACES = 10_000_000  # of all bent copies, which take 0.8 KB each on their way
VALUES_REACH = 1.0  # radii of the largest shapes: how far beyond outlines vertices know of them


def distribute(request: DistributeRequest, progress: Progress, cache: Cache | None = None) -> DistributeResult:
    """Shapes on a surface that do not touch each other.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    laid = laid_of(request, progress, cache)
    mesh, result = laid.mesh, laid.result
    if settings.make_bent:
        _check_faces(laid, surface.name)
    mapped = _mapped(laid, request, progress, cache)
    whole, templates = _drawn(laid, mapped, request, progress, cache)
    drawn = whole.mapped
    bent = outlines = values = None
    if settings.make_bent:
        bent = bent_copies(mesh, drawn, templates, settings, request.threads, progress, whole.left_out, whole.bent)
    bent_anchors = outline_anchors = None
    triangles = np.asarray(mesh.triangles)
    if bent is not None and settings.follow_surface:
        bent_anchors = anchored(surface, triangles, bent.faces, bent.barycentric, bent.vertices, progress)
    if settings.make_outlines:
        outlines, faces, barycentric = _outlines(mapped, progress)
        if settings.follow_surface:
            outline_anchors = anchored(surface, triangles, faces, barycentric, outlines.points, progress)
    cut = cut_anchors = None
    if settings.make_cut:
        cut = cut_shapes(mesh, mapped, laid.templates, progress)
        if settings.follow_surface:
            cut_anchors = anchored(surface, triangles, cut.faces, cut.barycentric, cut.vertices, progress)
        cut = replace(cut, faces=surface.of_mesh(cut.faces), corner_faces=surface.of_mesh(cut.corner_faces))
    if settings.write_attributes:
        with progress.stage(0.97, "measuring the way to the outlines") as job:
            found = mapped.attributes(VALUES_REACH * laid.size, threads=request.threads, job=job)
        shape = np.ascontiguousarray(found.placement, np.int32)
        classes = np.where(shape >= 0, np.asarray(mapped.placements.shape)[shape], -1)
        uv = uv_of_classes(laid.templates, classes, np.asarray(found.uv))
        values = ShapeValues(
            shape=surface.spread(shape, -1),
            distance=surface.spread(np.asarray(found.distance), np.inf),
            uv=np.stack([surface.spread(np.ascontiguousarray(c), 0.0) for c in uv.T], axis=1),
        )
    progress.check()
    placements = result.placements
    frames = tuple(values[: len(placements)] for values in drawn.frames())
    points, rotations, scales = frames
    if templates is not laid.templates:
        points, rotations, scales = tilted_frames(templates, placements.shape, frames, settings.tilt)
    counts = np.bincount(placements.shape, minlength=len(laid.templates)).astype(np.int32)
    corners = np.asarray(mesh.triangles)[placements.center.faces]
    return DistributeResult(
        placed=PlacedShapes(
            shape=np.ascontiguousarray(placements.shape, np.int32),
            points=points,
            rotations=rotations,
            scales=scales,
            faces=surface.of_mesh(placements.center.faces),
            barycentric=placements.center.barycentric,
            corners=corners if surface.used is None else surface.used[corners],
            corner_points=surface.vertices[corners],
        ),
        vertex_count=surface.vertex_count,
        class_counts=counts,
        text=told(laid, counts, settings),
        lines=(*figures(laid, settings.maximal), *made_smaller(whole.smaller), *filled(whole.fillers)),
        warnings=(
            *laid.warnings,
            *warnings_of(laid, mapped, settings),
            *left_out(whole.missing),
            *unfilled(MOST_FACES if whole.is_cut_short else 0),
        ),
        bent=bent,
        bent_anchors=bent_anchors,
        outlines=outlines,
        outline_anchors=outline_anchors,
        values=values,
        cut=cut,
        cut_anchors=cut_anchors,
    )


def laid_of(request: DistributeRequest, progress: Progress, cache: Cache) -> Laid:
    """The placements, from the cache or new. Raises BadInputError where not one shape finds room."""
    settings, surface, sb = request.settings, request.surface, native.load()
    if not any(template.share > 0 for template in request.templates):
        raise BadInputError(f"'{surface.name}': the shares of all shapes are 0; give one of them more")
    mesh = mesh_of_surface(surface, progress, cache)
    templates = tuple(sized(template) for template in request.templates)
    overlap = _overlap(settings, templates)
    if settings.overlap > overlap:
        progress.note("Shapes without a mesh do not overlap")
    parts = [footprints(template.parts, overlap, THIN if settings.no_crossings else ROUND) for template in templates]
    shapes = [sb.Shape(*[list(part) for part in outlines]) for outlines in parts]
    field = _field(request, mesh, progress, cache)
    if settings.bend and field is None:
        with progress.stage(0.2, "making a field to bend along") as job:
            field = MadeField(sb.direction_field(mesh, 2, job=job), 0)

    def graph() -> Any:
        choice = GraphChoice("NORMAL", 0)
        return graph_of_surface(surface, mesh, choice, request.threads, request.disk, progress, cache)

    density = density_of(request.density, surface, settings, mesh, graph, progress)
    densities = class_densities(request.classes, surface, density, mesh)
    fields = class_fields(request.classes, surface, None if field is None else field.field, mesh)
    around = None if request.kept is None else kept_placements(request.kept, mesh, surface.name)
    forbidden = None if request.forbidden is None else _forbidden_faces(request, mesh)
    options: dict[str, Any] = {
        "size_range": (1.0 - settings.size_variation, 1.0),
        "gap": settings.gap,
        "mode": settings.packing,
        "mirror": settings.mirror,
        "bend": settings.bend,
        "maximal": settings.maximal,
        "seed": settings.seed,
        "shares": None if settings.maximal else [template.share for template in templates],
    }
    if densities is not None and not (settings.size_by_density and (settings.maximal or settings.packing > 0)):
        options["density"] = densities  # where shapes fill the surface their sizes alone say how many there are
    if "density" in options and settings.maximal:
        progress.note("Where shapes fill the surface the density says where, not how many; let it rule their size")
    if forbidden is not None:
        options["forbidden"] = forbidden
    field_key = [(own.angles, own.symmetry) for own in _listed(fields)]
    loops = [loop for outlines in parts for part in outlines for loop in part]
    shared = content_of([sorted(options.items(), key=itemgetter(0)), field_key, loops, request.kept])

    def place(size: float, most: int | None, each: int = 1, **more: Any) -> Placed:
        count = most and each * most
        shared_size = sizes(mesh, size, density if settings.size_by_density else None)
        wanted = class_sizes(request.classes, surface, shared_size)
        least = min(float(np.min(own)) for own in _listed(wanted))
        if room(mesh.area, least, options["size_range"][0], shapes) > MOST_ROOM:
            raise BadInputError(f"'{surface.name}': {too_small(size)}")
        key = (surface.key, content_of([shared, wanted, count, *more]))

        def lay() -> Any:
            with progress.stage(0.75, "laying shapes on the surface") as job:
                return sb.distribute(
                    mesh, shapes, count, field=fields, size=wanted, around=around, threads=request.threads, job=job,
                    **options, **more,
                )  # fmt: skip

        try:
            result = cache.get(("shapes", *key), lay, lambda found: BYTES_PER_SHAPE * len(found.placements))
        except sb.InputError as error:
            raise BadInputError(f"'{surface.name}': {refusal(str(error), templates)}") from error
        progress.check()
        return Placed(size, result, key)

    fills = settings.maximal or (settings.packing > 0 and "density" not in options)
    if settings.size:
        placed = place(settings.size, None if settings.maximal else settings.count)
    else:
        free = mesh.area if forbidden is None else float(np.asarray(mesh.face_areas)[~forbidden].sum()) or mesh.area
        if "density" in options and settings.maximal:
            free *= max(painted_share(mesh, own) for own in _listed(options["density"]))
        elif "density" in options and not settings.size_by_density:
            free /= max(crowding(mesh, own) for own in _listed(options["density"]))
        first = size_of(settings.count, settings.packing if fills else 0.0, fills, free, shapes, templates)
        with progress.stage(0.3, "finding out how large shapes can be") as job:
            size = laid_out(mesh, shapes, first, request.threads, job)
        if size < first:
            progress.note("The surface bends too much for shapes as large as the count has room for")
        lay = place
        if size < ROUGH * first and fills and not settings.maximal:
            # Places all over, of which enough do: to look for more room where there is hardly any takes minutes.
            even = np.zeros(len(mesh.vertices))
            even[mesh.triangles if forbidden is None else mesh.triangles[~forbidden]] = 1.0
            lay = partial(place, each=PLACES_EACH, density=even)
        placed = fitted_to_count(lay, size, settings.count, fills, settings.maximal)
    warnings = () if field is None else field.notes
    laid = Laid(mesh, templates, shapes, placed.size, placed.result, placed.key, fills and not settings.size, warnings)
    if not len(placed.result.placements):
        raise BadInputError(f"'{surface.name}': {no_room(laid)}")
    return laid


def _check_faces(laid: Laid, name: str) -> None:
    """Refuses more than memory is likely to have room for, before any of it is taken."""
    each = [0 if template.solid is None else len(template.solid.offsets) - 1 for template in laid.templates]
    faces = int(np.array(each)[laid.result.placements.shape].sum())
    if faces > MOST_FACES:
        raise BadInputError(
            f"'{name}': {len(laid.result.placements):,} bent copies would have {faces:,} faces; lay fewer or larger "
            "ones, or Instances in place of Bent Copies"
        )


def _mapped(laid: Laid, request: DistributeRequest, progress: Progress, cache: Cache) -> Any:
    def lay() -> Any:
        with progress.stage(0.85, "cutting outlines out of the surface") as job:
            return native.load().map_shapes(
                laid.mesh, laid.shapes, laid.result.placements, laid.result.field, threads=request.threads, job=job
            )

    return cache.get(("mapped shapes", *laid.key), lay, lambda found: BYTES_PER_SHAPE * len(found))


def _listed(values: Any) -> list[Any]:
    """What is given once for all, or once a class, as a list."""
    return [] if values is None else list(values) if isinstance(values, list) else [values]


def _overlap(settings: DistributeSettings, templates: Sequence[ShapeTemplate]) -> float:
    """By how much shapes overlap: all of them, or none."""
    return settings.overlap if all(template.solid is not None for template in templates) else 0.0


def _drawn(
    laid: Laid, mapped: Any, request: DistributeRequest, progress: Progress, cache: Cache
) -> tuple[Whole, Sequence[ShapeTemplate]]:
    """The shapes as they are shown, and where: those that were laid, unless they overlap."""
    settings = request.settings
    overlap = _overlap(settings, laid.templates)
    if overlap == 0.0:
        return Whole(mapped), laid.templates
    clears, fills = settings.no_crossings and settings.make_bent, settings.fill_gaps
    templates = [
        tilted(template, settings.tilt, THIN if settings.no_crossings else ROUND) for template in laid.templates
    ]
    shapes = [native.load().Shape(*[list(part) for part in template.parts]) for template in laid.templates]
    solids = [template.solid for template in templates]
    order = Order(laid.mesh, shapes, solids, laid.result.placements, laid.result.field, settings.fit, request.threads)

    bent = None  # not kept: it is far larger than all else

    def lay() -> Whole:
        nonlocal bent
        with progress.stage(0.9, "laying shapes over each other") as job:
            whole = map_whole(order, overlap, clears, MOST_FACES if fills else 0, job)
        bent = whole.bent
        return replace(whole, bent=None)

    drawn = content_of([settings.fit, clears, fills, [solid.vertices for solid in solids if solid]])
    key = ("overlapping shapes", *laid.key, drawn)
    whole = cache.get(key, lay, lambda found: BYTES_PER_SHAPE * len(found.mapped))
    return replace(whole, bent=bent), templates


def _field(request: DistributeRequest, mesh: Any, progress: Progress, cache: Cache) -> MadeField | None:
    if request.field is None:
        return None
    if isinstance(request.field, DirectionFieldRequest):
        return field_of(request.field, mesh, progress, cache)
    return MadeField(given_field(request.surface, request.field, mesh), 0)


def _forbidden_faces(request: DistributeRequest, mesh: Any) -> np.ndarray:
    """(F,) faces with a forbidden corner."""
    assert request.forbidden is not None
    surface = request.surface
    vertices = request.forbidden if surface.used is None else request.forbidden[surface.used]
    faces: np.ndarray = vertices[mesh.triangles].any(axis=1)
    return faces


def _outlines(mapped: Any, progress: Progress) -> tuple[PathsResult, Indices, Reals]:
    """All loops of all shapes as closed lines, and the triangles and weights of their points."""
    lines, faces, weights = [], [np.empty(0, np.int32)], [np.empty((0, 3))]
    for number in range(len(mapped)):
        if number % 64 == 0:
            progress.check()
        if number not in mapped.failures:
            lines += [np.asarray(loop) for loop in mapped.outline(number)]
            for loop in mapped.outline_surface(number):
                faces.append(loop.faces)
                weights.append(loop.barycentric)
    lengths = [np.linalg.norm(np.diff(line, axis=0, append=line[:1]), axis=1).sum() for line in lines]
    points = np.concatenate(lines) if lines else np.empty((0, 3))
    found = PathsResult(
        points=points,
        normals=np.zeros_like(points),
        offsets=np.cumsum([0, *map(len, lines)]).astype(np.int32),
        closed=np.ones(len(lines), bool),
        lengths=np.array(lengths),
    )
    return found, np.concatenate(faces), np.concatenate(weights)


def check(request: DistributeRequest, progress: Progress, cache: Cache | None = None) -> CheckResult:
    """Lays the same shapes again, or finds them in the cache, and has them checked by other mathematics.

    Raises as `distribute` does.
    """
    cache = cache or cache_module.shared
    laid = laid_of(request, progress, cache)
    mapped = _mapped(laid, request, progress, cache)
    with progress.stage(0.98, "checking the shapes") as job:
        report = native.load().check_distribution(laid.mesh, mapped, threads=request.threads, job=job)
    count = len(laid.result.placements)
    text = f"{count:,} shapes checked: "
    text += f"{report.fault_count:,} faults" if report.fault_count else "none touches another"
    return CheckResult(
        text=text,
        faults=tuple(fault(*found) for found in report.faults[:MOST_FAULTS]),
        lines=(
            f"Covered: {report.coverage:.2%} by {report.sample_count:,} samples",
            f"{report.piece_count:,} pieces of outlines compared, {report.triangle_count:,} triangles",
        ),
    )
