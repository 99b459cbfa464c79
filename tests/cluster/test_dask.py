# SPDX-License-Identifier: MIT
"""Dask: answers of a cluster are those of one machine to the bit, also where workers die in the middle."""

from __future__ import annotations

import contextlib
import itertools
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import FrameType

import dask
import numpy as np
import pytest
from distributed import Client, LocalCluster

import saddleback as sb
import saddleback.dask as over_dask
from tests import meshes

MOST_SECONDS = 60  # of a test, on a machine that does much else; all take some 20 s together


@pytest.fixture(autouse=True)
def never_hangs() -> Iterator[None]:
    def end(number: int, frame: FrameType | None) -> None:
        raise TimeoutError(f"the test took over {MOST_SECONDS} s")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(MOST_SECONDS)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = str(tmp_path_factory.mktemp("dask"))
    given = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None, "memory_limit": 0}
    # LocalCluster gives up a worker that is away this long after it died once, also when it only died again just then.
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": "1 hour"}),
        LocalCluster(local_directory=folder, **given) as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.fixture
def client(cluster: Client) -> Client:
    """Both workers, also behind a test that killed some: their nannies begin others."""
    cluster.wait_for_workers(2, timeout=MOST_SECONDS)
    return cluster


@pytest.fixture(scope="module")
def mesh() -> sb.Mesh:
    return sb.Mesh(*meshes.torus(90, 50))


def file_of(graph: sb.SaddleVertexGraph, folder: Path) -> bytes:
    graph.save(folder / "graph")
    return (folder / "graph").read_bytes()


def die_in_second_task(lives: str) -> None:
    """Make this process kill itself, without a word to anyone; it takes a file of the folder along, or lives on."""
    check, begun = over_dask._check_version, itertools.count(1)

    def check_or_die(there: str, who: str) -> None:
        if next(begun) == 2:
            for name in os.listdir(lives):
                with contextlib.suppress(FileNotFoundError):
                    os.unlink(os.path.join(lives, name))
                    os.kill(os.getpid(), signal.SIGKILL)
        check(there, who)

    over_dask._check_version = check_or_die


@contextlib.contextmanager
def killed(client: Client, count: int, folder: Path) -> Iterator[None]:
    """So many workers are killed within the block, with a task done and another begun."""
    (folder / "lives").mkdir()
    for number in range(count):
        (folder / "lives" / str(number)).touch()
    client.run(die_in_second_task, str(folder / "lives"))
    yield
    assert not os.listdir(folder / "lives")


