# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes on a surface as the add-on asks for them: counts, sizes, fields, what is made of the placements."""

import re
import time
import tracemalloc
from dataclasses import fields, replace
from types import SimpleNamespace

import numpy as np
import pytest

from saddleback_blender.core import distribute_runs, distribute_texts, native, runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.errors import BadInputError
from saddleback_blender.core.requests import DirectionFieldRequest, DistributeRequest, GivenDirections, Surface
from saddleback_blender.core.settings import DirectionFieldSettings, DistributeSettings
from saddleback_blender.core.shapes.shape_presets import preset
from saddleback_blender.core.shapes.shape_sizes import Placed, fitted_to_count
from saddleback_blender.core.shapes.shape_templates import fans, fitted
from saddleback_blender.core.surfaces.quaternions import turned
from tests import meshes

BALL = meshes.icosphere(4)
FEW = {"count": 60, "packing": 0.0}


def surface_of(vertices, triangles):
    return Surface("Thing", np.asarray(vertices, np.float64), np.asarray(triangles, np.int32), len(vertices))


def run(templates=None, arrays=BALL, cache=None, options=None, **settings):
    surface = surface_of(*arrays)
    request = DistributeRequest(
        surface,
        DistributeSettings(**(FEW | settings)),
        tuple(templates or preset("SCALES")),
        **(options or {}),
    )
    return distribute_runs.distribute(request, runs.new_progress(), cache or Cache(2**28))


def panel(symmetry="1"):
    return DirectionFieldRequest(surface_of(*BALL), DirectionFieldSettings(symmetry=symmetry))


@pytest.mark.parametrize("power", [1.0, 1.3, 2.0, 3.0, 4.0])
@pytest.mark.parametrize("first", [700, 1100, 1250])
def test_a_size_is_found_in_few_trials_however_the_count_falls_with_it(power, first):
    trials = []

    def place(size, most):
        trials.append(size)
        placements = range(min(int(first * size**-power), most))
        return Placed(size, SimpleNamespace(placements=placements), ())

    found = fitted_to_count(place, 1.0, 1000, fills=True, maximal=False)
    assert abs(len(found.result.placements) - 1000) <= 50
    assert len(trials) <= (3 if power < 4.0 else 5)


def test_shapes_are_laid_bent_and_framed():
    result = run(make_outlines=True, write_attributes=True, options={"field": panel()})
    assert result.class_counts.tolist() == [60] and result.text.startswith("60 shapes")
    assert result.lines[0].startswith("Covered: 40.0%")
    placed = result.placed
    np.testing.assert_allclose(np.linalg.norm(placed.points, axis=1), 1, atol=0.01)
    np.testing.assert_allclose(turned(placed.rotations, np.tile([0, 0, 1.0], (60, 1))), placed.points, atol=0.05)
    bent = result.bent
    assert set(bent.polygon_copy) == set(range(60)) and bent.offsets[-1] == len(bent.corners) == len(bent.uv)
    radius = np.linalg.norm(bent.vertices, axis=1)
    assert radius.min() > 0.98 and radius.max() > 1.02
    # Faces look outwards, and each copy stays about its center.
    first = bent.vertices[bent.corners[bent.offsets[:-1]]]
    second, third = (bent.vertices[bent.corners[bent.offsets[:-1] + i]] for i in (1, 2))
    outwards = (np.cross(second - first, third - first) * first).sum(axis=1)
    assert (outwards > 0).mean() > 0.9
    assert np.linalg.norm(first - placed.points[bent.polygon_copy], axis=1).max() < 1.5 * placed.scales.max()
    assert len(result.outlines.lengths) == 60 and result.outlines.closed.all()
    inside = result.values.distance < 0
    assert 0.3 < inside.mean() < 0.5 and (result.values.shape[inside] >= 0).all()
    assert np.ptp(result.values.uv[inside]) > 0.5


def test_shapes_bend_along_the_field():
    bent = run(preset("FEATHERS"), bend=True, make_outlines=True, options={"field": panel()})
    straight = run(preset("FEATHERS"), make_outlines=True, options={"field": panel()})
    assert bent.class_counts.sum() >= 50
    assert not np.array_equal(bent.outlines.points[:50], straight.outlines.points[:50])
    assert run(preset("FEATHERS"), bend=True, count=20).class_counts.sum() == 20  # along the smoothest field
    fill = {"maximal": True, "size": 0.3, "make_outlines": True}
    full, stiff = (run(preset("FEATHERS"), bend=bend, **fill) for bend in (True, False))
    assert full.lines[-1].startswith("Proved full") and not full.warnings
    assert full.outlines.points.shape != stiff.outlines.points.shape


