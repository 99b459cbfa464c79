# SPDX-License-Identifier: GPL-3.0-or-later
"""The job of render farms: the commands of docs/farms.md run as they stand, frames are whole or not there, and tasks go
on where they were ended.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace

import bpy
import pytest
from scenes import grid

REPOSITORY = Path(__file__).resolve().parents[3]
PAGE = (REPOSITORY / "docs" / "farms.md").read_text(encoding="utf-8")
PROGRAM = bpy.app.binary_path  # none where Blender is a module of Python


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


@pytest.fixture
def place(tmp_path):
    """A folder as the page takes it for granted: the scene, the script, and the add-on for those Blenders."""
    tmp_path = tmp_path / "two words"
    tmp_path.mkdir()
    item = grid(n=12)
    item.shape_key_add(name="rest")
    key = item.shape_key_add(name="long")
    for vertex in key.data:
        vertex.co.x *= 3
    for frame, value in ((1, 0.0), (3, 1.0)):
        key.value = value
        key.keyframe_insert("value", frame=frame)
    item.saddleback.tessellate.use_modifiers, item.saddleback.tessellate.count = True, 6
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    bpy.context.scene.collection.objects.link(camera)
    camera.location.z = 8.0
    render = bpy.context.scene.render
    bpy.context.scene.camera, render.engine = camera, "CYCLES"
    bpy.context.scene.cycles.samples, bpy.context.scene.cycles.use_denoising = 1, False
    render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 12, 100
    bpy.context.view_layer.objects.active = item
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    (tmp_path / "blend-samples").mkdir()  # copies: not everyone may make links in Windows
    shutil.copy(REPOSITORY / "blend-samples" / "farm.py", tmp_path / "blend-samples")
    scripts = tmp_path / "scripts"
    (scripts / "startup").mkdir(parents=True)
    add_on = REPOSITORY / "addon" / "saddleback_blender"
    shutil.copytree(add_on, scripts / "addons" / "saddleback_blender", ignore=shutil.ignore_patterns("__pycache__"))
    folders = [path for path in os.environ.get("SADDLEBACK_PYTHONPATH", "").split(os.pathsep) if path]
    where = f"import sys\nsys.path[:0] = {folders!r}\ndef register(): pass\n"
    (scripts / "startup" / "where_saddleback_is.py").write_text(where, encoding="utf-8")
    return tmp_path


def made_ready(command, place):
    """A command's words and its environment; `blender` and `python` are what this test runs in."""
    words = shlex.split(command) if isinstance(command, str) else list(command)
    if words[0] == "blender" and not PROGRAM:  # the module of Python opens the scene itself
        at = words.index("-P")
        words = ["python", words[at + 1], words[at - 1], *words[words.index("--") + 1 :]]
    words[0] = PROGRAM or sys.executable
    environment = {**os.environ, "BLENDER_USER_SCRIPTS": str(place / "scripts"), "PWD": str(place)}
    environment["PYTHONIOENCODING"] = "ascii"  # as logs in Windows, which know the letters of one language
    if not PROGRAM:
        paths = [str(place / "scripts" / "addons"), os.environ.get("SADDLEBACK_PYTHONPATH", "")]
        environment["PYTHONPATH"] = os.pathsep.join(paths)
    return words, environment


def run(command, place):
    """Run it as a farm does."""
    words, environment = made_ready(command, place)
    return subprocess.run(words, cwd=place, env=environment, capture_output=True, text=True, timeout=300)


def farm_words(*arguments):
    return ["blender", "-b", "scene.blend", "-P", "blend-samples/farm.py", "--", *arguments]


def farm(place, *arguments):
    return run(farm_words(*arguments), place)


def frames(place, suffix="png"):
    return [f"out/frame.{frame:04}.{suffix}" for frame in (1, 2, 3)], sorted(
        path.relative_to(place).as_posix() for path in (place / "out").iterdir()
    )


