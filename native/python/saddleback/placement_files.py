# SPDX-License-Identifier: MIT
"""Shapes and where they lie, as a text file that other programs can read."""

import json
import math
import os
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from saddleback._saddleback import DirectionField, InputError, Mesh, Placements, Shape, SurfacePoints, _write_file

_KIND = "saddleback placements"
_Made = TypeVar("_Made")


def write_placements(
    path: str | os.PathLike[str],
    mesh: Mesh,
    shapes: Shape | Sequence[Shape],
    placements: Placements,
    field: DirectionField | Sequence[DirectionField] | None = None,
) -> None:
    """Write shapes and their placements as JSON; numbers come back to the bit.

    An older file is replaced when the new one is whole, and keeps its permissions.

    Args:
        path: the file.
        mesh: what they lie on; only its size is kept, to tell another mesh.
        shapes: a Shape or several.
        placements: which index them.
        field: what they bend along, if they do; or a sequence, one a shape.

    Raises
    ------
        InputError: a placement of a shape that there is not, or on a face that the mesh does not have.
        OSError: the file cannot be written; what was there before has not changed.
    """
    name = os.fspath(path)
    kinds = [shapes] if isinstance(shapes, Shape) else list(shapes)
    for values, count, what in (
        (placements.shape, len(kinds), "shape"),
        (placements.center.faces, len(mesh.triangles), "face"),
    ):
        if len(values) and values.max() >= count:
            raise InputError(
                f"placements: that at [{values.argmax()}] has {what} {values.max()}, but there are {count}"
            )
    content = {
        "kind": _KIND,
        "vertices": len(mesh.vertices),
        "faces": len(mesh.triangles),
        "shapes": [[[loop.tolist() for loop in part] for part in kind.parts] for kind in kinds],
        "shape": placements.shape.tolist(),
        "face": placements.center.faces.tolist(),
        "barycentric": placements.center.barycentric.tolist(),
        "angle": placements.angle.tolist(),
        "scale": placements.scale.tolist(),
        "mirrored": placements.mirrored.tolist(),
    }
    if isinstance(field, DirectionField):
        content["field"] = _told(field)
    elif field is not None:
        content["field"] = [_told(own) for own in field]
    try:
        _write_file(name, json.dumps(content).encode())
    except InputError as error:
        raise OSError(str(error)) from None


def read_placements(path: str | os.PathLike[str], mesh: Mesh) -> tuple[list[Shape], Placements]:
    """Read what `write_placements` wrote.

    Returns
    -------
        The shapes and the placements.

    Raises
    ------
        InputError: the file is of another kind or for another mesh, or what it says makes no shapes or placements.
        OSError: the file cannot be read.
    """
    content = _Content(path, mesh)
    shapes = content.shapes()
    faces = content.wholes("face", len(mesh.triangles))
    count = len(faces)
    weights = content.reals("barycentric", count, 3)
    center = content.make(lambda: SurfacePoints(faces, weights))
    index = content.wholes("shape", len(shapes), count)
    angle, scale, mirrored = content.reals("angle", count), content.reals("scale", count), content.flags(count)
    return shapes, content.make(lambda: Placements(index, center, angle, scale, mirrored))


def _told(field: DirectionField) -> dict[str, object]:
    return {"symmetry": field.symmetry, "angles": field.angles.tolist(), "turns": field.turns.tolist()}


def read_placement_field(
    path: str | os.PathLike[str], mesh: Mesh
) -> DirectionField | tuple[DirectionField, ...] | None:
    """Read the field that placements bend along, or those of each shape, the same to the bit; None if they do not bend.

    Raises
    ------
        InputError: the file is of another kind or for another mesh, or what it says makes no field.
        OSError: the file cannot be read.
    """
    content = _Content(path, mesh)
    field = content.values.get("field")
    if field is None:
        return None
    if isinstance(field, list):
        return tuple(content.field(own, mesh) for own in field)
    return content.field(field, mesh)


