# SPDX-License-Identifier: MIT
"""Meshes and curves as files that other programs read, with what was found on them as attributes."""

from __future__ import annotations

import gzip
import io
import itertools
import os
import re
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._arrays import reals
from saddleback._saddleback import InputError, _write_file

_Path = str | os.PathLike[str]
_Arrays = dict[str, NDArray[Any]]
_COLORS = ("color", "colors")
_PLY_TYPES = {  # of the two names of each, the one that meshio knows as well
    "i1": "int8",
    "u1": "uchar",
    "i2": "int16",
    "u2": "uint16",
    "i4": "int",
    "u4": "uint",
    "f4": "float",
    "f8": "double",
}


class _Surface(NamedTuple):
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int32]


def write_mesh(
    path: _Path,
    mesh: Any,
    attributes: Mapping[str, ArrayLike] | None = None,
    *,
    face_attributes: Mapping[str, ArrayLike] | None = None,
) -> None:
    """Write a mesh as PLY (binary) or OBJ; coordinates come back to the bit.

    An older file is replaced when the new one is whole, and keeps its permissions.

    Parameters
    ----------
    path : str or os.PathLike
        The file: ``.ply`` or ``.obj``, and ``.gz`` behind it to compress it.
    mesh : Mesh, or whatever has vertices and triangles (SplitMesh, DualMesh, CutSurface), or (vertices, triangles)
        Vertices (V, 3), triangles (F, 3).
    attributes : {name: array}, optional
        One value, or row of values, a vertex (V) or a face (F); of vertices where there are as many of both. A PLY
        file holds any, rows as ``name_0``, ``name_1``, ...; ``color`` (3 or 4 of uint8, or of floats from 0 to 1),
        ``normal`` (3) and ``uv`` (2) by the names that other programs look for. An OBJ file holds color, normal and
        uv of vertices, and one array of integers of the faces, as groups.
    face_attributes : {name: array}, optional
        Of faces, whatever there are as many of.

    Raises
    ------
    InputError
        Another extension; a name that is no word or is taken; an array of another length or type; what OBJ cannot hold.
    OSError
        The file cannot be written; what was there before has not changed.

    Notes
    -----
    O(V + F).

    Examples
    --------
    >>> sb.write_mesh("cells.ply", cells.split(), {"cell": cells.split().triangle_cell})  # doctest: +SKIP
    """
    surface = _surface(mesh)
    of_vertices, of_faces = _sorted(surface, attributes or {}, face_attributes or {})
    format_, is_compressed = _format(path)
    write = _ply if format_ == "ply" else _obj
    _save(path, write(surface, of_vertices, of_faces), is_compressed)


def write_curves(path: _Path, curves: Iterable[Any]) -> None:
    """Write polylines as PLY (vertices and edges) or OBJ (lines); coordinates come back to the bit.

    Parameters
    ----------
    path : str or os.PathLike
        The file: ``.ply`` or ``.obj``, and ``.gz`` behind it to compress it.
    curves : iterable of GeodesicPath, VoronoiEdge, or (n, 3) float array
        Those with fewer than two points are left out.

    Raises
    ------
    InputError
        Another extension, or points that are no (n, 3) numbers.
    OSError
        The file cannot be written; what was there before has not changed.

    Notes
    -----
    O(points).
    """
    format_, is_compressed = _format(path)
    lines = []
    for number, curve in enumerate(curves):
        points = reals(getattr(curve, "points", curve), f"curves[{number}]")
        if points.ndim != 2 or points.shape[1] != 3:
            raise InputError(f"curves: wanted (n, 3) points, got {points.shape} at [{number}]")
        if len(points) > 1:
            lines.append(points)
    ends = np.cumsum([0, *(len(line) for line in lines)])
    vertices = np.concatenate([np.zeros((0, 3)), *lines])
    if format_ == "obj":
        text = "".join(map("v {!r} {!r} {!r}\n".format, *vertices.T.tolist())) if len(vertices) else ""
        for begin, end in itertools.pairwise(ends):
            text += "l " + " ".join(map(str, range(begin + 1, end + 1))) + "\n"
        _save(path, text.encode(), is_compressed)
        return
    begins = np.delete(np.arange(len(vertices)), ends[1:] - 1)
    edges = _record({"vertex1": begins.astype("<i4"), "vertex2": (begins + 1).astype("<i4")}, len(begins))
    places = _record(dict(zip("xyz", vertices.T, strict=True)), len(vertices))
    head = _ply_head([("vertex", places, ""), ("edge", edges, "")])
    _save(path, head + places.tobytes() + edges.tobytes(), is_compressed)


