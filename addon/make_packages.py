"""Puts the add-on and its native wheels into dist/: the wheels, the legacy zip and the extension zip.

python addon/make_packages.py WHEEL...

The second half of addon/package. The same files in give the same bytes out.
"""

from __future__ import annotations

import shutil
import sys
import sysconfig
import zipfile
from collections.abc import Iterator
from pathlib import Path

import tomllib

ROOT = Path(__file__).resolve().parents[1]
ADDON = ROOT / "addon/saddleback_blender"
DIST = ROOT / "dist"
MANIFEST = "blender_manifest.toml"
EXTENSION_PLATFORMS = {"linux-x86_64": "linux-x64", "linux-aarch64": "linux-arm64"}
"""What Blender's manifest calls the platforms of `sysconfig.get_platform()`."""


def main(wheels: list[Path]) -> None:
    """Replace what dist/ holds by packages with these wheels."""
    manifest = (ADDON / MANIFEST).read_text(encoding="utf-8")
    version = tomllib.loads(manifest)["version"]
    platform = sysconfig.get_platform()
    name = platform.replace("-", "_").replace(".", "_")
    DIST.mkdir(exist_ok=True)
    for stale in [*DIST.glob("saddleback-*.zip"), *DIST.glob("saddleback-*.whl")]:
        stale.unlink()
    legacy = legacy_zip(DIST / f"saddleback-{version}-legacy-{name}.zip", wheels)
    extension = extension_zip(
        DIST / f"saddleback-{version}-{name}.zip", wheels, manifest, EXTENSION_PLATFORMS[platform]
    )
    copies = [Path(shutil.copy2(wheel, DIST)) for wheel in wheels]
    for path in (legacy, extension, *copies):
        print(f"-- {path.relative_to(ROOT)} ({path.stat().st_size / 1024:.0f} KiB)")


def legacy_zip(path: Path, wheels: list[Path]) -> Path:
    """Writes the package for Blender 3.4 to 4.1, with the wheels unpacked in its lib/, where core/native.py looks."""
    contents = {f"saddleback_blender/{name}": data for name, data in addon_files() if name != MANIFEST}
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
    contents[MANIFEST] = completed_manifest(manifest, [wheel.name for wheel in wheels], platform).encode()
    for wheel in wheels:
        contents[f"wheels/{wheel.name}"] = wheel.read_bytes()
    return write_zip(path, contents)


def completed_manifest(manifest: str, wheels: list[str], platform: str) -> str:
    """Add the keys that depend on the build, in front of the first table (behind one they would belong to it)."""
    lines = manifest.splitlines()
    table = next((i for i, line in enumerate(lines) if line.startswith("[")), len(lines))
    lines[table:table] = [
        f'platforms = ["{platform}"]',
        "wheels = [",
        *(f'  "./wheels/{name}",' for name in wheels),
        "]",
    ]
    return "\n".join(lines) + "\n"


def addon_files() -> Iterator[tuple[str, bytes]]:
    """Yield name and content of what belongs to the add-on, the licence included."""
    for path in sorted(ADDON.rglob("*")):
        relative = path.relative_to(ADDON)
        if path.is_file() and "__pycache__" not in relative.parts and relative.parts[0] != "lib":
            yield relative.as_posix(), path.read_bytes()
    yield "LICENSE", (ROOT / "LICENSE").read_bytes()


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
