# SPDX-License-Identifier: GPL-3.0-or-later
"""Six jobs of an artist by real clicks (artist.py): how many clicks each takes, what it makes, whether the tab fits."""

import pytest

from tests.addon_ui.runs import play, seen

PATIENCE = 1200  # seconds for everything, on a slow machine that draws in software
# Nothing is typed; strokes come on top.
MOST_CLICKS = {
    "panels_on_a_car": 2,
    "leather": 2,
    "lamp_to_stl": 3,
    "stippled_portrait": 3,
    "remesh": 3,
    "scales_along_strokes": 3,
}
LEAST_POINTS = {
    "panels_on_a_car": ("cells", 10_000),
    "leather": ("cells", 10_000),
    "lamp_to_stl": ("shell", 10_000),
    "stippled_portrait": ("voronoi centers", 6_000),
    "remesh": ("dual", 2_000),
    "scales_along_strokes": ("shapes", 10_000),
}


@pytest.fixture(scope="module")
def report():
    """What the jobs made, by name, in a window of 1680 x 1050 pixels."""
    return play("artist", 1680, 1050, PATIENCE)


@pytest.mark.parametrize("job", MOST_CLICKS)
def test_a_job_takes_few_clicks(report, job):
    result = seen(report, job)
    role, least = LEAST_POINTS[job]
    assert 1 <= result["clicks"] <= MOST_CLICKS[job]
    assert result["outputs"][role] >= least


def test_the_lamp_is_a_file_to_print(report):
    (size,) = seen(report, "lamp_to_stl")["files"].values()
    assert size > 500_000


def test_scales_lie_along_the_strokes(report):
    result = seen(report, "scales_along_strokes")
    assert result["strokes"] == 10 and result["follows"] == "ANNOTATIONS"


@pytest.mark.parametrize("job", ["panels_on_a_car", "remesh", "leather"])
def test_the_tab_is_a_screen_high_at_first_and_after_a_look(report, job):
    assert seen(report, job)["hidden"] == [0, 0]
