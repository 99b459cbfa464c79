"""Shapes and where they lie, as a text file that other programs can read."""

import json
import os
from collections.abc import Sequence
from typing import Any

import numpy as np

from saddleback._saddleback import DirectionField, InputError, Mesh, Placements, Shape, SurfacePoints

_KIND = "saddleback placements"


def write_placements(
    path: str | os.PathLike[str],
    mesh: Mesh,
    shapes: Shape | Sequence[Shape],
    placements: Placements,
    field: DirectionField | None = None,
) -> None:
    """Write shapes and their placements as JSON; numbers come back to the bit.

    Args:
        path: the file.
        mesh: what they lie on; only its size is kept, to tell another mesh.
        shapes: a Shape or several.
        placements: which index them.
        field: what they bend along, if they do.

    Raises
    ------
        OSError: the file cannot be written.
    """
    kinds = [shapes] if isinstance(shapes, Shape) else list(shapes)
    content = {
        "kind": _KIND,
        "vertices": len(mesh.vertices),
        "faces": len(mesh.triangles),
        "shapes": [[[loop.tolist() for loop in part] for part in kind.parts] for kind in kinds],
        "shape": placements.shape.tolist(),
        "face": placements.centre.faces.tolist(),
        "barycentric": placements.centre.barycentric.tolist(),
        "angle": placements.angle.tolist(),
        "scale": placements.scale.tolist(),
        "mirrored": placements.mirrored.tolist(),
    }
    if field is not None:
        content["field"] = {
            "symmetry": field.symmetry,
            "angles": field.angles.tolist(),
            "turns": field.turns.tolist(),
        }
    with open(path, "w", encoding="utf-8") as file:
        json.dump(content, file)


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
    content = _content(path, mesh)
    shapes = [Shape(*parts) for parts in content["shapes"]]
    weights = np.asarray(content["barycentric"], dtype=np.float64).reshape(-1, 3)
    centre = SurfacePoints(np.asarray(content["face"], dtype=np.int32), weights)
    index = np.asarray(content["shape"], dtype=np.int32)
    flags = np.asarray(content["mirrored"], dtype=np.bool_)
    return shapes, Placements(index, centre, content["angle"], content["scale"], flags)


def read_placement_field(path: str | os.PathLike[str], mesh: Mesh) -> DirectionField | None:
    """Read the field that placements bend along, the same to the bit; None if they do not bend.

    Raises
    ------
        InputError: the file is of another kind or for another mesh, or what it says makes no field.
        OSError: the file cannot be read.
    """
    field = _content(path, mesh).get("field")
    if field is None:
        return None
    missing = {"symmetry", "angles", "turns"} - set(field)
    if missing:
        raise InputError(f"{os.fspath(path)}: {min(missing)} of the field is missing")
    return DirectionField.from_turns(mesh, field["angles"], field["turns"], field["symmetry"])


def _content(path: str | os.PathLike[str], mesh: Mesh) -> dict[str, Any]:
    name = os.fspath(path)
    try:
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
    except ValueError as error:
        raise InputError(f"{name}: not a file of placements ({error})") from None
    if not isinstance(content, dict) or content.get("kind") != _KIND:
        raise InputError(f"{name}: not a file of placements")
    missing = {"vertices", "faces", "shapes", "shape", "face", "barycentric", "angle", "scale", "mirrored"} - set(
        content
    )
    if missing:
        raise InputError(f"{name}: {min(missing)} is missing")
    wanted, found = (content["vertices"], content["faces"]), (len(mesh.vertices), len(mesh.triangles))
    if wanted != found:
        raise InputError(
            f"{name}: for a mesh of {wanted[0]} vertices and {wanted[1]} faces, this one has {found[0]} and {found[1]}"
        )
    return content
