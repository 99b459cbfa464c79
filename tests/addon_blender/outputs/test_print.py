# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamp shells for printers: round ribs, a base, millimeters, fewer faces, 3MF."""

import zipfile
from xml.etree import ElementTree

import bpy
import numpy as np
import pytest
from mathutils import Matrix
from output_scenes import read_attribute, sphere_source, triangles_of, world_positions
from scenes import grid
from test_output_shell import assert_solid, shell_of, volume

from saddleback_blender import jobs

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def test_round_ribs_are_thick_in_the_middle_and_thin_at_their_sides():
    source = grid(n=16)
    sizes = {"count": 2, "rib_width": 0.2, "rib_thickness": 0.1}
    square, _ = assert_solid(shell_of(source, **sizes))
    whole = volume(square, triangles_of(shell_of(source, **sizes).data))
    item = shell_of(source, rib_profile="ROUND", **sizes)
    places, triangles = assert_solid(item)
    assert abs(places[:, 2]).max() == pytest.approx(0.05, rel=0.05)
    # Half ellipses, the lowest quarter of them upright: of all the thickness 0.25 + 0.75 pi / 4.
    assert volume(places, triangles) / whole == pytest.approx(0.25 + 0.75 * np.pi / 4, abs=0.06)
    # The frame of the square lies within half a width of the border; at its inner side it is thin.
    inner = np.abs(places[:, :2] - 0.5).max(axis=1)
    along = abs(places[:, 1] - 0.5) < 0.2
    side = along & (abs(inner - 0.4) < 1e-6)
    assert side.sum() > 4
    np.testing.assert_allclose(abs(places[side, 2]), 0.25 * 0.05, rtol=0.02)
    wall = read_attribute(item.data, "saddleback_wall")
    np.testing.assert_allclose(wall, 0.1, rtol=1e-5)  # that of the middle of the rib, all along it
    assert "at the least" not in jobs.state.line


@pytest.mark.parametrize("profile", ["SQUARE", "ROUND"])
def test_a_ball_stays_one_solid_with_a_base(profile):
    source = sphere_source(levels=4)
    item = shell_of(source, rib_width=0.12, rib_thickness=0.06, rib_profile=profile, base_height=0.3)
    places, triangles = assert_solid(item)
    # No hole below the base's height: rays from the center all meet the solid.
    corners = places[triangles]
    heights = np.linspace(-0.99, -0.75, 9)
    angles = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    for z in heights:
        for angle in angles:
            radius = np.sqrt(1 - z * z)
            way = np.array([radius * np.cos(angle), radius * np.sin(angle), z])
            assert meets(corners, way)
    above = [np.array([np.cos(a), np.sin(a), 0]) for a in np.linspace(0, 2 * np.pi, 40, endpoint=False)]
    assert not all(meets(corners, way) for way in above)


def meets(corners, way):
    """Tells whether the ray from the origin passes through a triangle, by the signs of three volumes."""
    a, b, c = corners.transpose(1, 0, 2)
    signs = np.stack([np.cross(p, q) @ way for p, q in ((a, b), (b, c), (c, a))])
    is_ahead = (corners.mean(axis=1) @ way) > 0
    return bool((((signs >= 0).all(axis=0) | (signs <= 0).all(axis=0)) & is_ahead).any())


def test_lengths_in_millimeters_whatever_the_unit_of_others():
    source = grid(n=12, size=0.1)
    for scale, size in ((1.0, 0.1), (0.001, 100.0)):
        source.data.transform(Matrix.Scale(size / max(source.dimensions), 4))
        bpy.context.view_layer.update()
        bpy.context.scene.unit_settings.scale_length = scale
        for unit in ("RELATIVE", "ABSOLUTE"):
            item = shell_of(source, count=3, lengths=unit, in_millimeters=True, rib_width_mm=6.0, rib_thickness_mm=3.0)
            places, _ = assert_solid(item)
            np.testing.assert_allclose(np.ptp(places[:, 2]), 0.003 / scale, rtol=1e-5)
            inner = np.abs(places[:, :2] - size / 2).max(axis=1)
            frame = size / 2 - inner[abs(places[:, 1] - size / 2) < size / 8]
            assert abs(frame - 0.003 / scale).min() < 1e-5 / scale  # half of the frame's rib lies on the mesh


