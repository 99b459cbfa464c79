# SPDX-License-Identifier: GPL-3.0-or-later
"""A write that fails, at whichever step, leaves the file as it was."""

import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
from scenes import add_object, grid, select, sphere

import saddleback_blender
from saddleback_blender import compat, rollback
from saddleback_blender.ops import base

FOLDER = Path(saddleback_blender.__file__).parent
WATCHED = (str(FOLDER / "bridge"), str(FOLDER / "nodes.py"), str(FOLDER / "shape_nodes.py"), str(FOLDER / "props"))
KINDS = ("objects", "meshes", "curves", "collections", "node_groups", "materials", "actions", "images")


class StepError(Exception):
    """The step that fails."""


class Steps:
    """Counts the calls of functions that write, while an operator writes; the one of number `fatal` raises."""

    def __init__(self, fatal=None):
        self.count, self.fatal = 0, fatal

    def __enter__(self):
        self.before = rollback.all_or_nothing
        steps = self

        class Traced:
            def __init__(self):
                self.inner = steps.before()

            def __enter__(self):
                self.inner.__enter__()
                sys.settrace(steps.step)

            def __exit__(self, *error):
                sys.settrace(None)
                return self.inner.__exit__(*error)

        rollback.all_or_nothing = Traced
        return self

    def __exit__(self, *_):
        sys.settrace(None)
        rollback.all_or_nothing = self.before

    def step(self, frame, event, _):
        if event == "call" and frame.f_code.co_filename.startswith(WATCHED) and frame.f_code.co_name[0] != "<":
            self.count += 1
            if self.count == self.fatal:
                raise StepError
        return


def plain(value):
    if hasattr(value, "to_list"):
        return tuple(value.to_list())
    return value.name if isinstance(value, bpy.types.ID) else value


def attributes(mesh):
    found = {}
    for attribute in mesh.attributes:
        if attribute.data_type in rollback.ELEMENTS and not attribute.name.startswith("."):
            element, width, dtype = rollback.ELEMENTS[attribute.data_type]
            values = np.empty(width * len(attribute.data), dtype)
            attribute.data.foreach_get(element, values)
            found[attribute.name] = (attribute.data_type, attribute.domain, values.tobytes())
    return found


def told_object(item):
    modifiers = [
        (m.name, m.node_group.name, {k: plain(v) for k, v in compat.modifier_inputs(m).items()})
        for m in item.modifiers
        if m.type == "NODES"
    ]
    return {
        "data": item.data.name if item.data is not None else None,
        "parent": item.parent.name if item.parent is not None else None,
        "places": [tuple(map(tuple, m)) for m in (item.matrix_basis, item.matrix_parent_inverse)],
        "keys": {key: plain(item[key]) for key in sorted(item.keys()) if key != "saddleback"},
        "collections": sorted(collection.name for collection in item.users_collection),
        "slots": [(slot.link, plain(slot.material)) for slot in item.material_slots],
        "modifiers": modifiers,
        "rest": item.add_rest_position_attribute,
        "groups": [group.name for group in item.vertex_groups],
        "settings": settings(item.saddleback),
    }


def settings(group):
    found = {}
    for name in sorted(set(group.bl_rna.properties.keys())):
        if name not in ("rna_type", "name") and group.is_property_set(name):
            value = getattr(group, name)
            found[name] = settings(value) if isinstance(value, bpy.types.PropertyGroup) else plain(value)
    return {name: value for name, value in found.items() if value != {}}


def whole_file():
    """Everything that a run could touch."""
    told = {kind: sorted((block.name, block.users) for block in getattr(bpy.data, kind)) for kind in KINDS}
    told["object"] = {item.name: told_object(item) for item in bpy.data.objects}
    told["mesh"] = {
        mesh.name: (
            attributes(mesh),
            {key: plain(mesh[key]) for key in sorted(mesh.keys())},
            [plain(material) for material in mesh.materials],
            len(mesh.vertices),
        )
        for mesh in bpy.data.meshes
    }
    return told


def differences(before, after, path=""):
    if isinstance(before, dict) and isinstance(after, dict):
        return [
            line
            for key in {**before, **after}
            for line in differences(before.get(key, "missing"), after.get(key, "missing"), f"{path}/{key}")
        ]
    return [] if before == after else [f"{path}: {str(before)[:300]} is now {str(after)[:300]}"]


def call(operator, **settings):
    return getattr(bpy.ops.saddleback, operator)(**settings)


