# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot be done is refused in one sentence that names the object, and nothing changes."""

import bpy
import numpy as np
import pytest
from scenes import add_object, fingerprint, grid, grid_arrays, select, sphere

from saddleback_blender import jobs


def refuse(*sentences, operator="tessellate", **options):
    """Calls the operator, which must refuse with all these words and leave the file as it is."""
    for item in bpy.data.objects:  # the settings exist from the first look on
        assert item.saddleback.tessellate.count and item.saddleback.distance.quality and item.saddleback.path.connect
    before = fingerprint()
    with pytest.raises(RuntimeError) as caught:
        getattr(bpy.ops.saddleback, operator)(**options)
    for sentence in sentences:
        assert sentence in str(caught.value)
    assert fingerprint() == before


OPERATORS = ["distance", "path", "tessellate", "repair", "clear"]


@pytest.mark.parametrize("operator", OPERATORS)
def test_no_active_object(operator):
    refuse("no active object", operator=operator)


@pytest.mark.parametrize("operator", OPERATORS)
def test_not_a_mesh(operator):
    curve = bpy.data.objects.new("Line", bpy.data.curves.new("Line", "CURVE"))
    bpy.context.scene.collection.objects.link(curve)
    bpy.context.view_layer.objects.active = curve
    refuse("'Line' is no mesh but of the type Curve", "Convert > Mesh", "choose a mesh", operator=operator)


@pytest.mark.parametrize("operator", OPERATORS)
def test_edit_mode(operator):
    sphere()
    bpy.ops.object.mode_set(mode="EDIT")
    refuse("'Sphere' is in Edit Mode", "leave it", operator=operator)


@pytest.mark.parametrize("operator", OPERATORS)
def test_hidden(operator):
    sphere().hide_set(True)
    refuse("'Sphere' is hidden", "show it", operator=operator)


@pytest.mark.parametrize("operator", ["distance", "path", "tessellate", "repair"])
def test_zero_scale(operator):
    item = sphere()
    item.scale.z = 0
    bpy.context.view_layer.update()
    refuse("'Sphere' has zero scale along Z", operator=operator)


def test_a_very_flat_but_not_zero_scale_is_fine():
    item = grid()
    item.scale = (1, 1, 1e-3)
    bpy.context.view_layer.update()
    assert bpy.ops.saddleback.tessellate(count=5, iterations=1) == {"FINISHED"}


@pytest.mark.parametrize("operator", ["distance", "path", "tessellate", "repair"])
def test_linked_object(operator, tmp_path):
    sphere()
    path = str(tmp_path / "library.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(path, link=True) as (source, target):
        target.objects = source.objects
    bpy.context.scene.collection.objects.link(target.objects[0])
    bpy.context.view_layer.objects.active = target.objects[0]
    refuse("'Sphere' is linked from", "library.blend", "make a library override of it first", operator=operator)


def test_empty_mesh_and_mesh_without_faces():
    add_object("Nothing", [], [])
    refuse("'Nothing' is empty")
    add_object("Wire", [(0, 0, 0), (1, 0, 0)], [])
    refuse("'Wire' has no faces; choose")


def test_modifiers_that_leave_no_faces():
    item = sphere()
    item.vertex_groups.new(name="Nothing")
    item.modifiers.new("Mask", "MASK").vertex_group = "Nothing"
    refuse("'Sphere' has no faces as its modifiers leave it", "Realize Instances", use_modifiers=True)


def test_selection_is_missing_or_off_the_surface():
    vertices, faces = grid_arrays(3)
    item = add_object("Loose", np.concatenate([vertices, [[9, 9, 9]]]), faces)
    select(item, [])
    refuse("'Loose' has no selected vertex", operator="distance")
    refuse("'Loose' has no selected vertex", sites_source="SELECTED")
    select(item, [16])
    refuse("'Loose': the source at vertex 16 belongs to no face", operator="distance")
    refuse("'Loose': the site at vertex 16 belongs to no face", sites_source="SELECTED")


def test_sources_that_do_not_exist():
    item = sphere()
    refuse(
        "'Sphere' has no vertex group; paint one or choose another source", operator="distance", sources="VERTEX_GROUP"
    )
    item.vertex_groups.new(name="Empty")
    refuse("no vertex has a weight above 0.5", "'Empty'", operator="distance", sources="VERTEX_GROUP")
    refuse("no empty is parented to 'Sphere'", operator="distance", sources="EMPTIES")
    refuse("no collection 'Gone'", operator="distance", sources="EMPTIES", sources_collection="Gone")


def test_sites_object_is_missing_or_useless():
    sphere()
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT"))
    bpy.context.scene.collection.objects.link(lamp)
    add_object("Void", [], [], active=False)
    refuse("no object is chosen to take sites from", sites_source="OBJECT")
    refuse("no object 'Gone'", sites_source="OBJECT", sites_object="Gone")
    refuse("'Lamp' is no mesh object", sites_source="OBJECT", sites_object="Lamp")
    refuse("'Void' has no vertices", sites_source="OBJECT", sites_object="Void")
    refuse("cannot take its sites from itself", sites_source="OBJECT", sites_object="Sphere")


def test_density_is_missing_or_useless():
    item = sphere()
    refuse("'Sphere' has no vertex group", density_source="VERTEX_GROUP")
    item.vertex_groups.new(name="Paint")
    refuse("'Sphere': vertex group 'Paint' is zero everywhere", density_source="VERTEX_GROUP")


def test_instance_object_is_missing_or_the_source_itself():
    sphere()
    refuse("no object 'Gone' to put on the centers", make_centers=True, instance_object="Gone")
    refuse("'Sphere' cannot be put on its own centers", make_centers=True, instance_object="Sphere")


def test_attribute_names_that_would_overwrite_something():
    item = sphere()
    item.data.attributes.new("corner", "FLOAT", "CORNER")
    item.vertex_groups.new(name="group")
    item.data.attributes.new("paint", "FLOAT", "POINT").data.foreach_set("value", np.ones(162, np.float32))
    refuse("cannot be called ''", cell_attribute="")
    refuse("cannot be called 'position'", cell_attribute="position")
    refuse("two attributes are to be called 'same'", cell_attribute="same", distance_attribute="same")
    refuse("has a vertex group 'group'", cell_attribute="group")
    refuse("has another kind of attribute 'corner'", distance_attribute="corner")
    refuse(
        "would overwrite its density 'paint'",
        distance_attribute="paint",
        density_source="ATTRIBUTE",
        density_name="paint",
    )


def test_a_bad_mesh_offers_the_repair():
    vertices, faces = grid_arrays(3)
    add_object("Twice", vertices, [*faces, faces[4]])
    refuse("'Twice': ", "press Repair", count=3)
    assert bpy.context.window_manager.saddleback_needs_repair == "Twice"
    assert bpy.ops.saddleback.repair() == {"FINISHED"}
    assert bpy.context.window_manager.saddleback_needs_repair == ""
    assert bpy.ops.saddleback.tessellate(count=3, iterations=1) == {"FINISHED"}


def test_nothing_runs_beside_a_run(monkeypatch):
    sphere()

    class Busy:
        name = "Other"

    monkeypatch.setattr(jobs.state, "task", Busy())
    refuse("Other is being computed", count=5)


def test_the_native_part_is_missing(monkeypatch):
    from saddleback_blender.core import native

    sphere()

    def missing():
        raise native.NativeMissingError("Saddleback's native library does not load")

    monkeypatch.setattr(native, "load", missing)
    refuse("native library does not load")
    assert native.problem() and native.description()
