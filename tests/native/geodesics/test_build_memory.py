# SPDX-License-Identifier: MIT
"""What a computation takes beside its input, at its peak."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PEAK = """
import numpy as np
import saddleback as sb
from tests import meshes

def kilobytes(name):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith(name))

{prepare}
with open("/proc/self/clear_refs", "w") as peak:
    peak.write("5")
before = kilobytes("VmRSS")
{work}
print((kilobytes("VmHWM") - before) * 1024)
"""

readable = pytest.mark.skipif(
    sys.platform != "linux" or not Path("/proc/self/clear_refs").exists() or "ASAN_OPTIONS" in os.environ,
    reason="no peak of memory to be read here, or not the build's alone",
)


def peak(prepare: str, work: str) -> float:
    """Bytes. A new process, whose heap holds nothing that the work could use."""
    done = subprocess.run(
        [sys.executable, "-c", PEAK.format(prepare=prepare, work=work)], capture_output=True, text=True
    )
    if "PermissionError" in done.stderr:
        pytest.skip("this system lets no process read its peak")
    assert done.returncode == 0, done.stderr
    return float(done.stdout)


@readable
@pytest.mark.parametrize(("how", "most"), [("k=100", 2000), ("accuracy=5e-3", 1500)])
def test_peak_of_the_build(how: str, most: int) -> None:
    """Bytes a vertex."""
    bytes_taken = peak("mesh = sb.Mesh(*meshes.icosphere(6))", f"sb.SaddleVertexGraph(mesh, threads=1, {how})")
    assert bytes_taken / (10 * 4**6 + 2) < most


@readable
def test_peak_of_a_plane_diagram() -> None:
    """The diagram itself has 160 bytes a site, at a million."""
    assert peak("sites = np.random.default_rng(0).random((10**6, 2))", "sb.voronoi_2d(sites, threads=1)") < 195e6
