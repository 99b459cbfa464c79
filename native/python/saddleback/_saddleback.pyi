# SPDX-License-Identifier: MIT
"""Types of the compiled part; its docstrings tell shapes, units, errors and sources."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Literal, SupportsFloat, SupportsIndex, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Floats: TypeAlias = NDArray[np.float64]
_Indices: TypeAlias = NDArray[np.int32]
_Path: TypeAlias = str | bytes | os.PathLike[str] | os.PathLike[bytes]
_Bytes: TypeAlias = bytes | bytearray | memoryview
_Method: TypeAlias = Literal["label_correcting", "dijkstra"]
_Device: TypeAlias = str  # "auto", "cpu", "cuda", "cuda:1", "cuda:0,1", "cuda:all"

__version__: str

def limit_device_memory(bytes: SupportsIndex) -> None:
    """Say how much of a CUDA device's memory may be taken, from the next call on.

    Others may need the rest: a renderer, or another program.

    Parameters
    ----------
    bytes : int
        0: what is free.

    Raises
    ------
    InputError
        A negative number.

    Notes
    -----
    What needs more raises DeviceError with the figure before anything runs; with device="auto" it runs on the processor.
    """

def release_pinned_memory() -> None:
    """Give back to the system what `pinned=True` keeps for results to come: up to 2 GiB of what was freed."""

def set_cuda_module(module: object) -> None:
    """Tell the library what the CUDA module offers."""

class Error(Exception):
    """Root of all errors of this library."""

class MeshError(Error, ValueError):
    """The mesh cannot be used as it is; `repair` may help."""

class InputError(Error, ValueError):
    """An argument is wrong; the message names it."""

class VersionError(InputError):
    """A newer version of this library wrote the file; nothing is wrong with it."""

class Cancelled(Error):
    """The job was cancelled."""

class DeviceError(Error):
    """The wanted device cannot be used."""

@final
class Job:
    """A token for long work: one thread computes with it, another watches or stops it.

    Pass it as ``job=`` and read ``fraction`` and ``text`` from any other thread meanwhile. A job may be used again; its
    fraction then starts from 0. Once cancelled it stays cancelled.
    """
    def __init__(self) -> None: ...
    @property
    def fraction(self) -> float:
        """Share of the work done, 0 to 1, never falling during one call."""
    @property
    def text(self) -> str:
        """The work being done, for a person to read."""
    @property
    def cancelled(self) -> bool:
        """True once `cancel` was called."""
    def part(self, begin: SupportsFloat, end: SupportsFloat) -> Job:
        """A job for a part of this one's work, from `begin` to `end` in its 0 to 1.

        Several calls, each with the part that comes after the last one's, report one rising fraction; what is done to a part is
        done to the whole. Raises InputError unless 0 <= begin <= end <= 1.
        """
    def update(self, fraction: SupportsFloat) -> None:
        """Say how far the work between calls has come, 0 to 1; raises `Cancelled` when asked to stop."""
    def cancel(self) -> None:
        """Ask the work to stop: within 0.1 s its call raises `Cancelled`."""

@final
class Mesh:
    """An oriented manifold triangle mesh with or without boundary, of any number of components; immutable.

    Parameters
    ----------
    vertices : array_like of shape (V, d), d >= 2
        Positions; any real number type, kept as float64. Every vertex must belong to a face. With more than three coordinates
        edges are as long as in d dimensions, and the first three are kept to show the surface; with two the third is 0.
    triangles : array_like of shape (F, 3)
        Vertex indices of each face, counter-clockwise; any integer type.
    lengths : array_like of shape (F, 3) or (E,), optional
        A metric of the surface's own: how long the sides of each face are, from corner i to corner i + 1, or the edges, in
        the order of `edges`. Everything is then measured by them, and `vertices` only show the surface.
    job : Job, optional
        Watched for progress and cancellation.

    Raises
    ------
    InputError
        An argument has the wrong shape or type.
    MeshError
        Lengths that are not finite and positive, that are not the same for both faces of an edge (to 1e-12), or that are
        not those of a triangle.
        No faces, coordinates that are not finite or beyond 1e60, indices out of range, faces without area (lower than 1e-12
        of their longest edge) or that use a vertex twice, duplicate faces, non-manifold edges or vertices, neighbors of
        opposite orientation, vertices of no face. The message names the first three; `repair` mends all but the index range.

    Notes
    -----
    O(V + F) time; about 200 bytes a vertex. All arrays that it gives are read-only views of its memory.
    """
    def __init__(
        self, vertices: ArrayLike, triangles: ArrayLike, *, lengths: ArrayLike | None = None, job: Job | None = None
    ) -> None: ...
    @property
    def vertices(self) -> _Floats:
        """(V, 3) float64: positions."""
    @property
    def triangles(self) -> _Indices:
        """(F, 3) int32: vertices of each face."""
    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
    @property
    def face_count(self) -> int:
        """Number of faces."""
    @property
    def edge_count(self) -> int:
        """Number of edges."""
    @property
    def edges(self) -> _Indices:
        """(E, 2) int32: the two vertices of each edge, in the order of the faces."""
    @property
    def edge_lengths(self) -> _Floats:
        """(E,) float64: lengths, in the order of `edges`."""
    @property
    def is_intrinsic(self) -> bool:
        """True where lengths are not those of the positions: given, or of more than three coordinates. What needs a shape in space is then refused."""
    @property
    def mean_edge_length(self) -> float:
        """Mean length of an edge."""
    @property
    def face_areas(self) -> _Floats:
        """(F,) float64: areas."""
    @property
    def area(self) -> float:
        """Area of the whole surface."""
    @property
    def corner_angles(self) -> _Floats:
        """(F, 3) float64: angle at each corner of each face, radians."""
    @property
    def total_angles(self) -> _Floats:
        """(V,) float64: sum of the corner angles at each vertex, radians."""
    @property
    def saddle_vertices(self) -> _Indices:
        """(n,) int32: inner vertices whose total angle exceeds 2 pi, and all boundary vertices: where a shortest path may bend."""
    @property
    def vertex_kinds(self) -> NDArray[np.int8]:
        """(V,) int8: the sign of the curvature: -1 saddle vertices, with all of the boundary; 0 Euclidean ones, flat to 1e-10; 1 spherical ones."""
    @property
    def boundary_vertices(self) -> _Indices:
        """(n,) int32: vertices on the boundary."""
    @property
    def boundary_loops(self) -> list[_Indices]:
        """List of (n,) int32: vertices of each boundary loop in order, the surface on the left."""
    @property
    def is_closed(self) -> bool:
        """True without boundary."""
    @property
    def components(self) -> _Indices:
        """(V,) int32: connected component of each vertex, 0 to component_count - 1."""
    @property
    def component_count(self) -> int:
        """Number of connected components."""
    @property
    def genus(self) -> int:
        """Number of handles, summed over the components, boundary loops thought closed."""
    @property
    def fingerprint(self) -> int:
        """64-bit hash of vertices, triangles and lengths of its own."""
    @staticmethod
    def from_trimesh(mesh: Any) -> Mesh:
        """Take the vertices and faces of a ``trimesh.Trimesh``, or of whatever has both.

        Raises
        ------
        InputError
            Something else. MeshError: not a valid mesh; ``repair(mesh.vertices, mesh.faces)`` helps.
        """
    @staticmethod
    def from_pyvista(mesh: Any) -> Mesh:
        """Take the points and faces of a ``pyvista.PolyData``, or the surface of another of its data sets.

        Polygons become triangles as PyVista makes them. PyVista's own points are float32 unless they were given as float64.

        Raises
        ------
        InputError
            Something else. MeshError: not a valid mesh.
        """
    @staticmethod
    def from_meshio(mesh: Any) -> Mesh:
        """Take the points and triangles of a ``meshio.Mesh``; quadrangles are halved, other cells left out.

        Raises
        ------
        InputError
            Something else, or a mesh without triangles. MeshError: not a valid mesh.
        """
    @staticmethod
    def from_open3d(mesh: Any) -> Mesh:
        """Take the vertices and triangles of an ``open3d.geometry.TriangleMesh``, or of one of ``open3d.t.geometry``.

        Raises
        ------
        InputError
            Something else. MeshError: not a valid mesh.
        """
    def to_trimesh(self, attributes: Mapping[str, ArrayLike] | None = ...) -> Any:
        """Make a ``trimesh.Trimesh`` of the same vertices and faces, in their order.

        Parameters
        ----------
        attributes : {name: array}, optional
            As in `write_mesh`; they become ``vertex_attributes`` and ``face_attributes``.

        Raises
        ------
        ImportError
            There is no trimesh. InputError: attributes of another length.
        """
    def to_pyvista(self, attributes: Mapping[str, ArrayLike] | None = ...) -> Any:
        """Make a ``pyvista.PolyData`` of the same points and faces, in their order.

        Parameters
        ----------
        attributes : {name: array}, optional
            As in `write_mesh`; they become ``point_data`` and ``cell_data``.

        Raises
        ------
        ImportError
            There is no pyvista. InputError: attributes of another length.
        """
    def to_meshio(self, attributes: Mapping[str, ArrayLike] | None = ...) -> Any:
        """Make a ``meshio.Mesh`` of the same points and triangles, in their order.

        Parameters
        ----------
        attributes : {name: array}, optional
            As in `write_mesh`; they become ``point_data`` and ``cell_data``.

        Raises
        ------
        ImportError
            There is no meshio. InputError: attributes of another length.
        """
    def to_open3d(self, attributes: Mapping[str, ArrayLike] | None = ...) -> Any:
        """Make an ``open3d.geometry.TriangleMesh`` of the same vertices and triangles, in their order.

        Parameters
        ----------
        attributes : {name: array}, optional
            As in `write_mesh`; it holds ``color`` and ``normal`` of the vertices.

        Raises
        ------
        ImportError
            There is no open3d. InputError: other attributes, or of another length.
        """

@final
class RepairReport:
    """The changes of a repair; `str` of it is a sentence."""
    @property
    def changes(self) -> dict[str, int]:
        """dict of str to int: how often each kind of change was made; kinds that did not occur are absent."""
    @property
    def vertex_map(self) -> _Indices:
        """(old V,) int32: the new vertex (the first copy if it was split), or -1."""
    @property
    def face_map(self) -> _Indices:
        """(old F,) int32: the new face (the first part if it was divided), or -1."""
    @property
    def near_border_vertices(self) -> int:
        """Border vertices of the mesh that came out that lie within 1e-4 of an edge from another border's vertex."""
    @property
    def joining_distance(self) -> float:
        """The weld distance that would join these, in the unit of the vertices; 0 where there are none."""
    @property
    def t_junctions(self) -> int:
        """Border vertices that lie as near to the inside of another border's edge; ``stitch=True`` joins them."""

def repair(
    vertices: ArrayLike,
    triangles: ArrayLike,
    weld_distance: SupportsFloat = 0.0,
    *,
    stitch: bool = False,
    fill_holes: SupportsIndex = 0,
    job: Job | None = None,
) -> tuple[Mesh, RepairReport]:
    """Make a valid mesh of nearly anything.

    Drops what cannot be used (indices out of range, vertices that are not finite, faces that repeat a vertex or another
    face, vertices of no face), welds vertices, splits non-manifold edges and vertices, orients the faces (the outermost
    outward where closed, and what lies within with it; open ones so that not decidedly more of the back than of the front is
    seen from outside; a surface without orientation, such as a Moebius strip, is cut along a seam) and mends faces without
    area so that no crack opens. Borders that nearly meet are told in the report. A good mesh whose vertices are all in
    different places comes back as it was.

    Parameters
    ----------
    vertices : array_like of shape (V, 3)
        Positions; any real number type.
    triangles : array_like of shape (F, 3)
        Vertex indices of each face; any integer type.
    weld_distance : float, default 0
        Vertices within this distance become one (in the unit of `vertices`); 0 welds those at exactly the same place.
    stitch : bool, default False
        Divide border edges where vertices of other borders lie on them, or within `weld_distance`: T-junctions close.
    fill_holes : int, default 0
        Fill border loops of up to so many edges, by the triangulation of least area; 2000 at most.
    job : Job, optional
        Watched for progress and cancellation.

    Returns
    -------
    mesh : Mesh
    report : RepairReport
        What was done, and where each vertex and face went.

    Raises
    ------
    InputError
        An argument has the wrong shape, type or value.
    MeshError
        No face is left.

    Notes
    -----
    O(n log n), and O(h^3) for a hole of h edges. Non-manifold edges are cut and stitched after [gueziec2001], holes filled
    after [barequet1995].
    """

def read_mesh(path: _Path, *, job: Job | None = None) -> Mesh:
    """Read a mesh from an OBJ, PLY (text, binary), OFF (text) or STL (text, binary) file.

    Polygons become triangles that cover them, concave ones and such with holes (edges there and back) too: a fan where one
    covers it, else Delaunay's triangulation, seen along the mean normal. An STL file's corners at exactly the same place
    become one vertex. Coordinates keep the file's precision.

    Parameters
    ----------
    path : str or os.PathLike
        The file; its extension tells the format. A further ``.gz`` says that it is compressed.
    job : Job, optional
        Watched for progress and cancellation.

    Returns
    -------
    Mesh

    Raises
    ------
    InputError
        The file cannot be opened, or its extension is unknown.
    MeshError
        The file breaks off, holds what is not understood or has no faces (the message names the line or byte), or holds no
        valid mesh: ``repair(*read_arrays(path))`` then helps.

    Warns
    -----
    UserWarning
        Faces cross themselves or have no area: their triangles may overlap.

    Notes
    -----
    O(n), for STL and large concave polygons O(n log n).
    """

def read_arrays(path: _Path, *, job: Job | None = None) -> tuple[_Floats, _Indices]:
    """Read the raw arrays of a mesh file, whether they make a valid mesh or not.

    Parameters
    ----------
    path : str or os.PathLike
        As for `read_mesh`.
    job : Job, optional
        Watched for progress and cancellation.

    Returns
    -------
    vertices : (V, 3) float64
    triangles : (F, 3) int32

    Raises
    ------
    InputError, MeshError
        As for `read_mesh`, but for the validity of the mesh.

    Warns
    -----
    UserWarning
        As for `read_mesh`.
    """

@final
class SurfacePoints:
    """Points anywhere on a mesh: a face index and three barycentric coordinates each. Immutable.

    Args:
        faces: (n,) face indices, integers >= 0.
        barycentric: (n, 3) coordinates in the order of the face's corners, >= 0 and summing to 1; rounding (up to 1e-6,
            as float32 brings) is removed.

    Raises:
        InputError: wrong shape or type, a negative face, coordinates not finite, negative or of another sum.
    """
    def __init__(self, faces: ArrayLike, barycentric: ArrayLike) -> None: ...
    @property
    def faces(self) -> _Indices:
        """(n,) int32: face indices; read-only view."""
    @property
    def barycentric(self) -> _Floats:
        """(n, 3) float64: coordinates; read-only view."""
    def positions(self, mesh: Mesh) -> _Floats:
        """(n, 3) float64: positions in space on that mesh."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex | slice) -> SurfacePoints: ...
    def __iter__(self) -> Iterator[SurfacePoints]: ...

_Points: TypeAlias = ArrayLike | SurfacePoints

def project(mesh: Mesh, xyz: ArrayLike, *, threads: SupportsIndex = 0, job: Job | None = None) -> SurfacePoints:
    """The nearest surface point for each position.

    Of equally near points the one in the smallest face is given; on an edge or vertex its coordinates are exactly 0 or 1.
    A bounding volume hierarchy is built for each call: O((F + n) log F).

    Args:
        xyz: (n, 3) positions, mesh units.
        threads: 0 for all cores; never changes the result.

    Raises:
        InputError: wrong shape, a coordinate that is not finite.
        Cancelled: the job was.
    """

def sample(
    mesh: Mesh,
    count: SupportsIndex,
    density: ArrayLike | None = None,
    seed: SupportsIndex = 0,
    *,
    one_per_component: bool = False,
    job: Job | None = None,
) -> SurfacePoints:
    """Points whose number per area follows the density, spread evenly: systematic sampling along a Hilbert curve.

    The same seed gives the same points on every platform. O(F log F + count).

    Args:
        count: number of points, at least 1.
        density: (V,) wanted points per area, >= 0; only ratios matter; linear over each face. None: the same everywhere.
        one_per_component: every connected component gets a point, by area where its density is zero.
        job: a Job that tells how far it is and may stop it.

    Raises:
        InputError: count too small, density of the wrong length, not finite, negative or zero everywhere.
        Cancelled: the job was.
    """

@final
class SurfaceCurve:
    """A polyline on the surface: straight between consecutive points, each pair of which shares a face. Immutable.

    The points of a GeodesicPath or a TracedPath (`path.surface`) are such a curve.

    Args:
        mesh: the mesh, kept alive by the curve.
        points: (n,) vertices or a SurfacePoints, n >= 2, in order; repeated points are harmless. A point within 1e-6
            (barycentric) of an edge counts as on it where its neighbor needs that.
        closed: the curve runs on from the last point to the first, which then need not be repeated.

    Raises:
        InputError: fewer than two points, a point off the mesh, consecutive points that share no face (their indices are
            named), a curve without length.
    """
    def __init__(self, mesh: Mesh, points: _Points, closed: bool = False) -> None: ...
    @property
    def points(self) -> SurfacePoints:
        """The points as a SurfacePoints."""
    @property
    def closed(self) -> bool:
        """True if the curve runs on to its first point."""
    @property
    def length(self) -> float:
        """Mesh units."""
    def __len__(self) -> int: ...

def feature_curves(
    mesh: Mesh,
    angle: SupportsFloat = ...,
    *,
    boundary: bool = True,
    edges: ArrayLike | None = None,
    corner_angle: SupportsFloat = ...,
    least_length: SupportsFloat = 0.0,
) -> list[SurfaceCurve]:
    """The lines of a mesh that a remesh should keep, as a list of SurfaceCurve.

    Edges at which the normals of the faces differ by more than `angle`, the boundary and the given edges are put together
    to curves as long as can be: they end where not two but one or several of these edges meet, and where they turn by
    more than `corner_angle`. Lines without such a place are closed. In the order of their first vertices.

    Args:
        mesh: the Mesh.
        angle: radians, 0 to pi; pi finds no edge but those of the boundary and the given ones.
        boundary: whether the mesh's boundary is such a line.
        edges: (n, 2) vertices of more such edges.
        corner_angle: radians, 0 to pi.
        least_length: lines are left out where all that hang together are shorter, but for the boundary and the given edges:
            noise of scans, or details that a coarse remesh cannot show. About twice the size of a cell, for example.

    For `centroidal_voronoi(curves=...)`, whose sites then stay on these lines. O(V + F).

    Raises:
        InputError: an angle out of range; a length below 0; two vertices in `edges` that no edge joins.
    """

@final
class BarredMesh:
    """A surface with barriers as a mesh of its own, and the way there and back; made by `add_barriers`."""
    @property
    def mesh(self) -> Mesh:
        """Mesh: the surface with its barriers."""
    @property
    def whole(self) -> Mesh:
        """Mesh: the surface without them."""
    @property
    def vertex_origin(self) -> _Indices:
        """(W,) int32: vertex of `whole` that each vertex is a copy of, -1 for those on curves."""
    @property
    def vertex_points(self) -> SurfacePoints:
        """SurfacePoints (W): where each vertex lies on `whole`."""
    @property
    def face_origin(self) -> _Indices:
        """(U,) int32: face of `whole` that each face is a part of, ascending."""
    def to_barred(self, points: _Points) -> tuple[SurfacePoints, _Indices]:
        """Bring points of the whole mesh to the barred one.

        Parameters
        ----------
        points : vertex indices or SurfacePoints
            On the whole mesh.

        Returns
        -------
        tuple of SurfacePoints (m) and (m,) int32
            The points, those on a barrier once for each side, and which of the given points each is.

        Raises
        ------
        InputError
            A point off the mesh, or in nothing but faces that are left out.

        Notes
        -----
        O(log F) a point.
        """
    def to_whole(self, points: _Points) -> SurfacePoints:
        """Bring points of the barred mesh, as those of a path, to the whole one.

        Parameters
        ----------
        points : vertex indices or SurfacePoints
            On `mesh`.

        Returns
        -------
        SurfacePoints

        Raises
        ------
        InputError
            A point off the mesh.

        Notes
        -----
        O(1) a point.
        """
    def polygons(
        self, cells: GeodesicVoronoi, *, bend: SupportsFloat = 0.15, tolerance: SupportsFloat = ...
    ) -> tuple[CellPolygons, SplitMesh]:
        """Make a polygon of the whole surface for each cell of the barred one.

        Sides run along the barriers, with a corner wherever those bend, meet or end. Cells on both sides of a barrier share
        corners and sides there, so polygons of a closed surface are closed. Where a barrier ends within a cell, the cell's
        boundary is moved to that end, or the cell becomes two: those that it adds come after the last site's.

        Parameters
        ----------
        cells : GeodesicVoronoi
            Of `mesh`.
        bend : float
            How far other sides may leave the boundary that they stand for, as for `GeodesicVoronoi.polygons`.
        tolerance : float
            A length that it is never more than.

        Returns
        -------
        tuple of CellPolygons and SplitMesh
            The polygons, on `whole`; `missing` names cells that are no disks. And the whole mesh cut along the boundaries of the
            cells: what each polygon stands for.

        Raises
        ------
        InputError
            Cells of another mesh; a negative bend or tolerance.

        Notes
        -----
        O((V + F) log F), and O(F) for each end of a barrier within a cell.
        """
    def values_to_barred(self, values: ArrayLike) -> _Floats:
        """Bring values of the whole mesh's vertices, as a density, to those of the barred one.

        Parameters
        ----------
        values : array_like of shape (V,)

        Returns
        -------
        (W,) float64
            Linear over each face where a curve has made a vertex.

        Raises
        ------
        InputError
            A wrong number of values.

        Notes
        -----
        O(W).
        """
    def least(self, values: ArrayLike) -> _Floats:
        """Bring values of the barred mesh's vertices, as distances, to those of the whole one.

        Parameters
        ----------
        values : array_like of shape (W,)

        Returns
        -------
        (V,) float64
            The least of a vertex's copies on all sides of its barriers; infinity where all of its faces are left out.

        Raises
        ------
        InputError
            A wrong number of values.

        Notes
        -----
        O(V + W).
        """
    def least_copies(self, values: ArrayLike) -> _Indices:
        """For each vertex of the whole mesh its copy of the least value.

        Brings labels back: ``cells.vertex_cell[barred.least_copies(cells.vertex_distance)]``.

        Parameters
        ----------
        values : array_like of shape (W,)

        Returns
        -------
        (V,) int32
            Vertices of `mesh`, the smallest of equal ones; -1 where all of a vertex's faces are left out.

        Raises
        ------
        InputError
            A wrong number of values.

        Notes
        -----
        O(V + W).
        """

def add_barriers(
    mesh: Mesh,
    *,
    edges: ArrayLike | None = None,
    curves: Sequence[SurfaceCurve] | None = None,
    faces: ArrayLike | None = None,
    job: Job | None = None,
) -> BarredMesh:
    """Part a surface along lines that no path may cross, and leave faces out.

    What comes back holds a mesh on which everything works unchanged: distances, graphs, paths, cells, shapes. On both sides
    of a barrier it has vertices of their own; where a barrier ends inside the surface its sides meet, and paths go around
    the end. What a barrier encloses is a part of its own (`mesh.components`): no distance from outside reaches it, which is
    told as infinity.

    Parameters
    ----------
    mesh : Mesh
    edges : array_like of shape (n, 2), optional
        Barriers along edges of the mesh, each by its two vertices.
    curves : sequence of SurfaceCurve, optional
        Barriers across faces. They may cross and touch each other, edges and vertices; what is nearer than 1e-9 of a face
        meets. Faces that they cross become several.
    faces : array_like of (F,) bool or of face indices, optional
        The faces that are left out.
    job : Job, optional
        Watched for progress and cancellation.

    Returns
    -------
    BarredMesh

    Raises
    ------
    InputError
        Two vertices that no edge joins, a curve of another mesh, a curve that crosses or touches itself (the message tells
        where), faces out of range, all faces left out.

    Notes
    -----
    O(V + F), and O(p^2) for p pieces of curves in one face. A vertex that stays one comes in the old order; second and
    further copies follow. Constrained triangulations after [sloan1993].
    """

_Sources: TypeAlias = _Points | SurfaceCurve | Sequence[SurfaceCurve]

class GeodesicPath:
    """A curve on the surface; consecutive points share a face."""
    @property
    def points(self) -> _Floats:
        """(n, 3) float64: points in space."""
    @property
    def surface(self) -> SurfacePoints:
        """These points as a SurfacePoints."""
    @property
    def length(self) -> float:
        """Length of the curve, mesh units."""

@final
class GeodesicPaths:
    """Many paths in flat arrays; also a sequence of GeodesicPath, each made when asked for.

    Path i has the points `points[offsets[i]:offsets[i + 1]]`.
    """
    @property
    def points(self) -> _Floats:
        """(n, 3) float64: points of all paths in space."""
    @property
    def surface(self) -> SurfacePoints:
        """These points as a SurfacePoints."""
    @property
    def offsets(self) -> NDArray[np.int64]:
        """(paths + 1,) int64."""
    @property
    def lengths(self) -> _Floats:
        """(paths,) float64: mesh units; inf where no source reaches."""
    @property
    def sources(self) -> _Indices:
        """(paths,) int32: index of the source each begins at; -1 where none reaches."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex) -> GeodesicPath: ...
    def __iter__(self) -> Iterator[GeodesicPath]: ...

