# SPDX-License-Identifier: MIT
"""A short run of random input past the truths, and the table of what guards what."""

from __future__ import annotations

import math
import os

import numpy as np
import pytest

from tests.truth import families, fuzz, table
from tests.truth.registry import Check, load_checks

SECONDS = 60.0
SETTLED_SEED, SETTLED_CASES = families.NEWEST, 3000


@pytest.fixture(scope="module")
def worker():
    """One process for all cases of old findings; a case that it dies of, or hangs in, is told, and another follows."""
    worker = fuzz.Worker()
    yield worker
    worker.close()


def test_random_input_meets_the_truths():
    """The same cases each time: with new seeds a search still finds something every few minutes, see docs/truths.md.

    SADDLEBACK_FUZZ_SEED searches from another seed for a minute; each finding prints a command of its own.
    """
    asked = os.environ.get("SADDLEBACK_FUZZ_SEED")
    seed, most_cases = (families.NEWEST + int(asked) % 10**12, math.inf) if asked else (SETTLED_SEED, SETTLED_CASES)
    settled = [check for check in load_checks().values() if not check.unsettled]
    done = fuzz.run(settled, SECONDS, seed, os.cpu_count() or 1, most_cases)
    assert not done.findings, f"seed {seed}:\n" + "\n".join(done.findings)
    assert done.outcomes["fine"] > 0.5 * sum(done.outcomes.values()), dict(done.outcomes)


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        ("cells_exact.check_dual_edges_are_ways", 123034344),  # parts ran out between two sites 6e-5 apart
        ("cells_exact.check_dual_edges_are_ways", 20270111),  # a sliver of a third cell between all samples
        ("cells_exact.check_dual_edges_are_ways", 4668),  # straight to the place beside the site, on another sheet
        ("cells_exact.check_dual_edges_are_ways", 8006),  # by a corner of the boundary, straight over nothing
        ("cells.exact_cells_of_places", 1000000149555),  # a spike of needles: three gigabytes of windows went round it
        ("cells_exact.check_dual_edges_from_either_side", 1000031016488),  # past the end of a border, on each side
        ("cells_exact.check_dual_edges_from_either_side", 1000031014354),  # over a target in space, aimed at for ever
        ("cells_exact.check_dual_edges_from_either_side", 1000031007050),  # by a coarse graph's paths
        ("cells_exact.check_dual_edges_from_either_side", 1000051008471),  # along the surface's border
        ("cells_exact.check_borders_are_nearest", 1000020346635),  # a site that lags little all along another's ridge
        ("cells_exact.check_borders_are_nearest", 1000020354905),
        ("cells_exact.check_cells_without_places", 1000020332442),
        ("cells_exact.check_borders_are_nearest", 612),  # straight on at a corner, another way beside it
        ("mapped.solids_unroll", 1000001005532),  # an edge farthest from the surface between two samples
        ("disks.inset_disks", 1000020335261),  # a twin hidden by a weight as large as their distance
        ("surfaces.graphs_without_places", 1000020262499),  # far ends of thin tubes, near each other in space
        ("cells.cells_of_few_sites", 123091566),  # told in single precision to be as near as another way
        ("lines_and_maps.lines_along_fields", 20626990),  # ended at a singularity past its length
        ("shapes.innocent_shapes", 123100773),  # an edge 1e-5 long, seen along
        ("graph.path_lengths", 20460663),  # wandered through a region of 1e-9 of its distance, all of it on a ray
        ("cells.places_in_cells", 66001587),  # a site seen straight that claims nothing of the face
        ("cells.cells_of_places", 1000000000284),  # corners far outside a cell, reached over its own vertices only
        ("cells.cells_of_places", 1000000000603),
        ("cells.cells_of_places", 1000000000718),
        ("cells.cells_of_places", 1000000000741),  # in line along the border, on a flat grid
        ("cells.cells_of_places", 1000000044051),  # behind a site at a vertex, as if its ways bent there
        ("cells.cells_of_places", 1000071035246),  # a corner behind a hole, laid flat as if nothing were between
        ("cells.cells_of_places", 1000031020836),
        ("cells.cells_of_places", 1000071078380),  # corners told too far: nodes of other cells are on the way
        ("cells.cells_of_places", 1000000134431),
        ("cells.cells_of_places", 1000000080266),
        ("cells.cells_of_places", 1000031028316),
        ("cells.cells_of_places", 1000000141187),  # the node on the way is as near to a site of a smaller number
        ("cells.cells_of_places", 1000020321672),
        ("cell_parts.boundaries_are_midway", 20329483),  # a third cell between two, told from two corners alone
        ("cell_parts.boundaries_among_needles", 795778662590),
        ("cell_parts.polygons_beside_barriers", 20406904),  # a corner on the point of a barrier that was tried
        ("relaxation.least_sums_of_squares", 72000214),  # to and fro across a valley, between ways that bend
        ("relaxation.least_sums_of_squares", 72000855),  # held by the border, a hundred times
        ("relaxation.least_sums_of_squares", 74000016),  # the least is at a saddle that ways bend at
        ("relaxation.least_sums_of_squares", 74000560),
        ("relaxation.least_sums_of_squares", 72000863),
        ("relaxation.least_sums_of_squares", 72001955),
        ("relaxation.least_sums_of_squares", 74002574),  # the least is farther along the border
        ("relaxation.least_sums_of_squares", 91003354),  # begun at a saddle, whose mean told no way down
        ("relaxation.least_sums_of_squares", 91004980),
        ("relaxation.least_sums_of_squares", 91001186),  # at a vertex where the border is more than half a turn
        ("outlines.safe_distances", 20301927),  # needles side by side, told apart by the tables' angles
        ("outlines.safe_distances", 892871),  # a strip before the other's first
        ("ways.maps_do_not_fold", 20284100),  # parts of a face that have no area but for rounding, refused
        ("ways.maps_do_not_fold", 20284209),  # far from the origin a step of a line across is rounding, refused
        ("ways.maps_do_not_fold", 20284539),  # a closed curve that ends along its beginning: flow below doubles between
        ("ways.maps_do_not_fold", 1000020284682),  # half of a disk on a neck of 1e-9: folded by what factors round
        ("ways.maps_do_not_fold", 30520017),  # a fan of slivers laid on each other
        ("ways.map_of_a_disk", 168109),  # seen past a ring of 1e-5, longer by 2e-12
        ("plane.lifted_cells", 12073),  # sides of twins in line to rounding, met as if none were between them
        ("plane.lifted_cells", 28583),
        ("disks.lifted_disks", 1000000049687),  # a triangle that reaches far beyond a narrow cell it has its middle in
        ("disks.lifted_disks", 41134446),  # both sides of a cell in one line: what lies beside became the cell's
        ("relaxation.values_between_places", 5612356),  # two places 1e-5 apart pulled a third
        (
            "ways.maps_hold_what_lies_beside",
            1000000010338,
        ),  # triangles nearly as large as a band that is wide and short
        ("ways.maps_of_narrow_bands", 1000000032335),
        ("ways.maps_hold_what_lies_beside", 20270245),  # an edge cut at the radius saw past an end of the curve
        ("ways.maps_hold_what_lies_beside", 20275565),
        ("ways.maps_of_narrow_bands", 1000010128640),  # places beside an origin far away were rounded
        ("ways.maps_of_narrow_bands", 1000000161763),
        ("ways.maps_of_narrow_bands", 1000000086059),
        ("ways.maps_of_narrow_bands", 6),  # slivers of a curve's parts, all halved to the end: no end
        ("ways.maps_of_narrow_bands", 11),
        ("plane.clipped_cells", 20567684),  # sides of twins in line to rounding: no corner between them
        ("baked.texels_of_cells", 30508662),  # rays went round a spike of 6e-9 radians without end, never at its tip
        ("sweeps.ties_of_a_circle", 31001546),  # six arcs vanish in the moment in which a site is touched
        ("sweeps.ties_of_a_circle", 31000843),  # twins an ulp apart, touched in the wrong order
        ("sweeps.ties_of_a_circle", 893636),  # begun in a vertex, whose event was not told
        ("disks.clipped_disks_in_line", 10),  # vertices 1e16 away, to which a curve had no points near the domain
        ("disks.clipped_disks_in_line", 51),
        ("disks.wanted_areas", 551),  # a border that passes two sites close by, as one piece
        ("relaxation.centers_of_the_plane", 20280198),  # a place within rounding of a vertex saw all in its direction
        ("relaxation.centers_of_the_plane", 777013576),  # an obtuse corner nearer than both ends of the side across
        ("relaxation.centers_of_the_plane", 555000955),  # a millionth of the size beside an edge, seen end-on
        ("relaxation.corners_of_the_plane", 20407879),  # a corner of flat angles: three times the tolerance
    ],
)
def test_what_a_search_found_stays_mended(worker, name, seed):
    outcome = worker.run(fuzz.random_case(load_checks()[name], seed))
    assert outcome.word == "fine", outcome.text


