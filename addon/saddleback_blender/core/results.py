# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds what a run answers: frozen dataclasses of numpy arrays in the surface's space, with the Blender mesh's own
vertex numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .solids.level_lines import LevelLines

if TYPE_CHECKING:
    from .solids.edge_network import EdgeNetwork

Reals = NDArray[np.float64]
Indices = NDArray[np.int32]


@dataclass(frozen=True)
class Figures:
    """Holds how even cells are, as numbers; those of triangles are means over all of the dual mesh."""

    triangle_quality: float  # 1 = equilateral, 0 = without area
    least_angle: float  # radians
    irregular: float  # share of vertices that have not six neighbors (four at a border)
    energy: float | None  # times that of regular hexagons in a plane; None where nothing was relaxed


@dataclass(frozen=True)
class EdgeMarks:
    """Edges (m, 2) that are marked, and how."""

    edges: Indices
    sharp: NDArray[np.bool_]  # (m,)
    seam: NDArray[np.bool_]  # (m,)
    crease: Reals  # (m,) 0 to 1

    def along(self, *edges: Indices) -> EdgeMarks:
        """The same marks along one or several other lists of edges (m, 2), one after another."""
        count = len(edges)
        return EdgeMarks(
            np.concatenate(edges), np.tile(self.sharp, count), np.tile(self.seam, count), np.tile(self.crease, count)
        )


@dataclass(frozen=True)
class Dual:
    """The triangulation of n sites: one vertex a cell, one edge where two cells meet, one triangle where three do.

    With quads there are more vertices, on the surface, too: after the sites those in the middles of edges and of
    triangles.
    """

    vertices: Reals  # (n, 3) on the surface
    triangles: Indices  # (t, 3) counter-clockwise; none twice, and no corner twice in one
    faces: Indices  # (n,) of the surface, where the vertices are
    barycentric: Reals  # (n, 3)
    sites: int  # so many vertices are sites
    added: int  # so many of them at the end are no sites of the cells, but put there to make the mesh whole
    issues: tuple[str, ...]  # where cells are too large to be triangulated, for a person to read
    quads: Indices | None = None  # (q, 4) counter-clockwise, where they were wanted
    marks: EdgeMarks | None = None  # of the edges of its faces, where any were marked
    corner_faces: Indices | None = None  # (corners,) of the surface's triangles: on the side of the face of each corner
    corner_barycentric: Reals | None = None  # (corners, 3)

    @property
    def polygons(self) -> Indices:
        """(f, 3) or (f, 4): what is wanted."""
        return self.triangles if self.quads is None else self.quads

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class LampShell:
    """The ribs between cells as a solid: every edge has two triangles, all of them seen from outside."""

    vertices: Reals  # (n, 3)
    triangles: Indices  # (t, 3)
    pieces: int  # so many that hang together
    thickness: float  # that was asked for
    is_thinner: NDArray[np.bool_]  # (n,) where there was no room for the whole thickness
    crossing: int  # triangles that still pass through others; not 0 only where the surface itself does
    feet: Reals  # (n, 3) where on the surface the vertices stand: half-way between one outside and its like inside
    wall: Reals  # (n,) how thick the solid is there, in the middle of the rib
    parts: int = 1  # of the surface
    added: int = 0  # cells, without which there would be more pieces

    @property
    def thinner(self) -> float:
        """The share of places that are thinner than was asked for."""
        return float(self.is_thinner.mean())

    @property
    def volume(self) -> float:
        """What a printer fills."""
        vertices = self.vertices - self.vertices.mean(axis=0)  # far from the origin rounding would be all of it
        a, b, c = (vertices[corner] for corner in self.triangles.T)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class CellMesh:
    """Cells as a mesh, with their gap and height. n vertices, m triangles."""

    vertices: Reals  # (n, 3)
    feet: Reals  # (n, 3) where on the surface the vertices stand
    triangles: Indices  # (m, 3)
    triangle_cell: Indices  # (m,)
    vanished: Indices  # cells that the gap swallowed whole
    thinner: Indices  # cells that are lower in places, where there was no room for their thickness
    crossing: Indices  # cells that still pass through themselves or others: the surface itself does there

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class CellsResult:
    """Geodesic cells of a mesh of V vertices.

    V counts the Blender mesh's vertices. A vertex of no face, or of a part of the surface without a site, has cell -1
    and distance inf. n cells, e edges (polylines between two cells).
    """

    vertex_cell: Indices  # (V,) cell of each vertex, -1 = none
    vertex_distance: Reals  # (V,) world units to the cell's site, inf = unreached
    vertex_density: Reals | None  # (V,) the density used, None = uniform
    sites_position: Reals  # (n, 3)
    sites_normal: Reals  # (n, 3) unit length
    cell_area: Reals  # (n,)
    edge_points: Reals  # (m, 3) polyline points of all edges, one after another
    edge_offsets: Indices  # (e + 1,) edge i owns edge_points[edge_offsets[i]:edge_offsets[i + 1]]
    edge_cells: Indices  # (e, 2) the cells on both sides
    edge_closed: NDArray[np.bool_]  # (e,) the last point joins the first
    energy: Reals  # (k,) of each iteration, empty where nothing was relaxed
    iterations: int
    stop_reason: str
    edge_distance: Reals | None = None  # (V,) world units to the edge of the vertex's cell, inf = none; where wanted
    sites_tone: Reals | None = None  # (n,) 0 to 1, how dark the image is there, or how high the density; None = neither
    mesh: CellMesh | None = None  # where it was wanted
    polygons: SurfacePolygons | None = None  # where they were wanted in place of the mesh
    dual: Dual | None = None  # where it was wanted
    shell: LampShell | None = None  # where it was wanted
    figures: Figures | None = None  # None where the sites have no triangle
    exchanged: int = 0  # cells that were moved to where the dual mesh needs them
    twin: Indices | None = None  # (n,) where it was mirrored: the cell of the one side that each is the mirror of
    frame: tuple[str, str] = ("", "")  # names the surface, and all else that decided on the cells but the density
    network: EdgeNetwork | None = None  # the edges joined, where an object of them will be written

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.sites_position)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class CellPolygons:
    """Cells as polygons: polygon i runs through corners[offsets[i]:offsets[i + 1]], counter-clockwise from outside."""

    vertices: Reals  # (n, 3)
    corners: Indices
    offsets: Indices  # (p + 1,)
    polygon_cell: Indices  # (p,)


