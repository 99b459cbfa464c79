# SPDX-License-Identifier: MIT
"""Each class of shapes its own density, direction and size; copies around those that lie there."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.laid_shapes import (
    CRESCENT,
    DISK,
    NEEDLE,
    STAR,
    at,
    collisions,
    fits,
    laid_flat,
    plane,
    ring,
    same,
)  # fmt: skip

SHAPES = [STAR, NEEDLE, CRESCENT]


def along_axes(result: sb.Distribution, field: sb.DirectionField, shape: int) -> np.ndarray:
    """Cosines between the x axes of a class's copies and the field."""
    mesh, laid = result.mesh, result.placements[result.placements.shape == shape]
    corners = mesh.vertices[mesh.triangles[laid.center.faces]]
    x = corners[:, 1] - corners[:, 0]
    x /= np.linalg.norm(x, axis=1)[:, None]
    normal = np.cross(x, corners[:, 2] - corners[:, 0])
    y = np.cross(normal / np.linalg.norm(normal, axis=1)[:, None], x)
    axis = x * np.cos(laid.angle)[:, None] + y * np.sin(laid.angle)[:, None]
    cosines: np.ndarray = (axis * field.directions(laid.center)).sum(axis=1)
    return cosines


def thinned(density: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Numbers of places in 10 x 10 squares of the unit square, and what the density (of a grid's vertices) asks for."""
    found = np.histogram2d(places[:, 0], places[:, 1], 10, [[0, 1], [0, 1]])[0].ravel()
    n = round(np.sqrt(len(density)))
    fine = density.reshape(n, n).T  # x first
    middle = (fine[1:, 1:] + fine[:-1, 1:] + fine[1:, :-1] + fine[:-1, :-1]) / 4
    wanted = middle.reshape(10, (n - 1) // 10, 10, (n - 1) // 10).sum(axis=(1, 3)).ravel()
    return np.array([found, wanted * len(places) / wanted.sum()])


def test_each_class_follows_its_own_density() -> None:
    mesh = sb.Mesh(*meshes.grid(41, 41))
    x, y = mesh.vertices[:, 0], mesh.vertices[:, 1]
    densities = [np.maximum(0, 2 * x - 0.4), np.maximum(0, 1.6 - 2 * x), np.sin(np.pi * x) * y]
    counts = [900, 600, 1200]
    result = sb.distribute(mesh, SHAPES, counts, density=densities, size=0.004)
    assert np.bincount(result.placements.shape).tolist() == counts
    places = result.placements.center.positions(mesh)
    for shape, density in enumerate(densities):
        found, wanted = thinned(density, places[result.placements.shape == shape])
        assert np.corrcoef(found, wanted)[0, 1] > 0.95
        assert found[wanted == 0].sum() == 0
    assert sb.check_distribution(mesh, result, samples=1000).ok
    again = sb.distribute(mesh, SHAPES, counts, density=np.array(densities) * 2.0**-300, size=0.004, threads=1)
    assert same(result, again)


def test_each_class_points_along_its_own_field() -> None:
    mesh, lines = ring()
    fields = [sb.direction_field(mesh, 1), lines, lines.turned(0.7)]
    for mode in ("random", "packed"):
        result = sb.distribute(mesh, SHAPES, field=fields, size=0.12, mode=mode, shares=[1, 1, 1])
        assert (np.bincount(result.placements.shape) > 20).all()
        assert along_axes(result, fields[0], 0) == pytest.approx(1, abs=1e-9)
        for shape in (1, 2):
            assert np.abs(along_axes(result, fields[shape], shape)) == pytest.approx(1, abs=1e-9)
        assert sb.check_distribution(mesh, result, samples=1000).ok


def test_each_class_has_its_own_size() -> None:
    mesh, field = plane()
    ramp = 0.02 + 0.04 * mesh.vertices[:, 0]
    for size in ([0.05, 0.03, 0.04], (0.05, ramp, 0.04), np.array([ramp, 0.5 * ramp, np.full_like(ramp, 0.03)])):
        result = sb.distribute(mesh, SHAPES, field=field, size=size, gap=0.004)
        x = result.placements.center.positions(mesh)[:, 0]
        for shape in range(3):
            own = np.broadcast_to(np.asarray(size[shape]), mesh.vertex_count)
            slope = own[mesh.vertices[:, 0] == 1][0] - own[mesh.vertices[:, 0] == 0][0]
            wanted = own[mesh.vertices[:, 0] == 0][0] + slope * x
            is_own = result.placements.shape == shape
            assert is_own.sum() > 10
            assert result.placements.scale[is_own] == pytest.approx(wanted[is_own])
        assert collisions(laid_flat(result, 1.0)) == 0


def test_full_with_sizes_and_fields_of_each_class() -> None:
    """A surface that is called full has no room for any class in its own size and direction."""
    mesh, field = plane(turning=True)
    other = sb.DirectionField.from_vectors(mesh, np.tile([1.0, 2.0, 0.0], (mesh.face_count, 1)), 1)
    sizes = np.array([0.05 + 0.03 * mesh.vertices[:, 1], np.full(mesh.vertex_count, 0.04)])
    shapes, fields = [STAR, CRESCENT], [field, other]
    result = sb.distribute(mesh, shapes, field=fields, size=sizes, maximal=True, tolerance=0.02)
    assert result.stop_reason == "full" and result.certificate.uncertified_area < 0.02 * mesh.area
    copies = laid_flat(result)
    assert collisions(copies) == 0
    rng = np.random.default_rng(1)
    centers = result.placements.center.positions(mesh)[:, :2]
    for place in rng.uniform(0.0, 1.0, (500, 2)):
        if np.linalg.norm(place - [0.5, 0.5]) < 0.05:
            continue
        point = sb.project(mesh, [[*place, 0.0]])
        near = np.flatnonzero(np.linalg.norm(centers - place, axis=1) < 0.16)
        for shape, size, own in ((STAR, 0.05 + 0.03 * place[1], field), (CRESCENT, 0.04, other)):
            direction = own.directions(point)[0]
            extra = shape.moved(size, np.arctan2(direction[1], direction[0]), place)
            outside = (np.abs(np.concatenate(extra.loops) - 0.5) > 0.5).any()
            assert outside or any(extra.overlaps(copies[i]) for i in near)


def values_at(mesh: sb.Mesh, values: np.ndarray, points: sb.SurfacePoints) -> np.ndarray:
    """Values of vertices (V,), linear within faces."""
    found: np.ndarray = (values[mesh.triangles[points.faces]] * points.barycentric).sum(axis=1)
    return found


def test_full_wherever_the_density_of_a_class_is_positive() -> None:
    """Nothing fits where a class may lie, by brute force, and none lies where its density is 0."""
    mesh, _ = ring()
    field, (x, y, z) = sb.direction_field(mesh, 1), mesh.vertices.T
    densities = [np.maximum(0, x - 0.3), np.maximum(0, 0.2 - x) * (y > 0), 1e-200 * np.maximum(0, z)]
    options = {"field": field, "size": 0.12, "maximal": True, "seed": 3}
    result = sb.distribute(mesh, SHAPES, density=densities, **options)
    assert result.stop_reason == "full" and result.certificate.uncertified_area < 0.02 * mesh.area
    assert sb.check_distribution(mesh, result, samples=1000).ok
    for shape, density in enumerate(densities):
        laid = result.placements[result.placements.shape == shape]
        assert len(laid) > 10 and values_at(mesh, density, laid.center).min() > 0
        tried = sb.sample(mesh, 80, 1.0 * (density > 0), seed=shape)
        wanted = values_at(mesh, density, tried) > 0
        told = [fits(result, shape, at(tried, i), field, 0.02) for i in np.flatnonzero(wanted)]
        assert told.count(False) > 50 and told.count(True) == 0
        # Elsewhere the certificate says nothing.
        bare = sb.sample(mesh, 80, 1.0 * np.all([d == 0 for d in densities], axis=0), seed=shape)
        assert [fits(result, shape, at(bare, i), field, 0.02) for i in range(80)].count(True) > 20
    assert same(result, sb.distribute(mesh, SHAPES, density=np.array(densities) * 2.0**-50, threads=1, **options))


def test_where_all_is_full_densities_say_which_class_lies_where() -> None:
    mesh, field = plane()
    x = mesh.vertices[:, 0]
    options = {"field": field, "size": 0.02, "maximal": True}
    two = sb.distribute(mesh, [STAR, STAR], density=[1 - x, x], **options)
    on_right = two.placements.center.positions(mesh)[:, 0] > 0.5
    left, right = (np.bincount(two.placements.shape[side]) for side in (~on_right, on_right))
    assert left[0] > 2 * left[1] and right[1] > 2 * right[0]
    even, painted = (sb.distribute(mesh, STAR, density=d, **options) for d in (None, 0.001 + x))
    assert len(painted) == pytest.approx(len(even), rel=0.03)
    assert same(even, sb.distribute(mesh, STAR, density=np.ones(len(x)), **options))


def test_counts_that_follow_a_density_end_where_nothing_more_fits() -> None:
    mesh, field = plane()
    x = mesh.vertices[:, 0]
    density = np.maximum(0, x - 0.25)
    options = {"field": field, "density": density, "size": 0.03}
    few = sb.distribute(mesh, DISK, 40, maximal=True, **options)
    assert few.stop_reason == "counts" and len(few) == 40
    assert same(few, sb.distribute(mesh, DISK, 40, **options))
    many = sb.distribute(mesh, DISK, 1000, maximal=True, **options)
    assert many.stop_reason == "full" and many.certificate.uncertified_area == 0
    assert len(many) > len(sb.distribute(mesh, DISK, 1000, **options))
    assert many.placements.center.positions(mesh)[:, 0].min() > 0.25


def test_what_is_given_once_for_each_is_what_is_given_for_all() -> None:
    mesh, field = ring()
    size = np.linspace(0.08, 0.15, mesh.vertex_count)
    one = sb.distribute(mesh, SHAPES, field=field, size=size, gap=0.01, seed=4)
    assert same(one, sb.distribute(mesh, SHAPES, field=[field] * 3, size=[size] * 3, gap=0.01, seed=4))
    assert same(
        sb.distribute(mesh, SHAPES, size=0.1, maximal=True), sb.distribute(mesh, SHAPES, size=[0.1] * 3, maximal=True)
    )
    bent = sb.distribute(mesh, SHAPES, 40, field=[field] * 3, shares=[1, 1, 1], size=0.15, bend=True)
    whole = sb.distribute(mesh, SHAPES, 40, field=field, shares=[1, 1, 1], size=0.15, bend=True)
    assert same(bent, whole) and bent.field == (field,) * 3
    assert all(
        a.tobytes() == b.tobytes() for i in range(40) for a, b in zip(bent.outline(i), whole.outline(i), strict=True)
    )


def test_each_class_bends_along_its_own_field() -> None:
    mesh, lines = ring()
    fields = [lines, lines.turned(np.pi / 2)]
    shape = sb.Shape.needle(12)
    result = sb.distribute(mesh, [shape, shape], 60, field=fields, shares=[1, 1], size=0.4, bend=True)
    assert len(result) == 60 and sb.check_distribution(mesh, result, samples=1000).ok
    for i in (0, 1):
        own = result.placements[result.placements.shape == i]
        alone = sb.Placements(np.zeros(len(own), int), own.center, own.angle, own.scale, own.mirrored)
        mapped = sb.map_shapes(mesh, shape, alone, fields[i])
        numbers = np.flatnonzero(result.placements.shape == i)
        for k, number in enumerate(numbers):
            assert mapped.outline(k)[0].tobytes() == result.outline(number)[0].tobytes()


@pytest.mark.parametrize("gap", [0.0, 0.02])
@pytest.mark.parametrize("options", [{}, {"mode": "packed"}, {"maximal": True, "tolerance": 0.1}, {"density": True}])
def test_copies_are_laid_around_those_that_lie_there(gap: float, options: dict[str, object]) -> None:
    mesh, field = ring()
    if "density" in options:
        options = {"density": 2 + mesh.vertices[:, 0], "counts": [60, 40, 50]}
    orders = {"field": field, "size": 0.1, "gap": gap, "mirror": True, **options}
    first = sb.distribute(mesh, SHAPES, seed=1, **orders)
    kept = first.placements[np.arange(len(first)) % 3 == 0]
    again = sb.distribute(mesh, SHAPES, seed=2, around=kept, **orders)
    head = again.placements[: len(kept)]
    for name in ("shape", "angle", "scale", "mirrored"):
        assert np.array_equal(getattr(head, name), getattr(kept, name))
    assert np.array_equal(head.center.barycentric, kept.center.barycentric)
    assert len(again) > 0.9 * len(first)
    if "counts" in options:
        assert np.bincount(again.placements.shape).tolist() == options["counts"]
    assert sb.check_distribution(mesh, again, samples=1000).ok
    assert same(again, sb.distribute(mesh, SHAPES, seed=2, around=kept, threads=1, **orders))


def test_a_gap_is_kept_to_those_that_lie_there() -> None:
    mesh, field = plane()
    kept = sb.distribute(mesh, DISK, 12, field=field, size=0.05, seed=3).placements
    inner = (np.abs(kept.center.positions(mesh)[:, :2] - 0.5) < 0.5 - 0.05 - 0.045).all(axis=1)
    assert 4 < inner.sum() < 12
    for gap in (0.03, 0.08):
        result = sb.distribute(mesh, DISK, field=field, size=0.03, gap=gap, around=kept)
        places = result.placements.center.positions(mesh)[:, :2]
        own, new = places[:12], places[12:]
        apart = np.linalg.norm(own[:, None] - new, axis=2) - 0.05 - 0.03 + 0.001  # a disk has 24 corners
        assert len(new) > 5 and apart.min() >= gap / 2 and apart[inner].min() >= gap


def test_counts_that_are_met_by_what_lies_there_add_nothing() -> None:
    mesh, field = plane()
    kept = sb.distribute(mesh, SHAPES, [10, 0, 4], field=field, size=0.05).placements
    result = sb.distribute(mesh, SHAPES, [7, 0, 6], field=field, size=0.05, around=kept)
    assert np.bincount(result.placements.shape).tolist() == [10, 0, 6] and result.stop_reason == "counts"


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"size": [[0.1], [0.1]]}, "size has 2 lists, but there are 3 shapes"),
        ({"size": [0.1, -1, 0.1]}, "size of shape 1 is -1"),
        ({"size": [0.1, [0.1, 0.2, 0.3, 0.4], 0.1]}, "size of shape 1 has 4 values, but the mesh has 625 vertices"),
        ({"size": [0.1, 9.0, 0.1]}, "size: shape 1 has an area of"),
        ({"field": []}, "field: wanted at least one DirectionField"),
        ({"field": [plane()[1]] * 2}, "field has 2 lists, but there are 3 shapes"),
        ({"field": [plane()[1], ring()[1], plane()[1]]}, "field of shape 1: is one of another mesh"),
        ({"field": [plane()[1], None, plane()[1]]}, "field of shape 1: wanted a DirectionField, got a NoneType"),
        ({"density": np.ones((2, 625)), "counts": [1, 1, 1]}, "density has 2 lists, but there are 3 shapes"),
        ({"density": [np.ones(625), np.zeros(625), np.ones(625)], "counts": [1, 1, 1]}, "density of shape 1 is zero"),
        ({"density": [np.ones(625), -np.ones(625), np.ones(625)], "counts": [1, 1, 1]}, "density of shape 1: value -1"),
        ({"around": [1, 2]}, "around: wanted a Placements, got a list"),
    ],
)
def test_bad_orders_name_the_class(options: dict[str, object], sentence: str) -> None:
    mesh, _ = plane()
    with pytest.raises(sb.InputError, match=sentence.replace("(", r"\(")):
        sb.distribute(mesh, SHAPES, **{"size": 0.1, **options})


