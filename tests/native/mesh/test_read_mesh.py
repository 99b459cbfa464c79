# SPDX-License-Identifier: MIT
"""read_mesh and read_arrays: every format, and files that lie."""

import gzip
import os
import random
import struct

import numpy as np
import pytest

import saddleback as sb
from tests import meshes
from tests.native import mesh_dialects

VERTICES, TRIANGLES = meshes.torus()


def obj(vertices, faces):
    lines = ["# a comment", "mtllib none.mtl", "vn 0 0 1"]
    lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    return "\n".join(lines + ["f " + " ".join(f"{v + 1}//1" for v in f) for f in faces]).encode()


def off(vertices, faces):
    lines = ["COFF", "# a comment", f"{len(vertices)} {len(faces)} 0"]
    lines += [f"{x!r} {y!r} {z!r} 255 0 0 255" for x, y, z in vertices.tolist()]
    return "\n".join(lines + [f"{len(f)} " + " ".join(map(str, f)) + " 0.5 0.5 0.5" for f in faces]).encode()


def ply_header(kind, vertices, faces, real="double"):
    return (
        f"ply\nformat {kind} 1.0\ncomment x\nelement vertex {vertices}\nproperty {real} x\nproperty {real} y\n"
        f"property {real} z\nproperty uchar red\nelement face {faces}\nproperty list uchar int vertex_indices\n"
        "property float quality\nend_header\n"
    ).encode()


def ply_text(vertices, faces):
    lines = [f"{x!r} {y!r} {z!r} 7" for x, y, z in vertices.tolist()]
    lines += [f"{len(f)} " + " ".join(map(str, f)) + " 0.5" for f in faces]
    return ply_header("ascii", len(vertices), len(faces)) + "\n".join(lines).encode()


def ply_binary(vertices, faces, order="<"):
    name = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    data = b"".join(struct.pack(order + "dddB", *p, 7) for p in vertices)
    data += b"".join(struct.pack(f"{order}B{len(f)}if", len(f), *f, 0.5) for f in faces)
    return ply_header(name, len(vertices), len(faces)) + data


def ply_big_endian(vertices, faces):
    return ply_binary(vertices, faces, ">")


def stl_binary(vertices, faces):
    data = b"".join(struct.pack("<12fH", 0, 0, 0, *vertices[list(f)].ravel(), 0) for f in faces)
    return b"solid but binary".ljust(80) + struct.pack("<I", len(faces)) + data


def stl_text(vertices, faces):
    text = "solid torus\n"
    for f in faces:
        text += "facet normal 0 0 0\nouter loop\n"
        text += "".join(f"vertex {x!r} {y!r} {z!r}\n" for x, y, z in vertices[list(f)].tolist())
        text += "endloop\nendfacet\n"
    return (text + "endsolid torus\n").encode()


WRITERS = {
    "obj": [obj],
    "off": [off],
    "ply": [ply_text, ply_binary, ply_big_endian],
    "stl": [stl_binary, stl_text],
}
FORMATS = [(extension, writer) for extension, writers in WRITERS.items() for writer in writers]


@pytest.mark.parametrize(("extension", "writer"), FORMATS)
def test_what_was_written_is_read(tmp_path, extension, writer):
    path = tmp_path / f"möbel torus.{extension.upper()}"
    path.write_bytes(writer(VERTICES, TRIANGLES.tolist()))
    mesh = sb.read_mesh(path)
    assert (mesh.vertex_count, mesh.face_count, mesh.genus) == (len(VERTICES), len(TRIANGLES), 1)
    precision = 1e-6 if writer is stl_binary else 0
    assert mesh.vertices[mesh.triangles] == pytest.approx(VERTICES[TRIANGLES], abs=precision)
    vertices, triangles = sb.read_arrays(str(path))
    assert np.array_equal(vertices, mesh.vertices)
    assert np.array_equal(triangles, mesh.triangles)


