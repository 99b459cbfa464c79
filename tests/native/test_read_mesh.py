"""read_mesh and read_arrays: every format, and files that lie."""

import random
import struct

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

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
    with pytest.raises(sb.InputError, match=r"n\\xff\.obj cannot be opened"):
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
        ("four.off", b"4OFF\n1 1 0\n", sb.MeshError, "three dimensions"),
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
    with pytest.raises(sb.InputError, match="cannot be read"):
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
