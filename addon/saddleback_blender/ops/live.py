# SPDX-License-Identifier: GPL-3.0-or-later
"""Auto Update: what was made in a layer follows what it was made from, by the phases of the operators' own runs.

A handler marks what changed; a timer takes `step`s on the main thread, and only there anything of Blender is touched:
it reads, starts a thread that computes, shows what that has, and writes. A run that is out of date is stopped and begun
again, but not before it has shown something, so that cells are seen to follow a brush that never rests.
"""

from __future__ import annotations

import time
from contextlib import nullcontext
from typing import Any

import bpy
import numpy as np
from bpy.app.handlers import persistent
from numpy.typing import NDArray

from .. import compat, jobs, rollback
from ..bridge.inputs.mesh_in import level_place, scale_of
from ..bridge.outputs.live_preview import LivePreview
from ..bridge.outputs.out_collection import hair
from ..bridge.outputs.standing import follow_again, let_stand, may_move
from ..core.flowing_cells import FlowingCells
from ..props import TOLD, existing_group
from ..props.layers import active_layer
from .live_inputs import goes_along, inputs_of, is_child, name_of_input
from .quiet import KINDS, quiet

STEP = 0.02  # seconds between two steps while something is to be done
HAS_WINDOW = not bpy.app.background
WAIT = 0.2  # the same while nothing may be done
REST = 0.3  # seconds without a change before a result is written: what is under way, as a stroke, ends first
WAITS = {
    "EDIT": "waits until Edit Mode is left",
    "RENDER": "waits until the render is done",
    "RUN": "waits until the other run is done",
    "PLAY": "waits until the animation stops",
}
MADE_NOTHING = "nothing was made in this layer yet: press a button that makes something"


class Watched:
    """One object whose active layer is kept up to date."""

    def __init__(self, source: bpy.types.Object) -> None:
        self.name = source.name
        self.layer = source.saddleback.layer_word
        self.cells = FlowingCells()
        self.seen: dict[str, str] = {}  # by kind of run: the content of the request that was made last
        self.inputs: set[tuple[str, str]] = set()  # data-blocks that are read
        self.scale = b""  # of the object, where it is all that is read of its place
        self.places: NDArray[np.float32] | None = None  # (V, 3) of its vertices, while what follows it stands
        self.is_changed = False
        self.is_refused = False  # could not be read, as while it is hidden
        self.is_accepted = False  # what was made belongs to what it is made from, whatever that is by now


class Live:
    """Holds what is watched, and the one run that goes on."""

    def __init__(self) -> None:
        self.watched: dict[int, Watched] = {}
        self.operator: Any = None  # the run's, and what it is for
        self.target: Watched | None = None
        self.preview: LivePreview | None = None
        self.has_shown = False
        self.is_writing = False
        self.changed_at = self.read_until = 0.0
        self.has_news = False  # objects may have come or gone
        self.is_told = False  # by Blender of a change, right now

    def stop(self) -> None:
        """Cancels the run, without waiting; nothing of it is in the file."""
        if self.operator is not None:
            self.operator.task.cancel()
        if self.preview is not None:
            self.preview.remove()
        jobs.state.live_running = None
        self.operator = self.target = self.preview = None

    def forget(self) -> None:
        """Begins anew, as with another file."""
        self.stop()
        self.watched.clear()
        follow_again()
        jobs.state.live.clear()
        jobs.state.live_ended = ""


live = Live()


def step(context: bpy.types.Context) -> float | None:
    """Does what is next; returns the seconds until the next step, None where there is nothing to be done."""
    _accept_others()
    if live.has_news or any(_is_lost(key, watched) for key, watched in live.watched.items()):
        _look_around(context)
    reason = _waits_for(context)
    if reason == "RUN" and live.target is not None:
        live.target.is_changed = True
        live.stop()
    if live.operator is not None:
        _go_on(context, reason)
    open_ones = [watched for watched in live.watched.values() if watched.is_changed or watched is live.target]
    if not open_ones:
        return None
    if reason:
        for watched in open_ones:
            _tell(context, watched, WAITS[reason])
        return WAIT
    if live.operator is None and time.perf_counter() >= live.read_until:
        _begin(context, open_ones[0])
    return STEP


def _tell(context: bpy.types.Context, watched: Watched, text: str, percent: int | None = None) -> None:
    """Lets the panel say what is going on: a sentence, or how far a run is."""
    running = None if percent is None else (watched.name, percent)
    if (jobs.state.live.get(watched.name, ""), jobs.state.live_running) != (text, running):
        jobs.state.live[watched.name], jobs.state.live_running = text, running
        jobs.redraw(context)


