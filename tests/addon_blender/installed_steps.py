# SPDX-License-Identifier: GPL-3.0-or-later
"""What a user does with a package, in a process and a profile of their own; started by test_install.py.

    ... installed_steps.py -- first PACKAGE FILE.blend     install, enable, run, save the file and the preferences
    ... installed_steps.py -- again FILE.blend             reopen, run, undo, redo, disable, enable, run

Prints one word for each step that held.
"""

import os
import sys
from pathlib import Path

import bpy
import numpy as np

PROFILE = Path(os.environ["BLENDER_USER_RESOURCES"])
QUICK = {"count": 12, "iterations": 2, "k": 20}


def module_name():
    (name,) = (entry.module for entry in bpy.context.preferences.addons if "saddleback" in entry.module)
    return name


def cells():
    data = bpy.data.objects["Ball"].data.attributes["saddleback_cell"].data
    values = np.empty(len(data), dtype=np.int32)
    data.foreach_get("value", values)
    return values


def tessellate(**settings):
    assert bpy.ops.saddleback.tessellate("EXEC_DEFAULT", True, **{**QUICK, **settings}) == {"FINISHED"}


def use_the_others():
    """Every other operator once, two of them with their graph kept on disk."""
    ops = bpy.ops.saddleback
    mesh = bpy.data.objects["Ball"].data
    chosen = np.zeros(len(mesh.vertices), bool)
    chosen[[0, 9]] = True
    mesh.polygons.foreach_set("select", np.zeros(len(mesh.polygons), bool))
    mesh.vertices.foreach_set("select", chosen)
    for call in (
        lambda: ops.distance(k=20, cache_on_disk=True),
        lambda: ops.path(k=20, cache_on_disk=True),
        lambda: ops.direction_field(),
        lambda: ops.distribute(count=5),
        lambda: ops.repair(),
    ):
        assert call() == {"FINISHED"}
    assert len(list(PROFILE.rglob("*.saddleback"))) == 1, "the graph is not kept on disk, or twice"
    bpy.ops.mesh.primitive_plane_add()
    assert ops.voronoi_2d(count=9) == {"FINISHED"}
    assert ops.clear() == {"FINISHED"}
    bpy.context.view_layer.objects.active = bpy.data.objects["Ball"]


def install(package):
    if "legacy" in package.name:
        bpy.ops.preferences.addon_install(filepath=str(package), overwrite=True)
        bpy.ops.preferences.addon_enable(module="saddleback_blender")
    else:
        bpy.ops.extensions.package_install_files(filepath=str(package), repo="user_default", enable_on_install=True)
    add_on = sys.modules[module_name()]
    assert Path(add_on.__file__).is_relative_to(PROFILE), add_on.__file__
    assert "saddleback" not in sys.modules, "the native library is loaded before anybody needs it"


def first(package, file):
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    install(package)
    print("installed")
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    bpy.context.object.name = "Ball"
    tessellate()
    import saddleback

    assert Path(saddleback.__file__).is_relative_to(PROFILE), saddleback.__file__
    assert set(cells()) == set(range(12))
    print("ran")
    use_the_others()
    print("others")
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    bpy.ops.wm.save_userpref()
    np.save(file.with_suffix(".npy"), cells())
    print("saved")


def again(file):
    if bpy.app.version[:2] == (4, 2):  # as a wheel it starts without the user's preferences and dies when they are read
        bpy.ops.preferences.addon_enable(module="bl_ext.user_default.saddleback")
    else:
        bpy.ops.wm.read_userpref()
    bpy.ops.wm.open_mainfile(filepath=str(file))
    kept = np.load(file.with_suffix(".npy"))
    np.testing.assert_array_equal(cells(), kept)
    bpy.ops.ed.undo_push(message="reopened")
    print("reopened")
    tessellate()
    np.testing.assert_array_equal(cells(), kept)
    tessellate(count=7)
    assert set(cells()) == set(range(7))
    print("ran")
    bpy.ops.ed.undo()
    np.testing.assert_array_equal(cells(), kept)
    bpy.ops.ed.redo()
    assert set(cells()) == set(range(7))
    print("undone")
    name = module_name()
    bpy.ops.preferences.addon_disable(module=name)
    assert not any("saddleback" in entry.module for entry in bpy.context.preferences.addons)
    assert not hasattr(bpy.types.Object, "saddleback")
    print("disabled")
    bpy.ops.preferences.addon_enable(module=name)
    tessellate(count=9)
    assert set(cells()) == set(range(9))
    print("enabled")


if __name__ == "__main__":
    step, *paths = sys.argv[sys.argv.index("--") + 1 :]
    {"first": first, "again": again}[step](*map(Path, paths))
    sys.stdout.flush()
    if bpy.app.version < (4, 3) and not bpy.app.binary_path:
        os._exit(0)  # as tests/run_in_blender.py does