def test_mirrored_copies_face_outwards_too():
    drop = np.stack([np.cos(np.linspace(0, 6, 20)), np.sin(np.linspace(0, 6, 20)) * 0.5], axis=1)
    template = fitted("Drop", [[drop]], np.zeros(2), preset("SCALES")[0].solid)
    result = run([template], mirror=True)
    bent = result.bent
    mirrored = result.placed.scales[:, 1] < 0
    assert 0.2 < mirrored.mean() < 0.8
    a, b, c = (bent.vertices[bent.corners[bent.offsets[:-1] + i]] for i in (0, 1, 2))
    outwards = (np.cross(b - a, c - a) * a).sum(axis=1) > 0
    for chosen in (mirrored, ~mirrored):
        assert outwards[chosen[bent.polygon_copy]].mean() > 0.9


def test_shapes_without_a_solid_raise_the_surface():
    ring = np.stack([np.cos(np.arange(24) / 24 * 2 * np.pi), np.sin(np.arange(24) / 24 * 2 * np.pi)], axis=1)
    result = run([fitted("Ring", [[ring, 0.5 * ring]], np.zeros(2))], thickness=0.05, count=20)
    bent = result.bent
    radius = np.linalg.norm(bent.vertices, axis=1)
    assert 0.98 < radius.min() < 1.0 and 1.04 < radius.max() < 1.06
    for copy in range(20):
        chosen = bent.polygon_copy == copy
        rows = [bent.corners[a:b] for a, b in zip(bent.offsets[:-1][chosen], bent.offsets[1:][chosen], strict=True)]
        edges = {(int(a), int(b)) for row in rows for a, b in zip(row, np.roll(row, -1), strict=True)}
        lone = [(a, b) for a, b in edges if (b, a) not in edges]
        # Open only below: around the outline and around the hole.
        assert lone and all(radius[a] < 1.001 for a, _ in lone)
        assert len({a for a, _ in lone}) == len(lone)
    assert bent.uv.min() >= -1e-9 and bent.uv.max() <= 1 + 1e-9


def test_counts_follow_the_shares_to_the_last_one():
    leaves = preset("LEAVES")
    result = run(leaves, count=50)
    assert result.class_counts.tolist() == [20, 30] and "20 Leaf, 30 Small Leaf" in result.text
    scales = result.placed.scales[:, 0]
    np.testing.assert_allclose(scales, scales[0])  # sizes of classes are in their outlines
    three = [replace(template, share=1.0) for template in (*leaves, leaves[0])]
    assert sorted(run(three, count=50).class_counts.tolist()) == [16, 17, 17]
    with pytest.raises(BadInputError, match="the shares of all shapes are 0"):
        run([replace(leaves[0], share=0.0)])


def test_shapes_are_small_where_the_density_is_high():
    z = BALL[0][:, 2]
    density = np.where(z > 0, 4.0, 1.0)
    result = run(preset("STUDS"), size_by_density=True, count=120, options={"density": density})
    top = result.placed.points[:, 2] > 0.1
    bottom = result.placed.points[:, 2] < -0.1
    sizes = result.placed.scales[:, 0]
    assert np.median(sizes[bottom]) == pytest.approx(2 * np.median(sizes[top]), rel=0.05)
    assert top.sum() > 2.5 * bottom.sum()
    varied = run(size_variation=0.5).placed.scales[:, 0]
    assert varied.max() <= 2.001 * varied.min() and varied.max() > 1.6 * varied.min()


def test_nothing_is_laid_where_it_is_forbidden():
    forbidden = BALL[0][:, 2] > 0
    result = run(count=30, make_bent=False, write_attributes=True, options={"forbidden": forbidden})
    assert (result.placed.points[:, 2] < 0).all()
    assert not (result.values.distance[BALL[0][:, 2] > 0.1] < 0).any()


