# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pictures of the documentation from the demo's chameleon: after blend-samples/run, call

    .cache/bpy-4.5/bin/python docs/images/make_pictures.py [NAME ...]

Names are the functions below whose docstring begins with "Picture".
"""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "blend-samples/scene"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "addon"))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "build/python"))

import looks
import palette
import studio
import subject as models

ROOT = Path(__file__).resolve().parents[2]
ROLE = "saddleback_role"
PAINT = "Cell density"
WIDTH, HEIGHT, SAMPLES = 660, 440, 6


def start() -> bpy.types.Object:
    """The chameleon as an artist has it before the first press of a button."""
    body = models.open_subject(ROOT / "blend-samples" / "out" / "creature.blend", "z")
    bpy.ops.preferences.addon_enable(module="saddleback_blender")
    for child in body.children:
        looks.dress_child(child)
    return body


def shoot(body: bpy.types.Object, name: str) -> None:
    """Lights, renders, saves docs/images/NAME.jpg."""
    scene = bpy.context.scene
    family = [body, *(child for child in body.children if child.type == "MESH" and ROLE not in child)]
    studio.add_to(scene, np.concatenate([models.positions(item) for item in family]), WIDTH / HEIGHT)
    studio.use_cycles(scene, WIDTH, HEIGHT, SAMPLES)
    scene.render.image_settings.file_format = "JPEG"
    scene.render.image_settings.quality = 88
    scene.render.filepath = str(ROOT / "docs" / "images" / f"{name}.jpg")
    bpy.ops.render.render(write_still=True)
    print(f"-- {scene.render.filepath}", flush=True)


def ramp_material(
    name: str, attribute: str, stops: list[tuple[float, str]], scale: float, lines: float = 0.0
) -> bpy.types.Material:
    """Color by a vertex attribute divided by `scale`; with `lines`, dark isolines at that spacing."""
    material = studio.principled(name, (0.5, 0.5, 0.5), Roughness=0.5, Specular=0.3)
    tree = material.node_tree
    shader = tree.nodes["Principled BSDF"]
    value = tree.nodes.new("ShaderNodeAttribute")
    value.attribute_name = attribute
    divide = tree.nodes.new("ShaderNodeMath")
    divide.operation, divide.inputs[1].default_value = "DIVIDE", scale
    ramp = tree.nodes.new("ShaderNodeValToRGB")
    while len(ramp.color_ramp.elements) < len(stops):
        ramp.color_ramp.elements.new(0.5)
    for element, (position, code) in zip(ramp.color_ramp.elements, stops, strict=True):
        element.position, element.color = position, (*palette.linear([code])[0], 1)
    tree.links.new(value.outputs["Fac"], divide.inputs[0])
    tree.links.new(divide.outputs[0], ramp.inputs["Fac"])
    color = ramp.outputs["Color"]
    if lines:
        wave = tree.nodes.new("ShaderNodeMath")
        wave.operation, wave.inputs[1].default_value = "PINGPONG", lines / 2
        thin = tree.nodes.new("ShaderNodeMath")
        thin.operation, thin.inputs[1].default_value = "LESS_THAN", 0.07 * lines
        mix = tree.nodes.new("ShaderNodeMixRGB")
        mix.inputs["Color2"].default_value = (0.015, 0.02, 0.05, 1)
        tree.links.new(value.outputs["Fac"], wave.inputs[0])
        tree.links.new(wave.outputs[0], thin.inputs[0])
        tree.links.new(thin.outputs[0], mix.inputs["Fac"])
        tree.links.new(color, mix.inputs["Color1"])
        color = mix.outputs["Color"]
    tree.links.new(color, shader.inputs["Base Color"])
    return material


def tessellate(**settings: object) -> None:
    """The operator, with what all pictures share."""
    shared = {"count": 900, "seed": 7, "iterations": 15, "k": 40, "edge_radius": 0.006}
    bpy.ops.saddleback.tessellate(**(shared | settings))


def output(body: bpy.types.Object, role: str) -> bpy.types.Object:
    """What the add-on made."""
    return next(child for child in body.children if child.get(ROLE) == role)


def clay(body: bpy.types.Object, **settings: object) -> None:
    """Cells as dark lines on plain clay."""
    tessellate(**settings)
    body.data.materials.append(studio.principled("Clay", (0.62, 0.50, 0.40), Roughness=0.6))


def paint(body: bpy.types.Object) -> None:
    """Picture: what was painted, in weight paint's colors."""
    weights = np.zeros(len(body.data.vertices), np.float32)
    group = body.vertex_groups[PAINT].index
    for vertex in body.data.vertices:
        weights[vertex.index] = next((item.weight for item in vertex.groups if item.group == group), 0)
    body.data.attributes.new("shown", "FLOAT", "POINT").data.foreach_set("value", weights)
    stops = [(0.0, "#2438b8"), (0.25, "#22b6c9"), (0.5, "#3fbf4d"), (0.75, "#f2d02c"), (1.0, "#e2362b")]
    body.data.materials.append(ramp_material("Paint", "shown", stops, 1.0))