@pytest.mark.parametrize(("extension", "writer"), [f for f in FORMATS if f[0] != "stl"])
def test_polygons_become_triangles_that_do_not_fold(tmp_path, extension, writer):
    # A dart whose reflex corner comes last: the fan from the first corner would fold over.
    dart = np.array([(0, 0, 0), (2, 1, 0), (4, 0, 0), (2, 3, 0)], dtype=float)[[1, 2, 3, 0]]
    pentagon = np.array([(np.cos(a), np.sin(a), 0) for a in 2 * np.pi * np.arange(5) / 5]) + np.array([10, 0, 0])
    for turn in range(4):
        order = [(i + turn) % 4 for i in range(4)]
        path = tmp_path / f"{turn}.{extension}"
        path.write_bytes(writer(np.vstack([dart, pentagon]), [order, [4, 5, 6, 7, 8]]))
        mesh = sb.read_mesh(path)
        assert mesh.face_count == 5
        a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
        assert (np.cross(b - a, c - a)[:, 2] > 0).all()


@pytest.mark.parametrize(("extension", "writer"), [f for f in FORMATS if f[0] != "stl"])
def test_broken_meshes_are_read_whole_for_repair(tmp_path, extension, writer):
    vertices, triangles = meshes.non_manifold_edge(4)
    path = tmp_path / f"fan.{extension}"
    path.write_bytes(writer(vertices, triangles.tolist()))
    with pytest.raises(sb.MeshError, match="non-manifold edge"):
        sb.read_mesh(path)
    read = sb.read_arrays(path)
    assert np.array_equal(read[1], triangles)
    assert sb.repair(*read)[0].face_count == 4


@pytest.mark.parametrize("name", mesh_dialects.DIALECTS)
def test_dialects(tmp_path, name):
    path = tmp_path / f"größe.{mesh_dialects.DIALECTS[name][0]}"
    path.write_bytes(mesh_dialects.contents(name))
    mesh = sb.read_mesh(path)
    assert (mesh.vertex_count, mesh.face_count, mesh.genus) == (8, 12, 0)
    assert mesh.area == pytest.approx(6, rel=1e-15)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) == pytest.approx(6, rel=1e-15)  # six times the volume


@pytest.mark.parametrize(("extension", "writer"), FORMATS)
def test_compressed_files(tmp_path, extension, writer):
    whole = writer(VERTICES, TRIANGLES.tolist())
    plain, path = tmp_path / f"a.{extension}", tmp_path / f"ü.{extension}.gz"
    plain.write_bytes(whole)
    path.write_bytes(gzip.compress(whole))
    for got, wanted in zip(sb.read_arrays(path), sb.read_arrays(plain), strict=True):
        assert np.array_equal(got, wanted)
    assert np.array_equal(sb.read_mesh(path, job=sb.Job()).triangles, sb.read_mesh(plain).triangles)
    path.write_bytes(gzip.compress(whole)[:-20])
    with pytest.raises(sb.MeshError, match=r"ü\.\w+\.gz cannot be uncompressed"):
        sb.read_mesh(path)
    path.write_bytes(whole)
    with pytest.raises(sb.MeshError, match="cannot be uncompressed: Not a gzipped file"):
        sb.read_arrays(path)
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        sb.read_arrays(path, job=job)
    with pytest.raises(sb.InputError, match=r"none\.obj\.gz cannot be opened: No such file"):
        sb.read_mesh(tmp_path / "none.obj.gz")


