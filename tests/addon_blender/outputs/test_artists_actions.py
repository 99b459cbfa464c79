# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists do between two runs: whatever it is, what was made stands in a known relation to what is there."""

import bpy
import numpy as np
import pytest
from scenes import positions, sphere
from test_rigs import activate, library, link

from saddleback_blender.bridge.outputs.out_collection import find_output
from saddleback_blender.core import runs


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


def add_key(item):
    item.shape_key_add(name="Basis")
    item.shape_key_add(name="Blown up").data[0].co.x += 1.0


def show_material(item):
    item.data.materials.append(bpy.data.materials.new("Mine"))
    item.data.polygons[0].material_index = len(item.data.materials) - 1


EDITS = {
    "key": add_key,
    "map": lambda item: item.data.uv_layers.new(name="Mine"),
    "attribute": lambda item: item.data.attributes.new("Mine", "FLOAT", "FACE"),
    "material": show_material,
}


@pytest.mark.parametrize("edit", EDITS)
def test_layers_that_an_artist_added_to_an_output_are_not_lost(edit):
    item = sphere()
    bpy.ops.saddleback.tessellate(count=9, make_cells=True)
    edited = find_output(item, "cells").data
    EDITS[edit](find_output(item, "cells"))
    bpy.ops.saddleback.tessellate(count=12, make_cells=True)
    assert bpy.data.objects["Sphere Cells Edited"].data == edited and find_output(item, "cells").data != edited
    bpy.ops.saddleback.tessellate(count=9, make_cells=True)
    assert len(bpy.data.objects) == 4  # the sphere, edges, cells and the edited cells


def test_materials_and_slots_alone_are_no_edit():
    item = sphere()
    bpy.ops.saddleback.tessellate(count=9, make_cells=True)
    find_output(item, "cells").data.materials[0] = bpy.data.materials.new("Mine")
    find_output(item, "cells").data.materials.append(None)
    bpy.ops.saddleback.tessellate(count=12, make_cells=True)
    assert len(bpy.data.objects) == 3 and find_output(item, "cells").material_slots[0].name == "Mine"


def test_our_groups_and_marks_may_be_edited():
    """Each ended in a Python error."""
    item, leaf = sphere(), sphere("Leaf", 1)
    bpy.context.view_layer.objects.active = item
    settings = {"count": 9, "make_centers": True, "instance_object": "Leaf"}
    bpy.ops.saddleback.tessellate(**settings)
    for group in bpy.data.node_groups:
        if hasattr(group, "interface"):
            inputs = [socket for socket in group.interface.items_tree if socket.in_out == "INPUT"]
        else:
            inputs = list(group.inputs)
        for socket in inputs[1:]:
            socket.name = f"My {socket.name}"
        for node in [node for node in group.nodes if node.type == "OBJECT_INFO"]:
            group.nodes.remove(node)
    bpy.ops.saddleback.tessellate(**settings)
    del find_output(item, "edges")["saddleback_role"]
    bpy.ops.saddleback.tessellate(**settings)
    assert bpy.ops.saddleback.clear() == {"FINISHED"}
    assert set(bpy.data.objects) == {item, leaf, bpy.data.objects["Sphere Edges"]}


def test_what_bands_show_is_no_material_of_the_artist_s():
    item = sphere()
    names = ["Skin", "Horn"]
    for name in names:
        item.data.materials.append(bpy.data.materials.new(name))
    for face in item.data.polygons:
        face.material_index = int(face.center.z > 0.0)
    bpy.ops.saddleback.apply_look(look="BANDS")
    bpy.ops.saddleback.layer_add()
    bpy.ops.saddleback.tessellate(count=50, region="MATERIAL", region_name="Horn", make_dual=True)
    dual = find_output(item, "dual").data
    assert [material.name for material in dual.materials] == names
    assert min(vertex.co.z for vertex in dual.vertices) > -0.1


