# SPDX-License-Identifier: MIT
"""Meshes, cells, fields and placements in a window or a picture, by PyVista or Polyscope; curves by matplotlib."""

from __future__ import annotations

import itertools
import os
import sys
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from saddleback._conversions import _package
from saddleback._saddleback import (
    CentroidalVoronoi,
    CutSurface,
    DirectionField,
    Distribution,
    DualMesh,
    Error,
    GeodesicPath,
    GeodesicVoronoi,
    InputError,
    Mesh,
    Quality,
    Relaxation2d,
    SaddleVertexGraph,
    SplitMesh,
    SurfacePoints,
    SweepCircle,
    VoronoiEdge,
)
from saddleback.mesh_files import _sorted, _Surface
from saddleback.quality_plot import _COLORS, _PANELS, _values


class _Scene(NamedTuple):
    """What is to be drawn, whichever package draws it."""

    surfaces: list[tuple[str, _Surface, dict[str, NDArray[Any]], dict[str, NDArray[Any]]]]
    curves: list[tuple[str, list[NDArray[np.float64]]]]
    points: list[tuple[str, NDArray[np.float64]]]
    arrows: list[tuple[str, NDArray[np.float64], NDArray[np.float64], float]]

    def add_surface(self, name: str, mesh: Any, **of_faces: NDArray[Any]) -> None:
        surface = _Surface(np.array(mesh.vertices), np.array(mesh.triangles))
        self.surfaces.append((name, surface, {}, of_faces))


def show(
    *things: Any,
    mesh: Mesh | None = None,
    attributes: Mapping[str, ArrayLike] | None = None,
    backend: str = "auto",
    picture: str | os.PathLike[str] | None = None,
    is_shown: bool = True,
) -> Any:
    """Show results in a window, or in the notebook: by PyVista, else by Polyscope, whichever is there.

    Parameters
    ----------
    *things
        Mesh (or SaddleVertexGraph: its mesh), GeodesicVoronoi or CentroidalVoronoi (colored cells and their edges),
        DualMesh, SplitMesh, CutSurface, DirectionField (arrows), Distribution (the surface and the copies on it),
        GeodesicPath, VoronoiEdge, SurfacePoints.
    mesh : Mesh, optional
        The mesh that SurfacePoints and DirectionField are on; it is shown as well.
    attributes : {name: array}, optional
        Of the mesh's vertices or faces, as in `write_mesh`: it is colored by the first.
    backend : str
        "pyvista", "polyscope" or "auto".
    picture : str or os.PathLike, optional
        Write this picture (png) instead of opening a window.
    is_shown : bool
        False: only make the scene.

    Returns
    -------
    pyvista.Plotter, or the module polyscope
        With the scene, to be changed further.

    Raises
    ------
    InputError
        Something that cannot be shown, or not without its mesh; another backend.
    ImportError
        There is no such package.
    Error
        PyVista's VTK finds nothing to draw with: on a Linux without a display that is libEGL.
    """
    scene = _Scene([], [], [], [])
    if mesh is not None:
        scene.add_surface("mesh", mesh)
    for number, thing in enumerate(things):
        _add(scene, thing, mesh, "" if len(things) == 1 else f" {number}")
    if attributes:
        if not scene.surfaces:
            raise InputError("attributes: there is no mesh to show them on")
        name, surface, _, of_faces = scene.surfaces[0]
        of_vertices, more = _sorted(surface, attributes, {})
        scene.surfaces[0] = (name, surface, of_vertices, more | of_faces)
    if backend not in ("auto", "pyvista", "polyscope"):
        raise InputError(f'backend: wanted "auto", "pyvista" or "polyscope", got {backend!r}')
    if backend == "polyscope":
        return _by_polyscope(scene, picture, is_shown)
    try:
        return _by_pyvista(scene, picture, is_shown)
    except ImportError:
        if backend == "pyvista":
            raise
        return _by_polyscope(scene, picture, is_shown)