@dataclass(frozen=True)
class SurfacePolygons(CellPolygons):
    """Cells on a surface, one polygon each; neighbors share corners and sides."""

    faces: Indices  # (n,) of the surface's triangles, where the vertices are
    barycentric: Reals  # (n, 3)
    corner_faces: Indices  # (corners,) of the surface's triangles: on the side of the polygon of each corner
    corner_barycentric: Reals  # (corners, 3)
    missing: Indices  # cells that are no disks and have no polygon
    added: int  # so many more than the cells; of cells: put there at the end so that all are disks
    is_patches: bool = False  # of their own, in place of the cells

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class FlatCells(CellPolygons):
    """Cells of the plane within a flat mesh, whose polygons share their vertices.

    A cell that the domain cuts apart has several polygons.
    """

    edges: Indices  # (e, 2)
    edge_cells: Indices  # (e, 2) the cells on the left and on the right; -1 beyond the border
    has_holes: bool  # some cell lies around a hole: its polygons are the outline and, clockwise, the hole


@dataclass(frozen=True)
class Sweep:
    """Sweep circles that grow together: what is to be seen at which radius."""

    center: Reals  # (3,) of the first
    axes: Reals  # (3, 3) rows: two directions in the plane, and its normal
    last_radius: float  # all edges are there
    edge_vertices: Reals  # (n, 3) edges in short pieces
    edges: Indices  # (m, 2)
    edge_radius: Reals  # (n,) radius at which the beach curve has passed the vertex
    # (k, m, s, 3) at k radii, last_radius * (1 to k) / k: the beach curve; of several circles all of these, and then
    # the circles, each as large as it gets.
    rings: Reals

    def seen_from_center(self, places: Reals) -> Reals:
        """Places (n, 3) by the first circle's center and axes."""
        seen: Reals = (places - self.center) @ self.axes.T
        return seen


@dataclass(frozen=True)
class Voronoi2dResult:
    """A diagram of the plane on a flat mesh, with `flat` and `polygons`, or on a surface, with edges and pieces.

    On a flat mesh `cells` has no edges, and pieces only where polygons cannot show a cell that lies around a hole.
    """

    cells: CellsResult
    flat: FlatCells | None = None
    polygons: CellPolygons | None = None  # the cells in the shape that was asked for
    vanished: int = 0  # cells of `polygons` that are narrower than the gap
    sweep: Sweep | None = None


@dataclass(frozen=True)
class DistanceResult:
    """Geodesic distances of a mesh of V vertices to the nearest source: world units, inf = unreached."""

    vertex_distance: Reals  # (V,)
    isolines: LevelLines | None = None  # where they were wanted

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class PathsResult:
    """m lines along the surface: line i runs through points[offsets[i]:offsets[i + 1]], back to its first where closed.

    A chain or a loop is one line through all its points, a pair one line each.
    """

    points: Reals  # (n, 3)
    normals: Reals  # (n, 3) unit length
    offsets: Indices  # (m + 1,)
    closed: NDArray[np.bool_]  # (m,)
    lengths: Reals  # (m,)

    @property
    def nbytes(self) -> int:
        """Memory of the arrays."""
        return _nbytes(self)


@dataclass(frozen=True)
class SurfaceArrows:
    """n places on a surface with a direction (n, 3) and a normal (n, 3), both of unit length."""

    points: Reals  # (n, 3)
    directions: Reals
    normals: Reals
    length: float  # to draw them with


