# SPDX-License-Identifier: MIT
"""Meshes of other packages in and out; by what their objects have, none of these packages is imported for it."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._saddleback import InputError, Mesh
from saddleback.mesh_files import _COLORS, _sorted, _surface

_Attributes = Mapping[str, ArrayLike] | None


def _missing(value: object, package: str, wanted: str) -> InputError:
    return InputError(f"mesh: wanted {wanted} of {package}, got a {type(value).__name__}")


def from_trimesh(mesh: Any) -> Mesh:
    """Take the vertices and faces of a ``trimesh.Trimesh``, or of whatever has both.

    Raises
    ------
    InputError
        Something else. MeshError: not a valid mesh; ``repair(mesh.vertices, mesh.faces)`` helps.
    """
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "faces")):
        raise _missing(mesh, "trimesh", "a Trimesh")
    return Mesh(mesh.vertices, mesh.faces)


def from_pyvista(mesh: Any) -> Mesh:
    """Take the points and faces of a ``pyvista.PolyData``, or the surface of another of its data sets.

    Polygons become triangles as PyVista makes them. PyVista's own points are float32 unless they were given as float64.

    Raises
    ------
    InputError
        Something else. MeshError: not a valid mesh.
    """
    if not hasattr(mesh, "points") or not (hasattr(mesh, "faces") or hasattr(mesh, "extract_surface")):
        raise _missing(mesh, "pyvista", "a PolyData")
    surface = mesh
    if not hasattr(mesh, "faces"):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # PyVista's, of the algorithm that it will take one day
            surface = mesh.extract_surface()
    if not surface.is_all_triangles:
        surface = surface.triangulate()
    return Mesh(surface.points, np.asarray(surface.faces).reshape(-1, 4)[:, 1:])


def from_meshio(mesh: Any) -> Mesh:
    """Take the points and triangles of a ``meshio.Mesh``; quadrangles are halved, other cells left out.

    Raises
    ------
    InputError
        Something else, or a mesh without triangles. MeshError: not a valid mesh.
    """
    if not (hasattr(mesh, "points") and hasattr(mesh, "cells")):
        raise _missing(mesh, "meshio", "a Mesh")
    blocks: list[NDArray[Any]] = []
    for block in mesh.cells:
        data = np.asarray(block.data)
        if block.type.startswith("triangle"):
            blocks.append(data[:, :3])
        elif block.type == "quad":
            blocks.append(data[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
    if not blocks:
        kinds = ", ".join(sorted({block.type for block in mesh.cells})) or "none"
        raise InputError(f"mesh: wanted triangles or quadrangles, got cells of the kinds: {kinds}")
    points = np.asarray(mesh.points, dtype=np.float64)
    flat = np.zeros((len(points), 3 - points.shape[1]))  # of a mesh in the plane
    return Mesh(np.hstack([points, flat]), np.concatenate(blocks))


def from_open3d(mesh: Any) -> Mesh:
    """Take the vertices and triangles of an ``open3d.geometry.TriangleMesh``, or of one of ``open3d.t.geometry``.

    Raises
    ------
    InputError
        Something else. MeshError: not a valid mesh.
    """
    if hasattr(mesh, "vertex") and hasattr(mesh, "triangle"):
        return Mesh(mesh.vertex.positions.numpy(), mesh.triangle.indices.numpy())
    if not (hasattr(mesh, "vertices") and hasattr(mesh, "triangles")):
        raise _missing(mesh, "open3d", "a TriangleMesh")
    return Mesh(np.asarray(mesh.vertices), np.asarray(mesh.triangles))


def _package(name: str, what: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{what} needs {name}, which is not here ({error}); pip install {name}") from None


def to_trimesh(self: Mesh, attributes: _Attributes = None) -> Any:
    """Make a ``trimesh.Trimesh`` of the same vertices and faces, in their order.

    Parameters
    ----------
    attributes : {name: array}, optional
        As in `write_mesh`; they become ``vertex_attributes`` and ``face_attributes``.

    Raises
    ------
    ImportError
        There is no trimesh. InputError: attributes of another length.
    """
    trimesh = _package("trimesh", "to_trimesh")
    of_vertices, of_faces = _sorted(_surface(self), attributes or {}, {})
    return trimesh.Trimesh(
        np.array(self.vertices),
        np.array(self.triangles),
        process=False,
        vertex_attributes=of_vertices,
        face_attributes=of_faces,
    )


def to_pyvista(self: Mesh, attributes: _Attributes = None) -> Any:
    """Make a ``pyvista.PolyData`` of the same points and faces, in their order.

    Parameters
    ----------
    attributes : {name: array}, optional
        As in `write_mesh`; they become ``point_data`` and ``cell_data``.

    Raises
    ------
    ImportError
        There is no pyvista. InputError: attributes of another length.
    """
    pyvista = _package("pyvista", "to_pyvista")
    of_vertices, of_faces = _sorted(_surface(self), attributes or {}, {})
    surface = pyvista.PolyData.from_regular_faces(np.array(self.vertices), np.array(self.triangles))
    surface.point_data.update(of_vertices)
    surface.cell_data.update(of_faces)
    return surface


def to_meshio(self: Mesh, attributes: _Attributes = None) -> Any:
    """Make a ``meshio.Mesh`` of the same points and triangles, in their order.

    Parameters
    ----------
    attributes : {name: array}, optional
        As in `write_mesh`; they become ``point_data`` and ``cell_data``.

    Raises
    ------
    ImportError
        There is no meshio. InputError: attributes of another length.
    """
    meshio = _package("meshio", "to_meshio")
    of_vertices, of_faces = _sorted(_surface(self), attributes or {}, {})
    return meshio.Mesh(
        np.array(self.vertices),
        [("triangle", np.array(self.triangles))],
        point_data=of_vertices,
        cell_data={name: [array] for name, array in of_faces.items()},
    )


def to_open3d(self: Mesh, attributes: _Attributes = None) -> Any:
    """Make an ``open3d.geometry.TriangleMesh`` of the same vertices and triangles, in their order.

    Parameters
    ----------
    attributes : {name: array}, optional
        As in `write_mesh`; it holds ``color`` and ``normal`` of the vertices.

    Raises
    ------
    ImportError
        There is no open3d. InputError: other attributes, or of another length.
    """
    open3d = _package("open3d", "to_open3d")
    of_vertices, of_faces = _sorted(_surface(self), attributes or {}, {})
    made = open3d.geometry.TriangleMesh(
        open3d.utility.Vector3dVector(np.array(self.vertices)), open3d.utility.Vector3iVector(np.array(self.triangles))
    )
    for name, array in (of_vertices | of_faces).items():
        if name in of_faces or name not in (*_COLORS, "normal"):
            raise InputError(f"attributes: a TriangleMesh holds color and normal of vertices, not {name!r}")
        if name == "normal":
            made.vertex_normals = open3d.utility.Vector3dVector(array.astype(np.float64))
        else:
            made.vertex_colors = open3d.utility.Vector3dVector(array[:, :3] / 255)
    return made


for _take in (from_trimesh, from_pyvista, from_meshio, from_open3d):
    setattr(Mesh, _take.__name__, staticmethod(_take))
for _make in (to_trimesh, to_pyvista, to_meshio, to_open3d):
    setattr(Mesh, _make.__name__, _make)
