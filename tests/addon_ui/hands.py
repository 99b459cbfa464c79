# SPDX-License-Identifier: GPL-3.0-or-later
"""A person at Blender: a screen to look at, a mouse, keys, and patience."""

import os
import time
from itertools import product
from pathlib import Path

import bpy

FOLDER = Path(os.environ["SADDLEBACK_UI_FOLDER"])
FRAME = 0.05  # seconds in which Blender handles the events that were sent and draws
PATIENCE = 60.0
STEP = 9  # pixels; a button is more than twice as high
known_places = {}  # where in the sidebar what is sought was last


class Screen:
    """The window, the 3D View and its sidebar, and a person's hands."""

    def __init__(self):
        self.window = bpy.context.window_manager.windows[0]
        self.area = next(area for area in self.window.screen.areas if area.type == "VIEW_3D")
        self.area.spaces.active.show_region_ui = True
        self.sidebar = next(region for region in self.area.regions if region.type == "UI")
        self.view = next(region for region in self.area.regions if region.type == "WINDOW")
        self.mouse = (400, 400)

    def override(self, region=None):
        """The context of the 3D View, or of one of its regions."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=region or self.view)

    def move(self, x, y):
        """Moves the mouse in two steps, so that what is under it notices."""
        for place in ((x + 4, y), (x, y)):
            self.window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=int(place[0]), y=int(place[1]))
        self.mouse = (int(x), int(y))

    def click(self, x, y):
        """Clicks the left button."""
        self.move(x, y)
        yield 4 * FRAME  # until what is under the mouse is lit up; before that a press is lost
        for value in ("PRESS", "RELEASE"):
            self.window.event_simulate(type="LEFTMOUSE", value=value, x=int(x), y=int(y))
            yield 2 * FRAME

    def press(self, key, **modifiers):
        """Presses and releases a key where the mouse is."""
        x, y = self.mouse
        for value in ("PRESS", "RELEASE"):
            self.window.event_simulate(type=key, value=value, x=x, y=y, **modifiers)

    def shoot(self, name):
        """Takes a picture of the whole window."""
        self.redraw()
        yield FRAME
        with self.override():
            bpy.ops.screen.screenshot(filepath=str(FOLDER / f"{name}.png"))
        yield FRAME

    def redraw(self):
        """Asks for a redraw of the sidebar."""
        self.sidebar.tag_redraw()

    def leave(self):
        """Moves the mouse into the view, and waits until Blender has left what it was over before."""
        self.move(self.view.x + 200, self.view.y + 300)
        for _ in range(6):
            yield 2 * FRAME
            with self.override(self.sidebar):
                if not (bpy.ops.ui.copy_python_command_button.poll() or bpy.ops.ui.copy_data_path_button.poll()):
                    return

    def find_button(self, command):
        """Where in the sidebar an operator's button is, by its command."""
        is_it = lambda copied: copied.startswith(command)  # noqa: E731 - asked again and again
        is_pair = "apply_look" in command  # two in a row
        return (yield from self._find(command, "copy_python_command_button", is_it, is_pair))

    def find_switch(self, name):
        """Where in the sidebar a property is, by the end of its path."""
        return (yield from self._find(name, "copy_data_path_button", lambda copied: copied.endswith(name)))

    def _find(self, name, copy, is_it, is_pair=False):
        """A place just below the first at which what Blender copies of what is under the mouse is sought."""
        left, bottom, width = self.sidebar.x, self.sidebar.y, self.sidebar.width
        # Down the middle first; then where buttons stand side by side.
        columns = [left + across for across in (width // 2 - 20, width // 5, width * 2 // 3, width - 45)]
        yield from self.leave()
        rows = range(bottom + self.sidebar.height - 8, bottom + 8, -2 * STEP)
        for x, y in [*known_places.get(name, ()), *product(columns[is_pair:], rows)]:
            if is_it((yield from self._copied(copy, x, y))):
                is_higher = is_it((yield from self._copied(copy, x, y + STEP)))
                y += STEP if is_higher else 0
                known_places[name] = [(x, y)]
                return x, y - 7  # into the middle: a press on the very edge may miss
        raise AssertionError("what is sought is not in the sidebar")

    def _copied(self, copy, x, y):
        """What Blender copies of what is there."""
        self.move(x, y)
        yield FRAME
        bpy.context.window_manager.clipboard = ""
        operator = getattr(bpy.ops.ui, copy)
        with self.override(self.sidebar):
            if operator.poll():
                operator()
        return bpy.context.window_manager.clipboard

    def click_until(self, place, is_done):
        """Clicks a button until something happens: the first click on a region may only wake it."""
        for _ in range(4):
            yield from self.leave()
            yield from self.click(*place)
            end = time.perf_counter() + 5.0
            while time.perf_counter() < end:
                if is_done():
                    return
                yield FRAME
        yield from self.shoot("nothing_happened")
        raise AssertionError("four clicks on the button did nothing: see nothing_happened.png")

    def open_tab(self, is_open):
        """Clicks the tabs at the sidebar's edge one after another until the wanted one is open."""
        self.redraw()
        yield 4 * FRAME
        right, top = self.sidebar.x + self.sidebar.width - 10, self.sidebar.y + self.sidebar.height
        for y in range(top - 30, self.sidebar.y + 20, -40):
            yield from self.click(right, y)
            yield 4 * FRAME
            if is_open():
                return
        raise AssertionError("no tab of the sidebar opens the panels")


def wait_until(condition, what, patience=PATIENCE):
    """Waits as a person does, without holding Blender up."""
    end = time.perf_counter() + patience
    while not condition():
        if time.perf_counter() > end:
            raise AssertionError(f"waited {patience:g} s for {what}")
        yield FRAME
