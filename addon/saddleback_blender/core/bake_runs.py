# SPDX-License-Identifier: GPL-3.0-or-later
"""Images of cells: from a UV map to files."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import cache as cache_module
from . import native
from .cache import Cache
from .cell_runs import shape_of_each
from .errors import BadInputError
from .images.exr import exr_bytes
from .images.png import png_bytes
from .progress import Progress
from .requests import BakeRequest, Direction
from .results import Indices, Reals
from .runs import Solved, solved_cells
from .settings import BakeSettings
from .solids.cell_mesh import CellShape
from .surfaces.cell_colors import cell_colors

FIRST_TILE = 1001
MOST_TEXELS = 16384
MOST_NAMED = 3
MOST_UNSURE = 0.01  # of the vertices
LEAST = float(np.finfo(np.float32).tiny)
LEVEL = 1e-3  # sine of the angle to the world's Z: normals nearer to it have no side
CELLS_DONE = 0.5  # of the run's progress
Part = Callable[[slice], NDArray[np.floating]]


@dataclass(frozen=True)
class BakedImage:
    """One map: a file for each tile."""

    label: str
    files: dict[int, Path]
    reach: float = 0.0  # what 1 stands for, in world units; 0 where values are what they are


@dataclass(frozen=True)
class BakeResult:
    """The images, whose files are gone with this."""

    images: tuple[BakedImage, ...]
    count: int  # of cells


@dataclass(frozen=True)
class _Reach:
    """The largest values of all tiles: of distances to edges, in all and in each cell, and of places in cells."""

    edge: float
    of_cells: Reals
    local: float


def tiles_of(uv: Reals) -> tuple[Indices, NDArray[np.bool_]]:
    """Numbers of the UDIM tiles in which the middles of triangles lie, (3 F, 2); which triangles (F,) are in none."""
    squares = np.floor(uv.reshape(-1, 3, 2).mean(axis=1)).astype(np.int64)
    outside = (squares[:, 0] < 0) | (squares[:, 0] > 9) | (squares[:, 1] < 0) | (squares[:, 1] > 99)
    numbers = FIRST_TILE + squares[:, 0] + 10 * squares[:, 1]
    return np.unique(numbers[~outside]).astype(np.int32), outside


def bake(request: BakeRequest, progress: Progress, cache: Cache | None = None) -> BakeResult:
    """Bakes the wanted maps into files. Raises BadInputError, the library's errors, and its Cancelled."""
    cache = cache or cache_module.shared
    _, _, solved, _ = solved_cells(request.cells, progress, cache)
    _check_cells(request, solved.cells)
    if request.settings.profile == "CELLS":
        request = replace(request, shape=shape_of_each(request.shape, request.cells, solved.cells.sites))
    _check_numbers(request, len(solved.cells.areas))
    baker = _Baker(request, solved, progress)
    try:
        folder = Path(tempfile.mkdtemp(prefix="saddleback-"))
        try:
            result = _into(folder, request, solved.cells, baker, progress)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
    except OSError as error:
        raise BadInputError(
            f"'{request.cells.surface.name}': the maps cannot be written to the system's folder for temporary files "
            f"on their way: {error.strerror}; make room there, or bake fewer or smaller maps"
        ) from error
    weakref.finalize(result, shutil.rmtree, folder, ignore_errors=True)
    return result


def _into(folder: Path, request: BakeRequest, cells: Any, baker: _Baker, progress: Progress) -> BakeResult:
    count, settings = len(cells.areas), request.settings
    reach = baker.reach_of_all() if len(request.tiles) > 1 else None
    suffix = ".exr" if settings.bits == "32" else ".png"
    files: dict[str, dict[int, Path]] = {}
    for number, tile in enumerate(request.tiles):
        baked = baker.tile(tile, settings.margin, baker.share(number + len(request.tiles), 0.8))
        if number == 0:
            baker.tell_left_out()
        reach = reach or _largest([_reach_of(baked)])
        with ThreadPoolExecutor(request.threads or None) as pool:
            written = []
            for label, part in _maps(request, baked, reach, cells):
                path = folder / f"{label.replace(' ', '_')}.{tile}{suffix}"
                files.setdefault(label, {})[tile] = path
                written.append(pool.submit(_write, path, part, settings, progress))
        for write in written:
            write.result()
        del baked
    assert reach is not None
    images = tuple(BakedImage(label, paths, _unit_of(label, request, reach)) for label, paths in files.items())
    return BakeResult(images, count)


