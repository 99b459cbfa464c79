# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks: one click, one picture; what they leave alone; the artist's own, kept as presets."""

import math
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Vector
from mathutils.bvhtree import BVHTree
from scenes import add_object, attribute, dealt, grid, positions, select, sphere

from saddleback_blender import finishes, jobs, looks, nodes
from saddleback_blender.bridge.inputs.mesh_in import read_triangles
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of
from saddleback_blender.bridge.outputs.preview import COLORS, RAMP
from saddleback_blender.core import native
from saddleback_blender.core.surfaces.normals import normals_at
from saddleback_blender.ops.look_presets import read_preset

ROLES = {
    "PANELS": "cells", "PEBBLES": "cells", "LAMP": "shell", "STIPPLE": "centers", "REMESH": "dual", "QUADS": "dual",
    "BANDS": "isolines",
    "SCALES": "shapes", "FEATHERS": "shapes", "STUDS": "shapes", "MOSAIC": "shapes",
}  # fmt: skip


def torus():
    bpy.ops.mesh.primitive_torus_add()
    return bpy.context.active_object


def apply(look):
    return bpy.ops.saddleback.apply_look(look=look)


def materials():
    return sorted(material.name for material in bpy.data.materials)


@pytest.mark.parametrize("make", [sphere, torus])
@pytest.mark.parametrize("look", sorted(looks.LOOKS))
def test_one_call_makes_the_look_and_another_piles_nothing_up(monkeypatch, look, make):
    if looks.LOOKS[look].operator == "distribute":  # copies of one shape, that what is asked here has no need of
        monkeypatch.setitem(looks.LOOKS[look].settings, "count", 100)
    item = make()
    assert apply(look) == {"FINISHED"}
    (shown,) = outputs_of(item)
    assert find_output(item, ROLES[look]) == shown
    finish = looks.finish_of(look)
    if finish is not None:
        material = bpy.data.materials[f"Saddleback {finish.name}"]
        assert set(shown.data.materials) == {material}
        mean = finishes.palette_of(finish).mean(axis=0)
        assert material.diffuse_color[:3] == pytest.approx(mean)  # what Solid shows
    group = getattr(item.saddleback, looks.LOOKS[look].operator)
    for name, value in {**looks.LOOKS[look].settings, "look": look}.items():
        assert getattr(group, name) == (pytest.approx(value) if isinstance(value, float) else value), name
    before = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.node_groups), materials()
    assert apply(look) == {"FINISHED"}
    assert (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.node_groups), materials()) == before


def test_every_look_stands_in_the_table_of_this_test():
    assert set(ROLES) == set(looks.LOOKS)


def test_a_look_takes_the_place_of_another_whoever_makes_it():
    item = sphere()
    for look in ("PANELS", "STUDS", "BANDS", "LAMP", "PEBBLES"):
        assert apply(look) == {"FINISHED"}
        assert [found["saddleback_role"] for found in outputs_of(item)] == [ROLES[look]]
        operators = ("tessellate", "distribute", "distance")
        shown = [getattr(item.saddleback, name).look for name in operators]
        assert sorted(shown) == sorted([look, "NONE", "NONE"])
        names = [slot.material.name for slot in item.material_slots]
        below = {"PANELS": "Panels Ground", "STUDS": "Studs Ground", "BANDS": "Distance", "PEBBLES": "Pebbles Ground"}
        assert names == ([f"Saddleback {below[look]}"] if look in below else [])
        assert (item.hide_render, item.display_type) == ((True, "BOUNDS") if look == "LAMP" else (False, "TEXTURED"))
    bpy.ops.saddleback.clear()
    assert not item.material_slots and not item.data.materials and not materials()


def test_a_body_with_a_material_keeps_it_and_comes_back_from_hiding():
    item = sphere()
    own = bpy.data.materials.new("Own")
    item.data.materials.append(own)
    apply("MOSAIC")
    assert item.material_slots[0].material == own
    item.display_type = "WIRE"
    apply("LAMP")
    assert item.hide_render and item.display_type == "BOUNDS"
    bpy.ops.saddleback.tessellate(look="NONE", make_cells=True)
    assert not item.hide_render and item.display_type == "WIRE"
    apply("REMESH")
    bpy.ops.saddleback.clear()
    assert not item.hide_render and item.display_type == "WIRE" and list(item.data.materials) == [own]


