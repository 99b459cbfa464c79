# SPDX-License-Identifier: GPL-3.0-or-later
"""Six jobs of an artist, each in a new file with a mesh in it, by clicks that are counted; played by driver.py.

How clicks are counted: the object is selected and the tab open before. Each press of a mouse button on the tab or the
file browser is one, also the press that confirms a file; strokes in the view are counted apart. Nothing is typed. What
Blender did not notice, as the first press on a window that was just made, is done again and counts once.
"""

import math
import os
import shutil
import sys
from pathlib import Path

import bpy
import numpy as np
from hands import FOLDER, FRAME, Screen, wait_until

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [
    str(REPOSITORY / room) for room in ("docs/manual/recipes", "blend-samples/scene", "blend-samples/creature")
]

import models

LONG = 400.0  # seconds that a run may take where everything is drawn in software


class Artist(Screen):
    """A person whose clicks are counted."""

    def __init__(self):
        super().__init__()
        self.clicks = self.strokes = 0
        self.hidden = []  # pixels of the tab that the window does not show: at first, and after the run

    def rows_below(self):
        """How many pixels the tab can be scrolled: what of it lies below the screen."""
        x, y = self.sidebar.x + self.sidebar.width // 2, self.sidebar.y + self.sidebar.height // 2
        ends = []
        for wheel in ("WHEELDOWNMOUSE", "WHEELUPMOUSE"):
            self.move(x, y)
            yield 4 * FRAME
            for _ in range(8):
                self.window.event_simulate(type=wheel, value="PRESS", x=x, y=y)
                yield 0.0
            yield 6 * FRAME
            ends.append(self.sidebar.view2d.region_to_view(0, 0)[1])
        return ends[1] - ends[0]

    def wish(self, command, is_done):
        """Clicks the button of a command in the tab until it is noticed: one click."""
        place = yield from self.find_button(command)
        yield from self.click_until(place, is_done)
        self.clicks += 1

    def open_panel(self, name, below):
        """Clicks the heading that stands so many pixels below the button Tessellate."""
        _, y = yield from self.find_button("bpy.ops.saddleback.tessellate")
        panel, opened = getattr(bpy.types, f"SADDLEBACK_PT_{name}"), []
        look = lambda *_: opened.append(True)  # noqa: E731 - what is appended is taken away again
        panel.append(look)
        yield from self.click_until((self.sidebar.x + self.sidebar.width // 2, y - below), lambda: opened)
        panel.remove(look)
        self.clicks += 1

    def draw(self, lines):
        """Leaves what the pen would: strokes are not counted as clicks, and a pen that is pushed by events hangs."""
        note = bpy.data.grease_pencils.new("Note")
        bpy.context.scene.grease_pencil = note
        frame = note.layers.new("Strokes").frames.new(1)
        for line in lines:
            stroke = frame.strokes.new()
            stroke.display_mode = "3DSPACE"
            stroke.points.add(len(line))
            for point, place in zip(stroke.points, line, strict=True):
                point.co = place
            self.strokes += 1
        yield 4 * FRAME

    def confirm(self):
        """Clicks the button of the file browser that takes the file."""
        yield from self._click_in_browser("EXECUTE", lambda region: (region.width - 60, region.height // 2))
        yield from wait_until(lambda: not has_browser(), "the file browser to close", 20)
        yield 4 * FRAME
        self.clicks += 1

    def choose_first(self):
        """Clicks the first file in the list, below the headings."""
        for below in (34, 40, 46, 52):  # where it is depends on the theme's sizes
            yield from self._click_in_browser("WINDOW", lambda region: (80, region.height - below))  # noqa: B023
            if bpy.context.window_manager.windows[-1].screen.areas[0].spaces.active.params.filename:
                break
        self.clicks += 1

    def _click_in_browser(self, kind, place):
        yield 20 * FRAME
        mine, self.window = self.window, bpy.context.window_manager.windows[-1]
        region = next(region for region in self.window.screen.areas[0].regions if region.type == kind)
        x, y = place(region)
        yield from self.click(region.x + x, region.y + y)
        yield 10 * FRAME
        self.window = mine


def prepare():
    """The add-on enabled."""
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender.core import native

    native.load()
    watch_tab()


def watch_tab():
    from saddleback_blender.ui import panels

    panels.SADDLEBACK_PT_main.append(lambda *_: drawn.update(main=drawn["main"] + 1))


drawn = {"main": 0}


def new_file(make):
    """A new file with nothing but what `make` makes, selected, seen as a whole; the tab is open."""
    bpy.ops.wm.read_homefile(use_factory_startup=True)
    yield 10 * FRAME
    artist = Artist()
    drawn["main"] = 0
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    with artist.override():
        if make is not None:
            make_active(make())
            bpy.ops.view3d.view_selected()
        bpy.ops.ed.undo_push(message="Ready")
    yield 10 * FRAME
    for x in (300, 500):  # the first drag after the start gets lost
        yield from artist.click(x, 500)
    if make is not None:
        make_active(bpy.data.objects[0])
    yield from artist.open_tab(lambda: drawn["main"] > 0)
    return artist


def in_order(_screen):
    """The jobs; each begins with a file of its own."""
    jobs = (panels_on_a_car, leather, lamp_to_stl, stippled_portrait, remesh, scales_along_strokes)
    only = os.environ.get("SADDLEBACK_UI_ONLY", "").split()
    return {job.__name__: job for job in jobs if not only or job.__name__ in only}


def make_active(item):
    bpy.ops.object.select_all(action="DESELECT")
    item.select_set(True)
    bpy.context.view_layer.objects.active = item


def look_button(look):
    return f"bpy.ops.saddleback.apply_look(look='{look}')"


def shown(artist, name):
    """Pictures as one sees it: in Solid view, with the tab, and in Material Preview."""
    yield 10 * FRAME
    yield from artist.shoot(name)
    if "SADDLEBACK_UI_MATERIAL" not in os.environ:  # takes a minute in software
        return
    artist.area.spaces.active.shading.type = "MATERIAL"
    artist.area.tag_redraw()
    yield 40 * FRAME
    yield from artist.shoot(f"{name}-material")
    artist.area.spaces.active.shading.type = "SOLID"


def one_look(make, look, name):
    artist = yield from new_file(make)
    artist.hidden.append((yield from artist.rows_below()))
    yield from artist.wish(look_button(look), is_running)
    yield from made()
    artist.hidden.append((yield from artist.rows_below()))
    yield from shown(artist, name)
    item = bpy.context.view_layer.objects.active
    return artist, item


def is_running():
    return bpy.context.window_manager.saddleback_running


def made():
    yield from wait_until(lambda: not is_running(), "the run to end", LONG)
    yield 4 * FRAME


def seen(artist, item):
    outputs = {
        child["saddleback_role"]: len(child.data.vertices) for child in item.children if "saddleback_role" in child
    }
    return {
        "clicks": artist.clicks,
        "strokes": artist.strokes,
        "hidden": artist.hidden,
        "outputs": outputs,
        "line": bpy.context.window_manager.saddleback_line,
    }


def panels_on_a_car():
    artist, item = yield from one_look(car, "PANELS", "car")
    return seen(artist, item)


def leather():
    artist, item = yield from one_look(models.strap, "PEBBLES", "leather")
    return seen(artist, item)


def remesh():
    artist, item = yield from one_look(monkey, "REMESH", "remesh")
    return seen(artist, item)


def scales_along_strokes():
    """Opens Direction Field, presses Draw, draws, clicks Scales."""
    artist = yield from new_file(models.fish)
    yield from artist.open_panel("direction_field", below=346)
    yield from artist.wish("bpy.ops.saddleback.draw_strokes(pen='ANNOTATE')", holds_pen)
    yield from artist.draw(models.fish_strokes())
    yield from artist.wish(look_button("SCALES"), is_running)
    yield from made()
    yield from shown(artist, "scales")
    item = bpy.data.objects["Fish"]
    return seen(artist, item) | {"follows": item.saddleback.direction_field.strokes}


def lamp_to_stl():
    """Clicks Lamp, presses Export STL, confirms the file."""
    artist, item = yield from one_look(models.lamp, "LAMP", "lamp")
    yield from in_folder_of_its_own(artist, "lamp")
    yield from artist.wish("bpy.ops.saddleback.export_stl", has_browser)
    yield from artist.confirm()
    written = list((FOLDER / "lamp").glob("*.stl"))
    return seen(artist, item) | {"files": {path.name: path.stat().st_size for path in written}}


def stippled_portrait():
    """Presses the button beside Stipple, clicks the image, confirms. There is no mesh at first."""
    artist = yield from new_file(None)
    yield from in_folder_of_its_own(artist, "portrait")
    models.portrait().save_render(str(FOLDER / "portrait" / "portrait.png"))
    yield from artist.wish("bpy.ops.saddleback.stipple_image", has_browser)
    yield from artist.choose_first()
    yield from artist.confirm()
    yield from artist.shoot("portrait-added")
    yield from wait_until(lambda: bpy.context.view_layer.objects.active is not None, "the sheet", 20)
    yield from shown(artist, "portrait")
    return seen(artist, bpy.context.view_layer.objects.active)


def in_folder_of_its_own(artist, name):
    """Saves the file where the artist keeps what belongs to it: the file browser begins there."""
    folder = FOLDER / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    with artist.override():
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"))
    yield 4 * FRAME


def holds_pen():
    return bpy.context.workspace.tools.from_space_view3d_mode("OBJECT").idname == "builtin.annotate"


def has_browser():
    return len(bpy.context.window_manager.windows) > 1


def car():
    """The body of a car, 4.4 m long, of 11,000 faces."""
    xs = np.linspace(-2.2, 2.2, 12)
    rows = []
    for x in xs:
        cabin = 1 / (1 + math.exp(-7 * (x + 1.35))) / (1 + math.exp(7 * (x - 0.75)))
        high = 0.75 + 0.6 * cabin - 0.14 * max(0, x - 1.4) ** 1.2 - 0.10 * max(0, -1.8 - x)
        wide, up = 0.86 - 0.10 * abs(x / 2.2) ** 3, max(0, high - 0.75) / 0.6
        half = [(1, 0.22), (1.03, 0.5), (1, 0.85 * min(high, 0.85)), (1 - 0.22 * up, 0.95 * high - 0.16 * up),
                (0.8 - 0.15 * up, high * 0.975), (0.3, high)]  # fmt: skip
        rows.append([(x, -wide * y, z) for y, z in half] + [(x, wide * y, z) for y, z in half[::-1]])
    around = len(rows[0])
    faces = [(i * around + j, i * around + j + 1, (i + 1) * around + j + 1, (i + 1) * around + j)
             for i in range(len(xs) - 1) for j in range(around - 1)]  # fmt: skip
    for i in (0, len(xs) - 1):
        caps = [(i * around + j, i * around + around - 1 - j, i * around + around - 2 - j, i * around + j + 1)
                for j in range(around // 2 - 1)]  # fmt: skip
        faces += caps if i else [cap[::-1] for cap in caps]
    item = models.smooth(models.add_mesh("Car", np.array(rows).reshape(-1, 3), faces))
    bpy.context.view_layer.objects.active = item
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.normals_make_consistent(inside=False)
    bpy.ops.object.mode_set(mode="OBJECT")
    item.modifiers.new("Subdivision", "SUBSURF").levels = 3
    bpy.ops.object.modifier_apply(modifier="Subdivision")
    return item


def monkey():
    bpy.ops.mesh.primitive_monkey_add()
    item = models.smooth(bpy.context.active_object)
    item.modifiers.new("Subdivision", "SUBSURF").levels = 2
    return item