def check(done, place):
    assert done.returncode == 0, done.stdout + done.stderr
    wanted, found = frames(place)
    assert found == wanted
    assert all((place / name).read_bytes().startswith(b"\x89PNG") for name in found)


def test_the_command_of_the_page(place):
    with_blender, with_python = (block.strip() for block in blocks("sh")[:2])
    command = with_blender if PROGRAM else with_python
    check(run(command.replace("1-240", "1-3"), place), place)


def test_flamenco(place):
    """What the job type puts together, its settings filled in."""
    (script,) = blocks("js")
    assert 'exe: "{blender}"' in script  # the manager's name for it
    (words,) = re.findall(r"args: \[(.*?)\]\.concat\(run\)", script, re.DOTALL)
    settings = {"blendfile": "scene.blend", "script": "blend-samples/farm.py", "output": "out/frame.####.png"}
    values = {**{f"job.settings.{name}": value for name, value in settings.items()}, "chunk": "1-3"}
    command = [values[word] if word in values else word.strip('"') for word in re.split(r",\s*", words)]
    for name in re.findall(r"job\.settings\.(\w+)", script):
        assert f'key: "{name}"' in script
    check(run(["blender", *command], place), place)


def test_deadline(place):
    (command,) = [block for block in blocks("sh") if "deadlinecommand" in block]
    words = shlex.split(command.replace("\\\n", " "))
    assert words[words.index("-executable") + 1] == "blender"
    arguments = words[words.index("-arguments") + 1].replace("<STARTFRAME>", "1").replace("<ENDFRAME>", "3")
    check(run(["blender", *shlex.split(arguments)], place), place)


def test_opencue(place, monkeypatch):
    """PyOutline stands in for itself: what would be submitted is run."""
    layers = []
    outline, modules, shell = (ModuleType(name) for name in ("outline", "outline.modules", "outline.modules.shell"))
    outline.Outline = lambda *_, **__: SimpleNamespace(add_layer=layers.append)
    outline.cuerun = SimpleNamespace(launch=lambda *_, **__: None)
    shell.Shell = lambda name, **arguments: arguments
    for module in (outline, modules, shell):
        monkeypatch.setitem(sys.modules, module.__name__, module)
    (script,) = [block for block in blocks("python") if "outline" in block]
    monkeypatch.chdir(place)
    exec(script, {})
    ((layer,),) = [layers]
    assert layer["range"] == "1-240"
    assert all(Path(word).is_absolute() for word in layer["command"] if "/" in word)
    check(run([word.replace("#FRAMESPEC#", "1-3") for word in layer["command"]], place), place)


def test_what_is_there_is_left_and_the_rest_made(place):
    (place / "out").mkdir()
    (place / "out" / "frame.0001.png").write_bytes(b"an older picture")
    (place / "out" / "frame.0002.png").touch()  # of a machine that lost its power
    done = farm(place, "--frames", "1-3", "--output", "out/frame.####.png")
    assert done.returncode == 0, done.stdout + done.stderr
    wanted, found = frames(place)
    assert found == wanted
    assert (place / "out" / "frame.0001.png").read_bytes() == b"an older picture"
    assert (place / "out" / "frame.0002.png").stat().st_size > 0
    assert farm(place, "--frames", "1", "--output", "out/frame.####.png", "--force").returncode == 0
    assert (place / "out" / "frame.0001.png").read_bytes().startswith(b"\x89PNG")


def test_a_folder_that_the_log_has_no_letters_for(place):
    done = farm(place, "--frames", "1", "--output", "猫/frame.####.png")
    assert done.returncode == 0, done.stdout + done.stderr
    assert (place / "猫" / "frame.0001.png").read_bytes().startswith(b"\x89PNG")