def test_what_the_artist_painted_and_chose_stays():
    item = sphere(subdivisions=5)
    top = [vertex.index for vertex in item.data.vertices if vertex.co.z > 0.7]
    item.vertex_groups.new(name="Fine").add(top, 1.0, "REPLACE")
    settings = item.saddleback.tessellate
    settings.density_source, settings.density_name, settings.seed = "VERTEX_GROUP", "Fine", 4
    assert apply("PANELS") == {"FINISHED"}
    assert (settings.density_source, settings.density_name, settings.seed) == ("VERTEX_GROUP", "Fine", 4)
    cells = np.zeros(len(item.data.vertices), np.int32)
    item.data.attributes["saddleback_cell"].data.foreach_get("value", cells)
    assert len(set(cells[top])) > 100  # of 200: painted cells are smaller by four
    bpy.ops.saddleback.tessellate(count=60)  # a script goes on from the look
    shown = find_output(item, "cells")
    assert settings.look == "PANELS" and shown.data.materials[0].name == "Saddleback Panels"
    assert find_output(item, "edges") is None


def test_a_material_that_the_artist_edited_is_not_made_again():
    item = sphere()
    apply("LAMP")
    material = bpy.data.materials["Saddleback Lamp"]
    material.name, material.diffuse_color = "My Lamp", (1.0, 0.0, 0.0, 1.0)
    other = sphere("Other")
    apply("LAMP")
    assert find_output(other, "shell").data.materials[0] == material == find_output(item, "shell").data.materials[0]
    assert material.diffuse_color[:] == (1.0, 0.0, 0.0, 1.0)
    own = bpy.data.materials.new("Own")
    find_output(other, "shell").data.materials[0] = own
    apply("LAMP")
    assert find_output(other, "shell").data.materials[0] == own


def test_colors_of_cells_are_those_of_the_look_and_no_two_neighbors_have_the_same():
    item = sphere(subdivisions=4)
    apply("PEBBLES")
    mesh = find_output(item, "cells").data
    colors = np.empty(4 * len(mesh.loops), np.float32)
    mesh.color_attributes[nodes.COLOR_ATTRIBUTE].data.foreach_get("color", colors)
    finish = looks.finish_of("PEBBLES")
    palette = finishes.palette_of(finish)
    seen = np.unique(colors.reshape(-1, 4)[:, :3], axis=0)
    share = seen[:, None] / palette  # how bright, for each of the palette's
    is_near = (np.ptp(share, axis=2) < 0.1) & (abs(share.mean(axis=2) - 1.0) < finish.contrast + 0.05)
    assert is_near.any(axis=1).all() and is_near.any(axis=0).all()


def vertex_colors(mesh, name):
    """(V, 4) linear colors."""
    found = np.empty(4 * len(mesh.vertices), np.float32)
    mesh.color_attributes[name].data.foreach_get("color", found)
    return found.reshape(-1, 4)


@pytest.mark.parametrize("own", ["", "Paint"])
@pytest.mark.parametrize("levels", [0, 1])
def test_solid_view_shows_the_colors_of_bands(levels, own):
    item = sphere()
    if own:
        item.data.color_attributes.new(own, "BYTE_COLOR", "POINT")
    if levels:
        item.modifiers.new("Smooth", "SUBSURF").levels = levels
    assert finishes.has_colors("BANDS") and not finishes.has_colors("LAMP")
    apply("BANDS")
    shown = (find_output(item, "surface") if levels else item).data
    if own:
        assert shown.color_attributes.active_color.name == own
        return
    assert shown.color_attributes.active_color.name == COLORS
    far = np.array([element.value for element in shown.attributes["saddleback_distance"].data])
    colors = vertex_colors(shown, COLORS)
    nearest, farthest = colors[far.argmin(), :3], colors[far.argmax(), :3]
    assert nearest == pytest.approx(RAMP[0][1], abs=0.3) and farthest == pytest.approx(RAMP[-1][1], abs=1e-6)
    assert nearest.sum() > farthest.sum()
    apply("PANELS")
    assert COLORS not in item.data.attributes and COLORS not in shown.attributes


