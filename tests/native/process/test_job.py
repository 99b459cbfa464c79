# SPDX-License-Identifier: MIT
"""Jobs: progress, cancelling from another thread, the progress bar."""

import io
import os
import signal
import threading
import time

import numpy as np
import pytest

import saddleback as sb
from tests import meshes


def test_a_job_tells_how_far_it_is():
    job = sb.Job()
    assert (job.fraction, job.text, job.cancelled) == (0.0, "", False)
    sb.Mesh(*meshes.torus(), job=job)
    assert (job.fraction, job.text) == (1.0, "Checking the mesh")
    sb.repair(*meshes.torus(), job=job)
    assert (job.fraction, job.text) == (1.0, "Repairing the mesh")
    assert repr(job) == "<saddleback.Job 100 %>"


def test_a_cancelled_job_stays_cancelled():
    job = sb.Job()
    job.cancel()
    assert job.cancelled
    for _ in range(2):
        with pytest.raises(sb.Cancelled):
            sb.Mesh(*meshes.torus(), job=job)


def test_cancelling_from_another_thread():
    vertices, triangles = meshes.grid(700, 700, jitter=0.3)
    job, outcome = sb.Job(), []

    def work():
        try:
            for _ in range(1000):
                sb.repair(vertices, triangles, job=job)
        except sb.Cancelled:
            outcome.append(time.monotonic())

    thread = threading.Thread(target=work)
    thread.start()
    while not job.text:
        time.sleep(0.001)
    job.cancel()
    thread.join(timeout=60)
    assert outcome


def test_other_things_are_no_jobs():
    with pytest.raises(sb.InputError, match=r"job: wanted a saddleback.Job or None, got a int"):
        sb.Mesh(*meshes.cube(), job=3)


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_progress_bar_draws_on_a_terminal_only():
    for stream, draws in ((Terminal(), True), (io.StringIO(), False)):
        with sb.progress_bar(stream) as job:
            sb.Mesh(*meshes.torus(), job=job)
            time.sleep(0.3 if draws else 0)
        assert ("Checking the mesh" in stream.getvalue()) == draws


def test_progress_bar_turns_an_interrupt_into_a_cancelled_job():
    before = signal.getsignal(signal.SIGINT)
    vertices, triangles = meshes.grid(300, 300, jitter=0.3)
    press = signal.raise_signal if os.name == "nt" else lambda number: os.kill(os.getpid(), number)
    timer = threading.Timer(0.2, press, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt), sb.progress_bar(io.StringIO()) as job:
        while True:
            sb.Mesh(vertices, triangles, job=job)
    assert job.cancelled
    assert signal.getsignal(signal.SIGINT) is before


def test_results_do_not_depend_on_threads():
    vertices, triangles = meshes.grid(100, 100, jitter=0.3)
    with_all = sb.Mesh(vertices, triangles)
    arrays = [with_all.total_angles, with_all.corner_angles, with_all.face_areas]
    for _ in range(3):
        again = sb.Mesh(vertices, triangles)
        assert again.area == with_all.area
        for a, b in zip(arrays, [again.total_angles, again.corner_angles, again.face_areas], strict=True):
            assert np.array_equal(a, b)


def test_parts_of_a_job_make_one_rising_fraction():
    job = sb.Job()
    first, second = job.part(0, 0.25), job.part(0.5, 1)
    mesh = sb.Mesh(*meshes.icosphere(2))
    sb.exact_distances(mesh, [0], job=first)
    assert job.fraction == first.fraction == second.fraction == 0.25
    second.update(0.5)
    assert job.fraction == 0.75
    second.update(0.1)  # never back
    assert job.fraction == 0.75
    sb.exact_distances(mesh, [0], job=second.part(0.5, 1))
    assert job.fraction == 1 and job.text
    sb.exact_distances(mesh, [0], job=job)
    assert job.fraction == 1
    second.cancel()
    assert job.cancelled and first.cancelled
    with pytest.raises(sb.Cancelled):
        first.update(0.5)
    for begin, end in ((-0.1, 1), (0.6, 0.5), (0, 1.1), (float("nan"), 1)):
        with pytest.raises(sb.InputError, match="begin, end: wanted 0 <= begin <= end <= 1"):
            job.part(begin, end)


def test_every_fraction_ends_at_one() -> None:
    """Also of calls with hardly anything to do, and of those that may be cut short but were not."""
    mesh = sb.Mesh(*meshes.icosphere(2))
    graph = sb.SaddleVertexGraph(mesh)
    calls = {
        "sample": lambda job: sb.sample(mesh, 1, job=job),
        "spread_values": lambda job: sb.spread_values(sb.Mesh(*meshes.two_components()), [0, 1], [1.0, 2.0], job=job),
        "project": lambda job: sb.project(mesh, np.zeros((0, 3)), job=job),
        "cut": lambda job: sb.map_shapes(
            mesh, sb.Shape.disk(), sb.Placements([0], sb.sample(mesh, 1), [0.0], [0.1])
        ).cut(job=job),
        "direction_field": lambda job: sb.direction_field(sb.Mesh(*meshes.grid(5, 5)), 1, {}, job=job),
        "centroidal_voronoi": lambda job: sb.centroidal_voronoi(
            graph, count=9, max_iterations=5, closed_ball=True, return_when_cancelled=True, job=job
        ),
    }
    for name, call in calls.items():
        job = sb.Job()
        call(job)
        assert job.fraction == 1, name
