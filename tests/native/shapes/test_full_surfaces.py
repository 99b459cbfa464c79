# SPDX-License-Identifier: MIT
"""Distributions until nothing more fits, and the certificate of that."""

from __future__ import annotations

import functools
import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native.laid_shapes import (
    CRESCENT,
    DISK,
    FRAME,
    NEEDLE,
    STAR,
    angle_in_face,
    at,
    collisions,
    fits,
    laid_flat,
    plane,
    ring,
    same,
)
from tests.truth import families


@pytest.mark.parametrize(
    ("shape", "mode", "turning"),
    [(STAR, "random", True), (NEEDLE, "packed", False), (CRESCENT, 0.5, True), (FRAME, "random", False)],
    ids=["star", "needle", "crescent", "frame"],
)
def test_nothing_collides_on_a_plane_and_nothing_more_fits(shape, mode, turning) -> None:
    mesh, field = plane(turning)
    result = sb.distribute(mesh, shape, field=field, size=0.07, mode=mode, maximal=True, tolerance=0.02)
    assert result.stop_reason == "full" and result.certificate.uncertified_area < 0.02 * mesh.area
    copies = laid_flat(result)
    assert collisions(copies) == 0
    assert all((np.abs(np.concatenate(s.loops) - 0.5) <= 0.5).all() for s in copies)
    rng = np.random.default_rng(1)
    places = rng.uniform(0.0, 1.0, (700, 2))
    ahead = field.directions(sb.project(mesh, np.column_stack([places, np.zeros(len(places))])))
    centers = result.placements.center.positions(mesh)[:, :2]
    for place, direction in zip(places, ahead, strict=True):
        if turning and np.linalg.norm(place - [0.5, 0.5]) < 0.05:
            continue  # about the singularity the certificate says nothing
        extra = shape.moved(0.07, np.arctan2(direction[1], direction[0]), place)
        if (np.abs(np.concatenate(extra.loops) - 0.5) > 0.5).any():
            continue
        near = np.flatnonzero(np.linalg.norm(centers - place, axis=1) < 0.14)
        assert any(extra.overlaps(copies[i]) for i in near)


def test_nothing_more_fits_on_a_rough_surface() -> None:
    """Copies at random places, larger by more than the tolerance, are laid among those that lie about them."""
    vertices, triangles = meshes.icosphere(4)
    vertices *= 1 + 0.08 * np.prod(np.sin(7 * vertices + 1), axis=1, keepdims=True)
    mesh = sb.Mesh(vertices, triangles)
    field = sb.direction_field(mesh, 1)
    size = 0.15
    result = sb.distribute(mesh, STAR, field=field, size=size, maximal=True)
    assert result.stop_reason == "full" and result.certificate.uncertified_area < 0.05 * mesh.area
    points = sb.sample(mesh, 300, seed=3)
    corners, ahead, places = (
        mesh.vertices[mesh.triangles[points.faces]],
        field.directions(points),
        points.positions(mesh),
    )
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(np.cross(first, second), first)
    across /= np.linalg.norm(np.cross(first, second), axis=1)[:, None]
    angles = np.arctan2((across * ahead).sum(axis=1), (first * ahead).sum(axis=1))
    laid, tried = result.placements, 0
    centers = laid.center.positions(mesh)
    for i, place in enumerate(places):
        near = np.flatnonzero(np.linalg.norm(centers - place, axis=1) < 2.2 * size)
        faces = np.append(laid.center.faces[near], points.faces[i])
        weights = np.vstack([laid.center.barycentric[near], points.barycentric[i]])
        scale = np.append(laid.scale[near], 1.06 * size)
        turned = np.append(laid.angle[near], angles[i])
        nothing = np.zeros(len(faces), int)
        among = sb.Placements(nothing, sb.SurfacePoints(faces, weights), turned, scale, nothing.astype(bool))
        mapped = sb.map_shapes(mesh, [STAR], among)
        tried += not mapped.failures
        assert mapped.failures or not sb.check_distribution(mesh, mapped, samples=1).ok, i
    assert tried > 200


