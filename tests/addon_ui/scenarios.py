# SPDX-License-Identifier: GPL-3.0-or-later
"""What a person does in the tab, and what is seen; played by driver.py inside Blender."""

import threading
import time
from functools import partial

import bpy
import numpy as np
from hands import FRAME, wait_until
from mathutils import Vector
from scenes import add_object, fingerprint

from tests import synthetic_cells

CELL = "saddleback_cell"
# How often the panels were drawn, and what was being done then.
drawn = {"main": 0, "running": 0, "fractions": []}


def prepare():
    """The add-on enabled, and a mesh large enough for a run to be watched."""
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    from saddleback_blender.core import native
    from saddleback_blender.ui import panels

    native.load()  # without it every scenario would only find that it is missing
    panels.SADDLEBACK_PT_main.append(_count_draw)
    for item in list(bpy.data.objects):
        bpy.data.objects.remove(item)
    ball = add_object("Ball", *synthetic_cells.sphere(6))
    ball.saddleback.tessellate.count = 150
    ball.saddleback.tessellate.iterations = 5
    bpy.ops.ed.undo_push(message="Ready")


def _count_draw(_panel, context):
    manager = context.window_manager
    drawn["main"] += 1
    if manager.saddleback_running:
        drawn["running"] += 1
        drawn["fractions"].append(round(manager.saddleback_fraction, 4))


def in_order(screen):
    """The scenarios; later ones go on where earlier ones ended."""
    made = (opened, repaired, tessellated, undone, adjusted, escaped, divided, combed, clothed, dressed, layered)
    made = (*made, followed, applied)
    plays = (*made, refused)
    return {play.__name__: (lambda play=play: play(screen)) for play in plays}


def manager():
    return bpy.context.window_manager


def ball():
    return bpy.data.objects["Ball"]  # fetched anew each time: undo ends the life of every reference


def outputs():
    return sorted(item.name for item in bpy.data.objects if item.parent == ball())


def opened(screen):
    """The tab is there and its panels draw."""
    for x in (300, 500):  # the first drag after the start gets lost
        yield from screen.click(x, 500)
    ball().select_set(True)
    bpy.context.view_layer.objects.active = ball()
    yield from screen.open_tab(lambda: drawn["main"] > 0)
    yield from screen.shoot("tab")
    return {"drawn": drawn["main"]}


def escaped(screen):
    """A run is stopped by ESC, early and late, and nothing has changed."""
    from saddleback_blender import jobs
    from saddleback_blender.core import cache

    cache.shared.clear()
    bpy.context.view_layer.objects.active = ball()
    screen.redraw()
    yield 12 * FRAME
    settings = ball().saddleback.tessellate
    settings.seed, settings.count, settings.iterations = 1, 1500, 400  # runs for longer than any of the waits
    place = yield from screen.find_button("bpy.ops.saddleback.tessellate")
    before = fingerprint()
    seconds = []
    for wait in (0.0, 0.3, 1.0):
        yield from screen.click_until(place, lambda: manager().saddleback_running)
        yield wait
        if not manager().saddleback_running:
            break
        # Threads that look on: this generator gets its turn only after Blender has drawn, which takes long in software.
        ends = []
        watchers = [threading.Thread(target=_watch, args=(is_over, ends)) for is_over in _endings(jobs.state.task)]
        for watcher in watchers:
            watcher.start()
        # From where the operator hears of it: in software the window's drawing may hold the event up before.
        began = _when_cancelled(jobs.state.task)
        screen.press("ESC")
        yield from wait_until(lambda: len(ends) == 2, "the run to stop", 20)  # noqa: B023 - asked in this turn
        seconds.append(max(ends) - began[0])
        yield 4 * FRAME
    return {"seconds": seconds, "same": fingerprint() == before}


def _endings(task):
    """A run is over when the operator no longer watches it and when its thread has ended."""
    from saddleback_blender import jobs

    return (lambda: jobs.state.task is not task, lambda: task.done)


def _when_cancelled(task):
    """A list that gets the time at which the task is told to stop."""
    times, cancel = [], task.cancel

    def watched():
        times.append(time.perf_counter())
        cancel()

    task.cancel = watched
    return times


