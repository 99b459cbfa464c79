# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that was made of a body goes with it: in every frame, in the view and in the final render, in copies."""

from functools import cached_property, partial

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector
from mathutils.bvhtree import BVHTree
from output_scenes import read_attribute
from scenes import add_object, positions, sphere

from saddleback_blender import compat, jobs, nodes
from saddleback_blender.bridge.inputs.curves_in import polylines_of
from saddleback_blender.bridge.outputs import following
from saddleback_blender.bridge.outputs.out_collection import find_output, outputs_of
from saddleback_blender.follow_nodes import follows
from tests import synthetic_cells

CELLS = 60
# Of a cell's size: how far a vertex may be from where it is to be.
SLACK = 0.01
FRAMES = 20
ROLES = {
    "edges", "paths", "isolines", "streamlines", "shape outlines", "cells", "shell", "arrows", "shapes", "centers",
    "dual", "shape cut", "shape instances",
}  # fmt: skip


# --- a body that moves ------------------------------------------------------------------------------------------------


def arm(name="Arm", sides=16, rings=24, place=None):
    """A closed limb of quads along Z, 2.4 long."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=sides, ring_count=rings)
    item = bpy.context.object
    item.name = item.data.name = name
    for vertex in item.data.vertices:
        vertex.co = Vector((0.45 * vertex.co.x, 0.45 * vertex.co.y, 1.2 * vertex.co.z))
    if place is not None:
        item.matrix_world = place
    bpy.context.view_layer.update()
    return item


def rig(item):
    """Bones that bend the limb at its middle, a key that swells it, a lattice that shears it, over 20 frames."""
    bones = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    bpy.context.scene.collection.objects.link(bones)
    bones.matrix_world = item.matrix_world
    bpy.context.view_layer.objects.active = bones
    bpy.ops.object.mode_set(mode="EDIT")
    for head, name in ((-1.2, "Low"), (0.0, "High")):
        bone = bones.data.edit_bones.new(name)
        bone.head, bone.tail = (0, 0, head), (0, 0, head + 1.2)
    bones.data.edit_bones["High"].parent = bones.data.edit_bones["Low"]
    bpy.ops.object.mode_set(mode="OBJECT")
    share = np.clip(0.5 + positions(item.data)[:, 2] / 0.8, 0, 1)
    for name, weights in (("Low", 1 - share), ("High", share)):
        group = item.vertex_groups.new(name=name)
        for vertex, weight in enumerate(weights.tolist()):
            group.add([vertex], weight, "REPLACE")
    item.shape_key_add(name="Basis")
    swollen = item.shape_key_add(name="Swollen")
    for point in swollen.data:
        point.co = Vector((1.3 * point.co.x, 1.1 * point.co.y, point.co.z))
    cage = bpy.data.objects.new("Cage", bpy.data.lattices.new("Cage"))
    bpy.context.scene.collection.objects.link(cage)
    cage.matrix_world = item.matrix_world @ Matrix.Diagonal((4, 4, 4, 1))
    item.modifiers.new("Cage", "LATTICE").object = cage
    item.modifiers.new("Bones", "ARMATURE").object = bones
    animate(bones, cage, swollen)
    bpy.context.view_layer.objects.active = item
    bpy.context.view_layer.update()
    return item


def animate(bones, cage, swollen):
    bend = bones.pose.bones["High"]
    bend.rotation_mode = "XYZ"
    points = [point.co_deform.copy() for point in cage.data.points]
    cage.data.animation_data_clear()
    for frame, amount in ((1, 0.0), (FRAMES, 1.0)):
        bend.rotation_euler = (1.2 * amount, 0.3 * amount, 0.5 * amount)
        bend.keyframe_insert("rotation_euler", frame=frame)
        swollen.value = amount
        swollen.keyframe_insert("value", frame=frame)
        cage.location.x = 0.2 * amount
        cage.keyframe_insert("location", index=0, frame=frame)
        for point, own in zip(cage.data.points, points, strict=True):
            point.co_deform = own + Vector((0.1 * own.z, 0, 0)) * 1.0
    bpy.context.scene.frame_set(1)


def subdivided(item, levels, render_levels):
    modifier = item.modifiers.new("Fine", "SUBSURF")
    modifier.levels, modifier.render_levels = levels, render_levels
    bpy.context.view_layer.update()
    return modifier


def everything(item, use_modifiers):
    """All outputs that one object can have."""
    add_object("Pin", [(-1, -1, 0), (1, -1, 0), (0, 1, 0), (0, 0, 2)], [(0, 1, 2), (0, 1, 3)], active=False)
    bpy.context.view_layer.objects.active = item
    settings = {"use_modifiers": use_modifiers}
    saddleback = bpy.ops.saddleback
    saddleback.tessellate(
        count=CELLS, iterations=5, make_cells=True, gap=0.02, inset=0.02, thickness=0.03, make_centers=True,
        instance_object="Pin", instance_scale=0.2, make_dual=True, make_shell=True, rib_width=0.06, **settings,
    )  # fmt: skip
    saddleback.distance(make_isolines=True, sources="CURSOR", isoline_count=5, **settings)
    saddleback.path(points="CURSOR", lift=0.01, **settings)
    saddleback.direction_field(make_arrows=True, arrow_count=50, make_streamlines=True, **settings)
    saddleback.distribute(
        shapes="STUDS", count=20, packing=0.0, field_source="NONE", make_instances=True, make_outlines=True,
        make_cut=True, **settings,
    )  # fmt: skip


# --- where everything is, and where it is to be -----------------------------------------------------------------------


class Body:
    """The triangles of the evaluated body: where they are, and where they were at rest."""

    def __init__(self, item, depsgraph):
        shown = item.evaluated_get(depsgraph)
        mesh = shown.to_mesh()
        mesh.calc_loop_triangles()
        corners = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("vertices", corners)
        self.triangles = corners.reshape(-1, 3)
        self.places = moved(shown.matrix_world, positions(mesh))
        rest = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.attributes["rest_position"].data.foreach_get("vector", rest)
        self.rest = rest.reshape(-1, 3).astype(float)
        shown.to_mesh_clear()

    @cached_property
    def normals(self):
        """(V, 3) of the vertices."""
        corners = self.places[self.triangles]
        normals = np.zeros_like(self.places)
        for i in range(3):
            sides = [corners[:, (i + j) % 3] - corners[:, i] for j in (1, 2)]
            across = np.cross(*sides)
            angles = np.arctan2(np.linalg.norm(across, axis=1), np.einsum("ij,ij->i", *sides))
            np.add.at(normals, self.triangles[:, i], unit(across) * angles[:, None])
        return unit(normals)

    def offset(self, found, points):
        """(n, 2) how high points are over places of the body, and how far to their side."""
        way = points - mixed(self.places, found)
        normals = unit(mixed(self.normals, found))
        height = np.einsum("ij,ij->i", way, normals)
        return np.column_stack([height, np.linalg.norm(way - height[:, None] * normals, axis=1)])

    @cached_property
    def tree_at_rest(self):
        return BVHTree.FromPolygons(self.rest.tolist(), self.triangles.tolist())

    def find_at_rest(self, points):
        """The triangles next to points while the body is at rest, and the weights there."""
        near = [self.tree_at_rest.find_nearest(point) for point in points.tolist()]
        corners = self.triangles[[triangle for _, _, triangle, _ in near]]
        return corners, barycentric(np.array([place for place, *_ in near]), self.rest[corners])


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def mixed(values, found):
    corners, weights = found
    return np.einsum("ni,nij->nj", weights, values[corners])


def barycentric(points, corners):
    """(n, 3) weights of points in the planes of n triangles."""
    sides = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
    u, v = np.einsum("nij,nj->in", np.linalg.pinv(sides), points - corners[:, 0])
    return np.column_stack([1 - u - v, u, v])


def moved(matrix, places):
    matrix = np.array(matrix)
    return places.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]


def points_of(item, depsgraph):
    """(n, 3) where an output's vertices, or the points of its lines, are in the world."""
    shown = item.evaluated_get(depsgraph)
    mesh = shown.to_mesh()
    places = moved(shown.matrix_world, positions(mesh))
    shown.to_mesh_clear()
    return places


