# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tab, the redo panel, the menu and the manual map offer: few settings, in the unit that is chosen."""

from fnmatch import fnmatchcase
from types import SimpleNamespace

import bpy
import pytest
from scenes import add_object, grid, sphere
from test_modal import press, run_to_end

from saddleback_blender import jobs
from saddleback_blender.core.settings import TessellateSettings, Voronoi2dSettings
from saddleback_blender.ops import redo
from saddleback_blender.ops.tessellate import SADDLEBACK_OT_tessellate
from saddleback_blender.ops.voronoi_2d import SADDLEBACK_OT_voronoi_2d
from saddleback_blender.props import BEGIN, PROPERTIES
from saddleback_blender.ui import menus, panels
from saddleback_blender.ui.panel_parts import SaddlebackPanel
from tests import synthetic_cells

MOST_SETTINGS = 10


class Layout:
    """Notes which settings are drawn in place of drawing."""

    def __init__(self, drawn):
        self.__dict__["drawn"] = drawn
        self.__dict__["labels"] = []

    def __setattr__(self, name, value):
        pass

    def prop(self, settings, name, **_):
        if settings.bl_rna.identifier.startswith("Saddleback"):
            self.drawn.append(name)

    def prop_search(self, settings, name, *_, **__):
        self.prop(settings, name)

    def template_ID(self, settings, name, **_):  # noqa: N802 - Blender's name
        self.prop(settings, name)

    def operator(self, *_, **__):
        return type("Button", (), {})()

    def template_list(self, *_, **__):
        pass

    popover = template_list

    def label(self, text="", **_):
        self.labels.append(text)

    progress = separator = menu = template_list

    def row(self, **_):
        return self

    column = box = split = grid_flow = row


def drawn_by(panel, is_opened=False):
    """Settings that a panel draws, its header's switch among them, as it is at first or opened by hand."""
    return draw(panel, is_opened).drawn


def draw(panel, is_opened=False):
    layout = Layout([])
    pretended = SimpleNamespace(layout=layout, split_layout=lambda _: layout, switch=getattr(panel, "switch", ""))
    context = SimpleNamespace(
        window_manager=bpy.context.window_manager,
        view_layer=bpy.context.view_layer,
        space_data=SimpleNamespace(shading=SimpleNamespace(type="WIREFRAME")),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
        region=None,
    )
    if hasattr(panel, "draw_header"):
        panel.draw_header(pretended, context)
    is_closed = "DEFAULT_CLOSED" in getattr(panel, "bl_options", set()) and hasattr(panel, "bl_parent_id")
    if is_opened or not is_closed or panel.bl_parent_id == "SADDLEBACK_PT_main":
        panel.draw(pretended, context)
    return layout


@pytest.mark.parametrize("name", list(PROPERTIES))
@pytest.mark.parametrize("painted", [False, True])
def test_at_most_ten_settings_are_shown_before_advanced(name, painted):
    item = sphere()
    if painted and "density_source" in PROPERTIES[name]:
        getattr(item.saddleback, name).density_source = "VERTEX_GROUP"
    top = next(panel for panel in panels.CLASSES if panel.__name__ == f"SADDLEBACK_PT_{name}")
    family = [top, *(panel for panel in panels.CLASSES if getattr(panel, "bl_parent_id", "") == top.__name__)]
    shown = [setting for panel in family for setting in drawn_by(panel, panel is top)]
    assert len(shown) == len(set(shown)) and shown
    assert len(shown) <= MOST_SETTINGS, shown


