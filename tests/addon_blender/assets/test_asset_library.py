# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library: what is in its file, and what its node groups make of the outputs of Tessellate."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import pytest

from saddleback_blender import compat
from saddleback_blender.assets import groups, library


@pytest.fixture
def body() -> bpy.types.Object:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=3.0)
    item = bpy.context.object
    bpy.ops.saddleback.tessellate(
        count=20, iterations=10, write_edge_distance=True, make_edges=True, edge_radius=0.0, make_centers=True
    )
    return item


def output(kind: str) -> bpy.types.Object:
    item = next(item for item in bpy.data.objects if item.name.endswith(kind))
    item.modifiers.clear()
    return item


def put(item: bpy.types.Object, name: str, **inputs: float) -> bpy.types.Object:
    """The object as it is seen with the asset as its modifier."""
    asset = next(asset for asset in groups.ASSETS if asset.name == name)
    modifier = item.modifiers.new(name, "NODES")
    modifier.node_group = asset.make(name)
    for label, value in inputs.items():
        compat.set_modifier_input(modifier, label, value)
    return item.evaluated_get(bpy.context.evaluated_depsgraph_get())


def radii(item: bpy.types.Object) -> np.ndarray:
    return np.linalg.norm(compat.read_positions(item.data), axis=1)


def edge_distances(item: bpy.types.Object) -> np.ndarray:
    values = np.empty(len(item.data.vertices), np.float32)
    item.data.attributes["saddleback_edge_distance"].data.foreach_get("value", values)
    return values


def test_the_file_holds_what_the_asset_browser_shows(tmp_path: Path) -> None:
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    mine = bpy.data.node_groups.new("Cell Panels", "GeometryNodeTree")
    path = library.write(tmp_path / "new" / "Jörg")
    assert [group.name for group in bpy.data.node_groups] == ["Cell Panels"], "the open file stays as it was"
    assert bpy.data.node_groups["Cell Panels"] == mine
    bpy.data.node_groups.remove(mine)
    with bpy.data.libraries.load(str(path), assets_only=True) as (found, wanted):
        assert set(found.node_groups) == {asset.name for asset in groups.ASSETS}
        wanted.node_groups = list(found.node_groups)
    catalogs = (path.parent / library.CATALOGS).read_text(encoding="utf-8")
    for group in bpy.data.node_groups:
        assert group.asset_data.description
        assert f"{group.asset_data.catalog_id}:Saddleback/" in catalogs
        pixels = np.empty(4 * 128 * 128, np.float32)
        group.preview.image_pixels_float.foreach_get(pixels)
        assert pixels.reshape(-1, 4)[:, :3].std() > 0.05, "a thumbnail that shows something"
    assert [file.name for file in path.parent.iterdir() if file.suffix == ".part"] == []


def test_the_preferences_learn_of_it_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compat, "user_folder", lambda _name: str(tmp_path))
    libraries = bpy.context.preferences.filepaths.asset_libraries
    before = len(libraries)
    for _ in range(2):
        assert bpy.ops.saddleback.add_asset_library() == {"FINISHED"}
    assert len(libraries) == before + 1
    assert libraries[-1].name == "Saddleback"
    bpy.ops.preferences.asset_library_remove(index=before)


def test_a_folder_that_cannot_be_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(compat, "user_folder", lambda _name: str(tmp_path / "file" / "assets"))
    with pytest.raises(RuntimeError, match="The assets cannot be written to"):
        bpy.ops.saddleback.add_asset_library()
    assert not bpy.data.node_groups


def test_panels_rise_between_their_joints(body: bpy.types.Object) -> None:
    distance, before = edge_distances(body), radii(body)
    most = distance.max()
    rise = radii(put(body, "Cell Panels", Gap=0.2, Bevel=0.1, Height=0.5)) - before
    assert np.allclose(rise[distance < 0.1 * most], 0.0, atol=1e-5)
    assert np.allclose(rise[distance > 0.2 * most], 0.5 * most, rtol=1e-3)


@pytest.mark.parametrize("scale", [0.02, 40.0])
def test_pebbles_are_round_at_any_size(body: bpy.types.Object, scale: float) -> None:
    body.data.transform(((scale, 0, 0, 0), (0, scale, 0, 0), (0, 0, scale, 0), (0, 0, 0, 1)))
    values = scale * edge_distances(body)
    body.data.attributes["saddleback_edge_distance"].data.foreach_set("value", values.astype(np.float32))
    before, most = radii(body), values.max()
    rise = radii(put(body, "Cell Pebbles", Gap=0.0, Bevel=1.0, Height=1.0)) - before
    along = values / most
    assert np.allclose(rise / most, np.sqrt(np.maximum(0.0, 1.0 - (1.0 - along) ** 2)), atol=2e-3)


def test_tubes_are_as_thick_as_their_edges_are_long(body: bpy.types.Object) -> None:
    edges = output("Edges")
    thin = put(edges, "Tubes by Cell Size", Thickness=0.02).to_mesh()
    places = np.array([vertex.co for vertex in thin.vertices])
    assert len(places) > 1000
    assert np.abs(np.linalg.norm(places, axis=1) - 3.0).max() < 0.08, "on the surface, but for half of the thickness"


def test_tubes_are_made_of_no_tubes(body: bpy.types.Object) -> None:
    before = len(body.data.vertices)
    assert len(put(body, "Tubes by Cell Size").data.vertices) == before


@pytest.mark.parametrize("name", ["Stipple Dots", "Overlapping Scales"])
def test_one_on_each_center(body: bpy.types.Object, name: str) -> None:
    put(output("Centers"), name)
    drawn = bpy.context.evaluated_depsgraph_get().object_instances
    away = np.array([each.matrix_world.translation.length for each in drawn if each.is_instance])
    assert len(away) == 20
    assert np.abs(away - 3.0).max() < 0.1


@pytest.mark.parametrize("name", ["Cell Color", "Distance Ramp"])
def test_shader_groups_give_a_color(name: str) -> None:
    material = bpy.data.materials.new("Test")
    material.use_nodes = True
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = next(asset for asset in groups.ASSETS if asset.name == name).make(name)
    shader = next(other for other in material.node_tree.nodes if other.type == "BSDF_PRINCIPLED")
    assert material.node_tree.links.new(node.outputs["Color"], shader.inputs["Base Color"]).is_valid
    sink = next(other for other in node.node_tree.nodes if other.type == "GROUP_OUTPUT")
    assert sink.inputs["Color"].is_linked