def _add(scene: _Scene, thing: Any, mesh: Mesh | None, mark: str) -> None:
    if isinstance(thing, CentroidalVoronoi):
        thing = thing.cells
    if isinstance(thing, SaddleVertexGraph):
        thing = thing.mesh
    if isinstance(thing, GeodesicVoronoi):
        split = thing.split()
        scene.add_surface(f"cells{mark}", split, cell=split.triangle_cell)
        scene.curves.append((f"edges{mark}", [edge.points for edge in thing.edges]))
    elif isinstance(thing, Distribution):
        cut = thing.mapped.cut()
        scene.add_surface(f"copies{mark}", cut, copy=cut.triangle_shape)
        loops = [np.vstack([loop, loop[:1]]) for i in range(len(thing)) for loop in thing.outline(i)]
        scene.curves.append((f"outlines{mark}", loops))
    elif isinstance(thing, Mesh | DualMesh | SplitMesh | CutSurface):
        scene.add_surface(f"{type(thing).__name__}{mark}", thing)
    elif isinstance(thing, GeodesicPath | VoronoiEdge):
        scene.curves.append((f"curve{mark}", [thing.points]))
    elif isinstance(thing, SurfacePoints | DirectionField):
        if mesh is None:
            raise InputError(f"mesh: a {type(thing).__name__} is shown on its mesh; give it as mesh=")
        if isinstance(thing, SurfacePoints):
            scene.points.append((f"points{mark}", thing.positions(mesh)))
        else:
            centers = mesh.vertices[mesh.triangles].mean(axis=1)
            scene.arrows.append((f"field{mark}", centers, thing.vectors, 0.6 * mesh.mean_edge_length))
    else:
        raise InputError(f"things: a {type(thing).__name__} cannot be shown")


def _can_vtk_draw() -> bool:
    """Without a display VTK dies by a signal unless it finds one of these libraries or brings its own."""
    if sys.platform != "linux" or os.environ.get("DISPLAY"):
        return True
    import ctypes
    import importlib.metadata  # slow, and not wanted for what does not draw

    for name in ("libEGL.so.1", "libOSMesa.so.8"):
        try:
            ctypes.CDLL(name)
        except OSError:
            continue
        return True
    return any(found.name == "vtk-osmesa" for found in importlib.metadata.distributions())


def _by_pyvista(scene: _Scene, picture: Any, is_shown: bool) -> Any:
    pyvista = _package("pyvista", "show")
    if not _can_vtk_draw():
        raise Error("there is no display, and no libEGL to draw without one: install it (libegl1), or PyVista crashes")
    plotter = pyvista.Plotter(off_screen=picture is not None or not is_shown)
    for name, surface, of_vertices, of_faces in scene.surfaces:
        data = pyvista.PolyData.from_regular_faces(surface.vertices, surface.triangles)
        data.point_data.update(of_vertices)
        data.cell_data.update(of_faces)
        first = next(iter(of_vertices | of_faces), None)
        colors = {"cmap": "tab20"} if first in ("cell", "copy") else {}
        plotter.add_mesh(data, name=name, scalars=first, color=None if first else "lightgray", **colors)
    for name, curves in scene.curves:
        lines = [curve for curve in curves if len(curve) > 1]
        if lines:
            ends = np.cumsum([0, *map(len, lines)])
            cells = [np.concatenate([[b - a], np.arange(a, b)]) for a, b in itertools.pairwise(ends)]
            data = pyvista.PolyData(np.concatenate(lines), lines=np.concatenate(cells))
            plotter.add_mesh(data, name=name, color="black", line_width=3)
    for name, places in scene.points:
        plotter.add_mesh(pyvista.PolyData(places), name=name, color="red", point_size=10, render_points_as_spheres=True)
    for name, places, vectors, length in scene.arrows:
        plotter.add_arrows(places, vectors, mag=length, name=name, color="black")
    if picture is not None:
        plotter.screenshot(os.fspath(picture))
    elif is_shown:
        plotter.show()
    return plotter