def anchors_of(output):
    """The triangles that an output's points stand on, and the weights there."""
    following = nodes.modifier_of(output, nodes.FOLLOW)
    mesh = compat.modifier_input(following, "Anchors").data if output.type == "CURVE" else output.data
    corners = np.column_stack([read_attribute(mesh, f"saddleback_corner_{letter}") for letter in "abc"])
    return corners, read_attribute(mesh, "saddleback_barycentric").astype(float)


def bare(item):
    """Shows the outputs' own points, without tubes or instances on them."""
    for output in outputs_of(item):
        for modifier in output.modifiers:
            if modifier.type == "NODES" and modifier.node_group[nodes.MARK] != nodes.FOLLOW:
                modifier.show_viewport = modifier.show_render = False
    bpy.context.view_layer.update()
    return [output for output in outputs_of(item) if output.modifiers]


class Watched:
    """The outputs of a body at rest, and what they must do when it moves."""

    def __init__(self, item, use_modifiers=False):
        self.item, self.outputs = item, bare(item)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        body = Body(item, depsgraph)
        self.rest, self.offset, self.found = {}, {}, {}
        for output in self.outputs:
            self.rest[output] = mixed(body.rest if use_modifiers else positions(item.data), anchors_of(output))
            found = body.find_at_rest(self.rest[output])
            self.offset[output] = body.offset(found, points_of(output, depsgraph))
            assert np.linalg.norm(self.offset[output], axis=1).max() < 0.35  # no anchor is far away

    def worst(self, depsgraph, copies=None):
        """The longest way, by role, of a vertex from where it is to be, in the size of a cell.

        It is to be as high over the place where it stands, and as far to the side of that, as it was.
        """
        body = Body(self.item if copies is None else copies[self.item], depsgraph)
        if len(body.places) not in self.found:  # where the places at rest are on a body of this level
            self.found[len(body.places)] = {o: body.find_at_rest(self.rest[o]) for o in self.outputs}
        sides = np.diff(body.places[body.triangles], axis=1).transpose(1, 0, 2)
        size = np.sqrt(np.linalg.norm(np.cross(*sides), axis=1).sum() / 2 / CELLS)
        worst = {}
        for output, found in self.found[len(body.places)].items():
            shown = points_of(output if copies is None else copies[output], depsgraph)
            change = body.offset(found, shown) - self.offset[output]
            worst[output["saddleback_role"]] = np.linalg.norm(change, axis=1).max() / size
        return worst


