# SPDX-License-Identifier: MIT
"""Answers that are promised to be equal to the bit on every platform are those that `tests/digests.json` keeps.

All the others, which this platform's libm may move by a bit: `python -m tests.digests`.
"""

from __future__ import annotations

import json
from itertools import groupby

import numpy as np
import pytest

from tests import digests
from tests.digest_questions import QUESTIONS, Question

PORTABLE = sorted((question for question in QUESTIONS if question.portable), key=lambda question: question.name)
BY_NAME = {name: list(questions) for name, questions in groupby(PORTABLE, key=lambda question: question.name)}


@pytest.mark.parametrize("name", BY_NAME)
def test_portable_answers_are_those_that_are_kept(name: str) -> None:
    kept = digests.Kept(digests.REFERENCE)
    for question, threads, arrays in digests.answers(BY_NAME[name], [1, 2], "cpu"):
        assert kept.difference(digests.name_of(question), arrays) is None, (question.subject, threads)


def test_every_question_has_a_digest_and_every_digest_a_question() -> None:
    kept = json.loads(digests.REFERENCE.read_text(encoding="utf-8"))
    assert {digests.name_of(question): question.portable for question in QUESTIONS} == {
        name: entry["portable"] for name, entry in kept.items()
    }


def test_a_digest_sees_one_bit_and_no_kind_of_nan() -> None:
    def digest(*parts: object) -> str:
        return digests.digest(digests.as_arrays(parts))

    assert digest([1.0, 2.0]) != digest([1.0, np.nextafter(2.0, 3)]) != digest([1.0], [2.0])
    assert digest([0.0]) != digest([-0.0])
    assert digest([np.nan, 1]) == digest([-np.nan, 1])
    assert digest(np.int32([1, 2])) == digest(np.int64([1, 2])) != digest([1.0, 2.0])


def test_differences_of_numbers_are_told(tmp_path) -> None:
    question = Question("name", "subject", True, lambda way: [[1.0, 4.0], [3]], False)
    before = digests.told(question, digests.Way())
    np.savez(tmp_path / "kept.npz", **{f"subject/name/{i:04}": array for i, array in enumerate(before)})
    kept = digests.Kept(tmp_path / "kept.npz")
    assert kept.difference("subject/name", before) is None
    assert kept.difference("subject/name", [np.array([1.0, 4.0 + 1e-6]), before[1]]) == (
        "differs: relative difference 2.5e-07"
    )
    assert kept.difference("subject/name", [before[0], np.array([2])]) == "differs: 1 other integers"
