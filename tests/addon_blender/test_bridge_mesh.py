# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender mesh becomes the surface that the artist sees, as seen from where the object stands."""

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from output_scenes import in_world, world_positions
from scenes import add_object, grid, grid_arrays, positions, sphere

from saddleback_blender import compat
from saddleback_blender.bridge.inputs import mesh_in
from saddleback_blender.bridge.inputs.density import read_attribute
from saddleback_blender.bridge.outputs.out_attributes import write_vertex_attributes
from saddleback_blender.core.errors import BadInputError


def read(item, use_modifiers=False):
    with mesh_in.mesh_of(bpy.context, item, use_modifiers) as mesh:
        return mesh_in.read_surface(item, mesh)


def area(surface):
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def volume(surface):
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6


def test_quads_are_cut_and_the_area_stays():
    surface = read(grid(n=7, size=2.0))
    assert surface.triangles.shape == (2 * 49, 3) and surface.triangles.dtype == np.int32
    assert surface.vertices.dtype == np.float64 and surface.used is None
    assert area(surface) == pytest.approx(4.0, rel=1e-6)


def test_triangles_keep_their_order():
    item = sphere(subdivisions=2)
    expected = np.array([tuple(polygon.vertices) for polygon in item.data.polygons])
    np.testing.assert_array_equal(read(item).triangles, expected)


def test_concave_polygon_is_cut_inside_itself():
    corners = [(0, 0, 0), (4, 0, 0), (4, 3, 0), (2, 1, 0), (0, 3, 0)]
    surface = read(add_object("Arrow", corners, [range(5)]))
    assert len(surface.triangles) == 3
    assert area(surface) == pytest.approx(8.0)  # 4 x 3 less the notch, a triangle of base 4 and height 2
    assert (np.cross(
        surface.vertices[surface.triangles[:, 1]] - surface.vertices[surface.triangles[:, 0]],
        surface.vertices[surface.triangles[:, 2]] - surface.vertices[surface.triangles[:, 0]],
    )[:, 2] > 0).all()  # fmt: skip


def test_non_uniform_scale_is_applied_and_the_place_is_not():
    item = grid(n=3)
    item.matrix_world = (
        Matrix.Translation((5, 6, 7)) @ Matrix.Rotation(1.0, 4, (1, 2, 3)) @ Matrix.Diagonal((2, 3, 1, 1))
    )
    bpy.context.view_layer.update()
    surface = read(item)
    np.testing.assert_allclose(surface.vertices.min(axis=0), (0, 0, 0))
    np.testing.assert_allclose(surface.vertices.max(axis=0), (2, 3, 0))
    np.testing.assert_allclose(in_world(item, surface.vertices), world_positions(item), atol=1e-6)


def sheared():
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    parent.scale, parent.rotation_euler = (1.0, 3.0, 0.7), (0.2, -0.4, 0.5)
    item = sphere(subdivisions=2)
    item.parent, item.rotation_euler = parent, (0.4, 0.7, -0.3)
    return item


@pytest.mark.parametrize("make", [sphere, sheared])
@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.2345, -2.0, 0.07), (1.0 / 3.0, np.pi, np.e), (-0.5, -0.5, -0.5)])
def test_the_surface_is_where_the_mesh_is(make, scale):
    item = make()
    item.scale, item.location = scale, (3.0, -1.0, 2.0)
    bpy.context.view_layer.update()
    surface = read(item)
    np.testing.assert_allclose(in_world(item, surface.vertices), world_positions(item), atol=4e-6)
    np.testing.assert_allclose(mesh_in.unscaled(item, surface.vertices), positions(item.data), atol=1e-12)


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.2345, -2.0, 0.07), (1.0 / 3.0, np.pi, np.e)])
def test_a_turned_object_has_the_same_surface(scale):
    item = sphere()
    item.scale = scale
    bpy.context.view_layer.update()
    first = read(item).key
    for turn in np.random.default_rng(0).uniform(-3.0, 3.0, (20, 3)):
        item.rotation_euler, item.location = turn, 1000.0 * turn
        bpy.context.view_layer.update()
        assert read(item).key == first


