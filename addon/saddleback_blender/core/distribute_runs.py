"""Shapes on a surface: from templates, a field and a density to placements, and to what is made of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import cache as cache_module
from . import native
from .bent_copies import bent_copies
from .cache import Cache
from .density_runs import density_of
from .errors import BadInputError
from .field_runs import field_of
from .given_fields import given_field
from .graphs import GraphChoice, graph_of_surface, mesh_of_surface
from .local_frames import anchored
from .progress import Progress
from .requests import DirectionFieldRequest, DistributeRequest, digest
from .results import CheckResult, DistributeResult, Indices, PathsResult, PlacedShapes, Reals, ShapeValues
from .shape_templates import ShapeTemplate, sized

# Share of the surface that shapes cover when their size is left to their count: at random, and side by side.
COVERAGE, PACKED_COVERAGE = 0.40, 0.55
BYTES_PER_SHAPE = 4000  # of a placement and its outline
VALUES_REACH = 1.0  # radii of the largest shapes: how far beyond outlines vertices know of them


def distribute(request: DistributeRequest, progress: Progress, cache: Cache | None = None) -> DistributeResult:
    """Shapes on a surface that do not touch each other.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    laid = laid_of(request, progress, cache)
    mesh, result = laid.mesh, laid.result
    mapped = _mapped(laid, request, progress, cache)
    bent = outlines = values = None
    if settings.make_bent:
        bent = bent_copies(mesh, mapped, laid.templates, settings, request.threads, progress)
    bent_anchors = outline_anchors = None
    triangles = np.asarray(mesh.triangles)
    if bent is not None and settings.follow_surface:
        bent_anchors = anchored(surface, triangles, bent.faces, bent.barycentric, bent.vertices)
    if settings.make_outlines:
        outlines, faces, barycentric = _outlines(mapped, progress)
        if settings.follow_surface:
            outline_anchors = anchored(surface, triangles, faces, barycentric, outlines.points)
    if settings.write_attributes:
        with progress.stage(0.97, "measuring the way to the outlines") as job:
            found = mapped.attributes(VALUES_REACH * laid.size, threads=request.threads, job=job)
        shape = np.ascontiguousarray(found.placement, np.int32)
        values = ShapeValues(
            shape=surface.spread(shape, -1),
            distance=surface.spread(np.asarray(found.distance), np.inf),
            uv=np.stack([surface.spread(np.ascontiguousarray(c), 0.0) for c in 0.5 + 0.5 * found.uv.T], axis=1),
        )
    progress.check()
    placements = result.placements
    points, rotations, scales = mapped.frames()
    counts = np.bincount(placements.shape, minlength=len(laid.templates)).astype(np.int32)
    corners = np.asarray(mesh.triangles)[placements.centre.faces]
    return DistributeResult(
        placed=PlacedShapes(
            shape=np.ascontiguousarray(placements.shape, np.int32),
            points=points,
            rotations=rotations,
            scales=scales,
            faces=placements.centre.faces,
            barycentric=placements.centre.barycentric,
            corners=corners if surface.used is None else surface.used[corners],
            corner_points=surface.vertices[corners],
        ),
        vertex_count=surface.vertex_count,
        class_counts=counts,
        text=_told(laid, counts),
        lines=_figures(laid, counts, settings.maximal),
        warnings=_warnings(laid, mapped),
        bent=bent,
        bent_anchors=bent_anchors,
        outlines=outlines,
        outline_anchors=outline_anchors,
        values=values,
    )


@dataclass(frozen=True)
class Laid:
    """What the library answered, and what it was asked with."""

    mesh: Any
    templates: tuple[ShapeTemplate, ...]
    shapes: list[Any]
    size: float  # scale of the largest
    result: Any
    key: tuple[str, ...]


