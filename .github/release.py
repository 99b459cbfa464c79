# SPDX-License-Identifier: MIT
"""Checks that a tag may be released, or prints the text of its release.

python3 .github/release.py v0.1.0 https://github.com/OWNER/REPOSITORY
python3 .github/release.py --notes v0.1.0
"""

import re
import sys
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[1]


def notes(version: str) -> str:
    """The changelog's section of a version."""
    text = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    found = re.search(rf"^## \[{re.escape(version)}\][^\n]*\n(.*?)(?=^## |\Z)", text, re.MULTILINE | re.DOTALL)
    return found[1].strip() if found else ""


def without_owner() -> list[str]:
    """The files of packages whose addresses have no owner yet."""
    files = [ROOT / "pyproject.toml", *sorted((ROOT / "addon").rglob("*.py"))]
    return [str(path.relative_to(ROOT)) for path in files if re.search(r"\bOWNER\b", path.read_text(encoding="utf-8"))]


def problems(version: str, address: str) -> list[str]:
    """What stands against releasing this version from the repository at this address."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    found = []
    if project["version"] != version:
        found.append(f"the tag is v{version}, but pyproject.toml has version {project['version']}")
    if project["urls"]["Source"] != address:
        found.append(f"pyproject.toml says that the source is at {project['urls']['Source']}, but this is {address}")
    found += [f"{name} says OWNER where docs/releasing.md, step 1, puts a name" for name in without_owner()]
    if not notes(version):
        found.append(f"CHANGELOG.md has no section [{version}]")
    return found


if __name__ == "__main__":
    if sys.argv[1] == "--notes":
        print(notes(sys.argv[2].removeprefix("v")))
    else:
        sys.exit("\n".join(problems(sys.argv[1].removeprefix("v"), sys.argv[2])) or 0)