class _Content:
    """Holds what a file of placements says. Whatever is not as it must be is told with its place and value."""

    def __init__(self, path: str | os.PathLike[str], mesh: Mesh) -> None:
        self.name = os.fspath(path)
        try:
            with open(path, encoding="utf-8") as file:
                content = json.load(file)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{self.name}: not a file of placements ({error})") from None
        if not isinstance(content, dict) or content.get("kind") != _KIND:
            raise InputError(f"{self.name}: not a file of placements")
        wanted = {"vertices", "faces", "shapes", "shape", "face", "barycentric", "angle", "scale", "mirrored"}
        if missing := wanted - set(content):
            raise InputError(f"{self.name}: {min(missing)} is missing")
        self.values: dict[str, Any] = content
        sizes = [content["vertices"], content["faces"]]
        for key in ("vertices", "faces"):
            if type(content[key]) is not int:
                raise self.wrong(key, content[key], "a whole number")
        if sizes != [len(mesh.vertices), len(mesh.triangles)]:
            raise InputError(
                f"{self.name}: for a mesh of {sizes[0]} vertices and {sizes[1]} faces, this one has "
                f"{len(mesh.vertices)} and {len(mesh.triangles)}"
            )

    def wrong(self, place: str, value: object, wanted: str) -> InputError:
        """The error for a value that is not as wanted."""
        shown = json.dumps(value) if not isinstance(value, list | dict) else f"a {type(value).__name__}"
        return InputError(f"{self.name}: {place} is {shown[:40]}, wanted {wanted}")

    def make(self, make: Callable[[], _Made]) -> _Made:
        """Returns what the library makes of the values; what it refuses is the file's fault."""
        try:
            return make()
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def field(self, field: object, mesh: Mesh) -> DirectionField:
        """A field, the same to the bit."""
        if not isinstance(field, dict):
            raise self.wrong("field", field, "an object")
        missing = {"symmetry", "angles", "turns"} - set(field)
        if missing:
            raise InputError(f"{self.name}: {min(missing)} of the field is missing")
        self.values |= field
        count, symmetry = len(mesh.triangles), field["symmetry"]
        if type(symmetry) is not int:
            raise self.wrong("symmetry", symmetry, "1, 2 or 4")
        angles, turns = self.reals("angles", count), self.reals("turns", count, 3)
        return self.make(lambda: DirectionField.from_turns(mesh, angles, turns, symmetry))

    def rows(self, place: str, value: object, count: int | None = None) -> list[Any]:
        """A list, of that length if one is given."""
        if not isinstance(value, list):
            raise self.wrong(place, value, "a list")
        if count is not None and len(value) != count:
            raise InputError(f"{self.name}: {place} has length {len(value)}, wanted {count}")
        return value

    def wholes(self, key: str, below: int, count: int | None = None) -> NDArray[np.int32]:
        """Whole numbers from 0 on."""
        values = self.rows(key, self.values[key], count)
        for i, value in enumerate(values):
            if type(value) is not int or not 0 <= value < below:
                raise self.wrong(f"{key}[{i}]", value, f"a whole number from 0 to {below - 1}")
        return np.array(values, dtype=np.int32)

    def flags(self, count: int) -> NDArray[np.bool_]:
        """Tells which placements are mirrored."""
        values = self.rows("mirrored", self.values["mirrored"], count)
        for i, value in enumerate(values):
            if type(value) is not bool:
                raise self.wrong(f"mirrored[{i}]", value, "true or false")
        return np.array(values, dtype=np.bool_)

    def reals(self, key: str, count: int, width: int | None = None) -> NDArray[np.float64]:
        """Numbers, or rows of them."""
        values = self.rows(key, self.values[key], count)
        if width is None:
            return np.array([self.real(f"{key}[{i}]", value) for i, value in enumerate(values)], dtype=np.float64)
        return self.points(key, values, width)

    def points(self, place: str, values: list[Any], width: int) -> NDArray[np.float64]:
        """Rows of numbers."""
        rows = [
            [self.real(f"{place}[{i}][{k}]", x) for k, x in enumerate(self.rows(f"{place}[{i}]", row, width))]
            for i, row in enumerate(values)
        ]
        return np.array(rows, dtype=np.float64).reshape(-1, width)

    def real(self, place: str, value: object) -> float:
        """A number that a double holds."""
        if (type(value) is int and abs(value) < 2**1023) or (type(value) is float and math.isfinite(value)):
            return float(value)
        raise self.wrong(place, value, "a number")

    def shapes(self) -> list[Shape]:
        """Shapes of parts of loops of points."""
        return [self.shape(f"shapes[{i}]", parts) for i, parts in enumerate(self.rows("shapes", self.values["shapes"]))]

    def shape(self, place: str, value: object) -> Shape:
        """One shape."""
        parts = []
        for p, part in enumerate(self.rows(place, value)):
            loops = enumerate(self.rows(f"{place}[{p}]", part))
            parts.append(
                [self.points(f"{place}[{p}][{k}]", self.rows(f"{place}[{p}][{k}]", loop), 2) for k, loop in loops]
            )
        try:
            return Shape(*parts)
        except InputError as error:
            raise InputError(f"{self.name}: {place}: {error}") from None