def distance(one: sb.Shape, other: sb.Shape) -> float:
    """Of two polygons that do not overlap: of every corner of each to every edge of the other."""
    least = np.inf
    for a, b in ((one, other), (other, one)):
        for loop in b.loops:
            edge = np.roll(loop, -1, axis=0) - loop
            for corners in a.loops:
                away = corners[:, None] - loop
                along = np.clip((away * edge).sum(axis=2) / (edge**2).sum(axis=1), 0, 1)
                least = min(least, float(np.linalg.norm(away - along[..., None] * edge, axis=2).min()))
    return least


def test_a_certificate_with_a_gap_counts_its_clearance_from_half_of_it() -> None:
    mesh, field = plane(turning=True)
    size, gap, tolerance = 0.07, 0.1, 0.02
    result = sb.distribute(mesh, STAR, field=field, size=size, gap=gap, maximal=True, tolerance=tolerance)
    certificate = result.certificate
    assert result.stop_reason == "full" and certificate.uncertified_area < 0.02 * mesh.area
    assert certificate.tolerance == pytest.approx(tolerance * (size + gap / 2))
    copies = laid_flat(result)
    apart = [distance(a, b) for i, a in enumerate(copies) for b in copies[:i] if not a.overlaps(b)]
    assert len(apart) == len(copies) * (len(copies) - 1) / 2 and min(apart) >= gap
    rng, nearest = np.random.default_rng(2), []
    places = rng.uniform(0.0, 1.0, (600, 2))
    ahead = field.directions(sb.project(mesh, np.column_stack([places, np.zeros(len(places))])))
    for place, direction in zip(places, ahead, strict=True):
        extra = STAR.moved(size, np.arctan2(direction[1], direction[0]), place)
        within = np.abs(np.concatenate(extra.loops) - 0.5).max() < 0.5 - gap / 2 - certificate.tolerance
        if within and np.linalg.norm(place - [0.5, 0.5]) > 0.05:
            nearest.append(min(0.0 if extra.overlaps(copy) else distance(extra, copy) for copy in copies))
    assert len(nearest) > 250 and max(nearest) < gap + certificate.tolerance
    # A clearance that grows with the gap needs no more cells than shapes alone.
    finer = sb.distribute(mesh, STAR, field=field, size=size, maximal=True, tolerance=tolerance)
    assert certificate.cells < finer.certificate.cells


def test_what_no_certificate_can_tell_is_not_called_full() -> None:
    """With half of such a gap around, a copy goes round the tube and meets itself: neither is it laid nor excluded."""
    mesh = sb.Mesh(*meshes.torus(10, 6))
    field = sb.direction_field(mesh, 1, {})
    result = sb.distribute(mesh, STAR, field=field, size=0.15, gap=2.5, maximal=True, tolerance=0.05, threads=1)
    assert result.stop_reason == "unproven" and len(result) == 0 and "unproven" in repr(result)
    assert result.certificate.uncertified_area == pytest.approx(mesh.area)
    bent = result.rejections["fold"] + result.rejections["stretched"]  # whichever is met first on the way out
    assert bent > 0.9 * sum(result.rejections.values()) > 0
    smaller = sb.distribute(mesh, STAR, field=field, size=0.15, gap=1.0, maximal=True, tolerance=0.05, threads=1)
    assert smaller.stop_reason == "full" and 0 <= smaller.certificate.uncertified_area < 0.5 * mesh.area


