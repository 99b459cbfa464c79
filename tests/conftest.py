# SPDX-License-Identifier: MIT
"""Shared by all tests."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# Slow shared machines must not fail a property; the same examples every time keep a red test red.
settings.register_profile("saddleback", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("saddleback")


@pytest.fixture
def as_anyone(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder of a user who may not write everywhere, as whom the test runs: root gives its rights up for so long."""
    if os.name == "nt" or os.geteuid() != 0:
        yield tmp_path_factory.mktemp("anyone")
        return
    with tempfile.TemporaryDirectory() as folder:
        nobody = 65534
        os.chown(folder, nobody, nobody)
        os.setresuid(nobody, nobody, 0)
        try:
            yield Path(folder)
        finally:
            os.setresuid(0, 0, 0)
