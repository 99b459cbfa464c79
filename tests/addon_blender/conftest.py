# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on enabled once, and an empty file for each test. Runs in Blender and in the `bpy` wheels alike."""

import os
import sys
import tempfile
from pathlib import Path

import pytest

os.environ.setdefault("BLENDER_USER_RESOURCES", tempfile.mkdtemp(prefix="saddleback-blender-"))
REPOSITORY = Path(__file__).resolve().parents[2]
for folder in (REPOSITORY / "addon", Path(__file__).resolve().parent):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))

try:
    import bpy
except ImportError:  # these tests need Blender; tests/run starts them where it is
    collect_ignore_glob = ["*"]
else:

    @pytest.fixture(scope="session", autouse=True)
    def addon():
        bpy.ops.preferences.addon_enable(module="saddleback_blender")
        assert "saddleback_blender" in bpy.context.preferences.addons
        yield
        bpy.ops.preferences.addon_disable(module="saddleback_blender")

    @pytest.fixture(autouse=True)
    def empty_file(addon):
        from saddleback_blender import jobs
        from saddleback_blender.core import cache

        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        cache.shared.clear()
        cache.shared.resize(2048 * 2**20)
        cache.shared.builds.clear()
        jobs.state.needs_repair = ""
        yield
        jobs.stop_all()