@pytest.mark.parametrize("scale", [(1, 1, 1), (-1, 1, 1), (-1, -2, 1), (-1, -1, -1)])
def test_faces_look_outward_under_any_mirroring(scale):
    item = sphere()
    item.scale = scale
    bpy.context.view_layer.update()
    assert volume(read(item)) > 0


def test_parent_scale_counts():
    parent = bpy.data.objects.new("Parent", None)
    bpy.context.scene.collection.objects.link(parent)
    item = grid(n=2)
    item.parent = parent
    parent.scale = (3, 3, 3)
    bpy.context.view_layer.update()
    assert area(read(item)) == pytest.approx(9.0, rel=1e-6)


def test_loose_vertices_are_left_out_and_mapped():
    vertices, faces = grid_arrays(3)
    loose = np.array([[9, 9, 9], [8, 8, 8]])
    mixed = np.concatenate([loose[:1], vertices, loose[1:]])
    surface = read(add_object("Loose", mixed, faces + 1))
    assert surface.vertex_count == 18
    np.testing.assert_array_equal(surface.used, np.arange(1, 17))
    np.testing.assert_allclose(surface.vertices, vertices)
    np.testing.assert_array_equal(surface.compact(np.array([0, 1, 17])), [-1, 0, -1])
    spread = surface.spread(np.arange(16.0), np.inf)
    assert np.isinf(spread[[0, 17]]).all()
    np.testing.assert_array_equal(spread[1:17], np.arange(16.0))
    np.testing.assert_array_equal(surface.gather(spread), np.arange(16.0))


def test_modifiers_count_only_when_asked_for():
    item = grid(n=2)
    item.modifiers.new("Subdivision", "SUBSURF").levels = 1
    assert len(read(item).vertices) == 9
    assert len(read(item, use_modifiers=True).vertices) == 25


def test_equal_geometry_has_one_key():
    first, second = read(grid("First")), read(grid("Second"))
    assert first.key == second.key
    second_item = bpy.data.objects["Second"]
    second_item.data.vertices[3].co.z += 0.25
    assert read(second_item).key != first.key


def test_no_faces_and_bad_numbers_are_refused_by_name():
    with pytest.raises(BadInputError, match="'Wire' has no faces"):
        read(add_object("Wire", [(0, 0, 0), (1, 0, 0)], []))
    item = grid("Broken", n=2)
    item.data.vertices[4].co.x = float("nan")
    with pytest.raises(BadInputError, match="'Broken': vertex 4 "):
        read(item)


class Watched(np.ndarray):
    """Tells when Blender goes through it in Python, as through any sequence, instead of copying it in one go."""

    elements = 0

    def __getitem__(self, key):
        Watched.elements += 1
        return super().__getitem__(key)

    def __setitem__(self, key, value):
        Watched.elements += 1
        super().__setitem__(key, value)


def test_integers_are_copied_in_one_go(monkeypatch):
    """NumPy's int32 is C's int in Linux and a long in Windows, which made this 18 times as slow there."""
    mesh, copied, kinds = grid(n=3).data, compat.as_copied, []

    def watch(values):
        kinds.append(values.dtype)
        return copied(values).view(Watched)

    monkeypatch.setattr(compat, "as_copied", watch)
    Watched.elements = 0
    numbers = np.arange(16, dtype=np.int32)
    write_vertex_attributes(bpy.context.object, {"numbers": numbers})
    write_vertex_attributes(bpy.context.object, {"numbers": numbers})  # reads, and finds them equal
    read, _ = read_attribute(bpy.context.object, mesh, "numbers")
    np.testing.assert_array_equal(read, numbers)
    corners, ends = compat.read_corner_vertices(mesh), compat.read_edge_vertices(mesh)
    assert corners.tolist() == [loop.vertex_index for loop in mesh.loops]
    assert ends.tolist() == [list(edge.vertices) for edge in mesh.edges]
    assert Watched.elements == 0
    assert len(kinds) >= 3 and set(kinds) == {np.dtype(np.int32)}
