# SPDX-License-Identifier: MIT
"""tests/run sorts its arguments, and tells when a Blender fails, dies or lies."""

from __future__ import annotations

import os
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


def outer(
    tmp_path: Path, inner_test: str, *arguments: str, ending: str = "", own_test: str = "", blenders: int = 1
) -> subprocess.CompletedProcess[str]:
    """Run an outer session whose only "Blenders" are this Python, over one inner test file."""
    (tmp_path / "test_inner.py").write_text(textwrap.dedent(inner_test))
    (tmp_path / "inner.py").write_text(
        textwrap.dedent(
            f"""
            import os, sys, pytest
            sys.path.insert(0, {str(ROOT)!r})
            os.chdir({str(tmp_path)!r})
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
            (here / "own").mkdir(exist_ok=True)
            (here / "own/test_own.py").write_text({textwrap.dedent(own_test)!r})
            blender = Blender("pretended", (sys.executable, str(here / "inner.py")))
            options = sys.argv[1:]
            inside = [*options, str(here / "test_inner.py"), "-p", "no:cacheprovider"]
            plugin = SessionsPlugin([blender] * {blenders}, inside)
            sys.exit(pytest.main([*options, "-p", "no:cacheprovider", str(here / "own")], plugins=[plugin]))
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


WAITS_FOR = """
    import time
    from pathlib import Path

    def wait_for(name):
        end = time.monotonic() + 60
        while not Path(name).exists():
            assert time.monotonic() < end
            time.sleep(0.01)
"""


def test_a_blender_runs_beside_the_own_tests(tmp_path):
    inside = WAITS_FOR + "\n    def test_inside(): Path('inside').touch(); wait_for('own-tests')"
    own = WAITS_FOR + "\n    def test_own(): wait_for('inside'); Path('own-tests').touch()"
    done = outer(tmp_path, inside, own_test=own)
    assert done.returncode == 0 and "2 passed" in summary(done)


def test_two_blenders_run_at_a_time(tmp_path):
    """Each waits until another one has begun as well, and tells how many are at work."""
    inside = """
    import os, time
    from pathlib import Path

    def test_inside():
        Path(f"begun-{os.getpid()}").touch()
        end = time.monotonic() + 60
        while len(list(Path().glob("begun-*"))) < 2:
            assert time.monotonic() < end
            time.sleep(0.01)
        Path(f"at-work-{os.getpid()}").touch()
        time.sleep(0.5)
        assert len(list(Path().glob("at-work-*"))) <= 2
        Path(f"at-work-{os.getpid()}").unlink()
    """
    done = outer(tmp_path, inside, blenders=3)
    assert done.returncode == 0 and "3 passed" in summary(done)


def test_a_stopped_session_ends_its_blenders(tmp_path):
    inside = """
    import os, time
    from pathlib import Path

    def test_inside():
        Path("pid").write_text(str(os.getpid()))
        time.sleep(600)
    """
    own = WAITS_FOR + "\n    def test_own(): wait_for('pid'); assert False"
    done = outer(tmp_path, inside, "-x", own_test=own)
    assert done.returncode == 1
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)
