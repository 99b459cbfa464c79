# SPDX-License-Identifier: GPL-3.0-or-later
"""Does what all operators that compute share: gather, run (at once for scripts, in a thread for the panel), write."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from time import perf_counter
from typing import Any

import bpy

from .. import compat, jobs, rollback
from ..blocks import find, name_of
from ..bridge.inputs.mesh_in import read_surface
from ..bridge.inputs.source import Source, active_object, usable_source, why_not
from ..bridge.outputs import hand_edits
from ..bridge.outputs.following import Follower
from ..bridge.outputs.layer_visibility import show_layer
from ..bridge.outputs.lifting import lift_lying
from ..bridge.outputs.out_collection import hide_output, outputs_of, remove_output
from ..bridge.outputs.out_looks import ROLES, remove_look, set_stage
from ..bridge.outputs.output_surface import has_own_faces
from ..bridge.outputs.solid_colors import show_colors
from ..bridge.tokens import SOURCE, layer_of
from ..core import native, runs
from ..core.errors import BadInputError
from ..core.lengths import told_lengths, world_lengths
from ..core.progress import Progress
from ..core.requests import Surface
from ..finishes import has_colors
from ..looks import LOOKS, NO_LOOK
from ..props import PROPERTIES, Settings, existing_group, fill_operator, keep_texts, note_call
from ..props.kinds import switch
from ..props.layers import check_layer, first_layer, look_of, name_after
from .redo import draw_redo

# Seconds between looks at the thread: a run's end, and a progress step, are seen this late at most. ESC is an event of
# its own and does not wait for it.
TIMER_STEP = 0.05
STOPPED = "Stopped; nothing was changed"
STOPPED_LATER = "Stopped; the objects that were done stay as they are"
# Of operators that may work on several objects.
ALL_SELECTED = {
    "all_selected": switch(
        "All Selected", "Do the same to all selected mesh objects, not only to the active one", False
    )
}


class PolledOperator:
    """Mixin: can be pressed while a mesh is active and nothing is being computed."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the button can be pressed; says why not."""
        problem = why_not(context)
        if not problem and jobs.state.task is not None:
            problem = f"{jobs.state.task.name} is being computed: wait, or press ESC"
        if problem:
            cls.poll_message_set(problem)  # type: ignore[attr-defined]  # of bpy.types.Operator
        return not problem