def test_every_entry_point_has_a_guard():
    empty = [name for name, guards in table.guards_of(load_checks()).items() if not guards]
    assert not empty, "register a check of tests/truth for each of these"


def test_the_page_shows_what_is_so():
    assert table.PAGE.read_text(encoding="utf-8") == table.page(), "run python -m tests.truth.table"


@pytest.mark.parametrize("family", families.FAMILIES)
def test_families_make_triangles(family):
    for seed in range(20):
        vertices, triangles = families.FAMILIES[family](np.random.default_rng(seed))
        assert vertices.shape[1] == triangles.shape[1] == 3
        assert 1 <= len(triangles) <= 1000
        assert np.isfinite(vertices).all()
        assert 0 <= triangles.min() <= triangles.max() < len(vertices)


def test_few_rows_remain_of_what_fails():
    wanted = {3, 77}
    rows = fuzz.fewest_rows(100, lambda rows: wanted <= set(rows.tolist()))
    assert set(rows.tolist()) == wanted


def errs(mesh: object, rng: np.random.Generator) -> None:
    raise AssertionError("as planned")


def test_a_crash_and_a_wrong_answer_are_findings():
    """With checks of this file, which a worker cannot import by registry: here in this process, there by a signal."""
    check = Check("planned", errs, (), "mesh")
    case = fuzz.random_case(check, 5)
    assert fuzz.attempt(check, case).word == "finding"
    vertices, triangles = case.arrays
    assert "as planned" in fuzz.told(case, fuzz.with_rows(case, np.array([0])), fuzz.attempt(check, case))
    assert len(fuzz.with_rows(case, np.array([0])).arrays[1]) == 1
    assert len(vertices) >= 3
    assert len(triangles) >= 1


def test_a_worker_that_dies_is_a_finding_and_is_replaced():
    worker = fuzz.Worker()
    name = next(iter(load_checks()))
    case = fuzz.random_case(load_checks()[name], 0)
    worker._process.kill()
    assert worker.run(case).word == "finding"
    assert worker.run(case).word in ("fine", "refused")
    worker.close()