def _watch(is_over, ends):
    while not is_over():
        time.sleep(0.002)
    ends.append(time.perf_counter())


def tessellated(screen):
    """The button starts a run that is seen to go on, and makes what was asked for."""
    drawn.update(running=0, fractions=[])
    bpy.context.view_layer.objects.active = ball()
    with screen.override():
        bpy.ops.ed.undo_push(message="Ball again")
    screen.redraw()
    yield 12 * FRAME
    place = yield from screen.find_button("bpy.ops.saddleback.tessellate")
    yield from screen.click_until(place, lambda: manager().saddleback_running)
    yield from wait_until(lambda: drawn["running"] > 2, "the progress to be drawn", 20)
    yield from screen.shoot("running")
    yield from wait_until(lambda: not manager().saddleback_running, "the run to end")
    yield 4 * FRAME
    yield from screen.shoot("done")
    values = np.empty(len(ball().data.vertices), np.int32)
    if CELL in ball().data.attributes:
        ball().data.attributes[CELL].data.foreach_get("value", values)
    return {
        "running": drawn["running"],
        "fractions": list(drawn["fractions"]),
        "cells": len(np.unique(values)),
        "outputs": outputs(),
        "line": manager().saddleback_line,
    }


def adjusted(screen):
    """Adjust Last Operation changes the outputs without computing the graph again."""
    from saddleback_blender.core import cache

    def tube_vertices():
        item = bpy.data.objects["Ball Edges"]
        mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        co = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", co)
        return float(np.linalg.norm(co.reshape(-1, 3), axis=1).max())

    place = yield from screen.find_button("bpy.ops.saddleback.tessellate")
    yield from screen.click_until(place, lambda: len(manager().operators) > 0)
    yield from wait_until(lambda: not manager().saddleback_running, "the run from the cache to end")
    builds, radius = dict(cache.shared.builds), tube_vertices()
    operator = manager().operators[-1]
    operator.properties.lengths, operator.properties.edge_radius = "ABSOLUTE", 0.05
    operator.properties.make_cells = True
    began = time.perf_counter()
    with screen.override():
        bpy.ops.ed.undo_redo()  # what the panel Adjust Last Operation calls when a value in it changes
    seconds = time.perf_counter() - began
    yield 4 * FRAME
    yield from screen.shoot("adjusted")
    return {
        "operator": operator.bl_idname,
        "wider": tube_vertices() - radius,
        "outputs": outputs(),
        "builds": [builds, dict(cache.shared.builds)],
        "seconds": seconds,
    }


def undone(screen):
    """One step of undo takes everything back, and redo brings it again."""
    screen.move(screen.view.x + 200, screen.view.y + 300)
    yield FRAME
    screen.press("Z", ctrl=True)
    yield 6 * FRAME
    after_undo = [outputs(), CELL in ball().data.attributes]
    screen.press("Z", ctrl=True, shift=True)
    yield 6 * FRAME
    return {"undo": after_undo, "redo": [outputs(), CELL in ball().data.attributes]}


def applied(screen):
    """Scale is applied, the edges are made again, and that is undone: nothing jumps, nor after the Redo of Apply."""

    def middle():
        item = bpy.data.objects["Moved Edges"]
        mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        return list(sum((item.matrix_world @ v.co for v in mesh.vertices), Vector()) / len(mesh.vertices))

    with screen.override():
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, location=(5.0, 3.0, 1.0), rotation=(1.0, 0.5, 0.0))
        bpy.context.active_object.name = "Moved"
        bpy.context.active_object.scale = (1.0, 2.0, 1.0)
        bpy.context.view_layer.update()
        bpy.ops.saddleback.tessellate("EXEC_DEFAULT", True, count=40)
    yield 2 * FRAME
    found = [middle()]

    def call(operator, *arguments, **settings):
        with screen.override():
            bpy.context.view_layer.objects.active = bpy.data.objects["Moved"]
            operator(*arguments, **settings)

    steps = (
        partial(call, bpy.ops.object.transform_apply, "EXEC_DEFAULT", True),
        partial(call, bpy.ops.saddleback.tessellate, "EXEC_DEFAULT", True, count=40, seed=2),
        partial(call, bpy.ops.ed.undo),
        partial(call, bpy.ops.ed.undo),
        partial(call, bpy.ops.ed.redo),
    )
    for step in steps:
        step()
        yield 2 * FRAME
        found.append(middle())
    call(bpy.ops.ed.undo)
    with screen.override():
        bpy.data.batch_remove([item for item in bpy.data.objects if item.name.startswith("Moved")])
        bpy.context.view_layer.objects.active = ball()
    yield 2 * FRAME
    return found