class SurfaceOperator(PolledOperator):
    """Mixin for operators on the active object. A subclass names its `settings` group and says how to gather and write.

    `execute` computes before it returns; `invoke` starts a thread and `modal` waits for it, so the window stays usable
    and ESC stops the run. Nothing in the file changes before the result is there.
    """

    settings_name: str  # of the group in Object.saddleback
    makes_layers = True  # or works on the object as a whole
    bl_label: str
    report: Callable[..., None]
    options: bpy.types.OperatorOptions
    properties: Any
    layout: bpy.types.UILayout
    look: str = NO_LOOK  # of the operators that make looks

    keys = "ESC: stop"  # what the status bar says of a run

    _task: jobs.Task | None = None
    _is_by_hand = False  # not by a script
    _lengths: dict[str, Any]  # in world units, those that are given as shares
    _called: tuple[str, ...]  # names of settings that the caller gave
    _others: list[str]  # names of selected objects that are still to be worked on
    _is_filled = False  # the active object is done, others may follow
    is_evaluated = False  # all that is read, right now
    _is_watched = False  # by a person, who can stop it
    _surface: Surface  # that the run is made on
    _follower: Follower | None = None

    def gather(self, context: bpy.types.Context, source: bpy.types.Object) -> Callable[[Progress], Any]:
        """Reads everything from Blender; returns the call that computes without it."""
        raise NotImplementedError

    def write(self, context: bpy.types.Context, source: bpy.types.Object, result: Any) -> str:
        """Writes the result into Blender; returns one line that tells it."""
        raise NotImplementedError

    def follower(self, context: bpy.types.Context, source: bpy.types.Object) -> Follower:
        """Returns what lets the outputs follow the source when it is deformed."""
        self._follower = Follower(context, source, self._surface, getattr(self, "use_modifiers", False))
        return self._follower

    def drop(self, source: bpy.types.Object, role: str) -> None:
        """An output that is not wanted: a person may want it again, and finds it as it was; a script gets no rest."""
        if self._is_by_hand and "look" not in self._called:
            hide_output(source, role)
        else:
            remove_output(source, role)

    def lying(self) -> dict[str, bool]:
        """Tells of outputs by their roles whether they would lie on the surface itself."""
        return {}

    def notes(self, result: Any) -> list[str]:
        """Sentences to warn with after a run."""
        return []

    def measured(self, settings: Settings, surface: Surface, count: int = 0) -> Settings:
        """The settings with all lengths in world units; `count` is the number of cells, where there are cells."""
        self._surface = surface
        self._lengths = world_lengths(settings, surface, count, compat.unit_scale(bpy.context.scene))
        return replace(settings, **self._lengths)

    def begin_watching(self, context: bpy.types.Context, source: bpy.types.Object) -> None:
        """Begins to show a run that goes on in a thread."""

    def show_newest(self) -> None:
        """Shows what is new, at every look at the thread."""

    def end_watching(self) -> None:
        """Takes away what was shown."""

    def keeps(self, context: bpy.types.Context, event: bpy.types.Event) -> bool:
        """Tells whether the event asks for what the run has so far."""
        return False

    def figures(self, result: Any) -> list[str]:
        """Lines of numbers that the panel shows after a run."""
        return []

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Computes and writes before it returns: scripts and the redo panel."""
        self._begin(context)
        answer = self._compute(context)
        while answer == {"FINISHED"} and self._others:
            with _active(context, self._others.pop(0)):
                self._compute(context)
        return answer

    def _compute(self, context: bpy.types.Context) -> set[str]:
        try:
            # The redo panel calls as a script does, with what a person has chosen.
            source, call = self._prepare(context, self._is_asked_by_hand())
            progress = runs.new_progress()
            result = call(progress)
        except Exception as error:
            return self._refuse(error, context)
        return self._succeed(context, source, result, progress)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        """Starts the run in a thread: the panel."""
        if hasattr(self, "all_selected") and not self.properties.is_property_set("all_selected"):
            self.all_selected = context.window_manager.saddleback_all_selected
        self._begin(context)
        self._is_watched = True
        return self._start(context)

    def _start(self, context: bpy.types.Context) -> set[str]:
        try:
            source, call = self._prepare(context, True)
            self._source = Source.of(context, source, getattr(self, "use_modifiers", False))
            progress = runs.new_progress()
        except Exception as error:
            return self._refuse(error, context)
        self._task = jobs.start(call, progress, source.name)
        manager = context.window_manager
        self._timer = manager.event_timer_add(TIMER_STEP, window=context.window)
        if not self._is_filled:  # else it watches already
            manager.modal_handler_add(self)
        self.begin_watching(context, source)
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Watches the run: its end, its progress, ESC."""
        task = self._task
        if task is None:
            return {"CANCELLED"}
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"INFO"}, STOPPED_LATER if self._is_filled else STOPPED)
            return {"FINISHED"} if self._is_filled else {"CANCELLED"}
        if event.type == "TIMER" and task.done:
            self._leave(context)
            return self._go_on(context, self._end(context, task))
        if event.type == "TIMER":
            self.show_newest()
            self._show(context)
        if self.keeps(context, event) and task.progress.settle():
            return {"RUNNING_MODAL"}
        # Undo would take the file from under the run; everything else (turning the view, say) goes its way.
        is_undo = event.type == "Z" and (event.ctrl or event.oskey)
        return {"RUNNING_MODAL"} if is_undo else {"PASS_THROUGH"}

    def cancel(self, context: bpy.types.Context) -> None:
        """ESC, or Blender closing the window or the file."""
        if self._task is not None:
            self._task.cancel()
            self._leave(context)

    def _begin(self, context: bpy.types.Context) -> None:
        """Notes which objects are to be worked on."""
        self._is_filled = False
        self._others = _selected(context) if getattr(self, "all_selected", False) else []

    def _go_on(self, context: bpy.types.Context, answer: set[str]) -> set[str]:
        """Begins with the next selected object, once the active one is done."""
        while self._is_filled and self._others:
            with _active(context, self._others.pop(0)):
                if self._start(context) == {"RUNNING_MODAL"}:
                    return {"RUNNING_MODAL"}
        return {"FINISHED"} if self._is_filled else answer

    def _is_asked_by_hand(self) -> bool:
        """Tells whether a person asks, not a script. A look is what a person chooses, whoever calls for it."""
        has_look = self.settings_name in ROLES and self.properties.is_property_set("look")
        return bool(self.options.is_invoke or self.options.is_repeat or has_look)

    def draw(self, _context: bpy.types.Context) -> None:
        """Draws Adjust Last Operation."""
        draw_redo(self.layout, self, self.settings_name)

    def _prepare(
        self, context: bpy.types.Context, is_by_hand: bool
    ) -> tuple[bpy.types.Object, Callable[[Progress], Any]]:
        self._began, self._is_by_hand, self._lengths = perf_counter(), is_by_hand, {}
        jobs.state.kind = self.settings_name
        source = usable_source(context, self.is_evaluated)
        if self.makes_layers:
            check_layer(source)
        self._layer = layer_of(source)
        if not self._is_filled:  # all selected objects get what the active one does
            self._called = fill_operator(self, source, self.settings_name, is_by_hand)
        native.load()
        return source, self.gather(context, source)

    def _end(self, context: bpy.types.Context, task: jobs.Task) -> set[str]:
        if isinstance(task.error, Exception):
            return self._refuse(task.error, context)
        if task.error is not None:
            raise task.error
        try:
            source = self._source.find(context)
            if self.makes_layers:
                check_layer(source)
            if layer_of(source) != self._layer:
                raise BadInputError(
                    f"'{source.name}': another layer was chosen during the run, so nothing was written: run again"
                )
        except BadInputError as error:
            return self._refuse(error, context)
        return self._succeed(context, source, task.result, task.progress)

    def _succeed(
        self, context: bpy.types.Context, source: bpy.types.Object, result: Any, progress: Progress
    ) -> set[str]:
        hand_edits.notes()  # of what was taken back
        try:
            with rollback.all_or_nothing():
                if not source.is_property_set("saddleback"):
                    rollback.undo_with(partial(source.property_unset, "saddleback"))
                if self.makes_layers:
                    name_after(source, LOOKS[self.look].label if self.look in LOOKS else self.bl_label)
                line = self.write(context, source, result)
                if self.settings_name in ROLES:
                    _settle_look(source, self.settings_name, self.look)
                if self._is_by_hand:
                    lift_lying(source, self.lying())
                note_call(source, self.settings_name, self._called, self._is_by_hand)
                labels = {name: prop.keywords["name"] for name, prop in PROPERTIES[self.settings_name].items()}
                lengths, figures = told_lengths(self, self._lengths, progress.chosen, labels), self.figures(result)
                keep_texts(source, self.settings_name, [line, *lengths], figures)
                if self.makes_layers:
                    hand_edits.stamp(outputs_of(source, self._layer))
                    show_layer(source, first_layer(source))
        except Exception as error:
            return self._refuse(error, context)
        if jobs.state.needs_repair == source.name:
            jobs.state.needs_repair = ""
        if self._is_watched and has_colors(getattr(self, "look", NO_LOOK)):
            show_colors(context.space_data)
        self._is_filled = True
        jobs.state.written.add(source.name)
        jobs.state.line = f"{line}, {perf_counter() - self._began:.1f} s"
        jobs.state.figures = [*lengths, *figures]
        followed = [] if self._follower is None else self._follower.notes()
        for note in [*progress.notes, *self.notes(result), *hand_edits.notes(), *followed, *_unseen(context, source)]:
            self.report({"WARNING"}, note)
        self.report({"INFO"}, jobs.state.line)
        return {"FINISHED"}

    def _refuse(self, error: Exception, context: bpy.types.Context) -> set[str]:
        """Tells an error that has a sentence; any other is a defect of ours and goes on as it is."""
        level = {"WARNING"} if self._is_filled else {"ERROR"}  # what was done before stays
        if isinstance(error, (BadInputError, native.NativeMissingError)):
            self.report(level, str(error))
            return {"CANCELLED"}
        sb = native.load()
        if isinstance(error, sb.Cancelled):
            self.report({"INFO"}, STOPPED)
            return {"CANCELLED"}
        if not isinstance(error, (sb.Error, MemoryError)):
            raise error
        active = active_object(context)
        name = self._task.name if self._task is not None else active.name if active is not None else ""
        text = (
            "there is not enough memory; ask for fewer or larger ones" if isinstance(error, MemoryError) else str(error)
        )
        if isinstance(error, sb.MeshError):
            text = text.removesuffix("; saddleback.repair mends this")
            source = bpy.data.objects.get(name)
            if source is not None and getattr(self, "use_modifiers", False) and _is_made_by_modifiers(context, source):
                text += (
                    "; its modifiers make this: apply them (Object > Apply > Visual Geometry to Mesh), press Repair "
                )
                text += "in the Saddleback tab, then run again"
            else:
                jobs.state.needs_repair = name
                text += "; press Repair in the Saddleback tab, then run again"
        self.report(level, f"'{name}': {text}")
        return {"CANCELLED"}

    def _show(self, context: bpy.types.Context) -> None:
        task, text = self._task, jobs.look()
        if task is not None and context.workspace is not None:
            context.workspace.status_text_set(f"Saddleback: {text} {100 * task.progress.fraction:.0f}%    {self.keys}")
            jobs.redraw(context)

    def _leave(self, context: bpy.types.Context) -> None:
        """Ends the watching: timer, status bar, panel."""
        if self._task is None:
            return
        self.end_watching()
        jobs.finish(self._task)
        if self._timer is not None:
            context.window_manager.event_timer_remove(self._timer)
            self._timer = None
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        jobs.redraw(context)
        self._task = None