def test_a_lamp_has_its_color_where_solid_view_shows_attributes():
    item = sphere()
    apply("LAMP")
    colors = vertex_colors(find_output(item, "shell").data, nodes.COLOR_ATTRIBUTE)
    lamp = finishes.palette_of(looks.finish_of("LAMP"))[0]
    assert np.median(colors[:, :3], axis=0) == pytest.approx(lamp, abs=0.01)


@pytest.mark.parametrize("size", [0.06, 120.0])
def test_a_look_is_as_large_as_the_model(size):
    item = sphere(radius=size)
    apply("SCALES")
    far = np.linalg.norm(positions(find_output(item, "shapes").data), axis=1)
    assert size < np.quantile(far, 0.9) < 1.05 * size and far.max() < 1.2 * size


def test_an_object_with_modifiers_shows_no_second_surface():
    item = grid()
    item.modifiers.new("Smooth", "SUBSURF").levels = 2
    apply("PANELS")
    copy = find_output(item, "surface")
    assert copy.hide_viewport and copy.hide_render


@pytest.mark.parametrize("look", ["REMESH", "QUADS"])
def test_new_meshes_keep_the_edges_of_a_box(look):
    bpy.ops.mesh.primitive_cube_add()
    item = bpy.context.active_object
    assert apply(look) == {"FINISHED"}
    made = find_output(item, "dual").data
    places, triangles = positions(made).astype(float), read_triangles(made)
    a, b, c = (places[triangles[:, side]] for side in range(3))
    assert np.einsum("ij,ij->", np.cross(a, b), c) / 6.0 == pytest.approx(8.0, rel=1e-5)
    assert np.abs(places).max(axis=1) == pytest.approx(1.0, abs=1e-5)
    on_corners = (np.abs(places) > 1.0 - 1e-5).all(axis=1)
    assert np.count_nonzero(on_corners) == 8


def test_each_of_more_parts_than_cells_has_cells_and_a_frame_of_a_lattice(monkeypatch, capfd):
    monkeypatch.setitem(looks.LOOKS["PANELS"].settings, "count", 20)  # a tenth of the parts are as many times more
    monkeypatch.setitem(looks.LOOKS["LAMP"].settings, "count", 15)
    planks = np.arange(23)[:, None, None] * (0.0, 0.0, 0.1) + [[0, 0, 0], [1, 0, 0], [1, 0.1, 0], [0, 0.1, 0]]
    item = add_object("Planks", planks.reshape(-1, 3).tolist(), np.arange(92).reshape(-1, 4).tolist())
    assert apply("PANELS") == {"FINISHED"}
    assert item.saddleback.tessellate.count == 20  # as the look has it
    cells = attribute(item, "saddleback_cell").reshape(-1, 4)
    assert (cells >= 0).all() and cells.max() < 43
    assert len(set(cells[:, 0])) == 23
    assert "43 cells, so that each part has one" in jobs.state.line
    assert apply("LAMP") == {"FINISHED"}
    shell = find_output(item, "shell").data
    assert len(set(native.load().connected_parts(read_triangles(shell), len(shell.vertices)))) == 23
    assert "in 23 pieces, since the mesh is in 23 parts: join those first" in capfd.readouterr().out


@pytest.mark.parametrize("look", ["REMESH", "QUADS"])
def test_a_new_mesh_has_the_border_of_an_open_one(look):
    item = grid(n=2)
    assert apply(look) == {"FINISHED"}
    mesh = find_output(item, "dual").data
    assert sum(polygon.area for polygon in mesh.polygons) == pytest.approx(1.0, abs=1e-6)  # to its very corners


def test_borders_that_need_most_cells_are_left():
    cards = np.arange(300.0)[:, None, None] * [2.0, 0, 0] + [[0.0, 0, 0], [0.1, 0, 0], [0.1, 1, 0], [0, 1, 0]]
    item = add_object("Cards", cards.reshape(-1, 3), np.arange(1200).reshape(-1, 4))
    assert apply("REMESH") == {"FINISHED"}
    assert len(find_output(item, "dual").data.polygons) > 2000


