# SPDX-License-Identifier: GPL-3.0-or-later
r"""Makes the pictures of the tab, in a Blender with a window, high enough for the whole of it.

    SADDLEBACK_UI_FOLDER=/tmp LIBGL_ALWAYS_SOFTWARE=1 xvfb-run -s "-screen 0 1000x1900x24" blender --factory-startup \
        --enable-event-simulate --window-geometry 0 0 1000 1900 --python docs/images/make_tab_pictures.py

It opens the tab by clicks, as the tests of the window do, applies a look to a ball and saves docs/images/tab-*.png.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / room) for room in ("", "addon", "build/python", "tests/addon_ui", "tests/addon_blender")]

import bpy
import hands
import numpy as np
import scenarios

# The rows of the sidebar, from the top, that show a part each.
PARTS = {"top": (0, 318), "cells": (318, 472), "outputs": (472, 657), "more": (657, 840)}


def crop(source: Path, target: Path, left: int, width: int, rows: tuple[int, int]) -> None:
    """A part of a screenshot; rows count from the top."""
    image = bpy.data.images.load(str(source))
    pixels = np.empty(image.size[1] * image.size[0] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    part = pixels.reshape(image.size[1], image.size[0], 4)[::-1][slice(*rows), left : left + width][::-1]
    made = bpy.data.images.new("Part", part.shape[1], part.shape[0])
    made.pixels.foreach_set(np.ascontiguousarray(part).ravel())
    made.filepath_raw, made.file_format = str(target), "PNG"
    made.save()
    print(f"-- {target}: {part.shape[1]} x {part.shape[0]}", flush=True)


def story(screen: hands.Screen) -> Iterator[float]:
    """Opens the tab, makes panels, takes the picture."""
    yield from scenarios.opened(screen)
    with screen.override():
        bpy.ops.saddleback.apply_look("INVOKE_DEFAULT", look="PANELS")
    yield from hands.wait_until(lambda: not bpy.context.window_manager.saddleback_running, "the look", 400)
    yield 10 * hands.FRAME
    yield from screen.shoot("tab")
    bar, high = screen.sidebar, screen.window.height
    above = high - bar.y - bar.height
    for name, (first, last) in PARTS.items():
        target = ROOT / "docs/images" / f"tab-{name}.png"
        crop(hands.FOLDER / "tab.png", target, bar.x, bar.width, (above + first, above + last))


def main() -> None:
    """Plays the story from a timer, as Blender draws between its steps."""
    bpy.context.preferences.system.viewport_aa = "OFF"
    bpy.context.preferences.view.show_splash = False
    scenarios.prepare()
    steps = story(hands.Screen())

    def tick() -> float:
        try:
            return next(steps)
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)

    bpy.app.timers.register(tick, first_interval=1.0)


main()
