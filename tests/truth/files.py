# SPDX-License-Identifier: MIT
"""What files hold, by the plainest means: areas by the shoelace formula in fractions, a reader of the plainest OBJ."""

from __future__ import annotations

import contextlib
import gzip
import json
import struct
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.truth.registry import guards

Points = NDArray[np.float64]


def shoelace_area(points: Points) -> float:
    """The area that a closed polygon of the plane goes round, counter-clockwise positive, rounded once."""
    exact = [(Fraction(float(p[0])), Fraction(float(p[1]))) for p in points]
    return float(sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(exact, exact[1:] + exact[:1], strict=True)) / 2)


def obj_of(points: Points, corners: Iterable[int]) -> str:
    """One polygon as a file."""
    vertices = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in np.asarray(points, float).tolist())
    return vertices + "f " + " ".join(str(v + 1) for v in corners) + "\n"


def read_plain_obj(text: str) -> tuple[list[list[float]], list[list[int]]]:
    """Vertices and polygons of a file that holds nothing else and is right."""
    vertices: list[list[float]] = []
    polygons: list[list[int]] = []
    for line in text.splitlines():
        key, *words = line.split()
        if key == "v":
            vertices.append([float(word) for word in words])
        else:
            polygons.append([int(word) - 1 for word in words])
    return vertices, polygons


def cross(o: Sequence[float], a: Sequence[float], b: Sequence[float]) -> float:
    """Twice the area of a triangle."""
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def random_star(rng: np.random.Generator) -> Points:
    """Corners round the origin, none more than half a turn behind the last."""
    n = int(rng.integers(4, 60))
    angles = 2 * np.pi * (np.arange(n) + 0.9 * rng.random(n)) / n
    return np.c_[np.cos(angles), np.sin(angles)] * (rng.random(n) ** 2 + 0.05)[:, None]


def random_tour(rng: np.random.Generator) -> Points:
    """A tour through places, exchanged until no exchange shortens it: so it crosses itself nowhere (but may touch)."""
    n = int(rng.integers(4, 16))
    points = rng.random((n, 2)) if rng.random() < 0.5 else rng.integers(0, 5, (n, 2)).astype(np.float64)
    points = rng.permutation(np.unique(points, axis=0))

    def length(a: int, b: int) -> float:
        return float(np.linalg.norm(points[a % len(points)] - points[b % len(points)]))

    better = True
    while better:
        better = False
        for i in range(len(points) - 1):
            for j in range(i + 2, len(points) - (i == 0)):
                if length(i, i + 1) + length(j, j + 1) > length(i, j) + length(i + 1, j + 1) + 1e-12:
                    points[i + 1 : j + 1] = points[i + 1 : j + 1][::-1].copy()
                    better = True
    return points


def random_wall(rng: np.random.Generator) -> Points:
    """A wall with windows, each reached by an edge there and back."""
    count = int(rng.integers(1, 4))
    corners: list[list[float]] = [[0, 0]]
    for k in range(count):
        n = int(rng.integers(3, 9))
        angles = 2 * np.pi * (np.arange(n) + 0.45 * rng.random(n)) / n
        window = [10 * k + 5, 6] + np.c_[np.cos(angles), np.sin(angles)] * rng.uniform(0.5, 2.5, n)[:, None]
        lowest = int(window[:, 1].argmin())
        around = np.roll(window, -lowest, axis=0)[[0, *range(n - 1, 0, -1), 0]].tolist()
        foot = [around[0][0], 0.0]
        corners += [foot, *around, foot]
    return np.array([*corners, [10 * count, 0], [10 * count, 10], [0, 10]])


def split_sides(points: Points, rng: np.random.Generator) -> Points:
    """The same polygon with further corners on its sides."""
    parts = []
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        shares = np.sort(rng.choice([0.25, 0.5, 0.75], int(rng.integers(3)), replace=False))
        parts += [a, *(a + share * (b - a) for share in shares)]
    return np.array(parts)