@pytest.mark.parametrize("domain", ["POINT", "FACE"])
def test_shapes_follow_a_vector_attribute(domain):
    vertices, triangles = BALL
    places = vertices if domain == "POINT" else vertices[triangles].mean(axis=1)
    east = np.stack([-places[:, 1], places[:, 0], 0.3 * np.ones(len(places))], axis=1)
    polygons = np.arange(len(triangles), dtype=np.int32) if domain == "FACE" else None
    given = GivenDirections(east, 1, "attribute 'flow'", polygons)
    result = run(make_bent=False, options={"field": given})
    x = turned(result.placed.rotations, np.tile([1.0, 0, 0], (60, 1)))
    there = result.placed.points
    wanted = np.stack([-there[:, 1], there[:, 0], 0.3 * np.ones(60)], axis=1)
    wanted -= (wanted * there).sum(axis=1, keepdims=True) * there
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    far_from_poles = np.abs(there[:, 2]) < 0.8
    assert (x * wanted).sum(axis=1)[far_from_poles].min() > 0.99
    east[:5] = 0
    with pytest.raises(BadInputError, match=r"'Thing': attribute 'flow' has no direction .* of 5120 faces"):
        run(options={"field": GivenDirections(east * (domain == "FACE"), 1, "attribute 'flow'", polygons)})


def test_outputs_do_not_compute_the_placements_again():
    cache = Cache(2**28)
    first = run(cache=cache)
    again = run(cache=cache, make_outlines=True, write_attributes=True)
    assert cache.builds["shapes"] == cache.builds["mapped shapes"] == 1
    np.testing.assert_array_equal(first.bent.vertices, again.bent.vertices)
    other = run(cache=cache, seed=1)
    assert cache.builds["shapes"] == 2 and not np.array_equal(other.placed.points, first.placed.points)


def test_shapes_are_checked_by_other_mathematics():
    request = DistributeRequest(surface_of(*BALL), DistributeSettings(count=40, packing=0.0), tuple(preset("SCALES")))
    report = distribute_runs.check(request, runs.new_progress(), Cache(2**28))
    assert report.text == "40 shapes checked: none touches another" and not report.faults
    assert 0.35 < float(report.lines[0].split()[1].rstrip("%")) / 100 < 0.45
    assert distribute_texts.fault("crossing", 3, 5, (1.0, 2.0, 0.5)) == "Shape 3 crosses shape 5 at (1, 2, 0.5)"


def test_filling_is_proved():
    result = run(preset("STUDS"), size=0.25, maximal=True, count=5)
    assert len(result.placed.shape) > 20 and "nothing more fits" in result.text
    assert any(line.startswith("Proved full") for line in result.lines)
    packed = run(preset("STUDS"), size=0.25, maximal=True, packing=1.0)
    assert len(packed.placed.shape) > len(result.placed.shape)


@pytest.mark.parametrize("size", [0.25, 0.0])
def test_filling_keeps_to_where_the_density_is_painted(size):
    density = np.maximum(0.0, BALL[0][:, 2])
    result = run(preset("STUDS"), size=size, maximal=True, options={"density": density})
    assert any(line.startswith("Proved full") for line in result.lines)
    heights = result.placed.points[:, 2]
    assert heights.min() > -0.15 and (heights < 0.25).sum() > 5  # down to the rim, where the density is low
    assert len(heights) > 10 if size else abs(len(heights) - 60) <= 3


def test_counts_that_do_not_fit_are_told():
    result = run(preset("STUDS"), size=0.3, count=500)
    assert len(result.placed.shape) < 100 and "no more room" in result.text
    assert result.text.startswith(f"{len(result.placed.shape)} of 500 shapes, no more")
    assert result.warnings == (
        f"{500 - len(result.placed.shape)} of 500 shapes found no room; make them smaller, or raise Packing",
    )
    # None at all is no result.
    with pytest.raises(
        BadInputError, match=r"'Thing': no shape found room at a radius of 1.9 \(tries refused: .* stretched"
    ):
        run(preset("STUDS"), size=1.9)
    with pytest.raises(
        BadInputError, match=r"'Thing': 'Stud' has an area of 7\d{3}, larger than the surface.*; make Size"
    ):
        run(preset("STUDS"), size=50.0)
    with pytest.raises(BadInputError, match=r"gap is 100: 'Scale' with half of it around .*; make Gap or Size smaller"):
        run(gap=100.0, size=0.1)
    with pytest.raises(BadInputError, match="the group Keep Off leaves no place for a shape"):
        run(options={"forbidden": np.ones(len(BALL[0]), bool)})