def test_stars_make_use_of_the_room_between_their_points() -> None:
    """Certified random pentagrams against certified random disks of the same circumradius, on a flat square.

    Parallel ones cannot be laid denser in random order: choosing among free pixels until none is left, by their
    Minkowski difference, gives 1.68 (and 0.548 as the share that disks cover, as the literature has it).
    """
    mesh = sb.Mesh(*meshes.grid(40, 40))
    x, y = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2].T
    disks = sum(len(sb.distribute(mesh, sb.Shape.disk(48), size=0.03, maximal=True, seed=i)) for i in range(3))
    counts = {}
    for turn in (0.0, 4.0):
        angle = turn * np.sin(2 * np.pi * x) * np.cos(2 * np.pi * y)
        field = sb.DirectionField.from_vectors(mesh, np.stack([np.cos(angle), np.sin(angle), 0 * x], axis=1))
        shape = sb.Shape.star(5, 0.381966)
        counts[turn] = sum(
            len(sb.distribute(mesh, shape, field=field, size=0.03, maximal=True, seed=i)) for i in range(3)
        )
    assert counts[0.0] > 1.62 * disks
    assert counts[4.0] > 1.72 * disks


def test_rounder_disks_are_as_soon_proved_full() -> None:
    mesh, field = ring()
    coarse, fine = (
        sb.distribute(mesh, sb.Shape.disk(n), field=field, size=0.15, maximal=True).certificate for n in (24, 48)
    )
    assert fine.cells < 1.5 * coarse.cells
    assert fine.leaves < 0.1 * fine.cells


@functools.cache
def waves() -> tuple[sb.Mesh, sb.DirectionField]:
    """A plane with a field that turns to and fro."""
    mesh = sb.Mesh(*meshes.grid(61, 61))
    x, y, _ = mesh.vertices[mesh.triangles].mean(axis=1).T
    turn = 2.5 * np.sin(9 * x) + np.cos(7 * y + x)
    return mesh, sb.DirectionField.from_vectors(mesh, np.column_stack([np.cos(turn), np.sin(turn), 0 * turn]), 1)


@functools.cache
def whirl() -> tuple[sb.Mesh, sb.DirectionField]:
    """A plane with a field that runs about a point."""
    mesh = sb.Mesh(*meshes.grid(61, 61))
    x, y, z = (mesh.vertices[mesh.triangles].mean(axis=1) - [0.5, 0.45, 0]).T
    return mesh, sb.DirectionField.from_vectors(mesh, np.column_stack([-y, x, z]), 1)


@pytest.mark.parametrize(
    ("surface", "shape", "size", "options"),
    [
        (ring, sb.Shape.leaf(3), 0.2, {}),
        (ring, sb.Shape.needle(5), 0.4, {"tolerance": 0.05}),
        (waves, sb.Shape.needle(6), 0.15, {}),
        (whirl, CRESCENT, 0.09, {"mode": "packed", "mirror": True}),
        (whirl, FRAME, 0.1, {"gap": 0.01}),
    ],
    ids=["ring", "needles", "waves", "whirl", "frames"],
)
def test_nothing_more_fits_where_copies_bend(surface, shape, size, options) -> None:
    mesh, field = surface()
    result = sb.distribute(mesh, shape, field=field, size=size, bend=True, maximal=True, **options)
    assert result.stop_reason == "full" and result.certificate.uncertified_area < 0.01 * mesh.area
    assert sb.check_distribution(mesh, result, samples=1000).ok
    points = sb.sample(mesh, 300, seed=2)
    if "gap" not in options:
        told = [fits(result, 0, at(points, i), field, 0.06) for i in range(300)]
        assert told.count(False) > 150 and told.count(True) == 0
    assert len(result) >= len(sb.distribute(mesh, shape, 10_000, field, size=size, bend=True, **options))
    assert same(
        result, sb.distribute(mesh, shape, field=field, size=size, bend=True, maximal=True, threads=1, **options)
    )


def test_copies_within_others_that_point_across_the_field_are_seen() -> None:
    mesh, field = waves()
    center = sb.project(mesh, [[0.5, 0.5, 0]])
    across = sb.Placements([0], center, [angle_in_face(mesh, field, center) + 1.3], [0.2])
    shapes = [sb.Shape.needle(2), DISK]
    result = sb.distribute(mesh, shapes, [1, 3000], field, size=[0.2, 0.004], bend=True, around=across)
    assert len(result) > 1000 and sb.check_distribution(mesh, result, samples=100_000).ok


