# SPDX-License-Identifier: MIT
"""Objects travel: through pickle, copy, other processes; equal ones are equal, and what stays says so."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import multiprocessing
import pickle
import subprocess
import sys
from pathlib import Path
from typing import Any

import joblib
import numpy as np
import pytest

import saddleback as sb
from tests import meshes

ROOT = Path(__file__).resolve().parents[3]
PROTOCOLS = range(pickle.HIGHEST_PROTOCOL + 1)
# What is measured anew where an object is made.
DIARIES = {"build_seconds", "query_times", "device_times"}

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def made() -> dict[str, Any]:
    """An object of every class that travels."""
    mesh = sb.Mesh(*meshes.grid(9, 9, jitter=0.3))
    graph = sb.SaddleVertexGraph(mesh)
    cells = sb.geodesic_voronoi(graph, [0, 9, 20, 60])
    field = sb.direction_field(mesh, 2)
    curve = sb.SurfaceCurve(mesh, [0, 1, 2])
    laid = sb.distribute(mesh, [sb.Shape.star(), sb.Shape.disk()], [2, 1], size=0.1, seed=3)
    rng = np.random.default_rng(0)
    sites = rng.random((30, 2))
    diagram = sb.voronoi_2d(sites, 0.05 * rng.random(30), SQUARE)
    chart = sb.Chart(mesh, mesh.vertices[:, :2])
    corners = np.array([[(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)]] * mesh.face_count).reshape(-1, 2)
    sweep = sb.SweepCircle(sites, (0.5, 0.5))
    _, report = sb.repair(*meshes.grid(4, 4))
    watch = sb.RelaxationWatch()
    even = sb.centroidal_voronoi(graph, count=5, max_iterations=5, watch=watch)
    mapped = laid.mapped
    objects = [
        mesh,
        report,
        sb.sample(mesh, 7),
        sb.add_barriers(mesh, edges=mesh.edges[::5], curves=[curve], faces=[3]),
        curve,
        graph,
        graph.path(0, 40),
        graph.paths([0], [3, 40]),
        sb.trace(mesh, 40, 0.3, 0.2),
        graph.log_map(40, 0.3),
        sb.polar_coordinates(graph, curve, 0.3),
        sb.stroke_map(mesh, curve, 0.3),
        cells,
        cells.edges[0],
        cells.split(),
        cells.dual(),
        cells.polygons(),
        even,
        watch.latest(),
        sb.bake_cells(cells, corners, size=(16, 16), allow_overlaps=True),
        sb.triangle_quality(mesh.vertices, mesh.triangles),
        sb.hausdorff_distance(mesh, sb.Mesh(mesh.vertices + 0.01, mesh.triangles)),
        diagram,
        diagram.clipped,
        sweep.step(),
        sb.relax_2d(sites, SQUARE, max_iterations=3),
        sb.balance_2d(sites, SQUARE, max_iterations=2),
        sb.weights_for_areas(sites[:9], SQUARE),
        sb.periodic_voronoi_2d(sites),
        chart,
        chart.lift(sb.voronoi_2d(mesh.vertices[[3, 30, 70], :2])),
        field,
        sb.Stroke(curve, True, 2.0),
        sb.streamline(mesh, field, 40, 0.3),
        sb.Shape.star(),
        laid,
        laid.placements,
        mapped,
        mapped.conform([(0.1, 0.2)], 0),
        mapped.bend([None, (np.array([(0, 0, 0), (0.5, 0, 0), (0, 0.5, 0.1)]), [[0, 1, 2]])]),
        mapped.cut(),
        mapped.attributes(0.1),
        sb.check_distribution(mesh, laid, samples=1000),
        sb.distribute(sb.Mesh(*meshes.grid(5, 5)), sb.Shape.disk(), size=0.2, maximal=True).certificate,
    ]
    tube = sb.SaddleVertexGraph(sb.Mesh(*meshes.cylinder()))
    objects += sb.geodesic_voronoi(tube, [0]).dual("strict").issues[:1]
    return {type(value).__name__: value for value in objects}


OBJECTS = made()
STAYS = {
    "CellCache": sb.CellCache,
    "DirectionFieldEditor": lambda: sb.DirectionFieldEditor(OBJECTS["Mesh"]),
    "ExactField": lambda: sb.ExactField(OBJECTS["Mesh"], [0]),
    "Job": sb.Job,
    "RelaxationWatch": sb.RelaxationWatch,
    "SafeDistanceTable": lambda: sb.SafeDistanceTable(sb.Shape.disk(), sb.Shape.star()),
    "SweepCircle": lambda: sb.SweepCircle([(0.0, 0.0), (1.0, 0.5)], (0.5, 0.5)),
    "SweepCircles": lambda: sb.SweepCircles([(0.0, 0.0), (1.0, 0.5)], [(0.5, 0.5)]),
}
ON_A_DEVICE = {"DeviceArray", "DeviceVoronoi2d"}  # tests/parity
OF_PYTHON = {"DensityMatch", "Device", "SuperPatches"}  # made of Python's own


def properties(value: Any) -> dict[str, Any]:
    names = [name for name, member in inspect.getmembers(type(value)) if isinstance(member, property)]
    return {name: getattr(value, name) for name in names if name not in DIARIES and not name.startswith("_")}


def is_same(a: Any, b: Any) -> bool:
    """By what can be read of them, without the library's own comparisons."""
    if isinstance(a, np.ndarray):
        return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(is_same(a[key], b[key]) for key in a)
    if isinstance(a, list | tuple):
        return len(a) == len(b) and all(is_same(x, y) for x, y in zip(a, b, strict=True))
    if type(a).__module__.startswith("saddleback"):
        return type(a) is type(b) and is_same(properties(a), properties(b))
    return repr(a) == repr(b)