def _is_lost(key: int, watched: Watched) -> bool:
    item = bpy.data.objects.get(watched.name)
    return item is None or _key(item) != key


def _look_around(context: bpy.types.Context) -> None:
    """Finds the objects that are to be watched, and those that are there no longer."""
    live.has_news = False
    found: dict[int, bpy.types.Object] = {}
    for item in context.view_layer.objects:
        if item.type == "MESH" and item.library is None and item.is_property_set("saddleback"):
            layer = active_layer(item)
            if layer is not None and layer.auto_update and not layer.is_frozen:
                found[_key(item)] = item
    for key in live.watched.keys() - found.keys():
        lost = live.watched.pop(key)
        twin = next((new for new, item in found.items() if item.name == lost.name), None)
        if twin is None or twin in live.watched:
            _end_watching(lost)
        else:  # the same one after Undo
            live.watched[twin] = lost
    for key, item in found.items():
        watched = live.watched.get(key)
        if watched is None or watched.layer != item.saddleback.layer_word:
            watched = live.watched[key] = Watched(item)
            watched.inputs, watched.is_changed = inputs_of(item), True
            watched.is_accepted = item.name not in jobs.state.live_asked
            jobs.state.live_asked.discard(item.name)
            jobs.state.live.setdefault(item.name, "")
        elif watched.name != item.name:
            if live.target is watched:  # the run knows it by its name
                live.stop()
                watched.is_changed = True
            jobs.state.live[item.name] = jobs.state.live.pop(watched.name, "")
            watched.name, watched.inputs = item.name, inputs_of(item)
    _check_standing()


def _let_stand(watched: Watched) -> None:
    """Lets what follows an object stand while the object is only painted. Scripts are to see at once what follows."""
    source = bpy.data.objects[watched.name]
    if HAS_WINDOW and not may_move(source):
        watched.places = compat.read_positions(source.data)
        let_stand(source, watched.places)


def _stands(watched: Watched) -> bool:
    """Tells whether the object's vertices are where they were when what follows it was let stand."""
    source = bpy.data.objects.get(watched.name)
    if watched.places is None or source is None or may_move(source):
        return False
    return np.array_equal(compat.read_positions(source.data), watched.places)


def _check_standing() -> None:
    """Lets follow again what belongs to an object that may move, or is no longer watched."""
    for watched in live.watched.values():
        watched.places = watched.places if _stands(watched) else None
    still = {watched.name for watched in live.watched.values() if watched.places is not None}
    follow_again(lambda host: host.name not in still)


def _key(item: bpy.types.ID) -> int:
    """What stays while an object is renamed."""
    return compat.identity(item) or int(item.as_pointer())


def _end_watching(watched: Watched) -> None:
    if live.target is watched:
        live.stop()
    jobs.state.live.pop(watched.name, None)
    if bpy.data.objects.get(watched.name) is None:
        jobs.state.live_ended = f"'{watched.name}' is gone, and with it its Auto Update; nothing else was changed"


def _accept_others() -> None:
    """Takes what a button, a script or Adjust Last Operation has written for what belongs to what is there."""
    _accept([watched for watched in live.watched.values() if watched.name in jobs.state.written])
    jobs.state.written.clear()


def _accept(every: list[Watched]) -> None:
    for watched in every:
        if watched is live.target:
            live.stop()
        watched.is_changed = watched.is_accepted = True


def _waits_for(context: bpy.types.Context) -> str:
    """Says why nothing may be read or written now; "" where nothing is in the way."""
    if context.mode.startswith("EDIT"):
        return "EDIT"
    if bpy.app.is_job_running("RENDER") or bpy.app.is_job_running("OBJECT_BAKE"):
        return "RENDER"
    if jobs.state.task is not None:
        return "RUN"
    windows = context.window_manager.windows
    return "PLAY" if any(window.screen.is_animation_playing for window in windows) else ""


def _go_on(context: bpy.types.Context, reason: str) -> None:
    """Shows what the run has, begins it again where it is out of date, and writes its result."""
    target, operator = live.target, live.operator
    assert target is not None
    _show(context, target)
    task = operator.task
    may_read = target.is_changed and not reason and time.perf_counter() >= live.read_until
    if may_read and not _is_current(context, target, operator):
        return
    if not task.done:
        _tell(context, target, "", int(100 * task.progress.fraction))
    elif not reason and time.perf_counter() - live.changed_at >= REST and not _is_stroking(context):
        _write(context, target, operator)