class _Baker:
    """Bakes tiles, and notes which faces are in none."""

    def __init__(self, request: BakeRequest, solved: Solved, progress: Progress) -> None:
        self._request, self._cells, self._progress = request, solved.cells, progress
        self._axes = _level(solved.site_normals, request.up)
        self._outside: Indices | None = None
        self._without_area: Indices = np.empty(0, np.int32)
        self._passes = 2 * len(request.tiles)

    def share(self, done: int, part: float) -> float:
        """Of the run's progress."""
        return CELLS_DONE + (1.0 - CELLS_DONE) * (done + part) / self._passes

    def reach_of_all(self) -> _Reach:
        """What values reach in all tiles, which are baked for that alone."""
        return _largest(
            [_reach_of(self.tile(tile, 0, self.share(number, 1.0))) for number, tile in enumerate(self._request.tiles)]
        )

    def tile(self, tile: int, margin: int, end: float) -> Any:
        """Bakes one tile. Raises BadInputError where faces overlap."""
        settings, sb = self._request.settings, native.load()
        square = (tile - FIRST_TILE) % 10, (tile - FIRST_TILE) // 10
        size = (settings.resolution, settings.resolution)
        with self._progress.stage(end, "baking" if len(self._request.tiles) == 1 else f"baking tile {tile}") as job:
            try:
                baked = sb.bake_cells(
                    self._cells, self._request.uv, values=self._request.directions, size=size, tile=square,
                    margin=margin, edge_distance=settings.bake_edge_distance or settings.bake_height,
                    local_uv=settings.bake_local_uv, axes=self._axes, threads=self._request.threads, job=job,
                )  # fmt: skip
            except sb.InputError:
                bare = sb.bake_cells(
                    self._cells, self._request.uv, size=size, tile=square, margin=0, edge_distance=False,
                    local_uv=False, allow_overlaps=True, threads=self._request.threads, job=job,
                )  # fmt: skip
                if not len(bare.overlapping):
                    raise
                raise BadInputError(
                    self._told("overlap others", bare.overlapping, "unwrap them side by side")
                ) from None
        outside = np.asarray(baked.outside)
        self._outside = outside if self._outside is None else np.intersect1d(self._outside, outside)
        self._without_area = np.union1d(self._without_area, np.asarray(baked.without_area)).astype(np.int32)
        return baked

    def tell_left_out(self) -> None:
        """Notes faces that no image shows. Raises BadInputError where none shows any."""
        count = len(self._request.uv) // 3
        outside = self._outside if self._outside is not None else np.empty(0, np.int32)
        if len(outside) + len(self._without_area) >= count:
            raise BadInputError(
                f"'{self._name}': no face has an area within the image in {self._label}; unwrap the mesh (UV > Unwrap)"
            )
        advice = {
            "lie outside the image": (outside, "move them there in the UV Editor, or choose UDIM Tiles"),
            "have no area": (self._without_area, "unwrap them: no texel shows them"),
        }
        for what, (triangles, remedy) in advice.items():
            if len(triangles):
                self._progress.note(self._told(what, triangles, remedy))

    @property
    def _name(self) -> str:
        return self._request.cells.surface.name

    @property
    def _label(self) -> str:
        name = self._request.settings.uv_name
        return f"UV map '{name}'" if name else "its UV map"

    def _told(self, what: str, triangles: Indices, remedy: str) -> str:
        polygons = np.unique(self._request.polygons[triangles])
        named = ", ".join(str(number) for number in polygons[:MOST_NAMED])
        more = ", ..." if len(polygons) > MOST_NAMED else ""
        faces = "1 face" if len(polygons) == 1 else f"{len(polygons):,} faces"
        return f"'{self._name}': {faces} ({named}{more}) {what} in {self._label}; {remedy}"


def _level(normals: Reals, up: Direction) -> Reals:
    """Directions (n, 3) along the surface to the right where `up` is upwards; along X on level ground."""
    right = np.cross(np.array(up), normals)
    is_level = np.linalg.norm(right, axis=1) > LEVEL
    return np.where(is_level[:, None], right, np.array([1.0, 0.0, 0.0]))


def _check_cells(request: BakeRequest, cells: Any) -> None:
    """Refuses cells that are others than those one sees."""
    seen = request.vertex_cell
    if seen is None:
        return
    surface, sites = request.cells.surface, request.cells.sites
    other = np.count_nonzero(surface.spread(cells.vertex_cell, -1, cells.vertex_distance) != seen)
    # Of kept centers a vertex half way between two may come to either.
    if other > (0 if sites is None else MOST_UNSURE * len(seen)):
        raise BadInputError(
            f"'{surface.name}': its cells are not those that are seen, since its mesh or its settings were changed: "
            "press Tessellate first"
        )


def _check_numbers(request: BakeRequest, count: int) -> None:
    settings = request.settings
    most = {"8": 2**8, "16": 2**16}.get(settings.bits)
    if settings.bake_cell and settings.cell_as == "NUMBER" and most is not None and count > most:
        raise BadInputError(
            f"'{request.cells.surface.name}' has {count:,} cells, and {settings.bits} bits can number {most:,}; choose "
            "more bits, or colors for the cells"
        )