@pytest.mark.parametrize("name", list(PROPERTIES))
def test_every_setting_is_in_the_panels_somewhere_open_or_closed(name):
    item = sphere()
    group = getattr(item.saddleback, name)
    shown = set()
    for source in ("UNIFORM", "DISTANCE", "IMAGE") if "density_source" in PROPERTIES[name] else ("",):
        for unit in ("RELATIVE", "ABSOLUTE") if "lengths" in PROPERTIES[name] else ("",):
            if source:
                group.density_source = source
            if unit:
                group.lengths = unit
            for panel in (panel for panel in panels.CLASSES if issubclass(panel, SaddlebackPanel)):
                closed = set(getattr(panel, "bl_options", set()))
                panel.bl_options = set()
                try:
                    shown |= set(drawn_by(panel))
                finally:
                    panel.bl_options = closed
    # What is asked for only where another setting wants it.
    dependent = {
        "tessellate": {
            "sites_object",
            "relax_sites",
            "cell_size",
            "patch_error",
            "rib_width_mm",
            "rib_thickness_mm",
            "base_height_mm",
        },
        "distance": {"sources_group", "sources_collection", "sources_object", "isoline_spacing"},
        "path": {"points_group", "points_collection", "connect", "from_cursor"},
        "ribbon": {"curves_collection", "image_name", "ribbon_object"},
        "voronoi_2d": {
            "uv_name",
            "sites_object",
            "image_name",
            "image_invert",
            "weights_name",
            "relax_sites",
            "circles_collection",
            "circle_count",
        },
        "direction_field": {
            "strokes_object",
            "strokes_collection",
            "singularities_collection",
            "align_weight",
            "painted_attribute",
            "painted_color",
            "painted_image",
        },
        "distribute": {
            "shapes_collection",
            "shapes_image",
            "direction_attribute",
            "direction_color",
            "direction_image",
        },
        "bake": {"direction_attribute"},
        "repair": set(),
    }[name]
    dependent |= {"look", "region_name", "barriers_name"}  # which has buttons of its own; which other settings need
    assert set(PROPERTIES[name]) - dependent <= shown


@pytest.mark.parametrize("name", list(PROPERTIES))
def test_the_redo_panel_has_six_rows_at_most_in_the_unit_that_is_chosen(name):
    values = {key: prop.keywords.get("default") for key, prop in PROPERTIES[name].items()}
    for unit in ("ABSOLUTE", "RELATIVE"):
        for outputs in (False, True):
            made = {key: outputs for key in values if key.startswith("make_")}
            operator = type("Operator", (), values | made | {"lengths": unit})()
            rows = redo.rows_of(operator, name)
            assert len(rows) <= redo.MOST_ROWS and set(rows) <= set(values)
            assert not any(key.endswith("_share") for key in rows) or unit == "RELATIVE"
            if not outputs:
                assert not any(key.startswith(("edge_", "rib_", "isoline_", "streamline_")) for key in rows)


@pytest.mark.parametrize(("look", "words"), [("STUDS", "416 shapes"), ("BANDS", "23 isolines"), ("PANELS", "")])
def test_what_a_look_made_stands_in_a_panel_that_is_open(look, words):
    sphere()
    bpy.ops.saddleback.apply_look(look=look)
    told = " ".join(draw(panels.SADDLEBACK_PT_main).labels)
    assert words in told and "cells" not in told
    below = next(panel for panel in panels.CLASSES if panel.__name__ == "SADDLEBACK_PT_tessellate")
    assert ("200 cells" in " ".join(draw(below, True).labels)) == (look == "PANELS")


def test_what_stippling_an_image_made_stands_there_too(tmp_path):
    image = bpy.data.images.new("Spot", 8, 8)
    image.filepath_raw, image.file_format = str(tmp_path / "spot.png"), "PNG"
    image.save()
    bpy.ops.saddleback.stipple_image(filepath=image.filepath_raw, count=30)
    assert "30 " in " ".join(draw(panels.SADDLEBACK_PT_main).labels)


def test_evenness_stands_for_iterations_annealing_and_starts():
    settings = sphere().saddleback.tessellate
    assert settings.evenness == "EVEN"
    settings.evenness = "PERFECT"
    assert (settings.iterations, settings.annealing, settings.starts) == (60, 200, 1)
    settings.iterations = 61
    assert settings.evenness == "CUSTOM"
    settings.evenness = "CUSTOM"
    assert settings.iterations == 61
    settings.evenness = "QUICK"
    assert (settings.iterations, settings.annealing) == (5, 0)