@pytest.mark.parametrize("look", ["BANDS", "REMESH"])
def test_no_look_leaves_its_ground_below_another(look):
    item = sphere(subdivisions=2)
    bpy.ops.saddleback.apply_look(look="PANELS")
    assert tuple(item.color) != (1.0, 1.0, 1.0, 1.0)
    bpy.ops.saddleback.apply_look(look=look)
    assert tuple(item.color) == (1.0, 1.0, 1.0, 1.0)
    assert look == "BANDS" or not find_output(item, "dual").material_slots
    bpy.ops.saddleback.clear()
    assert not item.material_slots


def test_a_scale_of_units_without_units_is_no_scale(tmp_path, capfd):
    """As Blender itself has it, which grays the scale out there."""
    units, path = bpy.context.scene.unit_settings, str(tmp_path / "lamp.stl")
    item, said = sphere(radius=0.05), []
    for scale in (1.0, 1000.0):
        units.system, units.scale_length = "NONE", scale
        bpy.ops.saddleback.tessellate(
            count=30, make_shell=True, in_millimeters=True, rib_width_mm=4.0, rib_thickness_mm=3.0
        )
        assert max(find_output(item, "shell").dimensions) == pytest.approx(0.103, rel=0.01)
        bpy.ops.saddleback.export_stl(filepath=path)
        said.append(
            [
                part
                for part in "".join(capfd.readouterr()).replace("\n", ",").split(",")
                if "mm" in part or "walls" in part
            ]
        )
    assert said[0] == said[1] and said[0][0] == " walls 0.003 thick"


def test_a_layer_that_a_script_took_away_is_made_again():
    item = sphere()
    for _ in range(2):
        bpy.ops.saddleback.layer_add()
        bpy.ops.saddleback.tessellate(count=9)
    outputs = set(bpy.data.objects)
    for remove in (lambda layers: layers.remove(1), lambda layers: layers.clear()):
        remove(item.saddleback.layers)
        bpy.ops.saddleback.tessellate(count=9)
        assert set(bpy.data.objects) == outputs


def test_what_memory_does_not_hold_is_told_as_that(monkeypatch):
    def give_up(*_):
        raise MemoryError("std::bad_alloc")

    sphere()
    monkeypatch.setattr(runs, "tessellate", give_up)
    with pytest.raises(RuntimeError, match="'Sphere': there is not enough memory; ask for fewer or larger ones"):
        bpy.ops.saddleback.tessellate(count=9)


def test_clearing_one_of_two_objects_with_a_mesh_leaves_the_bands_of_the_other():
    one = sphere(subdivisions=2)
    other, third = (bpy.data.objects.new(name, one.data) for name in ("Other", "Third"))
    third.modifiers.new("Fine", "SUBSURF")
    for item in (other, third):
        bpy.context.scene.collection.objects.link(item)
    before = {kind: len(getattr(bpy.data, kind)) for kind in ("objects", "materials", "node_groups", "collections")}
    for item in (one, third, other):
        activate(item)
        bpy.ops.saddleback.apply_look(look="BANDS")
    for item in (third, one):
        activate(item)
        assert bpy.ops.saddleback.clear() == {"FINISHED"}
        assert other.material_slots[0].material is not None
        assert {"saddleback_distance", "saddleback_distance_color"} <= set(one.data.attributes.keys())
    activate(other)
    bpy.ops.saddleback.clear()
    assert not one.data.materials and not [
        layer for layer in one.data.attributes if layer.name.startswith("saddleback")
    ]
    assert before == {kind: len(getattr(bpy.data, kind)) for kind in before}


def test_the_last_layer_is_deleted_with_its_ground():
    item = sphere(subdivisions=2)
    bpy.ops.saddleback.apply_look(look="PANELS")
    bpy.ops.saddleback.layer_delete()
    assert not bpy.data.materials and not item.material_slots and list(bpy.data.objects) == [item]


