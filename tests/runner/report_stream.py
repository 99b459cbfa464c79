# SPDX-License-Identifier: MIT
"""Sends what a pytest session finds, test by test, to the pytest that started its process.

One JSON object a line, into the file that SADDLEBACK_REPORTS names.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest


class ReportSender:
    """The plugin of the inner session."""

    def __init__(self, config: pytest.Config, file: str) -> None:
        self.config = config
        self.file = Path(file)

    def send(self, kind: str, content: Any) -> None:
        with self.file.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({kind: content}) + "\n")

    def pytest_collection_finish(self, session: pytest.Session) -> None:
        self.send("collected", len(session.items))

    def pytest_deselected(self, items: list[pytest.Item]) -> None:
        self.send("deselected", len(items))

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if not report.passed:
            self.send("collection", {"nodeid": report.nodeid, "outcome": report.outcome, "text": report.longreprtext})

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.send("start", nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.send("report", self.config.hook.pytest_report_to_serializable(config=self.config, report=report))

    def pytest_sessionfinish(self, exitstatus: int) -> None:
        self.send("finished", int(exitstatus))


class StreamPlugin:
    """Given to pytest.main; makes the sender once there is a configuration."""

    def pytest_configure(self, config: pytest.Config) -> None:
        file = os.environ.get("SADDLEBACK_REPORTS")
        if file:
            config.pluginmanager.register(ReportSender(config, file), "saddleback-report-sender")
