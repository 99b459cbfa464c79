# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds what a run is asked to do: one frozen dataclass for each operator, field for field its properties."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class RegionSettings:
    """Holds which part of the object a layer covers: the properties that all have which make patterns."""

    region: str = "WHOLE"  # WHOLE, VERTEX_GROUP, ATTRIBUTE, FACES, MATERIAL
    region_name: str = ""  # of the group, attribute or material


@dataclass(frozen=True)
class BarrierSettings:
    """Holds what is not crossed: the properties of operators that measure distances."""

    barriers: str = "NONE"  # NONE, SEAMS, SHARP, ATTRIBUTE
    barriers_name: str = ""  # of the attribute of edges or faces


@dataclass(frozen=True)
class PatternSettings(RegionSettings):
    """And whether the pattern is mirrored."""

    mirror_x: bool = False  # the same to both sides of the object's own X


@dataclass(frozen=True)
class DensitySettings:
    """Holds where cells or shapes are small: the properties that several operators share."""

    density_source: str = "UNIFORM"
    # UNIFORM, VERTEX_GROUP, ATTRIBUTE, COLOR, MASK, IMAGE, CURVATURE, DISTANCE, SPREAD
    density_name: str = ""  # vertex group, attribute or UV map; "" = the active one
    density_channel: str = "LUMINANCE"  # LUMINANCE, R, G, B, A
    density_image: str = ""
    density_object: str = ""  # the curve of DISTANCE
    density_collection: str = ""  # of curves; "" = those parented to the object
    density_reach: float = 0.0  # of the curve; 0 = by the surface's extent
    density_beyond: float = 0.1  # the density there, to 1 at the curve
    density_invert: bool = False
    density_contrast: float = 1.0
    density_smaller_by: float = 0.0  # cells are by this smaller where the paint is full; 0 = the density is the paint


@dataclass(frozen=True)
class TessellateSettings(DensitySettings, PatternSettings, BarrierSettings):
    """All properties of `saddleback.tessellate`; lengths are world units, shares percent of a cell's size.

    Objects are given by name ("" = none).
    """

    count: int = 200
    seed: int = 0
    method: str = "LBFGS"  # LBFGS, LLOYD
    iterations: int = 15
    stretch: float = 1.0  # cells are so many times as long along the object's direction field as they are wide
    follow_curvature: float = 0.0  # 1: cells are small where the surface bends, and short across ridges
    starts: int = 1  # relaxations from so many samples; the best is taken
    annealing: int = 0  # steps in which the sites are shaken before the iterations
    sites_source: str = "COUNT"  # COUNT, SIZE, SELECTED, OBJECT
    cell_size: float = 0.1  # of SIZE: the side of a square of the mean cell's area
    sites_object: str = ""
    relax_sites: bool = False  # move chosen sites too (those of COUNT always move)
    # Lines on which some sites of COUNT stay:
    hold_sharp: bool = False  # edges at which the surface bends by more than the angle
    sharp_angle: float = math.radians(40.0)
    hold_marked: bool = False  # edges that are marked sharp or as seams, or creased
    hold_boundary: bool = False
    quality: str = "NORMAL"  # FAST, NORMAL, FINE
    k: int = 0  # vertices in a neighborhood of the graph; 0 = by quality
    cache_on_disk: bool = False
    use_modifiers: bool = False
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the shares
    make_edges: bool = True
    edge_kind: str = "MESH"  # MESH, CURVE
    edge_radius: float = 0.01
    edge_radius_share: float = 4.0
    make_cells: bool = False
    gap: float = 0.0
    gap_share: float = 8.0
    inset: float = 0.0
    inset_share: float = 10.0
    thickness: float = 0.0
    thickness_share: float = 8.0
    dome: float = 0.0  # 0: a plateau; 1: round from the rim to the middle
    # Vertex groups or attributes by which the three are multiplied, as they are where each cell's site is; "" = none:
    gap_by: str = ""
    inset_by: str = ""
    thickness_by: str = ""
    underside: bool = False
    local_uv: bool = False
    # SURFACE = as many as the surface has, ONE = a polygon for each cell, PATCHES = as few polygons as the error needs
    cell_faces: str = "SURFACE"
    patch_error: float = 1.0  # of PATCHES, in percent of the surface's extent
    make_centers: bool = False
    instance_object: str = ""
    instance_dots: bool = False  # a dot on each center, where no object is chosen
    instance_size: str = "CELL"  # EQUAL, CELL, TONE = by the darkness of the image, or by the density
    instance_scale: float = 1.0
    make_dual: bool = False
    dual_faces: str = "TRIANGLES"  # TRIANGLES, QUADS
    dual_policy: str = "REPAIR"  # REPAIR, STRICT
    keep_count: bool = True  # of vertices of the dual mesh: one for each cell wherever that can be
    make_shell: bool = False
    rib_width: float = 0.0  # 0 = by the cells' size
    rib_width_share: float = 12.5
    rib_thickness: float = 0.0  # 0 = as wide
    rib_thickness_share: float = 12.5
    base_height: float = 0.0  # all is solid up to so far above the lowest point
    base_height_share: float = 0.0
    in_millimeters: bool = False  # the three lengths of the shell, whatever the unit of others
    rib_width_mm: float = 2.0
    rib_thickness_mm: float = 2.0
    base_height_mm: float = 0.0
    rib_profile: str = "SQUARE"  # SQUARE, ROUND
    shell_faces: int = 0  # about so many triangles at most; 0 = as many as there are
    cell_attribute: str = "saddleback_cell"
    distance_attribute: str = "saddleback_distance"
    density_attribute: str = "saddleback_density"
    write_edge_distance: bool = False
    edge_distance_attribute: str = "saddleback_edge_distance"
    look: str = "NONE"  # whose colors and material what is made has

    @property
    def makes_polygons(self) -> bool:
        """Tells whether what is made has one polygon each."""
        return self.make_cells and self.cell_faces != "SURFACE"

    @property
    def makes_patches(self) -> bool:
        """Tells whether polygons are patches by an error in place of the cells."""
        return self.make_cells and self.cell_faces == "PATCHES"