def test_copies_that_cannot_lie_there_are_named() -> None:
    mesh, field = plane()
    places = sb.project(mesh, [[0.5, 0.5, 0], [0.2, 0.2, 0], [0.55, 0.5, 0], [0.98, 0.5, 0]])

    def lying(*which: int) -> sb.Placements:
        n = len(which)
        points = sb.SurfacePoints(places.faces[list(which)], places.barycentric[list(which)])
        return sb.Placements([0] * n, points, [0.0] * n, [0.1] * n)

    for gap in (0.0, 0.01):
        with pytest.raises(sb.InputError, match="around: copy 2 meets one before it"):
            sb.distribute(mesh, DISK, field=field, size=0.05, gap=gap, around=lying(0, 1, 2))
        with pytest.raises(sb.InputError, match=r"around: copy 1.*reaches beyond the boundary"):
            sb.distribute(mesh, DISK, field=field, size=0.05, gap=gap, around=lying(0, 3))
    forbidden = mesh.vertices[mesh.triangles].mean(axis=1)[:, 0] < 0.3
    with pytest.raises(sb.InputError, match="around: copy 1 lies on a forbidden face"):
        sb.distribute(mesh, DISK, field=field, size=0.05, forbidden=forbidden, around=lying(0, 1))
    wrong = sb.Placements([3], lying(0).center, [0.0], [0.1])
    with pytest.raises(sb.InputError, match="around: "):
        sb.distribute(mesh, DISK, field=field, size=0.05, around=wrong)


def test_placements_are_picked_as_numpy_picks() -> None:
    mesh, _ = plane()
    laid = sb.distribute(mesh, SHAPES, 30, shares=[1, 1, 1], size=0.03).placements
    for index in (3, -1, slice(2, 20, 3), [5, 1, 5], laid.shape == 1, np.array([], int)):
        picked = laid[index]
        assert isinstance(picked, sb.Placements)
        assert np.array_equal(picked.scale, np.atleast_1d(laid.scale[index]))
        assert np.array_equal(picked.center.faces, np.atleast_1d(laid.center.faces[index]))
    with pytest.raises(IndexError):
        laid[30]
