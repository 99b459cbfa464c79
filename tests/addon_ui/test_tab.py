# SPDX-License-Identifier: GPL-3.0-or-later
"""The tab in a Blender with a window: one Blender plays all scenarios (scenarios.py), each test looks at one."""

import pytest

from tests.addon_ui.runs import play, seen

PATIENCE = 420  # seconds for everything, on a slow machine that draws in software


@pytest.fixture(scope="module")
def report():
    """What the scenarios saw, by name."""
    return play("scenarios", 1280, 800, PATIENCE)


def test_the_tab_opens_and_its_panels_draw(report):
    assert seen(report, "opened")["drawn"] > 0


def test_esc_stops_within_a_tenth_of_a_second_and_changes_nothing(report):
    result = seen(report, "escaped")
    assert result["seconds"]
    assert sorted(result["seconds"])[len(result["seconds"]) // 2] <= 0.1  # a busy machine may hold one of them up
    assert result["same"]


def test_the_button_starts_a_run_whose_progress_is_drawn(report):
    result = seen(report, "tessellated")
    assert result["running"] > 2
    assert result["fractions"] == sorted(result["fractions"])
    assert len(set(result["fractions"])) > 1
    assert result["cells"] == 150
    assert result["outputs"] == ["Ball Edges"]
    for words in ("'Ball'", "150 cells", "5 iterations", " s"):
        assert words in result["line"]


def test_adjust_last_operation_computes_only_what_changed(report):
    result = seen(report, "adjusted")
    assert result["operator"] == "SADDLEBACK_OT_tessellate"
    assert result["wider"] == pytest.approx(0.04, abs=0.005)
    assert result["outputs"] == ["Ball Cells", "Ball Edges"]
    before, after = result["builds"]
    for heavy in ("mesh", "graph", "cells"):
        assert before[heavy] == after[heavy] > 0


def test_one_undo_takes_everything_back_and_redo_brings_it_again(report):
    result = seen(report, "undone")
    assert result["undo"] == [[], False]
    assert result["redo"] == [["Ball Edges"], True]


def test_nothing_jumps_where_a_transform_is_applied_and_steps_are_undone(report):
    for middle in seen(report, "applied"):
        assert middle == pytest.approx([5.0, 3.0, 1.0], abs=0.1)


def test_a_faulty_mesh_is_repaired_by_one_click(report):
    assert "'Faulty'" in seen(report, "repaired")["line"]


def test_plane_diagrams_are_made_through_the_window(report):
    result = seen(report, "divided")
    assert "'Sheet': 200 cells" in result["line"]
    assert result["roles"] == [
        "beach curve", "growing edges", "sweep circle", "voronoi cells", "voronoi centers", "voronoi edges",
    ]  # fmt: skip


def test_fields_are_combed_through_the_window(report):
    result = seen(report, "combed")
    assert "'Ball': crosses" in result["line"] and "along 1 stroke" in result["line"]
    assert {"Ball Arrows", "Ball Streamlines"} <= set(result["outputs"])


def test_shapes_are_laid_through_the_window(report):
    result = seen(report, "clothed")
    assert "'Ball': 100 shapes" in result["line"]
    assert {"Ball Shapes", "Ball Shape Instances", "Ball Shape Outlines"} <= set(result["outputs"])


def test_one_click_makes_a_look_and_the_button_stays(report):
    result = seen(report, "dressed")
    assert result["made"] == {"cells": "Saddleback Panels"} and result["look"] == "PANELS"
    assert result["places"][0] == result["places"][1]


def test_a_second_layer_lies_beside_the_first(report):
    result = seen(report, "layered")
    assert result["names"] == ["Panels", "Scales"]
    assert result["made"] == {"cells": False, "shapes": True} and result["hidden"] == ["cells"]


def test_cells_follow_a_dab_of_the_brush(report):
    result = seen(report, "followed")
    assert result["previews"] > 0 and result["changed"] > 20
    assert result["seconds"] < 0.1  # of the main thread, in one piece
    assert result["undone"]


def test_the_tab_says_what_to_do_without_a_mesh(report):
    assert seen(report, "refused")["drawn"] > 0