V3 = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
PLY = mesh_dialects.PLY
REFUSED = [
    ("a.obj", V3 + "f -4 -2 -1\n", "line 4: vertex -4 is out of range; 3 come before"),
    ("a.obj", V3 + "f 1 2 3\nf 1 2 4\nf 1 2 3\n", "line 5: vertex 4 is out of range; the file has 3"),
    ("a.obj", V3 + "f 1 2 99999999999\n", "line 4: vertex 99999999999 is out of range"),
    ("a.obj", V3 + "f 1,2,3\n", 'line 4: wanted a vertex number, got "1,2,3"'),
    ("a.obj", V3 + "f 1 2 3/x\n", 'line 4: wanted vertex/texture/normal, got "3/x"'),
    ("a.obj", "v 0 0\nv 1 0 0\n", "line 1: the line ends where a coordinate should be"),
    ("a.obj", "v 0 0 1.0d+00\n", 'line 1: wanted a coordinate, got "1.0d\\+00"'),
    ("a.obj", "v 0 0 0 red\n", 'line 1: wanted a number, got "red"'),
    ("a.obj", V3 + "\r\rface 1 2 3\r", 'line 6: "face" is no keyword of OBJ'),
    ("a.obj", V3 + "cstype bspline\nsurf 0 1 0 1 1 2 3\n", "line 5: free-form surfaces are not read"),
    ("a.obj", (V3 + "f 1 2 3\n").encode("utf-16"), "line 1: the text is UTF-16, which is not read; save it as UTF-8"),
    ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "line 6: vertex 3 is out of range; the file has 3"),
    ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", "line 6: vertex -1 is out of range"),
    ("a.off", "OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "line 4: the line ends where a coordinate"),
    ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n", 'line 7: "3" follows the last of 1 faces'),
    ("a.off", "OFF\n-3 1 0\n", "line 2: wanted the number of vertices, got -3"),
    ("a.off", "OFF BINARY\n", "line 1: binary OFF files cannot be read"),
    ("a.off", "off4\n", "text ends where the number of faces"),
    ("a.off", "4OFF\n1 1 0\n", "three dimensions"),
    ("a.off", "OFT\n3 1 0\n", "line 1: an OFF file begins with OFF"),
    ("a.stl", "solid x\nfacet\nouter loop\nvertex 0 0 0\nendfacet\n", "line 5: wanted vertex or endloop"),
    ("a.stl", "solid x\nfacets\n", 'line 2: "facets" is no keyword of STL'),
    ("a.stl", "hello\n", "line 1: an STL file of text begins with solid"),
    ("a.stl", mesh_dialects.stl_binary(count=11), "binary STL file of 11 faces: 684 bytes instead of 634"),
    ("a.stl", mesh_dialects.stl_binary(count=13), "binary STL file of 13 faces: 684 bytes instead of 734"),
    ("a.ply", PLY.replace("property float y\n", "property float v\n"), "line 3: the vertices have no property y"),
    ("a.ply", PLY.replace("property float y\n", "property float x\n"), "line 3: vertex has two properties x"),
    ("a.ply", PLY.replace("float y", "list uchar float y"), "line 3: vertex's property y is a list"),
    ("a.ply", PLY.replace("vertex_indices", "corners"), "line 7: face has no property vertex_indices"),
    ("a.ply", PLY.replace("uchar int", "uchar float"), "line 7: vertex_indices are no whole numbers"),
    ("a.ply", PLY.replace("uchar int", "float int"), "line 8: the length of a list is not a whole number"),
    ("a.ply", PLY.replace("3 0 1 3", "3 0 1 8"), "line 18: vertex 8 is out of range; the file has 8"),
    ("a.ply", PLY.replace("3 0 1 3", "3 0 1 -1"), "line 18: vertex -1 is out of range"),
    ("a.ply", PLY.replace("3 0 1 3", "3 0 1 3 255"), "line 18: the line holds more than the header declares"),
    ("a.ply", PLY.replace("3 0 1 3", "3 0 1"), "line 19: the line holds more than the header declares"),
    ("a.ply", PLY + "3 0 1 2\n", "line 30: the file goes on behind the last element"),
    ("a.ply", mesh_dialects.ply_binary() + b"\n\1", "byte 422: the file goes on behind the last element"),
    ("a.ply", PLY.replace("format ascii 1.0\n", ""), "the header does not tell the format"),
    ("a.ply", PLY.replace("format", "formal"), 'line 2: "formal" is no keyword of a PLY header'),
    ("a.ply", PLY.replace("element face", "element vertex"), 'line 7: a second element is called "vertex"'),
    ("a.ply", PLY.replace("element face 12", "element face -1"), "line 7: wanted an element count, got -1"),
]


@pytest.mark.parametrize(("name", "contents", "says"), REFUSED)
def test_what_is_not_understood_is_refused(tmp_path, name, contents, says):
    (tmp_path / name).write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    with pytest.raises(sb.MeshError, match=says):
        sb.read_arrays(tmp_path / name)


