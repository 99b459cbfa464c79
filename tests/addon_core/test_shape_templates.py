# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that come with the add-on, outlines from loops and masks, colors and turns of copies."""

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core.shapes.mask_shapes import parts_of_image, silhouette
from saddleback_blender.core.shapes.outline_loops import border_loops, is_seen_once, parts_of_loops, twice_area
from saddleback_blender.core.shapes.shape_colors import random_of, shape_colors
from saddleback_blender.core.shapes.shape_presets import PRESETS, preset
from saddleback_blender.core.shapes.shape_templates import box_uv, fitted, sized
from saddleback_blender.core.surfaces.quaternions import euler_of, quaternions_of, turned

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def shape_of(parts):
    return sb.Shape(*[list(part) for part in parts])


@pytest.mark.parametrize("name", PRESETS)
def test_presets_are_shapes_with_a_solid_right_within(name):
    for template in preset(name):
        shape = shape_of(template.parts)
        assert shape.circumradius == pytest.approx(1.0) and shape.inradius > 0.2
        solid = template.solid
        outside = np.abs(solid.vertices[:, :2]).max() > 1.0 + 1e-9
        assert not outside and solid.vertices[:, 2].min() >= 0
        grown = sb.Shape(*[[loop * (1 + 1e-9) for loop in part] for part in template.parts])
        assert grown.contains(solid.vertices[:, :2]).all()
        # Closed but for its rim on the surface, which every other edge crosses once each way.
        ends = [np.roll(row, -1) for row in np.split(solid.corners, solid.offsets[1:-1])]
        edges = np.column_stack([solid.corners, np.concatenate(ends)])
        there = {tuple(edge) for edge in edges.tolist()}
        lone = [edge for edge in there if edge[::-1] not in there]
        assert len(there) == len(edges) and all(solid.vertices[a, 2] == 0 for a, _ in lone)
        assert solid.uv.min() >= 0 and solid.uv.max() <= 1


def test_sizes_make_classes_smaller_whole():
    large, small = preset("LEAVES")
    shrunk = sized(small)
    assert shrunk.size == 1 and shape_of(shrunk.parts).circumradius == pytest.approx(small.size)
    np.testing.assert_allclose(shrunk.solid.vertices, small.solid.vertices * small.size)
    assert shrunk.scale == pytest.approx(small.scale * small.size) and large.share < small.share


def test_a_template_has_radius_one_about_its_center():
    template = fitted("Square", [[SQUARE]], np.array([0.5, 0.5]))
    (loop,) = template.parts[0]
    np.testing.assert_allclose(np.linalg.norm(loop, axis=1), 1)
    np.testing.assert_allclose((SQUARE + template.shift[:2]) * template.scale, loop)


def test_loops_within_loops_are_holes_and_parts():
    ring = [SQUARE, 0.2 + 0.6 * SQUARE, 0.4 + 0.2 * SQUARE[::-1], SQUARE + (3, 0)]
    parts = parts_of_loops(ring)
    assert sorted(len(part) for part in parts) == [1, 1, 2]
    assert shape_of(parts).area == pytest.approx(1 - 0.36 + 0.04 + 1)
    assert twice_area(SQUARE) == 2 and twice_area(SQUARE[::-1]) == -2


def test_borders_of_flat_meshes():
    triangles = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
    (loop,) = border_loops(triangles)
    assert sorted(loop.tolist()) == [0, 1, 2, 3] and is_seen_once(SQUARE, triangles)
    assert not is_seen_once(SQUARE, np.array([(0, 1, 2), (0, 3, 2)], np.int32))
    assert border_loops(np.array([(0, 1, 2), (0, 3, 4)], np.int32)) is None  # two borders meet in a vertex
    tetrahedron = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)], np.int32)
    assert border_loops(tetrahedron) is None


def test_a_silhouette_covers_the_mesh_and_little_more():
    rng = np.random.default_rng(3)
    turn = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    ring = np.stack([3 * np.cos(turn) + 5, np.sin(turn), rng.normal(size=40)], axis=1)
    inner = (ring - (5, 0, 0)) * (0.4, 0.4, 1) + (5, 0, 0)
    here, onward = np.arange(40), np.roll(np.arange(40), -1)
    triangles = np.concatenate([np.stack([here, onward, 40 + here], 1), np.stack([onward, 40 + onward, 40 + here], 1)])
    vertices = np.concatenate([ring, inner])
    shape = shape_of(silhouette(vertices, triangles))
    assert len(shape.parts) == 1 and len(shape.parts[0]) == 2
    corners = vertices[triangles][:, :, :2]
    weights = rng.dirichlet(np.ones(3), (len(triangles), 30))
    assert shape.contains(np.einsum("tki,tij->tkj", weights, corners).reshape(-1, 2)).all()
    assert shape.contains(vertices[:, :2]).all()
    assert shape.area < 1.1 * np.pi * 3 * 0.84


def test_an_image_is_seen_the_right_way_up():
    mask = np.zeros((300, 600))  # the first row below: a broad foot, a narrow head
    mask[20:100, 100:500] = 1
    mask[100:280, 280:320] = 1
    (part,) = parts_of_image(mask)
    (loop,) = part
    low, high = loop.min(axis=0), loop.max(axis=0)
    assert (high - low)[0] / (high - low)[1] == pytest.approx(400 / 260, rel=0.03)
    assert np.ptp(loop[loop[:, 1] < low[1] + 5, 0]) > 5 * np.ptp(loop[loop[:, 1] > high[1] - 5, 0])
    with pytest.raises(sb.InputError, match="no clear mask"):
        parts_of_image(np.zeros((20, 20)))


def test_turns_as_euler_angles_and_back():
    rng = np.random.default_rng(5)
    quaternions = rng.normal(size=(200, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    special = np.array([(1.0, 0, 0, 0), (0, 1.0, 0, 0), (0.5**0.5, 0, 0.5**0.5, 0), (0.5**0.5, 0, -(0.5**0.5), 0)])
    quaternions = np.concatenate([quaternions, special])
    axes = [turned(quaternions, np.tile(axis, (len(quaternions), 1))) for axis in np.eye(3)]
    roll, pitch, yaw = euler_of(quaternions).T
    found = np.stack([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)], axis=1)
    np.testing.assert_allclose(found, axes[0], atol=1e-7)
    up = np.stack([np.cos(roll) * np.sin(pitch) * np.cos(yaw) + np.sin(roll) * np.sin(yaw),
                   np.cos(roll) * np.sin(pitch) * np.sin(yaw) - np.sin(roll) * np.cos(yaw),
                   np.cos(roll) * np.cos(pitch)], axis=1)  # fmt: skip
    np.testing.assert_allclose(up, axes[2], atol=1e-7)
    again = quaternions_of(*axes)
    np.testing.assert_allclose(np.abs((again * quaternions).sum(axis=1)), 1, atol=1e-12)


def test_colors_are_of_the_class_and_of_the_shape():
    random = random_of(100, 3)
    np.testing.assert_array_equal(random[:10], random_of(10, 3))
    colors = shape_colors(np.arange(100, dtype=np.int32) % 2, random)
    assert colors.min() >= 0 and colors.max() <= 1 and len(np.unique(colors, axis=0)) == 100
    np.testing.assert_allclose(box_uv(np.array([(0.0, 0, 0), (2, 1, 5)])), [(0, 0.25), (1, 0.75)])
