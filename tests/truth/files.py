# SPDX-License-Identifier: MIT
"""What files hold, by the plainest means: areas by the shoelace formula in fractions, a reader of the plainest OBJ."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Sequence
from fractions import Fraction
from pathlib import Path
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
