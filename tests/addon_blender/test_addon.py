# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on as a whole: enabled and disabled, its preferences, a missing library, quitting while it computes."""

import os
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest
from scenes import attribute, sphere

from saddleback_blender import prefs
from saddleback_blender.core import cache, native

REPOSITORY = Path(__file__).resolve().parents[2]


def preferences():
    return bpy.context.preferences.addons["saddleback_blender"].preferences


def test_disabling_takes_everything_away_and_enabling_brings_it_back():
    item = sphere()
    bpy.ops.preferences.addon_disable(module="saddleback_blender")
    try:
        assert not hasattr(bpy.types.Object, "saddleback")
        assert not hasattr(bpy.types.WindowManager, "saddleback_running")
        with pytest.raises(AttributeError):
            bpy.ops.saddleback.tessellate()
        assert not [name for name in dir(bpy.types) if name.startswith("SADDLEBACK_")]
    finally:
        bpy.ops.preferences.addon_enable(module="saddleback_blender")
    assert bpy.ops.saddleback.tessellate(count=5, iterations=1) == {"FINISHED"}
    assert item.saddleback.tessellate.count == 5


def test_threads_of_the_preferences_change_nothing_but_the_time():
    item = sphere()
    results = []
    for threads in (1, 2, 0):
        preferences().threads = threads
        assert prefs.threads(bpy.context) == threads
        cache.shared.clear()
        bpy.ops.saddleback.tessellate(count=20, iterations=3)
        results.append(attribute(item, "saddleback_distance").tobytes())
    assert len(set(results)) == 1


def test_the_cache_keeps_to_the_size_of_the_preferences():
    sphere()
    bpy.ops.saddleback.tessellate(count=20, iterations=1)
    assert cache.shared.nbytes > 0
    preferences().cache_megabytes = 0
    assert cache.shared.nbytes == 0
    bpy.ops.saddleback.tessellate(count=20, iterations=1)
    assert cache.shared.nbytes == 0
    preferences().cache_megabytes = 2048


def test_preferences_show_the_library_or_why_there_is_none(monkeypatch):
    assert native.problem() == "" and native.load().__version__ in native.description()
    monkeypatch.setitem(sys.modules, "saddleback", SimpleNamespace(__version__="99.0", __file__="/old/saddleback.py"))
    assert "99.0 is loaded from /old/saddleback.py" in native.problem() and "restart Blender" in native.problem()
    monkeypatch.setitem(sys.modules, "saddleback", None)  # an import of it fails
    assert native.right_package() in native.description() and "restart Blender" in native.problem()
    sphere()
    with pytest.raises(RuntimeError, match=native.right_package()):
        bpy.ops.saddleback.tessellate(count=5)


QUIT = """
    import sys, time
    sys.path += {folders}
    import bpy
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.context.preferences.addons["saddleback_blender"].preferences.threads = 1
    from scenes import grid
    from test_modal import pressed_tessellate
    grid(n=300)
    operator, context = pressed_tessellate(count=200, iterations=200, k=600)
    assert operator.invoke(context, None) == {{"RUNNING_MODAL"}}
    time.sleep({moment})
    assert not operator._task.done
    print("quits at", time.monotonic(), flush=True)
"""

SCRIPT = """
    import sys, time
    sys.path += {folders}
    import bpy
    import saddleback_blender
    saddleback_blender.register()
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    assert bpy.ops.saddleback.tessellate(count=10, iterations=1) == {{"FINISHED"}}
    print("quits at", time.monotonic(), flush=True)
"""


@pytest.mark.skipif(
    bpy.app.version < (4, 3) and not bpy.app.binary_path, reason="its module crashes at the end with any callback"
)
@pytest.mark.parametrize("text", [QUIT.replace("{moment}", "0.05"), QUIT.replace("{moment}", "1.0"), SCRIPT])
def test_quitting_is_clean_and_quick(tmp_path, text):
    script = tmp_path / "quit.py"
    packages = [Path(module.__file__).parents[1] for module in (native.load(), pytest)]
    folders = [str(folder) for folder in (Path(__file__).parent, REPOSITORY / "addon", *packages)]
    script.write_text(textwrap.dedent(text.format(folders=folders)))
    binary = bpy.app.binary_path
    command = [binary, "-b", "--factory-startup", "--python-exit-code", "9", "--python"] if binary else [sys.executable]
    done = subprocess.run(
        [*command, str(script)], capture_output=True, text=True, timeout=120, env={**os.environ}, check=False
    )
    assert done.returncode == 0 and "Traceback" not in done.stderr + done.stdout, done.stderr[-2000:]
    ended = time.monotonic()
    quits_at = next(line.split()[-1] for line in done.stdout.splitlines() if line.startswith("quits at"))
    assert ended - float(quits_at) < 8  # the run itself takes longer