@pytest.mark.parametrize(("extension", "writer"), FORMATS)
def test_truncated_files_say_so(tmp_path, extension, writer):
    whole = writer(VERTICES, TRIANGLES.tolist())
    path = tmp_path / f"cut.{extension}"
    for share in (0.0, 0.02, 0.3, 0.6, 0.95):
        path.write_bytes(whole[: int(share * len(whole))])
        # OBJ has no end mark: where it is cut between two lines only the mesh itself can be found wanting.
        with pytest.raises(sb.MeshError) as caught:
            sb.read_mesh(path)
        assert extension == "obj" or str(path) in str(caught.value)


def test_names_that_are_no_text(tmp_path):
    says = "is no text in UTF-8; rename the file" if os.name == "nt" else "cannot be opened"
    with pytest.raises(sb.InputError, match=rf"n\\xff\.obj {says}"):
        sb.read_mesh(bytes(tmp_path) + b"/n\xff.obj")


@pytest.mark.parametrize(
    ("name", "contents", "error", "says"),
    [
        ("none.obj", None, sb.InputError, "cannot be opened: No such file"),
        ("mesh.gltf", b"", sb.InputError, 'has the extension "gltf"; wanted obj, ply, off or stl'),
        ("mesh", b"", sb.InputError, 'has the extension ""'),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", sb.MeshError, "has no faces"),
        ("word.obj", b"v 0 0 zero\n", sb.MeshError, 'line 1: wanted a coordinate, got "zero"'),
        ("zero.obj", b"v 0 0 0\nf 0 1 2\n", sb.MeshError, "line 2: vertex number 0, but OBJ counts from 1"),
        ("range.obj", b"v 0 0 0\nf 1 2 3\n", sb.MeshError, "out of range"),
        ("huge.ply", ply_header("ascii", 4_000_000_000, 1) + b"0 0 0 0\n", sb.MeshError, "text ends"),
        ("huge2.ply", ply_header("binary_little_endian", 4_000_000_000, 1), sb.MeshError, "ends in the middle"),
        (
            "type.ply",
            b"ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\nend_header\n",
            sb.MeshError,
            "no PLY type",
        ),
        ("huge.off", b"OFF\n4000000000 4000000000 0\n0 0 0\n", sb.MeshError, "text ends"),
        ("short.stl", b"\0" * 80 + struct.pack("<I", 2**32 - 1), sb.MeshError, "4294967295 faces: 84 bytes"),
    ],
)
def test_bad_files(tmp_path, name, contents, error, says):
    if contents is not None:
        (tmp_path / name).write_bytes(contents)
    with pytest.raises(error, match=says):
        sb.read_mesh(tmp_path / name)


def test_negative_numbers_and_continued_lines_in_obj(tmp_path):
    path = tmp_path / "a.obj"
    path.write_bytes(b"v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -3/1 \\\r\n -2/1 -1/1\r\nv 5 5 5\n")
    vertices, triangles = sb.read_arrays(path)
    assert triangles.tolist() == [[0, 1, 2]]
    assert len(vertices) == 4


def test_bad_arguments(tmp_path):
    with pytest.raises(sb.InputError, match=r"path: wanted a str or os\.PathLike, got a int"):
        sb.read_mesh(3)
    with pytest.raises(sb.InputError, match=r"folder\.obj is a folder; give a file"):
        (tmp_path / "folder.obj").mkdir()
        sb.read_mesh(tmp_path / "folder.obj")


@pytest.mark.parametrize(("extension", "writer"), FORMATS)
def test_damaged_files_never_crash(tmp_path, extension, writer):
    whole = writer(*((a := meshes.icosphere(0))[0], a[1].tolist()))
    rng = random.Random(extension)
    path = tmp_path / f"damaged.{extension}"
    for _ in range(150):
        damaged = bytearray(whole)
        for _ in range(rng.randint(1, 6)):
            at = rng.randrange(len(damaged))
            damaged[at : at + rng.choice([0, 1, 1, 4])] = rng.choice(
                [b"", b"\xff", b"9", b"-", b"\n", rng.randbytes(4)]
            )
        path.write_bytes(damaged)
        try:
            vertices, triangles = sb.read_arrays(path)
            sb.repair(vertices, triangles)
        except (sb.MeshError, sb.InputError) as error:
            assert str(error)
