# SPDX-License-Identifier: MIT
"""Distances over surfaces, beside what apt and pip offer: `python -m tests.bench geodesics MESH...`.

For every mesh one table: preparation, one field (median of three sources), their errors over all vertices beyond the
first ring, and the memory that both take. Every method runs in a process of its own on one core; times are processor
time. Errors are against `exact_distances`, which `tests.bench exact` compares with pygeodesic. Peers that are not
installed are left out (`pip install pygeodesic potpourri3d libigl meshlib`; CGAL: `apt-get install libcgal-dev g++`).
"""

from __future__ import annotations

import importlib
import json
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb

Field = Callable[[int], Any]
SOURCES = 3


@dataclass(frozen=True)
class Method:
    name: str
    needs: str  # module
    prepare: Callable[[NDArray[np.float64], NDArray[np.int32]], Field]
    is_slow: bool = False  # one source will do
    read: Callable[[Any], NDArray[np.float64]] = np.asarray  # a field as the library gives it; not timed


def _graph(**how: float) -> Callable[[NDArray[np.float64], NDArray[np.int32]], Field]:
    def prepare(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
        graph = sb.SaddleVertexGraph(sb.Mesh(vertices, triangles), threads=1, **how)
        return lambda source: graph.distances([source])

    return prepare


def _exact(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
    mesh = sb.Mesh(vertices, triangles)
    return lambda source: sb.exact_distances(mesh, [source])


def _pygeodesic(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
    import pygeodesic.geodesic as mmp

    solver = mmp.PyGeodesicAlgorithmExact(vertices, triangles)
    return lambda source: np.asarray(solver.geodesicDistances(np.array([source]))[0])


def _potpourri(kind: str) -> Callable[[NDArray[np.float64], NDArray[np.int32]], Field]:
    def prepare(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
        import potpourri3d

        if kind == "heat":
            heat = potpourri3d.MeshHeatMethodDistanceSolver(vertices, triangles)
            return lambda source: np.asarray(heat.compute_distance(source))
        marching = potpourri3d.MeshFastMarchingDistanceSolver(vertices, triangles)
        return lambda source: np.asarray(marching.compute_distance([[(source, [])]]))

    return prepare


def _igl_heat(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
    import igl

    data = igl.HeatGeodesicsData()
    igl.heat_geodesics_precompute(vertices, triangles.astype(np.int64), data)
    return lambda source: np.asarray(igl.heat_geodesics_solve(data, np.array([source], dtype=np.int64)))


def _igl_exact(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
    import igl

    faces, targets = triangles.astype(np.int64), np.arange(len(vertices), dtype=np.int64)
    none = np.zeros(0, dtype=np.int64)
    return lambda source: np.asarray(
        igl.exact_geodesic(vertices, faces, np.array([source], dtype=np.int64), none, targets, none)
    )


def _meshlib(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
    import meshlib.mrmeshnumpy as mrn
    import meshlib.mrmeshpy as mr

    mesh = mrn.meshFromFacesVerts(triangles, vertices)

    def field(source: int) -> Any:
        start = mr.VertBitSet()
        start.resize(len(vertices))
        start.set(mr.VertId(source))
        return mr.computeSurfaceDistances(mesh, start)

    return field


def _meshlib_values(scalars: Any) -> NDArray[np.float64]:
    return np.array([scalars.vec[i] for i in range(scalars.size())], dtype=np.float64)


def _cgal(kind: str) -> Callable[[NDArray[np.float64], NDArray[np.int32]], Field]:
    """CGAL has no Python of its own: a small program, compiled here, that times itself."""

    def prepare(vertices: NDArray[np.float64], triangles: NDArray[np.int32]) -> Field:
        folder = Path(tempfile.mkdtemp())
        program = folder / "cgal_geodesics"
        source = Path(__file__).with_name("_cgal_geodesics.cpp")
        build = ["g++", "-O3", "-DNDEBUG", "-std=c++17", "-w", f"-DKIND_{kind}", "-I/usr/include/eigen3"]
        subprocess.run([*build, str(source), "-o", str(program), "-lgmp", "-lmpfr"], check=True)
        with open(folder / "mesh.bin", "wb") as file:
            np.array([len(vertices), len(triangles)], dtype=np.int64).tofile(file)
            vertices.astype(np.float64).tofile(file)
            triangles.astype(np.int32).tofile(file)

        def field(source: int) -> NDArray[np.float64]:
            told = subprocess.run(
                [str(program), str(folder / "mesh.bin"), str(folder / "field.bin"), str(source)],
                check=True,
                capture_output=True,
                text=True,
            )
            Measured.told = json.loads(told.stdout)
            return np.fromfile(folder / "field.bin", dtype=np.float64)

        return field

    return prepare


class Measured:
    """What a program of its own says of its times and memory."""

    told: dict[str, float] | None = None


METHODS = [
    Method("saddleback, accuracy=2e-2", "saddleback", _graph(accuracy=2e-2)),
    Method("saddleback, accuracy=5e-3", "saddleback", _graph(accuracy=5e-3)),
    Method("saddleback, accuracy=2e-3", "saddleback", _graph(accuracy=2e-3)),
    Method("saddleback, k=100", "saddleback", _graph(k=100)),
    Method("saddleback exact_distances", "saddleback", _exact),
    Method("MeshLib computeSurfaceDistances", "meshlib.mrmeshpy", _meshlib, read=_meshlib_values),
    Method("potpourri3d fast marching", "potpourri3d", _potpourri("marching")),
    Method("potpourri3d heat, robust", "potpourri3d", _potpourri("heat")),
    Method("libigl heat", "igl", _igl_heat),
    Method("CGAL heat, intrinsic Delaunay", "CGAL", _cgal("HEAT")),
    Method("pygeodesic exact (MMP)", "pygeodesic.geodesic", _pygeodesic, is_slow=True),
    Method("CGAL exact (shortest paths)", "CGAL", _cgal("EXACT"), is_slow=True),
    Method("libigl exact", "igl", _igl_exact, is_slow=True),
]


def is_installed(module: str) -> bool:
    if module == "CGAL":
        return shutil.which("g++") is not None and Path("/usr/include/CGAL/Heat_method_3").is_dir()
    try:
        importlib.import_module(module)
    except ImportError:
        return False
    return True


def sources_of(count: int) -> list[int]:
    return [int(source) for source in np.random.default_rng(1).choice(count, SOURCES, replace=False)]


def status_bytes(name: str) -> int:
    lines = Path("/proc/self/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith(name))


def memory_now_and_forget_peak() -> int:
    Path("/proc/self/clear_refs").write_text("5")
    return status_bytes("VmRSS")


def measure(path: Path, method: Method) -> dict[str, Any]:
    """In a process of its own: seconds and bytes, and the fields in a file."""
    mesh = sb.read_mesh(path)
    vertices, triangles = np.array(mesh.vertices), np.array(mesh.triangles)
    is_installed(method.needs)  # what it takes to import it is not counted
    before = memory_now_and_forget_peak()
    start = time.process_time()
    field = method.prepare(vertices, triangles)
    prepared = time.process_time() - start
    seconds, found = [], []
    for source in sources_of(len(vertices))[: 1 if method.is_slow else SOURCES]:
        start = time.process_time()
        raw = field(source)
        seconds.append(Measured.told["field"] if Measured.told else time.process_time() - start)
        found.append(method.read(raw))
    memory = status_bytes("VmHWM") - before
    if Measured.told:
        prepared, memory = Measured.told["prepare"], Measured.told["bytes"]
    return {"prepare": prepared, "field": float(np.median(seconds)), "bytes": memory, "fields": found}


def row(path: Path, method: Method, exact: list[NDArray[np.float64]], rings: list[NDArray[np.int64]]) -> str:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.npz"
        told = subprocess.run(
            [sys.executable, "-m", "tests.bench", "geodesics", "--one", str(path), method.name, str(out)],
            capture_output=True,
            text=True,
            check=False,
        )
        if told.returncode != 0:
            return f"{method.name:32s} failed: {told.stderr.strip().splitlines()[-1][:90]}"
        result = json.loads(told.stdout.splitlines()[-1])
        fields = np.load(out)["fields"]
    count, errors = len(exact[0]), []
    for found, right, ring in zip(fields, exact, rings, strict=False):
        far = np.isfinite(right) & (right > 0)
        far[ring] = False
        errors.append(np.abs(found[far] / right[far] - 1))
    error = np.concatenate(errors)
    return (
        f"{method.name:32s} {result['prepare']:10.2f} {1e6 * result['prepare'] / count:9.1f} "
        f"{1e3 * result['field']:10.2f} {1e6 * result['field'] / count:9.2f} {100 * error.mean():10.4f} "
        f"{100 * error.max():9.3f} {result['bytes'] / count / 1024:9.2f}"
    )


def table(path: Path) -> None:
    mesh = sb.read_mesh(path)
    sources = sources_of(len(mesh.vertices))
    exact = [sb.exact_distances(mesh, [source]) for source in sources]
    rings = [np.unique(mesh.triangles[(mesh.triangles == source).any(axis=1)]) for source in sources]
    print(f"\n{path.stem}, {len(mesh.vertices):,d} vertices")
    print(
        f"{'method':32s} {'prepare s':>10s} {'us/v':>9s} {'field ms':>10s} {'us/v':>9s} {'mean err %':>10s} "
        f"{'max err %':>9s} {'KB/v':>9s}"
    )
    for method in METHODS:
        if is_installed(method.needs):
            print(row(path, method, exact, rings), flush=True)
        else:
            print(f"{method.name:32s} not installed", flush=True)


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--one"]:
        method = next(method for method in METHODS if method.name == arguments[2])
        result = measure(Path(arguments[1]), method)
        np.savez(arguments[3], fields=np.array(result.pop("fields")))
        print(json.dumps(result))
        return 0
    for argument in arguments:
        table(Path(argument))
    return 0
