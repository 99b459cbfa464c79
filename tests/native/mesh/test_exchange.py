# SPDX-License-Identifier: MIT
"""Meshes and results in other packages and files: all that these can hold comes back to the bit.

trimesh and meshio are always there. The larger ones are where SADDLEBACK_PACKAGING=all asks for them:
tests/packaging/test_other_packages.py runs this file with all of them.
"""

from __future__ import annotations

import ctypes
import importlib.util
import io
import os
import re
import sys
import xml.etree.ElementTree
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import meshio
import numpy as np
import pytest
import trimesh

import saddleback as sb
from tests import meshes

MESH = sb.Mesh(*meshes.icosphere(2))
VALUES = np.random.default_rng(0).normal(size=MESH.vertex_count)
CELLS = np.arange(MESH.face_count, dtype=np.int32) % 7
WITH_ALL = os.environ.get("SADDLEBACK_OTHER_PACKAGES") == "all"


def needs(package: str) -> Any:
    there = WITH_ALL or importlib.util.find_spec(package)
    return pytest.mark.skipif(
        not there, reason=f"{package} is not here: SADDLEBACK_PACKAGING=all tests/run tests/packaging"
    )


def is_same_mesh(a: sb.Mesh, b: sb.Mesh) -> bool:
    return a.vertices.tobytes() == b.vertices.tobytes() and a.triangles.tobytes() == b.triangles.tobytes()


def read_by_trimesh(path: Path, element: str) -> Any:
    """An element's properties."""
    return trimesh.load(path, process=False).metadata["_ply_raw"][element]["data"]


@pytest.mark.parametrize(
    "package", [pytest.param(name, marks=needs(name)) for name in ("trimesh", "meshio", "pyvista", "open3d")]
)
def test_meshes_come_back_to_the_bit(package: str) -> None:
    there = getattr(MESH, f"to_{package}")()
    assert is_same_mesh(getattr(sb.Mesh, f"from_{package}")(there), MESH)


def test_trimesh_keeps_attributes(tmp_path: Path) -> None:
    there = MESH.to_trimesh({"value": VALUES, "cell": CELLS})
    assert (there.vertex_attributes["value"] == VALUES).all()
    assert (there.face_attributes["cell"] == CELLS).all()
    assert there.area == pytest.approx(MESH.area, rel=1e-12)


def test_meshio_keeps_attributes_through_its_files(tmp_path: Path) -> None:
    there = MESH.to_meshio({"value": VALUES, "cell": CELLS})
    for name in ("a.vtu", "a.vtk"):
        there.write(tmp_path / name)
        again = meshio.read(tmp_path / name)
        assert is_same_mesh(sb.Mesh.from_meshio(again), MESH), name
        assert (again.point_data["value"] == VALUES).all()
        assert (again.cell_data["cell"][0] == CELLS).all()


def test_meshio_in_the_plane_with_quadrangles_and_lines() -> None:
    points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (2.0, 0.5)]
    cells = [("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]])]
    made = sb.Mesh.from_meshio(meshio.Mesh(points, cells))
    assert made.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]]
    assert made.area == 1.5


def test_points_of_single_precision_are_doubled_exactly() -> None:
    single = MESH.vertices.astype(np.float32)
    there = trimesh.Trimesh(single, MESH.triangles, process=False)
    assert (sb.Mesh.from_trimesh(there).vertices == single.astype(np.float64)).all()


@needs("pyvista")
def test_pyvista_keeps_attributes_and_makes_triangles() -> None:
    import pyvista

    there = MESH.to_pyvista({"value": VALUES, "cell": CELLS})
    assert (there.point_data["value"] == VALUES).all()
    assert (there.cell_data["cell"] == CELLS).all()
    for other in (pyvista.Plane(i_resolution=3, j_resolution=2), pyvista.Plane().cast_to_unstructured_grid()):
        assert sb.Mesh.from_pyvista(other).area == pytest.approx(1)