def _surface(mesh: Any) -> _Surface:
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        vertices, triangles = mesh.vertices, mesh.triangles
        if hasattr(mesh, "faces") and np.ndim(triangles) == 3:  # of trimesh: places, not indices
            triangles = mesh.faces
    else:
        try:
            vertices, triangles = mesh
        except (TypeError, ValueError):
            raise InputError(f"mesh: wanted a Mesh, or vertices and triangles, got a {type(mesh).__name__}") from None
    surface = _Surface(reals(vertices, "mesh: vertices"), np.asarray(triangles))
    for array, name in ((surface.vertices, "vertices"), (surface.triangles, "triangles")):
        if array.ndim != 2 or array.shape[1] != 3:
            raise InputError(f"mesh: wanted {name} (n, 3), got {array.shape}")
    corners = surface.triangles
    if corners.dtype.kind not in "iu":
        raise InputError(f"mesh: wanted triangles of integers, got {corners.dtype}")
    if len(corners) and not (corners.min() >= 0 and corners.max() < len(surface.vertices)):
        raise InputError(f"mesh: triangles name vertices beyond the {len(surface.vertices)} that there are")
    return _Surface(surface.vertices, corners.astype(np.int32))


def _format(path: _Path) -> tuple[str, bool]:
    """Returns the format that a path's extension names, and whether it is to be compressed."""
    name = os.fspath(path)
    plain = name[:-3] if name.lower().endswith(".gz") else name
    extension = os.path.splitext(plain)[1].lower()
    if extension not in (".ply", ".obj"):
        raise InputError(f'path: {name} has the extension "{extension[1:]}"; wanted ply or obj, or these with .gz')
    return extension[1:], plain != name


def _save(path: _Path, contents: bytes, is_compressed: bool) -> None:
    try:
        _write_file(os.fspath(path), gzip.compress(contents, 6, mtime=0) if is_compressed else contents)
    except InputError as error:
        raise OSError(str(error)) from None


def _sorted(
    surface: _Surface, either: Mapping[str, ArrayLike], faces: Mapping[str, ArrayLike]
) -> tuple[_Arrays, _Arrays]:
    """Returns the attributes of the vertices and those of the faces, checked."""
    counts = len(surface.vertices), len(surface.triangles)
    found: tuple[_Arrays, _Arrays] = {}, {}
    for argument, given in (("attributes", either), ("face_attributes", faces)):
        for name, values in given.items():
            if not re.fullmatch(r"[A-Za-z_][\w.:-]*", name, re.ASCII):
                raise InputError(f"{argument}: {name!r} is no name; wanted a letter, then letters, digits and _ . : -")
            if np.ma.is_masked(values):
                raise InputError(f"{argument}: {name!r} has masked elements")
            array = np.asarray(values)
            if array.ndim not in (1, 2) or array.dtype.kind not in "biuf":
                raise InputError(
                    f"{argument}: {name!r} is {array.dtype} {array.shape}; wanted (n,) or (n, k) numbers or booleans"
                )
            allowed = counts if argument == "attributes" else counts[1:]
            if len(array) not in allowed:
                wanted = f"{counts[0]} for the vertices or {counts[1]} for the faces"
                raise InputError(
                    f"{argument}: {name!r} has {len(array)} rows; wanted "
                    + (wanted if argument == "attributes" else f"{counts[1]}, one a face")
                )
            is_of_faces = argument == "face_attributes" or len(array) != counts[0]
            found[is_of_faces][name] = _plain(name, array)
    return found


def _plain(name: str, array: NDArray[Any]) -> NDArray[Any]:
    """As a type that PLY has: colors of bytes, integers of 32 bits."""
    if name in _COLORS:
        return _bytes_of_colors(name, array)
    if array.dtype.kind == "b":
        return array.astype(np.uint8)
    if array.dtype.kind == "f":
        return array if array.dtype.itemsize == 4 else array.astype(np.float64)
    if array.dtype.itemsize < 8:
        return array
    if array.size and (array.min() < -(2**31) or array.max() >= 2**31):
        raise InputError(f"attributes: {name!r} holds integers of more than 32 bits; files have none")
    return array.astype(np.int32)


def _bytes_of_colors(name: str, array: NDArray[Any]) -> NDArray[np.uint8]:
    if array.ndim != 2 or array.shape[1] not in (3, 4):
        raise InputError(f"attributes: {name!r} is {array.shape}; wanted 3 or 4 values each, red, green, blue, alpha")
    if array.dtype == np.uint8:
        return array
    if array.dtype.kind != "f" or not ((array >= 0) & (array <= 1)).all():
        raise InputError(f"attributes: {name!r}; wanted uint8, or floats from 0 to 1")
    return np.round(array * 255).astype(np.uint8)


