# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's core is importable without Blender."""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
for folder in (HERE.parents[1] / "addon", HERE):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