@needs("open3d")
def test_open3d_of_both_kinds() -> None:
    import open3d

    colors = np.random.default_rng(1).integers(0, 256, (MESH.vertex_count, 3), dtype=np.uint8)
    there = MESH.to_open3d({"color": colors, "normal": sb.vertex_normals(MESH.vertices, MESH.triangles)})
    assert (np.round(np.asarray(there.vertex_colors) * 255) == colors).all()
    assert is_same_mesh(
        sb.Mesh.from_open3d(open3d.t.geometry.TriangleMesh.from_legacy(there, open3d.core.float64)), MESH
    )
    with pytest.raises(sb.InputError, match="holds color and normal of vertices, not 'value'"):
        MESH.to_open3d({"value": VALUES})


@pytest.mark.parametrize("package", ["trimesh", "pyvista", "meshio", "open3d"])
def test_something_else_is_refused_by_a_sentence(package: str) -> None:
    with pytest.raises(sb.InputError, match=f"mesh: wanted .* of {package}, got a list"):
        getattr(sb.Mesh, f"from_{package}")([])


def test_what_is_no_mesh_there_is_none_here() -> None:
    with pytest.raises(sb.InputError, match=r"wanted triangles or quadrangles, got cells of the kinds: line"):
        sb.Mesh.from_meshio(meshio.Mesh([(0.0, 0, 0), (1.0, 0, 0)], [("line", [[0, 1]])]))
    twice = np.vstack([MESH.triangles, MESH.triangles[:1]])
    with pytest.raises(sb.MeshError, match="repair"):
        sb.Mesh.from_trimesh(SimpleNamespace(vertices=MESH.vertices, faces=twice))


@pytest.mark.parametrize("package", ["trimesh", "pyvista", "meshio", "open3d"])
def test_without_the_package_it_says_what_to_install(package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(
        ImportError, match=rf"to_{package} needs {package}, which is not here .*; pip install {package}"
    ):
        getattr(MESH, f"to_{package}")()


def test_ply_attributes_are_read_by_others(tmp_path: Path) -> None:
    colors = np.random.default_rng(1).random((MESH.vertex_count, 3))
    normals = sb.vertex_normals(MESH.vertices, MESH.triangles)
    given = {"value": VALUES, "color": colors, "normal": normals, "pair": np.c_[VALUES, VALUES], "cell": CELLS}
    for name in ("a.ply", "b.PLY.gz"):
        sb.write_mesh(tmp_path / name, MESH, given)
        assert is_same_mesh(sb.read_mesh(tmp_path / name), MESH)
    assert (read_by_trimesh(tmp_path / "a.ply", "face")["cell"].ravel() == CELLS).all()
    sb.write_mesh(tmp_path / "c.ply", MESH, {name: array for name, array in given.items() if name != "cell"})
    there = meshio.read(tmp_path / "c.ply")  # which knows no properties beside a list
    assert is_same_mesh(sb.Mesh.from_meshio(there), MESH)
    assert (there.point_data["value"] == VALUES).all()
    assert (there.point_data["pair_1"] == VALUES).all()
    assert (np.c_[there.point_data["nx"], there.point_data["ny"], there.point_data["nz"]] == normals).all()
    assert (there.point_data["red"].view(np.uint8) == np.round(colors[:, 0] * 255)).all()  # it takes uchar for signed
    shown = trimesh.load(tmp_path / "a.ply", process=False)
    assert (shown.visual.vertex_colors[:, :3] == np.round(colors * 255)).all()


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "?", "f4", "f8"])
def test_every_type_of_number(kind: str, tmp_path: Path) -> None:
    values = (np.arange(MESH.vertex_count) % 100).astype(kind)
    sb.write_mesh(tmp_path / "a.ply", MESH, {"value": values})
    assert (read_by_trimesh(tmp_path / "a.ply", "vertex")["value"].ravel() == values).all()


