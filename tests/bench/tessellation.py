# SPDX-License-Identifier: MIT
"""Even cells and their dual meshes: `python -m tests.bench tessellation [--cells N] [MESH...]`.

Per mesh: CPU seconds an iteration and in all, vertices out, Euler characteristic (of the mesh in brackets), quality of
the dual mesh, greatest distances between the two surfaces, from the mesh and back, in % of its diagonal. Peers that are
installed run on the same input: pyacvd (clusters of a subdivided mesh), pymeshlab (geodesic Voronoi relaxation of
vertices), MeshLib (remesher), CGAL (isotropic remeshing; `apt-get install libcgal-dev g++`).
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

import saddleback as sb
from tests import meshes

Arrays = meshes.Arrays
LONG = 400  # iterations at most

HEADER = f"{'method':<34} {'s/iteration':>11} {'seconds':>8} {'V out':>6} {'chi':>9} {'Q mean':>7} {'Q min':>6}"
HEADER += f" {'angle':>6} {'least':>6} {'irregular':>9} {'Hausdorff':>12}"


def characteristic(triangles: np.ndarray) -> int:
    edges = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return len(np.unique(triangles)) - len(np.unique(edges, axis=0)) + len(triangles)


def deviations(mesh: sb.Mesh, vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, float]:
    """Greatest distances from the mesh to the dual mesh and back, in % of the diagonal."""
    try:
        found = sb.hausdorff_distance(mesh, sb.Mesh(vertices, triangles))
    except sb.MeshError:
        return np.nan, np.nan
    diagonal = np.linalg.norm(np.ptp(mesh.vertices, axis=0))
    return float(100 * found.from_first / diagonal), float(100 * found.from_second / diagonal)


def row(name: str, mesh: sb.Mesh, seconds: float, iterations: int, vertices: np.ndarray, triangles: np.ndarray) -> str:
    quality = sb.triangle_quality(vertices, triangles)
    own = len(mesh.vertices) - mesh.edge_count + len(mesh.triangles)
    per_iteration = f"{seconds / iterations:.3f}" if iterations else "-"
    there, back = deviations(mesh, vertices, triangles)
    return (
        f"{name:<34} {per_iteration:>11} {seconds:>8.2f} {len(np.unique(triangles)):>6}"
        f" {characteristic(triangles):>4} ({own:>2}) {quality.mean_quality:>7.4f} {quality.min_quality:>6.3f}"
        f" {np.degrees(quality.mean_angle):>6.2f} {np.degrees(quality.min_angle):>6.1f}"
        f" {100 * quality.irregular:>8.1f}% {there:>6.2f} {back:>5.2f}"
    )


def ours(mesh: sb.Mesh, cells: int) -> Iterator[str]:
    start = time.process_time()
    graph = sb.SaddleVertexGraph(mesh, accuracy=5e-3, threads=1)
    built = time.process_time() - start
    yield f"{'graph':<34} {'-':>11} {built:>8.2f}"
    for method, annealing, iterations in (("lloyd", 0, 20), ("lbfgs", 0, 20), ("lbfgs", 0, LONG), ("lbfgs", 300, 100)):
        start = time.process_time()
        relaxed = sb.centroidal_voronoi(
            graph,
            count=cells,
            method=method,
            annealing=annealing,
            closed_ball=annealing > 0,
            max_iterations=iterations,
            tolerance=1e-7,
            seed=1,
            threads=1,
        )
        seconds = time.process_time() - start
        vertices, triangles, issues = relaxed.cells.dual("strict")
        steps = f"{annealing} + {relaxed.iterations}" if annealing else f"{relaxed.iterations}"
        moved = f", {relaxed.exchanged} moved" if relaxed.exchanged else ""
        name = f"{method}, {steps} steps, E {relaxed.normalized_energy:.4f}{moved}"
        yield row(name, mesh, seconds, annealing + relaxed.iterations + 1, vertices, triangles)
        if issues:
            yield f"  {len(issues)} issues, first: {issues[0]}"


def pyacvd_cells(mesh: sb.Mesh, cells: int) -> Arrays:
    import pyacvd
    import pyvista

    clustering = pyacvd.Clustering(pyvista.make_tri_mesh(mesh.vertices, mesh.triangles))
    if len(mesh.vertices) < 50 * cells:
        clustering.subdivide(2)
    clustering.cluster(cells)
    made = clustering.create_mesh()
    return np.asarray(made.points, dtype=float), made.faces.reshape(-1, 4)[:, 1:].astype(np.int32)


def pymeshlab_cells(mesh: sb.Mesh, cells: int) -> Arrays:
    import pymeshlab

    meshes_ = pymeshlab.MeshSet(verbose=False)
    meshes_.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.triangles))
    meshes_.generate_sampling_voronoi(samplenum=cells, iternum=10, distancetype="Euclidean")
    made = meshes_.mesh(1)  # its cells, fans about their seeds; the current one is the input
    return dual_of_fans(made.vertex_matrix(), made.face_matrix())


def dual_of_fans(vertices: np.ndarray, triangles: np.ndarray) -> Arrays:
    """The triangulation of the middles of cells, each a fan about one of the first vertices.

    Cells that meet at a corner give a fan, those about a corner on the border none.
    """
    cells = int(triangles.min(axis=1).max()) + 1
    if not ((triangles < cells).sum(axis=1) == 1).all():
        raise ValueError("its cells are no fans")
    turn = np.argmax(triangles < cells, axis=1)
    fans = np.take_along_axis(triangles, (turn[:, None] + np.arange(3)) % 3, axis=1).tolist()
    sides: dict[int, dict[int, list[int]]] = {}  # by corner, by cell: the corners beside it in the cell
    for cell, before, after in fans:
        sides.setdefault(before, {}).setdefault(cell, []).append(after)
        sides.setdefault(after, {}).setdefault(cell, []).append(before)
    made: list[list[int]] = []
    for about in sides.values():  # from cell to cell across the edges that end here; cells may lie either way round
        ring, edge = [next(iter(about))], about[next(iter(about))][0]
        for _ in range(len(about) - 1):
            ring += [cell for cell in about if cell != ring[-1] and edge in about[cell]][:1]
            edge = next((other for other in about[ring[-1]] if other != edge), edge)
        if len(set(ring)) == len(about) and edge in about[ring[0]]:
            made += [[ring[0], ring[i], ring[i + 1]] for i in range(1, len(ring) - 1)]
    return np.asarray(vertices[:cells], dtype=float), np.array(made, dtype=np.int32).reshape(-1, 3)


def edge_length(mesh: sb.Mesh, cells: int) -> float:
    """Of equilateral triangles about so many vertices."""
    return float(np.sqrt(2 / np.sqrt(3) * mesh.area / cells))


def meshlib_cells(mesh: sb.Mesh, cells: int) -> Arrays:
    from meshlib import mrmeshnumpy, mrmeshpy

    other = mrmeshnumpy.meshFromFacesVerts(mesh.triangles, mesh.vertices)
    settings = mrmeshpy.RemeshSettings()
    settings.targetEdgeLen = edge_length(mesh, cells)
    mrmeshpy.remesh(other, settings)
    other.pack()
    return mrmeshnumpy.getNumpyVerts(other), mrmeshnumpy.getNumpyFaces(other.topology)


def cgal_cells(mesh: sb.Mesh, cells: int, program: Path) -> tuple[float, Arrays]:
    """CGAL has no Python of its own: a small program that times itself."""
    with tempfile.TemporaryDirectory() as folder:
        given, made = Path(folder) / "given.bin", Path(folder) / "made.bin"
        with given.open("wb") as file:
            np.array([len(mesh.vertices), len(mesh.triangles)], np.int64).tofile(file)
            mesh.vertices.tofile(file)
            mesh.triangles.astype(np.int32).tofile(file)
        length = str(edge_length(mesh, cells))
        told = subprocess.run([program, given, made, length], check=True, capture_output=True, text=True)
        with made.open("rb") as file:
            vertex_count, triangle_count = np.fromfile(file, np.int64, 2)
            vertices = np.fromfile(file, np.float64, 3 * vertex_count).reshape(-1, 3)
            triangles = np.fromfile(file, np.int32, 3 * triangle_count).reshape(-1, 3)
    return float(told.stdout), (vertices, triangles)


def cgal(mesh: sb.Mesh, cells: int) -> str:
    name = "cgal"
    if shutil.which("g++") is None or not Path("/usr/include/CGAL/Polygon_mesh_processing").is_dir():
        return f"{name:<34} not installed"
    source = Path(__file__).with_name("_cgal_remesh.cpp")
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "cgal_remesh"
        build = ["g++", "-O3", "-DNDEBUG", "-std=c++17", "-w", "-I/usr/include/eigen3"]
        subprocess.run([*build, str(source), "-o", str(program), "-lgmp", "-lmpfr"], check=True)
        try:
            seconds, (vertices, triangles) = cgal_cells(mesh, cells, program)
        except subprocess.CalledProcessError as error:
            return f"{name:<34} failed: {error.stderr[:80]}"
    return row(name, mesh, seconds, 0, vertices, triangles)


PEERS: dict[str, Callable[[sb.Mesh, int], Arrays]] = {
    "pyacvd": pyacvd_cells,
    "pymeshlab": pymeshlab_cells,
    "meshlib": meshlib_cells,
}


def peers(mesh: sb.Mesh, cells: int) -> Iterator[str]:
    for name, method in PEERS.items():
        if importlib.util.find_spec(name) is None:
            yield f"{name:<34} not installed"
            continue
        start = time.process_time()
        try:
            vertices, triangles = method(mesh, cells)
        except Exception as error:  # a peer that fails is a result
            yield f"{name:<34} failed: {str(error)[:80]}"
            continue
        yield row(name, mesh, time.process_time() - start, 0, vertices, triangles)
    yield cgal(mesh, cells)


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.bench tessellation")
    parser.add_argument("--cells", type=int, default=500)
    parser.add_argument("meshes", nargs="*", type=Path)
    options = parser.parse_args(arguments)
    inputs = {path.stem: path for path in options.meshes}
    named = {name: sb.read_mesh(path) for name, path in inputs.items()} or {
        "torus": sb.Mesh(*meshes.torus(160, 64)),
    }
    for name, mesh in named.items():
        print(f"{name}: {len(mesh.vertices)} vertices, {options.cells} cells\n{HEADER}")
        for line in (*ours(mesh, options.cells), *peers(mesh, options.cells)):
            print(line, flush=True)
    return 0
