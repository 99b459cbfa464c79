"""What building a graph takes beside the mesh, at its peak."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

PEAK = """
import saddleback as sb
from tests import meshes

def kilobytes(name):
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith(name))

mesh = sb.Mesh(*meshes.icosphere(6))
with open("/proc/self/clear_refs", "w") as peak:
    peak.write("5")
before = kilobytes("VmRSS")
sb.SaddleVertexGraph(mesh, threads=1, {how})
print((kilobytes("VmHWM") - before) * 1024 / mesh.vertex_count)
"""


@pytest.mark.skipif(
    not Path("/proc/self/clear_refs").exists() or "ASAN_OPTIONS" in os.environ,
    reason="no peak of memory to be read here, or not the build's alone",
)
@pytest.mark.parametrize(("how", "most"), [("k=100", 2000), ("accuracy=5e-3", 1500)])
def test_peak_of_the_build(how: str, most: int) -> None:
    """Bytes a vertex. A new process, whose heap holds nothing that the build could use."""
    done = subprocess.run([sys.executable, "-c", PEAK.format(how=how)], capture_output=True, text=True)
    if "PermissionError" in done.stderr:
        pytest.skip("this system lets no process read its peak")
    assert float(done.stdout) < most, done.stderr
