# SPDX-License-Identifier: MIT
"""Doc comments begin a sentence, and the words of the house are those of docs/glossary.md."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted(path for path in (ROOT / "native").rglob("*") if path.suffix in (".h", ".cpp", ".cu", ".cuh"))
SCRIPTS = sorted((ROOT / "addon").rglob("*.py")) + sorted((ROOT / "native").rglob("*.py"))
MOST_FRAGMENTS = 0.005  # of all doc comments
MID_SENTENCE = re.compile(
    r"(The same|About|Above|Across|After|Again|Against|Along|Also|Among|And|Around|As|At|Because|Before|Behind|Below|"
    r"Beside|Between|Beyond|But|By|Else|For|From|How|If|In|Instead|Into|Like|Neither|Not|Of|On|Only|Or|Out|Over|Per|"
    r"Since|So|Such|Than|That|Those|Through|To|Told|Under|Until|Up|What|Whatever|When|Where|Whether|Which|While|Who|"
    r"Whoever|Whose|Why|With|Within|Without)\b"
)
# Words that we once had for a window's child and cone, a cell builder, a random batch, what waits, the bucket of a
# calendar queue, a site that may own a part of a face, the CUDA module. `late` and `day` stay words in prose.
PRIVATE = re.compile(
    r"(?<![A-Za-z])(heirs?|shin(?:e|es|ing)|shone|relight|lit|winders?|showers?|rain(?:s|ed)?|(?:next_)?day_\w+|days|"
    r"wish(?:es|ed)?|grants?|granted|(?:is_|be_)late|late_\w*|laid_(?=\W)|(?:Cell|Face|Site|Exact)Claims?|"
    r"CudaTwins?|TwinStatus|twin_(?:arcs|search|voronoi|caller)|(?:arc|plane|search)_twin)(?![a-z])"
)


def doc_comments(text: str) -> Iterator[tuple[int, str]]:
    """Yield the first lines of doc comments with their numbers."""
    goes_on = False
    for number, line in enumerate(text.split("\n"), 1):
        found = re.match(r"\s*///(?!<)\s?(.*)", line)
        if found and not goes_on:
            yield number, found[1]
        goes_on = bool(found)


def private_words(text: str) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(text.split("\n"), 1):
        yield from ((number, word[1]) for word in PRIVATE.finditer(line))


def test_doc_comments_begin_with_a_verb_or_a_noun() -> None:
    comments = [(path, n, text) for path in SOURCES for n, text in doc_comments(path.read_text(encoding="utf-8"))]
    fragments = [f"{path.relative_to(ROOT)}:{n}: {text}" for path, n, text in comments if MID_SENTENCE.match(text)]
    assert len(comments) > 2000, "few doc comments were found: the rule would hold for nothing"
    assert len(fragments) <= MOST_FRAGMENTS * len(comments), "\n".join(fragments)


def test_private_words_go() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {word}"
        for path in SOURCES + SCRIPTS
        for number, word in private_words(path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(found)


@pytest.mark.parametrize("line", ["/// Of all threads.", "  /// Whether it is.", "/// The same about a node."])
def test_a_fragment_is_seen(line: str) -> None:
    ((_, text),) = doc_comments(f"int a;\n{line}\n/// More of it.\nint b;\n")
    assert MID_SENTENCE.match(text)


@pytest.mark.parametrize(
    "line", ["Window heir;", "late_sides_.clear();", "wish_count()", "// is lit.", "CellClaims c;"]
)
def test_a_private_word_is_seen(line: str) -> None:
    assert [number for number, _ in private_words(f"int a;\n{line}")] == [2]


@pytest.mark.parametrize("line", ["product(day, dby)", "plates", "latest", "split", "remain", "wakes too late"])
def test_other_words_are_left_alone(line: str) -> None:
    assert not list(private_words(line))
