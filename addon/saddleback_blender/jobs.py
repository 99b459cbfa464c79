# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs that go on while Blender stays usable: one worker thread each, watched by a timer, ended before Blender quits.

The thread works on arrays and never touches bpy; progress and cancel go through a token, never a call into Python from
native threads. What the panel shows of a run is read through properties of the window manager that store nothing, so a
run leaves no trace in the file. One is a switch of the tab, which no file has either.
"""

from __future__ import annotations

import atexit
import threading
from collections.abc import Callable
from typing import Any

import bpy
from bpy.props import BoolProperty, FloatProperty, StringProperty

from .core.progress import Progress


class Task:
    """One call in one thread. `done`, `result` and `error` are read by the timer; `cancel` returns at once."""

    def __init__(self, call: Callable[[Progress], Any], progress: Progress, name: str) -> None:
        self.progress = progress
        self.name = name
        self.result: Any = None
        self.error: BaseException | None = None
        self._call = call
        self._thread = threading.Thread(target=self._run, name="saddleback", daemon=True)

    @property
    def text(self) -> str:
        """Says whose run it is and what is being done."""
        return f"{self.name}: {self.progress.text}" if self.progress.text else self.name

    @property
    def done(self) -> bool:
        """True once the thread has ended."""
        return not self._thread.is_alive()

    def start(self) -> None:
        """Starts the thread."""
        _unfinished.append(self)
        self._thread.start()

    def cancel(self) -> None:
        """Asks it to stop, without waiting."""
        self.progress.cancel()

    def join(self, seconds: float | None = None) -> None:
        """Waits for the end of the thread, at most `seconds`."""
        self._thread.join(seconds)

    def _run(self) -> None:
        try:
            self.result = self._call(self.progress)
        except BaseException as error:  # handed to the main thread, which tells it in words
            self.error = error


class State:
    """Holds what the panel shows: the task that is watched, the object refused last, what the last run made.

    Blender asks for a text twice, for its length and for itself, and must get the same: none may change but by `look`.
    """

    def __init__(self) -> None:
        self.task: Task | None = None
        self.text = ""  # what the task was doing when it was looked at last
        self.kind = ""  # of the last run: the name of its settings
        self.needs_repair = ""
        self.line = ""
        self.figures: list[str] = []
        self.written: set[str] = set()  # objects for which runs wrote what Auto Update has not seen yet
        self.colored: set[int] = set()  # 3D views, by their pointers, that a look made show colors of attributes
        self.live: dict[str, str] = {}  # by object: what Auto Update is doing, or why it waits
        self.live_running: tuple[str, int] | None = None  # the object whose run goes on, and how many percent are done
        self.live_asked: set[str] = set()  # objects whose Auto Update was switched on just now
        self.live_ended = ""  # why it goes on no longer for an object that is gone


state = State()
_unfinished: list[Task] = []


WINDOW_MANAGER_PROPERTIES = {
    "saddleback_running": BoolProperty(
        name="Running", description="A run is going on", get=lambda _: state.task is not None
    ),
    "saddleback_fraction": FloatProperty(
        name="Progress", description="Share of the run done", min=0.0, max=1.0, subtype="FACTOR",
        get=lambda _: state.task.progress.fraction if state.task is not None else 0.0,
    ),
    "saddleback_percent": FloatProperty(
        name="Progress", description="Share of the run done", min=0.0, max=100.0, precision=0, subtype="PERCENTAGE",
        get=lambda _: 100.0 * state.task.progress.fraction if state.task is not None else 0.0,
    ),
    "saddleback_text": StringProperty(
        name="Doing", description="What is being done", get=lambda _: state.text
    ),
    "saddleback_kind": StringProperty(
        name="Kind", description="Which settings the last run was of", get=lambda _: state.kind
    ),
    "saddleback_needs_repair": StringProperty(
        name="Needs Repair", description="Object refused by the last run", get=lambda _: state.needs_repair
    ),
    "saddleback_line": StringProperty(
        name="Last Run", description="What the last run made", get=lambda _: state.line
    ),
    "saddleback_all_selected": BoolProperty(
        name="All Selected", description="Do the same to all selected mesh objects, not only to the active one"
    ),
    "saddleback_figures": StringProperty(
        name="Figures", description="How even the last run's cells are", get=lambda _: "\n".join(state.figures)
    ),
}  # fmt: skip


def start(call: Callable[[Progress], Any], progress: Progress, name: str) -> Task:
    """Starts a task and shows it in the panel; the caller must end it with `finish`."""
    state.task = start_unseen(call, progress, name)
    return state.task


def start_unseen(call: Callable[[Progress], Any], progress: Progress, name: str) -> Task:
    """Starts a task that is in nobody's way."""
    _unfinished[:] = [task for task in _unfinished if not task.done]
    task = Task(call, progress, name)
    task.start()
    return task


def look() -> str:
    """Returns what the task is doing, for the panel to show until the next look. For the main thread."""
    state.text = state.task.text if state.task is not None else ""
    return state.text


def finish(task: Task) -> None:
    """Takes the task off the panel. A cancelled one may still need a moment to end; nobody waits for it."""
    if state.task is task:
        state.task = None
        look()


def stop_all(seconds: float = 5.0) -> None:
    """Cancels and awaits every thread: native code must not outlive the interpreter."""
    for task in _unfinished:
        task.cancel()
    for task in _unfinished:
        task.join(seconds)
    _unfinished.clear()
    state.task = None
    look()


def note_setting(group: bpy.types.PropertyGroup, _context: bpy.types.Context) -> None:
    """Lets Auto Update see a change of a setting, which by itself changes nothing that Blender shows."""
    if state.live:
        group.id_data.update_tag()


def redraw(context: bpy.types.Context) -> None:
    """Redraws the sidebars and status bars only: a redraw of the viewport costs far more than the progress is worth."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "STATUSBAR":
                area.tag_redraw()
            elif area.type == "VIEW_3D":
                for region in area.regions:
                    if region.type == "UI":
                        region.tag_redraw()


def register() -> None:
    """Makes everything of this module known to Blender."""
    for name, prop in WINDOW_MANAGER_PROPERTIES.items():
        setattr(bpy.types.WindowManager, name, prop)
    atexit.register(stop_all)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    stop_all()
    atexit.unregister(stop_all)
    for name in WINDOW_MANAGER_PROPERTIES:
        delattr(bpy.types.WindowManager, name)