def _reach_of(baked: Any) -> _Reach:
    of_cells = np.asarray(baked.farthest, np.float64)
    local = 0.0 if baked.local_uv is None else float(max(baked.local_uv.max(), -baked.local_uv.min()))
    return _Reach(float(of_cells.max(initial=0.0)), of_cells, local)


def _largest(reaches: list[_Reach]) -> _Reach:
    return _Reach(
        max(reach.edge for reach in reaches),
        np.max([reach.of_cells for reach in reaches], axis=0),
        max(reach.local for reach in reaches),
    )


def _unit_of(label: str, request: BakeRequest, reach: _Reach) -> float:
    if label == "Height":
        return float(np.max(request.shape.height))
    if request.settings.bits == "32":
        return 0.0
    return {"Edge Distance": reach.edge, "Local UV": reach.local}.get(label, 0.0)


def _maps(request: BakeRequest, baked: Any, reach: _Reach, cells: Any) -> Iterable[tuple[str, Part]]:
    """Names of the wanted maps, each with what makes rows (k, width, channels) of it, 0 to 1 but for 32 bits."""
    settings = request.settings
    is_raw = settings.bits == "32"
    if settings.bake_cell:
        colors = _colors(settings, cells)
        yield "Cell", lambda part: colors[baked.cell[part]]
    if settings.bake_edge_distance:
        unit = 1.0 if is_raw else max(reach.edge, LEAST)
        yield "Edge Distance", lambda part: _finite(baked.edge_distance[part], reach.edge)[:, :, None] / unit
    if settings.bake_height:
        yield (
            "Height",
            lambda part: _height(
                _finite(baked.edge_distance[part], reach.edge), baked.cell[part], request.shape, reach.of_cells
            ),
        )
    if settings.bake_local_uv:
        yield "Local UV", lambda part: _signed(_with_zero(baked.local_uv[part]), is_raw, reach.local)
    if settings.bake_direction:
        yield "Direction", lambda part: _signed(_unit(baked.values[part]), is_raw, 1.0)


def _colors(settings: BakeSettings, cells: Any) -> Reals:
    """What stands for each cell, and last for none."""
    count = len(cells.areas)
    if settings.cell_as == "COLOR":
        return np.concatenate([cell_colors(count, np.asarray(cells.edge_cells)), np.zeros((1, 3))])
    numbers = np.append(np.arange(count, dtype=np.float64), 0.0)
    return (numbers / {"8": 255.0, "16": 65535.0, "32": 1.0}[settings.bits])[:, None]


def _finite(distance: NDArray[np.floating], farthest: float) -> NDArray[np.floating]:
    """A cell without an edge is all middle."""
    return np.where(np.isfinite(distance), distance, farthest)


def _height(distance: NDArray[np.floating], cell: Indices, shape: CellShape, farthest: Reals) -> NDArray[np.floating]:
    """The share of the thickness (k, width, 1), as the output Cells is raised."""
    start, width, height = (
        np.append(np.broadcast_to(lengths, len(farthest)), 0.0)
        for lengths in (shape.rim_start, shape.rim_width, shape.height)
    )
    inside = distance - start[cell]
    plateau = (inside > 0.0).astype(np.float64)
    np.divide(inside, width[cell], out=plateau, where=width[cell] > 0.0)
    plateau = np.clip(plateau, 0.0, 1.0)
    within = np.clip(inside / np.maximum(np.append(farthest, 1.0) - start, LEAST)[cell], 0.0, 1.0)
    round_share = np.sqrt(within * (2.0 - within))
    share = (1.0 - shape.dome) * plateau + shape.dome * round_share
    if shape.thickness_by is not None:
        share *= (height / max(height.max(), LEAST))[cell]
    return np.where(cell >= 0, share, 0.0)[:, :, None]


def _with_zero(uv: NDArray[np.floating]) -> NDArray[np.floating]:
    return np.concatenate([uv, np.zeros_like(uv[:, :, :1])], axis=2)


def _unit(vectors: NDArray[np.floating]) -> NDArray[np.floating]:
    length = np.linalg.norm(vectors, axis=2, keepdims=True)
    units: NDArray[np.floating] = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return units


def _signed(values: NDArray[np.floating], is_raw: bool, reach: float) -> NDArray[np.floating]:
    return values if is_raw else 0.5 + values / (2.0 * max(reach, LEAST))


def _write(path: Path, part: Part, settings: BakeSettings, progress: Progress) -> None:
    height = settings.resolution
    if settings.bits == "32":
        data = exr_bytes(lambda rows: part(rows).astype(np.float32), height, progress.check)
    else:
        kind = np.uint8 if settings.bits == "8" else np.uint16
        most = np.iinfo(kind).max

        def whole(rows: slice) -> NDArray[np.unsignedinteger]:
            return np.rint(most * np.clip(part(rows), 0.0, 1.0)).astype(kind)

        data = png_bytes(whole, height, progress.check)
    with path.open("wb") as file:
        for block in data:
            file.write(block)