@pytest.mark.parametrize("rule", [{"k": 20}, {}], ids=str)
def test_a_graph_of_eight_parts(client: Client, mesh: sb.Mesh, rule: dict[str, int], tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    graph = over_dask.build(client, mesh, parts=8, progress=lambda *done: seen.append(done), **rule)
    assert file_of(graph, tmp_path) == file_of(sb.SaddleVertexGraph(mesh, **rule), tmp_path)
    assert seen == sorted(seen)
    assert seen[-1] == (8, 8)


@pytest.mark.parametrize("victims", [1, 2])
def test_workers_killed_in_the_middle_of_a_graph(client: Client, mesh: sb.Mesh, victims: int, tmp_path: Path) -> None:
    """Parts that they had found are gone with them, and where all die the mesh that was sent."""
    with killed(client, victims, tmp_path):
        graph = over_dask.build(client, mesh, accuracy=1e-3, parts=8)
    assert file_of(graph, tmp_path) == file_of(sb.SaddleVertexGraph(mesh, accuracy=1e-3), tmp_path)


def test_fields(client: Client, mesh: sb.Mesh) -> None:
    graph = sb.SaddleVertexGraph(mesh)
    points = sb.sample(mesh, 9, seed=2)
    curves = [sb.SurfaceCurve(mesh, sb.trace(mesh, vertex, 0.3, 0.5).surface) for vertex in (0, 70)]
    for sources in (np.arange(0, 4000, 500), [3, 5], points, curves):
        lazy = over_dask.fields(client, graph, sources, chunk=4, limit=0.9)
        assert (lazy.shape, lazy.dtype) == ((len(sources), mesh.vertex_count), np.float64)
        assert np.array_equal(lazy.compute(), graph.fields(sources, limit=0.9))
    assert lazy.min().compute() == 0


def test_a_worker_killed_in_the_middle_of_fields(client: Client, mesh: sb.Mesh, tmp_path: Path) -> None:
    graph = sb.SaddleVertexGraph(mesh)
    lazy = over_dask.fields(client, graph, np.arange(256), chunk=8)
    with killed(client, 1, tmp_path):
        found = lazy.compute()
    assert np.array_equal(found, graph.fields(np.arange(256)))


def cells_of(mesh: sb.Mesh, path: str) -> bytes:
    graph = sb.SaddleVertexGraph(mesh, threads=over_dask.threads())
    cells = sb.geodesic_voronoi(graph, [0, 30, 60], threads=over_dask.threads())
    return Path(path).stem.encode() + cells.areas.tobytes()


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A ring that breathes."""
    folder = tmp_path_factory.mktemp("frames")
    for i in range(240):
        ring = sb.Mesh(*meshes.torus(14, 8, tube_radius=0.3 + 0.1 * np.sin(2 * np.pi * i / 240)))
        sb.write_mesh(folder / f"ring.{i:04}.ply", ring)
    return sorted(folder.iterdir())


def test_an_animation_while_a_worker_is_killed(client: Client, frames: list[Path], tmp_path: Path) -> None:
    seen: list[tuple[int, int]] = []
    with killed(client, 1, tmp_path):
        found = over_dask.map_meshes(client, cells_of, frames, progress=lambda *done: seen.append(done))
    assert seen[-1] == (240, 240)
    assert found == [cells_of(sb.read_mesh(path), str(path)) for path in frames]
    assert len(set(found)) == 240


def fail_once(mesh: sb.Mesh, path: str) -> str:
    try:
        Path(path).with_suffix(".tried").touch(exist_ok=False)
    except FileExistsError:
        return path
    raise OSError("the network is away")


def test_what_raises_is_tried_again(client: Client, frames: list[Path], tmp_path: Path) -> None:
    path = tmp_path / "ring.ply"
    path.write_bytes(frames[0].read_bytes())
    with pytest.raises(OSError, match="the network is away"):
        over_dask.map_meshes(client, fail_once, [path], retries=0)
    path.with_suffix(".tried").unlink()
    assert over_dask.map_meshes(client, fail_once, [path], retries=1) == [str(path)]


def test_what_is_refused_is_said_with_its_path(client: Client, frames: list[Path], tmp_path: Path) -> None:
    (tmp_path / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(sb.Error, match=r"broken\.obj"):
        over_dask.map_meshes(client, cells_of, [*frames[:2], tmp_path / "broken.obj"], retries=0)

    def refuse(mesh: sb.Mesh, path: str) -> float:
        return sb.SaddleVertexGraph(mesh, threads=1).distance(0, 10**6)

    with pytest.raises(sb.InputError, match=r"ring.0000.ply: .*1000000"):
        over_dask.map_meshes(client, refuse, frames[:1], retries=0)
    with pytest.raises(sb.InputError, match="k: 100000 vertices"):
        over_dask.build(client, sb.read_mesh(frames[0]), k=100000, retries=0)


def test_bad_input(client: Client, mesh: sb.Mesh) -> None:
    graph = sb.SaddleVertexGraph(mesh, k=5)
    for call, says in (
        (lambda: over_dask.build(client, mesh, parts=0), "parts: wanted at least 1, got 0"),
        (lambda: over_dask.fields(client, graph, [0], chunk=0), "chunk: wanted at least 1"),
        (lambda: over_dask.fields(client, graph, []), "sources: wanted at least 1, got none"),
        (lambda: over_dask.fields(client, graph, [[1, 2]]), r"sources: wanted a row of vertices, .* \(1, 2\)"),
        (lambda: over_dask.fields(client, graph, 7), r"sources: wanted a row of vertices, .* \(\)"),
        (lambda: over_dask.fields(client, graph, [10**6]).compute(), "1000000"),
    ):
        with pytest.raises(sb.InputError, match=says):
            call()
    assert over_dask.map_meshes(client, cells_of, []) == []


def slowly(mesh: sb.Mesh, path: str) -> str:
    time.sleep(0.2)
    return path


def test_cancelling(client: Client, frames: list[Path]) -> None:
    job = sb.Job()
    threading.Timer(0.5, job.cancel).start()
    begun = time.perf_counter()
    with pytest.raises(sb.Cancelled):
        over_dask.map_meshes(client, slowly, frames, job=job)
    while any(client.processing().values()):
        time.sleep(0.05)
    assert time.perf_counter() - begun < 12  # all frames take 24 s


def ask_threads(mesh: sb.Mesh, path: str) -> int:
    return over_dask.threads()


def configure(count: object) -> None:
    dask.config.set({"saddleback.threads": count})


def test_the_worker_says_how_many_threads(client: Client, frames: list[Path]) -> None:
    assert over_dask.map_meshes(client, ask_threads, frames[:1]) == [1]
    try:
        client.run(configure, 3)
        assert over_dask.map_meshes(client, ask_threads, frames[:1]) == [3]
        client.run(configure, "many")
        with pytest.raises(sb.InputError, match=r"saddleback.threads in Dask's configuration: .* got 'many'"):
            over_dask.map_meshes(client, ask_threads, frames[:1], retries=0)
    finally:
        client.run(configure, 1)


CALLS: list[Callable[[Client, sb.Mesh], object]] = [
    lambda client, mesh: over_dask.build(client, mesh),
    lambda client, mesh: over_dask.fields(client, sb.SaddleVertexGraph(mesh, k=5), [0]),
    lambda client, mesh: over_dask.map_meshes(client, cells_of, []),
]
MODULES = "__import__('sys').modules"


@pytest.mark.parametrize("call", CALLS)
def test_workers_of_another_version_or_without_the_library(
    client: Client, mesh: sb.Mesh, call: Callable[[Client, sb.Mesh], object]
) -> None:
    worker = min(client.run(os.getpid))
    client.run(eval, f"setattr({MODULES}['saddleback'], '__version__', '0.0.7')", workers=[worker])
    with pytest.raises(sb.VersionError, match=rf"worker {worker} has saddleback 0.0.7, which may answer otherwise"):
        call(client, mesh)
    client.run(eval, f"setattr({MODULES}['saddleback'], '__version__', '{sb.__version__}')", workers=[worker])
    client.run(eval, f"{MODULES}.update(kept={MODULES}['saddleback'], saddleback=None)", workers=[worker])
    with pytest.raises(sb.InputError, match=rf"worker {worker} has no saddleback \("):
        call(client, mesh)
    client.run(eval, f"{MODULES}.update(saddleback={MODULES}.pop('kept'))", workers=[worker])


def test_workers_of_another_version_that_came_later(mesh: sb.Mesh) -> None:
    for task in (
        lambda: over_dask._find(0, mesh, 2, None, None, "0.0.7"),
        lambda: over_dask._fields(sb.SaddleVertexGraph(mesh, k=5), [0], 1.0, "0.0.7"),
        lambda: over_dask._apply("none.ply", cells_of, "0.0.7"),
    ):
        with pytest.raises(sb.VersionError, match=r"the client of this task has saddleback 0.0.7"):
            task()


def test_without_dask_it_says_what_to_install() -> None:
    code = "import sys; sys.modules['distributed'] = None; import saddleback.dask"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=MOST_SECONDS)
    assert "saddleback.dask needs dask and distributed" in done.stderr
    assert "pip install saddleback[dask]" in done.stderr