def _is_made_by_modifiers(context: bpy.types.Context, source: bpy.types.Object) -> bool:
    """Tells whether a fault of what is seen is none of the object's own mesh, which Repair could mend."""
    if has_own_faces(context, source):
        return False
    try:
        own = read_surface(source, source.data, check=False)
        native.load().Mesh(own.vertices, own.triangles)
    except native.load().MeshError:
        return False
    except BadInputError:  # it has no faces, as where a Skin modifier makes them
        pass
    return True


def _selected(context: bpy.types.Context) -> list[str]:
    """Names of selected mesh objects but for the active one and what was made of objects."""
    active = active_object(context)
    chosen = [item for item in context.view_layer.objects if item.select_get(view_layer=context.view_layer)]
    others = [item for item in chosen if item.type == "MESH" and item != active and SOURCE not in item]
    return [name_of(bpy.data.objects, item) for item in others]


def _active(context: bpy.types.Context, name: str) -> Any:
    item = find(bpy.data.objects, name)
    return context.temp_override(object=item, active_object=item)


def _unseen(context: bpy.types.Context, source: bpy.types.Object) -> list[str]:
    """A sentence where outputs are there, but not in this view layer."""
    items = [item for item in outputs_of(source) if item.users_collection]
    if any(item.name not in context.view_layer.objects for item in items):
        context.view_layer.update()  # which does not know of new objects yet
    names = sorted(item.name for item in items if item.name not in context.view_layer.objects)
    if not names:
        return []
    told = " and ".join(f"'{name}'" for name in names)
    return [f"{told}: made, but not seen, since this view layer excludes the collection"]


def _settle_look(source: bpy.types.Object, settings_name: str, look: str) -> None:
    """Takes away what other operators made for the look that the object had before, and sets the stage for this one."""
    groups = {other: existing_group(source, other) for other in ROLES if other != settings_name}
    others = {other: group for other, group in groups.items() if group is not None and group.look != NO_LOOK}
    if look == NO_LOOK and others:
        return
    for other, group in others.items():
        remove_look(source, other)
        keep_texts(source, other, [], [])
        rollback.remember_setting(group, "look")
        group.look = NO_LOOK
    set_stage(source, look_of(source))