def test_the_menu_and_the_manual_name_operators_and_pages_that_are_there(request):
    for name in (entry[0] for entry in menus.ENTRIES if entry):
        assert hasattr(bpy.types, f"SADDLEBACK_OT_{name}"), name
    pages = request.config.rootpath / "docs/manual"
    url, patterns = menus.manual_map()
    assert url.endswith("/")
    assert all((pages / page).is_file() for _, page in patterns)
    for group in menus.GROUPS:
        assert bpy.types.PropertyGroup.bl_rna_get_subclass_py(group) is not None, group

    def page_of(identifier):  # as Blender looks them up
        return next(page for pattern, page in patterns if fnmatchcase(identifier.lower(), pattern.lower()))

    assert page_of("bpy.ops.saddleback.tessellate") == page_of("bpy.types.SaddlebackTessellateProps.count")
    assert (
        page_of("bpy.ops.saddleback.distribute") == "shapes.md" and page_of("bpy.ops.saddleback.clear") == "README.md"
    )


def told(kind, settings, **options):
    operator, context = press(kind, settings, **options)
    operator.invoke(context, None)
    return run_to_end(operator, context), operator


def test_the_space_of_a_diagram_is_found():
    assert BEGIN["voronoi_2d"]["space"] == "AUTO"
    few = {"count": 30, "iterations": 2}
    grid()
    assert told(SADDLEBACK_OT_voronoi_2d, Voronoi2dSettings(), **few)[0] == {"FINISHED"}
    bowl = sphere()
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for vertex in bowl.data.vertices:
        vertex.select = vertex.co.z > 0.5
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.delete(type="VERT")
    bpy.ops.object.mode_set(mode="OBJECT")
    assert told(SADDLEBACK_OT_voronoi_2d, Voronoi2dSettings(), **few)[0] == {"FINISHED"}  # a disk
    add_object("Closed", *synthetic_cells.sphere(2))
    result, operator = told(SADDLEBACK_OT_voronoi_2d, Voronoi2dSettings(), **few)
    assert result == {"CANCELLED"} and "Tessellate makes cells of any surface" in operator.messages[-1][1]


def test_chosen_sites_stay_when_the_panel_begins_with_iterations():
    item = grid()
    seeds = add_object("Seeds", [(0.2, 0.3, 0), (0.7, 0.6, 0), (0.4, 0.8, 0)], [(0, 1, 2)], active=False)
    item.saddleback.voronoi_2d.sites_object = seeds
    options = {"sites_source": "OBJECT", "sites_object": seeds.name, "make_centers": True}
    assert told(SADDLEBACK_OT_voronoi_2d, Voronoi2dSettings(), **options)[0] == {"FINISHED"}
    assert item.saddleback.voronoi_2d.iterations == 15
    centers = bpy.data.objects[f"{item.name} Voronoi Centers"]
    places = sorted(tuple(round(value, 3) for value in vertex.co.xy) for vertex in centers.data.vertices)
    assert places == [(0.2, 0.3), (0.4, 0.8), (0.7, 0.6)]


def test_what_a_zero_left_to_the_run_is_told():
    sphere()
    few = {"count": 20, "iterations": 2, "k": 30, "make_shell": True, "lengths": "ABSOLUTE"}
    assert told(SADDLEBACK_OT_tessellate, TessellateSettings(), **few)[0] == {"FINISHED"}
    line = next(line for line in jobs.state.figures if line.startswith("Automatic: "))
    assert line.startswith("Automatic: Rib Width 0.0") and "Rib Thickness 0.0" in line
    assert told(SADDLEBACK_OT_tessellate, TessellateSettings(), **few, rib_width=0.05, rib_thickness=0.04)[0]
    assert not any(line.startswith("Automatic") for line in jobs.state.figures)


def test_cells_can_be_asked_for_by_their_size():
    item = sphere()
    area = sum(polygon.area for polygon in item.data.polygons)
    options = {"sites_source": "SIZE", "cell_size": (area / 50) ** 0.5, "iterations": 2, "k": 30}
    bpy.ops.saddleback.tessellate(**options)
    assert jobs.state.line.startswith(f"'{item.name}': 50 cells")
    bpy.ops.saddleback.tessellate()
    assert jobs.state.line.startswith(f"'{item.name}': 50 cells")  # the size is kept, not the number
    with pytest.raises(RuntimeError, match=r"would have .* cells of size 1e-05; make them larger"):
        bpy.ops.saddleback.tessellate(**options | {"cell_size": 1e-5})