def test_each_field_of_a_mesh_has_its_own_symmetry():
    item = sphere()
    shapes = {"count": 40, "field_source": "ATTRIBUTE", "direction_attribute": "along"}
    bpy.ops.saddleback.direction_field(symmetry="1", direction_attribute="along")
    bpy.ops.saddleback.distribute(**shapes)
    before = positions(find_output(item, "shapes").data)
    bpy.ops.saddleback.direction_field(symmetry="4", direction_attribute="crosses")
    bpy.ops.saddleback.distribute(**shapes)
    np.testing.assert_array_equal(positions(find_output(item, "shapes").data), before)
    bpy.ops.saddleback.clear()
    assert not list(item.data.keys())


def test_a_duplicate_keeps_to_its_own_outputs_when_the_original_goes():
    item = sphere(subdivisions=2)
    bpy.ops.saddleback.tessellate(count=9, make_cells=True)
    for output in item.children:
        output.select_set(True)
    bpy.ops.object.duplicate()
    (copy,) = (one for one in bpy.context.selected_objects if one.parent is None)
    left = [bpy.data.objects[name] for name in ("Sphere Cells", "Sphere Edges")]
    bpy.data.objects.remove(item)
    activate(copy)
    bpy.ops.saddleback.tessellate(count=20, make_cells=True)
    assert [output.parent for output in left] == [None, None]
    bpy.ops.saddleback.clear()
    assert set(bpy.data.objects) == {copy, *left}


def test_linked_duplicates_and_empty_slots_have_a_ground_too():
    """The slot that the first of them got was taken for a material of the others."""
    one = sphere(subdivisions=2)
    other = bpy.data.objects.new("Other", one.data)
    bpy.context.scene.collection.objects.link(other)
    for item in (one, other):
        activate(item)
        bpy.ops.saddleback.apply_look(look="PANELS")
        assert item.material_slots[0].material.name == "Saddleback Panels Ground"
    for item in (one, other):
        activate(item)
        bpy.ops.saddleback.clear()
        assert tuple(item.color) == (1.0, 1.0, 1.0, 1.0)
    assert not one.data.materials and not bpy.data.materials
    one.data.materials.append(None)
    bpy.ops.saddleback.apply_look(look="PANELS")
    assert other.material_slots[0].material.name == "Saddleback Panels Ground"
    bpy.ops.saddleback.clear()
    assert other.material_slots[0].link == "DATA" and not bpy.data.materials


@pytest.mark.parametrize("output", ["make_cells", "make_dual", "make_edges"])
def test_how_an_artist_draws_an_output_stays_with_the_next_run(output):
    """Shade Smooth or Flat, in Blenders before 4.1 by an angle, properties of one's own and a bevel went with it."""
    item = sphere()
    options = {"iterations": 2, "k": 30, "make_edges": False, output: True, "edge_kind": "CURVE"}
    bpy.ops.saddleback.tessellate(count=20, **options)
    made = find_output(item, output.removeprefix("make_"))

    def parts():
        return made.data.splines if made.type == "CURVE" else made.data.polygons

    before = {part.use_smooth for part in parts()}
    for wanted in (not before.pop(), not before):
        for part in parts():
            part.use_smooth = wanted
        if hasattr(made.data, "use_auto_smooth"):
            made.data.use_auto_smooth, made.data.auto_smooth_angle = wanted, 0.5
        made.data["price"], made.data["tags"], made.data["of"] = 12, [1.0, 2.0], {"a": item}
        made.data.id_properties_ui("price").update(min=3, description="In coins")
        if made.type == "CURVE":
            made.data.bevel_depth, made.data.use_fill_caps = 0.01, True
        for count in (23, 26):
            bpy.ops.saddleback.tessellate(count=count, **options)
            assert find_output(item, made["saddleback_role"]) == made and {p.use_smooth for p in parts()} == {wanted}
            if hasattr(made.data, "use_auto_smooth"):
                assert (made.data.use_auto_smooth, made.data.auto_smooth_angle) == (wanted, pytest.approx(0.5))
            assert (made.data["price"], list(made.data["tags"]), made.data["of"]["a"]) == (12, [1.0, 2.0], item)
            assert made.data.id_properties_ui("price").as_dict()["description"] == "In coins"
            if made.type == "CURVE":
                assert made.data.bevel_depth == pytest.approx(0.01) and made.data.use_fill_caps
