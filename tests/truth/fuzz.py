# SPDX-License-Identifier: MIT
"""Sends random input past the library and its truths, and makes what fails small.

    python -m tests.truth.fuzz [--seconds 60] [--seed N] [--only PATTERN] [--workers 2]
    python -m tests.truth.fuzz --replay CHECK SEED        one case again, made small and printed

Every case runs in a process of its own pool, so that a crash or a hang is a finding like any other.
"""

from __future__ import annotations

import argparse
import fnmatch
import math
import multiprocessing
import os
import sys
import threading
import time
import traceback
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]

if __name__ == "__main__":  # as a file, too: the project's root holds the package `tests`
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import saddleback as sb
from tests import meshes
from tests.truth import families
from tests.truth.registry import Check, load_checks

MOST_MEMORY = 4 << 30
LONGEST = 60.0
"""Seconds after which a case counts as hanging; the slowest sanitizer build needs 10."""

Arrays = tuple[Any, ...]


@dataclass(frozen=True)
class Case:
    """A check, the seed of what it draws, and its input: (vertices, triangles), (sites,) or nothing."""

    check: str
    seed: int
    family: str
    arrays: Arrays


@dataclass
class Outcome:
    """`word` is one of fine, refused, finding; `text` tells what was found."""

    word: str
    text: str = ""


def random_case(check: Check, seed: int) -> Case:
    """The case that belongs to a seed."""
    if check.on == "mesh":
        return Case(check.name, seed, *families.random_mesh(seed))
    rng = np.random.default_rng([seed, 1])
    return Case(check.name, seed, check.on, (families.random_sites(rng),) if check.on == "plane" else ())


def attempt(check: Check, case: Case) -> Outcome:
    """Run a check on its case, in this process."""
    rng = np.random.default_rng([case.seed, 2])
    try:
        if check.on == "mesh":
            try:
                mesh = sb.Mesh(*case.arrays)
            except sb.MeshError:
                mesh, _ = sb.repair(*case.arrays)
            check.function(mesh, rng)
        else:
            check.function(*case.arrays, rng)
    except sb.Error as error:
        return Outcome("refused", str(error))
    except Exception:
        return Outcome("finding", traceback.format_exc())
    return Outcome("fine")


def limit_memory() -> None:
    """Make a case that asks for more than a small machine has a finding, and no harm to others.

    Not under AddressSanitizer, which reserves terabytes.
    """
    if resource is not None and "libasan" not in os.environ.get("LD_PRELOAD", ""):
        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def serve(pipe: Connection) -> None:
    """A worker's life: takes cases, sends outcomes."""
    limit_memory()
    checks = load_checks()
    while True:
        case = pipe.recv()
        if case is None:
            return
        pipe.send(attempt(checks[case.check], case))


class Worker:
    """A process that runs cases; when it dies or hangs, that is the outcome, and a fresh one takes over."""

    def __init__(self) -> None:
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()

    def run(self, case: Case) -> Outcome:
        try:
            self._pipe.send(case)
            if self._pipe.poll(LONGEST):
                outcome: Outcome = self._pipe.recv()
                return outcome
            text = f"no answer after {LONGEST:g} s"
        except (EOFError, BrokenPipeError, ConnectionResetError):
            self._process.join()
            text = f"the process died with exit code {self._process.exitcode}"
        self._process.kill()
        self._process.join()
        self._start()
        return Outcome("finding", text)

    def close(self) -> None:
        self._pipe.send(None)
        self._process.join()


