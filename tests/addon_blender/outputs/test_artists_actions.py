# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists do between two runs: whatever it is, what was made stands in a known relation to what is there."""

import bpy
from scenes import sphere

from saddleback_blender.bridge.outputs.out_collection import find_output


def test_a_copy_of_what_modifiers_made_goes_once_the_mesh_has_its_own_faces_again():
    """It showed the bands of before, and the body, which has the new ones, was hidden for it."""
    item = sphere()
    item.modifiers.new("Fine", "SUBSURF")
    bpy.ops.saddleback.apply_look(look="BANDS")
    assert find_output(item, "surface") is not None and item.display_type == "BOUNDS"
    bpy.ops.object.modifier_apply(modifier="Fine")
    bpy.ops.saddleback.apply_look(look="BANDS")
    assert find_output(item, "surface") is None
    assert item.display_type == "TEXTURED" and not item.hide_render
    assert "saddleback_distance_color" in item.data.attributes
