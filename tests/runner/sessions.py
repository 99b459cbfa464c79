# SPDX-License-Identifier: MIT
"""The outer pytest's view of the tests that run inside a Blender: each Blender is one item that brings many reports.

The process runs its own pytest (tests/run_in_blender.py) over tests/addon_blender; its reports arrive one by one and
are shown, counted and summed up as if they were this session's own, with the Blender's name before the test's.

A Blender runs beside the session's own tests, from before they are collected, and keeps one core busy as they do; once
those are over, two run at a time. What they report waits until its turn.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SESSION_LIMIT = 1800
"""Seconds after which a Blender that says nothing more is ended, so that a hang becomes a failure."""
CLOSING_LIMIT = 60
"""Seconds that a Blender has to close down after its tests."""
LOOKS_EVERY = 0.1
"""Seconds between two looks at what a Blender reports."""


@dataclass(frozen=True)
class Blender:
    """A way to run Python with `bpy`: Blender itself, or an environment that holds a bpy wheel."""

    name: str
    command: tuple[str, ...]
    environment: dict[str, str] = field(default_factory=dict)


class SessionsPlugin:
    """Adds the sessions behind all other tests; -k and -m choose inside them, not among them."""

    def __init__(self, blenders: list[Blender], arguments: list[str]) -> None:
        self.blenders = blenders
        self.arguments = arguments
        self.sessions: list[BlenderSession] = []

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection(self, session: pytest.Session) -> None:
        self.sessions = [
            BlenderSession.from_parent(session, blender=blender, arguments=self.arguments) for blender in self.blenders
        ]
        if not session.config.option.collectonly:
            self.start(1)

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items += self.sessions

    def pytest_runtest_logstart(self) -> None:
        self.start(1)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> bool | None:
        if not isinstance(item, BlenderSession):
            return None
        item.pass_all_on(lambda: self.start(2))
        return True

    def pytest_sessionfinish(self) -> None:
        for item in self.sessions:
            item.stop()

    def start(self, most: int) -> None:
        """Start the next Blender where fewer than `most` run."""
        running = sum(item.is_running for item in self.sessions)
        for item in self.sessions:
            if running < most and not item.is_started:
                item.start()
                running += 1


class BlenderSession(pytest.Item):
    """All tests inside one Blender."""

    def __init__(self, *, blender: Blender, arguments: list[str], **rest: Any) -> None:
        super().__init__(name=blender.name, **rest)
        self.blender = blender
        self.arguments = arguments
        self.finished: int | None = None
        self.running = ""
        self.process: subprocess.Popen[str] | None = None
        self.files = contextlib.ExitStack()

    def runtest(self) -> None:
        raise NotImplementedError("a session reports for its tests")

    def reportinfo(self) -> tuple[Path, None, str]:
        return ROOT / "tests", None, self.name

    @property
    def is_started(self) -> bool:
        return self.process is not None

    @property
    def is_running(self) -> bool:
        return self.process is not None and self.process.poll() is None

    def start(self) -> None:
        folder = Path(self.files.enter_context(tempfile.TemporaryDirectory(prefix="saddleback-blender-")))
        resources = folder / "resources"
        resources.mkdir()
        self.reports = folder / "reports"
        self.reports.touch()
        self.output = folder / "output"
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        environment |= {
            "BLENDER_USER_RESOURCES": str(resources),
            "OPENBLAS_NUM_THREADS": "1",  # idle ones of numpy loop for work on a core that is wanted
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
            "SADDLEBACK_REPORTS": str(self.reports),
            **self.blender.environment,
        }
        self.process = subprocess.Popen(
            [*self.blender.command, *self.arguments],
            cwd=ROOT,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=self.files.enter_context(self.output.open("w")),
            stderr=subprocess.STDOUT,
            text=True,
        )

    def stop(self) -> None:
        """End what still runs."""
        if self.process is not None and self.is_running:
            self.process.kill()
            self.process.wait()
        self.files.close()

    def pass_all_on(self, start_others: Callable[[], None]) -> None:
        """Report all that the process reports; whatever else goes wrong with it is a failure too."""
        begin = time.time()
        for line in self._lines(start_others):
            self._pass_on(json.loads(line))
            if self.session.shouldstop or self.session.shouldfail:
                return
        problem = self._problem()
        if problem:
            tail = "\n".join(self.output.read_text(encoding="utf-8", errors="replace").splitlines()[-80:])
            self._report_failure(f"{problem}\n--- last output ---\n{tail}", begin)
        self.stop()

    def _lines(self, start_others: Callable[[], None]) -> Iterator[str]:
        """Yield the lines of the reports until the process has ended or says nothing more for too long."""
        start_others()
        with self.reports.open(encoding="utf-8") as stream:
            part, last = "", time.monotonic()
            while time.monotonic() - last < (SESSION_LIMIT if self.finished is None else CLOSING_LIMIT):
                was_running = self.is_running
                text = stream.read()
                *complete, part = (part + text).split("\n")
                yield from complete
                if text:
                    last = time.monotonic()
                elif not was_running:
                    return
                else:
                    start_others()
                    time.sleep(LOOKS_EVERY)

    def _pass_on(self, message: dict[str, Any]) -> None:
        ((kind, content),) = message.items()
        hook = self.config.hook
        if kind == "collected":
            self.session.testscollected += content - 1
        elif kind == "start":
            self.running = content
            hook.pytest_runtest_logstart(nodeid=self._named(content), location=(self.name, None, content))
        elif kind == "report":
            report = hook.pytest_report_from_serializable(config=self.config, data=content)
            report.nodeid = self._named(report.nodeid)
            hook.pytest_runtest_logreport(report=report)
            if report.when == "teardown":
                self.running = ""
                hook.pytest_runtest_logfinish(nodeid=report.nodeid, location=report.location)
        elif kind == "collection" and content["outcome"] == "failed":
            self._report_failure(content["text"], time.time(), content["nodeid"])
        elif kind == "finished":
            self.finished = content

    def _problem(self) -> str:
        """Say what is wrong with the session as a whole, "" when nothing is."""
        code = self.process.poll() if self.process is not None else None
        if code is None:
            return f"{self.name} did not end"
        if self.finished is None:
            during = f" during {self.running}" if self.running else ""
            return f"{self.name} died with code {code}{during}"
        no_tests = pytest.ExitCode.NO_TESTS_COLLECTED
        told = (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED, no_tests)
        if self.finished not in told:
            return f"pytest inside {self.name} ended with code {self.finished}"
        if code != self.finished:
            return f"pytest inside {self.name} ended with code {self.finished}, but the process with {code}"
        return ""

    def _report_failure(self, text: str, start: float, nodeid: str = "session") -> None:
        nodeid = self._named(nodeid)
        location = (self.name, None, nodeid)
        hook = self.config.hook
        hook.pytest_runtest_logstart(nodeid=nodeid, location=location)
        stop = time.time()
        report = pytest.TestReport(
            nodeid, location, {}, "failed", text, "call", duration=stop - start, start=start, stop=stop
        )
        hook.pytest_runtest_logreport(report=report)
        hook.pytest_runtest_logfinish(nodeid=nodeid, location=location)

    def _named(self, nodeid: str) -> str:
        return f"{self.name}: {nodeid}"
