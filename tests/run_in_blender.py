# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs pytest inside Blender.

    blender -b --factory-startup --python-exit-code 9 --python tests/run_in_blender.py -- PYTEST_ARGUMENTS
    PYTHON_WITH_BPY tests/run_in_blender.py -- PYTEST_ARGUMENTS

`SADDLEBACK_PYTHONPATH` (folders, separated like PATH) says where the native package, and pytest if Blender's Python has
none, are found.
"""

import os
import sys
import tempfile
from pathlib import Path
from typing import NoReturn

# Before anything asks Blender for its folders: a test must not see, or touch, the user's own.
os.environ.setdefault("BLENDER_USER_RESOURCES", tempfile.mkdtemp(prefix="saddleback-blender-"))

import numpy  # noqa: F401  (Blender's own, before the folders below offer another)

sys.path[:0] = [path for path in os.environ.get("SADDLEBACK_PYTHONPATH", "").split(os.pathsep) if path]
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import pytest

from tests.runner.report_stream import StreamPlugin


def main() -> int:
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    # The cache folder instead of `-p no:cacheprovider`, which other plugins do not survive. Blender's own modules warn.
    folder = tempfile.mkdtemp(prefix="saddleback-pytest-")
    return int(pytest.main([*arguments, "-o", f"cache_dir={folder}", "-W", "default"], plugins=[StreamPlugin()]))


def leave(code: int) -> NoReturn:
    """Ends the program. The module of Blender 4.2 crashes after Python has ended, once any property has a callback."""
    import bpy

    sys.stdout.flush()
    if bpy.app.version < (4, 3) and not bpy.app.binary_path:
        sys.stderr.flush()
        os._exit(code)
    sys.exit(code)


if __name__ == "__main__":
    code = main()
    leave(code)