@pytest.mark.parametrize("profile", ["SQUARE", "ROUND"])
def test_fewer_faces_are_still_a_solid(profile):
    source = sphere_source(levels=5)
    lengths = {"rib_width": 0.15, "rib_thickness": 0.08, "rib_profile": profile}
    full = shell_of(source, **lengths)
    places, triangles = assert_solid(full)
    wanted = len(triangles) // 6
    item = shell_of(source, shell_faces=wanted, **lengths)
    fewer, faces = assert_solid(item)
    assert len(faces) <= 1.05 * wanted
    assert f"{len(faces):,} faces" in jobs.state.line
    assert volume(fewer, faces) == pytest.approx(volume(places, triangles), rel=0.04)
    wall = read_attribute(item.data, "saddleback_wall")
    assert len(wall) == len(fewer) and wall.max() == pytest.approx(0.08, rel=0.01)


@pytest.mark.parametrize(("height", "most"), [(0.1, 0.5), (0.02, 1.0)])
def test_fewer_faces_where_there_is_no_room_do_not_cross(height, most):
    source = sphere_source(levels=4)
    source.scale = (1, 1, height)
    bpy.context.view_layer.update()
    lengths = {"rib_width": 0.2, "rib_thickness": 0.08}
    count = len(shell_of(source, **lengths).data.polygons)
    assert "at the least" in jobs.state.line
    _, faces = assert_solid(shell_of(source, shell_faces=count // 4, **lengths))
    assert len(faces) < most * count  # where walls are a thousandth of a rib, hardly any face can go


def test_the_shell_follows_with_fewer_faces():
    source = sphere_source(levels=4)
    source.shape_key_add(name="Basis")
    key = source.shape_key_add(name="High")
    for point in key.data:
        point.co.z += 3
    item = shell_of(source, rib_width=0.15, rib_thickness=0.08, shell_faces=3000)
    before = world_positions(item)
    key.value = 1
    bpy.context.view_layer.update()
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    np.testing.assert_allclose(world_positions(item, shown.data), before + (0, 0, 3), atol=1e-4)


def test_a_mirrored_shell_is_one_solid_and_painted():
    source = sphere_source(levels=4)
    item = shell_of(source, rib_width=0.15, rib_thickness=0.08, mirror_x=True, rib_profile="ROUND")
    places, _ = assert_solid(item)
    assert len(read_attribute(item.data, "saddleback_wall")) == len(places)


def test_3mf_is_the_solid_in_millimeters(tmp_path):
    source = sphere_source(levels=3)
    item = shell_of(source, rib_width=0.2, rib_thickness=0.08)
    bpy.context.scene.unit_settings.scale_length = 0.01
    path = tmp_path / "lamp"
    assert bpy.ops.saddleback.export_3mf(filepath=str(path)) == {"FINISHED"}
    (written,) = tmp_path.iterdir()
    assert written.name == "lamp.3mf"
    with zipfile.ZipFile(written) as archive:
        assert archive.testzip() is None
        assert archive.namelist() == ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
        relation = ElementTree.fromstring(archive.read("_rels/.rels"))[0]
        assert relation.get("Target") == "/3D/3dmodel.model"
        model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    assert model.tag == f"{CORE}model" and model.get("unit") == "millimeter"
    (mesh,) = model.iter(f"{CORE}mesh")
    places = np.array([[float(v.get(axis)) for axis in "xyz"] for v in mesh.iter(f"{CORE}vertex")])
    faces = np.array([[int(t.get(f"v{corner}")) for corner in (1, 2, 3)] for t in mesh.iter(f"{CORE}triangle")])
    np.testing.assert_array_equal(faces, triangles_of(item.data))
    np.testing.assert_allclose(places, 10 * world_positions(item), rtol=1e-6, atol=1e-6)
    (built,) = model.iter(f"{CORE}item")
    assert built.get("objectid") == next(model.iter(f"{CORE}object")).get("id")
    with pytest.raises(RuntimeError, match="cannot be saved"):
        bpy.ops.saddleback.export_3mf(filepath=str(tmp_path / "none" / "lamp.3mf"))
    assert list(tmp_path.iterdir()) == [written]
