# SPDX-License-Identifier: MIT
"""Links, keys, names, paths and signatures in the documentation lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import saddleback
from tests.tooling.signatures import PAGES, with_signatures
from tests.tooling.tracked import tracked

ROOT = Path(__file__).resolve().parents[2]
TRACKED = tracked()
DOCS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").rglob("*.md"))]
BIBLIOGRAPHY = (ROOT / "docs/bibliography.bib").read_text(encoding="utf-8")
CITATION = re.compile(r"\[([a-z]+(?:18|19|20)\d\d)\](?!\()")
CODE = tuple(f"native/{room}/" for room in ("include", "src", "bindings", "python")) + ("addon/", "tests/", "docs/")


def texts() -> dict[str, str]:
    """What people read, by path: code and documentation."""
    ends = (".h", ".cpp", ".cu", ".cuh", ".py", ".pyi", ".md")
    names = [name for name in TRACKED if name.startswith(CODE) and name.endswith(ends)] + [
        "README.md",
        "CONTRIBUTING.md",
    ]
    return {name: (ROOT / name).read_text(encoding="utf-8") for name in names if (ROOT / name).exists()}


def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", DOCS, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_leads_somewhere(page: Path) -> None:
    for target, anchor in re.findall(r"\]\(([^)#:\s]*)(?:#([^)\s]*))?\)", page.read_text(encoding="utf-8")):
        there = (page.parent / target).resolve() if target else page
        assert there.exists(), f"{target} does not exist"
        assert not anchor or anchor in anchors(there), f"{there.name} has no heading {anchor}"


def test_every_page_and_picture_is_linked() -> None:
    linked = {
        (page.parent / target).resolve()
        for page in DOCS
        for target in re.findall(r"\]\(([^)#:\s]+)", page.read_text(encoding="utf-8"))
    }
    pictures = [path for path in (ROOT / "docs/images").iterdir() if path.suffix in (".png", ".jpg", ".svg")]
    lonely = {path for path in [*DOCS, *pictures] if path.parent != ROOT} - linked
    assert not lonely, f"nothing links to {sorted(str(path.relative_to(ROOT)) for path in lonely)}"


def test_every_cited_work_is_in_the_bibliography_and_none_stands_there_in_vain() -> None:
    known = set(re.findall(r"^@\w+\{(\w+),", BIBLIOGRAPHY, re.MULTILINE))
    cited = {key: name for name, text in texts().items() for key in CITATION.findall(text)}
    assert {f"{key} in {name}" for key, name in cited.items() if key not in known} == set()
    assert known - set(cited) == set()


def test_nobody_cites_the_thesis_without_its_key() -> None:
    pattern = re.compile(r"\bthesis\b(?!\.md)", re.IGNORECASE)
    found = [name for name, text in texts().items() if pattern.search(text) and "thesis" not in name]
    assert found == ["tests/tooling/test_docs.py"]


PATH = re.compile(r"`([a-z0-9_]+(?:/[a-z0-9_*]+)*/(?:[a-z0-9_*]+\.(?:cpp|h|cu|cuh|py))?)`")


def is_there(path: str) -> bool:
    """Whether a tracked path ends with it, or a folder does."""
    end = "" if path.endswith("/") else "$"
    pattern = re.compile("(^|/)" + re.escape(path).replace(r"\*", "[^/]*") + end)
    return any(pattern.search(name) for name in TRACKED)


@pytest.mark.parametrize(
    "page", [ROOT / "docs/architecture.md", ROOT / "docs/glossary.md", *PAGES], ids=lambda p: p.stem
)
def test_every_file_that_is_named_exists(page: Path) -> None:
    missing = [path for path in PATH.findall(page.read_text(encoding="utf-8")) if not is_there(path)]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_algorithms_are_described_alike_and_signatures_are_those_of_the_package(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert with_signatures(text) == text, "python -m tests.tooling.signatures writes them"
    if page.stem != "README":
        for part in ("What", "Guarantee", "Complexity", "Picture", "Source"):
            assert f"\n**{part}.**" in text, part
        assert "<!-- signatures: " in text


@pytest.mark.parametrize("page", [page for page in DOCS if page.parent != ROOT], ids=lambda p: str(p.relative_to(ROOT)))
def test_python_in_the_documentation_uses_names_that_exist(page: Path) -> None:
    for code in re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
        if "sb.SaddleVertexGraph(\n" not in code and "->" not in code:
            compile(code, str(page), "exec")
        for name in re.findall(r"\bsb((?:\.[A-Za-z_]\w*)+)", code):
            thing: object = saddleback
            for part in name[1:].split("."):
                thing = getattr(thing, part)


def test_operators_in_the_documentation_have_the_properties_that_are_shown() -> None:
    addon = ROOT / "addon/saddleback_blender"
    source = "".join(
        path.read_text(encoding="utf-8") for room in ("ops", "props") for path in (addon / room).glob("*.py")
    )
    for page in DOCS:
        for name, given in re.findall(r"bpy\.ops\.saddleback\.(\w+)\(([^()]*)\)", page.read_text(encoding="utf-8")):
            assert f'"saddleback.{name}"' in source, f"{page.name}: there is no operator {name}"
            for keyword in re.findall(r"(\w+)=", given):
                assert re.search(rf"\b{keyword}\b", source), f"{page.name}: {name} has no property {keyword}"


def test_numbers_are_written_with_a_digit_before_the_point() -> None:
    found = [
        f"{page.relative_to(ROOT)}: {match[0].strip()}"
        for page in DOCS
        for match in re.finditer(r"(?:^|[\s(|])\.\d\S*", page.read_text(encoding="utf-8"))
    ]
    assert found == []