def test_every_public_class_is_asked() -> None:
    classes = {name for name in sb.__all__ if isinstance(getattr(sb, name), type)}
    errors = {name for name in classes if issubclass(getattr(sb, name), Exception)}
    assert {*OBJECTS, *STAYS, *ON_A_DEVICE, *OF_PYTHON} == classes - errors


@pytest.mark.parametrize("name", OBJECTS)
def test_pickled_ones_are_the_same(name: str) -> None:
    value = OBJECTS[name]
    for protocol in PROTOCOLS:
        again = pickle.loads(pickle.dumps(value, protocol))
        assert again is not value
        assert is_same(again, value), protocol
        assert again == value
        assert hash(again) == hash(value)
        assert again.__dask_tokenize__() == value.__dask_tokenize__()


@pytest.mark.parametrize("name", OBJECTS)
def test_copies_are_themselves(name: str) -> None:
    """Nothing can change them."""
    value = OBJECTS[name]
    assert copy.copy(value) is value
    assert copy.deepcopy([value])[0] is value


@pytest.mark.parametrize("name", STAYS)
def test_what_stays_says_what_to_do(name: str) -> None:
    value = STAYS[name]()
    for how in (copy.copy, copy.deepcopy, *(lambda value, p=p: pickle.dumps(value, p) for p in PROTOCOLS)):
        with pytest.raises(TypeError, match=rf"cannot pickle or copy a saddleback\.{name}: \w+.* (make|send|grow)"):
            how(value)


def test_what_python_made_travels() -> None:
    for value in (sb.devices()[0], sb.DensityMatch(0.5, np.ones(3), np.ones(3, np.int64))):
        assert repr(pickle.loads(pickle.dumps(value))) == repr(value)
    patches = sb.super_patches(sb.Mesh(*meshes.cube()), error=0.01)
    again = pickle.loads(pickle.dumps(patches))
    for field in dataclasses.fields(patches):
        assert np.all(getattr(again, field.name) == getattr(patches, field.name)), field.name


def test_out_of_band_buffers_are_not_copied_into_the_pickle() -> None:
    """As Dask sends them."""
    cells, buffers = OBJECTS["SplitMesh"], []
    rest = pickle.dumps(cells, 5, buffer_callback=buffers.append)
    assert sum(len(buffer.raw()) for buffer in buffers) >= cells.vertices.nbytes + cells.triangles.nbytes
    assert len(rest) < 1000
    assert pickle.loads(rest, buffers=buffers) == cells


def test_others_are_other() -> None:
    vertices, triangles = meshes.grid(9, 9, jitter=0.3)
    other = vertices.copy()
    other[5, 2] = np.nextafter(0, 1)
    mesh, moved = sb.Mesh(vertices, triangles), sb.Mesh(other, triangles)
    assert mesh == sb.Mesh(vertices, triangles)
    assert mesh != moved
    assert mesh != "a mesh"
    assert mesh.__dask_tokenize__() != moved.__dask_tokenize__()
    graph = sb.SaddleVertexGraph(mesh, k=20)
    assert graph == sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), k=20, threads=1)
    assert graph != sb.SaddleVertexGraph(mesh, k=21)
    assert graph != sb.SaddleVertexGraph(moved, k=20)
    assert sb.SurfacePoints([0], [(1, 0, 0)]) != sb.SurfacePoints([0], [(0, 1, 0)])
    assert sb.geodesic_voronoi(graph, [0, 9]) != sb.geodesic_voronoi(graph, [0, 10])
    assert sb.Shape.star(5) != sb.Shape.star(6)
    assert len({mesh, sb.Mesh(vertices, triangles), moved}) == 2
    longer, longest = (sb.Mesh(vertices, triangles, lengths=share * mesh.edge_lengths) for share in (2, 3))
    assert longer == pickle.loads(pickle.dumps(longer))
    assert len({mesh, longer, longest}) == len({each.__dask_tokenize__() for each in (mesh, longer, longest)}) == 3
    assert longer != longest and longer != mesh


