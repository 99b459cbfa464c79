"""Runs pytest inside Blender.

    blender -b --factory-startup --python-exit-code 9 --python tests/run_in_blender.py -- PYTEST_ARGUMENTS

`SADDLEBACK_PYTHONPATH` (folders, separated like PATH) says where the native package, and pytest if Blender's Python has
none, are found. They go behind Blender's own folders, so that its numpy stays the one in use.
"""

import os
import sys
import tempfile

# Before anything asks Blender for its folders: a test must not see, or touch, the user's own.
os.environ.setdefault("BLENDER_USER_RESOURCES", tempfile.mkdtemp(prefix="saddleback-blender-"))
sys.path += [path for path in os.environ.get("SADDLEBACK_PYTHONPATH", "").split(os.pathsep) if path]

import pytest


def main() -> int:
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    # The cache folder instead of `-p no:cacheprovider`, which other plugins do not survive.
    return int(pytest.main([*arguments, "-o", f"cache_dir={tempfile.mkdtemp(prefix='saddleback-pytest-')}"]))


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.exit(code)