def repaired(screen):
    """A mesh with faults is refused; the panel offers the repair; one click, and it is accepted."""
    vertices, triangles = synthetic_cells.sphere(3)
    fin = np.concatenate([triangles, [[0, 1, len(vertices)]]])  # a face on a third vertex of its own ...
    faces = np.concatenate([fin, np.roll(triangles[:1], 1, axis=1)])  # ... and one face twice
    add_object("Faulty", np.concatenate([vertices, [[0.0, 0.0, 3.0]]]), faces)
    with screen.override():
        bpy.ops.ed.undo_push(message="Faulty")
    screen.redraw()
    yield 12 * FRAME
    place = yield from screen.find_button("bpy.ops.saddleback.tessellate")
    yield from screen.click_until(place, lambda: manager().saddleback_needs_repair == "Faulty")
    yield from leave_popup(screen)
    yield from screen.shoot("refused")
    place = yield from screen.find_button("bpy.ops.saddleback.repair")
    yield from screen.click_until(place, lambda: not manager().saddleback_needs_repair)
    yield from wait_until(lambda: not manager().saddleback_running, "the repair to end")
    yield from screen.shoot("repaired")
    place = yield from screen.find_button("bpy.ops.saddleback.tessellate")
    yield from screen.click_until(place, lambda: CELL in bpy.data.objects["Faulty"].data.attributes)
    return {"line": manager().saddleback_line}


def divided(screen):
    """The panels of plane diagrams draw every choice, and a run goes through the window."""
    ticks = np.linspace(-1.0, 1.0, 5)
    places = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    quads = [(r * 5 + c, r * 5 + c + 1, r * 5 + c + 6, r * 5 + c + 5) for r in range(4) for c in range(4)]
    sheet = add_object("Sheet", np.column_stack([places, np.zeros(25)]), quads)
    settings = sheet.saddleback.voronoi_2d
    settings.animate = settings.make_centers = True
    choices = [("UV", "IMAGE"), ("DISK", "SELECTED"), ("OUTLINE", "OBJECT"), ("OUTLINE", "COUNT")]
    for settings.space, settings.sites_source in choices:
        for panel in ("voronoi_2d", "plane_edges", "plane_cells", "plane_centers", "sweep"):
            with screen.override():
                bpy.ops.wm.call_panel(name=f"SADDLEBACK_PT_{panel}", keep_open=False)
            yield 4 * FRAME
            if panel == "voronoi_2d":
                yield from screen.shoot(f"plane-{settings.sites_source}")
            yield from leave_popup(screen)
    with screen.override():
        bpy.ops.saddleback.voronoi_2d("INVOKE_DEFAULT")
    yield from wait_until(lambda: not manager().saddleback_running, "the diagram to be made")
    yield 4 * FRAME
    yield from screen.shoot("divided")
    sheet = bpy.data.objects["Sheet"]
    made = sorted(item["saddleback_role"] for item in bpy.data.objects if item.parent == sheet)
    return {"line": manager().saddleback_line, "roles": made}


