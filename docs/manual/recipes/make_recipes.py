# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures and animations of the recipes, by the operators that an artist's clicks run.

    .cache/bpy-4.5/bin/python docs/manual/recipes/make_recipes.py [NAME ...]

Each entry of RECIPES is a model, its steps, and what moves in the animation. It needs Python with bpy, which renders,
and Pillow (pip install Pillow), which writes the animations: a tool for making this documentation alone.
"""

from __future__ import annotations

import math
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = [str(ROOT / room) for room in ("blend-samples/scene", "blend-samples/creature", "addon", "build/python")]
sys.path.insert(0, str(HERE))

import bpy
import models
import numpy as np
import shape
import studio
import subject
from mathutils import Vector
from PIL import Image

STEP_SIZE, MOTION_SIZE = (420, 280), (320, 214)
STEP_SAMPLES, MOTION_SAMPLES = 4, 3
BACKDROP = (0.11, 0.12, 0.14, 1.0)
COLORS, FRAME_TIME = 112, 110  # of the animations; milliseconds
Action = Callable[[bpy.types.Object], None]


def press(operator: str, **values: Any) -> Action:
    """Clicks a button of the tab: a call from a script would leave out what only the panel begins with."""

    def act(item: bpy.types.Object) -> None:
        from saddleback_blender.props import BEGIN

        group, begin = getattr(item.saddleback, operator, None), BEGIN.get(operator, {})
        begun = {name: value for name, value in begin.items() if not group.is_property_set(name)}
        print(f"   {operator}: {getattr(bpy.ops.saddleback, operator)(**begun, **values)}", flush=True)

    return act


def choose(group: str = "", **values: Any) -> Action:
    """Sets settings in the tab: of a panel, or above the panels."""

    def act(item: bpy.types.Object) -> None:
        owner = getattr(item.saddleback, group) if group else item.saddleback
        for name, value in values.items():
            setattr(owner, name, value() if callable(value) else value)

    return act


def press_kept(operator: str, group: str, **values: Any) -> list[Action]:
    """Sets settings, then clicks."""
    return [choose(group, **values), press(operator)]


@dataclass
class Recipe:
    """A model, what is done in each step, and for each frame of the animation what is done before it."""

    model: Callable[[], bpy.types.Object]
    steps: list[list[Action]]
    motion: Callable[[bpy.types.Object], Iterator[None]]
    view: tuple[float, float, float] = (0.50, -1.0, 0.27)
    room: list[tuple[float, float, float]] = field(default_factory=list)  # points that the picture holds as well


def swing(item: bpy.types.Object, frames: int = 12, reach: float = 35.0) -> Iterator[None]:
    """Turns the object to and fro."""
    begin = item.rotation_euler.z
    for i in range(frames):
        item.rotation_euler.z = begin + math.radians(reach) * math.sin(2 * math.pi * i / frames)
        yield


def grow(operator: str, group: str, name: str, values: list[Any]) -> Callable[[bpy.types.Object], Iterator[None]]:
    """Sets one setting again and again and clicks."""

    def move(item: bpy.types.Object) -> Iterator[None]:
        for value in values:
            for act in press_kept(operator, group, **{name: value}):
                act(item)
            yield

    return move


def chameleon() -> bpy.types.Object:
    """The demo's model, with a third of its faces."""
    return models.solid("Chameleon", shape.parts(), 0.03)


def to_nose(item: bpy.types.Object, turn: float = 0.0) -> None:
    """Puts the 3D cursor to the nose, or somewhere on the way from there to the tail."""
    places = subject.positions(item)
    wanted = places[:, 0].max() - turn * np.ptp(places[:, 0])
    near = np.flatnonzero(np.abs(places[:, 0] - wanted) < 0.05)
    bpy.context.scene.cursor.location = places[near[np.argmin(places[near, 1])]]


def wander(item: bpy.types.Object, frames: int = 10) -> Iterator[None]:
    """The cursor goes along the body and back, and the bands go with it."""
    for i in range(frames):
        to_nose(item, 0.28 * (1 - math.cos(2 * math.pi * i / frames)))
        press("distance")(item)
        yield


