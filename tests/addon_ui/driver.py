# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender with a window: plays scenarios as a person would, and writes what it saw.

    blender --factory-startup --enable-event-simulate --python-exit-code 9 --python driver.py

A scenario is a generator that yields the seconds until Blender calls it again; between two calls Blender handles events
and draws. It returns what the test outside looks at. SADDLEBACK_UI_FOLDER gets report.json and the screenshots.
"""

import importlib
import json
import os
import sys
import time
import traceback
from pathlib import Path

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
FOLDER = Path(os.environ["SADDLEBACK_UI_FOLDER"])
sys.path[:0] = [str(REPOSITORY), str(REPOSITORY / "addon"), str(HERE), str(HERE.parent / "addon_blender")]
sys.path += [path for path in os.environ.get("SADDLEBACK_PYTHONPATH", "").split(os.pathsep) if path]

import bpy
from hands import Screen

TURN = 0.005  # seconds of rest in each turn of Blender's main loop, which never sleeps while events are simulated
PLAYS = importlib.import_module(os.environ.get("SADDLEBACK_UI_PLAYS", "scenarios"))


def play(plays):
    """Plays all scenarios in order from a timer, writes the report and ends Blender."""
    report = {}

    def story():
        for name, scenario in plays.items():
            try:
                report[name] = {"seen": (yield from scenario())}
            except Exception:  # noqa: PERF203 - the next scenario must be played all the same
                report[name] = {"error": traceback.format_exc()}
        (FOLDER / "report.json").write_text(json.dumps(report, indent=1))

    steps = story()

    def tick():
        try:
            return next(steps)
        except StopIteration:
            pass
        except BaseException:
            traceback.print_exc()
        sys.stdout.flush()
        os._exit(0)  # quitting in order may ask to save, and nothing of this Blender is to be kept

    def rest():
        time.sleep(TURN)
        return 0.0

    bpy.app.timers.register(tick, first_interval=1.0, persistent=True)
    bpy.app.timers.register(rest, persistent=True)


def main():
    """Enables the add-on and starts the scenarios."""
    bpy.context.preferences.system.viewport_aa = "OFF"  # a quarter of the time for each redraw in software
    bpy.context.preferences.view.show_splash = False
    bpy.context.preferences.view.smooth_view = 0  # no view glides while a run begins
    PLAYS.prepare()
    play(PLAYS.in_order(Screen()))


main()