def fewest_rows(count: int, fails: Callable[[NDArray[np.int64]], bool], tries: int = 400) -> NDArray[np.int64]:
    """Fewer and fewer of `count` rows, as long as the rest still fails: delta debugging.

    After [zeller2002].
    """
    rows, block = np.arange(count), max(count // 2, 1)
    while tries > 0:
        start, shrunk = 0, False
        while start < len(rows) and tries > 0:
            rest = np.delete(rows, slice(start, start + block))
            tries -= 1
            if len(rest) and fails(rest):
                rows, shrunk = rest, True
            else:
                start += block
        if block == 1 and not shrunk:
            break
        block = block if shrunk and block < len(rows) else max(block // 2, 1)
    return rows


def with_rows(case: Case, rows: Any) -> Case:
    """The case with some of its triangles or sites only."""
    if len(case.arrays) == 2:
        vertices, triangles = case.arrays
        return Case(case.check, case.seed, case.family, meshes.without_unused(vertices, triangles[rows]))
    return Case(case.check, case.seed, case.family, (case.arrays[0][rows],))


def made_small(worker: Worker, case: Case) -> Case:
    """The smallest input found that still is a finding. A hang is left as it is: each try would take its time."""
    if not case.arrays:
        return case
    rows = fewest_rows(len(case.arrays[-1]), lambda rows: worker.run(with_rows(case, rows)).word == "finding")
    return with_rows(case, rows)


def told(case: Case, small: Case, outcome: Outcome) -> str:
    """What a person needs to go on: the case, its command, the small input as Python."""
    lines = [f"FINDING {case.check}, seed {case.seed}, {case.family}"]
    lines += [f"  python -m tests.truth.fuzz --replay {case.check} {case.seed}"]
    names = {2: ("vertices", "triangles"), 1: ("sites",), 0: ()}[len(small.arrays)]
    lines += [f"  {name} = np.array({array.tolist()})" for name, array in zip(names, small.arrays, strict=True)]
    return "\n".join([*lines, *("  " + line for line in outcome.text.strip().splitlines()[-12:])])


@dataclass
class Run:
    """What several workers have done so far."""

    checks: list[Check]
    seed: int
    until: float
    most_cases: float = math.inf
    next_case: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)
    by_check: dict[str, Counter[str]] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)
    lock: threading.Lock = field(default_factory=threading.Lock)

    def work(self) -> None:
        worker = Worker()
        while time.monotonic() < self.until:
            with self.lock:
                number = self.next_case
                self.next_case += 1
            if number >= self.most_cases:
                break
            check = self.checks[number % len(self.checks)]
            case = random_case(check, self.seed + number)
            outcome = worker.run(case)
            text = self._told(worker, case, outcome) if outcome.word == "finding" else ""
            with self.lock:
                self.outcomes[outcome.word] += 1
                self.by_check.setdefault(check.name, Counter())[outcome.word] += 1
                if text:
                    self.findings.append(text)
                    print(text, flush=True)
        worker.close()

    def _told(self, worker: Worker, case: Case, outcome: Outcome) -> str:
        """Only a check's first findings are made small."""
        found = self.by_check.get(case.check, Counter())["finding"]
        hangs = outcome.text.startswith("no answer")
        return told(case, case if found >= 3 or hangs else made_small(worker, case), outcome)


def run(checks: list[Check], seconds: float, seed: int, workers: int, most_cases: float = math.inf) -> Run:
    """Random cases of these checks for so long, or so many."""
    state = Run(checks, seed, time.monotonic() + seconds, most_cases)
    threads = [threading.Thread(target=state.work) for _ in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return state


def replay(check: Check, seed: int) -> int:
    """One case again."""
    worker, case = Worker(), random_case(check, seed)
    outcome = worker.run(case)
    is_found = outcome.word == "finding"
    print(told(case, made_small(worker, case), outcome) if is_found else f"{outcome.word} {outcome.text}")
    worker.close()
    return is_found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=int(time.time()) % 10**9 * 1000, help="less than a trillion")
    parser.add_argument("--only", default="*", help="checks by pattern, as distances.*")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--replay", nargs=2, metavar=("CHECK", "SEED"))
    arguments = parser.parse_args()
    checks = load_checks()
    if arguments.replay:
        return replay(checks[arguments.replay[0]], int(arguments.replay[1]))
    chosen = [check for check in checks.values() if fnmatch.fnmatch(check.name, arguments.only)]
    if not chosen:
        parser.error(f"no check is named {arguments.only}")
    seed = families.NEWEST + arguments.seed % 10**12
    print(f"{len(chosen)} checks, seed {seed}", flush=True)
    done = run(chosen, arguments.seconds, seed, arguments.workers)
    for name, words in sorted(done.by_check.items()):
        print(f"  {name}: " + ", ".join(f"{count} {word}" for word, count in sorted(words.items())))
    print(f"{sum(done.outcomes.values())} cases, {len(done.findings)} findings")
    return bool(done.findings)


if __name__ == "__main__":
    sys.exit(main())
