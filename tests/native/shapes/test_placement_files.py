# SPDX-License-Identifier: MIT
"""Files of placements: whole or not at all, and broken ones told with the place."""

import json
import os
import stat
import subprocess
import sys

import numpy as np
import pytest

import saddleback as sb
from tests import meshes

posix = pytest.mark.skipif(os.name == "nt", reason="Windows has no such limits and modes")


@pytest.fixture(scope="module")
def mesh():
    return sb.Mesh(*meshes.grid(12, 12))


@pytest.fixture(scope="module")
def field(mesh):
    return sb.direction_field(mesh, symmetry=1)


@pytest.fixture
def laid(mesh):
    center = sb.SurfacePoints([3, 70, 5], [[0.2, 0.3, 0.5]] * 3)
    return sb.Placements([0, 1, 0], center, [0.1, -0.2, 7.5], [1, 2.5, 0.1], [True, False, False])


SHAPES = [sb.Shape.star(), sb.Shape.disk(7)]


def write(path, mesh, laid, field=None):
    sb.write_placements(path, mesh, SHAPES, laid, field)


def test_what_was_written_is_read(tmp_path, mesh, laid, field):
    path = tmp_path / "größe.json"
    write(path, mesh, laid, field)
    shapes, read = sb.read_placements(path, mesh)
    assert [[loop.tolist() for loop in shape.loops] for shape in shapes] == [
        [loop.tolist() for loop in shape.loops] for shape in SHAPES
    ]
    for name in ("shape", "angle", "scale", "mirrored"):
        assert np.array_equal(getattr(read, name), getattr(laid, name))
    assert np.array_equal(read.center.barycentric, laid.center.barycentric)
    assert np.array_equal(sb.read_placement_field(path, mesh).turns, field.turns)


TREE = []
for _ in range(50):
    TREE = [TREE]
BROKEN = [
    ({"face": [3, 1.9, 5]}, r"face\[1\] is 1.9, wanted a whole number from 0 to 241"),
    ({"face": [3, True, 5]}, r"face\[1\] is true, wanted a whole number"),
    ({"face": [3, 242, 5]}, r"face\[1\] is 242, wanted a whole number from 0 to 241"),
    ({"face": [3, -1, 5]}, r"face\[1\] is -1"),
    ({"face": [3, 2**40, 5]}, r"face\[1\] is 1099511627776"),
    ({"face": [3, "a", 5]}, r'face\[1\] is "a"'),
    ({"face": [[1], [2, 3]]}, r"face\[0\] is a list"),
    ({"face": None}, "face is null, wanted a list"),
    ({"face": {}}, "face is a dict, wanted a list"),
    ({"face": [1]}, "barycentric has length 3, wanted 1"),
    ({"shape": [0, 2, 0]}, r"shape\[1\] is 2, wanted a whole number from 0 to 1"),
    ({"shape": [0, 1]}, "shape has length 2, wanted 3"),
    ({"mirrored": ["false", False, False]}, r'mirrored\[0\] is "false", wanted true or false'),
    ({"mirrored": [False, 0, False]}, r"mirrored\[1\] is 0, wanted true or false"),
    ({"angle": "x"}, 'angle is "x", wanted a list'),
    ({"angle": [0, float("nan"), 0]}, r"angle\[1\] is NaN, wanted a number"),
    ({"angle": [0, 10**400, 0]}, r"angle\[1\] is 1000"),
    ({"scale": [1, 0, 1]}, "scale"),
    ({"scale": [1, True, 1]}, r"scale\[1\] is true"),
    ({"barycentric": [[0.2, 0.3, 0.5], [0.2, 0.8], [0.2, 0.3, 0.5]]}, r"barycentric\[1\] has length 2, wanted 3"),
    ({"barycentric": [0.2, 0.3, 0.5]}, r"barycentric\[0\] is 0.2, wanted a list"),
    ({"shapes": 5}, "shapes is 5, wanted a list"),
    ({"shapes": []}, r"shape\[0\] is 0"),
    ({"shapes": [[[[1]]]]}, r"shapes\[0\]\[0\]\[0\]\[0\] is 1, wanted a list"),
    ({"shapes": [[[[[0, 0], [1, 0]]]]]}, r"shapes\[0\]"),
    ({"shapes": TREE}, r"shapes\[0\]"),
    ({"vertices": float("nan")}, "vertices is NaN, wanted a whole number"),
    ({"vertices": 7}, "for a mesh of 7 vertices and 242 faces, this one has 144 and 242"),
    ({"kind": ["saddleback placements"]}, "not a file of placements"),
]


