# SPDX-License-Identifier: MIT
"""Tests that a CUDA device gives the processor's answers. Without one they do not run, and the summary says so."""

from __future__ import annotations

from pathlib import Path

import pytest

import saddleback as sb

_HERE = Path(__file__).parent
_left_out = 0


def _has_device() -> bool:
    return any(device.kind == "cuda" for device in sb.devices())


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave this folder's tests out where nothing can run them."""
    global _left_out
    if _has_device():
        return
    ours = [item for item in items if _HERE in item.path.parents]
    _left_out = len(ours)
    config.hook.pytest_deselected(items=ours)
    items[:] = [item for item in items if _HERE not in item.path.parents]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say plainly what was not tested."""
    if _left_out:
        terminalreporter.write_line(
            f"CUDA was NOT tested: {_left_out} tests of tests/parity need a device. {sb.cuda_status()}."
        )
