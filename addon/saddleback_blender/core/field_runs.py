# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of directions: from strokes, singularities and alignment to vectors, and to what shows them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import cache as cache_module
from . import native
from .cache import Cache
from .errors import BadInputError
from .fields.field_strokes import reach_of, strokes_of
from .fields.given_fields import painted_directions
from .fields.stream_lines import even_streamlines
from .graphs import mesh_of_surface
from .progress import Progress
from .requests import DirectionFieldRequest, SingularPlace, Surface, digest
from .results import FieldResult, Indices, Reals, SurfaceArrows
from .surfaces.normals import normals_at
from .surfaces.point_grid import even_points

MOST_NAMED = 3  # of strokes that a warning tells
ARROW_LENGTH = 0.75  # of the distance from one to the next
# What a field and an editor hold, roughly: angles, turns, the multigrid's levels.
FIELD_BYTES_PER_FACE, EDITOR_BYTES_PER_FACE = 120, 900


def direction_field(request: DirectionFieldRequest, progress: Progress, cache: Cache | None = None) -> FieldResult:
    """A field of directions on a surface.

    Raises BadInputError, the library's MeshError and InputError with sentences, and its Cancelled.
    """
    cache = cache or cache_module.shared
    settings, surface = request.settings, request.surface
    mesh = mesh_of_surface(surface, progress, cache)
    made = field_of(request, mesh, progress, cache)
    if request.strokes:
        progress.choose("stroke_reach", settings.stroke_reach, reach_of(mesh))
    field = made.field
    progress.check()
    if settings.domain == "FACE":
        directions = _of_polygons(mesh, surface, field.vectors, request.polygons)
    else:
        own = field.directions(np.arange(len(surface.vertices), dtype=np.int32))
        directions = np.stack([surface.spread(np.ascontiguousarray(column), 0.0) for column in own.T], axis=1)
    singular = np.array(sorted(field.singularities), np.int32)
    arrows = None
    if settings.make_arrows:
        usual = ARROW_LENGTH * float(np.sqrt(mesh.area / settings.arrow_count))
        length = progress.choose("arrow_length", settings.arrow_length, usual)
        arrows = _arrows(mesh, field, settings.arrow_count, length, settings.seed, progress)
    streamlines = None
    if settings.make_streamlines:
        streamlines = even_streamlines(mesh, field, settings, progress)
    progress.check()
    return FieldResult(
        symmetry=field.symmetry,
        domain=settings.domain,
        directions=directions,
        singular_points=mesh.vertices[singular],
        singular_normals=_vertex_normals(mesh, singular),
        singular_indices=np.array([field.singularities[vertex] for vertex in singular.tolist()]),
        largest_turn=float(field.largest_turn),
        stroke_count=made.stroke_count,
        warnings=made.notes,
        arrows=arrows,
        streamlines=streamlines,
    )


@dataclass(frozen=True)
class MadeField:
    """The library's field, how many strokes it follows, and whose are too far from the surface."""

    field: Any
    stroke_count: int
    left_out: tuple[str, ...] = ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Returns what to warn of."""
        if not self.left_out:
            return ()
        many = len(self.left_out)
        whose = ", ".join(sorted(set(self.left_out))[:MOST_NAMED])
        if many == 1:
            return (f"One stroke is too far from the surface and was left out: {whose}",)
        return (f"{many} strokes are too far from the surface and were left out, among them {whose}",)


def field_of(request: DirectionFieldRequest, mesh: Any, progress: Progress, cache: Cache) -> MadeField:
    """The library's field as the settings ask for it; what an earlier run found out is used again."""
    settings, surface, painted = request.settings, request.surface, request.painted
    symmetry = int(settings.symmetry)
    if settings.align == "CURVATURE" and symmetry == 1:
        raise BadInputError(
            f"'{surface.name}': how a surface bends tells no vector from its opposite; choose Lines or Crosses"
        )
    indices = singular_vertices(request, mesh)
    key = digest(
        symmetry, settings.align, settings.align_weight, settings.stroke_weight, settings.stroke_reach,
        settings.hard_strokes, settings.turn, indices,
        *(part for line in request.strokes for part in (line.points, line.closed, line.hard)),
        *((painted.vectors, painted.symmetry, painted.polygons, settings.painted_weight) if painted else ()),
    )  # fmt: skip
    faces = len(mesh.triangles)

    def make() -> MadeField:
        editor = cache.get(
            ("field editor", surface.key, str(symmetry)),
            lambda: native.load().DirectionFieldEditor(mesh, symmetry),
            lambda _: EDITOR_BYTES_PER_FACE * faces,
        )
        with progress.stage(0.2, "bringing strokes to the surface"):
            drawn = strokes_of(request, mesh)
        directions = painted_directions(surface, painted, mesh) if painted else None
        weights = np.full(faces, settings.painted_weight) if painted else None
        with progress.stage(0.8, "combing the surface") as job:
            try:
                field = editor.field(
                    indices, drawn.strokes, settings.align.lower(), align_weight=settings.align_weight,
                    directions=directions, weights=weights, job=job,
                )  # fmt: skip
            except native.load().InputError as error:
                raise BadInputError(f"'{surface.name}': {_told(str(error), drawn.labels)}") from error
        return MadeField(field.turned(settings.turn) if settings.turn else field, drawn.followed, drawn.left_out)

    return cache.get(("field", surface.key, key), make, lambda _: FIELD_BYTES_PER_FACE * faces)