@pytest.fixture
def rendered():
    """Calls something with the depsgraph of a final render of the frame."""
    asked = {}

    class ProbeEngine(bpy.types.RenderEngine):
        bl_idname = bl_label = "SADDLEBACK_PROBE"

        def render(self, depsgraph):
            asked["answer"] = asked["question"](depsgraph)
            self.end_result(self.begin_result(0, 0, 8, 8))

    def render(question):
        scene = bpy.context.scene
        if scene.camera is None:
            scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
            scene.collection.objects.link(scene.camera)
        scene.render.engine = "SADDLEBACK_PROBE"
        asked.clear()
        asked["question"] = question
        bpy.ops.render.render()
        return asked["answer"]

    bpy.utils.register_class(ProbeEngine)
    yield render
    bpy.utils.unregister_class(ProbeEngine)


def viewed(question):
    bpy.context.view_layer.update()
    return question(bpy.context.evaluated_depsgraph_get())


@pytest.mark.parametrize("use_modifiers", [True, False])
def test_all_outputs_follow_in_view_and_render(rendered, use_modifiers):
    item = rig(arm(place=Matrix.Translation((3, 1, 2)) @ Matrix.Rotation(0.7, 4, (1, 2, 3))))
    subdivided(item, 1, 2)
    everything(item, use_modifiers)
    watched = Watched(item, use_modifiers)
    roles = {output["saddleback_role"] for output in watched.outputs}
    assert roles == (ROLES | {"surface"} if use_modifiers else ROLES)
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        for ask in (viewed, rendered):
            worst = ask(watched.worst)
            assert max(worst.values()) < SLACK, (frame, ask.__name__, str(worst))