@dataclass(frozen=True)
class DistanceSettings(RegionSettings, BarrierSettings):
    """All properties of `saddleback.distance`; lengths are world units, objects are given by name ("" = none)."""

    sources: str = "SELECTED"  # SELECTED, VERTEX_GROUP, EMPTIES, CURVES, CURSOR, CURSOR_PARTS
    sources_group: str = ""
    sources_collection: str = ""
    sources_object: str = ""  # the curve object of CURVES
    limit: float = 0.0  # no distance beyond it; 0 = none
    quality: str = "NORMAL"  # FAST, NORMAL, FINE, EXACT
    k: int = 0  # vertices in a neighborhood of the graph; 0 = by quality
    cache_on_disk: bool = False
    use_modifiers: bool = False
    make_isolines: bool = False
    isolines_by: str = "COUNT"  # COUNT, SPACING
    isoline_count: int = 10
    isoline_spacing: float = 0.1
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the share, in percent of the model's extent
    isoline_radius: float = 0.005
    isoline_radius_share: float = 0.25
    make_preview: bool = False
    preview_lines: bool = True
    distance_attribute: str = "saddleback_distance"
    look: str = "NONE"


@dataclass(frozen=True)
class PathSettings(RegionSettings, BarrierSettings):
    """All properties of `saddleback.path`; lengths are world units."""

    points: str = "SELECTED"  # SELECTED, VERTEX_GROUP, EMPTIES, CURSOR
    points_group: str = ""
    points_collection: str = ""
    from_cursor: bool = False  # the 3D cursor is a point, too: the first
    connect: str = "CHAIN"  # CHAIN, LOOP, PAIRS
    smooth: bool = False  # of chains: without corners at their points
    tighten: bool = False  # of a closed chain: to a closed geodesic
    shorten: bool = True
    quality: str = "NORMAL"  # FAST, NORMAL, FINE, EXACT
    k: int = 0  # vertices in a neighborhood of the graph; 0 = by quality
    cache_on_disk: bool = False
    use_modifiers: bool = False
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the shares, in percent of the model's extent
    path_radius: float = 0.01
    path_radius_share: float = 0.4
    lift: float = 0.0  # how far above the surface
    lift_share: float = 0.0


