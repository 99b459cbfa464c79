# SPDX-License-Identifier: MIT
"""All of them on one page: `python -m tests.bench all FOLDER [--only NAME...]`; FOLDER holds triangle meshes (PLY).

Each runs in a process of its own, and what it prints becomes a section of build/bench/README.md, beside a plot of how
calls scale. One that fails, or runs for an hour, is a section as well; the page is written after each. Takes hours:
those that look for themselves whether all is right try many meshes.
"""

from __future__ import annotations

import argparse
import platform
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = ROOT / "build/bench"
LIMIT = 3600  # seconds
SCANS = ("bunny-35k-closed", "dragon-50k", "kitten-53k", "rocker-arm-10k", "anisotropic-cylinder-1000")
FOLDERS = ("exact", "fields", "paths", "stroke_maps")
SEVERAL = ("cells", "geodesics", "progress", "queries", "tessellation")
ALONE = ("distribution", "plane_counts", "surface", "voronoi_2d")


def commands(folder: Path) -> dict[str, list[str]]:
    """Return the arguments of each benchmark, by its name."""
    scans = [str(file) for name in SCANS if (file := folder / f"{name}.ply").exists()]
    scans = scans or [str(file) for file in sorted(folder.glob("*.ply"))[: len(SCANS)]]
    return {
        **{name: [] for name in ALONE},
        **{name: [str(folder)] for name in FOLDERS},
        **dict.fromkeys(SEVERAL, scans),
        "parts": scans[:1],
        "scaling": ["--plot", str(PLACE / "scaling.svg")],
    }


def section(name: str, arguments: list[str]) -> str:
    command = [sys.executable, "-m", "tests.bench", name, *arguments]
    try:
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=LIMIT, check=False)
    except subprocess.TimeoutExpired:
        return f"## {name}\n\nDid not end within {LIMIT} s.\n"
    said = done.stdout.strip() + ("" if done.returncode == 0 else f"\n\nFailed:\n{done.stderr.strip()[-2000:]}")
    picture = "\n![How calls scale](scaling.svg)\n" if name == "scaling" else ""
    return f"## {name}\n\n```\n{said}\n```\n{picture}"


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--only", nargs="+", metavar="NAME")
    options = parser.parse_args(arguments)
    known = commands(options.folder.resolve())
    unknown = set(options.only or ()) - set(known)
    if unknown or not any(options.folder.glob("*.ply")):
        parser.error(f"no such benchmark: {', '.join(sorted(unknown))}" if unknown else "no PLY files in the folder")
    PLACE.mkdir(parents=True, exist_ok=True)
    page = f"# Benchmarks\n\n{platform.platform()}, {platform.processor() or platform.machine()}\n"
    for name in options.only or known:
        print(name, flush=True)
        page += "\n" + section(name, known[name])
        (PLACE / "README.md").write_text(page, encoding="utf-8")
    print(PLACE / "README.md")