def combed(screen):
    """The panels of direction fields draw every choice, and a run goes through the window, strokes and all."""
    bpy.context.view_layer.objects.active = ball()
    curve = bpy.data.curves.new("Stroke", "CURVE")
    curve.dimensions = "3D"
    points = curve.splines.new("POLY").points
    points.add(1)
    points[0].co, points[1].co = (0, -1, 0, 1), (0.8, -0.6, 0, 1)
    stroke = bpy.data.objects.new("Stroke", curve)
    bpy.context.scene.collection.objects.link(stroke)
    stroke.parent = ball()
    settings = ball().saddleback.direction_field
    settings.make_streamlines, settings.singularities = True, "EMPTIES"
    choices = [("1", "NONE", "NONE"), ("2", "CURVATURE", "OBJECT"), ("4", "BOUNDARY", "COLLECTION")]
    for settings.symmetry, settings.align, settings.strokes in choices:
        yield from show_panels(screen, ("direction_field", "arrows", "streamlines"))
    settings.singularities, settings.align = "AUTO", "NONE"
    with screen.override():
        bpy.ops.saddleback.direction_field("INVOKE_DEFAULT")
    yield from wait_until(lambda: not manager().saddleback_running, "the field to be made")
    yield 4 * FRAME
    yield from screen.shoot("combed")
    return {"line": manager().saddleback_line, "outputs": outputs()}


def clothed(screen):
    """The panels of shapes draw every choice, and a run goes through the window."""
    settings = ball().saddleback.distribute
    settings.make_outlines = settings.make_instances = True
    sources = ("UNIFORM", "IMAGE", "DISTANCE", "SPREAD")
    for settings.shapes, settings.density_source in zip(
        ("SCALES", "COLLECTION", "IMAGE", "MOSAIC"), sources, strict=True
    ):
        settings.field_source = "ATTRIBUTE" if settings.shapes == "IMAGE" else "PANEL"
        yield from show_panels(screen, ("distribute", "shape_density", "shape_outputs"))
    settings.density_source, settings.count, settings.packing = "UNIFORM", 100, 0.0
    with screen.override():
        bpy.ops.saddleback.distribute("INVOKE_DEFAULT")
    yield from wait_until(lambda: not manager().saddleback_running, "the shapes to be laid")
    yield 4 * FRAME
    yield from screen.shoot("clothed")
    return {"line": manager().saddleback_line, "outputs": outputs()}


def dressed(screen):
    """One click on a look makes it, in a run that can be watched; the button stays where it was."""
    with screen.override():
        doll = add_object("Doll", *synthetic_cells.sphere(3))
        bpy.ops.ed.undo_push(message="Doll")
    screen.redraw()
    yield 12 * FRAME
    look = "bpy.ops.saddleback.apply_look(look='PANELS')"
    place = yield from screen.find_button(look)
    yield from screen.shoot("looks")
    yield from screen.click_until(place, lambda: manager().saddleback_running or doll.children)
    yield from wait_until(lambda: not manager().saddleback_running, "the look to be made")
    yield 4 * FRAME
    yield from screen.shoot("dressed")
    again = yield from screen.find_button(look)
    doll = bpy.data.objects["Doll"]
    made = {item["saddleback_role"]: item.data.materials[0].name for item in doll.children}
    return {"made": made, "look": doll.saddleback.tessellate.look, "places": [place, again]}


def layered(screen):
    """A second pattern on the same object; the first is hidden, and Undo takes all of the second back."""
    command = "bpy.ops.saddleback.layer_add()"
    doll = bpy.data.objects["Doll"]
    place = yield from screen.find_button(command)
    yield from screen.click_until(place, lambda: len(bpy.data.objects["Doll"].saddleback.layers) == 2)
    place = yield from screen.find_button("bpy.ops.saddleback.apply_look(look='SCALES')")
    yield from screen.click_until(place, lambda: manager().saddleback_running or len(doll.children) == 2)
    yield from wait_until(lambda: not manager().saddleback_running, "the scales to be made")
    yield 4 * FRAME
    doll = bpy.data.objects["Doll"]
    names = [layer.name for layer in doll.saddleback.layers]
    made = {item["saddleback_role"]: item.get("saddleback_layer", "") != "" for item in doll.children}
    doll.saddleback.layers[0].show_viewport = False
    screen.redraw()
    yield 4 * FRAME
    yield from screen.shoot("layered")
    hidden = [item["saddleback_role"] for item in doll.children if item.hide_viewport]
    doll.saddleback.layers[0].show_viewport = True
    return {"names": names, "made": made, "hidden": hidden}