@dataclass(frozen=True)
class RibbonSettings(RegionSettings, BarrierSettings):
    """All properties of `saddleback.ribbon`; lengths are world units, objects are given by name ("" = none)."""

    curves_object: str = ""
    curves_collection: str = ""  # "" = the curves parented to the object
    show: str = "BAND"  # BAND, IMAGE, OBJECT
    image_name: str = ""
    ribbon_object: str = ""
    repeat: str = "REPEAT"  # REPEAT = as often as keeps the proportions, STRETCH = once
    use_modifiers: bool = False
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the shares, in percent of the model's extent
    width: float = 0.2
    width_share: float = 6.0
    lift: float = 0.005  # how far above the surface
    lift_share: float = 0.15


@dataclass(frozen=True)
class Voronoi2dSettings(RegionSettings):
    """All properties of `saddleback.voronoi_2d`; lengths are world units, objects are given by name ("" = none)."""

    space: str = "OUTLINE"  # AUTO, OUTLINE, UV, DISK
    uv_name: str = ""  # the UV map; "" = the active one
    sites_source: str = "COUNT"  # COUNT, SELECTED, OBJECT, IMAGE
    count: int = 200  # of COUNT and IMAGE
    seed: int = 0
    sites_object: str = ""
    image_name: str = ""
    image_invert: bool = False  # cells are small where the image is light
    weights_name: str = ""  # attribute of the vertices that are sites; "" = all weigh the same
    iterations: int = 0
    relax_sites: bool = True  # move chosen sites too (those of COUNT and IMAGE always move)
    equal_cells: bool = False  # all of one area, or of one share of the image's tone
    seamless: bool = False  # opposite sides of a rectangle are one
    use_modifiers: bool = False
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the shares, in percent of a cell's size
    make_edges: bool = True
    edge_kind: str = "MESH"  # MESH, CURVE
    edge_radius: float = 0.01
    edge_radius_share: float = 4.0
    make_cells: bool = True
    gap: float = 0.0
    gap_share: float = 8.0
    inset: float = 0.0
    inset_share: float = 10.0
    thickness: float = 0.0
    thickness_share: float = 8.0
    underside: bool = False
    make_centers: bool = False
    instance_object: str = ""
    instance_dots: bool = False  # a dot on each center, where no object is chosen
    instance_size: str = "CELL"  # EQUAL, CELL, TONE = by the darkness of the image, or by the density
    instance_scale: float = 1.0
    animate: bool = False
    circles: str = "MIDDLE"  # of the sweep: MIDDLE = one, CURSOR = one, EMPTIES, COUNT
    circles_collection: str = ""  # "" = the empties parented to the object
    circle_count: int = 9
    frame_start: int = 1
    frame_end: int = 120


@dataclass(frozen=True)
class DirectionFieldSettings(RegionSettings):
    """All properties of `saddleback.direction_field`; lengths are world units, "" is no object or collection."""

    symmetry: str = "1"  # 1 = vectors, 2 = lines, 4 = crosses
    align: str = "NONE"  # NONE, CURVATURE, BOUNDARY
    align_weight: float = 1.0
    strokes: str = "NONE"  # NONE, ANNOTATIONS, OBJECT, COLLECTION
    strokes_object: str = ""
    strokes_collection: str = ""  # "" = those parented to the object
    hard_strokes: bool = False  # all of them, not only those with "hard" in their name
    stroke_weight: float = 1.0  # of soft ones
    stroke_reach: float = 0.0  # what of a stroke is farther from the surface is left out; 0 = by the surface's extent
    painted: str = "NONE"  # NONE, ATTRIBUTE, COLOR, IMAGE
    painted_attribute: str = ""
    painted_color: str = ""  # "" = the active one
    painted_image: str = ""
    painted_weight: float = 1.0
    singularities: str = "AUTO"  # AUTO, EMPTIES
    singularities_collection: str = ""  # "" = those parented to the object
    turn: float = 0.0  # radians, counter-clockwise
    use_modifiers: bool = False
    domain: str = "POINT"  # POINT, FACE
    direction_attribute: str = "saddleback_direction"
    make_arrows: bool = True
    arrow_count: int = 1500
    arrow_length: float = 0.0  # 0 = by their number
    make_streamlines: bool = False
    streamline_spacing: float = 0.0  # 0 = by the surface's extent
    streamline_length: float = 0.0  # 0 = by the spacing
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the share, in percent of the model's extent
    streamline_radius: float = 0.005
    streamline_radius_share: float = 0.2
    seed: int = 0


