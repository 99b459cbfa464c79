# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the frames of an animation on a render farm, a range to a task: run by Blender, or by Python with bpy.

blender -b SCENE.blend -P blend-samples/farm.py -- --frames 1-240 --output OUT/frame.####.png [--run ...]
python blend-samples/farm.py SCENE.blend --frames 1-240 --output OUT/frame.####.png

Each frame: the scene goes there, what `--run` names is made anew with the settings that the object keeps, and the
result is written: a picture as the scene renders it (.png, .exr), or the object and what was made of it (.ply, .obj),
as they are in that frame. Files appear whole or not at all, and frames whose file is there are left out, so that a task
that was ended may simply be started again. The exit code is 0 when every frame is there.
"""

from __future__ import annotations

import argparse
import io
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path

import bpy

PICTURES = {".png": "PNG", ".exr": "OPEN_EXR"}
KINDS = ("repair", "distance", "path", "ribbon", "tessellate", "voronoi_2d", "direction_field", "distribute")


def frames_of(text: str) -> list[int]:
    """Frames that a farm names: 7, 1-240, 1-240x2, and several of these with commas between."""
    frames: list[int] = []
    for part in text.split(","):
        match = re.fullmatch(r"(-?\d+)(?:-(-?\d+)(?:x([1-9]\d*))?)?", part.strip())
        if not match:
            raise argparse.ArgumentTypeError(f"wanted frames such as 7, 1-240 or 1-240x2, got '{part}'")
        first, last, step = int(match[1]), int(match[2] or match[1]), int(match[3] or 1)
        if last < first:
            raise argparse.ArgumentTypeError(f"'{part}' ends before it begins")
        frames += range(first, last + 1, step)
    return frames


def arguments() -> argparse.Namespace:
    """What the command line says; Blender's own arguments end with --."""
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="farm.py", description=__doc__.split("\n")[0])
    parser.add_argument("scene", nargs="?", help="the .blend, unless Blender has opened one")
    parser.add_argument("--frames", required=True, type=frames_of, help="such as 7, 1-240, 1-240x2")
    parser.add_argument("--output", required=True, help="such as OUT/frame.####.png; .exr, .ply and .obj as well")
    parser.add_argument("--run", nargs="*", default=[], choices=KINDS, help="made anew in each frame, in this order")
    parser.add_argument("--object", help="of which; by default the active one")
    parser.add_argument("--force", action="store_true", help="make frames again whose files are there")
    return parser.parse_args(given)


def place_of(pattern: str, frame: int) -> Path:
    """The file of a frame: hash marks are its digits, and are put before the ending where there are none."""
    path = Path(pattern)
    name = path.name if "#" in path.name else f"{path.stem}.####{path.suffix}"
    return path.with_name(re.sub("#+", lambda marks: f"{frame:0{len(marks[0])}d}", name))


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Write beside the place, then move there: nobody ever sees half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.stem}.{os.getpid()}.partial{path.suffix}")
    try:
        write(partial)
        os.replace(partial, path)
    finally:
        partial.unlink(missing_ok=True)


def render(path: Path) -> None:
    """As the scene's camera sees it."""
    settings = bpy.context.scene.render
    settings.image_settings.file_format = PICTURES[path.suffix]
    settings.use_file_extension = False
    settings.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def export(path: Path, item: bpy.types.Object) -> None:
    """The object and what was made of it, all modifiers applied."""
    for other in bpy.context.view_layer.objects:
        other.select_set(other == item or other in item.children_recursive)
    if path.suffix == ".obj":
        bpy.ops.wm.obj_export(filepath=str(path), export_selected_objects=True, export_materials=False)
    else:
        bpy.ops.wm.ply_export(filepath=str(path), export_selected_objects=True)


def main() -> None:
    """All frames, one after the other."""
    asked = arguments()
    suffix = Path(asked.output).suffix
    if suffix not in (*PICTURES, ".ply", ".obj"):
        sys.exit(f"--output: wanted a name that ends in .png, .exr, .ply or .obj, got '{asked.output}'")
    if asked.scene:
        if not Path(asked.scene).is_file():
            sys.exit(f"scene: there is no file {asked.scene}")
        bpy.ops.wm.open_mainfile(filepath=str(Path(asked.scene).resolve()), load_ui=False)
    if asked.run and not hasattr(bpy.types, "SADDLEBACK_OT_tessellate"):
        try:
            bpy.ops.preferences.addon_enable(module="saddleback_blender")
        except RuntimeError as error:
            sys.exit(f"--run: the add-on Saddleback is not enabled in this Blender, nor found ({error})")
    item = bpy.data.objects.get(asked.object) if asked.object else bpy.context.view_layer.objects.active
    if item is None and (asked.run or asked.object or suffix not in PICTURES):
        sys.exit(f"--object: the scene has no object {asked.object or 'that is active'}; name one")
    if item is not None:
        bpy.context.view_layer.objects.active = item
    if isinstance(sys.stdout, io.TextIOWrapper):  # a farm's log may have no letter for what a folder is called
        sys.stdout.reconfigure(errors="backslashreplace")
    for frame in asked.frames:
        path = place_of(str(Path(asked.output).resolve()), frame)
        if path.is_file() and path.stat().st_size > 0 and not asked.force:
            print(f"-- {frame}: {path} is there", flush=True)
            continue
        bpy.context.scene.frame_set(frame)
        try:
            for kind in asked.run:
                getattr(bpy.ops.saddleback, kind)()
            write_whole(path, render if suffix in PICTURES else lambda to: export(to, item))
        except Exception as error:  # Blender itself would end with the exit code of success
            sys.exit(f"frame {frame}: {str(error).strip()}")
        print(f"-- {frame}: {path}", flush=True)


main()
if not bpy.app.binary_path:  # the module of Blender 4.2 crashes when Python ends, whose exit code would be a failure's
    sys.stdout.flush()
    os._exit(0)