@pytest.mark.parametrize(("change", "says"), [pytest.param(*case, id=str(case[0])[:40]) for case in BROKEN])
def test_broken_values_are_told_with_their_place(tmp_path, mesh, laid, change, says):
    path = tmp_path / "p.json"
    write(path, mesh, laid)
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(sb.InputError, match=f"p.json: {says}"):
        sb.read_placements(path, mesh)


@pytest.mark.parametrize("text", [b"", b"\0", b"\xff\xfe\0", b"[" * 100000, b'{"a":' * 100000, b"[]", b"1" * 5000])
def test_what_is_no_such_file(tmp_path, mesh, text):
    path = tmp_path / "p.json"
    path.write_bytes(text)
    for read in (sb.read_placements, sb.read_placement_field):
        with pytest.raises(sb.InputError, match=r"p\.json: not a file of placements"):
            read(path, mesh)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (5, "field is 5, wanted an object"),
        ({"symmetry": 1}, "angles of the field is missing"),
        ({"symmetry": "x", "angles": "y", "turns": None}, 'symmetry is "x", wanted 1, 2 or 4'),
        ({"symmetry": 1, "angles": "y", "turns": None}, 'angles is "y", wanted a list'),
        ({"symmetry": 1, "angles": [0.0] * 242, "turns": None}, "turns is null, wanted a list"),
        ({"symmetry": 3, "angles": [0.0] * 242, "turns": [[0.0] * 3] * 242}, "symmetry"),
    ],
)
def test_broken_fields(tmp_path, mesh, laid, field, change, says):
    path = tmp_path / "p.json"
    write(path, mesh, laid, field)
    path.write_text(json.dumps(json.loads(path.read_text()) | {"field": change}))
    with pytest.raises(sb.InputError, match=f"p.json: {says}"):
        sb.read_placement_field(path, mesh)


FULL_DISK = """
import resource, sys
import saddleback as sb
from tests import meshes
from tests.native.shapes.test_placement_files import SHAPES
mesh = sb.Mesh(*meshes.grid(12, 12))
laid = sb.Placements([0], sb.SurfacePoints([3], [[0.2, 0.3, 0.5]]), [0.1], [1.0])
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), resource.RLIM_INFINITY))
try:
    sb.write_placements(sys.argv[1], mesh, SHAPES, laid)
except OSError as error:
    sys.exit(str(error))
"""


@posix
@pytest.mark.parametrize("room", [0, 100])
def test_a_full_disk_leaves_the_old_file(tmp_path, room):
    path = tmp_path / "p.json"
    path.write_bytes(b"old")
    done = subprocess.run(
        [sys.executable, "-c", FULL_DISK, path, str(room)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 1
    assert "p.json cannot be written: File too large; make room" in done.stderr
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["p.json"]


@posix
@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_permissions_are_kept(tmp_path, mesh, laid, mode):
    path = tmp_path / "p.json"
    path.touch()
    path.chmod(mode)
    write(path, mesh, laid)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    graph = sb.SaddleVertexGraph(mesh, k=4)
    graph.save(path)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert sb.SaddleVertexGraph.load(path, mesh).k == 4


def test_what_could_not_be_read_is_not_written(tmp_path, mesh, laid):
    path = tmp_path / "placements.json"
    with pytest.raises(sb.InputError, match=r"placements: that at \[1\] has shape 1, but there are 1"):
        sb.write_placements(path, mesh, SHAPES[0], laid)
    with pytest.raises(sb.InputError, match=r"placements: that at \[1\] has face 70, but there are 8"):
        write(path, sb.Mesh(*meshes.grid(3, 3)), laid)
    assert not path.exists()


@posix
def test_a_new_file_is_as_open_as_others(tmp_path, mesh, laid):
    old = os.umask(0o027)
    try:
        write(tmp_path / "p.json", mesh, laid)
    finally:
        os.umask(old)
    assert stat.S_IMODE((tmp_path / "p.json").stat().st_mode) == 0o640


def test_places_that_cannot_be_written(tmp_path, mesh, laid):
    with pytest.raises(OSError, match="No such file or directory; make its folder"):
        write(tmp_path / "none" / "p.json", mesh, laid)
    with pytest.raises(OSError, match="is a folder"):
        write(tmp_path, mesh, laid)
    with pytest.raises(TypeError):
        write(3, mesh, laid)