@dataclass(frozen=True)
class DistributeSettings(DensitySettings, PatternSettings):
    """All properties of `saddleback.distribute`; lengths are world units, "" is no object, collection or layer."""

    shapes: str = "SCALES"  # COLLECTION, IMAGE, SCALES, STUDS, FEATHERS, LEAVES, MOSAIC
    shapes_collection: str = ""
    shapes_image: str = ""
    count: int = 500
    size: float = 0.0  # radius of the circle around the largest shapes; 0 = by the count
    size_variation: float = 0.0  # by which share of the largest the smallest are smaller
    size_by_density: bool = False  # small where the density is high, instead of by chance
    lengths: str = "ABSOLUTE"  # ABSOLUTE, RELATIVE = by the shares, in percent of the place of a shape
    gap: float = 0.0
    gap_share: float = 0.0
    overlap: float = 0.0  # share of their length by which shapes reach over those before them
    tilt: float = math.radians(14.0)  # of shapes that overlap: how steeply they rise to their tips
    no_crossings: bool = False  # shapes that overlap are drawn so that none passes through another
    fill_gaps: bool = False  # small copies where these leave skin bare
    packing: float = 1.0  # 0 = by chance, 1 = side by side
    maximal: bool = False  # go on until nothing more fits, whatever the count
    mirror: bool = False  # half of them
    bend: bool = False  # along the field, unless they fill the surface
    seed: int = 0
    field_source: str = "PANEL"  # PANEL, ATTRIBUTE, COLOR, IMAGE, NONE = the smoothest lines
    direction_attribute: str = "saddleback_direction"
    direction_color: str = ""  # "" = the active one
    direction_image: str = ""
    forbidden_group: str = ""
    keep: bool = False  # shapes of the output Instances as they lie; the others are laid around them
    use_modifiers: bool = False
    make_bent: bool = True
    fit: float = 0.01  # of bent copies: how far faces may leave the surface, in radii; 0 = their faces stay as they are
    thickness: float = 0.0  # of shapes without a mesh; 0 = by their size
    make_instances: bool = False
    follow_surface: bool = True  # where the mesh is deformed later
    make_outlines: bool = False
    outline_radius: float = 0.005
    outline_radius_share: float = 3.0
    make_cut: bool = False  # a copy of the mesh with the outlines cut in
    write_attributes: bool = False
    look: str = "NONE"  # whose colors and material what is made has


@dataclass(frozen=True)
class BakeSettings:
    """All properties of `saddleback.bake`."""

    uv_name: str = ""  # the UV map; "" = the active one
    resolution: int = 2048  # texels in each direction
    use_tiles: bool = False  # an image of UDIM tiles, of those in which faces lie
    margin: int = 16  # texels
    bits: str = "16"  # 8, 16, 32
    bake_cell: bool = True
    cell_as: str = "COLOR"  # COLOR, NUMBER
    bake_edge_distance: bool = True
    bake_height: bool = True
    profile: str = "PANELS"  # PANELS, PEBBLES, CELLS = as the output Cells is shaped
    bake_local_uv: bool = False
    bake_direction: bool = False
    direction_attribute: str = "saddleback_direction"
    direction_space: str = "TANGENT"  # TANGENT, WORLD
    image_prefix: str = ""  # images are called so and what they show; "" = the object's name
    folder: str = ""  # where files go; "" = into the .blend


@dataclass(frozen=True)
class RepairSettings:
    """All properties of `saddleback.repair`."""

    weld_distance: float = 0.0  # world units; 0 welds vertices at the very same place only
    close_cracks: bool = False  # borders that nearly meet are joined; without a weld distance by the one that is told
    fill_holes: int = 0  # holes of up to so many edges are filled
