# SPDX-License-Identifier: GPL-3.0-or-later
"""What tests of Auto Update begin with."""

import bpy
import pytest
from scenes import sphere, switch_on

from saddleback_blender.ops import live


@pytest.fixture(autouse=True)
def little_rest(monkeypatch):
    """Nobody is at a stroke, whose end results wait for."""
    monkeypatch.setattr(live, "REST", 0.03)


@pytest.fixture
def item():
    """A ball with cells that follow."""
    ball = sphere(subdivisions=4)
    ball.vertex_groups.new(name="paint").add([0], 1.0, "REPLACE")
    settings = ball.saddleback.tessellate
    settings.density_source, settings.density_name, settings.density_smaller_by = "VERTEX_GROUP", "paint", 3.0
    bpy.ops.saddleback.tessellate(count=80)
    switch_on(ball)
    return ball