def draw_strokes(item: bpy.types.Object) -> None:
    """What the pen would draw, as curves."""
    import looks

    press("draw_strokes", pen="CURVE")(item)
    curve = bpy.context.active_object
    bpy.ops.object.mode_set(mode="OBJECT")
    curve.data.splines.clear()
    for points in models.fish_strokes():
        spline = curve.data.splines.new("POLY")
        spline.points.add(len(points) - 1)
        spline.points.foreach_set("co", np.column_stack([points, np.ones(len(points))]).astype(np.float32).ravel())
    curve.data.bevel_depth = 0.012
    curve.data.materials.append(looks.red_ink())
    bpy.context.view_layer.objects.active = item


def hide_strokes(item: bpy.types.Object) -> None:
    """Takes the strokes out of the picture."""
    next(
        child for child in item.children if child.type == "CURVE" and "saddleback_role" not in child
    ).hide_render = True


def paint(item: bpy.types.Object) -> None:
    """Presses the button Weights, and paints."""
    press("paint_density", paint="WEIGHT")(item)
    bpy.ops.object.mode_set(mode="OBJECT")
    models.paint_fingers(item)


def bend(item: bpy.types.Object, frames: int = 10) -> Iterator[None]:
    """Bends the strap to a ring and back; the studs follow."""
    modifier = item.modifiers.new("Bend", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "BEND", "Z"
    for i in range(frames):
        modifier.angle = math.radians(80.0) * (1 - math.cos(2 * math.pi * i / frames))
        yield


def put_light(item: bpy.types.Object) -> None:
    """A bulb in the lamp."""
    bulb = bpy.data.objects.new("Bulb", bpy.data.lights.new("Bulb", "POINT"))
    bulb.data.energy, bulb.data.color, bulb.data.shadow_soft_size = 0.6, (1.0, 0.72, 0.4), 0.012
    bulb.location = 0, 0, 0.065
    bpy.context.scene.collection.objects.link(bulb)


def suzanne() -> bpy.types.Object:
    """Blender's monkey, smoothed by a modifier."""
    bpy.ops.mesh.primitive_monkey_add()
    item = models.smooth(bpy.context.active_object)
    item.modifiers.new("Subdivision", "SUBSURF").levels = 2
    bpy.context.view_layer.update()
    return item


def show_wires(item: bpy.types.Object) -> None:
    """Draws the edges of the new mesh, as Edit Mode does, for the picture."""
    made = next(child for child in item.children if child.get("saddleback_role") == "dual")
    made.data.polygons.foreach_set("use_smooth", np.zeros(len(made.data.polygons), bool))
    if "Lines" not in made.modifiers:
        lines = made.modifiers.new("Lines", "WIREFRAME")
        lines.thickness, lines.use_replace, lines.material_offset = 0.012, False, 1
        made.data.materials.clear()
        for name, color in (("Clay", (0.62, 0.5, 0.4)), ("Lines", (0.03, 0.03, 0.03))):
            made.data.materials.append(studio.principled(name, color, Roughness=0.7))


RECIPES = {
    "panels": Recipe(models.hull, [[], [press("apply_look", look="PANELS")],
        press_kept("tessellate", "tessellate", count=500)], swing, (0.75, -1.0, 0.7)),
    "pebbles": Recipe(models.vase, [[], [press("apply_look", look="PEBBLES")],
        press_kept("tessellate", "tessellate", count=300)], swing),
    "scales": Recipe(models.fish, [[draw_strokes], [press("direction_field")],
        [hide_strokes, press("apply_look", look="SCALES")]], swing, (0.35, -1.0, 0.25)),
    "studs": Recipe(models.strap, [[], [press("apply_look", look="STUDS")]], bend, (0.35, -1.0, 0.35),
        room=[(0.0, 0.0, 1.35)]),
    "lamp": Recipe(models.lamp, [[], [press("apply_look", look="LAMP")], [put_light]], swing),
    "stipple": Recipe(models.canvas, [[],
        press_kept("voronoi_2d", "voronoi_2d", sites_source="IMAGE", image_name=models.portrait, count=4000,
            make_edges=False, make_cells=False, make_centers=True)],
        grow("voronoi_2d", "voronoi_2d", "iterations", [0, 0, 1, 2, 4, 8, 14, 22, 30, 30]), (0.0, -1.0, 0.0)),
    "remesh": Recipe(suzanne, [[], [press("apply_look", look="REMESH"), show_wires],
        [*press_kept("tessellate", "tessellate", count=600), show_wires]], swing, (0.4, -1.0, 0.15)),
    "bands": Recipe(chameleon, [[], [to_nose, press("apply_look", look="BANDS")]], wander, (0.5, -1.0, 0.2)),
    "density": Recipe(models.hand, [[paint], [press("apply_look", look="PANELS")],
        press_kept("tessellate", "tessellate", count=500)], swing, (0.3, -1.0, 0.15)),
    "layers": Recipe(models.shield, [[],
        [choose(region="MATERIAL", region_name="Plate"), press("apply_look", look="PANELS")],
        [press("layer_add"), choose(region="MATERIAL", region_name="Rim"), press("apply_look", look="STUDS")]],
        swing, (0.3, -1.0, 0.1)),
}  # fmt: skip


def stage(points: np.ndarray, view: tuple[float, float, float]) -> None:
    """A dark backdrop, lights, and a camera that sees the points (n, 3) from a direction."""
    studio.VIEW = Vector(view).normalized()
    studio.add_to(bpy.context.scene, points, STEP_SIZE[0] / STEP_SIZE[1])
    shader = bpy.data.materials["Backdrop"].node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = BACKDROP


def render(path: Path, size: tuple[int, int], samples: int) -> None:
    """Renders one picture."""
    scene = bpy.context.scene
    studio.use_cycles(scene, *size, samples)
    scene.cycles.denoising_quality, scene.cycles.denoising_prefilter = "FAST", "NONE"
    scene.view_settings.exposure = -0.6
    scene.render.image_settings.file_format = "JPEG" if path.suffix == ".jpg" else "PNG"
    scene.render.image_settings.quality = 88
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def animate(frames: list[Path], target: Path) -> None:
    """One animation of many pictures, all with the same colors."""
    pictures = [Image.open(frame).convert("RGB") for frame in frames]
    strip = Image.new("RGB", (pictures[0].width, sum(picture.height for picture in pictures)))
    for i, picture in enumerate(pictures):
        strip.paste(picture, (0, i * picture.height))
    palette = strip.quantize(COLORS, kmeans=3, dither=Image.Dither.NONE)  # the means keep rare colors
    flat = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    flat[0].save(target, save_all=True, append_images=flat[1:], duration=FRAME_TIME, loop=0, optimize=True)
    print(f"-- {target.relative_to(ROOT)}: {target.stat().st_size / 1000:.0f} KB", flush=True)


def make(name: str, recipe: Recipe, folder: Path) -> None:
    """All pictures of one recipe."""
    folder.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    item = recipe.model()
    bpy.context.view_layer.update()
    stage(np.concatenate([subject.positions(item) * 1.03, np.array(recipe.room).reshape(-1, 3)]), recipe.view)
    for number, actions in enumerate(recipe.steps, 1):
        for act in actions:
            act(item)
        render(folder / f"{number}.jpg", STEP_SIZE, STEP_SAMPLES)
    with tempfile.TemporaryDirectory() as place:
        frames = []
        for i, _ in enumerate(recipe.motion(item)):
            frames.append(Path(place) / f"{i:02}.png")
            render(frames[-1], MOTION_SIZE, MOTION_SAMPLES)
        animate(frames, folder / "motion.gif")


def main() -> None:
    """Makes the recipes that are named, or all."""
    for name in sys.argv[1:] or RECIPES:
        make(name, RECIPES[name], HERE / "images" / name)


if __name__ == "__main__":
    main()
