# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects made for tests, and what is read back from them."""

import time

import bpy
import numpy as np

from saddleback_blender import compat, nodes


def dealt(*cases):
    """Cases that take long and differ by Blender in nothing but how the mesh is read.

    Each of the three Blenders that `tests/run` asks takes every third one, any other takes all.
    """
    first = {(3, 4): 0, (4, 5): 1, (5, 0): 2}.get(bpy.app.version[:2])
    return cases if first is None else cases[first::3]


def add_object(name, vertices, faces, active=True):
    """A mesh object in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([tuple(map(float, v)) for v in vertices], [], [tuple(map(int, f)) for f in faces])
    mesh.update(calc_edges=True)
    item = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(item)
    if active:
        bpy.context.view_layer.objects.active = item
        item.select_set(True)
    bpy.context.view_layer.update()
    return item


def grid_arrays(n=12, size=1.0):
    """A flat square of n by n quads."""
    ticks = np.linspace(0.0, size, n + 1)
    x, y = np.meshgrid(ticks, ticks)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    number = np.arange(x.size).reshape(n + 1, n + 1)
    faces = np.stack([number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]], axis=-1).reshape(-1, 4)
    return vertices, faces


def grid(name="Grid", n=12, size=1.0):
    """A flat square of n by n quads as an object."""
    return add_object(name, *grid_arrays(n, size))


def sphere(name="Sphere", subdivisions=3, radius=1.0):
    """An icosphere object."""
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=subdivisions, radius=radius)
    item = bpy.context.active_object
    item.name = item.data.name = name
    return item


def attribute(item, name):
    """(V,) values of a vertex attribute."""
    data = item.data.attributes[name].data
    values = np.empty(len(data), {"FLOAT": np.float32, "INT": np.int32}[item.data.attributes[name].data_type])
    data.foreach_get("value", values)
    return values


def positions(mesh):
    """(V, 3) places in object space."""
    values = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", values)
    return values.reshape(-1, 3)


def select(item, vertices):
    """Selects exactly these vertices."""
    chosen = np.zeros(len(item.data.vertices), bool)
    chosen[list(vertices)] = True
    # Edges are left alone: Blender 5.0 crashes in edges.foreach_set("select").
    item.data.polygons.foreach_set("select", np.zeros(len(item.data.polygons), bool))
    item.data.vertices.foreach_set("select", chosen)


def fingerprint(told=True):
    """Everything in the file that a run could touch: data-blocks, shapes, attributes, settings, links.

    Without `told` but for what runs said of their objects.
    """
    kinds = ("objects", "meshes", "curves", "collections", "node_groups", "materials")
    seen = [(kind, sorted((block.name, block.users) for block in getattr(bpy.data, kind))) for kind in kinds]
    for item in bpy.data.objects:
        settings = {name: repr(value) for name, value in _flat(item.saddleback)}
        if not told:
            settings = {name: value for name, value in settings.items() if not name.endswith((".told", ".figures"))}
        seen.append((item.name, tuple(map(tuple, item.matrix_world)), item.modifiers.keys(), sorted(settings.items())))
    for mesh in bpy.data.meshes:
        kinds = [(a.name, a.domain, a.data_type) for a in mesh.attributes]
        seen.append((mesh.name, positions(mesh).tobytes(), len(mesh.polygons), sorted(kinds)))
    return seen


def _flat(group, prefix=""):
    for name in sorted(set(group.bl_rna.properties.keys())):
        if name in ("rna_type", "name"):
            continue
        value = getattr(group, name)
        if isinstance(value, bpy.types.PropertyGroup):
            yield from _flat(value, prefix + name + ".")
        else:
            yield prefix + name, value


def tube_radius(item):
    """The radius of the tubes that show an output's lines."""
    for kind in (nodes.TUBES, nodes.CURVE_TUBES):
        modifier = nodes.modifier_of(item, kind)
        if modifier is not None:
            return compat.modifier_input(modifier, "Radius")
    return 0.0


def steps(until=lambda: False, seconds=60.0):
    """Takes the steps of Auto Update until there is nothing to be done, or until something is so.

    Without a window there are no timers that would.
    """
    from saddleback_blender import jobs
    from saddleback_blender.ops import live

    bpy.context.view_layer.update()  # which tells the handler of changes
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        pause = live.step(bpy.context)
        if pause is None or until():
            return
        time.sleep(pause)
    raise AssertionError(f"nothing came of it: {jobs.state.live}")


def begin():
    """Takes steps until a run of Auto Update goes on."""
    from saddleback_blender.ops import live

    steps(lambda: live.live.operator is not None)
    assert live.live.operator is not None


def switch_on(item):
    """Auto Update of the active layer."""
    layer = item.saddleback.layers[item.saddleback.layer_index]
    assert not layer.auto_update  # off by default
    layer.auto_update = True
    item.update_tag()  # as a click does
    steps()


def paint(item, around=(1.0, 0.0, 0.0), reach=0.4):
    """A dab, as a brush leaves it."""
    near = np.flatnonzero(np.linalg.norm(positions(item.data) - around, axis=1) < reach)
    item.vertex_groups["paint"].add(near.tolist(), 1.0, "REPLACE")
    item.data.update_tag()
    return near
