# SPDX-License-Identifier: MIT
"""Builds of two commits side by side: `python -m tests.bench versions BEFORE AFTER [--threads N] MESH...`.

BEFORE and AFTER are folders to import `saddleback` from (`build/python` of two checkouts). Each plays the calls of
`tests.bench.progress` in a process of its own, by turns, so that a machine that slows down slows both. A line a call:
the least time of both, and the median of the ratios after/before; with one thread processor time, else by the clock on
the wall. `!` marks more than 1.03. Calls that follow one that a build does not know are left out.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

MOST = 1.03


def play(mesh: str, threads: int) -> None:
    """The process of one build: names its calls, then plays those whose names it reads, and says how long they take."""
    import saddleback as sb
    from tests.bench import progress

    progress.THREADS = threads
    clock = time.thread_time if threads == 1 else time.perf_counter
    with tempfile.TemporaryDirectory() as folder:
        cases = {}
        try:
            for case in progress.calls(sb.read_mesh(mesh), Path(folder)):
                cases[case.name] = case
        except (AttributeError, TypeError) as error:
            print(f"{sb.__file__}: {error}", file=sys.stderr)
        print("\t".join(cases), flush=True)
        for line in sys.stdin:
            case = cases[line.rstrip("\n")]
            given, begin = case.prepare(), clock()
            case.call(None, given)
            print(clock() - begin, flush=True)


class Build:
    """One build and its process."""

    def __init__(self, folder: str, mesh: str, threads: int):
        command = [sys.executable, "-m", "tests.bench", "versions", "--play", mesh, "--threads", str(threads)]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join([folder, "."])}
        self._process = subprocess.Popen(
            command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.names = self._answer().split("\t")

    def seconds(self, name: str) -> float:
        assert self._process.stdin
        self._process.stdin.write(f"{name}\n")
        self._process.stdin.flush()
        return float(self._answer())

    def end(self) -> None:
        self._process.kill()
        self._process.wait()

    def _answer(self) -> str:
        assert self._process.stdout
        line = self._process.stdout.readline().rstrip("\n")
        if not line:
            raise RuntimeError("A build has stopped; what it said is above.")
        return line


def compare(options: argparse.Namespace, mesh: str) -> None:
    builds = [Build(folder, mesh, options.threads) for folder in (options.before, options.after)]
    for name in builds[1].names:
        if options.only not in name or name not in builds[0].names:
            continue
        times: list[list[float]] = [[], []]
        begin = time.perf_counter()
        while len(times[0]) < options.rounds or (
            len(times[0]) < 40 and time.perf_counter() - begin < options.least_seconds
        ):
            for index in (0, 1) if len(times[0]) % 2 else (1, 0):
                times[index].append(builds[index].seconds(name))
        ratio = median(after / before for before, after in zip(*times, strict=True))
        mark = "!" if ratio > MOST else " "
        print(f"{mark} {name:45} {min(times[0]):9.4f} {min(times[1]):9.4f} {ratio:7.3f}", flush=True)
    for build in builds:
        build.end()


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="tests.bench versions", description=__doc__)
    parser.add_argument("--play", help=argparse.SUPPRESS)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--only", default="")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--least-seconds", type=float, default=1.0)
    if "--play" in arguments:
        options = parser.parse_args(arguments)
        play(options.play, options.threads)
        return 0
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("meshes", nargs="+")
    options = parser.parse_args(arguments)
    for mesh in options.meshes:
        print(f"{Path(mesh).stem}, {options.threads} threads: seconds before, after, ratio")
        compare(options, mesh)
    return 0