def even(body: bpy.types.Object) -> None:
    """Picture: cells of even size."""
    clay(body)


def painted(body: bpy.types.Object) -> None:
    """Picture: as many cells, small where the density is high."""
    clay(body, density_source="VERTEX_GROUP", density_name=PAINT)


def random(body: bpy.types.Object) -> None:
    """Picture: cells of sites as chance puts them, before the first iteration."""
    clay(body, iterations=0)


def cells(body: bpy.types.Object) -> None:
    """Picture: the cells as a mesh, with gap, inset and thickness, in the colors that the add-on gives them."""
    tessellate(make_edges=False, make_cells=True, gap=0.014, inset=0.012, thickness=0.012,
               density_source="VERTEX_GROUP", density_name=PAINT)  # fmt: skip
    body.data.materials.append(looks.grout())


def centers(body: bpy.types.Object) -> None:
    """Picture: an object on every center, as large as its cell."""
    stud = looks.make_stud(looks.gold())
    tessellate(make_edges=False, make_centers=True, instance_object=stud.name, instance_scale=0.75,
               density_source="VERTEX_GROUP", density_name=PAINT)  # fmt: skip
    body.data.materials.append(studio.principled("Clay", (0.10, 0.16, 0.20), Roughness=0.5))


def dual(body: bpy.types.Object) -> None:
    """Picture: the dual mesh, with its edges drawn."""
    tessellate(make_edges=False, make_dual=True)
    mesh = output(body, "dual")
    mesh.data.polygons.foreach_set("use_smooth", np.zeros(len(mesh.data.polygons), bool))
    mesh.data.materials.clear()
    mesh.data.materials.append(studio.principled("Clay", (0.62, 0.50, 0.40), Roughness=0.6))
    wires = mesh.modifiers.new("Wires", "WIREFRAME")
    wires.use_replace, wires.thickness, wires.material_offset = False, 0.006, 1
    mesh.data.materials.append(studio.principled("Wires", (0.03, 0.03, 0.04), Roughness=0.5))
    body.hide_render = True


def shell(body: bpy.types.Object) -> None:
    """Picture: the lamp shell alone."""
    tessellate(make_edges=False, make_shell=True, count=350, rib_width=0.022, rib_thickness=0.02)
    solid = output(body, "shell").data
    solid.materials.clear()
    solid.materials.append(studio.principled("Print", (0.42, 0.10, 0.05), Roughness=0.45))
    body.hide_render = True


def strokes_of(body: bpy.types.Object) -> bpy.types.Object:
    """The curves that the model was given, shown in red."""
    strokes = next(child for child in body.children if child.type == "CURVE")
    strokes.data.bevel_depth = 0.012
    strokes.data.materials.append(looks.red_ink())
    return strokes


def fields_strokes(body: bpy.types.Object) -> None:
    """Picture: streamlines of a field that follows strokes."""
    strokes_of(body)
    bpy.ops.saddleback.direction_field(
        strokes="COLLECTION", make_arrows=False, make_streamlines=True, streamline_spacing=0.05, streamline_radius=0.006
    )
    body.data.materials.append(looks.clay())


def fields_arrows(body: bpy.types.Object) -> None:
    """Picture: the same field as arrows, with its singularities."""
    bpy.ops.saddleback.direction_field(strokes="COLLECTION", arrow_count=3000, arrow_length=0.072)
    body.data.materials.append(looks.clay())


