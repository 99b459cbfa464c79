# SPDX-License-Identifier: MIT
"""tests/run sorts its arguments, and tells when a Blender fails, dies or lies."""

from __future__ import annotations

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from tests.runner.arguments import split

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("given", "plain", "inside", "options"),
    [
        ([], [], [], []),
        (["-k", "repair"], [], [], ["-k", "repair"]),
        (["tests"], [], [], []),
        (["tests/tooling", "-x"], ["tests/tooling"], [], ["-x"]),
        (["tests/addon_blender/conftest.py::a[1]"], [], ["tests/addon_blender/conftest.py::a[1]"], []),
        (["tests/addon_blender", "tests/tooling"], ["tests/tooling"], ["tests/addon_blender"], []),
    ],
)
def test_arguments_are_sorted(given, plain, inside, options):
    result = split(given, ROOT)
    assert (result.plain, result.inside, result.options) == (plain, inside, options)


def test_what_the_arguments_ask_for():
    assert split([], ROOT).wants_plain and split([], ROOT).wants_inside
    assert not split(["tests/tooling"], ROOT).wants_inside
    assert not split(["tests/addon_blender"], ROOT).wants_plain


@pytest.mark.parametrize(
    ("given", "needs"),
    [
        ([], ["blender", "bpy"]),
        (["-k", "repair"], ["blender", "bpy"]),
        (["tests/native"], []),
        (["tests/addon_ui"], ["blender"]),
        (["tests/addon_blender/conftest.py"], ["blender", "bpy"]),
    ],
)
def test_only_what_is_needed_is_installed(given, needs):
    assert split(given, ROOT).needs == needs


def outer(tmp_path: Path, inner_test: str, *arguments: str, ending: str = "") -> subprocess.CompletedProcess[str]:
    """Run an outer session whose only "Blender" is this Python, over one inner test file."""
    (tmp_path / "test_inner.py").write_text(textwrap.dedent(inner_test))
    (tmp_path / "inner.py").write_text(
        textwrap.dedent(
            f"""
            import os, sys, pytest
            sys.path.insert(0, {str(ROOT)!r})
            from tests.runner.report_stream import StreamPlugin
            code = pytest.main(sys.argv[1:], plugins=[StreamPlugin()])
            {ending or "sys.exit(int(code))"}
            """
        )
    )
    (tmp_path / "outer.py").write_text(
        textwrap.dedent(
            f"""
            import sys, pytest
            sys.path.insert(0, {str(ROOT)!r})
            from tests.runner.sessions import Blender, SessionsPlugin
            from pathlib import Path
            here = Path({str(tmp_path)!r})
            (here / "nothing").mkdir(exist_ok=True)
            blender = Blender("pretended", (sys.executable, str(here / "inner.py")))
            options = sys.argv[1:]
            plugin = SessionsPlugin([blender], [*options, str(here / "test_inner.py"), "-p", "no:cacheprovider"])
            sys.exit(pytest.main([*options, "-p", "no:cacheprovider", str(here / "nothing")], plugins=[plugin]))
            """
        )
    )
    command = [sys.executable, str(tmp_path / "outer.py"), *arguments]
    return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=120)


def summary(done: subprocess.CompletedProcess[str]) -> str:
    return done.stdout.strip().splitlines()[-1]


TESTS = """
    import os
    import pytest

    def test_good(): pass

    def test_bad(): assert 1 + 1 == 3, "the culprit"

    @pytest.mark.skip(reason="elsewhere")
    def test_skipped(): pass
"""


def test_inner_results_are_counted_one_by_one(tmp_path):
    done = outer(tmp_path, TESTS)
    assert done.returncode == 1
    assert "1 failed, 1 passed, 1 skipped" in summary(done)
    assert "the culprit" in done.stdout and "test_inner.py::test_bad" in done.stdout


def test_a_choice_is_made_inside(tmp_path):
    done = outer(tmp_path, TESTS, "-k", "good")
    assert done.returncode == 0
    assert "1 passed" in summary(done)


def test_a_crash_is_a_failure_that_names_the_test(tmp_path):
    done = outer(tmp_path, "import os\ndef test_good(): pass\ndef test_dies(): os.abort()\n")
    assert done.returncode == 1
    assert "died with code -6 during" in done.stdout and "test_dies" in done.stdout
    assert "1 failed, 1 passed" in summary(done)


def test_a_file_that_cannot_be_imported_is_a_failure(tmp_path):
    done = outer(tmp_path, "import no_such_module")
    assert done.returncode == 1
    assert "no_such_module" in done.stdout and "1 failed" in summary(done)


def test_a_wrong_exit_code_is_a_failure(tmp_path):
    done = outer(tmp_path, "def test_good(): pass", ending="sys.exit(9)")
    assert done.returncode == 1
    assert "ended with code 0, but the process with 9" in done.stdout