def followed(screen):
    """A dab of a brush, and the cells follow while the window stays awake; one step of Undo takes that back."""
    from saddleback_blender.bridge.outputs import live_preview
    from saddleback_blender.ops import live

    with screen.override():
        globe = add_object("Globe", *synthetic_cells.sphere(5))
        globe.location.x = 3.0
        globe.vertex_groups.new(name="Paint").add([0], 1.0, "REPLACE")
        settings = globe.saddleback.tessellate
        settings.density_source, settings.density_name, settings.count = "VERTEX_GROUP", "Paint", 200
        bpy.ops.object.select_all(action="DESELECT")
        globe.select_set(True)
        bpy.ops.view3d.view_selected()
        bpy.ops.saddleback.tessellate("INVOKE_DEFAULT")
    yield from wait_until(lambda: not manager().saddleback_running, "the cells to be made")
    with screen.override():
        bpy.ops.object.mode_set(mode="WEIGHT_PAINT")
        bpy.context.scene.tool_settings.unified_paint_settings.size = 40
    screen.redraw()
    yield 12 * FRAME
    place = yield from screen.find_switch("auto_update")
    yield from screen.click_until(place, lambda: bpy.data.objects["Globe"].saddleback.layers[0].auto_update)
    at_rest = lambda: not bpy.app.timers.is_registered(live.tick)  # noqa: E731 - asked again and again
    yield 4 * FRAME
    yield from wait_until(at_rest, "the first update")
    seconds, previews, before = [], [], _cells_of("Globe")
    step, show = live.step, live_preview.LivePreview.show

    def timed_step(context):
        began = time.thread_time()
        try:
            return step(context)
        finally:
            seconds.append(time.thread_time() - began)

    def noted_show(preview, lines):
        previews.append(len(lines.vertices))
        show(preview, lines)

    live.step, live_preview.LivePreview.show = timed_step, noted_show
    x, y = screen.view.x + screen.view.width // 2, screen.view.y + screen.view.height // 2
    yield from screen.click(x, y)
    yield from wait_until(lambda: previews, "a preview")
    yield from screen.shoot("preview")
    yield from wait_until(at_rest, "the cells to follow")
    after = _cells_of("Globe")
    yield from screen.shoot("followed")
    live.step, live_preview.LivePreview.show = step, show
    screen.move(screen.view.x + 200, screen.view.y + 300)
    yield FRAME
    screen.press("Z", ctrl=True)
    yield 6 * FRAME
    yield from wait_until(at_rest, "Undo to be taken as it is")
    undone = _cells_of("Globe")
    with screen.override():
        bpy.ops.object.mode_set(mode="OBJECT")
    return {
        "seconds": max(seconds),
        "previews": len(previews),
        "changed": int((after != before).sum()),
        "undone": bool((undone == before).all()),
    }


def _cells_of(name):
    values = np.empty(len(bpy.data.objects[name].data.vertices), np.int32)
    bpy.data.objects[name].data.attributes[CELL].data.foreach_get("value", values)
    return values


def show_panels(screen, names):
    """Each panel by itself, drawn and photographed."""
    for name in names:
        with screen.override():
            bpy.ops.wm.call_panel(name=f"SADDLEBACK_PT_{name}", keep_open=False)
        yield 4 * FRAME
        yield from screen.shoot(f"panel-{name}")
        yield from leave_popup(screen)


def refused(screen):
    """Without a mesh object the tab says what to do."""
    bpy.context.view_layer.objects.active = None
    screen.redraw()
    yield 4 * FRAME
    yield from screen.shoot("nothing")
    empty = bpy.data.objects.new("Nothing", None)
    bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.objects.active = empty
    count = drawn["main"]
    screen.redraw()
    yield 4 * FRAME
    yield from screen.shoot("empty")
    return {"drawn": drawn["main"] - count}


def leave_popup(screen):
    """An error pops up under the mouse and goes when the mouse leaves it."""
    for x, y in ((700, 400), (300, 200), (40, 300)):
        screen.move(x, y)
        yield 2 * FRAME
