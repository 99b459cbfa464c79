# SPDX-License-Identifier: GPL-3.0-or-later
"""Graphs on disk: used in the next session, built again when they are no good, the oldest gone first."""

import os
import time

import meshes_of_core as shapes
import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core import runs
from saddleback_blender.core.cache import Cache
from saddleback_blender.core.disk_cache import DiskCache
from saddleback_blender.core.requests import DistanceRequest
from saddleback_blender.core.settings import DistanceSettings


@pytest.fixture
def disk(tmp_path):
    return DiskCache(tmp_path / "not" / "there yet", 2**30)


def run(disk, surface=None, cache=None, **settings):
    """One run of a new session: what it answered, what it told, what it did."""
    surface = surface if surface is not None else shapes.grid(12)
    request = DistanceRequest(surface, DistanceSettings(**{"k": 20, **settings}), np.array([0], np.int32), disk=disk)
    progress = runs.new_progress()
    texts, stage = [], progress.stage

    def noted_stage(end, text, **more):
        texts.append(text)
        return stage(end, text, **more)

    progress.stage = noted_stage
    result = runs.distance(request, progress, cache or Cache(2**30))
    return result.vertex_distance, progress.notes, texts


def test_the_next_session_builds_nothing(disk):
    first, notes, texts = run(disk)
    assert notes == [] and "building the distance graph" in texts and "keeping the distance graph on disk" in texts
    second, notes, texts = run(disk)
    assert notes == [] and "loading the distance graph" in texts
    assert "building the distance graph" not in texts and "keeping the distance graph on disk" not in texts
    np.testing.assert_array_equal(first, second)
    assert len(list(disk.folder.iterdir())) == 1


def test_files_are_of_a_shape_and_a_graph(disk):
    run(disk)
    run(disk, limit=0.5)
    assert len(list(disk.folder.iterdir())) == 1
    run(disk, k=21)
    run(disk, surface=shapes.grid(13))
    assert len(list(disk.folder.iterdir())) == 3


def test_nothing_is_written_unless_asked(disk):
    run(None)
    assert not disk.folder.exists()


def test_a_graph_in_memory_goes_to_disk_when_that_is_asked_later(disk):
    cache = Cache(2**30)
    run(None, cache=cache)
    _, _, texts = run(disk, cache=cache)
    assert "building the distance graph" not in texts and len(list(disk.folder.iterdir())) == 1


@pytest.mark.parametrize("damage", [lambda old: b"", lambda old: old[:-1], lambda old: old[:200] + b"?" + old[201:]])
def test_a_damaged_file_is_built_again_with_a_note(disk, damage):
    right, _, _ = run(disk)
    (path,) = disk.folder.iterdir()
    path.write_bytes(damage(path.read_bytes()))
    values, notes, _ = run(disk)
    np.testing.assert_array_equal(values, right)
    assert len(notes) == 1 and notes[0].startswith("The distance graph kept on disk could not be used")
    assert run(disk)[1] == []  # it is good again


def test_a_file_of_a_newer_version_stays(disk):
    right, _, _ = run(disk)
    (path,) = disk.folder.iterdir()
    contents = bytearray(path.read_bytes())
    contents[8] += 1  # the version
    path.write_bytes(contents)
    for _ in range(2):
        values, notes, texts = run(disk)
        np.testing.assert_array_equal(values, right)
        assert len(notes) == 1 and "is left to the newer version that wrote it" in notes[0]
        assert "building the distance graph" in texts
        assert path.read_bytes() == contents and os.listdir(disk.folder) == [path.name]


def check_that_it_is_only_a_note(folder, *sentences):
    disk = DiskCache(folder, 2**30)
    values, notes, _ = run(disk)
    assert np.isfinite(values).all()
    assert len(notes) == 1 and notes[0].startswith("The distance graph could not be kept on disk (")
    for sentence in sentences:
        assert sentence in notes[0]
    assert disk.clear() == 0


def test_a_file_in_the_folders_place(tmp_path):
    (tmp_path / "file").write_text("in the way")
    check_that_it_is_only_a_note(
        tmp_path / "file" / "graphs", "cannot be made", "choose another cache folder in the pref"
    )


@pytest.mark.parametrize("folder", ["x" * 256, "/".join(["y" * 200] * 30)])
def test_a_folder_whose_name_is_too_long(tmp_path, folder):
    check_that_it_is_only_a_note(tmp_path / folder, "ame too long")
    assert os.listdir(tmp_path) == []


@pytest.mark.skipif(os.name == "nt", reason="Windows has other permissions for folders")
@pytest.mark.parametrize("mode", [0o500, 0o000])
def test_a_folder_that_must_not_be_written(as_anyone, mode):
    as_anyone.chmod(mode)
    check_that_it_is_only_a_note(as_anyone, "Permission denied; allow it or choose another place")
    check_that_it_is_only_a_note(as_anyone / "graphs", "cannot be made: Permission denied")
    as_anyone.chmod(0o700)


def test_a_full_drive(disk):
    """The limit on a file's size stands for the drive's end."""
    resource = pytest.importorskip("resource", reason="POSIX alone limits the size of files")
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5000, old[1]))
    try:
        check_that_it_is_only_a_note(disk.folder, "File too large; make room or choose another place")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert os.listdir(disk.folder) == []


def test_the_oldest_go_first(disk):
    for n in (10, 11, 12):
        run(disk, surface=shapes.grid(n))
    sizes = {path.name: path.stat().st_size for path in disk.folder.iterdir()}
    oldest, middle, newest = sorted(disk.folder.iterdir(), key=lambda path: path.stat().st_size)
    now = time.time()
    for path, age in ((oldest, 50), (middle, 300), (newest, 200)):
        os.utime(path, (now - age, now - age))
    run(disk, surface=shapes.grid(11))  # used again: the youngest now
    assert DiskCache(disk.folder, sizes[middle.name] + sizes[oldest.name]).trim() == 1
    assert sorted(disk.folder.iterdir()) == sorted([middle, oldest])
    # A new one goes in, however little room there is for the others.
    small = DiskCache(disk.folder, int(1.3 * sizes[newest.name]))
    run(small, surface=shapes.grid(12))
    assert [path.name for path in disk.folder.iterdir()] == [newest.name]
    assert small.clear() == 1 and not list(disk.folder.iterdir())


def test_other_files_stay_but_what_a_crash_left_goes(disk):
    run(disk)
    partial, young, other = (disk.folder / name for name in (".saddleback-1.partial", ".saddleback-2.partial", "note"))
    for path in (partial, young, other):
        path.write_text("")
    os.utime(partial, (0, 0))
    os.utime(other, (0, 0))
    disk.clear()
    assert sorted(disk.folder.iterdir()) == sorted([young, other])


def test_one_that_does_not_fit_is_not_kept(disk):
    values, notes, _ = run(DiskCache(disk.folder, 1000))
    assert np.isfinite(values).all() and not disk.folder.exists()
    assert len(notes) == 1 and "was not kept on disk, where 0 MB are allowed" in notes[0]


def test_cancelling_while_it_is_kept(disk):
    surface = shapes.grid(12)
    mesh = sb.Mesh(surface.vertices, surface.triangles)
    job = sb.Job()
    job.cancel()
    with pytest.raises(sb.Cancelled):
        disk.save("graph", sb.SaddleVertexGraph(mesh, k=20), job, print)
    assert not list(disk.folder.iterdir())