class TracedPath(GeodesicPath):
    """A traced curve and how it ended."""
    @property
    def end_angle(self) -> float:
        """Direction of arrival, radians, in the chart of the last point's face (corner 0 to 1 is 0)."""
    @property
    def end_direction(self) -> _Floats:
        """(3,) float64: direction of arrival, a unit vector."""
    @property
    def hit_boundary(self) -> bool:
        """True when the boundary stopped the curve early."""

def trace(
    mesh: Mesh,
    point: SupportsIndex | SurfacePoints,
    direction: SupportsFloat | ArrayLike,
    length: SupportsFloat,
    *,
    job: Job | None = None,
) -> TracedPath:
    """Walks straight on over the surface: the exponential map.

    Through a vertex the curve goes on with half of the total angle on either side [polthier1998]; at the boundary it stops,
    unless it runs along a straight border or touches a corner. O(faces crossed).

    Args:
        point: one surface point, or a vertex index.
        direction: an angle in radians, or a (3,) vector, which is projected onto the surface. Angles are measured
            counter-clockwise in the chart of the point's face (corner 0 to corner 1 is 0) or, at a vertex, on the surface
            about it from its first edge.
        length: mesh units, >= 0.
        job: a Job that tells how far it is and may stop it.

    Raises:
        InputError: bad point, direction or length; a vector across the surface; a curve over more than a million faces.
    """

def exact_distances(mesh: Mesh, sources: _Points, limit: SupportsFloat = ..., *, job: Job | None = None) -> _Floats:
    """Distance of every vertex from the nearest source, exact up to rounding.

    Right on flat and regular meshes, needles, boundaries and several components. For one field; a SaddleVertexGraph answers
    many at a stated accuracy.

    Parameters
    ----------
    mesh : Mesh
    sources : (n,) int array or SurfacePoints
        Vertices, or points anywhere on the surface.
    limit : float
        Vertices farther than this stay at infinity, and what lies beyond costs no time. Mesh units.
    job : Job, optional
        Progress and cancellation.

    Returns
    -------
    (V,) float64 array
        Mesh units; inf where no source reaches.

    Raises
    ------
    InputError
        No sources, a source off the mesh, limit negative or not a number.
    Cancelled
        The job was cancelled.

    Notes
    -----
    One core; about O(V^1.5) time, some 600 bytes a vertex while it runs. J. Chen, Y. Han: Shortest paths on a polyhedron,
    1990; S.-Q. Xin, G.-J. Wang: Improving Chen and Han's algorithm on the discrete geodesic problem, ACM Transactions on
    Graphics 28(4), 2009.
    """

def exact_nearest(
    mesh: Mesh, sources: _Points, limit: SupportsFloat = ..., *, job: Job | None = None
) -> tuple[_Floats, _Indices]:
    """Returns exact distances, and which source is nearest.

    Returns
    -------
    distance : (V,) float64 array
        Mesh units; inf where no source reaches.
    source : (V,) int32 array
        Index into `sources`, -1 where none reaches; of those at the same distance, up to a relative 1e-12, the smallest.
    """

@final
class ExactField:
    """Exact distances at every point of the surface, not at the vertices alone, and the shortest paths.

    Takes what exact_distances takes and raises what it raises. Keeps the windows of the propagation: about 40 bytes each,
    20 to 150 of them a vertex of a scan, but as the root of the vertices on flat and smooth surfaces, a thousand each of a
    million (nbytes tells). Raises InputError where memory is too small for them. Immutable.
    """
    def __init__(self, mesh: Mesh, sources: _Points, *, job: Job | None = None) -> None: ...
    @property
    def distances(self) -> _Floats:
        """(V,) float64: distance of every vertex, mesh units; inf where no source reaches."""
    @property
    def nearest(self) -> _Indices:
        """(V,) int32: which source is nearest; -1 where none reaches, ties to the smaller index."""
    def distance_to(self, points: _Points, *, job: Job | None = None) -> _Floats:
        """Distance of any surface points from the nearest source.

        Parameters
        ----------
        points : (n,) int array or SurfacePoints
        job : Job, optional

        Returns
        -------
        (n,) float64 array
            Mesh units; inf where no source reaches.

        Raises
        ------
        InputError
            A point off the mesh.
        Cancelled
            The job was cancelled.
        """
    def path(self, target: SupportsIndex | SurfacePoints) -> GeodesicPath:
        """The shortest path from the nearest source to a point.

        Straight within faces, bent only at saddle vertices and on the boundary, as long as the distance. O(faces crossed).

        Parameters
        ----------
        target : int or SurfacePoints
            One vertex or one surface point.

        Returns
        -------
        GeodesicPath
            From the source to the target: a point for each edge or vertex that the path crosses.

        Raises
        ------
        InputError
            Not one point, a point off the mesh, a point that no source reaches.
        """
    def paths(self, targets: _Points, *, job: Job | None = None) -> list[GeodesicPath]:
        """`path` for several targets: a list of GeodesicPath. The first target that is wrong is named."""
    @property
    def window_count(self) -> int:
        """Windows propagated: the work done."""
    @property
    def nbytes(self) -> int:
        """Memory of the field, bytes."""

