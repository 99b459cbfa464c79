# SPDX-License-Identifier: MIT
"""Questions about shapes: their outlines, maps and distributions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

import saddleback as sb
from tests import meshes
from tests.digest_questions.asking import Way, all_of, asked, surface
from tests.digest_questions.plane import SQUARE
from tests.digest_questions.surfaces import LARGE, density_of

FRAME = sb.Shape([SQUARE * 2 - 1, (SQUARE - 0.5)[::-1]])
PRESETS = {
    "disk": sb.Shape.disk(24), "star": sb.Shape.star(5), "needle": sb.Shape.needle(6), "leaf": sb.Shape.leaf(),
    "drop": sb.Shape.drop(), "crescent": sb.Shape.crescent(0.8, 0.4, 20), "frame": FRAME,
}  # fmt: skip
SOLID = (
    np.array([(0.0, 0, 0), (0.5, 0, 0.1), (0.2, 0.5, 0), (0.2, 0.2, 0.4)]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]),
)


@asked(PRESETS)
def shape(given: sb.Shape, way: Way) -> Iterable[object]:
    names = "area circumradius inradius has_half_turn"
    table = sb.SafeDistanceTable(given, PRESETS["leaf"], threads=way.threads)
    turns = np.linspace(0, 6, 20)
    moved = given.moved(0.5, 0.3, (0.1, 0.2))
    return [
        *given.loops, *all_of(given, names), *moved.loops, *given.mirrored().loops,
        given.contains(np.random.default_rng(1).uniform(-1, 1, (50, 2))), given.overlaps(moved),
        table.distance(turns, turns[::-1].copy(), 1.0, 0.5), table.nbytes,
    ]  # fmt: skip


@asked({"blobs": 7, "noise": 1})
def shape_from_mask(coarse: int) -> Iterable[object]:
    image = np.kron(
        np.random.default_rng(coarse).random((40 // coarse, 40 // coarse)) > 0.45, np.ones((coarse, coarse))
    )
    made = sb.Shape.from_mask(np.pad(image, 2).astype(np.uint8) * 255)
    return [*made.loops, made.area, made.circumradius]


def placements_of(made: sb.Placements) -> list[object]:
    return [*all_of(made, "shape angle scale mirrored"), *surface(made.center)]


COVERED = {
    name: LARGE[name]
    for name in ("icosphere", "torus", "grid_jittered", "saddle", "cone", "double_torus", "bumpy_torus")
}


@asked(COVERED)
def mapped_shapes(case: meshes.Case, way: Way) -> Iterable[object]:
    random, shapes, count = np.random.default_rng(3), list(PRESETS.values()), 9
    size = 0.12 * case.mesh.area**0.5
    placements = sb.Placements(
        random.integers(0, len(shapes), count), sb.sample(case.mesh, count, seed=3), random.uniform(0, 6, count),
        np.full(count, size), random.random(count) < 0.5,
    )  # fmt: skip
    mapped = sb.map_shapes(case.mesh, shapes, placements, threads=way.threads)
    laid = [i for i in range(len(mapped)) if i not in mapped.failures]
    bent = mapped.bend([SOLID] * len(shapes), threads=way.threads)
    told = mapped.attributes(0.2 * size, threads=way.threads)
    report = sb.check_distribution(case.mesh, mapped, samples=2000, threads=way.threads)
    patches = mapped.patches()
    names = "coverage patch_coverage stretch fault_count"
    return [
        np.array(sorted(mapped.failures)), mapped.stretch, *mapped.frames(),
        *[loop for i in laid for loop in mapped.outline(i)],
        *[mapped.conform(SOLID[0], i).points for i in laid],
        *all_of(bent, "vertices heights begins triangles triangle_copy triangle_source deviations lost"),
        *all_of(patches, "vertices triangles triangle_face triangle_shape uv"),
        *all_of(told, "placement distance uv"), *all_of(report, names),
    ]  # fmt: skip


@asked(
    COVERED,
    random={"counts": [4, 5, 3]},
    packed={"counts": [4, 5, 3], "mode": "packed", "mirror": True},
    mixed={"counts": [3, 3, 3], "mode": 0.5, "size_range": (0.6, 1.0), "gap": 0.01},
)
def distribution(case: meshes.Case, way: Way, **options: Any) -> Iterable[object]:
    shapes = [PRESETS[name] for name in ("star", "disk", "crescent")]
    made = sb.distribute(case.mesh, shapes, seed=1, size=0.1 * case.mesh.area**0.5, threads=way.threads, **options)
    cut, told = made.mapped.cut(), made.mapped.attributes(0.05, threads=way.threads)
    return [
        *placements_of(made.placements), np.array(list(made.rejections.values())), *made.outline(0),
        *all_of(cut, "vertices triangles triangle_face triangle_shape uv"), *all_of(told, "placement distance uv"),
    ]  # fmt: skip


@asked(COVERED)
def distribution_field(case: meshes.Case, way: Way) -> Iterable[object]:
    along = sb.direction_field(case.mesh, 2)
    size, density = 0.15 * case.mesh.area**0.5, density_of(case)
    made = sb.distribute(
        case.mesh, PRESETS["leaf"], field=along, density=density, size=size, bend=True, counts=6, threads=way.threads
    )
    full = sb.distribute(
        case.mesh, PRESETS["star"], field=along, size=1.5 * size, maximal=True, tolerance=0.1, threads=way.threads
    )
    proof = all_of(full.certificate, "tolerance cells leaves uncertified_area")
    return [*placements_of(made.placements), *placements_of(full.placements), *proof]


@asked(COVERED, painted={}, bent={"bend": True})
def distribution_full(case: meshes.Case, way: Way, **options: Any) -> Iterable[object]:
    along, density = sb.direction_field(case.mesh, 2), density_of(case)
    made = sb.distribute(
        case.mesh, [PRESETS["leaf"], PRESETS["disk"]], field=along, size=0.15 * case.mesh.area**0.5, maximal=True,
        density=[density, np.maximum(0, density.max() - 2 * density)], tolerance=0.1, threads=way.threads, **options,
    )  # fmt: skip
    return [*placements_of(made.placements), *all_of(made.certificate, "tolerance cells leaves uncertified_area")]