def laid_of(request: DistributeRequest, progress: Progress, cache: Cache) -> Laid:
    """The placements, from the cache or new."""
    settings, surface, sb = request.settings, request.surface, native.load()
    if not any(template.share > 0 for template in request.templates):
        raise BadInputError(f"'{surface.name}': the shares of all shapes are 0; give one of them more")
    mesh = mesh_of_surface(surface, progress, cache)
    templates = tuple(sized(template) for template in request.templates)
    shapes = [sb.Shape(*[list(part) for part in template.parts]) for template in templates]
    field = _field(request, mesh, progress, cache)
    bends = settings.bend and not settings.maximal
    if settings.bend and settings.maximal:
        progress.note("Shapes that fill the surface do not bend along the field")
    if bends and field is None:
        with progress.stage(0.2, "making a field to bend along") as job:
            field = sb.direction_field(mesh, 2, job=job)

    def graph() -> Any:
        choice = GraphChoice("NORMAL", 0)
        return graph_of_surface(surface, mesh, choice, request.threads, request.disk, progress, cache)

    density = density_of(request.density, surface, settings, mesh, graph, progress)
    size = settings.size or _size(settings.count, settings.packing, mesh.area, shapes, templates)
    sizes = _sizes(mesh, size, density if settings.size_by_density else None)
    options: dict[str, Any] = {
        "counts": None if settings.maximal else settings.count,
        "shares": None if settings.maximal else [template.share for template in templates],
        "size": sizes,
        "size_range": (1.0 - settings.size_variation, 1.0),
        "gap": settings.gap,
        "mode": settings.packing,
        "mirror": settings.mirror,
        "bend": bends,
        "maximal": settings.maximal,
        "seed": settings.seed,
    }
    if density is not None and settings.maximal and not settings.size_by_density:
        progress.note("Where shapes fill the surface the density has no say in their number; let it rule their size")
    elif density is not None and not (settings.size_by_density and (settings.maximal or settings.packing > 0)):
        options["density"] = density  # where shapes fill the surface their sizes alone say how many there are
    if request.forbidden is not None:
        options["forbidden"] = _forbidden_faces(request, mesh)
    key = (
        surface.key,
        digest(
            *(value for item in sorted(options.items(), key=lambda item: item[0]) for value in item),
            None if field is None else field.angles, None if field is None else field.symmetry,
            *(loop for template in templates for part in template.parts for loop in part),
        ),
    )  # fmt: skip

    def place() -> Any:
        with progress.stage(0.75, "laying shapes on the surface") as job:
            return sb.distribute(mesh, shapes, field=field, threads=request.threads, job=job, **options)

    result = cache.get(("shapes", *key), place, lambda found: BYTES_PER_SHAPE * len(found.placements))
    progress.check()
    return Laid(mesh, templates, shapes, size, result, key)


def _mapped(laid: Laid, request: DistributeRequest, progress: Progress, cache: Cache) -> Any:
    def lay() -> Any:
        with progress.stage(0.85, "cutting outlines out of the surface") as job:
            return native.load().map_shapes(
                laid.mesh, laid.shapes, laid.result.placements, laid.result.field, threads=request.threads, job=job
            )

    return cache.get(("mapped shapes", *laid.key), lay, lambda found: BYTES_PER_SHAPE * len(found))


def _field(request: DistributeRequest, mesh: Any, progress: Progress, cache: Cache) -> Any:
    if request.field is None:
        return None
    if isinstance(request.field, DirectionFieldRequest):
        return field_of(request.field, mesh, progress, cache).field
    return given_field(request.surface, request.field, mesh)


def _size(count: int, packing: float, area: float, shapes: Sequence[Any], templates: Sequence[ShapeTemplate]) -> float:
    """The scale at which so many shapes cover a fair share of the surface."""
    shares = np.array([template.share for template in templates])
    mean = float((shares * [shape.area for shape in shapes]).sum() / shares.sum())
    cover = COVERAGE + packing * (PACKED_COVERAGE - COVERAGE)
    return float(np.sqrt(cover * area / (count * mean)))