def _show(context: bpy.types.Context, target: Watched) -> None:
    lines = target.cells.newest()
    source = bpy.data.objects.get(target.name)
    if lines is None or source is None:
        return
    if live.preview is None:
        live.preview = LivePreview(level_place(source), hair(source))
    live.preview.show(lines.lines)
    live.has_shown = True


def _is_current(context: bpy.types.Context, target: Watched, operator: Any) -> bool:
    """Tells whether the run still is what would be begun now; else stops it, once it has shown something."""
    kind = operator.settings_name
    newer, call = _read(context, target, kind)
    if call is not None and newer.content == operator.content:
        target.is_changed = False
        return True
    shows = kind == "tessellate" and newer.shape == operator.shape
    if call is not None and shows and not live.has_shown and not operator.task.done:
        return True
    preview, live.preview = live.preview, None  # which stays until there is another
    live.stop()
    live.preview = preview
    if call is not None:
        _start(target, newer, call)
    else:
        _drop_preview()
        _tell(context, target, " ".join(newer.errors))
        target.is_changed = False
    return False


def _read(context: bpy.types.Context, target: Watched, kind: str) -> tuple[Any, Any]:
    """Reads what a run of this kind needs."""
    began = time.perf_counter()
    operator = quiet(kind)
    operator.is_evaluated = live.is_told
    if kind == "tessellate":
        operator.flowing = target.cells
    source = bpy.data.objects[target.name]
    with context.temp_override(object=source, active_object=source):
        call = operator.read(bpy.context)
    target.inputs = inputs_of(source)
    target.scale = scale_of(source).tobytes() if goes_along(source, target.inputs) else b""
    # As long again belongs to the window.
    live.read_until = 2.0 * time.perf_counter() - began
    return operator, call


def _kinds(target: Watched) -> list[str]:
    """What was made in the layer, in the order in which one reads what another wrote."""
    source = bpy.data.objects[target.name]
    groups = {kind: existing_group(source, kind) for kind in KINDS}
    return [kind for kind, group in groups.items() if group is not None and getattr(group, TOLD)]


def _begin(context: bpy.types.Context, target: Watched) -> None:
    """Begins the first run whose request is another than before; accepts all where that was asked for."""
    kinds = _kinds(target)
    jobs.state.live_ended = ""
    text = "" if kinds else MADE_NOTHING
    for kind in kinds:
        operator, call = _read(context, target, kind)
        if call is None:
            text = " ".join(operator.errors)
        elif target.is_accepted or target.seen.get(kind) == operator.content:
            target.seen[kind] = operator.content
        else:
            _start(target, operator, call)
            return
    target.is_changed = target.is_accepted = False
    target.is_refused = bool(kinds and text)
    _let_stand(target)
    _tell(context, target, text)


def _start(target: Watched, operator: Any, call: Any) -> None:
    operator.start(call)
    live.operator, live.target, live.has_shown = operator, target, False
    target.is_changed = False
    target.seen.pop(operator.settings_name, None)


def _write(context: bpy.types.Context, target: Watched, operator: Any) -> None:
    """Writes the result, as one step of Undo: where data-blocks come and go between two steps, Undo is not safe."""
    source = bpy.data.objects[target.name]
    live.is_writing = True
    try:
        with context.temp_override(object=source, active_object=source):
            is_written = operator.finish(bpy.context)
        _let_stand(target)
        context.view_layer.update()
        if is_written and not bpy.app.background:
            bpy.ops.ed.undo_push(message=f"Auto Update {operator.bl_label}")
    finally:
        live.is_writing = False
        jobs.state.written.discard(source.name)
    # What was refused is not tried again before a change.
    target.seen[operator.settings_name] = operator.content
    target.is_changed |= len(_kinds(target)) > 1  # others may read what this one wrote
    _drop_preview()
    live.operator = live.target = None
    _tell(context, target, operator.errors[-1] if operator.errors else "")


def _drop_preview() -> None:
    if live.preview is not None:
        live.preview.remove()
        live.preview = None


def _is_stroking(context: bpy.types.Context) -> bool:
    return any(compat.strokes_going_on(window) for window in context.window_manager.windows)


