# SPDX-License-Identifier: MIT
"""However an array lies in memory, the answer is that of a plain one; what holds no such numbers is refused by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

VERTICES, TRIANGLES = meshes.grid(9, 9, jitter=0.3)
MESH = sb.Mesh(VERTICES, TRIANGLES)
GRAPH = sb.SaddleVertexGraph(MESH)
FACES, COUNT = len(TRIANGLES), len(VERTICES)
CELL = (np.arange(FACES) % 3 == 0).astype(np.int32)
VALUES = np.random.default_rng(0).integers(1, 9, COUNT) / 8
FIELDS = np.column_stack([VERTICES, VALUES])
SITES = np.random.default_rng(1).integers(1, 63, (9, 2)) / 64
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
IMAGE = np.pad(np.ones((8, 9)), 4)
MANY = sb.sample(MESH, 7)


def laid(**more: Any) -> tuple[np.ndarray, ...]:
    placements = sb.distribute(
        MESH, [sb.Shape.disk(), sb.Shape.star()], [5, 4], seed=2, **({"size": 0.05} | more)
    ).placements
    return placements.shape, placements.center.faces, placements.center.barycentric, placements.scale


def mirrored(flags: Any) -> tuple[np.ndarray, ...]:
    return (sb.Placements([0] * 7, MANY, [0.0] * 7, [1.0] * 7, flags).mirrored,)


# Of each kind of argument: the call, its name, a plain array.
CALLS: dict[str, tuple[Callable[[Any], Any], np.ndarray]] = {
    "forbidden": (lambda x: laid(forbidden=x), np.arange(FACES) < 60),
    "mirrored": (mirrored, np.arange(7) < 3),
    "faces": (lambda x: (sb.add_barriers(MESH, faces=x).face_origin,), np.arange(FACES) < 60),
    "density": (lambda x: laid(density=x), VALUES),
    "size": (lambda x: laid(size=x), VALUES / 16),
    "density_2d": (lambda density: (sb.relax_2d(SITES, SQUARE, density, 2).sites,), VALUES.reshape(27, 3)),
    "values": (lambda x: (sb.neighbor_means(TRIANGLES, x),), FIELDS),
    "fields": (lambda x: sb.cut_at_level(x, TRIANGLES, 3, 0.4), FIELDS),
    "image": (lambda x: tuple(sb.Shape.from_mask(x).loops), IMAGE),
    "triangles": (lambda x: (sb.triangle_edges(x, COUNT)[0],), TRIANGLES),
    "xyz": (lambda x: (sb.project(MESH, x).barycentric,), VERTICES[:9] * 1.5),
    "sources": (lambda x: (GRAPH.distances(x),), np.array([3, 17, 40])),
    "distances": (lambda x: (sb.blend_by_distance(x, [1.0, 2.0]),), VALUES[:80].reshape(2, 40)),
    "power": (lambda x: (sb.blend_by_distance(VALUES[:80].reshape(2, 40), [1.0, 2.0], x),), np.array(2.0)),
    "stretch": (lambda x: (sb.anisotropic_metric(MESH, VERTICES[:3].repeat(FACES // 3 + 1, 0)[:FACES], x),), VALUES),
    "field": (lambda x: (sb.anisotropic_metric(MESH, x, 2.0),), VERTICES[TRIANGLES[:, 1]] + 0.1),
    "curves": (lambda x: sb.write_curves("/nowhere/curves.obj", [x]), VERTICES),
}


class Table:
    """As pandas' tables: an array, whose parts are columns."""

    def __init__(self, array: np.ndarray) -> None:
        self._array = array

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self._array, dtype=dtype)

    def __len__(self) -> int:
        return len(self._array)

    def __iter__(self) -> Any:
        return iter("columns")


def strided(array: np.ndarray) -> np.ndarray:
    """Beside each of its elements one that is none of its own."""
    wide = np.zeros((*array.shape, 2), array.dtype)
    wide[..., 0], wide[..., 1] = array, ~array if array.dtype == bool else -1 - array
    return wide[..., 0]


LAYOUTS: dict[str, Callable[[np.ndarray], Any]] = {
    "strided": strided,
    "backward": lambda array: array[::-1].copy()[::-1],
    "fortran": np.asfortranarray,
    "swapped": lambda array: array.astype(array.dtype.newbyteorder()),
    "list": np.ndarray.tolist,
    "table": Table,
    "unmasked": np.ma.array,
    "long": lambda array: array.astype(np.longdouble) if array.dtype.kind == "f" else array,
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", sorted(set(CALLS) - {"curves"}))
def test_layouts_make_no_difference(name: str, layout: str) -> None:
    call, array = CALLS[name]
    if layout in ("table", "backward", "fortran") and array.ndim == 0:
        return
    for one, other in zip(call(array), call(LAYOUTS[layout](array)), strict=True):
        np.testing.assert_array_equal(one, other)


def masked(array: np.ndarray) -> np.ma.MaskedArray[Any, Any]:
    return np.ma.array(array, mask=np.arange(array.size).reshape(array.shape) == 0)


OTHERS: dict[str, Callable[[np.ndarray], Any]] = {
    "masked": masked,
    "text": lambda array: array.astype(float).astype(str),
    "complex": lambda array: array + 1j,
    "dates": lambda array: array.astype(np.int64).astype("datetime64[s]"),
    "halves": lambda array: array + 0.5 if array.dtype.kind in "bi" else [None] * 3,
    "nothing": lambda array: np.where(np.ones_like(array, bool), np.nan, 0.0) if array.dtype.kind in "bi" else {},
}


@pytest.mark.parametrize("other", OTHERS)
@pytest.mark.parametrize("name", CALLS)
def test_what_holds_no_such_numbers_is_refused_by_name(name: str, other: str) -> None:
    call, array = CALLS[name]
    with pytest.raises(sb.InputError, match=rf"^{name.removesuffix('_2d')}\b"):
        call(OTHERS[other](array))


def test_scalars_of_numpy_are_numbers_and_its_booleans_are_none() -> None:
    assert laid(size=np.array(0.05))[0].tolist() == laid(size=0.05)[0].tolist()
    for wrong in (np.True_, np.complex128(1), np.complex64(1)):
        with pytest.raises(sb.InputError, match="length: wanted a real number"):
            sb.trace(MESH, 40, 0.5, wrong)
    with pytest.raises(sb.InputError, match="cells: wanted an integer"):
        sb.density_match(MESH, sb.Placements([0] * 7, MANY, [0.0] * 7, [1.0] * 7), VALUES, 3.0)  # type: ignore[arg-type]
    with pytest.raises(sb.InputError, match="sharp: wanted"):
        sb.super_patches(MESH, 9, sharp=9.0)
    with pytest.raises(sb.InputError, match="vertex_count: wanted 0 or more, got -1"):
        sb.triangle_edges(np.zeros((0, 3), int), -1)
    with pytest.raises(sb.InputError, match="limit: wanted a length of 0 or more, got nan"):
        sb.cell_boundary_distance(VERTICES, TRIANGLES, CELL, float("nan"))
    with pytest.raises(sb.InputError, match="shares has 0 values"):
        laid(shares=[])


def test_placements_are_picked_by_one_row_of_indices() -> None:
    placements = sb.Placements(np.arange(7), MANY, [0.0] * 7, [1.0] * 7)
    assert placements[np.array([4, 2])].shape.tolist() == [4, 2]
    for wrong in ([[0, 1]], np.True_, None):
        with pytest.raises(sb.InputError, match="index: wanted shape"):
            placements[wrong]