def fields_curvature(body: bpy.types.Object) -> None:
    """Picture: crosses along the principal directions, as streamlines both ways."""
    bpy.ops.saddleback.direction_field(
        symmetry="4", align="CURVATURE", align_weight=0.4, make_arrows=False, make_streamlines=True,
        streamline_spacing=0.06, streamline_radius=0.005,
    )  # fmt: skip
    body.data.materials.append(looks.clay())


def lay(body: bpy.types.Object, shapes: str, **settings: object) -> None:
    """Shapes along the strokes' field, in the colors that the add-on gives them, on dark skin."""
    bpy.ops.saddleback.direction_field(strokes="COLLECTION", make_arrows=False)
    bpy.ops.saddleback.distribute(shapes=shapes, seed=7, **settings)
    body.data.materials.append(looks.skin())


def shapes_mosaic(body: bpy.types.Object) -> None:
    """Picture: tiles of three kinds, side by side."""
    lay(body, "MOSAIC", count=2200)


def shapes_leaves(body: bpy.types.Object) -> None:
    """Picture: leaves of two sizes."""
    lay(body, "LEAVES", count=2600, size=0.05, size_variation=0.15, packing=0.0)


def shapes_studs(body: bpy.types.Object) -> None:
    """Picture: studs, small where the density was painted."""
    lay(body, "STUDS", count=1800, size=0.024, packing=0.0, size_by_density=True, density_source="VERTEX_GROUP",
        density_name=PAINT)  # fmt: skip
    body.data.materials.clear()
    body.data.materials.append(studio.principled("Leather", (0.10, 0.035, 0.015), Roughness=0.55))
    output(body, "shapes").data.materials[0].user_remap(looks.gold())


def distance(body: bpy.types.Object) -> None:
    """Picture: the distance from the tip of the nose along the skin, a line every fifth of a unit."""
    nose = int(np.argmax(models.positions(body)[:, 0]))
    body.vertex_groups.new(name="Nose").add([nose], 1.0, "REPLACE")
    bpy.ops.saddleback.distance(sources="VERTEX_GROUP", sources_group="Nose", k=40)
    values = looks.read(body.data, "saddleback_distance", "POINT", 1)
    stops = [(0.0, "#fff3c4"), (0.2, "#f6b04e"), (0.45, "#e2574c"), (0.7, "#8e3a80"), (1.0, "#2b2a6b")]
    body.data.materials.append(ramp_material("Distance", "saddleback_distance", stops, float(values.max()), 0.2))


def paths(body: bpy.types.Object) -> None:
    """Picture: isolines from the nose, and the shortest paths from tip to tip."""
    places = models.positions(body)
    nose = int(np.argmax(places[:, 0]))
    chosen = np.zeros(len(places), bool)
    chosen[nose] = True
    body.data.vertices.foreach_set("select", chosen)
    bpy.ops.saddleback.distance(
        make_isolines=True, isolines_by="SPACING", isoline_spacing=0.15, isoline_radius=0.003, make_preview=True,
        preview_lines=False,
    )  # fmt: skip
    distances = looks.read(body.data, "saddleback_distance", "POINT", 1)
    tail = int(np.argmax(np.where(np.isfinite(distances), distances, -1)))
    crest = int(np.argmax(places[:, 2]))
    along = (places[:, 0] - places[:, 0].min()) / np.ptp(places[:, 0])
    feet = []
    for begin, end in ((0.28, 0.45), (0.58, 0.75)):  # hind and fore, on the side of the camera
        side = np.flatnonzero((along > begin) & (along < end) & (places[:, 1] < 0))
        feet.append(int(side[np.argmin(places[side, 2])]))
    body.vertex_groups.new(name="Tips").add([nose, tail, crest, *feet], 1.0, "REPLACE")
    bpy.ops.saddleback.path(points="VERTEX_GROUP", points_group="Tips", connect="PAIRS", path_radius=0.011, lift=0.004)


def main() -> None:
    """Makes the pictures that are named, or all."""
    everything = {k: f for k, f in globals().items() if callable(f) and (f.__doc__ or "").startswith("Picture")}
    for name in sys.argv[1:] or everything:
        body = start()
        everything[name](body)
        own_page = name in ("distance", "paths") or name.startswith(("fields_", "shapes_"))
        shoot(body, name.replace("_", "-") if own_page else f"tessellation-{name}")


main()