def seed():
    return add_object("Seed", [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], active=False)


def stroke(item):
    curve = bpy.data.curves.new("Stroke", "CURVE")
    curve.dimensions = "3D"
    points = curve.splines.new("POLY").points
    points.add(1)
    points[0].co, points[1].co = (1, 0, 0, 1), (0, 1, 0, 1)
    line = bpy.data.objects.new("Stroke", curve)
    line.parent = item
    bpy.context.scene.collection.objects.link(line)


def host():
    item = sphere("Ball", 2)
    item.data.materials.append(bpy.data.materials.new("Skin"))
    item.vertex_groups.new(name="Up").add([0, 1, 2], 1.0, "REPLACE")
    seed()
    stroke(item)
    bpy.context.view_layer.objects.active = item
    select(item, [0, 20])
    return item


ALL = {"make_cells": True, "make_centers": True, "make_dual": True, "make_shell": True, "instance_object": "Seed"}
SHAPES = {"shapes": "STUDS", "field_source": "NONE", "packing": 0.0}
LINES = {"make_outlines": True}
EVERY = {"make_instances": True, "make_outlines": True, "make_cut": True, "write_attributes": True}
RUNS = [
    ("tessellate", {"count": 6}, {"count": 9, **ALL}),
    ("tessellate", {"count": 9, **ALL}, {"count": 6, "make_edges": False, "write_edge_distance": True}),
    ("tessellate", {"count": 9, "make_centers": True, "instance_object": "Seed"}, {"count": 7, "edge_kind": "CURVE"}),
    ("tessellate", {"count": 6}, {"count": 9, "use_modifiers": True}),
    ("distance", {}, {"make_isolines": True, "make_preview": True}),
    ("distance", {"make_isolines": True, "make_preview": True}, {"make_preview": False}),
    ("path", {}, {"k": 20}),
    ("ribbon", {}, {"show": "OBJECT", "ribbon_object": "Seed"}),
    ("direction_field", {}, {"make_arrows": False, "make_streamlines": True}),
    ("voronoi_2d", {"animate": True}, {"make_cells": True, "animate": True}),
    ("distribute", {"count": 5, **SHAPES}, {"count": 6, **SHAPES, **EVERY}),
    ("distribute", {"count": 5, **SHAPES, **EVERY}, {"count": 6, **SHAPES, "follow_surface": False, **LINES}),
]  # fmt: skip


@pytest.mark.parametrize(("operator", "first", "second"), RUNS, ids=[f"{run[0]}{i}" for i, run in enumerate(RUNS)])
def test_a_failing_write_leaves_the_file_as_it_was(operator, first, second):
    item = grid("Ball", 4) if operator == "voronoi_2d" else host()
    if operator == "path":
        select(item, [0, 20])
    call(operator, **first)
    if second.get("use_modifiers"):
        item.modifiers.new("Fine", "SUBSURF").levels = 1
    bpy.context.view_layer.update()
    before = whole_file()
    fails_all_the_way(lambda: call(operator, **second), before)


def fails_all_the_way(run, before, most=12):
    """The run fails at steps from the first to the last, and the file stays; then it succeeds."""
    with Steps() as steps, pytest.MonkeyPatch.context() as patch:
        patch.setattr(base, "note_call", fail)  # which comes last
        with pytest.raises(RuntimeError, match="StepError"):
            run()
    assert not differences(before, whole_file())
    assert steps.count > 5
    for fatal in sorted({int(n) for n in np.linspace(1, steps.count, min(steps.count, most))}):
        with Steps(fatal), pytest.raises(RuntimeError, match="StepError"):
            run()
        found = differences(before, whole_file())
        assert not found, f"step {fatal} of {steps.count}: " + "\n".join(found)
    run()
    assert differences(before, whole_file())


def fail(*_):
    raise StepError


def test_what_fails_in_clear_and_paint_is_taken_back():
    item = host()
    call("tessellate", count=9, **ALL)
    call("distance", make_preview=True)
    before = whole_file()
    for operator in ("clear", "paint_density", "add_singularity"):
        for fatal in range(1, 40):
            with Steps(fatal) as steps:
                try:
                    call(operator)
                except RuntimeError as error:
                    assert "StepError" in str(error)
            if steps.count < fatal:
                break
            assert not differences(before, whole_file()), (operator, fatal)
        if operator == "paint_density":
            bpy.ops.object.mode_set(mode="OBJECT")
        before = whole_file()
    assert "saddleback_density" in item.vertex_groups
