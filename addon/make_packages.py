# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the add-on and its native wheels into dist/: the wheels, the legacy zip and the extension zip.

python addon/make_packages.py WHEEL...

The second half of addon/package. The wheels are of one platform; what dist/ holds for others stays. The same files in
give the same bytes out.
"""

from __future__ import annotations

import re
import shutil
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon/saddleback_blender"
DIST = ROOT / "dist"
MANIFEST = "blender_manifest.toml"
EXTENSION_PLATFORMS = {
    "linux_x86_64": "linux-x64",
    "linux_aarch64": "linux-arm64",
    "macosx_arm64": "macos-arm64",
    "macosx_x86_64": "macos-x64",
    "win_amd64": "windows-x64",
}
"""What Blender's manifest calls the platforms of wheels."""
FIND_LIBRARY = b"""
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent / "lib"))
"""
"""What the legacy zip adds to __init__.py; for an extension Blender installs wheels."""
LEGACY_PYTHONS = ("cp310", "cp311")
EXTENSION_PYTHONS = ("cp311", "cp313")


def main(wheels: list[Path]) -> None:
    """Replace what dist/ holds for a platform by packages with its wheels."""
    manifest = (ADDON / MANIFEST).read_text(encoding="utf-8")
    version = tomllib.loads(manifest)["version"]
    (of_wheels,) = {platform_of(wheel) for wheel in wheels}
    platform = EXTENSION_PLATFORMS[of_wheels]
    name = platform.replace("-", "_")  # as Blender's --split-platforms writes it
    DIST.mkdir(exist_ok=True)
    for stale in [*DIST.glob(f"saddleback-*-{name}.zip"), *DIST.glob("saddleback-*.whl")]:
        if stale.suffix == ".zip" or platform_of(stale) == of_wheels:
            stale.unlink()
    made = [Path(shutil.copy2(wheel, DIST)) for wheel in wheels]
    if fitting := chosen(wheels, LEGACY_PYTHONS):
        made.append(legacy_zip(DIST / f"saddleback-{version}-legacy-{name}.zip", fitting))
    if fitting := chosen(wheels, EXTENSION_PYTHONS):
        made.append(extension_zip(DIST / f"saddleback-{version}-{name}.zip", fitting, manifest, platform))
    for path in made:
        print(f"-- {path.relative_to(ROOT)} ({path.stat().st_size / 1024:.0f} KiB)")


def platform_of(wheel: Path) -> str:
    """Read it from a wheel's name, whatever the age of the systems: manylinux_2_28_x86_64 is linux_x86_64."""
    tag = wheel.stem.rsplit("-", 1)[1].split(".")[0]
    return re.sub(r"^(?:many)?(linux|macosx)_\d+_\d+", r"\1", tag)


def chosen(wheels: list[Path], pythons: tuple[str, ...]) -> list[Path]:
    """Those for these Pythons, as far as they were made."""
    return [wheel for wheel in wheels if wheel.name.split("-")[2] in pythons]


def legacy_zip(path: Path, wheels: list[Path]) -> Path:
    """Writes the package for Blender 3.4 to 4.1, with the wheels unpacked in its lib/."""
    contents = {f"saddleback_blender/{name}": data for name, data in addon_files() if name != MANIFEST}
    contents["saddleback_blender/__init__.py"] += FIND_LIBRARY
    for wheel in wheels:
        with zipfile.ZipFile(wheel) as archive:
            for item in archive.infolist():
                if not item.is_dir() and ".dist-info/" not in item.filename:
                    contents[f"saddleback_blender/lib/{item.filename}"] = archive.read(item)
    return write_zip(path, contents)


def extension_zip(path: Path, wheels: list[Path], manifest: str, platform: str) -> Path:
    """Writes the package for Blender 4.2 and later: the package's files, a manifest that names the wheels, and the
    wheels.
    """
    contents = dict(addon_files())
    contents["__init__.py"] = without_bl_info(contents["__init__.py"])
    contents[MANIFEST] = completed_manifest(manifest, [wheel.name for wheel in wheels], platform).encode()
    for wheel in wheels:
        contents[f"wheels/{wheel.name}"] = wheel.read_bytes()
    return write_zip(path, contents)


def without_bl_info(source: bytes) -> bytes:
    """Take out what the manifest says instead. In the sources it stays, which Blender 3.4 runs as they are."""
    kept, count = re.subn(rb"^bl_info = \{\n.*?^\}\n+", b"", source, flags=re.MULTILINE | re.DOTALL)
    if count != 1:
        raise ValueError("__init__.py has no bl_info = {...}")
    return kept


def completed_manifest(manifest: str, wheels: list[str], platform: str) -> str:
    """Add the keys that depend on the build, in front of the first table (behind one they would belong to it)."""
    lines = manifest.splitlines()
    table = next((i for i, line in enumerate(lines) if line.startswith("[")), len(lines))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines[table:table] = [
        f'website = "{project["urls"]["Homepage"]}"',
        f'platforms = ["{platform}"]',
        "wheels = [",
        *(f'  "./wheels/{name}",' for name in wheels),
        "]",
    ]
    return "\n".join(lines) + "\n"


def addon_files() -> Iterator[tuple[str, bytes]]:
    """Yield name and content of what belongs to the add-on, the licenses included."""
    for path in sorted(ADDON.rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts:
            yield path.relative_to(ADDON).as_posix(), path.read_bytes()
    yield "LICENSE", (ROOT / "addon/LICENSE").read_bytes()
    yield "licenses/Saddleback-library.txt", (ROOT / "native/LICENSE").read_bytes()
    for path in sorted((ROOT / "native/licenses").iterdir()):
        yield f"licenses/{path.name}", path.read_bytes()


def write_zip(path: Path, contents: dict[str, bytes]) -> Path:
    """Write the files in order of their names, all of the same date."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(contents):
            item = zipfile.ZipInfo(name, date_time=(2020, 1, 1, 0, 0, 0))
            item.compress_type = zipfile.ZIP_DEFLATED
            item.external_attr = (0o755 if ".so" in name else 0o644) << 16
            archive.writestr(item, contents[name])
    return path


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]])