@pytest.mark.parametrize("look", ["REMESH", "QUADS"])
def test_edges_that_need_most_cells_are_left(look):
    bpy.ops.mesh.primitive_cube_add()
    item = bpy.context.active_object
    item.modifiers.new("Bars", "SUBSURF").subdivision_type = "SIMPLE"
    item.modifiers["Bars"].levels = 2
    item.modifiers.new("Lattice", "WIREFRAME").thickness = 0.06
    assert apply(look) == {"FINISHED"}


@pytest.mark.parametrize("look", ["PANELS", "STUDS"])
def test_a_mesh_that_is_inside_out_is_told_and_repair_turns_it(look, capfd):
    item = sphere()
    item.data.flip_normals()
    assert apply(look) == {"FINISHED"}
    assert "'Sphere' is inside out" in capfd.readouterr().out
    assert bpy.ops.saddleback.repair() == {"FINISHED"} and apply(look) == {"FINISHED"}
    assert "inside out" not in capfd.readouterr().out


def test_a_look_is_a_mesh_though_faults_stay_where_no_cells_can_be_joined(monkeypatch, capfd):
    item, library = sphere(), native.load()
    own = library.GeodesicVoronoi.dual

    def dual(cells, policy="repair", **options):
        if policy == "repair":
            raise library.InputError("sites: no dual mesh after 504 more sites")
        return own(cells, policy, **options)

    monkeypatch.setattr(library.GeodesicVoronoi, "dual", dual)
    with pytest.raises(RuntimeError, match="no dual mesh after 504"):
        bpy.ops.saddleback.tessellate(count=9, make_dual=True)
    for look in ("REMESH", "QUADS"):
        assert apply(look) == {"FINISHED"}
        assert len(find_output(item, "dual").data.polygons) > 1000


def test_stones_are_smooth_all_over():
    item = sphere()
    apply("PEBBLES")
    mesh = find_output(item, "cells").data
    if bpy.app.version < (4, 1):
        assert mesh.auto_smooth_angle > math.radians(60.0)
        return
    angle = edge_angles(mesh)
    sharp = np.zeros(len(mesh.edges), bool)
    mesh.edges.foreach_get("use_edge_sharp", sharp)
    assert np.degrees(angle.max()) > 31.0 and not sharp[angle < math.radians(60.0)].any()


