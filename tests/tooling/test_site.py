# SPDX-License-Identifier: MIT
"""The reference site is built without a warning, its scripts and notebooks run, and no link in it leads nowhere."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

import saddleback

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = sorted((ROOT / "docs/site/notebooks").glob("*.ipynb"))
SCRIPTS = sorted((ROOT / "docs/site/gallery").glob("plot_*.py"))


@pytest.fixture(scope="module")
def site(tmp_path_factory) -> Path:
    """Run the one command. A warning, a script or a cell that fails, is an error to it."""
    folder = tmp_path_factory.mktemp("site") / "html"
    done = subprocess.run([ROOT / "docs/site/build", folder], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


def test_nothing_but_a_site_is_replaced(tmp_path) -> None:
    (tmp_path / "mine.txt").write_text("kept")
    done = subprocess.run([ROOT / "docs/site/build", tmp_path], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and "name another folder" in done.stderr
    assert (tmp_path / "mine.txt").read_text() == "kept"


class Links(HTMLParser):
    """What a page leads to, and what can be led to in it."""

    def __init__(self, page: Path) -> None:
        super().__init__()
        self.targets: set[str] = set()
        self.names: set[str] = set()
        self.feed(page.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in ("id", "name") and value:
                self.names.add(value)
            elif name in ("href", "src") and value and not re.match(r"[a-z]+:|//", value):
                self.targets.add(unquote(value))


def test_every_link_of_the_site_leads_somewhere(site: Path) -> None:
    pages = {page: Links(page) for page in site.rglob("*.html") if "cpp" not in page.relative_to(site).parts[:1]}
    assert len(pages) > 150
    lost = []
    for page, links in pages.items():
        for target in links.targets:
            path, _, anchor = target.partition("#")
            there = (page.parent / path.partition("?")[0]).resolve() if path else page
            if not there.exists() or (anchor and there in pages and anchor not in pages[there].names):
                lost.append(f"{page.relative_to(site)}: {target}")
    assert not lost


def test_every_public_name_has_its_page(site: Path) -> None:
    names = [name for name in saddleback.__all__ if not name.startswith("_")]
    missing = [name for name in names if not (site / f"site/made/api/saddleback.{name}.html").exists()]
    assert not missing
    text = (site / "site/made/api/saddleback.SaddleVertexGraph.html").read_text(encoding="utf-8")
    assert "label_correcting" in text and "Raises" in text


def test_every_script_of_the_gallery_is_shown_with_its_picture(site: Path) -> None:
    assert len(SCRIPTS) >= 4
    for script in SCRIPTS:
        page = (site / f"site/made/gallery/{script.stem}.html").read_text(encoding="utf-8")
        assert f"sphx_glr_{script.stem}_001.png" in page


def test_the_notebooks_ran_and_are_kept_without_results(site: Path) -> None:
    assert {path.stem for path in NOTEBOOKS} == {"distances_and_paths", "cells_and_remeshing", "fields_and_shapes"}
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        code = [cell for cell in cells if cell["cell_type"] == "code"]
        assert code and not any(cell["outputs"] or cell["execution_count"] for cell in code)
        page = (site / f"site/notebooks/{path.stem}.html").read_text(encoding="utf-8")
        assert page.count("cell_output") >= len(code) - 1


def test_it_can_be_searched(site: Path) -> None:
    assert (site / "search.html").exists() and (site / "searchindex.js").stat().st_size > 100_000


@pytest.mark.skipif(shutil.which("doxygen") is None, reason="tests/run installs Doxygen")
def test_the_cpp_library_has_its_pages(site: Path) -> None:
    assert (site / "cpp/structsaddleback_1_1DualMesh.html").exists()