@final
class SaddleVertexGraph:
    """Saddle Vertex Graph: geodesic distances as shortest paths in a sparse graph.

    Every vertex is linked to the vertices of its geodesic disk that it sees along one straight geodesic, and to its
    neighbors. Arcs are real paths on the surface, so distances are never too short; the graph is symmetric to the bit.

    Parameters
    ----------
    mesh : Mesh
    k : int, optional
        Vertices per geodesic disk, not counting the center; 1 to the mesh's vertex count. More is slower and more accurate:
        the mean error is about 0.4 % at 50 and 0.1 % at 100.
    accuracy : float, optional
        Largest relative error of a distance that is accepted, above 0 and below 1. The mean error is far below. When none
        of k, accuracy and exact is given: 0.005.
    exact : bool
        All straight geodesics, so that distances between vertices are exact. For small meshes: the graph has V^2 arcs where
        nothing is a saddle.
    threads : int
        0: all cores. The result does not depend on it.
    device : str
        "cpu"; "cuda", or "cuda:1" for the second CUDA device; "cuda:0,1" and "cuda:all" let several share the work; "auto"
        takes the first one where there is one and the mesh is large enough to gain by it, and the CPU otherwise. The result
        does not depend on it, to the bit.
    instructions : str
        "auto", or one of "avx512", "avx2", "plain" and "neon" that the machine has. The result does not depend on it.
    job : Job, optional
        Progress and cancellation.
    pinned : bool
        Whether arcs come into memory that a CUDA device writes by itself, for one graph after the other: the first takes
        longer, the others gain a third of a millisecond and more. See `release_pinned_memory`.

    Raises
    ------
    InputError
        k below 1 or above the vertex count; accuracy not between 0 and 1; more than one of k, accuracy and exact; not
        enough memory for the exact graph (the message says how much it would take); an unknown device or instruction set.
    DeviceError
        device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails; the
        message says why. Exact graphs are built on the CPU only.
    Cancelled
        The job was cancelled.

    Notes
    -----
    Time grows with V times the windows of a disk (about 250 for accuracy=0.005, 650 for k=100); 8 bytes an arc, about 55
    arcs a vertex for accuracy=0.005. X. Ying, X. Wang, Y. He: Saddle Vertex Graph (SVG): A Novel Solution to the Discrete
    Geodesic Problem, ACM Transactions on Graphics 32(6), 2013. Y. Adikusuma, Z. Fang, Y. He: Fast Construction of Discrete
    Geodesic Graphs, ACM Transactions on Graphics 39(2), 2020.
    """
    def __init__(
        self,
        mesh: Mesh,
        k: SupportsIndex | None = None,
        *,
        accuracy: SupportsFloat | None = None,
        exact: bool = False,
        threads: SupportsIndex = 0,
        device: _Device = "auto",
        instructions: str = "auto",
        job: Job | None = None,
        pinned: bool = False,
    ) -> None: ...
    def neighbors(self, vertex: SupportsIndex) -> tuple[_Indices, _Floats, _Floats]:
        """The vertices that one is linked to.

        Parameters
        ----------
        vertex : int

        Returns
        -------
        tuple of (n,) int32, (n,) float64, (n,) float64
            Vertices, ascending; lengths of the arcs to them, mesh units; angles in which the arcs leave, radians, as `trace`
            takes them.

        Raises
        ------
        InputError
            A vertex out of range.

        Notes
        -----
        O(degree times faces crossed): each arc is unfolded again for its angle.
        """
    def arcs(self, *, job: Job | None = None) -> tuple[NDArray[np.int64], _Indices, _Floats]:
        """All arcs in compressed sparse rows, as SciPy's and others' graphs take them.

        ``scipy.sparse.csr_matrix((lengths, targets, offsets))`` is the matrix of the graph's lengths.

        Parameters
        ----------
        job : Job, optional
            Watched for progress and cancellation.

        Returns
        -------
        tuple of (V + 1,) int64, (arc_count,) int32, (arc_count,) float64
            Offsets: the arcs of vertex v are ``offsets[v]`` to ``offsets[v + 1]``; targets, ascending within each; lengths, mesh
            units, equal to the bit for an arc and its reverse.

        Notes
        -----
        O(arcs log degree); copies of 12 bytes an arc.
        """
    @property
    def tiers(self) -> dict[str, int]:
        """dict of str to int: arcs by their ends, each counted once: "S-S" between saddle vertices, "N-S" from one to another vertex, "N-N" between others [ying2013]. O(arcs)."""
    def distances(
        self,
        sources: _Sources,
        limit: SupportsFloat = ...,
        method: _Method = "label_correcting",
        *,
        device: _Device = "auto",
        job: Job | None = None,
    ) -> _Floats:
        """Distance of every vertex from the nearest source.

        Parameters
        ----------
        sources : (n,) int array, SurfacePoints, SurfaceCurve or a sequence of SurfaceCurves
            Vertices, points anywhere on the surface (linked to the graph by a window propagation each), or curves: then it is
            the distance to the curve itself, not to its points.
        limit : float
            Vertices farther than this stay at infinity. Mesh units.
        method : str
            "label_correcting" (buckets) or "dijkstra" (heap): the same bits, at different speeds.
        device : str
            "cpu"; "cuda", or "cuda:1" for the second CUDA device, which keeps the graph's arcs from then on (of several that
            are named, the first); "auto" takes the first one for graphs that were built by one or are kept by one. The result
            does not depend on it, to the bit.
        job : Job, optional

        Returns
        -------
        (V,) float64 array
            Mesh units; inf where no source reaches.

        Raises
        ------
        InputError
            No sources, a source off the mesh, limit negative or not a number, an unknown method or device.
        DeviceError
            device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(arcs): well below a microsecond a vertex.
        """
    def nearest(
        self,
        sources: _Sources,
        limit: SupportsFloat = ...,
        method: _Method = "label_correcting",
        *,
        device: _Device = "auto",
        job: Job | None = None,
    ) -> tuple[_Floats, _Indices]:
        """Distance of every vertex from the nearest source, and which source it is.

        Takes what `distances` takes.

        Returns
        -------
        distance : (V,) float64 array
            Mesh units; inf where no source reaches.
        source : (V,) int32 array
            Index into `sources`, -1 where none reaches; ties go to the smaller index.
        """
    def fields(
        self,
        sources: _Sources,
        limit: SupportsFloat = ...,
        *,
        threads: SupportsIndex = 0,
        device: _Device = "auto",
        job: Job | None = None,
    ) -> _Floats:
        """A distance field for every source alone, over threads.

        Parameters
        ----------
        sources, limit
            As `distances` takes them; each point and each curve is a source.
        threads : int
            0: all cores. The result does not depend on it.
        device : str
            As `distances`; "auto" also takes the device for eight fields and more.
        job : Job, optional

        Returns
        -------
        (n, V) float64 array
            Row i is `distances` of source i.

        Raises
        ------
        InputError
            As `distances`; more fields than there is memory for (8 n V bytes).
        Cancelled
            The job was cancelled.
        """
    def distance(
        self, a: SupportsIndex | SurfacePoints, b: SupportsIndex | SurfacePoints, *, job: Job | None = None
    ) -> float:
        """Distance between two points, by A*.

        Parameters
        ----------
        a, b : int or SurfacePoints
            A vertex or one point of the surface each.
        job : Job, optional

        Returns
        -------
        float
            Mesh units; the same bits as `distances([a])[b]`, `distances_to(a, b)` and `distance(b, a)`. inf between points of
            different components.

        Raises
        ------
        InputError
            A point off the mesh, or not one point.
        Cancelled
            The job was cancelled.

        Notes
        -----
        Distances to sixteen landmarks bound what is left of a path [goldberg2005], so that few vertices are looked at. The
        first call finds the landmarks: the time of 17 fields, 64 bytes a vertex.
        """
    def _distance_and_settled(
        self, a: SupportsIndex | SurfacePoints, b: SupportsIndex | SurfacePoints
    ) -> tuple[float, int]:
        """The distance and how many vertices its search expanded; for tests and benchmarks."""
    def distances_to(self, sources: _Sources, targets: _Points, *, job: Job | None = None) -> _Floats:
        """Distance of every target from the nearest source.

        Parameters
        ----------
        sources : (n,) int array, SurfacePoints, SurfaceCurve or a sequence of SurfaceCurves
        targets : (m,) int array or SurfacePoints
            Vertices, or points anywhere on the surface.
        job : Job, optional

        Returns
        -------
        (m,) float64 array
            Mesh units; inf where no source reaches. Between two points the same bits in both directions.

        Raises
        ------
        InputError
            No sources, a point off the mesh.
        Cancelled
            The job was cancelled.

        Notes
        -----
        A field, and for each point inside a face a window propagation of its own; points near each other are joined by their
        straight geodesic. After [ying2014] section 4.4.4.
        """
    def save(self, path: _Path, *, job: Job | None = None) -> None:
        """Write the graph to a file, without its mesh.

        The file is written beside its place and moved there when it is whole: until then an old one stays as it was. Its bytes
        depend on the graph alone.

        Parameters
        ----------
        path : str or os.PathLike
        job : Job, optional

        Raises
        ------
        InputError
            The file cannot be written: no such folder, no permission, no space.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(arcs), 8 bytes an arc.
        """
    @staticmethod
    def load(path: _Path, mesh: Mesh, *, mmap: bool = False, job: Job | None = None) -> SaddleVertexGraph:
        """Read a graph that `save` wrote for this very mesh.

        Nothing in the file is taken on trust: a damaged one is refused, never loaded as something else.

        Parameters
        ----------
        path : str or os.PathLike
        mesh : Mesh
            With the positions and triangles of the one that the graph was built for.
        mmap : bool
            Map the file into memory instead of reading it: the system brings what queries read, and programs that map the same
            file share it. Rows of arcs are looked at when they are read first, so that a damaged file leads nowhere; what only
            the whole of it tells, `check` finds. The file may be replaced (not under Windows, as long as it is mapped), but must
            not be changed in place. Files of older versions are read.
        job : Job, optional

        Returns
        -------
        SaddleVertexGraph

        Raises
        ------
        InputError
            The file cannot be read, is no graph, is of a newer version, of another mesh, cut off or damaged.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(arcs), far less than building takes; O(V) with mmap, and pages of the file in place of memory.
        """
    @staticmethod
    def from_parts(
        mesh: Mesh, parts: Iterable[_Bytes], *, threads: SupportsIndex = 0, job: Job | None = None
    ) -> SaddleVertexGraph:
        """Join the parts of a graph: the same graph, to the bit, as built at once.

        Parameters
        ----------
        mesh : Mesh
            The one whose arcs they are.
        parts : list of bytes
            What find_arcs returned of each part, or unite_arcs of each, in any order.
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Returns
        -------
        SaddleVertexGraph

        Raises
        ------
        InputError
            A part is missing, given twice, damaged, of another mesh, or found with other options or in another number of parts.
        VersionError
            A part was found by another version of the library.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(arcs): about a sixth of the time of a build, and less of united parts.
        """
    def check(self, *, job: Job | None = None) -> None:
        """Check a graph that was loaded with mmap=True as if it had been read.

        Its checksum is summed, and all of its numbers are looked at. Other graphs have been checked, or were built.

        Parameters
        ----------
        job : Job, optional

        Raises
        ------
        InputError
            The file is damaged.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(arcs).
        """
    def path(
        self,
        a: SupportsIndex | SurfacePoints,
        b: SupportsIndex | SurfacePoints,
        shorten: bool = False,
        *,
        job: Job | None = None,
    ) -> GeodesicPath:
        """The path between two points, whose length is their distance in the graph.

        Every arc is unfolded into the faces that it crosses: a polyline with one point for each edge crossed, straight in between,
        that bends at vertices only. Consecutive points share a face. A shortest path bends at saddle vertices alone, with at
        least pi on either side, as paths in an exact graph do; all other bends are what the graph is inexact by.

        Args:
            a, b: a vertex or a point anywhere on the surface each.
            shorten: straighten those bends, to a local geodesic (straight to rounding, at least pi on either side of every
                vertex that it meets), which is never longer than the distance in the graph.
            job: progress and cancellation.

        Raises:
            InputError: a point off the mesh; points on two components of the mesh, between which there is no path.
            Cancelled: the job was.

        Notes:
            A distance field from `a`, then O(faces crossed); `paths` shares one field among many targets.
        """
    def paths(
        self,
        sources: _Points,
        targets: _Points,
        shorten: bool = False,
        *,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> GeodesicPaths:
        """Paths to many targets, each from its nearest source, by one distance field.

        Args:
            sources, targets: vertices or SurfacePoints.
            shorten: as in `path`.
            threads: 0 for all cores; never changes the result.
            job: progress and cancellation.

        Returns:
            GeodesicPaths in the order of the targets; a target that no source reaches has a path without points, of length inf
            and source -1.

        Raises:
            InputError: no sources, a point off the mesh.
            Cancelled: the job was.
        """
    def log_map(
        self, center: SupportsIndex | SurfacePoints, radius: SupportsFloat, *, job: Job | None = None
    ) -> LogMap:
        """Length and direction of the shortest path to every vertex about a point.

        Exact (window propagation, no graph involved). Shortest paths that bend at a saddle vertex all leave in the direction of
        the path to it: such vertices are marked in `shadowed`. Every vertex has the coordinates of its shortest path; where there
        are several (the cut locus: the far side of a sphere, the seam behind a bump) those of one of them, so that neighbors on
        either side of it may lie far apart in the map.

        `uv` is `distance` times the unit vector of the angle. Angles are measured as `trace` does: in the chart of the point's face
        (corner 0 to corner 1 is 0) or, at a vertex, on the surface about it from its first edge. About an interior vertex they
        are scaled in `uv` so that its total angle becomes 2 pi; `angle` holds them unscaled, as `trace` takes them.
        A cone's tip or any other vertex with less than 2 pi throws such a seam: the two ways past it meet behind it.

        Args:
            center: a vertex or one surface point; one within 1e-10 (barycentric) of a vertex is that vertex.
            radius: mesh units, above 0; inf for the whole component.
            job: progress and cancellation.

        Raises:
            InputError: a point off the mesh, a radius that is not above 0.
            Cancelled: the job was.

        Notes:
            O(n sqrt(n) log n) for n vertices within the radius.
        """
    @property
    def mesh(self) -> Mesh:
        """The Mesh."""
    @property
    def arc_count(self) -> int:
        """Directed arcs; each has its reverse."""
    @property
    def mean_degree(self) -> float:
        """Arcs per vertex."""
    @property
    def nbytes(self) -> int:
        """Memory of the arcs, bytes; also of those that relaxations have made beside them."""
    @property
    def k(self) -> int | None:
        """Vertices per geodesic disk; None when built otherwise."""
    @property
    def accuracy(self) -> float | None:
        """Largest relative error accepted; None when built otherwise."""
    @property
    def is_exact(self) -> bool:
        """True if distances between vertices are exact."""
    @property
    def device(self) -> str:
        """The device that found the arcs: "cpu" or "cuda"."""
    @property
    def device_times(self) -> dict[str, float] | None:
        """Seconds of the device's part by its own clock (upload, find, unite, download), and the numbers of sources that were done in a second pass and by the processor; None when no device built it."""
    @property
    def query_times(self) -> dict[str, float] | None:
        """Seconds of the last query by a CUDA device, by its own clock (upload, find, unite, download); None when there was none."""
    @property
    def build_seconds(self) -> float:
        """Time of the build; 0 when it was loaded."""

def find_arcs(
    mesh: Mesh,
    part: SupportsIndex,
    parts: SupportsIndex,
    *,
    k: SupportsIndex | None = None,
    accuracy: SupportsFloat | None = None,
    threads: SupportsIndex = 0,
    instructions: str = "auto",
    job: Job | None = None,
) -> bytes:
    """Find the arcs of one part of a graph's vertices, for `SaddleVertexGraph.from_parts`.

    Parts may be found in any order, by other processes and on other machines; tables are laid for the part and what lies
    about it alone, so that they take little longer together than the whole at once.

    Parameters
    ----------
    mesh : Mesh
    part, parts : int
        Which one, from 0 on, of how many; all are about equally large, and some may be empty.
    k, accuracy : optional
        As of SaddleVertexGraph.
    threads : int
        0: all cores. The result does not depend on it.
    instructions : str
        As of SaddleVertexGraph. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    bytes
        The arcs, of what they are, and a checksum: about 9 bytes an arc. The same on any machine.

    Raises
    ------
    InputError
        part not within 0 to parts - 1; k or accuracy as of SaddleVertexGraph.
    Cancelled
        The job was cancelled.

    Notes
    -----
    Time grows with V / parts times the windows of a disk, and, for a tenth of the whole, with V.
    """

def arcs_across(arcs: _Bytes, part: SupportsIndex) -> bytes:
    """Return those of a part's arcs that lead into another part, as `unite_arcs` takes them.

    Parameters
    ----------
    arcs : bytes
        What find_arcs returned.
    part : int
        The other part.

    Returns
    -------
    bytes
        12 bytes an arc; of large neighboring parts a hundredth of the arcs.

    Raises
    ------
    InputError
        arcs are damaged or something else; part is their own, or out of range.

    Notes
    -----
    O(arcs).
    """

def unite_arcs(arcs: _Bytes, across: Iterable[_Bytes], *, threads: SupportsIndex = 0, job: Job | None = None) -> bytes:
    """Unite a part's arcs with the reverses of those of all others: its rows of the graph.

    `SaddleVertexGraph.from_parts` does this for all parts that find_arcs returned. Done part by part, no machine needs more
    than its own part and the arcs that lead into it, and from_parts only puts one behind the other.

    Parameters
    ----------
    arcs : bytes
        What find_arcs returned.
    across : list of bytes
        arcs_across(other, part) of each other part, in any order.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    bytes
        8 bytes an arc.

    Raises
    ------
    InputError
        Bytes are damaged, something else, or of another graph; the arcs of a part are missing, or given twice.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(arcs).
    """

@final
class LogMap:
    """Vertices about a point and the shortest ways to them."""
    @property
    def vertices(self) -> _Indices:
        """(m,) int32: vertices, ascending."""
    @property
    def uv(self) -> _Floats:
        """(m, 2) float64: distance times the unit vector of the scaled angle."""
    @property
    def distance(self) -> _Floats:
        """(m,) float64: mesh units."""
    @property
    def angle(self) -> _Floats:
        """(m,) float64: direction of departure as `trace` takes it, radians; 0 at the center."""
    @property
    def shadowed(self) -> NDArray[np.bool_]:
        """(m,) bool: the shortest path bends at a saddle vertex."""
    def __len__(self) -> int: ...

def exp_map(
    mesh: Mesh,
    center: SupportsIndex | SurfacePoints,
    uv: ArrayLike,
    *,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> SurfacePoints:
    """Returns where straightest geodesics from a point end: the inverse of `log_map`.

    Args:
        center: a vertex or one surface point.
        uv: (n, 2) vectors as in `LogMap.uv`: length and (about a vertex scaled) direction of departure.
        threads: 0 for all cores; never changes the result.
        job: progress and cancellation.

    Returns:
        SurfacePoints, n of them. A curve that the boundary stops ends there; it goes on along a straight border and past
        corners of it that it touches. Through vertices it goes on with half of the total angle on either side, unlike a shortest path that touches a saddle vertex: there alone, and where `log_map`
        says `shadowed`, the maps are not each other's inverse.

    Raises:
        InputError: a point off the mesh, a vector that is not finite, a curve over more than a million faces.
        Cancelled: the job was.
    """

@final
class PolarCoordinates:
    """Vertices about a curve."""
    @property
    def vertices(self) -> _Indices:
        """(m,) int32: vertices, ascending."""
    @property
    def distance(self) -> _Floats:
        """(m,) float64: mesh units; positive on the left of the curve, negative on its right."""
    @property
    def along(self) -> _Floats:
        """(m,) float64: arc length of the nearest point of the curve, 0 to its length (on a closed curve less than it)."""
    @property
    def shadowed(self) -> NDArray[np.bool_]:
        """(m,) bool: the shortest path bends at a saddle vertex."""
    def __len__(self) -> int: ...

def bezier_curve(
    graph: SaddleVertexGraph, controls: _Points, *, halvings: SupportsIndex = 5, job: Job | None = None
) -> SurfaceCurve:
    """The Bezier curve of control points on the surface.

    De Casteljau's construction with shortest ways in place of straight lines: it begins and ends at the first and the last
    point, in the directions of those next to them.

    Args:
        graph: the graph of the mesh.
        controls: vertices or SurfacePoints, at least two, in order; four make a cubic curve.
        halvings: 0 to 10; the curve is drawn as 2^halvings pieces.
        job: progress and cancellation.

    Returns:
        SurfaceCurve.

    Raises:
        InputError: as `curve_through`.
        Cancelled: the job was.

    Notes:
        A distance field a point, then O(faces crossed) each time that a piece is halved. After [morera2007], by halves as in [mancinelli2022]; ways stay in
        their homotopy class, so that the curve does not jump.
    """

def curve_through(
    graph: SaddleVertexGraph,
    points: _Points,
    *,
    closed: bool = False,
    smooth: bool = False,
    halvings: SupportsIndex = 5,
    job: Job | None = None,
) -> SurfaceCurve:
    """The curve through points that may be far apart.

    Shortest ways join them (`SaddleVertexGraph.path`, `shorten=True`) or, if it is to be smooth, cubic Bezier curves along the
    bisector of the directions at each point.

    Args:
        graph: the graph of the mesh.
        points: vertices or SurfacePoints, at least two (three, if closed), in order.
        closed: the curve runs on from the last point to the first.
        smooth: without corners at the points.
        halvings: 0 to 10; a smooth piece is drawn as 2^halvings pieces.
        job: progress and cancellation.

    Returns:
        SurfaceCurve.

    Raises:
        InputError: too few points, a point off the mesh, two neighbors that are the same or on different components (their
            indices are named), halvings out of range.
        Cancelled: the job was.

    Notes:
        A distance field a point, then O(faces crossed) each time that a piece is halved.
    """

def shorten_curve(curve: SurfaceCurve, *, job: Job | None = None) -> GeodesicPath:
    """Pulls a curve tight on the surface, without leaving its homotopy class.

    The ends of an open curve stay where they are. A closed curve becomes a closed geodesic, such as the ring about the
    narrowest place of a neck, or contracts to a point where nothing holds it.

    Args:
        curve: a SurfaceCurve.
        job: progress and cancellation.

    Returns:
        GeodesicPath: straight but at vertices, which it passes with at least pi on either side (but at the boundary). The
        points of a closed curve are listed once: `SurfaceCurve(mesh, path.surface, closed=True)`. One that contracts is one
        point, of length 0.

    Raises:
        InputError: no curve.
        Cancelled: the job was.

    Notes:
        O(faces crossed) a step. As the edge flips of [sharp2020], on the faces themselves; closed curves in a strip of faces
        by the least value of a convex function.
    """

def polar_coordinates(
    graph: SaddleVertexGraph,
    curve: SurfaceCurve | GeodesicPath | _Points,
    radius: SupportsFloat,
    *,
    job: Job | None = None,
) -> PolarCoordinates:
    """Coordinates along a curve for every vertex about it.

    Exact: rays leave the curve at right angles to its segments and as fans from its bends. It may cross itself, double back,
    run through vertices and along edges or the boundary. Where the nearest point of the curve is not unique (the cut locus)
    one of them is taken, so that neighbors on either side of it may lie far apart; vertices on the curve itself have
    distance 0 and the arc length where it first meets them. Behind a saddle vertex (`shadowed`) the foot is that of the way
    there. Beyond the ends of an open curve the foot is its end, and left and right are told by the curve run straight on.

    Args:
        graph: the graph of the mesh.
        curve: a SurfaceCurve, a GeodesicPath, or its points as a SurfacePoints or vertices (taken as an open curve).
        radius: mesh units, above 0; inf for everything that the curve reaches.
        job: progress and cancellation.

    Raises:
        InputError: no curve, a curve of another mesh, a radius that is not above 0.
        Cancelled: the job was.

    Notes:
        O(n sqrt(n) log n) for n vertices within the radius. After [ying2014] section 6.1, with exact rays instead of arc
        lengths along offset curves.
    """

@final
class StrokeMap:
    """The surface about a curve, laid flat without folds; made by `stroke_map`."""
    @property
    def vertices(self) -> _Floats:
        """(n, 3) float64: of the patch, in space."""
    @property
    def triangles(self) -> _Indices:
        """(m, 3) int32: of the patch, oriented as the mesh; those right of the curve come first."""
    @property
    def uv(self) -> _Floats:
        """(n, 2) float64: along the curve, 0 to `length`, and distance from it, positive on its left; mesh units."""
    @property
    def points(self) -> SurfacePoints:
        """SurfacePoints (n): the vertices on the mesh."""
    @property
    def face_origin(self) -> _Indices:
        """(m,) int32: face of the mesh that each triangle is a part of."""
    @property
    def length(self) -> float:
        """Of the curve, mesh units."""
    @property
    def area(self) -> float:
        """Of the patch, square mesh units."""
    @property
    def coverage(self) -> float:
        """Share that the patch is of all that lies beside the curve within the radius."""
    def __len__(self) -> int: ...

def stroke_map(
    mesh: Mesh,
    curve: SurfaceCurve | GeodesicPath | _Points,
    radius: SupportsFloat,
    *,
    job: Job | None = None,
) -> StrokeMap:
    """Map the surface beside a curve one to one to the plane, for pictures along it.

    `polar_coordinates` tells the truth about single vertices, but whole triangles fold where ways from two parts of the
    curve meet, and have no width about its bends and behind saddle vertices. Here none does: the patch is cut along the
    curve, across its ends at right angles, at the radius and along the cut locus, and large faces are divided. The distance
    is exact at the mesh's vertices, up to 1e-4 of the radius, and linear between them; the coordinate along the curve is the arc length on it, and off
    it harmonic, so that it passes over bends and bumps smoothly.

    Args:
        mesh: the Mesh.
        curve: a SurfaceCurve, a GeodesicPath, or its points as a SurfacePoints or vertices (taken as an open curve). A
            closed one is cut open where it starts.
        radius: mesh units, finite and at least 1/8000 of the curve's length.
        job: progress and cancellation.

    Returns:
        A StrokeMap: a triangle mesh on the surface with a place in the plane for every vertex. All its triangles have
        the same orientation there, by exact sign, and no two overlap. Left out is what lies beyond the ends of the curve and
        what no such map holds, about places where the distance is largest; `coverage` tells how much is there.

    Raises:
        InputError: a radius that is not finite and above 0, or less than 1/8000 of the curve's length, for which the map may
            take more than a million triangles (the message tells the least that works); no curve, a curve of another mesh, a
            curve that crosses or touches itself (the message tells where).
        Cancelled: the job was.

    Notes:
        O(n^1.5) for n vertices of the patch, and O(F). Fermi coordinates as in [ying2014] sections 6.1 to 6.3, by convex
        combinations [tutte1963], [floater2003] that keep the distances of exact windows.
    """

@final
class VoronoiEdge:
    """The boundary between two cells, or a part of it."""
    @property
    def points(self) -> _Floats:
        """(m, 3) float64: positions along the polyline; a closed one repeats its first point."""
    @property
    def surface(self) -> SurfacePoints:
        """These points as SurfacePoints."""
    @property
    def cells(self) -> tuple[int, int]:
        """The cells on the left and on the right."""
    @property
    def closed(self) -> bool:
        """True for a loop without branch points."""

@final
class SplitMesh:
    """A mesh in which every triangle lies in exactly one cell."""
    @property
    def vertices(self) -> _Floats:
        """(S, 3) float64: the mesh's vertices, then those on cell boundaries."""
    @property
    def triangles(self) -> _Indices:
        """(T, 3) int32."""
    @property
    def triangle_cell(self) -> _Indices:
        """(T,) int32."""
    @property
    def vertex_origin(self) -> _Indices:
        """(S,) int32: vertex of the original mesh, -1 for added ones."""

@final
class GeodesicVoronoi:
    """Geodesic Voronoi cells; made by `geodesic_voronoi`."""
    @property
    def sites(self) -> SurfacePoints:
        """SurfacePoints (n)."""
    @property
    def vertex_cell(self) -> _Indices:
        """(V,) int32: nearest site; ties: the smaller."""
    @property
    def device(self) -> str:
        """The device that found the vertices' nearest sites: "cpu" or "cuda"."""
    @property
    def vertex_distance(self) -> _Floats:
        """(V,) float64: distance to it, mesh units."""
    @property
    def areas(self) -> _Floats:
        """(n,) float64: they sum to the mesh's area."""
    @property
    def edges(self) -> list[VoronoiEdge]:
        """List of VoronoiEdge: the boundaries between cells."""
    @property
    def edge_points(self) -> _Floats:
        """(m, 3) float64: the points of all edges, one after another."""
    @property
    def edge_surface(self) -> SurfacePoints:
        """These points as SurfacePoints."""
    @property
    def edge_offsets(self) -> _Indices:
        """(e + 1,) int32: edge i is [offsets[i], offsets[i + 1])."""
    @property
    def edge_cells(self) -> _Indices:
        """(e, 2) int32: the cells on the left and on the right."""
    @property
    def edge_closed(self) -> NDArray[np.bool_]:
        """(e,) bool: loops without branch points."""
    @property
    def branch_points(self) -> SurfacePoints:
        """SurfacePoints where three or more cells meet."""
    def corners(self, cell: SupportsIndex) -> SurfacePoints:
        """SurfacePoints around a cell: branch points and ends at the mesh's boundary, the cell on the left."""
    def split(self) -> SplitMesh:
        """Cut the mesh along the cell boundaries: a SplitMesh. O(V + F)."""
    def dual_paths(self, *, threads: SupportsIndex = 0, job: Job | None = None) -> list[GeodesicPath]:
        """The edges of the dual mesh as geodesics on the surface.

        Parameters
        ----------
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Returns
        -------
        list of GeodesicPath
            In the order of `dual("strict").edges`: from site to site, the locally shortest way in the class of the shortest
            one over the boundary between their cells.

        Raises
        ------
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(faces crossed) each; of cells by the graph with a distance field for those that pass a saddle vertex. Each is as long
        as its polyline, those of exact cells do not depend on the graph.
        """
    def centers(
        self, density: ArrayLike | None = None, *, threads: SupportsIndex = 0, job: Job | None = None
    ) -> SurfacePoints:
        """The center of each cell: where its squared geodesic distances are least in sum.

        Parameters
        ----------
        density : (V,) float array, optional
            As in `centroidal_voronoi`: weighs by its square.
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Returns
        -------
        SurfacePoints
            (n). Of a cell without area or density: its site.

        Raises
        ------
        InputError
            A density of the wrong length, with a negative or not finite value, or 0 everywhere.
        Cancelled
            The job was cancelled.

        Notes
        -----
        To a millionth of the cell's size where it is flat, unless the center is beside edges of 1e-10 of that.
        O(f log f) for f faces of a cell. After [karcher1977].
        """
    def dual(
        self,
        policy: Literal["repair", "strict", "fail"] = "repair",
        *,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> DualMesh:
        """Make the dual mesh: the intrinsic Delaunay triangulation of the sites.

        Parameters
        ----------
        policy : str
            "repair": add sites where cells are too large for a triangulation of the surface (a cell that is no disk, two cells
            that meet twice, ...), until there is one, at most ten for each and 1,000. "strict": keep the sites; triangles and edges may repeat corners, and
            `issues` lists every violation. "fail": refuse where there is a violation.
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Returns
        -------
        DualMesh
            Unpacks into vertices (n, 3), triangles (t, 3) and issues (list of DualIssue).

        Raises
        ------
        InputError
            The policy is to fail and the cells have no triangulation as their dual; or so many more sites do not mend them.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(cells + boundaries). H. Edelsbrunner, N. R. Shah: Triangulating topological spaces, 1997 (the closed-ball property).
        """
    def polygons(
        self,
        policy: Literal["repair", "strict", "fail"] = "repair",
        *,
        bend: SupportsFloat = 0.15,
        tolerance: SupportsFloat = ...,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> CellPolygons:
        """Make a polygon for each cell: a mesh whose faces are the cells.

        Its vertices are where three or more cells meet, where boundaries end at the mesh's border, and where boundaries bend.
        Neighbors share their corners and sides: a closed surface gives a closed mesh. Two cells that meet along several
        boundaries, and cells with fewer than three corners, get corners within those boundaries, so that no two sides join the
        same corners.

        Parameters
        ----------
        policy : str
            For cells that are no disks, or fill a sphere by two, and so have no polygon. "repair": add sites, as `dual` does.
            "strict": `missing` names them. "fail": refuse.
        bend : float
            How far a side may leave the boundary that it stands for, in parts of the size (root of the area) of the smaller of
            its cells; where it would be more, there are corners on the way. inf: none but those needed.
        tolerance : float
            A length that it is never more than.
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Returns
        -------
        CellPolygons

        Raises
        ------
        InputError
            A negative bend; a cell without a polygon where the policy is to fail, or repair does not mend it.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O((V + F + boundaries) log F). Corners on the way after D. Douglas, T. Peucker: Algorithms for the reduction of the
        number of points required to represent a digitized line, 1973.
        """
    def cells_at(self, points: _Points) -> _Indices:
        """The cells of points of the surface (vertices or SurfacePoints), (m,) int32. Ties go to the smaller cell. O(cells that share a face) each."""
    def locate(self, points: _Points, *, job: Job | None = None) -> tuple[_Indices, _Floats]:
        """The cells of points of the surface (vertices or SurfacePoints), (m,) int32, as `cells_at`, and the distances from the nearest site, (m,) float64: lengths of ways in the graph, never too short and too long by its accuracy at most, or exact ones of exact cells. O(k log k) each. Raises Cancelled."""

@final
class CellPolygons:
    """A polygon for each cell; made by `GeodesicVoronoi.polygons`."""
    @property
    def points(self) -> SurfacePoints:
        """SurfacePoints (n): the vertices."""
    @property
    def vertices(self) -> _Floats:
        """(n, 3) float64: their positions."""
    @property
    def corners(self) -> _Indices:
        """(m,) int32: the vertices of all polygons, one after another, counter-clockwise."""
    @property
    def offsets(self) -> _Indices:
        """(p + 1,) int32: polygon i is [offsets[i], offsets[i + 1])."""
    @property
    def polygon_cell(self) -> _Indices:
        """(p,) int32, ascending."""
    @property
    def missing(self) -> _Indices:
        """(k,) int32: cells that have an area but no polygon."""
    @property
    def sites(self) -> SurfacePoints:
        """SurfacePoints: of the cells; those that repair added come last."""
    @property
    def is_barrier(self) -> NDArray[np.bool_]:
        """(m,) bool: by `corners`, whether the side from there on runs along a barrier."""
    @property
    def added(self) -> int:
        """Number of sites that repair added."""
    def triangles(self) -> _Indices:
        """The polygons cut into triangles between their corners, (t, 3) int32: a polygon of n corners into n - 2, in the order of the polygons; a fan where none of its triangles is turned over, else as Delaunay's as can be."""
    def __len__(self) -> int: ...

@final
class DualIssue:
    """A place where cells have no triangulation as their dual."""
    @property
    def kind(
        self,
    ) -> Literal["not_a_disk", "two_borders", "closed_boundary", "double_boundary", "cell_meets_itself", "few_corners"]:
        """ "not_a_disk", "two_borders", "closed_boundary", "double_boundary", "cell_meets_itself" or "few_corners"."""
    @property
    def cell(self) -> int:
        """The cell concerned."""
    @property
    def other(self) -> int | None:
        """The other cell, None where one is concerned."""
    @property
    def place(self) -> SurfacePoints:
        """SurfacePoints (1): where one more site mends it."""

@final
class DualMesh:
    """The triangulation of the sites that is dual to cells; made by `GeodesicVoronoi.dual`. Unpacks into vertices, triangles and issues."""
    @property
    def sites(self) -> SurfacePoints:
        """SurfacePoints (n): those that repair added come last."""
    @property
    def vertices(self) -> _Floats:
        """(n, 3) float64: the sites' positions, on the surface."""
    @property
    def triangles(self) -> _Indices:
        """(t, 3) int32: one for each branch point, counter-clockwise."""
    @property
    def edges(self) -> _Indices:
        """(e, 2) int32: the sites on both sides of each boundary between cells."""
    @property
    def edge_lengths(self) -> _Floats:
        """(e,) float64, mesh units: of the locally shortest way from site to site across that boundary, which `GeodesicVoronoi.dual_paths` leads along. Found when first asked for, O(faces crossed) each."""
    @property
    def cells(self) -> GeodesicVoronoi:
        """GeodesicVoronoi: the cells of its sites."""
    def quads(self, curves: Sequence[SurfaceCurve] | None = None) -> tuple[SurfacePoints, _Indices]:
        """Cut each triangle into three quads, with all vertices on the surface.

        The triangles' middles are the branch points of the cells, the edges' middles lie on the boundaries between cells: one
        step of Catmull-Clark without its smoothing, on the surface.

        Parameters
        ----------
        curves : sequence of SurfaceCurve, optional
            Along which edges of the mesh run: an edge between two sites on them has its middle where the boundary between their
            cells crosses them.

        Returns
        -------
        tuple of SurfacePoints and (q, 4) int32
            Points: the sites, the middle of each of `edges`, the branch points. Quads: counter-clockwise, from the branch
            point. Between sites on the mesh's border the middle is where the boundary of their cells ends.

        Raises
        ------
        InputError
            Curves of another mesh.

        Notes
        -----
        O(cells + boundaries). After E. Catmull, J. Clark: Recursively generated B-spline surfaces, 1978.
        """
    @property
    def issues(self) -> list[DualIssue]:
        """List of DualIssue; empty: a triangulation of the surface."""
    @property
    def added(self) -> int:
        """Number of sites that repair added."""
    @property
    def euler_characteristic(self) -> int:
        """Vertices - edges + triangles."""
    def __iter__(self) -> Iterator[_Floats | _Indices | list[DualIssue]]: ...

@final
class Quality:
    """Measures of a triangle mesh; made by `triangle_quality`."""
    @property
    def quality(self) -> _Floats:
        """(T,) float64: 6 S / (sqrt(3) p h) of area S, half perimeter p, longest edge h; 1 is best."""
    @property
    def least_angle(self) -> _Floats:
        """(T,) float64, radians."""
    @property
    def greatest_angle(self) -> _Floats:
        """(T,) float64, radians."""
    @property
    def valence(self) -> _Indices:
        """(V,) int32: edges at each vertex."""
    @property
    def irregular(self) -> float:
        """Share of vertices whose valence is not 6 (on the boundary not 4)."""
    @property
    def mean_quality(self) -> float:
        """Mean quality of the triangles."""
    @property
    def min_quality(self) -> float:
        """Least quality of the triangles."""
    @property
    def mean_angle(self) -> float:
        """Mean of the least angles, radians."""
    @property
    def min_angle(self) -> float:
        """The least angle of all, radians."""

@final
class HausdorffDistance:
    """The distance of two surfaces from each other; made by `hausdorff_distance`."""
    @property
    def distance(self) -> float:
        """The greater of the two."""
    @property
    def from_first(self) -> float:
        """Greatest distance of a point of the first mesh from the second."""
    @property
    def from_second(self) -> float:
        """Greatest distance of a point of the second mesh from the first."""
    @property
    def farthest_of_first(self) -> SurfacePoints:
        """SurfacePoints (1) of the first mesh."""
    @property
    def farthest_of_second(self) -> SurfacePoints:
        """SurfacePoints (1) of the second mesh."""

def hausdorff_distance(
    first: Mesh,
    second: Mesh,
    tolerance: SupportsFloat = 1e-4,
    *,
    limit: SupportsFloat = 0.0,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> HausdorffDistance:
    """Measure how far two surfaces are from each other, through space.

    Parameters
    ----------
    first, second : Mesh
    tolerance : float
        By which distances may be too small, as a share of the diagonal of both meshes' box.
    limit : float
        A length, 0 for none: only whether something is farther is found out, which takes less time. A distance above the
        limit may be any of those; one below may be anything up to it, or the tolerance more than it says.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    HausdorffDistance

    Raises
    ------
    InputError
        A tolerance that is not above 0, a limit that is negative.
    Cancelled
        The job was cancelled.

    Notes
    -----
    All points of the triangles count, not the vertices alone. About O((V + F) log F). M. Tang, M. Lee, Y. J. Kim:
    Interactive Hausdorff distance computation for general polygonal models, 2009.
    """

def triangle_quality(vertices: ArrayLike, triangles: ArrayLike) -> Quality:
    """Measure how near triangles are to equilateral ones.

    Parameters
    ----------
    vertices : (V, 3) float array
    triangles : (T, 3) int array
        Any triangles, manifold or not.

    Returns
    -------
    Quality

    Raises
    ------
    InputError
        An index out of range, a coordinate that is not finite.

    Notes
    -----
    O(V + T log T). After [frey1999].
    """

def neighbor_means(triangles: ArrayLike, values: ArrayLike) -> _Floats:
    """Mean of the numbers at the other corners of the triangles around each vertex.

    Parameters
    ----------
    triangles : (T, 3) int array
    values : (V, k) float array
        Numbers of each vertex, one at least.

    Returns
    -------
    (V, k) float64
        A neighbor on two of the triangles counts twice; zero where no triangle is. O(V k + T k).
    """

def vertex_normals(vertices: ArrayLike, triangles: ArrayLike) -> _Floats:
    """Unit normals of plain triangles' vertices, weighted by area.

    Parameters
    ----------
    vertices : (V, 3) float array
    triangles : (T, 3) int array

    Returns
    -------
    (V, 3) float64; zero where no triangle with an area meets the vertex. O(V + T).
    """

def triangle_edges(triangles: ArrayLike, vertex_count: SupportsIndex) -> tuple[_Indices, _Indices]:
    """Number the edges of triangles, in the order in which these come upon them, whichever way round.

    Parameters
    ----------
    triangles : (T, 3) int array
    vertex_count : int

    Returns
    -------
    ends : (e, 2) int32
        The vertices of each edge, once.
    corner_edges : (3 T,) int32
        The edge from each triangle's corner to its next one. O(V + T).
    """

def border_edges(triangles: ArrayLike, vertex_count: SupportsIndex) -> tuple[_Indices, _Indices]:
    """Find the edges that only one triangle uses.

    Parameters
    ----------
    triangles : (T, 3) int array
    vertex_count : int

    Returns
    -------
    ends : (b, 2) int32
        From and to, in the triangle's orientation.
    triangles : (b,) int32
        The one that uses the edge, in increasing order. O(V + T).
    """

def connected_parts(triangles: ArrayLike, vertex_count: SupportsIndex) -> _Indices:
    """Tell which triangles hang together.

    Parameters
    ----------
    triangles : (T, 3) int array
    vertex_count : int

    Returns
    -------
    (T,) int32
        The part of each, numbered in the order in which the triangles come upon them: those of one part lead to each other
        over common vertices. O(V + T).
    """

def cut_at_level(
    fields: ArrayLike, triangles: ArrayLike, column: SupportsIndex, level: SupportsFloat
) -> tuple[_Floats, _Indices, _Indices, NDArray[np.bool_]]:
    """Cut triangles along the line where a function that is linear over each equals a level.

    Parameters
    ----------
    fields : (V, k) float array
        All numbers of a vertex side by side, the position first: new vertices interpolate each of them, and are shared by
        both sides, so that no crack opens.
    triangles : (T, 3) int array
    column : int
        Of the function. A vertex nearer to the level than 1e-9 of its greatest value is on it. Values may be infinite, as
        distances beyond a limit are: an edge from a finite value to such a one crosses the level at its finite end.
    level : float
        Finite.

    Returns
    -------
    fields : (W, k) float64
        The given vertices, then the new ones.
    triangles : (U, 3) int32
    parents : (U,) int32
        The given triangle that each is part of, in increasing order.
    aboves : (U,) bool
        Whether it lies above the level; a triangle wholly on it does not. O(V k + T).
    """

def segment_distances(
    points: ArrayLike,
    point_group: ArrayLike,
    starts: ArrayLike,
    ends: ArrayLike,
    segment_group: ArrayLike,
    *,
    job: Job | None = None,
) -> _Floats:
    """Measure how far points are from straight segments, each from those of its own group only.

    Parameters
    ----------
    points : (n, 3) float array
    point_group : (n,) int array
        The group of each point, 0 or more: the cell that it lies in, say.
    starts, ends : (m, 3) float arrays
        Of the segments.
    segment_group : (m,) int array
        The group of each.
    job : Job, optional

    Returns
    -------
    (n,) float64
        Straight through space; infinity where the group has no segment. O(n + m log m) and for each point the segments of
        its group.

    Raises
    ------
    InputError
        A group below 0; another number of groups than points or segments.
    Cancelled
    """

def self_crossings(
    vertices: ArrayLike,
    triangles: ArrayLike,
    among: ArrayLike | None = None,
    *,
    owners: ArrayLike | None = None,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> _Indices:
    """Find the triangles that pass through each other.

    Exact for the coordinates as they are. Triangles that only touch, lie in one plane or share an edge are no such pair.

    Parameters
    ----------
    vertices : (V, 3) float array
    triangles : (T, 3) int array
    among : (n,) int array, optional
        Numbers of triangles, rising: only pairs of which one is among these.
    owners : (T,) int array, optional
        Whose each triangle is: only pairs of different owners, which is quicker than to look at all and leave out the rest.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    (k, 2) int32
        Numbers of triangles, the smaller first, in order. About O(T log n), where n = T without `among`.

    Raises
    ------
    InputError
        A corner that is no vertex, a vertex that is not finite, an `among` that does not rise, a wrong number of owners.
    Cancelled
        The job was cancelled.
    """

def cell_boundary(
    triangles: ArrayLike, triangle_cell: ArrayLike, vertex_count: SupportsIndex
) -> tuple[_Indices, _Indices]:
    """Find the edges between triangles of different cells.

    Parameters
    ----------
    triangles : (T, 3) int array
    triangle_cell : (T,) int array
    vertex_count : int

    Returns
    -------
    segments : (b, 2) int32
        The two vertices of each; the border of the mesh is no boundary of a cell.
    cells : (b, 2) int32
        The two cells beside each. O(V + T).
    """

def cell_boundary_distance(
    vertices: ArrayLike, triangles: ArrayLike, triangle_cell: ArrayLike, limit: SupportsFloat = ...
) -> _Floats:
    """Measure how far vertices are from the boundary of the cell that they lie in.

    Parameters
    ----------
    vertices : (V, 3) float array
    triangles, triangle_cell : (T, 3), (T,) int arrays
        Every triangle inside one cell, as `split` gives them.
    limit : float
        Vertices farther than one ring beyond it get infinity.

    Returns
    -------
    (V,) float64
        0 on a boundary, infinity in a cell without one. Straight distances to segments that were reached on the surface:
        never too short, at most a few percent too long near the middle line of a cell with a ragged boundary.

    Notes
    -----
    O(V + T) for a fixed number of rings. A vector distance transform [danielsson1980].
    """

def refine_to_cell_boundary(
    fields: ArrayLike,
    triangles: ArrayLike,
    triangle_cell: ArrayLike,
    levels: ArrayLike,
    tolerance: SupportsFloat,
) -> tuple[_Floats, _Indices, _Indices]:
    """Refine triangles until lines of equal distance to the boundary of the cells come out right on them.

    On triangles as large as the cells the distance is not linear: where all corners lie on the boundary it would be 0 all
    over. An edge is halved where the distance in its middle differs too much from the mean of both ends, and one of the
    levels is crossed.

    Parameters
    ----------
    fields : (V, k) float array
        All numbers of a vertex side by side, the position first; new vertices get the means of theirs. The last is filled
        with the distance, as `cell_boundary_distance` finds it.
    triangles, triangle_cell : (T, 3), (T,) int arrays
        Every triangle inside one cell, as `split` gives them.
    levels : (n,) float array
        Distances from the boundary whose lines `cut_at_level` is to find.
    tolerance : float
        By about which share of its level each may be off.

    Returns
    -------
    fields : (W, k) float64
        The given vertices, then the new ones.
    triangles, triangle_cell : (U, 3), (U,) int32
        O(V + U) for a fixed number of rings.

    Raises
    ------
    InputError
        A wrong number of cells, a tolerance that is not above 0.
    """

def geodesic_center(
    graph: SaddleVertexGraph, points: _Points, weights: ArrayLike | None = None, *, job: Job | None = None
) -> SurfacePoints:
    """Find the point from which squared geodesic distances to points are least in sum.

    Parameters
    ----------
    graph : SaddleVertexGraph
    points : (n,) int array or SurfacePoints
        Vertices, or points anywhere on one connected part of the surface.
    weights : (n,) float array, optional
        0 or more. None: all the same.
    job : Job, optional

    Returns
    -------
    SurfacePoints
        One point. Where there are several such points, the one that the given point nearest to the mean in space leads to;
        on a mesh with lengths of its own, the first given one.

    Raises
    ------
    InputError
        No points, points off the mesh or on separate parts, weights that are negative, not finite or all 0.
    Cancelled
        The job was cancelled.

    Notes
    -----
    Steps to the mean of the points in the tangent plane, by exact distances, while they lower the sum and are longer than
    1e-9 of the points' spread. Where the sum has a crease, through a saddle vertex, they may end beside its least. A few
    log maps, O(m sqrt(m) log m) each for m vertices within the spread of the points. After [karcher1977].
    """

@final
class BakedCells:
    """Images of cells; made by `bake_cells`. Row 0 is the lowest."""
    @property
    def triangle(self) -> _Indices:
        """(height, width) int32: which of the given triangles a texel's center lies in; -1: none."""
    @property
    def cell(self) -> _Indices:
        """(height, width) int32, -1 beyond the margin, where all else is 0."""
    @property
    def edge_distance(self) -> NDArray[np.float32] | None:
        """(height, width) float32: geodesic distance to the boundary of the cell, infinity where it has none; None where it was not wanted."""
    @property
    def local_uv(self) -> NDArray[np.float32] | None:
        """(height, width, 2) float32: the logarithm about the cell's site, mesh units; None where it was not wanted."""
    @property
    def values(self) -> NDArray[np.float32] | None:
        """(height, width, channels) float32; None without values."""
    @property
    def farthest(self) -> NDArray[np.float32]:
        """(cells,) float32: the largest edge distance of the texels of each, 0 where there is none."""
    @property
    def overlapping(self) -> _Indices:
        """(k,) int32: triangles that share texels' centers with others, deeper than rounding."""
    @property
    def without_area(self) -> _Indices:
        """(k,) int32: triangles that have no area in the UV map, and are nowhere seen."""
    @property
    def outside(self) -> _Indices:
        """(k,) int32: triangles that are nowhere in the image."""

def bake_cells(
    cells: GeodesicVoronoi,
    uv: ArrayLike,
    faces: ArrayLike | None = None,
    *,
    values: ArrayLike | None = None,
    axes: ArrayLike | None = None,
    size: tuple[SupportsIndex, SupportsIndex] = (1024, 1024),
    tile: tuple[SupportsIndex, SupportsIndex] = (0, 0),
    margin: SupportsIndex = 16,
    edge_distance: bool = True,
    local_uv: bool = True,
    allow_overlaps: bool = False,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> BakedCells:
    """Images of cells: what each texel of a UV map shows, found on the surface itself.

    For the center of every texel its triangle and its place there; from that, on the surface, the cell that holds it (as
    the outlines of cells are), the geodesic distance to the boundary of the cell, and the logarithm about the cell's site.
    Nothing is interpolated between vertices but `values`.

    Parameters
    ----------
    cells : GeodesicVoronoi
    uv : (3 n, 2) float array
        Places in the UV map of the corners of each of `faces`, in order.
    faces : (n,) int array, optional
        Faces of the mesh; one may be there several times, or not at all. None: all of them.
    values : (3 n, channels) float array, optional
        Numbers at the same corners, linear between.
    axes : (sites, 3) float array, optional
        Directions in space at the sites, in which the first coordinate of the logarithms points. None: as `log_map`.
    size : (int, int)
        Width and height in texels, 1 to 16384 each.
    tile : (int, int)
        The square of the UV plane that is seen: the UDIM tile 1001 + u + 10 v.
    margin : int
        0 to 1024 texels: as far from the triangles, texels get what the nearest texel within one has.
    edge_distance, local_uv : bool
        Whether these are wanted.
    allow_overlaps : bool
        Where triangles overlap the first of them is seen, instead of an InputError.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    BakedCells

    Raises
    ------
    InputError
        A size or margin out of range, places that are not finite, arrays of other lengths, faces off the mesh; triangles
        that overlap, with their number.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(texels (windows about a face + log(texels of a cell))), and window propagation within each cell. Distances and
    logarithms are exact up to rounding to float32. After [chen1990].
    """

def geodesic_voronoi(
    graph: SaddleVertexGraph,
    sites: _Points,
    *,
    exact: bool = False,
    threads: SupportsIndex = 0,
    device: str = "auto",
    job: Job | None = None,
) -> GeodesicVoronoi:
    """Assign every point of the surface to its nearest site.

    Bisectors are straight inside a face, right where both sites see it straight, past no saddle vertex and by one way.
    Cells smaller than a face, and several sites in one face, are found.

    Parameters
    ----------
    graph : SaddleVertexGraph
    sites : (n,) int array or SurfacePoints
        Vertices, or points anywhere on the surface.
    exact : bool
        By exact distances instead of the graph's, as a reference: bisectors are hyperbolas where they should be, and no
        point lies in a cell whose site is farther than another by more than 1e-5 of a cell's size (the root of its area).
        Sites within 1e-10 of the extent of their part of the mesh of each other are one: the first of them has the cell.
        Where lengths were given, the extent is the root of its area, or its longest edge.
        Many times slower.
    threads : int
        0: all cores. The result does not depend on it.
    device : str
        "cpu"; "cuda", or "cuda:1" for the second CUDA device, which finds the vertices' nearest sites, all else being the
        processor's part, and keeps the graph's arcs from then on; "auto": that where a CUDA device built the graph or keeps
        it. Not with `exact`. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    GeodesicVoronoi

    Raises
    ------
    InputError
        No sites, too many, a site off the mesh, a connected part of the mesh without a site; exact cells by a CUDA device.
    DeviceError
        device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n k log k + arcs). After Y.-J. Liu, Z. Chen, K. Tang: Construction of iso-contours, bisectors, and Voronoi diagrams on
    triangulated surfaces, IEEE TPAMI 33(8), 2011.
    """

@final
class CentroidalVoronoi:
    """Even cells; made by `centroidal_voronoi`."""
    @property
    def sites(self) -> SurfacePoints:
        """SurfacePoints (n)."""
    @property
    def cells(self) -> GeodesicVoronoi:
        """GeodesicVoronoi of the sites."""
    @property
    def energy(self) -> _Floats:
        """(iterations + 1,) float64: at the start and after each iteration; never rises. After an exchange of sites (`closed_ball`) those of the relaxation that followed."""
    @property
    def iterations(self) -> int:
        """Iterations done."""
    @property
    def converged(self) -> bool:
        """False when max_iterations ended it."""
    @property
    def held(self) -> _Indices:
        """(n,) int32: the curve that each site is held on, -1 for free ones."""
    @property
    def stop_reason(self) -> str:
        """ "tolerance", "no step lowers the energy", "least_move", "max_iterations" or "cancelled"; "closed_ball" where no more steps kept the dual a triangulation."""
    @property
    def normalized_energy(self) -> float:
        """Energy without a scale: near 1 for many nearly regular hexagons, larger for worse cells."""
    @property
    def exchanged(self) -> int:
        """Number of sites that `closed_ball` moved to where the dual's topology needs them."""
    @property
    def issues(self) -> list[DualIssue]:
        """List of DualIssue, with `closed_ball`: where the cells' dual is no triangulation all the same."""

@final
class RelaxationStep:
    """The sites after some iteration of a relaxation; from `RelaxationWatch.latest`."""
    @property
    def sites(self) -> SurfacePoints:
        """(n,) SurfacePoints."""
    @property
    def iterations(self) -> int:
        """Number of iterations done; 0: the start."""
    @property
    def energy(self) -> float:
        """Energy as in `CentroidalVoronoi.energy`."""

@final
class RelaxationWatch:
    """Shows the sites of a relaxation while it goes on in another thread.

    Pass it as ``watch=`` to `centroidal_voronoi`. Coarse cells and annealing, which make the start, are not shown. After an exchange of
    sites (`closed_ball`) the iterations begin again.
    """
    def __init__(self) -> None: ...
    def latest(self) -> RelaxationStep | None:
        """The `RelaxationStep` that was reached, None before the first. O(1)."""

@final
class CellCache:
    """Keeps the cells that a relaxation ended with, for the next one on the same graph.

    Pass it as ``cache=`` to `centroidal_voronoi`. Called again with the same graph, that finds anew only cells whose sites, or
    whose neighbors' sites, are elsewhere: move, add or remove a few of the result's sites (the others in the same order) and
    only their surroundings are computed. With another density, all masses and centers are found anew, and no cells. With
    ``least_move`` above 0 this goes for every iteration. Other cells stay the same to the bit. About 1 KB a vertex, and the
    graph, are kept.
    """
    def __init__(self) -> None: ...
    def clear(self) -> None:
        """Forgets what is kept."""

def centroidal_voronoi(
    graph: SaddleVertexGraph,
    sites: _Points | None = None,
    count: SupportsIndex | None = None,
    density: ArrayLike | None = None,
    method: Literal["lbfgs", "lloyd"] = "lbfgs",
    max_iterations: SupportsIndex = 100,
    tolerance: SupportsFloat = 1e-6,
    seed: SupportsIndex = 0,
    *,
    start: Literal["auto", "coarse_to_fine", "coarse_mesh", "sample"] = "auto",
    starts: SupportsIndex = 1,
    annealing: SupportsIndex = 0,
    fixed: ArrayLike | None = None,
    curves: Sequence[SurfaceCurve] | None = None,
    held: ArrayLike | None = None,
    least_move: SupportsFloat = 0.0,
    cache: CellCache | None = None,
    closed_ball: bool = False,
    return_when_cancelled: bool = False,
    watch: RelaxationWatch | None = None,
    threads: SupportsIndex = 0,
    device: str = "auto",
    job: Job | None = None,
) -> CentroidalVoronoi:
    """Spread sites so that each lies at the center of its cell: even cells.

    Parameters
    ----------
    graph : SaddleVertexGraph
    sites : (n,) int array or SurfacePoints, optional
        Where to start. Either this or `count`.
    count : int, optional
        Number of cells, at least one on every connected part; see `start`.
    density : (V,) float array, optional
        Wanted number of cells per area at each vertex, in proportion; 0 or more. None: the same everywhere.
    method : str
        "lbfgs" (fewer iterations) or "lloyd" (each site to the center of its cell).
    max_iterations : int
    tolerance : float
        Stop when the energy falls by less than this share of itself.
    seed : int
        Of the sampled start.
    start : str
        Where the sites of `count` come from. "coarse_to_fine": relaxed cells of a quarter of the number, with one more on
        each boundary between two of them, and so on down; few irregular cells remain. "sample": by density and seed. The
        same without iterations. "auto": from coarse cells when max_iterations is 50 or more. "coarse_mesh": from cells
        relaxed so on a mesh of 20 vertices for each (10,000 at least), where the mesh has five times as many vertices, no
        lengths of its own and no site is fixed: a tenth of max_iterations, 5 at least, is then made, and counted, on the
        mesh itself. As even cells, of a million vertices in a fourth of the time.
    starts : int
        With `count`: so many relaxations, by the seeds from `seed` on. The one with the least energy is the result: where a
        relaxation ends depends on where it began.
    annealing : int
        So many steps of simulated annealing before the iterations, each as long as one of those: the sites are shaken, less
        and less. Ends with less energy, and more even triangles, than any number of iterations; 300 are many. Sites that
        would end with more energy are left as they were.
    fixed : (m,) int array, optional
        Sites that stay where they are.
    curves : sequence of SurfaceCurve, optional
        Features or boundaries that sites slide along instead of leaving them. With `count`, sites are put on them as far
        apart as neighbors in even cells; the ends of open curves stay where they are (of those
        less than half a cell apart along curves, one). Others whose cells reach across a
        curve are put onto it.
    held : (n,) int array, optional
        With `sites`: the curve that each is held on, -1 for free ones. Held sites begin at the nearest points of their curves.
    least_move : float
        Sites that an iteration would move by less, in roots of their cells' areas, stay where they are, and cells that
        neither move nor have neighbors that do are not found anew: where most sites rest, iterations are short. When all
        would stay, the run ends. 1e-3 is less than one sees.
    cache : CellCache, optional
        Cells to begin with, and afterwards those of the result.
    closed_ball : bool
        Afterwards move sites from where they are least needed to where the cells break the closed-ball property (a cell that
        is no disk, two cells that meet twice, ...), and relax all again as far as nothing breaks it: the dual of just `count`
        sites is then a triangulation of the surface. Fixed sites stay, held ones stay on their curves. The energy may end
        above where the first relaxation did. Where no site can be spared, or 40 rounds of moving some do not help, or ten do
        not leave fewer faults, the sites are left as they were, and `CentroidalVoronoi.issues` tells so.
    return_when_cancelled : bool
        When the job is cancelled during annealing or the iterations, return the best found so far instead of raising.
    watch : RelaxationWatch, optional
        Shown the start and each iteration, for another thread to look at meanwhile.
    threads : int
        0: all cores. The result does not depend on it.
    device : str
        "cpu"; "cuda", or "cuda:1" for the second CUDA device, which finds the vertices' nearest sites in every iteration, all
        else being the processor's part, and keeps the graph's arcs from then on; "auto": that where a CUDA device built the
        graph or keeps it. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    CentroidalVoronoi

    Raises
    ------
    InputError
        Neither or both of sites and count; fewer cells than connected parts, or than the curves need; a fixed site or a curve
        out of range, a curve of another mesh; a density of the wrong length, with a negative or not finite value, or 0 everywhere; what `geodesic_voronoi` refuses.
    DeviceError
        device="cuda" where there is no usable CUDA device or module, too little of its memory is free, or it fails.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n k log k + arcs) per iteration. The energy is the integral of density^2 times squared distance and never rises.
    Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, SIAM Review 41(4), 1999. Y. Liu, W. Wang, B. Levy,
    F. Sun, D.-M. Yan, L. Lu, C. Yang: On centroidal Voronoi tessellation, ACM TOG 28(4), 2009. S. Kirkpatrick, C. Gelatt,
    M. Vecchi: Optimization by simulated annealing, Science 220, 1983.
    """

class predicates:  # noqa: N801  (a module; for tests)
    """Exact geometric predicates on arrays of points; for tests."""
    @staticmethod
    def orient_2d(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> _Indices: ...
    @staticmethod
    def in_circle(a: ArrayLike, b: ArrayLike, c: ArrayLike, d: ArrayLike) -> _Indices: ...
    @staticmethod
    def collinear_3d(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> _Indices: ...
    @staticmethod
    def lengths_2d(vectors: ArrayLike) -> _Reals: ...

_Domain: TypeAlias = ArrayLike | Sequence[ArrayLike]

@final
class ClippedCells:
    """Cells within a domain; made by `Voronoi2d.clip`."""
    @property
    def points(self) -> _Floats:
        """(P, 2) float64: corners of all loops, one after another."""
    @property
    def loop_offsets(self) -> _Indices:
        """(L + 1,) int32: loop i is [offsets[i], offsets[i + 1])."""
    @property
    def loop_sites(self) -> _Indices:
        """(L,) int32, ascending: outlines turn counter-clockwise, holes clockwise."""
    @property
    def areas(self) -> _Floats:
        """(n,) float64: 0 outside, and for sites equal to an earlier one. They sum to the domain's."""
    @property
    def centroids(self) -> _Floats:
        """(n, 2) float64: not a number where the area is 0."""

@final
class Voronoi2d:
    """Voronoi diagram of the plane; made by `voronoi_2d`."""
    @property
    def sites(self) -> _Floats:
        """(n, 2) float64: as given."""
    @property
    def weights(self) -> _Floats:
        """(n,) float64: as given, or (0,) if they are equal."""
    @property
    def powers(self) -> _Floats:
        """(n,) float64: the weights of a power diagram as given, or (0,) of others."""
    @property
    def site_of(self) -> _Indices:
        """(n,) int32: smallest index of an equal site; only such sites have a cell."""
    @property
    def hidden(self) -> _Indices:
        """(h,) int32, ascending: sites without a cell, since heavier ones leave them none."""
    @property
    def vertices(self) -> _Floats:
        """(V, 2) float64."""
    @property
    def edges(self) -> _Indices:
        """(E, 2) int32 vertices; -1 at infinity: (v, -1) is a ray, (-1, -1) a line."""
    @property
    def edge_sites(self) -> _Indices:
        """(E, 2) int32: the sites left and right of the edge."""
    @property
    def edge_directions(self) -> _Floats:
        """(E, 2) float64 unit vectors from first to second vertex; of a ray outwards, where a curved one goes at last."""
    @property
    def delaunay(self) -> _Indices:
        """(T, 3) int32 sites, counter-clockwise: the Delaunay triangulation. Triangles about one vertex share its smallest site."""
    @property
    def areas(self) -> _Floats:
        """(n,) float64: areas of the cells, inf for open ones, 0 for hidden sites. Equal sites have the same cell."""
    @property
    def centroids(self) -> _Floats:
        """(n, 2) float64: centers of mass of the cells, not a number for open ones."""
    @property
    def device(self) -> str:
        """The device that found the diagram: "cpu" or "cuda"."""
    @property
    def device_times(self) -> dict[str, float] | None:
        """Seconds of the device's part by its own clock (upload, order, find, unite, download), and the numbers of sites that took a second pass or the processor; None when no device found it."""
    @property
    def clipped(self) -> ClippedCells | None:
        """ClippedCells within the domain given to `voronoi_2d`, or None."""
    @property
    def cells(self) -> tuple[_Indices, _Indices]:
        """(n + 1,) int32 offsets and int32 vertices: the cell of site i is vertices[offsets[i]:offsets[i + 1]], counter-clockwise, -1 where it is open; empty for a site equal to an earlier one."""
    def edge_polyline(self, edge: SupportsIndex, tolerance: SupportsFloat, extent: SupportsFloat = 0.0) -> _Floats:
        """Points along an edge, from its first to its second vertex.

        Parameters
        ----------
        edge : int
        tolerance : float
            How far any point of the curve, a branch of a hyperbola where the weights differ, may be from the polyline. One
            finer than 1e-12 of what the curve spans is taken as that, which takes up to 500,000 points.
        extent : float
            Where an infinite end is cut off: so much farther from the middle of the curve, the point between the two sites, than
            the edge's vertex is, or than the middle itself if that comes later. 0: twice the distance of the sites.

        Returns
        -------
        (k, 2) float64 array, k = 2 for a straight edge

        Raises
        ------
        InputError
            An edge that does not exist, lengths that are not positive.

        Notes
        -----
        O(k).
        """
    def clip(
        self,
        polygon: _Domain,
        *,
        gap: SupportsFloat = 0.0,
        tolerance: SupportsFloat = 0.0,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> ClippedCells:
        """The cells within a simple polygon with holes: ClippedCells.

        Parameters
        ----------
        polygon : (m, 2) float array or list of such
            A simple polygon, or an outline and its holes, in any direction. Corners may be repeated in a row, and loops may touch
            other loops in points.
        gap : float
            How far neighboring cells are apart; the polygon's own sides stay. A cell narrower than that has no loop, one with a
            waist several. With weights each cell keeps half of it from all others, within the tolerance.
        tolerance : float
            How far polylines may be from curved edges; 0: a thousandth of a mean cell's width. One finer than 3.7e-9 of
            that width is taken as that, with which an edge as long as a cell is wide has some thousands of points. Neighbors
            share their points, so that areas, which are those of the polygons, sum to the domain's all the same.
        threads : int
            0: all cores.
        job : Job, optional

        Raises
        ------
        InputError
            Fewer than three corners, loops that touch themselves, cross or share a part of a side, a hole outside the outline, a
            gap that is negative or not finite.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(n), and O(m) for each cell at the polygon's edges.
        """
    def locate(self, points: ArrayLike, *, threads: SupportsIndex = 0, job: Job | None = None) -> _Indices:
        """Nearest site of each point, exactly; of equally near ones the smallest index.

        With weights the one with the smallest distance less its weight; of a power diagram the one with the least power. Hidden
        sites, whose cells have no area, are not found.

        Parameters
        ----------
        points : (m, 2) float array
        threads : int
            0: all cores.
        job : Job, optional

        Returns
        -------
        (m,) int32 array

        Raises
        ------
        InputError
            A coordinate that is not finite, or a diagram without sites.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(n + m) expected.
        """
    def cell_vertices(self, site: SupportsIndex) -> _Indices:
        """(k,) int32: vertices around a site's cell, counter-clockwise; -1 where it is open."""
    def cell_edges(self, site: SupportsIndex) -> _Indices:
        """(k,) int32: edges around a site's cell; edge k leads to vertex k of `cell_vertices`."""

def voronoi_2d(
    sites: ArrayLike,
    weights: ArrayLike | None = None,
    domain: _Domain | None = None,
    circles: SupportsIndex = 0,
    threads: SupportsIndex = 0,
    device: _Device = "auto",
    job: Job | None = None,
    *,
    pinned: bool = False,
) -> Voronoi2d:
    """Voronoi diagram of points or disks of the plane.

    Which cells touch, and where more than three meet in one vertex, is exact; only coordinates are rounded. With weights a
    point x belongs to the site with the smallest |x - site| - weight: edges are branches of hyperbolas, two cells may share
    several edges, and a site whose disk lies in another's is hidden.

    Parameters
    ----------
    sites : (n, 2) float array
        Any finite numbers in any order. Equal sites (of equal weight) share one cell.
    weights : (n,) float array, optional
        Radii of the sites; negative ones too, since only differences matter.
    domain : (m, 2) float array or list of such, optional
        A simple polygon, or an outline and its holes: `clipped` then holds the cells within.
    circles : int
        How many sweep circles, or parts of weighted sites, share the work; 0: as many as are good. The result does not
        depend on it.
    threads : int
        0: all cores. The result does not depend on it.
    device : str
        "auto", "cpu", "cuda" or, for another than the first CUDA device, "cuda:1"; "cuda:0,1" and "cuda:all" let several
        share the work. The result does not depend on it; what a device is not made for (few or scattered sites,
        weighted ones that share a place) runs on the processor.
    job : Job, optional
    pinned : bool
        Whether results come into memory that a CUDA device writes by itself, for one diagram after the other: the first
        takes longer, the others up to a quarter less. See `release_pinned_memory`. Sites in such memory (CuPy's, PyTorch's)
        are always read by the device itself.

    Returns
    -------
    Voronoi2d

    Raises
    ------
    InputError
        A coordinate or weight that is not finite, a wrong number of weights, coordinates so different in size that exact arithmetic cannot take them, a domain
        that is not a simple polygon with holes.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n log n) time (with weights: expected, for evenly spread sites), O(n) memory. H. Tong: the sweep circle that needs
    no transformation.
    """

def power_diagram_2d(
    sites: ArrayLike,
    weights: ArrayLike,
    domain: _Domain | None = None,
    *,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> Voronoi2d:
    """Power diagram of points of the plane (Laguerre's): weights move the borders between cells, which stay straight.

    A point x belongs to the site with the least power |x - site|^2 - weight. With the weight r^2 a site is a circle of radius
    r, and where two circles cross, the border runs through both crossings. A site may lie outside of its cell. Which cells
    there are, which touch, and where more than three meet in one vertex, is exact; only coordinates are rounded.

    Parameters
    ----------
    sites : (n, 2) float array
        Any finite numbers in any order. Of sites at one place the heaviest has a cell; equal ones share it.
    weights : (n,) float array
        Squares of lengths; negative ones too, since only differences matter.
    domain : (m, 2) float array or list of such, optional
        A simple polygon, or an outline and its holes: `clipped` then holds the cells within.
    threads : int
        Of all but the triangulation, which takes one. 0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    Voronoi2d
        Its `powers` are the weights, its `delaunay` the regular triangulation, and `hidden` the sites without a cell, or with
        one without an area.

    Raises
    ------
    InputError
        A coordinate or weight that is not finite, a wrong number of weights, coordinates or weights so different in size that
        exact arithmetic cannot take them, a domain that is not a simple polygon with holes.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n log n) expected, O(n) memory. F. Aurenhammer: Power diagrams, 1987. H. Edelsbrunner, N. Shah: Incremental topological
    flipping works for regular triangulations, 1996.
    """

@final
class PeriodicVoronoi2d:
    """Voronoi diagram of a plane that repeats itself; made by `periodic_voronoi_2d`."""
    @property
    def box(self) -> _Floats:
        """(2, 2) float64: its corners, rounded as the sites are."""
    @property
    def sites(self) -> _Floats:
        """(n, 2) float64: in the box, its low sides included, rounded."""
    @property
    def powers(self) -> _Floats:
        """(n,) float64: the weights of a power diagram as given, or (0,) of others."""
    @property
    def site_of(self) -> _Indices:
        """(n,) int32: smallest index of an equal site; only such sites have a cell."""
    @property
    def hidden(self) -> _Indices:
        """(h,) int32, ascending: sites without a cell, since heavier ones leave them none."""
    @property
    def vertices(self) -> _Floats:
        """(V, 2) float64: in the box."""
    @property
    def edges(self) -> _Indices:
        """(E, 2) int32 vertices."""
    @property
    def edge_shifts(self) -> _Indices:
        """(E, 2) int32: by how many periods, to the right and up, the second vertex lies elsewhere than in the box, as seen from the first."""
    @property
    def edge_sites(self) -> _Indices:
        """(E, 2) int32: the sites left and right of the edge; they may be the same."""
    @property
    def edge_site_shifts(self) -> _Indices:
        """(E, 2) int32: the periods to the right site, as seen from the left one."""
    @property
    def cells(self) -> tuple[_Indices, _Floats]:
        """(n + 1,) int32 offsets and (2 E, 2) float64 places: the cell of site i, around it and perhaps partly beside the box, is places[offsets[i]:offsets[i + 1]], counter-clockwise; empty for a site equal to an earlier one."""
    @property
    def corner_vertices(self) -> _Indices:
        """(2 E,) int32: the vertices at the corners of all cells."""
    @property
    def corner_shifts(self) -> _Indices:
        """(2 E, 2) int32: the periods to them, as seen from the cell's site."""
    @property
    def side_edges(self) -> _Indices:
        """(2 E,) int32: the edge that ends at each corner of all cells."""
    @property
    def delaunay(self) -> _Indices:
        """(T, 3) int32 sites, counter-clockwise: the triangulation of the torus; 2 for each site."""
    @property
    def delaunay_shifts(self) -> _Indices:
        """(T, 3, 2) int32: the periods to each corner, as seen from the first."""
    @property
    def areas(self) -> _Floats:
        """(n,) float64: of the cells; 0 for hidden sites. Equal sites have the same cell; the others' sum is the box's."""
    @property
    def centroids(self) -> _Floats:
        """(n, 2) float64: centers of mass as seen from the sites, perhaps beside the box; not a number for hidden sites."""
    def locate(self, points: ArrayLike, *, threads: SupportsIndex = 0, job: Job | None = None) -> _Indices:
        """The site of which a copy is nearest to each point, or has the least power there; of equally near ones any.

        Parameters
        ----------
        points : (m, 2) float array
            Exactly what they are in the box; others are brought there by whole periods, to rounding.
        threads : int
            0: all cores.
        job : Job, optional

        Returns
        -------
        (m,) int32 array

        Raises
        ------
        InputError
            A coordinate that is not finite.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O(n + m) expected.
        """

def periodic_voronoi_2d(
    sites: ArrayLike,
    box: ArrayLike = ((0.0, 0.0), (1.0, 1.0)),
    weights: ArrayLike | None = None,
    *,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> PeriodicVoronoi2d:
    """Voronoi diagram of sites that repeat themselves in both directions: on a torus, for seamless tiles.

    Sites are brought into the box and rounded to 2^-51 of what it and its neighbors span, so that their copies by whole
    periods are copies to the bit. Of these, which cells touch and where more than three meet is exact; only vertices are
    rounded. Cells may touch themselves, and two cells may share several edges.

    Parameters
    ----------
    sites : (n, 2) float array
        Anywhere; equal ones, a period apart or not, share a cell.
    box : (2, 2) float array
        The lower left and the upper right corner.
    weights : (n,) float array, optional
        Of a power diagram, as `power_diagram_2d` takes them. None: all alike.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    PeriodicVoronoi2d

    Raises
    ------
    InputError
        No sites, numbers that are not finite, a box without an area or thinner than 2^-41 of its coordinates, what
        `voronoi_2d` and `power_diagram_2d` refuse.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n log n) time, O(n) memory: copies as far around the box as circles about its vertices reach, in most cases four
    spacings of the sites, are part of the diagram, at most all eight neighbors.
    """

@final
class DeviceArray:
    """Numbers in a CUDA device's memory, complete: there is nothing to wait for.

    CuPy, PyTorch, JAX, Numba and others take it as it is, without a copy, by `__cuda_array_interface__` or DLPack; it lives
    as long as they hold it. Write to a copy only.
    """
    @property
    def shape(self) -> tuple[int, ...]:
        """Rows, and columns where there are several."""
    @property
    def dtype(self) -> np.dtype[Any]:
        """float64 or int32."""
    @property
    def nbytes(self) -> int: ...
    @property
    def __cuda_array_interface__(self) -> dict[str, Any]: ...
    def __len__(self) -> int: ...
    def __dlpack__(self, *args: object, **kwargs: object) -> Any: ...
    def __dlpack_device__(self) -> tuple[int, int]: ...
    def numpy(self) -> NDArray[Any]:
        """A copy in host memory.

        Raises
        ------
        DeviceError
            The device was lost.
        """

@final
class DeviceVoronoi2d:
    """A diagram on a CUDA device; made by `voronoi_2d_on_device`. Arrays as Voronoi2d has them."""
    @property
    def vertices(self) -> DeviceArray:
        """(V, 2) float64."""
    @property
    def edges(self) -> DeviceArray:
        """(E, 2) int32 vertices; -1 at infinity."""
    @property
    def edge_sites(self) -> DeviceArray:
        """(E, 2) int32: the sites left and right of the edge."""
    @property
    def site_of(self) -> DeviceArray:
        """(n,) int32: smallest index of an equal site."""
    @property
    def cell_places(self) -> DeviceArray:
        """(n,) int32: which cell is a site's."""
    @property
    def cell_sites(self) -> DeviceArray:
        """(C,) int32: whose a cell is."""
    @property
    def cell_offsets(self) -> DeviceArray:
        """(C + 1,) int32: cell i has the corners and sides [offsets[i], offsets[i + 1])."""
    @property
    def corner_vertices(self) -> DeviceArray:
        """(2 E,) int32 vertices of the cells, counter-clockwise; -1 where a cell is open."""
    @property
    def side_edges(self) -> DeviceArray:
        """(2 E,) int32: the edge before each corner."""
    @property
    def triangles(self) -> DeviceArray:
        """(T, 3) int32 sites, as Voronoi2d.delaunay; none unless only_triangles."""
    @property
    def device_times(self) -> dict[str, float]:
        """Seconds of the parts by the device's clock."""

def voronoi_2d_on_device(
    sites: Any, *, device: _Device = "cuda", only_triangles: bool = False, job: Job | None = None
) -> DeviceVoronoi2d:
    """Voronoi diagram of the plane that stays on the CUDA device that finds it.

    Parameters
    ----------
    sites : (n, 2) float array, or one on the device
        Whatever has `__cuda_array_interface__` (CuPy, PyTorch, Numba) is taken where it is: float64, in row order.
    device : str
        "cuda", or "cuda:1" for the second one.
    only_triangles : bool
        The Delaunay triangles and nothing else: less memory and less time.
    job : Job, optional

    Returns
    -------
    DeviceVoronoi2d

    Raises
    ------
    InputError
        Sites of another shape or type.
    DeviceError
        No usable device, too little memory, sites that a device is not made for or that are on another device.
    Cancelled
        The job was cancelled.

    Notes
    -----
    The same numbers as voronoi_2d, to the bit. O(n log n) time, O(n) memory: about 360 bytes a site meanwhile, 144 then, 24
    of triangles alone.
    """

@final
class SweepEvent:
    """An event in a step of a SweepCircle."""
    @property
    def kind(self) -> Literal["touch", "vanish"]:
        """ "touch": the circle reached a site. "vanish": an arc shrank to a vertex."""
    @property
    def radius(self) -> float:
        """Radius of the circle."""
    @property
    def sites(self) -> _Indices:
        """(1,) int32 the site touched, or those about the vertex, counter-clockwise: (3,), with weights or several circles also more."""
    @property
    def point(self) -> _Floats:
        """(2,) float64: the site, or the vertex."""

@final
class SweepCircle:
    """A sweep circle, one event at a time, to be looked at.

    The same step computes `voronoi_2d`, from centers of its own choice. Positions are rounded, and so is the order of nearly
    simultaneous events. With weights, and where rounding would lose a vertex, the events are told from the diagram; hidden
    sites have none, and a vertex of many cells is one event.

    Parameters
    ----------
    sites : (n, 2) float array
    center : (2,) float array
        Anywhere: among the sites, outside, on one of them.
    weights : (n,) float array, optional
        Radii of the sites. The circle touches a site sooner by its weight, at a radius below 0 when its disk holds the
        center.

    Raises
    ------
    InputError
        A coordinate that is not finite; what `voronoi_2d` refuses.

    Notes
    -----
    O(n log n) to make and for the first step, O(1) expected for another.
    """
    def __init__(self, sites: ArrayLike, center: ArrayLike, weights: ArrayLike | None = None) -> None: ...
    def step(self) -> SweepEvent | None:
        """Go on to the next event and return it; None after the last."""
    def grow(self, radius: SupportsFloat) -> None:
        """Grow to a radius, through all events on the way; a smaller radius changes nothing."""
    @property
    def radius(self) -> float:
        """Radius of the circle."""
    @property
    def center(self) -> _Floats:
        """(2,) float64."""
    @property
    def arcs(self) -> list[tuple[int, float, float]]:
        """List of (site, begin, end): ellipse arcs and their directions from the center, radians, counter-clockwise."""
    def beach_curve(self, samples: SupportsIndex) -> _Floats:
        """(samples, 2) float64: points in directions equally far apart, up to 100,000; none before the start."""
    @property
    def edges(self) -> tuple[_Floats, _Indices, NDArray[np.bool_]]:
        """(E, 2, 2) float64 ends, (E, 2) int32 sites, (E,) bool finished: the others grow at their end, or at both. After the last event there are as many as the diagram has."""
    def edge_polylines(self, tolerance: SupportsFloat) -> list[_Floats]:
        """List of (k, 2) float64: points along each of `edges`, within a tolerance; one finer than 1.5e-8 of the radius is taken as that."""

@final
class SweepCircles:
    """Sweep circles that grow together, to be looked at.

    Each grows about its own center until it has found the cells of the sites nearest to it, as much of them as lies in the
    domain. Without a domain one with an open cell among these goes on to the last vertex; with one each circle does without
    the events that the others tell.

    Parameters
    ----------
    sites : (n, 2) float array
    centers : (m, 2) float array
    weights : (n,) float array, optional
        Radii of the sites.
    domain : (m, 2) float array or list of such, optional
        Corners of a polygon and of its holes: what of the plane is wanted.

    Raises
    ------
    InputError
        No center, a coordinate that is not finite; what `voronoi_2d` refuses, of a domain, too.

    Notes
    -----
    O(m n log n) to make, O(m) for a step. Circles stop by theorem 3.3 of X. Ying: Parallel geodesic computing,
    chapter 3, exactly: where the beach curve is around the cells.
    """
    def __init__(
        self, sites: ArrayLike, centers: ArrayLike, weights: ArrayLike | None = None, *, domain: _Domain | None = None
    ) -> None: ...
    def step(self) -> tuple[int, SweepEvent] | None:
        """Go on to the next event of any circle: (circle, event); None after the last."""
    def grow(self, radius: SupportsFloat) -> None:
        """Grow all circles to a radius, through all events; a smaller radius changes nothing."""
    @property
    def centers(self) -> _Floats:
        """(m, 2) float64."""
    @property
    def radii(self) -> _Floats:
        """(m,) float64: where each circle is, or stopped; -inf for one to which no site is nearest."""
    @property
    def done(self) -> NDArray[np.bool_]:
        """(m,) bool: circles that have closed their cells."""
    def arcs(self, circle: SupportsIndex) -> list[tuple[int, float, float]]:
        """List of (site, begin, end), as of a SweepCircle."""
    def beach_curve(self, circle: SupportsIndex, samples: SupportsIndex) -> _Floats:
        """(samples, 2) float64, as of a SweepCircle."""
    def edges(self, circle: SupportsIndex) -> tuple[_Floats, _Indices, NDArray[np.bool_]]:
        """(E, 2, 2) float64 ends, (E, 2) int32 sites, (E,) bool finished: the others grow at their end, or at both. After the last event there are as many as the diagram has."""
    def edge_polylines(self, circle: SupportsIndex, tolerance: SupportsFloat) -> list[_Floats]:
        """List of (k, 2) float64: points along each of `edges`."""

def harmonic_map(mesh: Mesh, *, job: Job | None = None) -> _Floats:
    """Places in the unit disk for the vertices of a disk-like surface.

    The border goes once around the circle, every inner vertex to the weighted mean of its neighbors: no face flips.

    Parameters
    ----------
    mesh : Mesh
        One part with one border and no handles.
    job : Job, optional

    Returns
    -------
    (V, 2) float64 array

    Raises
    ------
    InputError
        The mesh is not a disk, or so long or deep that faces vanish in the rounding of doubles.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(V^1.5) time. Cotangent weights, raised where they are not positive. U. Pinkall, K. Polthier: Computing discrete
    minimal surfaces and their conjugates, 1993. M. Floater: One-to-one piecewise linear mappings over triangulations, 2003.
    """

@final
class LiftedVoronoi:
    """A plane diagram on a surface; made by `Chart.lift`."""
    @property
    def areas(self) -> _Floats:
        """(n,) float64: of the cells, on the surface; they sum to the mesh's area."""
    @property
    def centroids(self) -> _Floats:
        """(n, 2) float64: centers of mass in the plane, by area on the surface; not a number where that is 0."""
    @property
    def face_cell(self) -> _Indices:
        """(F,) int32: the cell of each face, -1 where several share it."""
    @property
    def edge_points(self) -> _Floats:
        """(m, 3) float64: the points of all edges' polylines, one after another."""
    @property
    def edge_surface(self) -> SurfacePoints:
        """These points as SurfacePoints; consecutive ones of a polyline share a face."""
    @property
    def edge_offsets(self) -> _Indices:
        """(e + 1,) int32: polyline i is [offsets[i], offsets[i + 1])."""
    @property
    def edge_of(self) -> _Indices:
        """(e,) int32: the diagram's edge of each polyline, ascending."""
    @property
    def edge_cells(self) -> _Indices:
        """(e, 2) int32: the cells on the left and on the right."""
    def locate(self, points: _Points) -> _Indices:
        """(m,) int32: the cell of each surface point. O(m log F)."""
    def split(self) -> SplitMesh:
        """Cut the mesh along the edges: a SplitMesh. O(V + F)."""

@final
class Chart:
    """A surface laid out in the plane: a UV map, of one or several islands. Immutable.

    Parameters
    ----------
    mesh : Mesh
    uv : (V, 2) or (3 F, 2) float array
        A place for each vertex, or for each corner of each face in order.
    job : Job, optional

    Raises
    ------
    InputError
        The wrong number of places, one that is not finite, a face that is flipped or without area in the plane, two faces
        that overlap by more than float32 rounding. Faces are named.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(F log F).
    """
    def __init__(self, mesh: Mesh, uv: ArrayLike, *, job: Job | None = None) -> None: ...
    @property
    def corners(self) -> _Floats:
        """(3 F, 2) float64: the place of each corner of each face."""
    @property
    def area(self) -> float:
        """Area in the plane."""
    def locate(
        self, places: ArrayLike, *, threads: SupportsIndex = 0, job: Job | None = None
    ) -> tuple[SurfacePoints, NDArray[np.bool_]]:
        """The surface points at places of the plane (m, 2): a SurfacePoints of those that there are, and (m,) bool saying which. O(m log F)."""
    def places(self, points: _Points) -> _Floats:
        """(m, 2) float64: where surface points lie in the plane."""
    def lift(
        self,
        diagram: Voronoi2d,
        *,
        tolerance: SupportsFloat = 0.0,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> LiftedVoronoi:
        """Brings a diagram of the plane to the surface: a LiftedVoronoi.

        Each point of the surface gets the cell that its place lies in. Edges are cut at every mesh edge that they cross, end at
        the map's border and may come in again.

        Parameters
        ----------
        diagram : Voronoi2d
            Of any kind; edges between weighted sites are polylines along the curves, by which their cells are divided.
        tolerance : float
            In the plane: no point of a curved edge is farther from its polyline. 0: a thousandth of a mean cell's width.
        threads : int
            0: all cores. The result does not depend on it.
        job : Job, optional

        Raises
        ------
        InputError
            A diagram without sites, a tolerance that is negative.
        Cancelled
            The job was cancelled.

        Notes
        -----
        O((F + pieces) log F).
        """

@final
class Relaxation2d:
    """Relaxed sites; made by `relax_2d`."""
    @property
    def sites(self) -> _Floats:
        """(n, 2) float64."""
    @property
    def energy(self) -> _Floats:
        """(iterations + 1,) float64: of the start and after each iteration; never rises without weights."""
    @property
    def iterations(self) -> int:
        """Steps done."""
    @property
    def converged(self) -> bool:
        """True if the sites rest."""
    @property
    def stop_reason(self) -> str:
        """The reason why it ended."""

@final
class Balance2d:
    """Sites and weights of even cells; made by `balance_2d`."""
    @property
    def sites(self) -> _Floats:
        """(n, 2) float64."""
    @property
    def weights(self) -> _Floats:
        """(n,) float64: of the power diagram; their mean is 0."""
    @property
    def shares(self) -> _Floats:
        """(n,) float64: of the whole mass in each cell."""
    @property
    def capacity_error(self) -> float:
        """The largest of a cell's, in shares of its capacity."""
    @property
    def energy(self) -> _Floats:
        """(iterations + 1,) float64: with the capacities met, of the start and after each iteration; never rises."""
    @property
    def iterations(self) -> int:
        """Steps of the sites."""
    @property
    def converged(self) -> bool:
        """True if the sites rest and the capacities are met."""
    @property
    def stop_reason(self) -> str:
        """The reason why it ended."""

def balance_2d(
    sites: ArrayLike,
    domain: _Domain,
    density: ArrayLike | Callable[[_Floats], ArrayLike] | None = None,
    capacities: ArrayLike | None = None,
    max_iterations: SupportsIndex = 50,
    tolerance: SupportsFloat = 1e-4,
    *,
    capacity_tolerance: SupportsFloat = 1e-5,
    samples: SupportsIndex = 512,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> Balance2d:
    """Moves sites to the centers of their cells within a domain, all of which have the same mass: the evenest stippling.

    Cells are those of a power diagram, whose weights are found with the sites: each cell has just its capacity, an equal
    share of the density's mass or one of its own. Where sites must stay, the weights alone are found, those of
    semi-discrete optimal transport.

    Parameters
    ----------
    sites : (n, 2) float array
        One whose cell has no mass (outside, where the density is 0, equal to another) is put into a heavy cell first.
    domain : (m, 2) float array or list of such
        A simple polygon, or an outline and its holes.
    density : (rows, columns) float array or callable, optional
        Mass per area, in proportion, as `relax_2d` takes it: what dots at the sites have as their tone. None: uniform.
    capacities : (n,) float array, optional
        Shares of the whole mass, which sum to 1. None: all alike.
    max_iterations : int
        Steps of the sites, in each of which the capacities are met. 0: the sites stay.
    tolerance : float
        Stop when the energy falls by less than this share of itself.
    capacity_tolerance : float
        How far the mass of a cell may be from its capacity, in shares of that.
    samples : int
        Of a callable, each way.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    Balance2d
        `power_diagram_2d(result.sites, result.weights, domain)` has the cells.

    Raises
    ------
    InputError
        No sites, a coordinate that is not finite, a density that is negative, not finite or 0 all over the domain, capacities
        that are not positive or do not sum to 1, options out of range; with `max_iterations` 0 a site whose cell has no mass.
    Cancelled
        The job was cancelled.

    Notes
    -----
    O(n^1.5 + rectangles that borders of cells cross) a step of Newton's method, of which the first weights take some 4 to 10
    and each iteration 2. The energy, the integral of density times squared distance, never rises. F. de Goes, K. Breeden, V.
    Ostromoukhov, M. Desbrun: Blue noise through optimal transport, 2012. J. Kitagawa, Q. Merigot, B. Thibert: Convergence of
    a Newton algorithm for semi-discrete optimal transport, 2019.
    """

@final
class AreaWeights:
    """Weights with which cells have given areas; made by `weights_for_areas`."""
    @property
    def weights(self) -> _Floats:
        """(n,) float64: of `voronoi_2d`; their mean is 0."""
    @property
    def shares(self) -> _Floats:
        """(n,) float64: of the domain's area, or of its mass, in each cell."""
    @property
    def lacks(self) -> _Floats:
        """(iterations + 1,) float64: what cells lack or have too much, in shares of the whole, as the root of the sum of squares: of equal weights and after each iteration. Falls each time."""
    @property
    def error(self) -> float:
        """The largest of a cell's, in shares of the wanted area."""
    @property
    def iterations(self) -> int:
        """Steps of Newton's method."""
    @property
    def converged(self) -> bool:
        """True if the error is within the tolerance."""
    @property
    def stop_reason(self) -> str:
        """The reason why it ended."""

def weights_for_areas(
    sites: ArrayLike,
    domain: _Domain,
    areas: ArrayLike | None = None,
    density: ArrayLike | Callable[[_Floats], ArrayLike] | None = None,
    *,
    tolerance: SupportsFloat = 1e-4,
    max_iterations: SupportsIndex = 60,
    samples: SupportsIndex = 512,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> AreaWeights:
    """Finds the weights with which the cells of `voronoi_2d(sites, weights)`, within a domain, have given areas.

    Parameters
    ----------
    sites : (n, 2) float array
        They stay. Without weights each needs some area: refused are sites outside, where the density is 0, or equal to others.
    domain : (m, 2) float array or list of such
        A simple polygon, or an outline and its holes.
    areas : (n,) float array, optional
        The wanted areas, in proportion. None: all alike.
    density : (rows, columns) float array or callable, optional
        As in `relax_2d`; its mass is wanted instead of area. None: uniform.
    tolerance : float
        How far a cell's area may be from the wanted one, in shares of that. Polylines along curves are as fine as it takes.
    max_iterations : int
    samples : int
        Of a callable, each way.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    AreaWeights

    Raises
    ------
    InputError
        No sites, a coordinate that is not finite, a site that has no area without weights, a density that is negative, not
        finite or 0 all over the domain, areas that are not positive or of another number, options out of range.
    Cancelled
        The job was cancelled.

    Notes
    -----
    Such weights exist for any areas: those of optimal transport whose cost is the distance. By Newton's method with steps
    short enough that no cell is lost and less is missing each time. O(n^1.5 + rectangles that borders cross) a step. J.
    Kitagawa, Q. Merigot, B. Thibert: Convergence of a Newton algorithm for semi-discrete optimal transport, 2019.
    """

def relax_2d(
    sites: ArrayLike,
    domain: _Domain,
    density: ArrayLike | Callable[[_Floats], ArrayLike] | None = None,
    max_iterations: SupportsIndex = 100,
    tolerance: SupportsFloat = 1e-6,
    *,
    weights: ArrayLike | None = None,
    samples: SupportsIndex = 512,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> Relaxation2d:
    """Moves sites to the centers of their cells within a domain until they rest: even cells, stippling.

    Parameters
    ----------
    sites : (n, 2) float array
        A site whose cell has no mass (outside, where the density is 0, equal to an earlier one) stays.
    domain : (m, 2) float array or list of such
        A simple polygon, or an outline and its holes.
    density : (rows, columns) float array or callable, optional
        The wanted number of cells per area, in proportion, over the domain's bounding box: equal rectangles, the first row
        at the least y (an image read from a file usually begins at the top). A callable takes (k, 2) places and returns
        (k,) densities; it is asked once, in the middles of `samples` by `samples` rectangles. None: uniform.
    max_iterations : int
    tolerance : float
        Stop when the energy falls by less than this share of itself; with weights when no site moves farther than this share
        of a mean cell's width.
    weights : (n,) float array, optional
        Of `voronoi_2d`: cells are those of disks, which keep their radii. Hidden sites stay.
    samples : int
        Of a callable, each way.
    threads : int
        0: all cores. The result does not depend on it.
    job : Job, optional

    Returns
    -------
    Relaxation2d

    Raises
    ------
    InputError
        No sites, a coordinate or weight that is not finite, a wrong number of weights, a density that is negative, not
        finite or 0 all over the domain, options out of range.
    Cancelled
        The job was cancelled.

    Notes
    -----
    Per iteration O(n log n + rectangles that borders of cells cross). The energy is the integral of density^2 times squared
    distance and never rises; with weights, whose cells are not the best for it, it may rise by little. Integrals over cells
    are exact for the rectangles. S. Lloyd: Least squares quantization in
    PCM, 1982. Q. Du, V. Faber, M. Gunzburger: Centroidal Voronoi Tessellations, 1999. A. Secord: Weighted Voronoi
    stippling, 2002.
    """

_Alignment: TypeAlias = Literal["none", "curvature", "boundary"]
_Curve: TypeAlias = Stroke | SurfaceCurve | GeodesicPath | ArrayLike | SurfacePoints

@final
class Stroke:
    """A curve that a field shall follow.

    Args:
        curve: a SurfaceCurve.
        hard: met exactly in every face that the curve crosses; otherwise as a spring of `weight` would.
        weight: positive; 1 meets strokes that do not cross to about a degree.

    Raises:
        InputError: anything but a SurfaceCurve.
    """
    def __init__(self, curve: SurfaceCurve, hard: bool = False, weight: SupportsFloat = 1.0) -> None: ...
    @property
    def hard(self) -> bool:
        """True if it is met exactly."""
    @property
    def weight(self) -> float:
        """Weight of a soft stroke."""

@final
class DirectionField:
    """One direction a face, of which `symmetry` equal ones make a vector (1), a line (2) or a cross (4). Immutable."""
    @staticmethod
    def from_vectors(mesh: Mesh, vectors: ArrayLike, symmetry: SupportsIndex = 1) -> DirectionField:
        """The field that has given directions: combed hair, a painted flow.

        Args:
            mesh: the mesh, kept alive by the field.
            vectors: (F, 3) reals, one for each face; their part within the face counts, their length does not.
            symmetry: 1, 2 or 4: how many directions at equal angles count as the same.

        Returns:
            DirectionField: from face to face it turns the nearer way, by at most pi / symmetry.

        Raises:
            InputError: another shape or symmetry, a vector that is not finite or has no direction within its face.

        Notes:
            O(F).
        """
    @staticmethod
    def from_turns(mesh: Mesh, angles: ArrayLike, turns: ArrayLike, symmetry: SupportsIndex = 1) -> DirectionField:
        """The field that has these angles and turns, as `angles` and `turns` of another gave them.

        Args:
            mesh: the Mesh that they were given for.
            angles: (F,) radians in the chart of each face.
            turns: (F, 3) radians, by how much the field turns across each edge, opposite for its two faces, 0 on the boundary.
            symmetry: 1: vectors, 2: lines, 4: crosses.

        Returns:
            DirectionField, the same to the bit.

        Raises:
            InputError: arrays of another length, not finite or beyond a thousand radians; turns that differ between the two
                faces of an edge or do not lead from the one's direction to the other's; a symmetry other than 1, 2 and 4.
        """
    @property
    def symmetry(self) -> int:
        """1: vectors, 2: lines, 4: crosses."""
    @property
    def vectors(self) -> _Floats:
        """(F, 3) float64: one of the directions at the center of each face, unit vectors."""
    @property
    def angles(self) -> _Floats:
        """(F,) float64: the same directions as angles, radians, in the chart of the face (corner 0 to corner 1 is 0)."""
    @property
    def turns(self) -> _Floats:
        """(F, 3) float64: by how much the field turns where it crosses edge i (corner i to i + 1) of the face outwards, radians, besides the transport that keeps directions straight; 0 on the boundary."""
    @property
    def singularities(self) -> dict[int, float]:
        """{vertex: index} of the interior vertices whose index is not 0."""
    @property
    def loop_indices(self) -> _Floats:
        """(boundary loops,) float64: how often the field turns against the boundary along each loop."""
    @property
    def largest_turn(self) -> float:
        """The largest of `turns`, radians. Below pi / symmetry the vectors alone tell the singularities; beyond, faces are too large for how fast the field has to turn."""
    @property
    def sharp_edges(self) -> _Indices:
        """(n, 2) int32: pairs of neighboring faces between which the field turns by pi / symmetry or more, where the vectors alone do not tell the singularities. With given singularities only what no other choice of turns around handles was found to avoid: faces there are too large. O(F)."""
    def directions(self, points: _Points) -> _Floats:
        """(n, 3) float64: the field at vertices or SurfacePoints, unit vectors in the planes of the points' faces; continuous but at vertices, about which it turns evenly (there a mean is given)."""
    def turned(self, angle: SupportsFloat) -> DirectionField:
        """Returns the field turned everywhere by an angle, radians counter-clockwise. Raises InputError for one that is not finite."""

@final
class DirectionFieldEditor:
    """Makes fields of one mesh one after another.

    Factors, loops around handles and harmonic forms are made once; singularities that stay are not solved for again; strokes
    begin from the last answer, so that two ways to the same strokes differ by rounding: about 1e-7 radians, 3e-5 at the
    most that was seen.

    Args:
        mesh: the mesh, kept alive.
        symmetry: 1, 2 or 4.
    """
    def __init__(self, mesh: Mesh, symmetry: SupportsIndex = 1) -> None: ...
    def field(
        self,
        singularities: Mapping[int, SupportsFloat] | None = None,
        strokes: Iterable[_Curve] = (),
        align: _Alignment = "none",
        *,
        loop_indices: Mapping[int, SupportsFloat] | None = None,
        align_weight: SupportsFloat = 1.0,
        directions: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        job: Job | None = None,
    ) -> DirectionField:
        """Finds a field as `direction_field` does."""

def direction_field(
    mesh: Mesh,
    symmetry: SupportsIndex = 1,
    singularities: Mapping[int, SupportsFloat] | None = None,
    strokes: Iterable[_Curve] = (),
    align: _Alignment = "none",
    *,
    loop_indices: Mapping[int, SupportsFloat] | None = None,
    align_weight: SupportsFloat = 1.0,
    directions: ArrayLike | None = None,
    weights: ArrayLike | None = None,
    job: Job | None = None,
) -> DirectionField:
    """Directions all over a surface, smooth, with singularities where one wants.

    With `singularities`: the field that turns least of those that have exactly these (trivial connections [crane2010]).
    Strokes, directions and alignment turn it by one angle a face, which cannot change any index. Without: the smoothest
    field, or the one nearest to strokes, directions and alignment, with the singularities that it then has [knoppel2013].

    Args:
        mesh: the mesh, kept alive by the field.
        symmetry: 1 for vectors, 2 for lines, 4 for crosses.
        singularities: None, or {vertex: index} with indices in multiples of 1/symmetry: how often the field turns
            counter-clockwise along a small loop about the vertex. In each component they must sum to its Euler
            characteristic, boundary loops counted with theirs.
        strokes: curves to follow, each a Stroke, SurfaceCurve, GeodesicPath, SurfacePoints or vertices; all but Strokes are
            soft, of weight 1. For symmetry 1 the field runs as the curve does.
        align: "none"; "curvature": lines along the least bent direction, crosses along both principal ones; "boundary":
            along every boundary loop, exactly so in faces with one boundary edge.
        loop_indices: {boundary loop: index}, how often the field turns against the boundary along it: 0 to follow it. Loops
            that are not named (and not aligned) take what turns least. Only together with `singularities`.
        align_weight: how much curvature counts against smoothness.
        directions: (F, 3) or (V, 3) vectors that the field shall have in faces or vertices (as many as both: in faces), zero
            where nothing is given; their part along the surface counts, their length does not.
        weights: (F,) or (V,) as `directions`, 0 or more: 1, as without them, meets smooth directions to about a degree.
        job: progress and cancellation.

    Raises:
        InputError: a vertex out of range or on the boundary; an index that the symmetry lacks; indices of a component of
            another sum, telling what is missing; a stroke of another mesh; hard strokes that disagree in a face; curvature
            for symmetry 1; directions of another number, not finite, or at right angles to the surface; weights of
            another number, below 0, or without directions.
        Cancelled: the job was.

    Notes:
        About O(F): a multigrid solve over vertices for singularities, one for each handle twice, one over faces for strokes.
    """

@final
class Streamline(GeodesicPath):
    """A curve along a direction field and why it ends."""
    @property
    def start(self) -> int:
        """Index of the point that it was started from."""
    @property
    def begin_reason(self) -> Literal["length", "boundary", "singularity"]:
        """The reason why it goes no farther back: "length", "boundary" or "singularity"."""
    @property
    def end_reason(self) -> Literal["length", "boundary", "singularity"]:
        """The reason why it goes no farther ahead."""

def streamline(
    mesh: Mesh,
    field: DirectionField,
    start: _Points,
    length: SupportsFloat,
    both: bool = False,
    *,
    heading: ArrayLike | None = None,
    max_curvature: SupportsFloat = ...,
    job: Job | None = None,
) -> Streamline:
    """Follows a direction field: the center line of a long shape, a hair, a seam.

    The field is integrated as it is inside faces, not only from edge to edge: fourth-order steps of at most a quarter of a
    face, shorter where the field turns far within one.

    Args:
        mesh: the field's mesh.
        field: a DirectionField.
        start: one surface point, or a vertex index.
        length: mesh units, > 0.
        both: half of the length on either side of the start, instead of all of it ahead.
        heading: (3,) vector; of the field's directions at the start the nearest one is followed. None: the first one.
        max_curvature: the most by which the curve bends, radians per mesh unit. Where the field turns faster the curve lags
            behind, so that shapes that reach up to 1 / max_curvature to either side do not fold.
        job: a Job to watch or cancel; its fraction is that of the length.

    Returns:
        Streamline: a GeodesicPath that knows why it ends. It has one point where the start is a singular vertex, or lies on
        the boundary where the field leaves the surface.

    Raises:
        InputError: a field of another mesh, a point off the mesh, a length or curvature that is not positive, a curve over
            more than a million faces or eight million steps.
        Cancelled: the job was.
    """

def smoothed_directions(triangles: ArrayLike, directions: ArrayLike, rounds: int, *, job: Job | None = None) -> _Floats:
    """Turn directions of vertices towards those of their neighbors, round after round.

    Parameters
    ----------
    triangles : (T, 3) int array
    directions : (V, 3) float array
        Unit vectors, such as normals.
    rounds : int
        In each, a direction becomes that of the mean of its neighbors' (see neighbor_means) and a fifth of itself.
    job : Job, optional

    Returns
    -------
    (V, 3) float64
        Unit vectors; as given where those around cancel out. O(rounds T).

    Raises
    ------
    InputError
        Fewer than 0 rounds; a corner out of range.
    Cancelled
    """

def spread_values(
    mesh: Mesh,
    places: _Points,
    values: ArrayLike,
    method: Literal["biharmonic", "harmonic"] = "biharmonic",
    *,
    job: Job | None = None,
) -> _Floats:
    """Values for every vertex from a few places where they are known, as a painted density.

    They never leave the range of the given ones and meet those: at vertices to 1e-5 of the range; at points within faces
    biharmonic ones to about 2 % of it, where corners of the face had to be kept within the range. Components without a
    place have the mean of all values.

    Args:
        mesh: a mesh.
        places: (n,) vertices or a SurfacePoints.
        values: (n,) reals.
        method: "biharmonic", smooth through the places (two linear systems a place: for up to a few dozens); "harmonic", with
            cusps at the places and flat between them (one system for any number; in a face, its corners have the value).
        job: progress and cancellation.

    Returns:
        (V,) float64.

    Raises:
        InputError: no place, one off the mesh, another number of values than places, a value that is not finite.
        Cancelled: the job was.

    Notes:
        After [botsch2004], with one constraint a place.
    """

def principal_curvatures(mesh: Mesh) -> tuple[_Floats, _Floats, _Floats]:
    """Finds how the surface bends at each vertex.

    From the change of vertex normals over each face, averaged about vertices [rusinkiewicz2004]. O(F).

    Returns:
        smallest, largest (V,) float64: principal curvatures, 1 / mesh units, positive where the surface bends away from its
        normal as a sphere does; direction (V, 3) float64: of the largest one, a unit vector up to its sign.
    """

_Part: TypeAlias = ArrayLike | Sequence[ArrayLike]

@final
class Shape:
    """A shape to lay on a surface: a flat outline of one or several parts, with or without holes.

    The origin of its plane lies at the center of a placement, its x axis points along the field.

    Args:
        parts: each an outline (n, 2), or a sequence of an outline and its holes; in any unit, in either direction.

    Raises:
        InputError: naming part, loop and corner: no part, fewer than three corners, a coordinate that is not finite or beyond
            1e30, loops that touch or cross themselves or each other, no area, a hole outside of its outline, a part within
            another.

    Notes:
        Decided exactly. O(m log m) expected for m corners.
    """
    def __init__(self, *parts: _Part) -> None: ...
    @staticmethod
    def from_mask(
        image: ArrayLike, max_corners: SupportsIndex = 128, centered: bool = True, *, job: Job | None = None
    ) -> Shape:
        """The parts of an image where it is over one half.

        Outlines by marching squares, simplified outwards only: the shape covers all of what they enclose. The image's right is
        x, up is y.

        Args:
            image: (rows, columns) from top to bottom: booleans, reals 0 to 1, or uint8 0 to 255; with a last axis of 4 channels
                the alpha counts.
            max_corners: at least 8.
            centered: about the smallest circle, of circumradius 1; or else in pixels, the first pixel's center at the origin.
            job: progress and cancellation.

        Raises:
            InputError: another shape of array, a value that is not finite; no clear mask: nothing or everything over one half, or
                more parts and holes than there are corners for.
            Cancelled: the job was.
        """
    @staticmethod
    def disk(corners: SupportsIndex = 64) -> Shape:
        """A regular polygon on the unit circle, its first corner on the x axis."""
    @staticmethod
    def star(points: SupportsIndex = 5, inner: SupportsFloat = 0.381966011250105) -> Shape:
        """`points` tips on the unit circle, one on the x axis, corners at the radius `inner` between them."""
    @staticmethod
    def needle(aspect: SupportsFloat = 10.0) -> Shape:
        """A rhombus of length 2 along the x axis, `aspect` times as long as wide."""
    @staticmethod
    def leaf(aspect: SupportsFloat = 2.5, corners: SupportsIndex = 40) -> Shape:
        """Two arcs between tips at -1 and 1 on the x axis, `aspect` times as long as wide."""
    @staticmethod
    def drop(round: SupportsFloat = 0.6, corners: SupportsIndex = 40) -> Shape:
        """A disk of radius `round` drawn out to a tip at 1 on the x axis: a scale, a drop, a feather."""
    @staticmethod
    def crescent(inner: SupportsFloat = 0.8, shift: SupportsFloat = 0.4, corners: SupportsIndex = 48) -> Shape:
        """The unit disk less a disk of radius `inner` about (shift, 0)."""
    @property
    def loops(self) -> list[_Floats]:
        """Lists of (n, 2) float64: outlines counter-clockwise, holes clockwise, part by part."""
    @property
    def parts(self) -> tuple[list[_Floats], ...]:
        """The loops as the constructor takes them: per part outline and holes."""
    @property
    def circumradius(self) -> float:
        """Distance of the farthest corner from the origin."""
    @property
    def inradius(self) -> float:
        """Radius of the largest disk about the origin within; 0 when the origin is outside."""
    @property
    def area(self) -> float:
        """Area of all parts, holes left out."""
    @property
    def has_half_turn(self) -> bool:
        """True if half a turn about the origin changes nothing."""
    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """(n,) bool for (n, 2) points of the plane."""
    def moved(self, scale: SupportsFloat = 1.0, angle: SupportsFloat = 0.0, shift: ArrayLike = ...) -> Shape:
        """Returns the shape scaled, then turned counter-clockwise (radians), then shifted."""
    def overlaps(self, other: Shape) -> bool:
        """Tells exactly whether the two have a common point, outlines included."""
    def mirrored(self) -> Shape:
        """Returns the shape with y negated."""
    def centered(self, radius: SupportsFloat = 1.0) -> Shape:
        """Moved so that the smallest circle around it is about the origin, and scaled so that it has this radius."""

_Reals: TypeAlias = SupportsFloat | ArrayLike

@final
class SafeDistanceTable:
    """Distances from which on two shapes in the plane are certainly apart, at any angles and scales.

    Two shapes slid together from afar first meet where their fronts do. The table keeps fronts over whole ranges of angles (720
    to a turn) and strips (256 to a shape), so that what it tells can only be too large: by about one percent, by up to
    8.4 % for needles.

    Args:
        a, b: Shapes.
        threads: 0 for all cores; never changes the result.
        job: progress and cancellation.

    Raises:
        InputError: anything but Shapes.
        Cancelled: the job was.

    Notes:
        Some 20 ms of one core and 2.5 MB; a multiple with thousands of corners.
    """
    def __init__(self, a: Shape, b: Shape, *, threads: SupportsIndex = 0, job: Job | None = None) -> None: ...
    @overload
    def distance(
        self,
        alpha: SupportsFloat,
        beta: SupportsFloat,
        scale_a: SupportsFloat = 1.0,
        scale_b: SupportsFloat = 1.0,
    ) -> float:
        """A distance between the centers from which on the shapes have no common point.

        Args:
            alpha: where the center of b is, seen in the plane of a: angle from a's x axis, radians.
            beta: where the center of a is, seen in the plane of b.
            scale_a, scale_b: lengths of one unit of the shapes' planes, > 0.

        Returns:
            float, or (n,) float64 where any argument is (n,).

        Raises:
            InputError: angles that are not finite, scales that are not positive, lengths that differ.

        Notes:
            O(1) at equal scales, else O(strips).
        """
    @overload
    def distance(
        self, alpha: _Reals, beta: _Reals, scale_a: _Reals = 1.0, scale_b: _Reals = 1.0
    ) -> float | _Floats: ...
    @property
    def nbytes(self) -> int:
        """Memory of the table and its fronts."""

@final
class Placements:
    """The places of copies of shapes on a surface.

    A point (x, y) of a shape's plane is laid at the distance scale * |(x, y)| from the center, in the direction
    angle + atan2(y, x).

    Args:
        shape: (n,) integers, which of a list of shapes.
        center: SurfacePoints, n.
        angle: (n,) radians, the direction of the shape's x axis at the center, counter-clockwise seen from outside, from the
            first edge (corner 0 to corner 1) of the center's face.
        scale: (n,) mesh units for one unit of the shape's plane.
        mirrored: (n,) booleans: y of the shape's plane is negated first. None: no shape is.

    Raises:
        InputError: lengths that differ, a negative shape, an angle that is not finite, a scale that is not positive.
    """
    def __init__(
        self,
        shape: ArrayLike,
        center: SurfacePoints,
        angle: ArrayLike,
        scale: ArrayLike,
        mirrored: ArrayLike | None = None,
    ) -> None: ...
    @property
    def shape(self) -> _Indices:
        """(n,) int32: which of the shapes."""
    @property
    def center(self) -> SurfacePoints:
        """SurfacePoints."""
    @property
    def angle(self) -> _Floats:
        """(n,) float64: radians from the first edge of the center's face."""
    @property
    def scale(self) -> _Floats:
        """(n,) float64: mesh units for one unit of the shape's plane."""
    @property
    def mirrored(self) -> NDArray[np.bool_]:
        """(n,) bool."""
    def __len__(self) -> int: ...
    def __getitem__(self, index: SupportsIndex | slice | ArrayLike) -> Placements: ...

@final
class ConformedPoints:
    """An object bent onto a surface and fixed to it."""
    @property
    def points(self) -> _Floats:
        """(n, 3) float64: where its vertices are."""
    @property
    def surface(self) -> SurfacePoints:
        """SurfacePoints that the vertices stand on."""
    @property
    def heights(self) -> _Floats:
        """(n,) float64: height of the vertices above the surface along its smooth normal, mesh units."""
    @property
    def lost(self) -> _Indices:
        """int32: vertices beside the outline for which there is no surface; they are put at the center."""
    def positions(self, mesh: Mesh) -> _Floats:
        """(n, 3) float64: where they are on the same mesh with other positions; InputError where it has other faces."""

@final
class BentCopies:
    """Meshes bent onto a surface and fixed to it, one after the other."""
    @property
    def vertices(self) -> _Floats:
        """(n, 3) float64: where the vertices are."""
    @property
    def surface(self) -> SurfacePoints:
        """SurfacePoints that the vertices stand on."""
    @property
    def heights(self) -> _Floats:
        """(n,) float64: height of the vertices above the surface along its smooth normal, mesh units."""
    @property
    def begins(self) -> NDArray[np.int64]:
        """(placements + 1,) int64: first vertex of each copy; those of its solid come first, then those in between."""
    @property
    def triangles(self) -> _Indices:
        """(m, 3) int32; of mirrored copies the other way round, so that the outside stays outside."""
    @property
    def triangle_copy(self) -> _Indices:
        """(m,) int32: placement."""
    @property
    def triangle_source(self) -> _Indices:
        """(m,) int32: triangle of the solid that it is, or is a part of."""
    @property
    def weights(self) -> _Floats:
        """(m, 3, 3) float64: of each corner, where it lies in that triangle (barycentric), for what the solid's corners carry."""
    @property
    def deviations(self) -> _Floats:
        """(placements,) float64: how far edges and triangles still leave the surface, as far as samples tell, as shares of the circumradius; not a number for those that could not be laid, or without a tolerance."""
    @property
    def lost(self) -> NDArray[np.int64]:
        """int64: vertices beside the outline for which there is no surface; they are put at the center."""
    def positions(self, mesh: Mesh) -> _Floats:
        """(n, 3) float64: where they are on the same mesh with other positions; InputError where it has other faces."""

@final
class CutSurface:
    """Surface cut along the outlines of shapes."""
    @property
    def surface(self) -> SurfacePoints:
        """SurfacePoints of its vertices on the mesh that was cut."""
    @property
    def vertices(self) -> _Floats:
        """(n, 3) float64."""
    @property
    def vertex_origin(self) -> _Indices:
        """(n,) int32: vertex of the mesh, -1 for those on outlines."""
    @property
    def uv(self) -> _Floats:
        """(n, 2) float64: in the plane of its shape, in its units; 0 outside of all."""
    @property
    def triangles(self) -> _Indices:
        """(m, 3) int32."""
    @property
    def triangle_face(self) -> _Indices:
        """(m,) int32: face of the mesh that the triangle is a part of."""
    @property
    def triangle_shape(self) -> _Indices:
        """(m,) int32: placement whose shape it lies in, -1 outside of all."""

@final
class ShapeAttributes:
    """Attributes of vertices by the shapes near them."""
    @property
    def placement(self) -> _Indices:
        """(V,) int32: placement of the nearest shape, -1 where none is within reach."""
    @property
    def distance(self) -> _Floats:
        """(V,) float64: to its outline, as in its plane, mesh units; negative inside, infinite where there is none."""
    @property
    def uv(self) -> _Floats:
        """(V, 2) float64: the vertex in the plane of that shape, in its units."""

@final
class MappedShapes:
    """Shapes laid on a surface by `map_shapes`. Those that could not be laid have no part."""
    @property
    def placements(self) -> Placements:
        """Placements."""
    @property
    def failures(self) -> dict[int, str]:
        """{placement: why} of those that could not be laid: "boundary" (leaves the surface), "fold" (would cover it twice), "stretched" (beyond the limits)."""
    @property
    def stretch(self) -> _Floats:
        """(n, 2) float64: smallest and largest singular value of the map of each shape, not a number for those that could not be laid."""
    def outline(self, i: SupportsIndex) -> list[_Floats]:
        """List of (k, 3) float64: the loops of a placement's outline on the surface, closed, straight in every face."""
    def outline_surface(self, i: SupportsIndex) -> list[SurfacePoints]:
        """These points as SurfacePoints; consecutive ones share the face of the first."""
    def conform(self, vertices: ArrayLike, i: SupportsIndex) -> ConformedPoints:
        """An object bent onto the surface.

        x and y go through the map of the shape, z along the smooth normal of the surface, all to the placement's scale. What
        reaches over the outline is laid as far as the surface goes on unfolded. Faces of mirrored copies turn over.

        Args:
            vertices: (n, 3), or (n, 2) with z = 0: in the shape's own units.
            i: which placement.

        Raises:
            InputError: bad vertices, a shape that could not be laid.
            IndexError: i is out of range.
        """
    def bend(
        self,
        solids: Sequence[tuple[ArrayLike, ArrayLike] | None],
        tolerance: SupportsFloat = 0.01,
        *,
        threads: SupportsIndex = 0,
        job: Job | None = None,
    ) -> BentCopies:
        """Meshes bent onto the surface, one for each placement, divided until they lie on it.

        As `conform` for all copies at once. Between the vertices of a mesh that is bent lie chords; where those leave the
        surface (they cross an edge of it, or bridge a hollow) edges and triangles are divided, and neighbors agree.

        Args:
            solids: for each shape (vertices (n, 3) or (n, 2) with z = 0 in the shape's own units, triangles (t, 3)), or None
                for a shape that has none.
            tolerance: how far edges and triangles may leave the surface that their vertices lie on or stand above, as a share
                of the copy's circumradius; 0 keeps the vertices as they are.
            threads, job: as in `map_shapes`.

        Returns:
            BentCopies.

        Raises:
            InputError: bad vertices or triangles, another number of solids than shapes, a tolerance that is negative or not
                finite.
            Cancelled: the job was.
        """
    def patch(self, i: SupportsIndex) -> CutSurface:
        """CutSurface of the piece of surface that a placement's shape covers."""
    def patches(self, *, job: Job | None = None) -> CutSurface:
        """CutSurface of all pieces, each by itself."""
    def cut(self, *, job: Job | None = None) -> CutSurface:
        """CutSurface of the whole surface, its own vertices first. Raises InputError where shapes overlap."""
    def attributes(
        self, reach: SupportsFloat = 0.0, *, threads: SupportsIndex = 0, job: Job | None = None
    ) -> ShapeAttributes:
        """Returns attributes of the mesh's vertices by the shapes near them.

        Args:
            reach: distance from the outlines, mesh units, up to which vertices outside of shapes count, too.
            threads, job: as in `map_shapes`.

        Returns:
            ShapeAttributes.

        Raises:
            InputError: a reach that is negative or not finite.
            Cancelled: the job was.
        """
    def frames(self, mesh: Mesh | None = None) -> tuple[_Floats, _Floats, _Floats]:
        """Rigid copies: points (n, 3), unit quaternions (n, 4) as w x y z, scales (n, 3) with y negative for mirrored ones. z is along the smooth normal, x along the placement's direction. On `mesh` instead, if it is given: the same one with other positions."""
    def __len__(self) -> int: ...

def map_shapes(
    mesh: Mesh,
    shapes: Shape | Sequence[Shape],
    placements: Placements,
    field: DirectionField | Sequence[DirectionField] | None = None,
    *,
    limits: tuple[SupportsFloat, SupportsFloat] = (0.5, 2.0),
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> MappedShapes:
    """Lays shapes on the surface: by the exponential map, or bent along a field.

    Each shape's plane is laid on the surface by a continuous map that is linear in every face. About a point it keeps
    lengths and directions from the center; with a field it keeps arc length along the field's curve through the center and
    distance from it, so that long shapes bend. Exact where the surface can be unrolled. A shape is laid only where its map
    is injective, stays on the surface and stretches within limits, which is checked face by face, exactly.

    Args:
        mesh: a mesh.
        shapes: a Shape or a sequence of them.
        placements: a Placements.
        field: None for the exponential map, or a DirectionField of the same mesh; or a sequence of them, one a shape.
        limits: (smallest, largest) factor by which lengths may change from the plane to the surface: the singular values.
        threads: 0 for all cores; never changes the result.
        job: progress and cancellation.

    Returns:
        MappedShapes.

    Raises:
        InputError: placements that do not fit mesh or shapes, a field of another mesh, limits in the wrong order.
        Cancelled: the job was.

    Notes:
        O(n log n + c m) a shape, for n vertices about it, m within it and c corners. After [melvaer2012].
    """

@final
class CheckReport:
    """The findings of `check_distribution`; true when nothing is wrong."""
    @property
    def ok(self) -> bool:
        """No fault at all."""
    @property
    def faults(self) -> list[tuple[str, int, int | None, tuple[float, float, float]]]:
        """List of (kind, placement, other placement or None, (x, y, z)), one for each kind and pair, 1000 at most. Kinds: "crossing", "nesting", "covered_twice" of two shapes; "not_laid", "open", "overturned", "incomplete" of one."""
    @property
    def fault_count(self) -> int:
        """Number of these."""
    @property
    def coverage(self) -> float:
        """Share of the surface that lies in shapes, by the samples."""
    @property
    def coverage_error(self) -> float:
        """Its standard deviation, were the samples independent."""
    @property
    def patch_coverage(self) -> float:
        """This share by the areas of the patches."""
    @property
    def stretch(self) -> tuple[float, float]:
        """Smallest and largest singular value of the maps, by the triangles of the patches."""
    @property
    def piece_count(self) -> int:
        """Pieces of outlines that were compared."""
    @property
    def triangle_count(self) -> int:
        """Triangles of patches."""
    @property
    def sample_count(self) -> int:
        """Samples."""
    def __bool__(self) -> bool: ...

def check_distribution(
    mesh: Mesh,
    result: object,
    *,
    samples: SupportsIndex = 1_000_000,
    seed: SupportsIndex = 0,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> CheckReport:
    """Finds whether shapes on a surface collide, in other ways than they were laid.

    Outlines: all pairs of pieces in each face by exact predicates; a common point of two shapes is a fault. Nesting: which
    shape each vertex lies in, spread from the edges that outlines cross, and on which side a point of every other outline is.
    Patches: no triangle turned over, areas as in the shape's plane. Samples: points of the surface, even by area, none of
    which may lie in two patches.

    Args:
        mesh: the mesh that the shapes lie on.
        result: a MappedShapes, or anything with `placements` and `shapes` (and a `field` that they bend along), which are
            laid by `map_shapes` first.
        samples: how many points.
        seed: of the samples.
        threads: 0 for all cores; never changes the result.
        job: progress and cancellation.

    Returns:
        CheckReport.

    Raises:
        InputError: a result of another mesh, or of no kind that is known; a negative number of samples.
        Cancelled: the job was.

    Notes:
        O(sum of squares of the pieces in a face + samples).
    """

@final
class Certificate:
    """A proof that nothing more fits: whatever is laid anywhere comes nearer to a copy than `tolerance`."""
    @property
    def tolerance(self) -> float:
        """Mesh units: of the largest shape where sizes are largest; elsewhere it is less."""
    @property
    def cells(self) -> int:
        """Tests of a cell of the surface."""
    @property
    def leaves(self) -> int:
        """Cells over which a copy can move by the tolerance at most, and at whose center none fits."""
    @property
    def uncertified_area(self) -> float:
        """Area of the cells that it cannot decide: around singularities, and where the surface bends too much."""
    @property
    def uncertified(self) -> SurfacePoints:
        """SurfacePoints: the centers of those cells."""

@final
class Distribution:
    """Copies of shapes on a surface; see `distribute`."""
    @property
    def mesh(self) -> Mesh:
        """The mesh."""
    @property
    def field(self) -> DirectionField | None:
        """The DirectionField that copies bend along, a tuple of one a shape, or None."""
    @property
    def shapes(self) -> list[Shape]:
        """List of the Shapes."""
    @property
    def placements(self) -> Placements:
        """Placements, in the order in which they were laid."""
    @property
    def stop_reason(self) -> Literal["counts", "full", "unproven", "tired"]:
        """ "counts": every count is met; "full": nothing more fits, as the certificate proves; "unproven": no room was found, but of more than half of the surface no certificate can tell, as shapes or gaps are too large for how it bends (`certificate.uncertified_area`); "tired": no room was found in a while."""
    @property
    def rejections(self) -> dict[str, int]:
        """{cause: number} of candidates that were not laid: collision, boundary, forbidden, fold, stretched."""
    @property
    def certificate(self) -> Certificate | None:
        """Certificate; None unless asked for."""
    @property
    def mapped(self) -> MappedShapes:
        """MappedShapes of all copies: patches, cut faces, attributes, bent objects, frames. Kept."""
    def outline(self, index: SupportsIndex) -> list[_Floats]:
        """List of (n, 3) float64: the closed outlines of a copy on the surface, loop by loop. InputError for an index out of range."""
    def conform(self, vertices: ArrayLike, index: SupportsIndex) -> _Floats:
        """(n, 3) float64: an object, (n, 3) or (n, 2) in the shape's units, bent onto the surface as a copy is; see `MappedShapes.conform`."""
    def __len__(self) -> int: ...

def distribute(
    graph: SaddleVertexGraph | Mesh,
    shapes: Shape | Sequence[Shape],
    counts: SupportsIndex | ArrayLike | None = None,
    field: DirectionField | Sequence[DirectionField] | None = None,
    density: ArrayLike | Sequence[ArrayLike] | None = None,
    size: SupportsFloat | ArrayLike | Sequence[SupportsFloat | ArrayLike] = 1.0,
    seed: SupportsIndex = 0,
    mode: Literal["random", "packed"] | SupportsFloat = "random",
    maximal: bool = False,
    *,
    shares: ArrayLike | None = None,
    gap: SupportsFloat = 0.0,
    size_range: ArrayLike = ...,
    forbidden: ArrayLike | None = None,
    around: Placements | None = None,
    mirror: bool = False,
    bend: bool = False,
    tolerance: SupportsFloat = 0.01,
    threads: SupportsIndex = 0,
    job: Job | None = None,
) -> Distribution:
    """Lays many copies of shapes on a surface so that none collides with another.

    Every copy is accepted only after the exact test of its outline, cut at the edges of the faces, against those already there.
    Candidates come in a random order (or that of a sweep), and each that finds room stays, as if one after the other.

    Args:
        graph: a SaddleVertexGraph or a Mesh.
        shapes: a Shape or a sequence of Shapes.
        counts: None: as many as find room; or one integer a shape (one for all where there is one shape, or with shares).
        field: DirectionField of the mesh: x axes of the shapes point along one of its directions, chosen at random among those
            that make a difference; or a sequence of them, one a shape. None: the smoothest field of lines.
        density: (V,) wanted number of copies per area, only ratios matter; needs counts or maximal. Or one such array a shape, as
            (n, V) or a sequence: each shape then follows its own.
        size: scale of the shapes, mesh units for one unit of their planes: a number, or (V,); or one a shape: (n,), (n, V) or a
            sequence of numbers and arrays. What is as long as there are vertices is one a vertex.
        seed: integer >= 0.
        mode: "random", or "packed": one beside the other in a front that sweeps over the surface, denser by a quarter and more;
            or a number from 0 (random) to 1 (packed).
        maximal: go on until nothing more fits, and prove it: `result.certificate`. Of a density only where it is positive, and none
            is centered where it is 0. It says which places, and of several classes which class (each by its density's share of
            its own mean there), are tried first; what lies there in the end is full, so for numbers per area use sizes (V,).
        shares: one number a shape, its share of the copies, only ratios matter; kept to a hundredth and one copy even where
            room runs out: where one class finds no more, the others stop as well. With a density those of the counts. None:
            counts alone, or whatever finds room.
        gap: least distance between copies, mesh units; half of it is kept to the border and to what is forbidden.
        size_range: (smallest, largest): every copy is scaled by another factor in this range.
        forbidden: (F,) booleans: faces that nothing may touch.
        around: Placements of these shapes that lie on the surface already: the others are laid around them. They come first in
            the result, as they are, and count as copies of their shapes, whatever the counts say. The others keep the gap to
            them, or half of it where they lie nearer to the border than that; of themselves only that none meets another is
            asked.
        mirror: half of the copies are mirrored, at random.
        bend: copies bend along the field's curves, as `map_shapes` lays them when given the field: for long shapes. Needs a
            field.
        tolerance: clearance of the proof, as a share of the circumradius, and half of the gap, of the smallest copy of a kind
            that might lie there.
        threads: 0: all cores. The result is the same for any number.
        job: progress and cancellation.

    Returns:
        Distribution.

    Raises:
        InputError: naming the argument: no shape; counts of another number than shapes, or negative; shares of another number,
            negative, all zero, with maximal, or beside counts of each shape; a field of another mesh; bend without a field;
            sizes or density of the wrong length, not finite or not positive; fields, sizes or densities of another number
            than shapes; copies around which to lay that meet each other or do not fit where they are; density zero everywhere,
            or without counts or maximal; a copy larger than the surface, alone or with half of the gap around; everything forbidden.
        Cancelled: the job was.

    Notes:
        Distances are within the surface: sheets that lie close to each other know nothing of each other. After
        [blelloch2012], and [ebeida2011] for outlines instead of disks.
    """

def _write_file(path: _Path, contents: bytes) -> None:
    """Writes a file whole, or leaves what was there before. Raises InputError when it cannot be written."""