def singular_vertices(request: DirectionFieldRequest, mesh: Any) -> dict[int, float] | None:
    """{vertex of the surface: index}; None where the field chooses."""
    if request.singularities is None:
        return None
    name, symmetry = request.surface.name, int(request.settings.symmetry)
    points = native.load().project(mesh, np.array([item.place for item in request.singularities]))
    vertices = mesh.triangles[points.faces, points.barycentric.argmax(axis=1)]
    boundary = set(np.asarray(mesh.boundary_vertices).tolist())
    taken: dict[int, SingularPlace] = {}
    for item, vertex in zip(request.singularities, vertices.tolist(), strict=True):
        if vertex in boundary:
            raise BadInputError(
                f"'{name}': '{item.name}' lies at the border of the surface, where a field cannot be singular; move it "
                "inwards"
            )
        if vertex in taken:
            raise BadInputError(
                f"'{name}': '{taken[vertex].name}' and '{item.name}' are at the same vertex; move one of them"
            )
        if item.index is not None and (item.index * symmetry).denominator != 1:
            kind = {1: "vectors have whole", 2: "lines have half", 4: "crosses have quarter"}[symmetry]
            raise BadInputError(
                f"'{name}': '{item.name}' has the index {item.index}, but {kind} indices; change it, or the symmetry"
            )
        taken[vertex] = item
    return {vertex: float(1 / symmetry if item.index is None else item.index) for vertex, item in taken.items()}


def _told(text: str, labels: Sequence[str]) -> str:
    """The library's refusal in the artist's words: no argument's name, strokes by what they are called."""
    is_sum = text.startswith("singularities: ") and "must sum to" in text
    text = re.sub(r"^\w+: ", "", text)
    text = re.sub(r"component (\d+)", lambda found: f"part {int(found[1]) + 1} of the surface", text)

    def label(found: re.Match[str]) -> str:
        number = int(found[0])
        return f"({labels[number]})" if number < len(labels) else found[0]

    if "hard stroke" in text:
        text = re.sub(r" in face \d+", "", text)
        text = re.sub(r"(?<=strokes )\d+|(?<=stroke )\d+|(?<= and )\d+", label, text)
    return text + ("; add empties of that index, or change theirs" if is_sum else "")


def _of_polygons(mesh: Any, surface: Surface, vectors: Reals, polygons: Indices | None) -> Reals:
    """(polygons, 3) the direction of each polygon's largest triangle; zero where the surface is not."""
    assert polygons is not None
    directions = np.zeros((int(polygons.max(initial=-1)) + 1, 3))
    order = np.argsort(mesh.face_areas, kind="stable")
    directions[surface.of_part(polygons)[order]] = vectors[order]  # the last one written, the largest, stays
    return directions


def _vertex_normals(mesh: Any, vertices: Indices) -> Reals:
    """(k, 3) unit normals at vertices."""
    if not len(vertices):
        return np.empty((0, 3))
    triangles = np.asarray(mesh.triangles)
    corner_of = np.zeros(mesh.vertex_count, np.int64)
    corner_of[triangles.ravel()] = np.arange(triangles.size)
    corners = corner_of[vertices]
    return normals_at(mesh.vertices, triangles, corners // 3, np.eye(3)[corners % 3])


def _arrows(mesh: Any, field: Any, count: int, length: float, seed: int, progress: Progress) -> SurfaceArrows:
    with progress.stage(0.85, "placing arrows"):
        points = even_points(mesh, count, seed)
        return SurfaceArrows(
            points=points.positions(mesh),
            directions=field.directions(points),
            normals=normals_at(mesh.vertices, mesh.triangles, points.faces, points.barycentric),
            length=length,
        )