def test_the_smooth_surface_carries_what_was_made_of_a_coarse_cage():
    item = arm()
    everything(item, False)
    watched = Watched(item)
    for levels in (1, 2, 3):
        fine = subdivided(item, levels, levels)
        worst = viewed(watched.worst)
        assert max(worst.values()) < SLACK, (levels, str(worst))
        item.modifiers.remove(fine)
    assert max(viewed(watched.worst).values()) < 1e-4


HARD = Matrix.Translation((30, -20, 10)) @ Matrix.Rotation(0.7, 4, (1, 2, 3)) @ Matrix.Diagonal((1.0, -0.6, 1.4, 1.0))


@pytest.mark.parametrize("place", [Matrix.Identity(4), HARD])
@pytest.mark.parametrize("is_flat", [False, True])
def test_at_rest_all_is_where_it_was_put(place, is_flat):
    item = arm(sides=8, rings=6, place=place)
    if is_flat and bpy.app.version >= (4, 1):
        item.data.normals_split_custom_set_from_vertices([(0.0, 0.6, 0.8)] * len(item.data.vertices))
    everything(item, False)
    for output in bare(item):
        shown = output.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = shown.to_mesh()
        if output.type == "CURVE":
            own = np.array([point.co[:3] for spline in output.data.splines for point in spline.points])
        else:
            own = positions(output.data)
        np.testing.assert_allclose(positions(mesh), own, rtol=0, atol=2e-6)
        shown.to_mesh_clear()