def test_obj_keeps_colors_normals_uv_and_groups(tmp_path: Path) -> None:
    uv = np.random.default_rng(1).random((MESH.vertex_count, 2))
    normals = sb.vertex_normals(MESH.vertices, MESH.triangles)
    colors = np.full((MESH.vertex_count, 4), 51, np.uint8)
    sb.write_mesh(tmp_path / "a.obj", MESH, {"uv": uv, "normal": normals, "color": colors, "cell": CELLS})
    assert is_same_mesh(sb.read_mesh(tmp_path / "a.obj"), MESH)
    lines = (tmp_path / "a.obj").read_text().splitlines()
    assert sum(line.startswith("g cell_") for line in lines) == MESH.face_count
    assert [line for line in lines if line.startswith("vt ")] == ["vt {!r} {!r}".format(*row) for row in uv.tolist()]
    first = next(line for line in lines if line.startswith("v "))
    assert first.endswith(" 0.2 0.2 0.2")
    there = trimesh.load(tmp_path / "a.obj", process=False, maintain_order=True)
    assert len(there.faces) == MESH.face_count


@pytest.mark.parametrize(
    ("name", "attributes", "said"),
    [
        ("a.stl", {}, 'the extension "stl"; wanted ply or obj, or these with .gz'),
        ("a", {}, 'the extension ""'),
        ("a.ply", {"two words": VALUES}, "'two words' is no name"),
        ("a.ply", {"x": VALUES}, "'x' would be a second 'x'"),
        ("a.ply", {"red": CELLS[: MESH.vertex_count], "color": np.zeros((MESH.vertex_count, 3))}, "a second 'red'"),
        ("a.ply", {"value": VALUES[:5]}, "'value' has 5 rows; wanted 162 for the vertices or 320 for the faces"),
        ("a.ply", {"value": np.zeros((162, 2, 2))}, r"wanted \(n,\) or \(n, k\) numbers"),
        ("a.ply", {"value": ["a"] * 162}, r"wanted \(n,\) or \(n, k\) numbers"),
        ("a.ply", {"value": np.full(162, 2**40)}, "integers of more than 32 bits"),
        ("a.ply", {"color": np.full((162, 3), 2.0)}, "wanted uint8, or floats from 0 to 1"),
        ("a.ply", {"color": VALUES}, "wanted 3 or 4 values each"),
        ("a.obj", {"value": VALUES}, "an OBJ file holds no 'value' of vertices; write a PLY file"),
        ("a.obj", {"cell": CELLS, "other": CELLS}, "one array of integers of faces, not cell, other"),
    ],
)
def test_what_a_file_cannot_hold_is_told(name: str, attributes: Any, said: str, tmp_path: Path) -> None:
    with pytest.raises(sb.InputError, match=said):
        sb.write_mesh(tmp_path / name, MESH, attributes)
    assert not list(tmp_path.iterdir())


def test_what_is_no_mesh_is_not_written(tmp_path: Path) -> None:
    for wrong, said in (
        ("mesh", "wanted a Mesh, or vertices and triangles, got a str"),
        ((MESH.vertices[:, :2], MESH.triangles), r"wanted vertices \(n, 3\)"),
        ((MESH.vertices, MESH.triangles + 1), "name vertices beyond the 162"),
        ((MESH.vertices, MESH.triangles * 1.0), "wanted triangles of integers"),
    ):
        with pytest.raises(sb.InputError, match=said):
            sb.write_mesh(tmp_path / "a.ply", wrong)
    with pytest.raises(sb.InputError, match=r"curves: wanted \(n, 3\) points, got \(3, 2\) at \[1\]"):
        sb.write_curves(tmp_path / "a.obj", [np.zeros((3, 3)), np.zeros((3, 2))])
    assert not list(tmp_path.iterdir())