def test_a_pickled_graph_is_its_file(tmp_path: Path) -> None:
    graph = OBJECTS["SaddleVertexGraph"]
    graph.save(tmp_path / "saved.graph")
    assert (tmp_path / "saved.graph").read_bytes() in pickle.dumps(graph)


def test_what_belongs_together_travels_once() -> None:
    """Cells bring their graph, which brings its mesh."""
    cells = OBJECTS["GeodesicVoronoi"]
    graph = OBJECTS["SaddleVertexGraph"]
    assert len(pickle.dumps([cells, graph, graph.mesh])) < len(pickle.dumps(cells)) + 500
    again, its_graph = pickle.loads(pickle.dumps([cells, graph]))
    assert is_same(again.locate([5]), cells.locate([5]))
    assert is_same(its_graph.distances([5]), graph.distances([5]))


def test_exact_cells_locate_as_before() -> None:
    cells = sb.geodesic_voronoi(OBJECTS["SaddleVertexGraph"], [0, 9, 20], exact=True)
    points = sb.sample(OBJECTS["Mesh"], 50, seed=5)
    again = pickle.loads(pickle.dumps(cells))
    assert is_same(again.locate(points), cells.locate(points))


def test_what_is_made_of_what_came_is_the_same() -> None:
    """The parts that cannot be read travel as well."""
    there = {name: pickle.loads(pickle.dumps(value)) for name, value in OBJECTS.items()}
    points = sb.sample(OBJECTS["Mesh"], 50, seed=5)
    for objects in (OBJECTS, there):
        objects["of it"] = [
            objects["SaddleVertexGraph"].distances([3, 50]),
            objects["GeodesicVoronoi"].split().triangles,
            objects["GeodesicVoronoi"].locate(points),
            [path.points for path in objects["GeodesicVoronoi"].dual_paths()],
            objects["DualMesh"].edge_lengths,
            objects["DualMesh"].quads(),
            objects["CentroidalVoronoi"].cells.centers().barycentric,
            objects["LiftedVoronoi"].split().triangle_cell,
            objects["LiftedVoronoi"].locate(points),
            objects["Chart"].places(points),
            objects["Voronoi2d"].locate([(0.3, 0.4), (0.9, 0.1)]),
            objects["DirectionField"].turned(0.3).vectors,
            objects["Distribution"].outline(1),
            objects["MappedShapes"].frames(),
            objects["SurfaceCurve"].length,
        ]
    assert is_same(OBJECTS.pop("of it"), there["of it"])


@pytest.mark.parametrize("damage", ["layout", "parts", "type"])
def test_a_pickle_of_another_version_is_refused(damage: str) -> None:
    restore, (kind, layout, version, state) = OBJECTS["LogMap"].__reduce__()
    if damage == "layout":
        with pytest.raises(sb.VersionError, match=f"pickled by saddleback {version}.* use the same version on both"):
            restore(kind, layout + 1, version, state)
        return
    wrong = state[:-1] if damage == "parts" else (state[1], *state[1:])
    with pytest.raises(sb.InputError, match="this pickled LogMap is damaged or of another version"):
        restore(kind, layout, version, wrong)


def distances_of(graph: sb.SaddleVertexGraph) -> Any:
    return graph.distances([0]), graph.__dask_tokenize__()


@pytest.mark.parametrize("how", ["joblib", "spawn"])
def test_a_graph_answers_the_same_in_other_processes(how: str) -> None:
    graph = OBJECTS["SaddleVertexGraph"]
    if how == "joblib":
        found = joblib.Parallel(n_jobs=2)([joblib.delayed(distances_of)(graph)] * 2)
    else:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            found = pool.map(distances_of, [graph])
    for distances, token in found:
        assert (distances == graph.distances([0])).all()
        assert token == graph.__dask_tokenize__()


def test_tokens_are_the_same_in_every_process() -> None:
    """Whatever order Python's hashes give there."""
    code = (
        "import saddleback as sb\nfrom tests import meshes\n"
        "graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(9, 9, jitter=0.3)))\n"
        "print([graph.__dask_tokenize__(), sb.repair(*meshes.grid(4, 4))[1].__dask_tokenize__()])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    tokens = [OBJECTS[name].__dask_tokenize__() for name in ("SaddleVertexGraph", "RepairReport")]
    assert done.stdout.strip() == str(tokens)
