# SPDX-License-Identifier: MIT
"""What surrounds the answers: jobs, devices, caches, pictures."""

from __future__ import annotations

import io
import threading
import xml.etree.ElementTree

import numpy as np

import saddleback as sb
from tests.truth.registry import guards

Random = np.random.Generator


@guards("Job", "Job.cancel", "progress_bar")
def jobs(mesh: sb.Mesh, rng: Random) -> None:
    """A watched call gives what an unwatched one gives, never goes back and ends at 1; a cancelled one raises."""
    seen: list[float] = []
    done = threading.Event()
    with sb.progress_bar(io.StringIO()) as job:

        def look() -> None:
            while not done.is_set():
                seen.append(job.fraction)

        watcher = threading.Thread(target=look)
        watcher.start()
        distances = sb.exact_distances(mesh, 0, job=job)
        done.set()
        watcher.join()
    assert (distances == sb.exact_distances(mesh, 0)).all()
    assert seen == sorted(seen)
    assert job.fraction == 1
    job.cancel()
    try:
        sb.exact_distances(mesh, 0, job=job)
    except sb.Cancelled:
        return
    raise AssertionError("a cancelled job went on")


@guards("Job.part", "Job.update")
def parts_of_jobs(mesh: sb.Mesh, rng: Random) -> None:
    """Each call of several ends where its part does, within the part that the whole is of another job."""
    whole = sb.Job()
    job = whole.part(0.25, 0.75)
    ends = np.sort(rng.random(3))
    for begin, end in zip([0.0, *ends[:-1]], ends, strict=True):
        sb.exact_distances(mesh, 0, job=job.part(begin, end))
        assert abs(whole.fraction - (0.25 + 0.5 * end)) < 1e-12
    job.update(1)
    assert whole.fraction == 0.75


@guards("devices", "Device", "cuda_status", "limit_device_memory", "release_pinned_memory", on="plane")
def devices(sites: np.ndarray, rng: Random) -> None:
    """The processor is always there, and "auto" answers as it does."""
    assert sb.devices()[0].name
    assert isinstance(sb.cuda_status(), str)
    sb.limit_device_memory(int(rng.integers(0, 1 << 30)))
    sb.release_pinned_memory()
    sb.limit_device_memory(0)
    plain, auto = sb.voronoi_2d(sites, device="cpu"), sb.voronoi_2d(sites, device="auto")
    assert plain.vertices.tobytes() == auto.vertices.tobytes()


@guards("voronoi_2d_on_device", "DeviceVoronoi2d", "DeviceArray", "DeviceArray.numpy", on="plane")
def on_device(sites: np.ndarray, rng: Random) -> None:
    """The same numbers as the processor's, or a DeviceError where there is no card."""
    try:
        found = sb.voronoi_2d_on_device(sites)
    except sb.DeviceError:
        return
    assert found.vertices.numpy().tobytes() == sb.voronoi_2d(sites).vertices.tobytes()


@guards("CellCache", "CellCache.clear", "RelaxationWatch", "RelaxationWatch.latest", "RelaxationStep")
def caches_and_watches(mesh: sb.Mesh, rng: Random) -> None:
    """Neither a cache nor a watch changes a relaxation."""
    graph = sb.SaddleVertexGraph(mesh, threads=1)
    count = mesh.component_count + int(rng.integers(1, 4))
    watch, cache = sb.RelaxationWatch(), sb.CellCache()
    options = {"count": count, "max_iterations": 3, "seed": 1}
    plain = sb.centroidal_voronoi(graph, **options)
    for _ in range(2):
        again = sb.centroidal_voronoi(graph, watch=watch, cache=cache, **options)
        assert again.sites.barycentric.tobytes() == plain.sites.barycentric.tobytes()
    cache.clear()
    step = watch.latest()
    assert step is None or len(step.sites) == count


@guards("quality_plot")
def pictures(mesh: sb.Mesh, rng: Random) -> None:
    """The picture is well-formed XML."""
    picture = sb.quality_plot({"a": sb.triangle_quality(mesh.vertices, mesh.triangles)})
    assert xml.etree.ElementTree.fromstring(picture).tag.endswith("svg")
