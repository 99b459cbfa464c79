# SPDX-License-Identifier: MIT
"""The outer pytest's view of the tests that run inside a Blender: each Blender is one item that brings many reports.

The process runs its own pytest (tests/run_in_blender.py) over tests/addon_blender; its reports arrive one by one and
are shown, counted and summed up as if they were this session's own, with the Blender's name before the test's.
"""

from __future__ import annotations

import contextlib
import json
import os
import selectors
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
SESSION_LIMIT = 1800
"""Seconds after which a Blender that says nothing more is ended, so that a hang becomes a failure."""


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

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, session: pytest.Session, items: list[pytest.Item]) -> None:
        items += [
            BlenderSession.from_parent(session, blender=blender, arguments=self.arguments) for blender in self.blenders
        ]

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> bool | None:
        if not isinstance(item, BlenderSession):
            return None
        item.run_all()
        return True


class BlenderSession(pytest.Item):
    """All tests inside one Blender."""

    def __init__(self, *, blender: Blender, arguments: list[str], **rest: Any) -> None:
        super().__init__(name=blender.name, **rest)
        self.blender = blender
        self.arguments = arguments
        self.finished: int | None = None
        self.running = ""

    def runtest(self) -> None:
        raise NotImplementedError("a session reports for its tests")

    def reportinfo(self) -> tuple[Path, None, str]:
        return ROOT / "tests", None, self.name

    def run_all(self) -> None:
        """Run the process to its end and pass on all that it reports; whatever else goes wrong is a failure too."""
        start = time.time()
        with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as output:
            code = None
            try:
                with self._process(output) as (process, reports):
                    for line in reports:
                        self._pass_on(json.loads(line))
                        if self.session.shouldstop or self.session.shouldfail:
                            process.terminate()
                            return
                    code = process.wait(timeout=60)  # the reports have ended: only closing down is left
            except subprocess.TimeoutExpired:
                pass
            output.seek(0)
            problem = self._problem(code)
            if problem:
                tail = "".join(output.readlines()[-80:])
                self._report_failure(f"{problem}\n--- last output ---\n{tail}", start)

    @contextlib.contextmanager
    def _process(self, output: Any) -> Iterator[tuple[subprocess.Popen[str], Iterator[str]]]:
        reading, writing = os.pipe()
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        with tempfile.TemporaryDirectory(prefix="saddleback-blender-") as resources:
            environment |= {
                "BLENDER_USER_RESOURCES": resources,
                "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
                "SADDLEBACK_REPORTS": str(writing),
                **self.blender.environment,
            }
            process = subprocess.Popen(
                [*self.blender.command, *self.arguments],
                cwd=ROOT,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                pass_fds=[writing],
                text=True,
            )
            os.close(writing)
            try:
                with os.fdopen(reading, encoding="utf-8") as reports:
                    yield process, _lines(reports, SESSION_LIMIT)
            finally:
                if process.poll() is None:
                    process.kill()
                    process.wait()

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

    def _problem(self, code: int | None) -> str:
        """Say what is wrong with the session as a whole, "" when nothing is."""
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


def _lines(stream: Any, limit: float) -> Iterator[str]:
    """Yield the lines until the other end closes; raise TimeoutExpired when none comes for `limit` seconds."""
    with selectors.DefaultSelector() as selector:
        selector.register(stream, selectors.EVENT_READ)
        buffer = b""
        while True:
            if not selector.select(timeout=limit):
                raise subprocess.TimeoutExpired("the tests inside Blender", limit)
            block = os.read(stream.fileno(), 65536)
            if not block:
                return
            *complete, buffer = (buffer + block).split(b"\n")
            for line in complete:
                yield line.decode("utf-8")