def test_shapes_too_large_for_a_rough_surface_are_soon_given_up() -> None:
    """Each try lays out the whole surface: so many a shape's area are enough, however many faces there are."""
    vertices, triangles = meshes.torus(70, 35)
    rough = vertices * (1 + 0.03 * np.random.default_rng(0).standard_normal((len(vertices), 1)))
    mesh = sb.Mesh(rough, triangles)
    result = sb.distribute(mesh, STAR, [50], size=0.3 * np.sqrt(mesh.area))
    assert result.stop_reason == "tired"
    assert sum(result.rejections.values()) < 0.6 * len(triangles)


@pytest.mark.parametrize("more", [{}, {"counts": [40]}, {"counts": [40], "density": np.ones(625)}])
def test_a_gap_that_hardly_anything_fits_with_ends_soon(more) -> None:
    mesh, field = plane()
    begin = time.process_time()
    result = sb.distribute(mesh, STAR, field=field, size=0.01, gap=1.05, threads=1, **more)
    assert len(result.placements) == 0 and result.rejections["boundary"] < 1000
    assert time.process_time() - begin < 5


def test_where_hardly_any_can_be_laid_room_is_not_looked_for_in_smaller_and_smaller_cells() -> None:
    vertices, triangles = meshes.grid(60, 60)
    vertices = 2.0 * vertices + [0.0, 0.0, 0.3] * np.random.default_rng(0).random((len(vertices), 1))
    result = sb.distribute(sb.Mesh(vertices, triangles), DISK, [500], size=0.1, mode="packed")
    assert result.stop_reason == "tired" and 0 < len(result) < 50
    assert sum(result.rejections.values()) < 150_000  # 900,000 when cells were split for them


def test_a_surface_that_folds_is_filled_quickly() -> None:
    """A rough spot took a minute: thousands of vertices a try, and tries a hundred times too many."""
    vertices, triangles = meshes.grid(120, 120)
    rough = np.linalg.norm(vertices[:, :2] - 0.5, axis=1) < 0.15
    vertices[rough, 2] = np.random.default_rng(0).uniform(-0.02, 0.02, rough.sum())
    mesh = sb.Mesh(vertices, triangles)
    field = sb.direction_field(mesh, 2)
    began = time.process_time()
    result = sb.distribute(mesh, STAR, field=field, size=0.05, maximal=True, tolerance=0.02, threads=1)
    assert time.process_time() - began < 3
    assert result.stop_reason == "full"
    assert len(result) > 90
    assert result.certificate is not None
    assert result.certificate.uncertified_area < mesh.face_areas[rough[triangles].any(axis=1)].sum()
    assert sb.check_distribution(mesh, result, samples=0)


def test_planes_that_are_laid_on_others_with_hardly_a_width() -> None:
    """Copies larger than the faces of boxes: what such planes foresee is far away, and was followed there."""
    for seed in range(12):
        mesh = sb.Mesh(*families.lattice(np.random.default_rng(seed)))
        for symmetry in (1, 4):
            field, size = sb.direction_field(mesh, symmetry), np.sqrt(0.5 * mesh.area / 25 / NEEDLE.area)
            result = sb.distribute(mesh, NEEDLE, 25, field=field, size=size)
            assert sb.check_distribution(mesh, result, samples=20_000).ok


def test_forbidden_faces_here_and_there() -> None:
    """No vertex is within what is forbidden, and hardly a corner of a copy that nothing else forbids."""
    mesh = sb.Mesh(*meshes.torus(60, 30))
    field, forbidden = sb.direction_field(mesh, 2), mesh.triangles[:, 0] % 5 == 0
    result = sb.distribute(mesh, STAR, field=field, size=0.09, maximal=True, forbidden=forbidden)
    assert result.stop_reason == "full"
    assert len(result) > 20
    assert result.certificate.leaves < 10_000  # places that nothing but trying tells
    outlines = np.concatenate([loop for i in range(len(result)) for loop in result.outline(i)])
    inner = sb.project(mesh, outlines)
    deep = forbidden[inner.faces] & (inner.barycentric.min(axis=1) > 1e-6)
    assert not deep.any()
