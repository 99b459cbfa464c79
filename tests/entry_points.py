# SPDX-License-Identifier: MIT
"""Asks every public entry point, one forked child for each question: `python -m tests.entry_points [PATTERN]`.

In a child that a process forks after parallel calls; with threads=100000; with 200, 300 and 500 MB of memory left; and
with Ctrl-C at random moments of those calls that take longer than its answer may. A result or an exception of ours is
right, a signal, a hang or another exception is not. The mesh is an icosphere of --size subdivisions.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import fnmatch
import functools
import io
import operator
import os
import random
import signal
import struct
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

import saddleback as sb
from tests import meshes
from tests.truth.table import entry_points

Call = Callable[..., object]
MEMORY = (200, 300, 500)  # megabytes beyond what the process has
ANSWER = 0.2  # seconds from Ctrl-C to KeyboardInterrupt
PATIENCE = 120  # seconds, after which a child counts as hung
PLACES = [(0.1, 0.2)]
SOLID = (np.array([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.1]]), [[0, 1, 2]])
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
OURS = (sb.Error, MemoryError)
prepared: dict[str, Call] = {}


def is_made_by_calls(name: str) -> bool:
    """Whether it is a class of results: nobody constructs those, which has a test of its own."""
    made = operator.attrgetter(name)(sb)
    if not isinstance(made, type):
        return False
    try:
        made()
    except TypeError as error:
        return "is made by the calls that return one" in str(error)
    except sb.Error:
        pass
    return False


class Inputs:
    """What the calls are about, each made when a call first asks for it."""

    def __init__(self, size: int, folder: Path) -> None:
        self.folder = folder
        self.vertices, self.triangles = meshes.icosphere(size)
        self.mesh = sb.Mesh(self.vertices, self.triangles)
        self.count = len(self.vertices)
        rng = np.random.default_rng(1)
        self.few = np.arange(0, self.count, self.count // 20, dtype=np.int32)
        self.sites = rng.random((self.count, 2))
        self.centers = rng.random((9, 2))
        self.cell_of_triangle = (self.vertices[self.triangles].mean(axis=1)[:, 0] > 0.1).astype(np.int32)
        self.shape, self.star = sb.Shape.disk(), sb.Shape.star()
        self.scale = 0.1

    @functools.cached_property
    def graph(self) -> sb.SaddleVertexGraph:
        return sb.SaddleVertexGraph(self.mesh, threads=2)

    @functools.cached_property
    def parts(self) -> list[bytes]:
        return [sb.find_arcs(self.mesh, part, 2, threads=2) for part in range(2)]

    @functools.cached_property
    def across(self) -> list[bytes]:
        return [sb.arcs_across(self.parts[1], 0)]

    @functools.cached_property
    def corners(self) -> Any:
        """A place in a UV map for each corner of a triangle: squares side by side, two triangles in each."""
        side = int(np.ceil(np.sqrt(self.mesh.face_count / 2)))
        number = np.arange(self.mesh.face_count)
        square = np.stack([number // 2 % side, number // 2 // side], axis=1)
        half = np.array([[(0.1, 0.1), (0.8, 0.1), (0.1, 0.8)], [(0.9, 0.9), (0.2, 0.9), (0.9, 0.2)]])
        return ((square[:, None] + half[number % 2]) / side).reshape(-1, 2)

    @functools.cached_property
    def disk(self) -> sb.Mesh:
        side = int(np.sqrt(self.count))
        return sb.Mesh(*meshes.grid(side, side, jitter=0.3))

    @functools.cached_property
    def uv(self) -> np.ndarray:
        return sb.harmonic_map(self.disk)

    @functools.cached_property
    def chart(self) -> sb.Chart:
        return sb.Chart(self.disk, self.uv)

    @functools.cached_property
    def patches(self) -> sb.SuperPatches:
        return sb.super_patches(self.mesh, 60, threads=2)

    @functools.cached_property
    def cells(self) -> sb.GeodesicVoronoi:
        return sb.geodesic_voronoi(self.graph, self.few)

    @functools.cached_property
    def diagram(self) -> sb.Voronoi2d:
        return sb.voronoi_2d(self.sites)

    @functools.cached_property
    def lifted(self) -> sb.LiftedVoronoi:
        return self.chart.lift(sb.voronoi_2d(self.sites[:500]))

    @functools.cached_property
    def points(self) -> sb.SurfacePoints:
        return sb.sample(self.mesh, 500)

    @functools.cached_property
    def field(self) -> sb.DirectionField:
        return sb.direction_field(self.mesh, 1)

    @functools.cached_property
    def lines(self) -> sb.DirectionField:
        return sb.direction_field(self.mesh, 2)

    @functools.cached_property
    def curve(self) -> sb.SurfaceCurve:
        return sb.SurfaceCurve(self.mesh, self.graph.path(0, self.count // 2).surface)

    @functools.cached_property
    def barred(self) -> sb.BarredMesh:
        return sb.add_barriers(self.mesh, edges=self.mesh.edges[::7], curves=[self.curve])

    @functools.cached_property
    def barred_cells(self) -> sb.GeodesicVoronoi:
        mesh = self.barred.mesh
        return sb.geodesic_voronoi(
            sb.SaddleVertexGraph(mesh, threads=2), sb.sample(mesh, mesh.component_count + 20, one_per_component=True)
        )

    @functools.cached_property
    def curve_points(self) -> Any:
        return self.curve.points.positions(self.mesh)

    @functools.cached_property
    def poly_data(self) -> Any:
        """What a PolyData has."""
        faces = np.column_stack([np.full(len(self.triangles), 3), self.triangles]).ravel()
        return SimpleNamespace(points=self.vertices, faces=faces, is_all_triangles=True)

    @functools.cached_property
    def exact(self) -> sb.ExactField:
        return sb.ExactField(self.mesh, [0])

    @functools.cached_property
    def laid(self) -> sb.Distribution:
        return sb.distribute(self.mesh, self.star, 200, field=self.field, size=self.scale)

    @functools.cached_property
    def bent(self) -> sb.BentCopies:
        return self.laid.mapped.bend([SOLID])

    @functools.cached_property
    def table(self) -> sb.SafeDistanceTable:
        return sb.SafeDistanceTable(self.star, self.shape)

    @functools.cached_property
    def saved(self) -> str:
        path = str(self.folder / "saved.graph")
        self.graph.save(path)
        return path

    @functools.cached_property
    def obj(self) -> str:
        path = self.folder / "mesh.obj"
        lines = ["v {} {} {}".format(*vertex) for vertex in self.vertices]
        lines += ["f {} {} {}".format(*corners) for corners in self.triangles + 1]
        path.write_text("\n".join(lines), encoding="utf-8")
        return str(path)

    @functools.cached_property
    def written(self) -> str:
        path = str(self.folder / "laid.json")
        sb.write_placements(path, self.mesh, [self.star], self.laid.placements, field=self.field)
        return path

    def sweep(self) -> sb.SweepCircle:
        return sb.SweepCircle(self.sites[:3000], (0.5, 0.5))

    def sweeps(self) -> sb.SweepCircles:
        return sb.SweepCircles(self.sites[:3000], self.centers)


def if_installed(call: Call) -> object:
    """What a call gives that needs a package of others, or nothing without it."""
    with contextlib.suppress(ImportError):
        return call()
    return None


def grown(sweep: Any) -> Any:
    """A sweep that has come some way."""
    sweep.grow(0.2)
    return sweep


def calls(at: Inputs) -> dict[str, Call]:
    """A call for every entry point; those that have threads take them."""
    inner = sb.SurfacePoints(at.points.faces[:1], at.points.barycentric[:1])
    fields = np.column_stack([at.vertices, at.vertices[:, 0]])
    heights = np.column_stack([at.vertices, np.zeros(at.count)])
    image = np.pad(np.ones((200, 200), bool), 9)
    grid = sb.Mesh(at.vertices * 1.01, at.triangles)
    quality = sb.triangle_quality(at.vertices, at.triangles)
    distances = np.linalg.norm(at.vertices[:, None] - at.vertices[at.few][None], axis=2)
    return {
        "BentCopies.positions": lambda: at.bent.positions(at.mesh),
        "CellCache": sb.CellCache,
        "CellCache.clear": lambda: sb.CellCache().clear(),
        "Chart": lambda: sb.Chart(at.disk, at.uv),
        "Chart.locate": lambda **more: at.chart.locate(at.uv * 0.9, **more),
        "Chart.places": lambda: at.chart.places(sb.sample(at.disk, 500)),
        "Chart.lift": lambda **more: at.chart.lift(sb.voronoi_2d(at.sites[:500]), **more),
        "ConformedPoints.positions": lambda: at.laid.mapped.conform(PLACES, 0).positions(at.mesh),
        "DensityMatch": lambda: sb.DensityMatch(0.5, np.ones(9), np.ones(9, np.int64)),
        "Device": lambda: sb.Device("cpu", "one", 1, 0, None, 0),
        "DeviceArray.numpy": lambda: sb.voronoi_2d_on_device(at.sites).triangles.numpy(),
        "DirectionField.from_vectors": lambda: sb.DirectionField.from_vectors(at.mesh, at.field.vectors),
        "DirectionField.from_turns": lambda: sb.DirectionField.from_turns(at.mesh, at.field.angles, at.field.turns),
        "DirectionField.directions": lambda: at.field.directions(at.points),
        "DirectionField.turned": lambda: at.field.turned(0.3),
        "DirectionFieldEditor": lambda: sb.DirectionFieldEditor(at.mesh, 2),
        "DirectionFieldEditor.field": lambda: sb.DirectionFieldEditor(at.mesh, 1).field({0: 1, 9: 1}),
        "Distribution.outline": lambda: at.laid.outline(0),
        "Distribution.conform": lambda: at.laid.conform(PLACES, 0),
        "ExactField": lambda: sb.ExactField(at.mesh, at.few),
        "ExactField.distance_to": lambda: at.exact.distance_to(at.points),
        "ExactField.path": lambda: at.exact.path(at.count // 2),
        "ExactField.paths": lambda: at.exact.paths(at.few),
        "GeodesicVoronoi.corners": lambda: at.cells.corners(0),
        "GeodesicVoronoi.dual_paths": lambda **more: at.cells.dual_paths(**more),
        "GeodesicVoronoi.centers": lambda **more: at.cells.centers(**more),
        "GeodesicVoronoi.dual": lambda **more: at.cells.dual(**more),
        "GeodesicVoronoi.polygons": lambda **more: at.cells.polygons(**more),
        "CellPolygons.triangles": lambda: at.cells.polygons().triangles(),
        "DualMesh.quads": lambda: at.cells.dual().quads(),
        "GeodesicVoronoi.cells_at": lambda: at.cells.cells_at(at.points),
        "GeodesicVoronoi.locate": lambda: at.cells.locate(at.points),
        "GeodesicVoronoi.split": lambda: at.cells.split(),
        "Job": sb.Job,
        "Job.cancel": lambda: sb.Job().cancel(),
        "Job.part": lambda: sb.Job().part(0.25, 0.5),
        "Job.update": lambda: sb.Job().update(0.5),
        "LiftedVoronoi.locate": lambda: at.lifted.locate(sb.sample(at.disk, 500)),
        "LiftedVoronoi.split": lambda: at.lifted.split(),
        "MappedShapes.outline": lambda: at.laid.mapped.outline(0),
        "MappedShapes.outline_surface": lambda: at.laid.mapped.outline_surface(0),
        "MappedShapes.conform": lambda: at.laid.mapped.conform(PLACES, 0),
        "MappedShapes.bend": lambda **more: at.laid.mapped.bend([SOLID], 1e-3, **more),
        "MappedShapes.patch": lambda: at.laid.mapped.patch(0),
        "MappedShapes.patches": lambda: at.laid.mapped.patches(),
        "MappedShapes.cut": lambda: at.laid.mapped.cut(),
        "MappedShapes.attributes": lambda **more: at.laid.mapped.attributes(0.1, **more),
        "MappedShapes.frames": lambda: at.laid.mapped.frames(),
        "Mesh": lambda: sb.Mesh(at.vertices, at.triangles),
        "Mesh.from_meshio": lambda: sb.Mesh.from_meshio(at.mesh.to_meshio()),
        "Mesh.from_open3d": lambda: sb.Mesh.from_open3d(at.mesh),
        "Mesh.from_pyvista": lambda: sb.Mesh.from_pyvista(at.poly_data),
        "Mesh.from_trimesh": lambda: sb.Mesh.from_trimesh(at.mesh.to_trimesh()),
        "Mesh.to_meshio": lambda: at.mesh.to_meshio({"x": at.vertices[:, 0]}),
        "Mesh.to_open3d": lambda: if_installed(at.mesh.to_open3d),
        "Mesh.to_pyvista": lambda: if_installed(at.mesh.to_pyvista),
        "Mesh.to_trimesh": lambda: at.mesh.to_trimesh({"x": at.vertices[:, 0]}),
        "Placements": lambda: sb.Placements([0], inner, [0.0], [1.0]),
        "RelaxationWatch": sb.RelaxationWatch,
        "RelaxationWatch.latest": lambda: sb.RelaxationWatch().latest(),
        "SaddleVertexGraph": lambda **more: sb.SaddleVertexGraph(at.mesh, **more),
        "SaddleVertexGraph.save": lambda: at.graph.save(str(at.folder / f"{os.getpid()}.graph")),
        "SaddleVertexGraph.load": lambda: sb.SaddleVertexGraph.load(at.saved, at.mesh),
        "SaddleVertexGraph.check": lambda: sb.SaddleVertexGraph.load(at.saved, at.mesh, mmap=True).check(),
        "SaddleVertexGraph.from_parts": lambda **more: sb.SaddleVertexGraph.from_parts(at.mesh, at.parts, **more),
        "find_arcs": lambda **more: sb.find_arcs(at.mesh, 1, 3, **more),
        "BarredMesh.least": lambda: at.barred.least(at.barred.mesh.vertices[:, 0]),
        "BarredMesh.least_copies": lambda: at.barred.least_copies(at.barred.mesh.vertices[:, 0]),
        "BarredMesh.polygons": lambda: at.barred.polygons(at.barred_cells),
        "BarredMesh.to_barred": lambda: at.barred.to_barred(at.points[:100]),
        "BarredMesh.to_whole": lambda: at.barred.to_whole(np.arange(100, dtype=np.int32)),
        "BarredMesh.values_to_barred": lambda: at.barred.values_to_barred(at.vertices[:, 0]),
        "add_barriers": lambda: sb.add_barriers(at.mesh, edges=at.mesh.edges[::7], curves=[at.curve]),
        "anisotropic_metric": lambda: sb.anisotropic_metric(at.mesh, at.lines, 2),
        "curvature_metric": lambda: sb.curvature_metric(at.mesh),
        "arcs_across": lambda: sb.arcs_across(at.parts[0], 1),
        "unite_arcs": lambda **more: sb.unite_arcs(at.parts[0], at.across, **more),
        "SaddleVertexGraph.arcs": lambda: at.graph.arcs(),
        "SaddleVertexGraph.neighbors": lambda: at.graph.neighbors(7),
        "SaddleVertexGraph.distances": lambda: at.graph.distances(at.few),
        "SaddleVertexGraph.nearest": lambda: at.graph.nearest(at.few),
        "SaddleVertexGraph.fields": lambda **more: at.graph.fields(at.few, **more),
        "SaddleVertexGraph.distance": lambda: at.graph.distance(0, at.count // 2),
        "SaddleVertexGraph.distances_to": lambda: at.graph.distances_to(inner, at.points),
        "SaddleVertexGraph.path": lambda: at.graph.path(0, at.count // 2, shorten=True),
        "SaddleVertexGraph.paths": lambda **more: at.graph.paths(at.few, at.few[::-1].copy(), **more),
        "SaddleVertexGraph.log_map": lambda: at.graph.log_map(0, 1.0),
        "SafeDistanceTable": lambda **more: sb.SafeDistanceTable(at.star, at.shape, **more),
        "SafeDistanceTable.distance": lambda: at.table.distance(0.1, 0.2),
        "Shape": lambda: sb.Shape(SQUARE),
        "Shape.from_mask": lambda: sb.Shape.from_mask(image),
        "Shape.contains": lambda: at.star.contains(at.sites),
        "Shape.moved": lambda: at.star.moved(2.0, 0.3, (1.0, 0.0)),
        "Shape.overlaps": lambda: at.star.overlaps(at.shape),
        "Shape.mirrored": lambda: at.star.mirrored(),
        "Shape.centered": lambda: at.star.centered(),
        "Shape.disk": sb.Shape.disk,
        "Shape.star": sb.Shape.star,
        "Shape.needle": sb.Shape.needle,
        "Shape.leaf": sb.Shape.leaf,
        "Shape.drop": sb.Shape.drop,
        "Shape.crescent": sb.Shape.crescent,
        "Stroke": lambda: sb.Stroke(at.curve),
        "SurfaceCurve": lambda: sb.SurfaceCurve(at.mesh, at.graph.path(0, 9).surface),
        "SurfacePoints": lambda: sb.SurfacePoints(at.points.faces, at.points.barycentric),
        "SurfacePoints.positions": lambda: at.points.positions(at.mesh),
        "SweepCircle": at.sweep,
        "SweepCircle.step": lambda: at.sweep().step(),
        "SweepCircle.grow": lambda: at.sweep().grow(2.0),
        "SweepCircle.beach_curve": lambda: grown(at.sweep()).beach_curve(500),
        "SweepCircle.edge_polylines": lambda: grown(at.sweep()).edge_polylines(1e-3),
        "SweepCircles": at.sweeps,
        "SweepCircles.step": lambda: at.sweeps().step(),
        "SweepCircles.grow": lambda: at.sweeps().grow(2.0),
        "SweepCircles.arcs": lambda: grown(at.sweeps()).arcs(0),
        "SweepCircles.beach_curve": lambda: grown(at.sweeps()).beach_curve(0, 500),
        "SweepCircles.edges": lambda: grown(at.sweeps()).edges(0),
        "SweepCircles.edge_polylines": lambda: grown(at.sweeps()).edge_polylines(0, 1e-3),
        "Voronoi2d.cell_vertices": lambda: at.diagram.cell_vertices(9),
        "Voronoi2d.cell_edges": lambda: at.diagram.cell_edges(9),
        "Voronoi2d.edge_polyline": lambda: at.diagram.edge_polyline(9, 1e-3),
        "Voronoi2d.clip": lambda **more: at.diagram.clip(SQUARE, **more),
        "Voronoi2d.locate": lambda **more: at.diagram.locate(at.sites, **more),
        "bake_cells": lambda **more: sb.bake_cells(at.cells, at.corners, size=(256, 256), **more),
        "blend_by_distance": lambda: sb.blend_by_distance(distances.T, at.few),
        "border_edges": lambda: sb.border_edges(at.triangles, at.count),
        "cell_boundary": lambda: sb.cell_boundary(at.triangles, at.cell_of_triangle, at.count),
        "cell_boundary_distance": lambda: sb.cell_boundary_distance(at.vertices, at.triangles, at.cell_of_triangle),
        "centroidal_voronoi": lambda **more: sb.centroidal_voronoi(at.graph, count=50, max_iterations=20, **more),
        "check_distribution": lambda **more: sb.check_distribution(at.mesh, at.laid, **more),
        "connected_parts": lambda: sb.connected_parts(at.triangles, at.count),
        "cuda_status": sb.cuda_status,
        "cut_at_level": lambda: sb.cut_at_level(fields, at.triangles, 3, 0.1),
        "density_by_curvature": lambda: sb.density_by_curvature(at.mesh),
        "density_match": lambda: sb.density_match(at.mesh, at.laid.placements, np.ones(at.count), cells=20),
        "devices": sb.devices,
        "direction_field": lambda: sb.direction_field(at.mesh, 4),
        "distribute": lambda **more: sb.distribute(at.mesh, at.star, size=at.scale, maximal=True, **more),
        "exact_distances": lambda: sb.exact_distances(at.mesh, at.few),
        "exact_nearest": lambda: sb.exact_nearest(at.mesh, at.few),
        "exp_map": lambda **more: sb.exp_map(at.mesh, 0, at.sites, **more),
        "feature_curves": lambda: sb.feature_curves(at.mesh, 0.01),
        "bezier_curve": lambda: sb.bezier_curve(at.graph, at.few[:3]),
        "curve_through": lambda: sb.curve_through(at.graph, at.few[:3], smooth=True),
        "shorten_curve": lambda: sb.shorten_curve(at.curve),
        "geodesic_center": lambda: sb.geodesic_center(at.graph, inner),
        "geodesic_voronoi": lambda **more: sb.geodesic_voronoi(at.graph, at.few, exact=True, **more),
        "harmonic_map": lambda: sb.harmonic_map(at.disk),
        "hausdorff_distance": lambda **more: sb.hausdorff_distance(at.mesh, grid, 1e-3, **more),
        "limit_device_memory": lambda: sb.limit_device_memory(0),
        "map_shapes": lambda **more: sb.map_shapes(at.mesh, at.star, at.laid.placements, **more),
        "plot": lambda: if_installed(lambda: sb.plot(quality)),
        "polar_coordinates": lambda: sb.polar_coordinates(at.graph, at.curve, 0.5),
        "SuperPatches": lambda: dataclasses.replace(at.patches, triangles=at.patches.triangles[:1]),
        "SuperPatches.hausdorff": lambda: at.patches.hausdorff(at.mesh, 1e-2),
        "super_patches": lambda **more: sb.super_patches(at.mesh, 60, **more),
        "stroke_map": lambda: sb.stroke_map(at.mesh, at.curve, 0.5),
        "principal_curvatures": lambda: sb.principal_curvatures(at.mesh),
        "progress_bar": lambda: contextlib.ExitStack().enter_context(sb.progress_bar(io.StringIO())),
        "project": lambda **more: sb.project(at.mesh, at.vertices * 1.1, **more),
        "quality_plot": lambda: sb.quality_plot(quality),
        "neighbor_means": lambda: sb.neighbor_means(at.triangles, at.vertices),
        "periodic_voronoi_2d": lambda **more: sb.periodic_voronoi_2d(at.sites, **more),
        "PeriodicVoronoi2d.locate": lambda **more: sb.periodic_voronoi_2d(at.sites[:100]).locate(at.sites, **more),
        "power_diagram_2d": lambda **more: sb.power_diagram_2d(at.sites, at.sites[:, 0] * 1e-6, **more),
        "ramp_by_distance": lambda: sb.ramp_by_distance(distances[:, 0], 1.0, 2.0, 0.5),
        "read_arrays": lambda: sb.read_arrays(at.obj),
        "read_mesh": lambda: sb.read_mesh(at.obj),
        "read_placement_field": lambda: sb.read_placement_field(at.written, at.mesh),
        "read_placements": lambda: sb.read_placements(at.written, at.mesh),
        "refine_to_cell_boundary": lambda: sb.refine_to_cell_boundary(
            heights, at.triangles, at.cell_of_triangle, [0.1], 1e-2
        ),
        "balance_2d": lambda **more: sb.balance_2d(at.sites[:300], SQUARE, max_iterations=3, **more),
        "weights_for_areas": lambda **more: sb.weights_for_areas(at.sites[:300], SQUARE, max_iterations=3, **more),
        "relax_2d": lambda **more: sb.relax_2d(at.sites, SQUARE, max_iterations=5, **more),
        "release_pinned_memory": sb.release_pinned_memory,
        "repair": lambda: sb.repair(
            at.vertices[at.triangles].reshape(-1, 3), np.arange(3 * len(at.triangles)).reshape(-1, 3)
        ),
        "sample": lambda: sb.sample(at.mesh, 20_000),
        "segment_distances": lambda **more: sb.segment_distances(
            at.vertices,
            np.zeros(at.count, np.int32),
            at.vertices[:99],
            at.vertices[1:100],
            np.zeros(99, np.int32),
            **more,
        ),
        "self_crossings": lambda **more: sb.self_crossings(at.vertices, at.triangles, **more),
        "show": lambda: if_installed(lambda: sb.show(at.mesh, is_shown=False)),
        "smoothed_directions": lambda **more: sb.smoothed_directions(at.triangles, at.vertices, 40, **more),
        "spread_values": lambda: sb.spread_values(at.mesh, at.few, at.few.astype(float)),
        "streamline": lambda: sb.streamline(at.mesh, at.field, 3, 20.0),
        "trace": lambda: sb.trace(at.mesh, 0, 0.3, 200.0),
        "triangle_edges": lambda: sb.triangle_edges(at.triangles, at.count),
        "triangle_quality": lambda: sb.triangle_quality(at.vertices, at.triangles),
        "vertex_normals": lambda: sb.vertex_normals(at.vertices, at.triangles),
        "voronoi_2d": lambda **more: sb.voronoi_2d(at.sites, **more),
        "voronoi_2d_on_device": lambda: sb.voronoi_2d_on_device(at.sites),
        "write_curves": lambda: sb.write_curves(at.folder / f"{os.getpid()}.obj", [at.curve_points]),
        "write_mesh": lambda: sb.write_mesh(at.folder / f"{os.getpid()}.ply", at.mesh, {"x": at.vertices[:, 0]}),
        "write_placements": lambda: sb.write_placements(
            at.folder / f"{os.getpid()}.json", at.mesh, [at.star], at.laid.placements
        ),
    }


def missing(table: dict[str, Call]) -> list[str]:
    """Entry points that have no call."""
    return [name for name in entry_points() if name not in table and not is_made_by_calls(name)]


def has_threads(name: str) -> bool:
    made = operator.attrgetter(name)(sb)
    said = vars(made)["__init__"].__doc__ if isinstance(made, type) and "__init__" in vars(made) else made.__doc__
    return "threads:" in str(said).split("\n", 1)[0]


def in_a_child(ask: Callable[[], str]) -> str:
    """What a forked child answers, or what became of it."""
    sys.stdout.flush()
    to_read, to_write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            signal.alarm(PATIENCE)
            os.close(to_read)
            try:
                answer = ask()
            except BaseException as error:  # all of them are findings
                answer = f"{type(error).__name__}: {error}"
            os.write(to_write, answer.encode()[:2000])
        finally:
            os._exit(0)
    os.close(to_write)
    with os.fdopen(to_read, "rb") as end:
        answer = end.read().decode()
    code = os.waitpid(child, 0)[1]
    return answer if code == 0 else "hangs" if code == signal.SIGALRM else f"dies of {signal.Signals(code & 127).name}"


def answers(call: Call, **more: object) -> str:
    """Nothing where it gives a result or an exception of ours."""
    with contextlib.suppress(*OURS):
        call(**more)
    return ""


def with_little_memory(call: Call, megabytes: int) -> str:
    import resource

    size = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE") + (megabytes << 20)
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
    return answers(call)


def press_later(after: float) -> int:
    """Send Ctrl-C from another process, as the call may hold Python's lock; give where to read the time."""
    to_read, to_write = os.pipe()
    if os.fork() == 0:
        time.sleep(after)
        os.write(to_write, struct.pack("d", time.monotonic()))
        os.kill(os.getppid(), signal.SIGINT)
        os._exit(0)
    return to_read