def edge_angles(mesh):
    """(e,) between the faces beside an edge, 0 where there is one."""
    normals = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("normal", normals)
    edges = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", edges)
    order = np.argsort(edges, kind="stable")
    first = np.flatnonzero(edges[order][1:] == edges[order][:-1])
    a, b = (normals.reshape(-1, 3)[order[first + i] // 3] for i in range(2))
    angle = np.zeros(len(mesh.edges))
    angle[edges[order[first]]] = np.arccos(np.clip(np.einsum("ij,ij->i", a, b), -1.0, 1.0))
    return angle


def test_what_cannot_be_covered_is_told_in_a_sentence():
    with pytest.raises(RuntimeError, match="no active object"):
        bpy.context.view_layer.objects.active = None
        apply("PANELS")
    item = add_object("Line", [(0, 0, 0), (1, 0, 0)], [])
    with pytest.raises(RuntimeError, match="'Line'"):
        apply("PANELS")
    assert not outputs_of(item) and item.saddleback.tessellate.look == "NONE"


def test_a_look_is_kept_as_a_preset_and_comes_back():
    item = sphere()
    apply("PANELS")
    bpy.ops.saddleback.tessellate(count=70, gap_share=12.0, seed=3)
    assert bpy.ops.saddleback.look_preset_add(name="Hull of mine") == {"FINISHED"}
    path = Path(bpy.utils.preset_paths("saddleback/looks")[0]) / "Hull_of_mine.py"
    operator, values = read_preset(path)
    assert operator == "tessellate" and values["count"] == 70 and values["look"] == "PANELS"
    assert not any("object" in name or name.startswith("density") for name in values)
    other = torus()
    assert bpy.ops.saddleback.run_preset(filepath=str(path)) == {"FINISHED"}
    settings = other.saddleback.tessellate
    assert (settings.count, settings.seed, settings.gap_share) == (70, 3, pytest.approx(12.0))
    assert find_output(other, "cells").data.materials[0].name == "Saddleback Panels"
    assert len(find_output(item, "cells").data.polygons)
    path.write_text(path.read_text() + "settings.tessellate.of_tomorrow = 1\n")
    assert bpy.ops.saddleback.run_preset(filepath=str(path)) == {"FINISHED"}
    bpy.ops.saddleback.look_preset_add(name="Hull_of_mine", remove_name=True)
    assert not path.exists()


@pytest.mark.parametrize(
    "text",
    [
        "",
        "settings.render.count = 1\n",
        "settings.tessellate.count = __import__('os')\n",
        "settings.tessellate.count = 'x'\n",
    ],
)
def test_a_preset_that_is_none_is_told_and_not_run(tmp_path, text):
    item = sphere()
    path = tmp_path / "own.py"
    path.write_text(text)
    with pytest.raises(RuntimeError, match=r"own\.py|count"):
        bpy.ops.saddleback.run_preset(filepath=str(path))
    assert not outputs_of(item)


def test_only_the_active_object_gets_it():
    item, other = sphere(), sphere("Other")
    select(item, [0])
    bpy.context.view_layer.objects.active = item
    apply("STUDS")
    assert outputs_of(item) and not outputs_of(other)


def bare_share(item, shown, count=4000):
    """The share of places on a closed surface, evenly spread, over which nothing lies as seen along the normal."""
    body = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = native.load().Mesh(positions(body.data).astype(float), read_triangles(body.data))
    places = native.load().sample(mesh, count, seed=1)
    normals = normals_at(mesh.vertices, mesh.triangles, places.faces, places.barycentric)
    tree = BVHTree.FromObject(shown, bpy.context.evaluated_depsgraph_get())
    size = np.sqrt(mesh.area / count)
    hits = [
        tree.ray_cast(Vector(place - 0.1 * size * normal), Vector(normal), 20.0 * size)[0]
        for place, normal in zip(places.positions(mesh), normals, strict=True)
    ]
    return hits.count(None) / count


def passing_pairs(shown):
    """The number of pairs of copies that pass through each other, by exact tests of all their triangles."""
    triangles = read_triangles(shown.data)
    owner = np.zeros(len(shown.data.polygons), np.int32)
    shown.data.attributes["saddleback_shape"].data.foreach_get("value", owner)
    polygon = np.zeros(len(triangles), np.int32)
    shown.data.loop_triangles.foreach_get("polygon_index", polygon)
    found = owner[polygon[native.load().self_crossings(positions(shown.data), triangles)]]
    return len(np.unique(np.sort(found[found[:, 0] != found[:, 1]], axis=1), axis=0))


@pytest.mark.parametrize(
    ("look", "make"),
    dealt(
        ("SCALES", "uv_sphere"),
        ("SCALES", "torus"),
        ("SCALES", "monkey"),
        ("FEATHERS", "torus"),
        ("FEATHERS", "monkey"),
        ("FEATHERS", "uv_sphere"),
    ),
)
def test_scales_leave_no_skin_bare_and_meet_only_where_they_overlap(look, make):
    getattr(bpy.ops.mesh, f"primitive_{make}_add")()
    item = bpy.context.active_object
    item.modifiers.new("Smooth", "SUBSURF").levels = 2
    apply(look)
    shown = find_output(item, "shapes")
    assert bare_share(item, shown) < 0.02 and not passing_pairs(shown)
    assert bpy.ops.saddleback.check_distribution() == {"FINISHED"}
    assert "none touches another" in jobs.state.line  # of what is not overlapped
    if make == "torus":
        bpy.ops.saddleback.distribute(no_crossings=False)
        assert passing_pairs(find_output(item, "shapes")) > 100  # so the count can fail


def strip():
    item = grid(n=40)
    for vertex in item.data.vertices:
        vertex.co.y *= 0.12
    return item


def monkey():
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.active_object


@pytest.mark.parametrize(("look", "make"), dealt(("SCALES", strip), ("SCALES", monkey), ("FEATHERS", strip)))
def test_small_ones_lie_where_skin_would_be_bare(look, make):
    """Along borders and where sharp edges have others drawn smaller."""
    item = make()
    apply(look)
    shown = find_output(item, "shapes")
    assert bare_share(item, shown) < 0.02 and not passing_pairs(shown)
    assert "small shapes lie where skin would be bare" in jobs.state.figures[-1]


def test_small_scales_of_both_sides_are_twins():
    item = monkey()
    item.saddleback.mirror_x = True
    apply("SCALES")
    mesh = find_output(item, "shapes").data
    number, random = (
        np.array([face.value for face in mesh.attributes[f"saddleback_{name}"].data]) for name in ("shape", "random")
    )
    numbers, first = np.unique(number, return_index=True)
    middle = np.array([face.center for face in mesh.polygons])[first]
    count = int(jobs.state.line.split(" shapes")[0].split()[-1].replace(",", ""))
    fillers = numbers >= 2 * count
    assert np.count_nonzero(fillers) > 100
    left, right = middle[fillers, 0] < 0, middle[fillers, 0] > 0
    assert np.sort(random[first][fillers][left]) == pytest.approx(np.sort(random[first][fillers][right]))


def test_a_tip_stands_higher_than_a_root_by_the_tilt():
    item = grid(n=20)
    tilt = np.radians(20.0)
    bpy.ops.saddleback.distribute(shapes="SCALES", count=40, overlap=0.5, tilt=tilt, make_instances=True)
    mesh = find_output(item, "shapes").data
    owner = np.zeros(len(mesh.polygons), np.int32)
    mesh.attributes["saddleback_shape"].data.foreach_get("value", owner)
    for number in np.unique(owner)[:5]:
        corners = {vertex for polygon in mesh.polygons if owner[polygon.index] == number for vertex in polygon.vertices}
        own = positions(mesh)[sorted(corners)]
        floor = own[np.argsort(own[:, 2])[: len(own) // 2]]
        length = np.ptp(own[:, :2] @ np.linalg.svd(own[:, :2] - own[:, :2].mean(axis=0))[2][0])
        assert np.tan(tilt) * length == pytest.approx(np.ptp(own[:, 2]), rel=0.25) and floor[:, 2].min() > -1e-6
    plain = find_output(item, "shape instances")
    normals = np.empty(3 * len(plain.data.vertices), np.float32)
    plain.data.attributes["saddleback_normal"].data.foreach_get("vector", normals)
    assert normals.reshape(-1, 3)[:, 2] == pytest.approx(np.cos(tilt), abs=1e-4)
    bpy.ops.saddleback.distribute(shapes="SCALES", count=40)
    assert item.saddleback.distribute.overlap == 0.0


def test_where_solid_view_shows_attributes_what_has_none_has_its_material_color():
    item = torus()
    apply("STUDS")
    assert item.color[:] == bpy.data.materials["Saddleback Studs Ground"].diffuse_color[:]
    apply("LAMP")
    assert item.color[:] == (1, 1, 1, 1)
    (shell,) = outputs_of(item)
    assert shell.color[:] == bpy.data.materials["Saddleback Lamp"].diffuse_color[:]
    item.color = 1, 0, 0, 1
    apply("STUDS")
    bpy.ops.saddleback.clear()
    assert item.color[:] == (1, 0, 0, 1)


def test_an_image_is_stippled_in_one_go_or_not_at_all(tmp_path):
    image = bpy.data.images.new("Half", 40, 20)
    pixels = np.ones((20, 40, 4), np.float32)
    pixels[:, :20, :3] = 0.0
    image.pixels.foreach_set(pixels.ravel())
    image.filepath_raw, image.file_format = str(tmp_path / "half.png"), "PNG"
    image.save()
    bpy.data.images.remove(image)
    assert bpy.ops.saddleback.stipple_image(filepath=str(tmp_path / "half.png"), count=300) == {"FINISHED"}
    sheet = bpy.context.active_object
    assert tuple(sheet.dimensions) == pytest.approx((2, 1, 0)) and sheet.select_get()
    (dots,) = outputs_of(sheet)
    places = positions(dots.data)
    assert len(places) == 300 and (places[:, 0] < 0.02).all()  # where it is dark
    before = len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.images)
    (tmp_path / "text.png").write_text("no image")
    for name in ("text.png", "missing.png", ""):
        with pytest.raises(RuntimeError, match="image"):
            bpy.ops.saddleback.stipple_image(filepath=str(tmp_path / name) if name else "")
        assert (len(bpy.data.objects), len(bpy.data.meshes), len(bpy.data.images)) == before
        assert bpy.context.active_object == sheet