def test_objects_of_others_are_looked_at_before_they_are_written(tmp_path: Path) -> None:
    sb.write_mesh(tmp_path / "a.ply", MESH.to_trimesh())  # whose `triangles` are places
    assert is_same_mesh(sb.read_mesh(tmp_path / "a.ply"), MESH)
    for vertices, triangles, said in (
        (MESH.vertices, [[0, 1, 9999]], "name vertices beyond"),
        (MESH.vertices[:, :2], MESH.triangles, r"wanted vertices \(n, 3\)"),
        (MESH.vertices, lambda: MESH.triangles, r"wanted triangles \(n, 3\)"),
    ):
        with pytest.raises(sb.InputError, match=said):
            sb.write_mesh(tmp_path / "b.ply", SimpleNamespace(vertices=vertices, triangles=triangles))


def test_faces_where_there_are_as_many_vertices(tmp_path: Path) -> None:
    torus = sb.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    sb.write_mesh(tmp_path / "a.ply", torus, {"a": [1, 2, 3, 4]}, face_attributes={"b": [5, 6, 7, 8]})
    assert read_by_trimesh(tmp_path / "a.ply", "vertex")["a"].ravel().tolist() == [1, 2, 3, 4]
    assert read_by_trimesh(tmp_path / "a.ply", "face")["b"].ravel().tolist() == [5, 6, 7, 8]


def test_a_write_that_fails_leaves_what_was_there(tmp_path: Path) -> None:
    (tmp_path / "a.ply").mkdir()
    with pytest.raises(OSError, match=r"a\.ply"):
        sb.write_mesh(tmp_path / "a.ply", MESH)
    with pytest.raises(OSError, match="nowhere"):
        sb.write_mesh(tmp_path / "nowhere" / "a.ply", MESH)
    assert [path.name for path in tmp_path.iterdir()] == ["a.ply"]


def test_compressed_files_are_the_same_bytes_each_time(tmp_path: Path) -> None:
    for name in ("a.ply.gz", "b.ply.gz"):
        sb.write_mesh(tmp_path / name, MESH)
    assert (tmp_path / "a.ply.gz").read_bytes() == (tmp_path / "b.ply.gz").read_bytes()


def test_notebooks_show_pictures_and_tables() -> None:
    diagram = sb.voronoi_2d(np.random.default_rng(0).random((20, 2)))
    for shown in (diagram._repr_svg_(), sb.triangle_quality(MESH.vertices, MESH.triangles)._repr_svg_()):
        xml.etree.ElementTree.fromstring(shown)
    assert diagram._repr_svg_().count("<circle") == 20
    assert sb.voronoi_2d(np.random.default_rng(0).random((20_001, 2)))._repr_svg_() is None
    graph = sb.SaddleVertexGraph(MESH)
    even = sb.centroidal_voronoi(graph, count=5, max_iterations=2)
    laid = sb.distribute(MESH, sb.Shape.disk(), 2, size=0.1)
    for value in (MESH, graph, even, even.cells, laid):
        table = xml.etree.ElementTree.fromstring(value._repr_html_())
        assert table.find("caption").text == f"saddleback.{type(value).__name__}"
    assert "<td>162</td>" in MESH._repr_html_()


class Bar:
    """A stand-in for tqdm's, which has drawn what it was told."""

    def __init__(self, total: int, **_: object) -> None:
        self.total, self.n, self.texts, self.is_open = total, 0, set(), True
        type(self).last = self

    def set_description_str(self, text: str, refresh: bool) -> None:
        self.texts.add(text)

    def refresh(self) -> None:
        pass

    def close(self) -> None:
        self.is_open = False


