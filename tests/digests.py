# SPDX-License-Identifier: MIT
"""Digests of all answers of the library, so that a change that should change nothing can be seen to change nothing.

``python -m tests.digests`` compares with `tests/digests.json`, which is written anew only when a change is meant to
alter results. ``--write FILE`` writes such a file (.json), or all the numbers (.npz); ``--compare FILE`` compares with
either, and of numbers tells the largest relative difference. Entries marked `"portable"` are promised to be equal to
the bit on every platform; the others use libm, whose last bits differ from one to the next.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests.digest_questions import QUESTIONS, Question, Way

REFERENCE = Path(__file__).with_name("digests.json")
Arrays = list[NDArray[Any]]
Entry = dict[str, Any]


def as_arrays(answer: Iterable[object]) -> Arrays:
    """Numbers as all platforms keep them: 64 bits, and one kind of NaN."""
    arrays = []
    for part in answer:
        array = np.asarray(part)
        if array.dtype.kind == "f":
            array = np.where(np.isnan(array), np.nan, array.astype("<f8"))
        arrays.append(array.astype("<u8" if array.dtype.kind == "u" else "<i8") if array.dtype.kind in "iub" else array)
    return arrays


def told(question: Question, way: Way) -> Arrays:
    """The answer, or the kind of the error that was raised."""
    try:
        return as_arrays(question.ask(way))
    except sb.Error as refusal:
        return [np.frombuffer(type(refusal).__name__.encode(), "<u1").astype("<i8")]


def digest(arrays: Arrays) -> str:
    sha = hashlib.sha256()
    for array in arrays:
        sha.update(f"{array.dtype.str}{array.shape}".encode())
        sha.update(array.tobytes())
    return sha.hexdigest()[:16]


def record(arrays: Arrays) -> list[float]:
    """How many numbers there are, the mean size of the finite ones and the largest: to judge a difference by."""
    numbers = np.concatenate([np.zeros(0), *(array.ravel().astype(float) for array in arrays)])
    finite = np.abs(numbers[np.isfinite(numbers)])
    scale = finite.max(initial=0)
    mean = float((finite / scale).mean() * scale) if scale > 0 else 0.0
    return [len(numbers), *(float(f"{value:.9g}") for value in (mean, scale))]


def name_of(question: Question) -> str:
    return f"{question.subject}/{question.name}"


def answers(questions: Iterable[Question], threads: list[int], device: str) -> Iterator[tuple[Question, int, Arrays]]:
    for question in questions:
        for count in threads if question.has_threads else threads[:1]:
            yield question, count, told(question, Way(count, device))


def entry_of(question: Question, arrays: Arrays) -> Entry:
    return {"digest": digest(arrays), "portable": question.portable, "record": record(arrays)}


def write_json(path: Path, entries: dict[str, Entry]) -> None:
    lines = [f"{json.dumps(name)}: {json.dumps(entry)}" for name, entry in sorted(entries.items())]
    path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def largest_difference(arrays: Arrays, others: Arrays) -> str:
    """Of each number, relative to the largest of its array."""
    if [a.shape for a in arrays] != [b.shape for b in others]:
        return "other shapes"
    largest = 0.0
    for a, b in zip(arrays, others, strict=True):
        if a.dtype.kind != "f" and (a != b).any():
            return f"{np.count_nonzero(a != b)} other integers"
        finite = np.isfinite(a) & np.isfinite(b)
        if (a[~finite].tobytes()) != b[~finite].tobytes():
            return "others are not finite"
        scale = np.abs(b[finite]).max(initial=0)
        if scale > 0:
            largest = max(largest, float((np.abs(a[finite] - b[finite]) / scale).max()))
    return f"relative difference {largest:.2g}"


class Kept:
    """What is compared with: digests of a .json file, or all numbers of an .npz file."""

    def __init__(self, path: Path) -> None:
        self.entries: dict[str, Entry] = json.loads(path.read_text(encoding="utf-8")) if path.suffix == ".json" else {}
        self.numbers = np.load(path) if path.suffix == ".npz" else {}
        self.names = set(self.entries) | {key.rsplit("/", 1)[0] for key in self.numbers}

    def difference(self, name: str, arrays: Arrays) -> str | None:
        """What is different, None for nothing."""
        if name not in self.names:
            return "is new"
        if self.entries:
            was, found = self.entries[name], record(arrays)
            return None if was["digest"] == digest(arrays) else f"differs: {was['record']} was, {found} is"
        others = [self.numbers[key] for key in sorted(k for k in self.numbers if k.rsplit("/", 1)[0] == name)]
        return None if digest(arrays) == digest(others) else f"differs: {largest_difference(arrays, others)}"


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.digests", description="Digests of all answers.")
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--device", default="cpu", help="cpu or cuda: its answers are the same")
    parser.add_argument("--write", type=Path, metavar="FILE", help="a .json file of digests, or .npz of all numbers")
    parser.add_argument("--compare", type=Path, metavar="FILE", help="either of them; by default tests/digests.json")
    parser.add_argument("--only", default="", metavar="TEXT", help="entries whose name contains it")
    parser.add_argument("--portable", action="store_true", help="only what is promised on every platform")
    parser.add_argument("--list", action="store_true", help="a line for each answer, with its time")
    options = parser.parse_args()
    questions = [q for q in QUESTIONS if options.only in name_of(q) and q.portable >= options.portable]
    kept = Kept(options.compare or REFERENCE) if options.compare or not options.write else None
    entries: dict[str, Entry] = {}
    numbers: dict[str, NDArray[Any]] = {}
    faults, last = 0, time.perf_counter()
    for question, threads, arrays in answers(questions, options.threads, options.device):
        name, entry = name_of(question), entry_of(question, arrays)
        difference = kept.difference(name, arrays) if kept else None
        if entries.setdefault(name, entry) != entry:
            difference = f"differs from what {options.threads[0]} threads find"
        if difference:
            faults += 1
            print(f"{name}, {threads} threads: {difference}{' (portable)' if question.portable else ''}")
        if options.list:
            print(f"{name}, {threads} threads: {entry['digest']} {time.perf_counter() - last:.3f} s")
        numbers.update({f"{name}/{i:04}": array for i, array in enumerate(arrays)} if options.write else {})
        last = time.perf_counter()
    gone = sorted(kept.names - set(entries)) if kept and len(questions) == len(QUESTIONS) else []
    for name in gone:
        print(f"{name}: is gone")
    if options.write:
        write_json(options.write, entries) if options.write.suffix == ".json" else np.savez(options.write, **numbers)
    print(f"{len(entries)} answers, {faults + len(gone)} of them different")
    return 1 if faults or gone else 0


if __name__ == "__main__":
    sys.exit(main())