STAR = np.stack([np.cos(np.arange(10) * np.pi / 5), np.sin(np.arange(10) * np.pi / 5)], axis=1)
STAR[1::2] *= 0.38


@pytest.mark.parametrize("packing", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("maximal", [False, True])
def test_so_many_are_as_large_as_fits_them(packing, maximal):
    star = fitted("Star", [[STAR]], np.zeros(2))
    result = run([star], packing=packing, maximal=maximal, make_bent=False)
    count = len(result.placed.shape)
    if packing or maximal:
        assert abs(count - 60) <= 3 and not result.warnings and " of " not in result.text
        # All over the surface: none of its octants is bare.
        octants = np.bincount((result.placed.points > 0) @ [1, 2, 4], minlength=8)
        assert octants.min() >= 4
    else:
        assert count == 60


def test_shapes_of_which_millions_would_fit_are_refused():
    with pytest.raises(BadInputError, match=r"at a radius of 0\.0005 there is room for more than 2 million shapes"):
        run(preset("STUDS"), size=0.0005, count=5)


def test_a_surface_in_hundreds_of_pieces_takes_what_fits_them():
    vertices, triangles = meshes.icosphere(2)
    loose = vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    result = run(preset("STUDS"), arrays=loose, count=40, packing=1.0, make_bent=False)
    assert len(result.placed.shape) >= 38


def test_a_surface_that_bends_too_much_for_its_area_takes_smaller_shapes_soon():
    """White noise: nowhere do shapes go that are as large as its area has room for, and looking for room takes long."""
    vertices, triangles = meshes.grid(60, 60)
    vertices = 2.0 * vertices + [0.0, 0.0, 0.3] * np.random.default_rng(0).random((len(vertices), 1))
    began = time.process_time()
    result = run(preset("STUDS"), arrays=(vertices, triangles), count=400, packing=1.0, make_bent=False)
    assert time.process_time() - began < 5.0  # 43 when shapes were too large at first
    assert abs(len(result.placed.shape) - 400) <= 20 and not result.warnings
    middle = vertices.mean(axis=0)[:2]
    assert np.bincount((result.placed.points[:, :2] > middle) @ [1, 2], minlength=4).min() > 70


def test_a_gap_makes_so_many_smaller():
    plain, apart = (run(preset("STUDS"), count=40, gap=gap, make_bent=False) for gap in (0.0, 0.2))
    assert len(plain.placed.shape) == len(apart.placed.shape) == 40
    assert apart.placed.scales.max() < 0.9 * plain.placed.scales.max()


def test_a_count_that_leaves_a_part_bare_is_told():
    result = run(preset("STUDS"), packing=1.0, size=0.1, make_bent=False)
    assert len(result.placed.shape) == 60 and "what they did not reach is bare" in result.warnings[0]
    assert not run(preset("STUDS"), packing=0.0, size=0.1, make_bent=False).warnings


def passing_pairs(result):
    """Pairs of copies that pass through each other, by exact tests of all their triangles."""
    bent = result.bent
    owner = np.repeat(bent.polygon_copy, np.diff(bent.offsets) - 2)
    found = owner[native.load().self_crossings(bent.vertices, bent.corners[fans(bent.offsets)])]
    return {tuple(sorted(pair)) for pair in found.tolist() if pair[0] != pair[1]}


@pytest.mark.parametrize("shapes", ["SCALES", "LEAVES"])
def test_shapes_that_overlap_pass_through_none_if_asked(shapes):
    options = {"count": 120, "packing": 1.0, "overlap": 0.6, "fit": 0.04}
    plain = run(preset(shapes), **options)
    clear = run(preset(shapes), no_crossings=True, **options)
    assert len(passing_pairs(plain)) > 10 and not passing_pairs(clear)
    assert re.fullmatch(r"\d+ shapes are drawn smaller, not to pass through others", clear.lines[-1])
    assert not clear.warnings and "smaller" not in " ".join(plain.lines)
    assert len(set(clear.bent.polygon_copy)) == clear.class_counts.sum()


TWO_SHEETS = meshes.grid(12)
TWO_SHEETS = (
    np.concatenate([TWO_SHEETS[0], TWO_SHEETS[0] + (0.0, 0.0, 1e-7)]),
    np.concatenate([TWO_SHEETS[1], TWO_SHEETS[1] + len(TWO_SHEETS[0])]),
)


@pytest.mark.parametrize("arrays", [BALL, TWO_SHEETS], ids=["smaller", "left out"])
def test_copies_bent_to_be_cleared_are_those_that_are_shown(arrays):
    cache, options = Cache(2**28), {"arrays": arrays, "count": 80, "overlap": 0.6, "no_crossings": True}
    # Where they were cleared before they are bent anew, all at once.
    first, again = (run([*preset("SCALES"), *preset("LEAVES")], cache=cache, **options).bent for _ in range(2))
    for field in fields(first):
        assert np.array_equal(getattr(first, field.name), getattr(again, field.name)), field.name


def test_whole_shapes_that_the_surface_bends_too_much_for_are_tried_smaller_alone(monkeypatch):
    sb, sizes = native.load(), []
    real = sb.map_shapes

    def counting(mesh, shapes, placements, *rest, **options):
        sizes.append(len(placements))
        return real(mesh, shapes, placements, *rest, **options)

    vertices, triangles = BALL
    rough = vertices * (1.0 + 0.02 * np.random.default_rng(0).standard_normal((len(vertices), 1)))
    monkeypatch.setattr(sb, "map_shapes", counting)
    run(arrays=(rough, triangles), count=100, size=0.2, overlap=0.7, make_bent=False)
    whole = max(sizes)
    assert len(sizes) > 5 and sizes.count(whole) == 3  # the footprints, all at their full size, all as they are drawn
    assert sizes[2:-1] == sorted(sizes[2:-1], reverse=True)


def test_shapes_that_pass_through_others_at_any_size_are_missing_and_told():
    result = run(arrays=TWO_SHEETS, count=80, overlap=0.5, no_crossings=True)
    missing = result.class_counts.sum() - len(set(result.bent.polygon_copy))
    assert missing > 0 and not passing_pairs(result)
    assert result.warnings[-1:] == distribute_texts.left_out(missing)


def test_counts_of_shapes_are_told_in_one_sentence_or_none():
    assert distribute_texts.made_smaller(0) == () == distribute_texts.left_out(0)
    assert distribute_texts.made_smaller(1) == ("1 shape is drawn smaller, not to pass through others",)
    assert distribute_texts.left_out(1)[0].startswith("1 shape is missing")


def test_more_faces_than_memory_has_room_for_are_refused_before_they_are_made(monkeypatch):
    monkeypatch.setattr(distribute_runs, "MOST_FACES", 10_000)
    with pytest.raises(BadInputError, match=r"60 bent copies would have 11,\d+ faces; lay fewer or larger ones"):
        run(make_bent=True)
    assert len(run(make_bent=False, make_instances=True).placed.points) == 60
    assert run(make_bent=True, count=40).bent is not None


def test_gaps_are_filled_to_as_many_faces_as_memory_has_room_for(monkeypatch):
    """Parts narrower than the shapes take many times as many small ones as were asked for."""
    settings = {"count": 80, "overlap": 0.5, "no_crossings": True, "fill_gaps": True}
    whole = run(arrays=TWO_SHEETS, **settings)
    faces, copies = len(whole.bent.polygon_copy), len(set(whole.bent.polygon_copy))
    assert not any("Gaps are left" in line for line in whole.warnings) and copies > 100
    monkeypatch.setattr(distribute_runs, "MOST_FACES", faces * 3 // 4)
    fewer = run(arrays=TWO_SHEETS, **settings)
    assert len(set(fewer.bent.polygon_copy)) < copies and len(fewer.bent.polygon_copy) <= faces * 3 // 4
    assert fewer.warnings[-1:] == distribute_texts.unfilled(faces * 3 // 4)


def test_bent_copies_take_little_more_memory_on_their_way_than_at_its_end():
    run(make_bent=True, count=10)  # what is imported and kept on the way
    tracemalloc.start()
    found = run(make_bent=True, count=2000)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 400 * len(found.bent.polygon_copy)
