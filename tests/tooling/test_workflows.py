# SPDX-License-Identifier: MIT
"""The workflows, which run on other machines than this: linted, and agreeing with what they call."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[2]
WORKFLOWS = sorted((ROOT / ".github/workflows").glob("*.yml"))


def release():
    spec = importlib.util.spec_from_file_location("release", ROOT / ".github/release.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_actionlint_is_content():
    command = [Path(sys.executable).with_name("actionlint"), "-no-color", *WORKFLOWS]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_files_that_workflows_name_exist():
    for workflow in WORKFLOWS:
        for name in re.findall(r"(?<![\w/])(?:tests|addon|\.github)/[\w/.]*\w", workflow.read_text()):
            assert (ROOT / name).exists(), f"{workflow.name} names {name}"


def test_a_release_needs_its_version_its_changelog_and_its_home(monkeypatch, tmp_path):
    tool = release()
    (tmp_path / "pyproject.toml").write_text('[project]\nversion = "1.2.3"\nurls.Source = "https://home"\n')
    (tmp_path / "CHANGELOG.md").write_text("# C\n\n## [1.2.3] - 2026\n\n### Added\n\n- A.\n\n## [1.2.2]\n\n- B.\n")
    monkeypatch.setattr(tool, "ROOT", tmp_path)
    assert tool.problems("1.2.3", "https://home") == []
    assert tool.notes("1.2.3") == "### Added\n\n- A."
    assert len(tool.problems("1.3.0", "https://elsewhere")) == 3
    (tmp_path / "addon").mkdir()
    (tmp_path / "addon/menus.py").write_text('MANUAL = "https://github.com/OWNER/saddleback"\n')
    assert tool.problems("1.2.3", "https://home") == [
        "addon/menus.py says OWNER where docs/releasing.md, step 1, puts a name"
    ]


def test_all_addresses_lead_to_one_home():
    home = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]["Homepage"]
    for path in [ROOT / "pyproject.toml", *(ROOT / "addon").rglob("*.py")]:
        for address in re.findall(r"https://github\.com/[^\s\"]+", path.read_text()):
            assert f"{address}/".startswith(f"{home}/"), f"{path.name}: {address} is not at {home}"


def test_the_page_tells_of_each_job_whether_it_ever_ran():
    page = (ROOT / "docs/releasing.md").read_text()
    for workflow in WORKFLOWS:
        jobs = re.findall(r"^  ([a-z-]+):", workflow.read_text().partition("\njobs:\n")[2], re.MULTILINE)
        assert jobs and all(f"`{job}`" in page for job in jobs), f"docs/releasing.md tells whether each ran: {jobs}"
