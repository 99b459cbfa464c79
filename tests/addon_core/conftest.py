"""The add-on's core is importable without Blender."""

import sys
from pathlib import Path

ADDON = str(Path(__file__).resolve().parents[2] / "addon")
if ADDON not in sys.path:
    sys.path.insert(0, ADDON)
