# SPDX-License-Identifier: GPL-3.0-or-later
"""Patterns that are the same to both sides of an object's X."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from scenes import add_object, attribute, fingerprint, positions

from saddleback_blender.core.surfaces.mirrors import partners

FLIP = np.array([-1, 1, 1], np.float32)
PLACES = {
    "origin": Matrix.Identity(4),
    "turned": Matrix.Translation((3.3, -2.1, 0.7))
    @ Matrix.Rotation(0.7, 4, (1, 2, 3))
    @ Matrix.Diagonal((2.0, 0.5, 1.0, 1.0)),
}


def creature(levels=1):
    """A monkey without its eyes, whose mesh is alike to both sides."""
    bpy.ops.mesh.primitive_monkey_add()
    item = bpy.context.active_object
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    min(item.data.vertices, key=lambda vertex: abs(vertex.co.x)).select = True  # of the head
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_linked()
    bpy.ops.mesh.select_all(action="INVERT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    if levels:
        item.modifiers.new("Finer", "SUBSURF").levels = levels
        bpy.ops.object.modifier_apply(modifier="Finer")
    item.name = "Creature"
    return item


def rows(values):
    """Rows of numbers as they are, sorted."""
    values = np.ascontiguousarray(values + np.float32(0))
    return values[np.lexsort(values.T)]


def is_mirrored(mesh):
    places = positions(mesh)
    return np.array_equal(rows(places), rows(places * FLIP))


def surfaces(mesh):
    """Corner places of each face and its color, and those of the mirrored faces."""
    places = positions(mesh)
    faces = [[], []]
    colors = np.empty(4 * len(mesh.loops), np.float32)
    mesh.color_attributes["saddleback_color"].data.foreach_get("color", colors)
    colors = colors.reshape(-1, 4)
    for polygon in mesh.polygons:
        corners = places[list(polygon.vertices)] + np.float32(0)
        for side, seen in zip(faces, (corners, corners[::-1] * FLIP + np.float32(0)), strict=True):
            first = min(range(len(seen)), key=lambda i, seen=seen: tuple(seen[i]))
            side.append((np.roll(seen, -first, axis=0).tobytes(), colors[polygon.loop_start].tobytes()))
    return tuple(map(sorted, faces))


@pytest.mark.parametrize("place", list(PLACES))
def test_cells_are_mirrored_to_the_bit(place):
    item = creature(levels=2)
    item.matrix_world = PLACES[place]
    bpy.ops.saddleback.tessellate(
        count=120, mirror_x=True, make_cells=True, make_centers=True, gap=0.01, thickness=0.02, inset=0.01,
        iterations=5, k=30,
    )  # fmt: skip
    for role in ("Edges", "Cells", "Centers"):
        assert is_mirrored(bpy.data.objects[f"Creature {role}"].data), role
    one, other = surfaces(bpy.data.objects["Creature Cells"].data)
    assert one == other
    cells = attribute(item, "saddleback_cell")
    count = len(bpy.data.objects["Creature Centers"].data.vertices)
    assert set(cells) == set(range(count)) and 110 <= count <= 130
    assert "mirror_x" not in item.saddleback.tessellate.bl_rna.properties and item.saddleback.mirror_x


def test_cells_lie_across_the_plane_without_a_seam():
    creature()
    bpy.ops.saddleback.tessellate(count=120, mirror_x=True, make_cells=True, make_centers=True, iterations=5, k=30)
    places = positions(bpy.data.objects["Creature Centers"].data)
    assert (places[:, 0] == 0).sum() >= 8
    cells = bpy.data.objects["Creature Cells"].data
    edges = positions(cells)[np.array([edge.vertices[:] for edge in cells.edges])]
    in_plane = [edge.key for edge, ends in zip(cells.edges, edges, strict=True) if (ends[:, 0] == 0).all()]
    faces = {}
    for polygon in cells.polygons:
        for key in polygon.edge_keys:
            faces.setdefault(key, []).append(polygon.index)
    assert in_plane and np.mean([len(faces[key]) == 2 for key in in_plane]) > 0.9  # the others are gaps' ends


@pytest.mark.parametrize("make", ["uv_sphere", "monkey", "torus"])
@pytest.mark.parametrize("count", [1, 4])
def test_of_too_few_cells_there_are_as_many_as_the_plane_needs(make, count, capfd):
    getattr(bpy.ops.mesh, f"primitive_{make}_add")()
    item = bpy.context.active_object
    bpy.ops.saddleback.tessellate(count=count, mirror_x=True, make_centers=True, k=30)
    made = bpy.data.objects[f"{item.name} Centers"].data
    assert is_mirrored(made) and count < len(made.vertices) <= 12
    assert "as few cells as X Mirror allows" in capfd.readouterr().out


def test_the_remesh_is_whole_and_mirrored():
    item = creature()
    bpy.ops.saddleback.tessellate(count=400, mirror_x=True, make_edges=False, make_dual=True, iterations=20, k=30)
    dual = bpy.data.objects["Creature Dual"].data
    assert is_mirrored(dual)
    uses = np.bincount(np.unique(np.sort([key for p in dual.polygons for key in p.edge_keys], axis=1), axis=0,
                                 return_inverse=True)[1].ravel())  # fmt: skip
    border = sum(uses == 1)
    assert uses.max() == 2
    bounds = [np.ptp(positions(mesh), axis=0) for mesh in (dual, item.data)]
    assert np.abs(bounds[0] - bounds[1]).max() < 0.2 and border < 60  # around the eyes


@pytest.mark.parametrize("place", list(PLACES))
def test_shapes_are_mirrored_to_the_bit(place):
    item = creature(2)
    item.matrix_world = PLACES[place]
    bpy.ops.saddleback.distribute(
        shapes="SCALES", count=120, mirror_x=True, make_instances=True, make_outlines=True, write_attributes=True
    )
    for role in ("Shapes", "Shape Instances"):
        assert is_mirrored(bpy.data.objects[f"Creature {role}"].data), role
    one, other = surfaces(bpy.data.objects["Creature Shapes"].data)
    assert one == other
    curve = bpy.data.objects["Creature Shape Outlines"].data
    points = np.array([point.co[:3] for spline in curve.splines for point in spline.points], np.float32)
    np.testing.assert_array_equal(rows(points), rows(points * FLIP))
    shape = attribute(item, "saddleback_shape")
    assert shape.max() + 1 == 2 * len({*shape[positions(item.data)[:, 0] > 0]} - {-1}) or shape.max() > 0


def test_a_mirrored_shape_stands_as_its_bent_copy_does():
    creature(2)
    bpy.ops.saddleback.distribute(shapes="FEATHERS", count=60, mirror_x=True, make_instances=True, fit=0.0)
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    seen = [np.array(instance.matrix_world)[:3, :3] for instance in depsgraph.object_instances if instance.is_instance]
    assert len(seen) % 2 == 0 and seen
    half = len(seen) // 2
    for one, other in zip(seen[:half], seen[half:], strict=True):
        flip = np.diag([-1.0, 1.0, 1.0])
        np.testing.assert_allclose(flip @ one, other, atol=1e-5)  # feathers are not turned, but mirrored


@pytest.mark.parametrize("operator", ["tessellate", "distribute"])
def test_a_mesh_without_a_mirror_is_told_and_nothing_changes(operator):
    item = creature()
    total = len(item.data.vertices)
    away = [v.index for v in item.data.vertices if v.co.x > 0.3][:7]
    for number in away:
        item.data.vertices[number].co.z += 0.05
    item.data.update()
    before = fingerprint()
    with pytest.raises(RuntimeError, match=rf"'Creature' is not the same .*: 14 of its {total:,} vertices have no"):
        getattr(bpy.ops.saddleback, operator)(mirror_x=True)
    assert fingerprint() == before


def test_faces_across_the_plane_are_told():
    x, y = np.meshgrid([-3.0, -1.0, 1.0, 3.0], [0.0, 1.0, 2.0])
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    faces = [(4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4) for j in range(2) for i in range(3)]
    add_object("Sheet", vertices, faces)
    with pytest.raises(RuntimeError, match="'Sheet': 4 triangles cross the mirror plane, X = 0; cut them there"):
        bpy.ops.saddleback.tessellate(mirror_x=True)


def test_a_sheared_object_has_no_mirror():
    item = creature(0)
    holder = bpy.data.objects.new("Holder", None)
    bpy.context.scene.collection.objects.link(holder)
    holder.scale = (1, 4, 0.5)
    item.parent, item.rotation_euler = holder, (0.4, 0.3, 0.7)
    with pytest.raises(RuntimeError, match="'Creature' is sheared by its parent, so that it has no mirror"):
        bpy.ops.saddleback.tessellate(mirror_x=True)


def test_partners_are_found_exactly_and_nearly():
    rng = np.random.default_rng(3)
    side = rng.uniform(0.1, 1.0, (500, 3))
    middle = np.column_stack([np.zeros(40), rng.uniform(0, 1, (40, 2))])
    places = np.concatenate([side, side * FLIP, middle])
    expected = np.concatenate([np.arange(500, 1000), np.arange(500), np.arange(1000, 1040)])
    np.testing.assert_array_equal(partners(places), expected)
    np.testing.assert_array_equal(partners(places + rng.uniform(-2e-6, 2e-6, places.shape)), expected)
    places[7, 2] += 0.01
    assert np.flatnonzero(partners(places) < 0).tolist() == [7, 507]


def test_a_region_on_one_side_is_covered_on_both():
    item = creature()
    up = [v.index for v in item.data.vertices if v.co.x > 0.3]
    item.vertex_groups.new(name="Left").add(up, 1.0, "REPLACE")
    bpy.ops.saddleback.tessellate(
        count=60, mirror_x=True, region="VERTEX_GROUP", region_name="Left", make_cells=True, make_dual=True, k=30
    )
    cells = bpy.data.objects["Creature Cells"]
    assert is_mirrored(cells.data) and np.abs(positions(cells.data)[:, 0]).min() > 0
    bpy.context.view_layer.update()
    shown = cells.evaluated_get(bpy.context.evaluated_depsgraph_get()).data  # as it follows
    np.testing.assert_allclose(positions(shown), positions(cells.data), atol=1e-5)