@pytest.mark.parametrize("with_tqdm", [True, False])
def test_a_bar_in_a_notebook(with_tqdm: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    err = io.StringIO()
    monkeypatch.setattr(sys, "stderr", err)
    monkeypatch.setitem(sys.modules, "ipykernel", ModuleType("ipykernel"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", SimpleNamespace(tqdm=Bar) if with_tqdm else None)
    mesh = sb.Mesh(*meshes.icosphere(6))
    with sb.progress_bar() as job:
        sb.exact_distances(mesh, [0], job=job)
        sb.exact_distances(mesh, [0])  # that it is seen at its end
    if with_tqdm:
        assert (Bar.last.n, Bar.last.total, Bar.last.is_open) == (100, 100, False)
        assert Bar.last.texts - {""}
        assert not err.getvalue()
    else:
        assert "100 %" in err.getvalue()
        assert "\x1b" not in err.getvalue()


def test_tqdm_itself_takes_what_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ipykernel", ModuleType("ipykernel"))
    monkeypatch.setattr(sys, "stderr", err := io.StringIO())
    with sb.progress_bar() as job:
        sb.exact_distances(sb.Mesh(*meshes.icosphere(5)), [0], job=job)
    assert "%" in err.getvalue()


@needs("pyvista")
@needs("polyscope")
@pytest.mark.parametrize("backend", ["pyvista", "polyscope"])
def test_everything_can_be_shown(backend: str, tmp_path: Path) -> None:
    from PIL import Image

    if backend == "polyscope":
        import polyscope

        polyscope.set_use_prefs_file(False)
        polyscope.init("openGL_mock")
    graph = sb.SaddleVertexGraph(MESH)
    cells = sb.geodesic_voronoi(graph, [0, 9, 60])
    field = sb.direction_field(MESH, 1, {0: 1, 3: 1})
    laid = sb.distribute(MESH, sb.Shape.star(), 3, size=0.2)
    scenes: list[tuple[Any, ...]] = [(MESH,), (graph,), (cells,), (cells.dual(), cells.edges[0]), (laid,)]
    scenes += [(graph.path(0, 30), field, sb.sample(MESH, 5))]
    for number, things in enumerate(scenes):
        picture = tmp_path / f"{number}.png"
        given = {"attributes": {"value": VALUES}} if number == 5 else {}
        sb.show(*things, mesh=MESH if number == 5 else None, backend=backend, picture=picture, **given)
        assert backend == "polyscope" or len(np.unique(np.array(Image.open(picture)))) > 5


@needs("pyvista")
def test_a_machine_that_cannot_draw_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def no_library(name: str) -> None:
        raise OSError(name)

    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.setattr(ctypes, "CDLL", no_library)
    with pytest.raises(sb.Error, match="there is no display, and no libEGL"):
        sb.show(MESH, backend="pyvista", picture=tmp_path / "no.png")


def test_what_cannot_be_shown_says_why() -> None:
    for things, said in (
        ((sb.sample(MESH, 3),), "a SurfacePoints is shown on its mesh; give it as mesh="),
        (("mesh",), "a str cannot be shown"),
    ):
        with pytest.raises(sb.InputError, match=re.escape(said)):
            sb.show(*things)
    with pytest.raises(sb.InputError, match='wanted "auto", "pyvista" or "polyscope", got'):
        sb.show(MESH, backend="vtk")
    with pytest.raises(sb.InputError, match="a Mesh cannot be plotted"):
        sb.plot(MESH)


@needs("matplotlib")
def test_numbers_are_plotted() -> None:
    import matplotlib

    matplotlib.use("Agg")
    even = sb.centroidal_voronoi(sb.SaddleVertexGraph(MESH), count=5, max_iterations=4)
    axes = sb.plot(even)
    assert (axes.lines[0].get_ydata() == even.energy).all()
    sweep = sb.SweepCircle(np.random.default_rng(0).random((20, 2)), (0.5, 0.5))
    sweep.grow(0.4)
    outline = np.array(sb.plot(sweep).lines[0].get_data())
    assert np.hypot(*(outline - 0.5 * np.ones((2, 1)))) == pytest.approx(sweep.radius)
    quality = sb.triangle_quality(MESH.vertices, MESH.triangles)
    assert sb.plot(quality).patches[0].get_data().values.sum() == pytest.approx(1)