def test_a_task_that_is_killed_is_started_again(place):
    words, environment = made_ready(farm_words("--frames", "1-3", "--output", "out/frame.####.exr"), place)
    task = subprocess.Popen(words, cwd=place, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    begun = time.monotonic()
    while not (place / "out" / "frame.0001.exr").exists() and time.monotonic() < begun + 120:
        time.sleep(0.01)
    task.kill()
    task.wait(60)
    done = farm(place, "--frames", "1-3", "--output", "out/frame.####.exr")
    assert done.returncode == 0, done.stdout + done.stderr
    for frame in (1, 2, 3):
        assert (place / "out" / f"frame.{frame:04}.exr").read_bytes().startswith(b"\x76\x2f\x31\x01"), frame


def widths(path):
    """How far each object of an .obj reaches along its first axis, by name."""
    found = {}
    for line in path.read_text(encoding="utf-8").splitlines():
        kind, *words = line.split()
        if kind == "o":
            xs = found[" ".join(words)] = []
        elif kind == "v":
            xs.append(float(words[0]))
    return {name: max(xs) - min(xs) for name, xs in found.items()}


def test_what_is_made_anew_in_each_frame(place):
    """Cells of the surface as it is then, exported with it: if they only followed it they would be 3 times as long."""
    arguments = ("--frames", "1,3", "--output", "out/frame.####.obj")
    done = farm(place, *arguments, "--run", "tessellate")
    assert done.returncode == 0, done.stdout + done.stderr
    first, last = (widths(place / "out" / f"frame.{frame:04}.obj") for frame in (1, 3))
    assert first.keys() == last.keys()
    (edges,) = (name for name in first if "Edges" in name)
    assert 2 * first[edges] < last[edges] < 2.9 * first[edges]


def test_a_deforming_character_needs_no_add_on(place):
    """What was made once follows the mesh in every frame: edges of cells are three times as long at its end."""
    assert bpy.ops.saddleback.tessellate() == {"FINISHED"}
    bpy.ops.wm.save_as_mainfile(filepath=str(place / "scene.blend"))
    shutil.rmtree(place / "scripts" / "addons" / "saddleback_blender")
    done = farm(place, "--frames", "1,3", "--output", "out/frame.####.obj")
    assert done.returncode == 0, done.stdout + done.stderr
    first, last = (widths(place / "out" / f"frame.{frame:04}.obj") for frame in (1, 3))
    assert first.keys() == last.keys()
    assert len(first) >= 2
    for name in first:
        assert last[name] == pytest.approx(3 * first[name], rel=0.05), name
    done = farm(place, "--frames", "2", "--output", "out/frame.####.obj", "--run", "tessellate")
    assert done.returncode != 0
    assert "the add-on Saddleback is not enabled in this Blender, nor found" in done.stdout + done.stderr


def test_meshes_as_ply(place):
    done = farm(place, "--frames", "1,3", "--output", "out/frame.####.ply")
    if bpy.app.version < (4, 0):  # the page says so
        assert done.returncode != 0
        assert "frame 1: " in done.stdout + done.stderr
        return
    assert done.returncode == 0, done.stdout + done.stderr
    first, last = ((place / "out" / f"frame.{frame:04}.ply").read_bytes() for frame in (1, 3))
    assert first.startswith(b"ply")
    assert first != last


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--frames", "3-1", "--output", "a.png"), "'3-1' ends before it begins"),
        (("--frames", "x", "--output", "a.png"), "wanted frames such as 7, 1-240"),
        (("--frames", "1", "--output", "a.gif"), "--output: wanted a name that ends in .png, .exr, .ply or .obj"),
        (("--frames", "1", "--output", "a.png", "--object", "Nobody"), "the scene has no object Nobody"),
        (("--frames", "1", "--output", "a.png", "--run", "dance"), "invalid choice: 'dance'"),
        (("--frames", "1", "--output", "a.png", "--run", "tessellate", "--object", "Camera"), "frame 1: "),
        (("--frames", "1", "--output", "scene.blend/a.png"), "frame 1: "),
    ],
)
def test_what_is_wrong_is_said_and_nothing_is_left(place, arguments, says):
    before = sorted(path.name for path in place.iterdir())
    done = farm(place, *arguments)
    assert done.returncode != 0
    assert says in done.stdout + done.stderr
    assert sorted(path.name for path in place.iterdir()) == before