def _columns(name: str, array: NDArray[Any]) -> _Arrays:
    """One array for each property, by the names that other programs look for."""
    if array.ndim == 1:
        return {name: array}
    width = array.shape[1]
    if name in _COLORS:
        words: tuple[str, ...] = ("red", "green", "blue", "alpha")
    elif (name, width) in (("normal", 3), ("normals", 3)):
        words = ("nx", "ny", "nz")
    elif (name, width) == ("uv", 2):
        words = ("s", "t")
    else:
        words = tuple(f"{name}_{i}" for i in range(width))
    return dict(zip(words, array.T, strict=False))


def _record(columns: _Arrays, count: int) -> NDArray[Any]:
    """Rows of these columns, least significant byte first."""
    record = np.empty(count, dtype=[(name, array.dtype.newbyteorder("<")) for name, array in columns.items()])
    for name, array in columns.items():
        record[name] = array
    return record


def _with_attributes(columns: _Arrays, attributes: _Arrays) -> _Arrays:
    for name, array in attributes.items():
        for word, column in _columns(name, array).items():
            if word in columns:
                raise InputError(f"attributes: {name!r} would be a second {word!r} in the file; give it another name")
            columns[word] = column
    return columns


def _ply_head(elements: list[tuple[str, NDArray[Any], str]]) -> bytes:
    lines = ["ply", "format binary_little_endian 1.0", "comment written by saddleback"]
    for name, record, corners in elements:
        lines.append(f"element {name} {len(record)}")
        for word in record.dtype.names or ():
            if word == corners:
                lines.append(f"property list uchar int {word}")
            elif word != "count":
                lines.append(f"property {_PLY_TYPES[record.dtype[word].str[1:]]} {word}")
    return "\n".join([*lines, "end_header\n"]).encode()


def _ply(surface: _Surface, of_vertices: _Arrays, of_faces: _Arrays) -> bytes:
    places = dict(zip("xyz", surface.vertices.T, strict=True))
    vertices = _record(_with_attributes(places, of_vertices), len(surface.vertices))
    corners = "vertex_indices"
    # "count" stands for the lists' lengths, which share their property with the corners.
    taken = _with_attributes({"count": np.zeros(0), corners: np.zeros(0)}, of_faces)
    rest = {name: array for name, array in taken.items() if name not in ("count", corners)}
    layout: list[Any] = [("count", "u1"), (corners, "<i4", 3)]
    layout += [(name, array.dtype.newbyteorder("<")) for name, array in rest.items()]
    faces = np.empty(len(surface.triangles), dtype=layout)
    faces["count"], faces[corners] = 3, surface.triangles
    for name, array in rest.items():
        faces[name] = array
    head = _ply_head([("vertex", vertices, ""), ("face", faces, corners)])
    return head + vertices.tobytes() + faces.tobytes()


def _obj(surface: _Surface, of_vertices: _Arrays, of_faces: _Arrays) -> bytes:
    shown = {("color" if name in _COLORS else name): array for name, array in of_vertices.items()}
    shapes = {"color": (3, 4), "normal": (3,), "uv": (2,)}
    for name, array in shown.items():
        if name not in shapes or array.ndim != 2 or array.shape[1] not in shapes[name]:
            raise InputError(f"attributes: an OBJ file holds no {name!r} of vertices; write a PLY file")
    groups = list(of_faces.items())
    if len(groups) > 1 or any(array.ndim != 1 or array.dtype.kind == "f" for _, array in groups):
        raise InputError(
            f"attributes: an OBJ file holds one array of integers of faces, not {', '.join(of_faces)}; write a PLY file"
        )
    text = io.StringIO()
    rows = [surface.vertices] + ([shown["color"][:, :3] / 255] if "color" in shown else [])
    _lines(text, "v", np.column_stack(rows))
    for word, name in (("vt", "uv"), ("vn", "normal")):
        if name in shown:
            _lines(text, word, shown[name].astype(np.float64))
    corner = {(False, False): "{0}", (True, False): "{0}/{0}", (False, True): "{0}//{0}", (True, True): "{0}/{0}/{0}"}[
        "uv" in shown, "normal" in shown
    ]
    face = "f " + " ".join(corner.replace("0", str(i)) for i in range(3)) + "\n"
    kinds = groups[0][1].tolist() if groups else [None] * len(surface.triangles)
    last = None
    for triangle, kind in zip((surface.triangles + 1).tolist(), kinds, strict=True):
        if kind != last:
            text.write(f"g {groups[0][0]}_{kind}\n")
            last = kind
        text.write(face.format(*triangle))
    return text.getvalue().encode()


def _lines(text: io.StringIO, word: str, rows: NDArray[np.float64]) -> None:
    """One line a row, numbers with all digits that tell them apart."""
    line = word + " {!r}" * rows.shape[1] + "\n"
    text.writelines(line.format(*row) for row in rows.tolist())