def test_a_run_on_a_posed_body_follows_from_that_pose(rendered):
    item = rig(arm())
    subdivided(item, 1, 2)
    bpy.context.scene.frame_set(FRAMES // 2)
    everything(item, True)
    watched = Watched(item, True)
    for frame in (1, FRAMES // 2, FRAMES):
        bpy.context.scene.frame_set(frame)
        for ask in (viewed, rendered):
            worst = ask(watched.worst)
            assert max(worst.values()) < SLACK, (frame, ask.__name__, str(worst))


def test_what_is_put_on_centers_turns():
    item = arm()
    everything(item, False)
    key = rising(item, lambda place: Matrix.Rotation(1.0, 3, "X") @ place)

    def turns():
        instances = bpy.context.evaluated_depsgraph_get().object_instances
        pins = [i.matrix_world.to_3x3().normalized() for i in instances if i.is_instance and i.object.name == "Pin"]
        return np.array([pin[:] for pin in pins])

    before = turns()
    key.value = 1.0
    bpy.context.view_layer.update()
    assert len(before) == CELLS
    np.testing.assert_allclose(turns(), np.array(Matrix.Rotation(1.0, 3, "X")) @ before, atol=1e-5)


def rising(item, change):
    if item.data.shape_keys is None:
        item.shape_key_add(name="Basis")
    key = item.shape_key_add(name="Changed")
    for point in key.data:
        point.co = change(point.co)
    key.value = 0.0
    bpy.context.view_layer.update()
    return key


def test_a_duplicate_and_a_full_copy_of_the_scene_follow_their_own_body():
    item = rig(arm())
    subdivided(item, 1, 2)
    everything(item, True)
    watched = Watched(item, True)
    for other in bpy.context.view_layer.objects:
        other.select_set(other == item or other in watched.outputs)
    before = set(bpy.data.objects)
    bpy.ops.object.duplicate()
    copies = {}
    for copy in set(bpy.data.objects) - before:
        copies[bpy.data.objects[copy.name.rsplit(".", 1)[0]]] = copy
    key = rising(copies[item], lambda place: place + Vector((0, 0, 3)))
    key.value = 1.0
    assert max(viewed(lambda depsgraph: watched.worst(depsgraph, copies)).values()) < SLACK
    assert max(viewed(watched.worst).values()) < 1e-4
    assert world_height(copies[item]) > 3.9 and world_height(item) < 1.3
    for copy in copies.values():
        bpy.data.objects.remove(copy)
    first = bpy.context.scene
    bpy.ops.scene.new(type="FULL_COPY")
    second = bpy.context.window.scene if bpy.context.window else bpy.data.scenes[-1]
    assert second != first
    copies = {}
    for copy in second.objects:
        copies[bpy.data.objects[copy.name.rsplit(".", 1)[0]]] = copy
    key = rising(copies[item], lambda place: place + Vector((0, 0, 3)))
    key.value = 1.0
    second.view_layers[0].update()
    assert max(watched.worst(second.view_layers[0].depsgraph, copies).values()) < SLACK


def world_height(item):
    return points_of_any(item)[:, 2].max()


def points_of_any(item):
    shown = item.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = shown.to_mesh()
    places = moved(shown.matrix_world, positions(mesh))
    shown.to_mesh_clear()
    return places


def repeated(item, kind):
    modifier = item.modifiers.new("Again", kind)
    if kind == "MIRROR":
        modifier.use_axis, modifier.use_mirror_merge = (True, False, False), False
    bpy.context.view_layer.update()


@pytest.mark.parametrize("is_later", [False, True])
@pytest.mark.parametrize("kind", ["MIRROR", "SOLIDIFY", "ARRAY"])
def test_what_modifiers_repeat_does_not_lead_astray(kind, is_later):
    item = arm()
    if kind == "MIRROR":
        for vertex in item.data.vertices:
            vertex.co.x += 2.0
    if not is_later:
        repeated(item, kind)
    everything(item, False)
    outputs = bare(item)
    before = {output: points_of_any(output) for output in outputs}
    if is_later:
        repeated(item, kind)
    key = rising(item, lambda place: place + Vector((0, 0, 3)))
    key.value = 1.0
    bpy.context.view_layer.update()
    for output in outputs:
        np.testing.assert_allclose(points_of_any(output), before[output] + (0, 0, 3), atol=1e-5)


@pytest.mark.parametrize("kind", ["WIREFRAME", "SCREW"])
def test_faces_between_copies_of_a_vertex_are_no_place_to_stand_on(kind):
    """At rest they have no area, and what was on one flew up to 100,000 units away."""
    item = arm()
    everything(item, False)
    before = {output: points_of_any(output) for output in bare(item)}
    item.modifiers.new("Bars", kind)
    bpy.context.view_layer.update()
    for output, places in before.items():
        np.testing.assert_allclose(points_of_any(output), places, atol=1e-5)


def test_where_following_ends_is_told(capfd):
    item = arm()
    item.modifiers.new("Both", "MIRROR").use_axis = (True, False, False)
    item.modifiers["Both"].use_mirror_merge = False
    for vertex in item.data.vertices:
        vertex.co.x += 2.0
    bpy.ops.saddleback.tessellate(count=20, use_modifiers=True)
    assert "stays where it is" not in "".join(capfd.readouterr())
    subdivided(item, 1, 2)
    bpy.ops.saddleback.tessellate(count=20, use_modifiers=True)
    assert "'Arm': its modifiers repeat faces or make new ones (Both, Fine), so where they" in "".join(
        capfd.readouterr()
    )


def test_all_is_read_before_anything_follows(monkeypatch):
    """Blender would evaluate what follows already, each time that something is read after it."""
    item, seen = arm(), []
    item.modifiers.new("Smooth", "SUBSURF").levels = 1

    def read(mesh):
        seen.append([found.name for found in outputs_of(item) if found.modifiers])
        return own(mesh)

    own = following.read_vertex_normals
    monkeypatch.setattr(following, "read_vertex_normals", read)
    bpy.ops.saddleback.tessellate(count=CELLS, make_cells=True, thickness=0.05, use_modifiers=True)
    assert seen == [[]]


def test_an_artist_s_bevel_stays_seen_and_our_lines_stay_lines():
    item = arm()
    item.data.vertices.foreach_set("select", np.isin(np.arange(len(item.data.vertices)), (0, 90)))
    bpy.ops.saddleback.path(points="SELECTED", path_radius=0.02)
    output = find_output(item, "paths")
    key = rising(item, lambda place: place + Vector((0, 0, 3)))
    key.value = 1.0
    bpy.context.view_layer.update()
    (line,) = polylines_of(output)
    assert line.points[:, 2].min() > 1.7
    output.data.bevel_depth = 0.1
    bpy.context.view_layer.update()
    assert len(points_of_any(output)) >= 8 * len(line.points)


def lines_or_points(output):
    """Where an output is seen, without the tubes of lines."""
    if output.type != "CURVE":
        return points_of_any(output)
    return np.concatenate([line.points for line in polylines_of(output)])


def apply_transform(**what):
    bpy.ops.object.transform_apply(**({"location": False, "rotation": False, "scale": False} | what))


def set_origin():
    bpy.context.scene.cursor.location = (0.0, 0.0, 7.0)
    bpy.ops.object.origin_set(type="ORIGIN_CURSOR")


CHANGES = {
    "all": partial(apply_transform, location=True, rotation=True, scale=True),
    "scale": partial(apply_transform, scale=True),
    "origin": set_origin,
}


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("chosen", ["source", "outputs", "both"])
def test_what_was_made_stays_where_a_transform_is_applied_or_an_origin_set(change, chosen):
    """Blender leaves children where they are; what follows the surface would be transformed twice."""
    item = sphere(subdivisions=3)
    bpy.ops.saddleback.tessellate(count=40, make_dual=True)
    item.location, item.rotation_euler, item.scale = (5.0, 1.0, 2.0), (1.0, 0.5, 0.2), (2.0, 1.0, 1.0)
    bpy.context.view_layer.update()
    bpy.ops.saddleback.tessellate(count=40, make_dual=True, edge_kind="CURVE")
    bpy.context.view_layer.update()
    outputs = [find_output(item, role) for role in ("edges", "dual")]
    before = [lines_or_points(output) for output in outputs]
    for output in outputs:
        output.select_set(chosen != "source")
    item.select_set(chosen != "outputs")
    CHANGES[change]()
    bpy.context.view_layer.update()
    for output, places in zip(outputs, before, strict=True):
        np.testing.assert_allclose(lines_or_points(output), places, atol=1e-5)
        has_scale = output.type == "MESH"  # lines are kept without
        assert follows(output, item) == (not has_scale and (change, chosen) == ("scale", "outputs"))
    assert "follows again once it is made again" in jobs.state.line
    for output in outputs:
        output.select_set(False)
    item.select_set(True)
    bpy.ops.saddleback.tessellate(count=40, make_dual=True, edge_kind="CURVE")
    bpy.context.view_layer.update()
    surface = moved(item.matrix_world, positions(item.data))
    for output in outputs:
        assert follows(output, item)
        np.testing.assert_allclose(lines_or_points(output).mean(axis=0), surface.mean(axis=0), atol=0.1)
    item.data.vertices[0].co *= 1.1
    item.data.update_tag()
    bpy.context.view_layer.update()
    assert all(follows(output, item) for output in outputs)


@pytest.mark.parametrize("order", ["REVERSE", "RANDOMIZE"])
def test_sorted_vertices_lead_nobody_astray(order):
    """Sort Elements gives a source's vertices other numbers: what was made of it stands where it stood."""
    item = sphere()
    item.shape_key_add(name="Basis")
    wide = item.shape_key_add(name="Wide")
    for point in wide.data:
        point.co.x *= 1.5
    bpy.ops.saddleback.tessellate(
        count=20, iterations=2, k=30, make_cells=True, make_centers=True, thickness=0.05, edge_kind="CURVE"
    )
    wide.value = 1.0
    bpy.context.view_layer.update()
    outputs = outputs_of(item)
    assert len(outputs) == 3

    def places():
        bpy.context.view_layer.update()
        return [points_of_any(output) for output in outputs]

    before = places()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.mesh.sort_elements(type=order, elements={"VERT", "FACE"}, seed=1)
    bpy.ops.object.mode_set(mode="OBJECT")
    for was, now in zip(before, places(), strict=True):
        assert np.abs(was - now).max() < 1e-3


def test_what_is_moved_and_not_sorted_is_followed_by_numbers():
    """All of a mesh is moved along itself, so that its places of before are on it, too."""
    item = add_object("Strip", *synthetic_cells.grid(40, 4))
    bpy.ops.saddleback.tessellate(count=20, iterations=2, k=30, make_centers=True)
    before = points_of_any(find_output(item, "centers"))
    for vertex in item.data.vertices:
        vertex.co.x += 0.25
    item.data.update()
    bpy.context.view_layer.update()
    assert np.allclose(before + (0.25, 0.0, 0.0), points_of_any(find_output(item, "centers")), atol=1e-5)