def tick() -> float | None:
    """Blender's timer: a step, as seen from a window, where there is one."""
    windows = bpy.context.window_manager.windows
    try:
        with bpy.context.temp_override(window=windows[0]) if windows else nullcontext():
            return step(bpy.context)
    except Exception:
        live.stop()
        for watched in live.watched.values():
            watched.is_changed = False
            jobs.state.live[watched.name] = "stopped by a fault of Saddleback's own; the console tells more"
        raise


def wake() -> None:
    """Lets steps be taken again."""
    if not bpy.app.timers.is_registered(tick):
        bpy.app.timers.register(tick, first_interval=0.0, persistent=True)


def _is_only_moved(update: bpy.types.DepsgraphUpdate, scales: dict[str, bytes]) -> bool:
    """Tells whether an object is only moved or turned of which that changes nothing that is made."""
    item = update.id.original
    if not isinstance(item, bpy.types.Object) or update.is_updated_geometry or update.is_updated_shading:
        return False
    return item.name in scales and scale_of(item).tobytes() == scales[item.name]


@persistent  # type: ignore[untyped-decorator]
def mark(_scene: Any, depsgraph: bpy.types.Depsgraph) -> None:
    """Notes which objects' inputs were changed. After each change in Blender, so that it has to be quick."""
    live.has_news = True
    if live.is_writing or live.is_told or depsgraph.mode == "RENDER" or not (live.watched or jobs.state.live_asked):
        return
    kept = {watched.name: watched.scale for watched in live.watched.values() if watched.scale}
    touched = {name_of_input(update.id.original) for update in depsgraph.updates}
    if not all(_stands(item) for item in live.watched.values() if item.places is not None and touched & item.inputs):
        _check_standing()
    changed = [update.id.original for update in depsgraph.updates if not _is_only_moved(update, kept)]
    names, keys = {name_of_input(block) for block in changed}, {_key(block) for block in changed}
    found = [
        watched
        for key, watched in live.watched.items()
        if key in keys
        or names & watched.inputs
        or any(is_child(block, watched.name) for block in changed)
        or (watched.is_refused and depsgraph.id_type_updated("SCENE"))  # of what is shown no other update tells
    ]
    for watched in found:
        watched.is_changed = True
    if found or jobs.state.live_asked:
        live.changed_at = time.perf_counter()
        wake()
    if len(found) == 1 and HAS_WINDOW and _may_begin_now(found[0]):
        live.is_told = True
        try:
            tick()
        finally:
            live.is_told = False


def _may_begin_now(watched: Watched) -> bool:
    """Tells whether a run may begin before the window is drawn, while Blender tells of a change.

    What is read must be the object's own and be there: nothing may be evaluated now.
    """
    is_own = watched.scale and watched.places is not None
    is_free = live.operator is None and jobs.state.task is None and not rollback.is_writing()
    return bool(is_own and is_free and not watched.is_accepted)


@persistent  # type: ignore[untyped-decorator]
def accept(*_: Any) -> None:
    """After Undo and Redo, and in a file that was opened, what was made is what belongs to it."""
    live.stop()
    _accept(list(live.watched.values()))
    _check_standing()
    live.has_news = True
    wake()


@persistent  # type: ignore[untyped-decorator]
def leave(*_: Any) -> None:
    """Another file is opened."""
    live.forget()


@persistent  # type: ignore[untyped-decorator]
def check(*_: Any) -> None:
    """Other scripts move vertices from frame to frame, of which no update tells."""
    if not all(_stands(watched) for watched in live.watched.values() if watched.places is not None):
        _check_standing()


@persistent  # type: ignore[untyped-decorator]
def follow(*_: Any) -> None:
    """Files and renders get what follows as it is without us."""
    for watched in live.watched.values():
        watched.places, watched.is_changed = None, True
    follow_again()
    wake()


@persistent  # type: ignore[untyped-decorator]
def mark_strokes(*_: Any) -> None:
    """An annotation was drawn, which is no object."""
    for watched in live.watched.values():
        watched.is_changed = True
    live.changed_at = time.perf_counter()
    wake()


HANDLERS = {
    "depsgraph_update_post": mark,
    "undo_post": accept,
    "redo_post": accept,
    "load_pre": leave,
    "load_post": accept,
    "annotation_post": mark_strokes,
    "frame_change_post": check,
    "save_pre": follow,
    "render_init": follow,
}


def register() -> None:
    """Makes everything of this module known to Blender."""
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)
    live.has_news = True  # in a file that is open already
    wake()


def unregister() -> None:
    """Takes it back, in the opposite order."""
    live.forget()
    if bpy.app.timers.is_registered(tick):
        bpy.app.timers.unregister(tick)
    for name, handler in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