def _by_polyscope(scene: _Scene, picture: Any, is_shown: bool) -> Any:
    polyscope = _package("polyscope", "show")
    if not polyscope.is_initialized():
        polyscope.set_use_prefs_file(False)  # or it writes two files into whatever folder one is in
        polyscope.init()
    polyscope.remove_all_structures()
    for name, surface, of_vertices, of_faces in scene.surfaces:
        shown = polyscope.register_surface_mesh(name, surface.vertices, surface.triangles)
        for place, attributes in (("vertices", of_vertices), ("faces", of_faces)):
            for word, values in attributes.items():
                is_color = values.ndim == 2 and values.dtype == np.uint8
                if is_color:
                    shown.add_color_quantity(word, values[:, :3] / 255, defined_on=place, enabled=True)
                elif values.ndim == 1:
                    kind = {"datatype": "categorical"} if word in ("cell", "copy") else {}
                    shown.add_scalar_quantity(word, values.astype(float), defined_on=place, enabled=True, **kind)
    for name, curves in scene.curves:
        lines = [curve for curve in curves if len(curve) > 1]
        if lines:
            ends = np.cumsum([0, *map(len, lines)])
            begins = np.delete(np.arange(ends[-1]), ends[1:] - 1)
            polyscope.register_curve_network(name, np.concatenate(lines), np.column_stack([begins, begins + 1]))
    for name, places in scene.points:
        polyscope.register_point_cloud(name, places)
    for name, places, vectors, _ in scene.arrows:
        polyscope.register_point_cloud(name, places, radius=0).add_vector_quantity("direction", vectors, enabled=True)
    if picture is not None:
        polyscope.screenshot(os.fspath(picture))
    elif is_shown:
        polyscope.show()
    return polyscope


def plot(result: Any, axes: Any = None) -> Any:
    """Draw a result's numbers by matplotlib.

    Parameters
    ----------
    result : Quality, CentroidalVoronoi, Relaxation2d or SweepCircle
        The shares of the triangles' qualities; the energy by iteration; how far the circle and its beach curve have
        grown.
    axes : matplotlib.axes.Axes, optional
        Where to draw; else new ones.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    InputError
        Another result.
    ImportError
        There is no matplotlib.
    """
    if not isinstance(result, Quality | CentroidalVoronoi | Relaxation2d | SweepCircle):
        raise InputError(f"result: a {type(result).__name__} cannot be plotted")
    if axes is None:
        _, axes = _package("matplotlib.pyplot", "plot").subplots()
    if isinstance(result, Quality):
        panel = _PANELS[0]
        axes.stairs(panel.shares(_values(result, 0)), panel.edges, fill=True, color=_COLORS[0], alpha=0.5)
        axes.set(xlabel="quality of triangles", ylabel="share")
    elif isinstance(result, SweepCircle):
        _plot_sweep(result, axes)
    else:
        axes.plot(result.energy, color=_COLORS[0])
        axes.set(xlabel="iteration", ylabel="energy", yscale="log")
    return axes


def _plot_sweep(sweep: SweepCircle, axes: Any) -> None:
    (x, y), around = sweep.center, np.linspace(0, 2 * np.pi, 200)
    axes.plot(x + sweep.radius * np.cos(around), y + sweep.radius * np.sin(around), color=_COLORS[1])
    axes.plot(*sweep.beach_curve(500).T, color=_COLORS[0])
    for line in _pieces(sweep):
        axes.plot(*line.T, color=_COLORS[6], linewidth=0.8)
    axes.set_aspect("equal")


def _pieces(sweep: SweepCircle) -> Iterable[NDArray[np.float64]]:
    return sweep.edge_polylines(max(sweep.radius, 1e-300) * 1e-3)
