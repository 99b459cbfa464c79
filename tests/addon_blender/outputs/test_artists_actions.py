# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists do between two runs: whatever it is, what was made stands in a known relation to what is there."""

import bpy
import pytest
from scenes import sphere
from test_rigs import activate, library, link

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


@pytest.mark.parametrize("look", ["LAMP", "BANDS"])
@pytest.mark.parametrize("has_own", [False, True])
def test_an_override_replaces_what_it_has_and_shows_again_what_it_hid(tmp_path, look, has_own):
    """One of an object that had been a source took no output for its own, and after reopening none came back."""
    sphere("Body", 2)
    if has_own:
        bpy.ops.saddleback.apply_look(look="PANELS")
    linked = next(item for item in link(library(tmp_path), "objects") if item.name == "Body")
    bpy.context.scene.collection.objects.link(linked)
    linked.override_create(remap_local_usages=True)
    path = str(tmp_path / "shot.blend")
    for wanted in (look, look, "PANELS"):
        body = next(item for item in bpy.data.objects if item.override_library is not None)
        activate(body)
        bpy.ops.saddleback.apply_look(look=wanted)
        assert (body.display_type, body.hide_render) == (
            ("TEXTURED", False) if wanted == "PANELS" else ("BOUNDS", True)
        )
        roles = [item["saddleback_role"] for item in bpy.data.objects if "saddleback_role" in item and not item.library]
        assert len(roles) == len(set(roles))
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path)