@dataclass(frozen=True)
class FieldResult:
    """A field of directions, and what shows it."""

    symmetry: int
    domain: str  # POINT, FACE
    directions: Reals  # (V, 3) or (polygons, 3) unit length; zero where there is no surface
    singular_points: Reals  # (k, 3)
    singular_normals: Reals  # (k, 3)
    singular_indices: Reals  # (k,)
    largest_turn: float  # radians from face to face
    stroke_count: int
    warnings: tuple[str, ...] = ()
    arrows: SurfaceArrows | None = None  # where they were wanted
    streamlines: PathsResult | None = None  # where they were wanted


@dataclass(frozen=True)
class PlacedShapes:
    """n shapes on a surface, as rigid copies stand there."""

    shape: Indices  # (n,) class
    points: Reals  # (n, 3) the center
    rotations: Reals  # (n, 4) quaternions, w first: from the shape's axes, z away from the surface
    scales: Reals  # (n, 3) length of a unit of the shape's plane; y negative where it is mirrored
    faces: Indices  # (n,) of the surface's triangles
    barycentric: Reals  # (n, 3)
    corners: Indices  # (n, 3) the triangles' vertices, numbered as in the Blender mesh
    corner_points: Reals  # (n, 3, 3) where they are


@dataclass(frozen=True)
class Anchors:
    """Where points stand on triangles of the surface, so that they go with them when those move and turn."""

    corners: Indices  # (n, 3) the triangles' vertices, numbered as in the Blender mesh
    barycentric: Reals  # (n, 3)
    offset: Reals  # (n, 3) from there to the points


@dataclass(frozen=True)
class BentCopies:
    """Polygon i runs through corners[offsets[i]:offsets[i + 1]], counter-clockwise from outside."""

    vertices: Reals  # (n, 3)
    faces: Indices  # (n,) of the surface's triangles, where the vertices stand
    barycentric: Reals  # (n, 3)
    corners: Indices
    offsets: Indices
    uv: Reals  # (corners, 2)
    smooth: NDArray[np.bool_]  # (p,)
    material: Indices  # (p,) of the shape's own list
    polygon_copy: Indices  # (p,) which placement
    polygon_shape: Indices  # (p,) which class of shapes


@dataclass(frozen=True)
class ShapeValues:
    """Holds what each of the Blender mesh's V vertices knows of the shapes."""

    shape: Indices  # (V,) whose outline is nearest; -1 = none near
    distance: Reals  # (V,) world units to its outline, negative inside; inf = none near
    uv: Reals  # (V, 2) in the unit square about the shape


@dataclass(frozen=True)
class CutShapes:
    """A surface of n vertices and m triangles, each of them inside just one of its shapes or outside of all."""

    vertices: Reals  # (n, 3)
    faces: Indices  # (n,) of the surface's triangles, on which the vertices lie
    barycentric: Reals  # (n, 3)
    triangles: Indices  # (m, 3)
    corner_faces: Indices  # (3 m,) of the surface's triangles: that which the cut triangle is a part of
    corner_barycentric: Reals  # (3 m, 3)
    copy: Indices  # (m,) which shape, -1 outside
    shape: Indices  # (m,) its class, -1 outside
    uv: Reals  # (3 m, 2) where in the shape, 0 outside


@dataclass(frozen=True)
class DistributeResult:
    """Shapes on a surface, and what is made of them."""

    placed: PlacedShapes
    vertex_count: int  # of the Blender mesh
    class_counts: Indices  # (classes,) how many of each
    text: str  # how it went, for a person to read
    lines: tuple[str, ...]  # further figures
    warnings: tuple[str, ...]
    bent: BentCopies | None = None  # where it was wanted
    bent_anchors: Anchors | None = None  # of its vertices, where they follow the surface
    outlines: PathsResult | None = None  # where they were wanted
    outline_anchors: Anchors | None = None  # of their points, where they follow the surface
    values: ShapeValues | None = None  # where they were wanted
    cut: CutShapes | None = None  # where it was wanted
    cut_anchors: Anchors | None = None  # of its vertices, where they follow the surface
    twin: Indices | None = None  # (n,) where it was mirrored: the shape of the one side that each is the mirror of


@dataclass(frozen=True)
class CheckResult:
    """Holds what an independent check of shapes found."""

    text: str  # for a person to read
    faults: tuple[str, ...]  # the first of them, one sentence each
    lines: tuple[str, ...]  # figures


@dataclass(frozen=True)
class RepairResult:
    """A repaired surface: what became of the vertices and triangles of the one given, and how much was changed."""

    vertices: Reals  # (n, 3)
    triangles: Indices  # (F, 3)
    vertex_map: Indices  # (old n,) new vertex, the first copy if it was split, -1 = gone
    face_map: Indices  # (old F,) new triangle, the first part if it was divided, -1 = gone
    changes: dict[str, int]  # by kind; empty when there was nothing to repair
    text: str  # the changes for a person to read
    filled: Indices  # new triangles that fill holes
    advice: tuple[str, ...]  # what the settings would mend that is left, one sentence each


def _nbytes(result: object) -> int:
    return sum(value.nbytes for value in vars(result).values() if isinstance(value, np.ndarray))
