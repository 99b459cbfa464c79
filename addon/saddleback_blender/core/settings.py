"""What a run is asked to do: one frozen dataclass for each operator, field for field its properties."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TessellateSettings:
    """All properties of `saddleback.tessellate`; lengths are world units, objects are given by name ("" = none)."""

    count: int = 200
    seed: int = 0
    iterations: int = 30
    sites_source: str = "COUNT"  # COUNT, SELECTED, OBJECT
    sites_object: str = ""
    relax_sites: bool = False  # move chosen sites too (those of COUNT always move)
    density_source: str = "UNIFORM"  # UNIFORM, VERTEX_GROUP, ATTRIBUTE, COLOR, MASK
    density_name: str = ""
    density_channel: str = "LUMINANCE"  # LUMINANCE, R, G, B, A
    density_invert: bool = False
    density_contrast: float = 1.0
    k: int = 50
    use_modifiers: bool = False
    make_edges: bool = True
    edge_kind: str = "MESH"  # MESH, CURVE
    edge_radius: float = 0.01
    make_cells: bool = False
    gap: float = 0.0
    inset: float = 0.0
    thickness: float = 0.0
    underside: bool = False
    make_centres: bool = False
    instance_object: str = ""
    instance_scale: float = 1.0
    cell_attribute: str = "saddleback_cell"
    distance_attribute: str = "saddleback_distance"
    density_attribute: str = "saddleback_density"


@dataclass(frozen=True)
class DistanceSettings:
    """All properties of `saddleback.distance`; lengths are world units."""

    sources: str = "SELECTED"  # SELECTED, VERTEX_GROUP, EMPTIES
    sources_group: str = ""
    sources_collection: str = ""
    limit: float = 0.0  # no distance beyond it; 0 = none
    k: int = 50
    use_modifiers: bool = False
    distance_attribute: str = "saddleback_distance"


@dataclass(frozen=True)
class RepairSettings:
    """All properties of `saddleback.repair`."""

    weld_distance: float = 0.0  # world units; 0 welds vertices at the very same place only