def _sizes(mesh: Any, size: float, density: Reals | None) -> float | Reals:
    """One scale, or one a vertex: by the density's square root, so that shapes fill the same share everywhere."""
    if density is None:
        return size
    middle = float(np.average(density, weights=_vertex_areas(mesh)))
    shrunk = np.sqrt(middle / np.maximum(density, middle / MOST_GROWTH**2))
    sizes: Reals = size * np.maximum(shrunk, 1.0 / MOST_GROWTH)
    return sizes


MOST_GROWTH = 4.0  # of a size by the density, up or down


def _vertex_areas(mesh: Any) -> Reals:
    thirds = np.repeat(np.asarray(mesh.face_areas, np.float64) / 3.0, 3)
    areas: Reals = np.bincount(mesh.triangles.ravel(), thirds, minlength=len(mesh.vertices)).astype(np.float64)
    return areas


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


# What the library's reasons to stop mean to a person; that every count is met needs no word.
STOPS = {"full": "nothing more fits", "tired": "no more room was found"}
REJECTIONS = {
    "collision": "met another",
    "boundary": "went over the border",
    "forbidden": "lay where none may",
    "fold": "would have folded",
    "stretched": "would have been stretched",
}


def _told(laid: Laid, counts: np.ndarray) -> str:
    total = int(counts.sum())
    text = "1 shape" if total == 1 else f"{total:,} shapes"
    if len(counts) > 1:
        names = (f"{count} {template.name}" for count, template in zip(counts, laid.templates, strict=True))
        text += f" ({', '.join(names)})"
    stop = STOPS.get(str(laid.result.stop_reason), "")
    return f"{text}, {stop}" if stop else text


def _figures(laid: Laid, counts: np.ndarray, is_maximal: bool) -> tuple[str, ...]:
    placements = laid.result.placements
    areas = np.array([shape.area for shape in laid.shapes])[placements.shape] * placements.scale**2
    lines = [f"Covered: {areas.sum() / laid.mesh.area:.1%}; radius of the largest {laid.size:.3g}"]
    tried = {REJECTIONS[name]: number for name, number in laid.result.rejections.items() if number}
    if tried:
        lines.append("Tries that " + ", ".join(f"{words}: {number:,}" for words, number in tried.items()))
    certificate = laid.result.certificate
    if is_maximal and certificate is not None:
        share = certificate.uncertified_area / laid.mesh.area
        lines.append(
            f"Proved full but for gaps under {certificate.tolerance:.2g}"
            + (f", on all but {share:.2%} of the surface" if share > 0 else "")
        )
    return tuple(lines)


def _warnings(laid: Laid, mapped: Any) -> tuple[str, ...]:
    found = []
    if len(mapped.failures):
        found.append(f"{len(mapped.failures)} shapes could not be laid out and are missing in what was made")
    if not len(laid.result.placements):
        found.append("No shape found room; make them smaller, or forbid less")
    return tuple(found)


FAULTS = {
    "not_laid": "could not be laid on the surface",
    "open": "has no closed outline",
    "crossing": "crosses",
    "nesting": "lies within",
    "overturned": "is turned over in a place",
    "incomplete": "is not all there",
    "covered_twice": "overlaps",
}
MOST_FAULTS = 8  # that are told


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
    told = f"{count:,} shapes checked: "
    told += f"{report.fault_count:,} faults" if report.fault_count else "none touches another"
    return CheckResult(
        text=told,
        faults=tuple(_fault(*fault) for fault in report.faults[:MOST_FAULTS]),
        lines=(
            f"Covered: {report.coverage:.2%} by {report.sample_count:,} samples",
            f"{report.piece_count:,} pieces of outlines compared, {report.triangle_count:,} triangles",
        ),
    )


def _fault(kind: str, first: int, second: int | None, where: tuple[float, float, float]) -> str:
    other = "" if second is None else f" shape {second}"
    place = ", ".join(f"{coordinate:.4g}" for coordinate in where)
    return f"Shape {first} {FAULTS[kind]}{other} at ({place})"