def interrupted(call: Call, after: float, answer: float = ANSWER) -> str:
    """Nothing where it is over before, or ends soon after Ctrl-C."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    pressed, ended = press_later(after), 0.0
    try:
        answers(call)
        ended = time.monotonic()
        time.sleep(PATIENCE)
    except KeyboardInterrupt:
        ended = ended or time.monotonic()
    waited = ended - struct.unpack("d", os.read(pressed, 8))[0]
    return "" if waited <= answer else f"{waited:.2f} s"


def seconds_of(call: Call) -> float:
    start = time.monotonic()
    answers(call)
    return time.monotonic() - start


def findings(name: str, call: Call, rng: random.Random, answer: float = ANSWER) -> list[str]:
    """What goes wrong for one entry point, whose call is to answer Ctrl-C within so many seconds."""
    asked = {"in a forked child": lambda: answers(call)}
    if has_threads(name):
        asked["threads=100000"] = lambda: answers(call, threads=100_000)
    if sys.platform == "linux":
        for megabytes in MEMORY:
            asked[f"with {megabytes} MB"] = functools.partial(with_little_memory, call, megabytes)
    found = [f"{name} {how}: {said}" for how, ask in asked.items() if (said := in_a_child(ask))]
    taken = seconds_of(call)
    for _ in range(3 if taken > answer else 0):
        after = rng.uniform(0.01, taken)
        late: list[str] = []
        while len(late) < 3 and (said := in_a_child(functools.partial(interrupted, call, after, answer))):
            late.append(said)  # and again, as another process may have held the core
        if len(late) == 3:
            found.append(f"{name}, Ctrl-C after {after:.2f} s of {taken:.2f}: {min(late)}")
    return found


def prepare(size: int, folder: Path) -> None:
    """Make the calls of a process whose only work is to be asked."""
    global prepared
    prepared = calls(Inputs(size, folder))


def findings_prepared(name: str, answer: float) -> list[str]:
    return findings(name, prepared[name], random.Random(name), answer)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pattern", nargs="?", default="*")
    parser.add_argument("--size", type=int, default=6)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    options = parser.parse_args()
    rng, total = random.Random(options.seed), 0
    with tempfile.TemporaryDirectory() as folder:
        table = calls(Inputs(options.size, Path(folder)))
        for name in missing(table):
            print(f"{name}: has no call")
        total = len(missing(table))
        for name, call in table.items():
            if not fnmatch.fnmatch(name, options.pattern):
                continue
            found = findings(name, call, rng)
            total += len(found)
            for line in found:
                print(line, flush=True)
    print(f"{total} findings, seed {options.seed}")
    return bool(total)


if __name__ == "__main__":
    sys.exit(main())