@guards("read_arrays", on="nothing")
def check_polygon_area(rng: np.random.Generator) -> None:
    """The triangles of a random polygon against the shoelace formula, flat, tilted, far away and scaled."""
    flat = (random_star, random_tour, random_wall)[rng.integers(3)](rng)
    if rng.random() < 0.3:
        flat = split_sides(flat, rng)
    area = abs(shoelace_area(flat))
    if area < 1e-6:
        return
    size = 1.0
    points = np.c_[flat, np.zeros(len(flat))]
    if rng.random() < 0.5:
        size = float(10.0 ** rng.uniform(-6, 6))
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        points = size * (points @ frame.T + rng.normal(size=3) * 10.0 ** rng.uniform(-2, 3))
    places, corners = np.unique(points, axis=0, return_inverse=True)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "polygon.obj"
        path.write_text(obj_of(places, corners.ravel().tolist()))
        vertices, triangles = sb.read_arrays(path)
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    got = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / size**2
    assert abs(got / area - 1) < 1e-10, f"area {got!r} for {area!r} of {flat.tolist()}"


@guards("read_mesh", "read_arrays", on="nothing")
def check_plain_obj(rng: np.random.Generator) -> None:
    """A file of triangles in random notation against a reader of the plainest form."""
    count = int(rng.integers(3, 30))
    notation = ("{:.3f}", "{!r}", "{:.17e}", "{:+.6g}")[rng.integers(4)].replace("+", "")
    text = "".join("v " + " ".join(notation.format(float(x)) for x in rng.normal(size=3)) + "\n" for _ in range(count))
    for _ in range(int(rng.integers(1, 20))):
        text += "f " + " ".join(str(v + 1) for v in rng.choice(count, 3, replace=False)) + "\n"
    wanted_vertices, wanted_polygons = read_plain_obj(text)
    ends = ("\n", "\r\n", "\r")[rng.integers(3)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.obj"
        path.write_bytes(text.replace("\n", ends).encode())
        vertices, triangles = sb.read_arrays(path)
    assert vertices.tolist() == wanted_vertices
    assert triangles.tolist() == wanted_polygons


STRANGE: tuple[Any, ...] = (
    None,
    True,
    "false",
    "",
    -1,
    0,
    1,
    3,
    1.9,
    2**31,
    10**400,
    float("nan"),
    1e308,
    [],
    [[]],
    {},
)


def damaged(value: Any, rng: np.random.Generator) -> Any:
    """The same but for one entry, somewhere, that is another, twice there or gone."""
    if isinstance(value, dict) and value and rng.random() < 0.95:
        key = list(value)[rng.integers(len(value))]
        return {**value, key: damaged(value[key], rng)}
    if isinstance(value, list) and value and rng.random() < 0.8:
        i = int(rng.integers(len(value)))
        entries = ([damaged(value[i], rng)], [value[i], value[i]], [])[rng.choice(3, p=[0.8, 0.1, 0.1])]
        return [*value[:i], *entries, *value[i + 1 :]]
    return STRANGE[rng.integers(len(STRANGE))]


@guards("read_placements", "read_placement_field", "write_placements", on="nothing")
def check_placement_files(rng: np.random.Generator) -> None:
    """Placements come back to the bit; a damaged file is refused by one sentence that names it, or makes sense."""
    mesh = sb.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    count = int(rng.integers(1, 5))
    center = sb.SurfacePoints(rng.integers(0, 4, count), rng.dirichlet([1, 1, 1], count))
    laid = sb.Placements(
        rng.integers(0, 2, count), center, rng.normal(size=count), rng.uniform(0.1, 9, count), rng.random(count) < 0.5
    )
    shapes = [sb.Shape.star(), sb.Shape.disk(5)]
    field = sb.direction_field(mesh, symmetry=1) if rng.random() < 0.5 else None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "placements.json"
        sb.write_placements(path, mesh, shapes, laid, field)
        read = sb.read_placements(path, mesh)[1]
        for name in ("shape", "angle", "scale", "mirrored"):
            assert np.array_equal(getattr(read, name), getattr(laid, name)), name
        assert np.array_equal(read.center.barycentric, center.barycentric)
        path.write_text(json.dumps(damaged(json.loads(path.read_text()), rng)))
        try:
            found, read = sb.read_placements(path, mesh)
            assert set(read.shape.tolist()) <= set(range(len(found)))
            assert set(read.center.faces.tolist()) <= set(range(4))
            sb.read_placement_field(path, mesh)
        except sb.InputError as error:
            assert str(error).startswith(f"{path}: "), str(error)
            assert "\n" not in str(error), str(error)


def read_plain_ply(contents: bytes) -> dict[str, list[list[float | list[int]]]]:
    """The rows of each element of a binary file whose lists are counted by a byte, value by value."""
    head, _, rest = contents.partition(b"end_header\n")
    codes = {
        "int8": "b",
        "uchar": "B",
        "int16": "h",
        "uint16": "H",
        "int": "i",
        "uint": "I",
        "float": "f",
        "double": "d",
    }
    elements: list[tuple[str, int, list[list[str]]]] = []
    for line in head.decode().splitlines():
        key, *words = line.split()
        if key == "element":
            elements.append((words[0], int(words[1]), []))
        elif key == "property":
            elements[-1][2].append(words)
    at = 0

    def take(code: str) -> Any:
        nonlocal at
        at += struct.calcsize("<" + code)
        return struct.unpack_from("<" + code, rest, at - struct.calcsize("<" + code))[0]

    found = {}
    for name, count, kinds in elements:
        found[name] = [
            [
                [take(codes[words[2]]) for _ in range(take(codes[words[1]]))]
                if words[0] == "list"
                else take(codes[words[0]])
                for words in kinds
            ]
            for _ in range(count)
        ]
    assert at == len(rest)
    return found


@guards("write_mesh", "write_curves", "read_mesh")
def check_written_meshes(mesh: sb.Mesh, rng: np.random.Generator) -> None:
    """Written meshes and curves against readers of the plainest forms, and what we read of them, to the bit."""
    scale = 10.0 ** rng.integers(-9, 9)
    mesh = sb.Mesh(mesh.vertices * scale, mesh.triangles)
    kinds = ("f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4")
    values = (rng.normal(size=mesh.vertex_count) * 100).astype(np.int64).astype(kinds[rng.integers(len(kinds))])
    cell, curve = rng.integers(0, 9, mesh.face_count), rng.normal(size=(int(rng.integers(2, 9)), 3))
    compressed = ".gz" if rng.random() < 0.3 else ""
    with tempfile.TemporaryDirectory() as folder:
        ply, obj = (Path(folder) / f"mesh.{kind}{compressed}" for kind in ("ply", "obj"))
        sb.write_mesh(ply, mesh, {"value": values}, face_attributes={"cell": cell})
        sb.write_mesh(obj, mesh, face_attributes={"cell": cell} if rng.random() < 0.5 else {})
        sb.write_curves(Path(folder) / "curves.ply", [curve, curve[:1], curve])
        open_ = gzip.open if compressed else open
        rows, lines = open_(ply, "rb").read(), open_(obj, "rb").read().decode()
        curves = read_plain_ply((Path(folder) / "curves.ply").read_bytes())
        for path in (ply, obj):
            again = sb.read_mesh(path)
            assert again.vertices.tobytes() == mesh.vertices.tobytes()
            assert again.triangles.tobytes() == mesh.triangles.tobytes()
    read = read_plain_ply(rows)
    assert read["vertex"] == [[*xyz, value] for xyz, value in zip(mesh.vertices.tolist(), values.tolist(), strict=True)]
    assert read["face"] == [[t, c] for t, c in zip(mesh.triangles.tolist(), cell.tolist(), strict=True)]
    vertices, polygons = read_plain_obj("\n".join(line for line in lines.splitlines() if not line.startswith("g ")))
    assert (vertices, polygons) == (mesh.vertices.tolist(), mesh.triangles.tolist())
    assert curves["vertex"] == [*curve.tolist(), *curve.tolist()]
    n = len(curve)
    assert curves["edge"] == [[i, i + 1] for i in range(2 * n - 1) if i != n - 1]


@contextlib.contextmanager
def stand_ins() -> Iterator[dict[str, Any]]:
    """What takes the place of packages that are too large to have, and keeps what it is handed."""

    class PolyData(SimpleNamespace):
        def __init__(self, points: Any, **more: Any) -> None:
            super().__init__(points=points, **more)

        @classmethod
        def from_regular_faces(cls, points: Any, faces: Any) -> PolyData:
            flat = np.column_stack([np.full(len(faces), 3), faces]).ravel()
            return cls(points=points, faces=flat, is_all_triangles=True, point_data={}, cell_data={})

    class Plotter(list):  # type: ignore[type-arg]
        def __init__(self, off_screen: bool) -> None:
            assert off_screen

        def add_mesh(self, mesh: Any, name: str, **_: Any) -> None:
            self.append((name, mesh))

    class TriangleMesh(SimpleNamespace):
        def __init__(self, vertices: Any, triangles: Any) -> None:
            super().__init__(vertices=vertices, triangles=triangles)

    vectors = SimpleNamespace(Vector3dVector=np.array, Vector3iVector=np.array)
    packages = {
        "pyvista": SimpleNamespace(PolyData=PolyData, Plotter=Plotter),
        "open3d": SimpleNamespace(utility=vectors, geometry=SimpleNamespace(TriangleMesh=TriangleMesh)),
    }
    before = {name: sys.modules.get(name) for name in packages}
    sys.modules.update(packages)  # type: ignore[arg-type]
    try:
        yield packages
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


@guards("show", "plot")
def check_pictures(mesh: sb.Mesh, rng: np.random.Generator) -> None:
    """A scene has the mesh with its values, and the edges of cells; a plot the energies."""
    graph, values = sb.SaddleVertexGraph(mesh, threads=1), rng.normal(size=mesh.vertex_count)
    count = mesh.component_count + 2
    even = sb.centroidal_voronoi(graph, count=count, max_iterations=3, seed=1)
    with stand_ins():
        scene = dict(sb.show(even, mesh=mesh, attributes={"value": values}, is_shown=False))
    assert scene["mesh"].points.tobytes() == mesh.vertices.tobytes()
    assert (scene["mesh"].point_data["value"] == values).all()
    assert (scene["cells"].cell_data["cell"] == even.cells.split().triangle_cell).all()
    drawn: dict[str, Any] = {}
    axes = SimpleNamespace(plot=lambda y, **_: drawn.update(energy=y), set=lambda **_: None)
    assert sb.plot(even, axes) is axes
    assert (drawn["energy"] == even.energy).all()


@guards(*(f"Mesh.{way}_{name}" for way in ("from", "to") for name in ("trimesh", "meshio", "pyvista", "open3d")))
def check_other_packages(mesh: sb.Mesh, rng: np.random.Generator) -> None:
    """Meshes come back from what other packages make of them, or from what has what theirs have, to the bit."""
    values = rng.normal(size=mesh.vertex_count)
    there, elsewhere = mesh.to_trimesh({"value": values}), mesh.to_meshio({"value": values})
    assert (there.vertex_attributes["value"] == values).all()
    assert (elsewhere.point_data["value"] == values).all()
    with stand_ins():
        data = mesh.to_pyvista({"value": values})
        assert (data.point_data["value"] == values).all()
        again = [sb.Mesh.from_pyvista(data), sb.Mesh.from_open3d(mesh.to_open3d())]
    for one in (*again, sb.Mesh.from_trimesh(there), sb.Mesh.from_meshio(elsewhere)):
        assert one.vertices.tobytes() == mesh.vertices.tobytes()
        assert one.triangles.tobytes() == mesh.triangles.tobytes()
