# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked files -> images of the .blend."""

from __future__ import annotations

import os
import shutil
from functools import partial
from pathlib import Path

import bpy

from ... import rollback
from ...core.bake_runs import BakedImage, BakeResult
from ...core.errors import BadInputError

MADE = "saddleback_baked"  # on images: the name that we gave them
REACH = "saddleback_reach"  # on images: what 1 stands for, in world units


def check_images(source: bpy.types.Object, names: list[str], folder: str) -> None:
    """Refuses names that other images have, and folders that cannot be written to. Raises BadInputError."""
    for name in names:
        other = bpy.data.images.get(name)
        if other is not None and (MADE not in other or other.library is not None):
            raise BadInputError(
                f"'{source.name}': there is an image '{name}' already, which Saddleback did not make; rename it, or "
                "choose another Name for the baked ones"
            )
    place = folder_of(folder)
    if place is not None and not (place.is_dir() and os.access(place, os.W_OK)):
        raise BadInputError(f"'{source.name}': '{place}' is no folder that can be written to; choose another")


def folder_of(folder: str) -> Path | None:
    """The folder of a setting, None for the .blend file itself."""
    return Path(bpy.path.abspath(folder)) if folder else None


def name_of_image(prefix: str, label: str) -> str:
    """What an image is called, which has room for 63 bytes."""
    return f"{prefix.encode()[:40].decode(errors='ignore')} {label}"


def write_images(source: bpy.types.Object, result: BakeResult, prefix: str, folder: str) -> list[str]:
    """Makes the images, in place of those of the same names; returns the names. Raises BadInputError."""
    names = [name_of_image(prefix, image.label) for image in result.images]
    check_images(source, names, folder)
    place = folder_of(folder)
    for image, name in zip(result.images, names, strict=True):
        if place is None:
            files = {
                tile: path.rename(path.with_name(_file_name(name, image, tile))) for tile, path in image.files.items()
            }
            made = _loaded(name, image, files)
            made.pack()
            made.filepath_raw = f"//{Path(made.filepath_raw).name}"
            rollback.when_written(partial(_put_in_place, made.name, name))
        else:
            files = {tile: place / _file_name(name, image, tile) for tile in image.files}
            for tile, path in files.items():
                _copy(source, image.files[tile], path)
            rollback.when_written(partial(_load_in_place, name, image, files))
    return names


def _file_name(name: str, image: BakedImage, tile: int) -> str:
    number = f".{tile}" if len(image.files) > 1 else ""
    return f"{bpy.path.clean_name(name)}{number}{image.files[tile].suffix}"


def _copy(source: bpy.types.Object, path: Path, wanted: Path) -> None:
    """Puts a file where it is to be. Windows refuses where another program holds what is there, so what may still fail
    comes first: a copy of what was there is moved back where anything fails later. A link stays one.
    """
    wanted = Path(os.path.realpath(wanted))
    part, former = (wanted.with_name(f".{wanted.name}.{end}") for end in ("part", "former"))
    for extra in (part, former):
        rollback.undo_with(partial(extra.unlink, missing_ok=True))
    put_back = partial(wanted.unlink, missing_ok=True)
    try:
        if wanted.exists():
            shutil.copyfile(wanted, former)
            put_back = partial(os.replace, former, wanted)
        shutil.copyfile(path, part)
        os.replace(part, wanted)
    except OSError as error:
        raise BadInputError(f"'{source.name}': '{wanted}' cannot be saved: {error.strerror}") from error
    rollback.undo_with(put_back)
    rollback.when_written(partial(former.unlink, missing_ok=True))


def _loaded(name: str, image: BakedImage, files: dict[int, Path]) -> bpy.types.Image:
    """An image of the files, under a name of its own."""
    first = files[min(files)]
    made = bpy.data.images.load(str(first))
    if len(files) > 1:
        made.source = "TILED"
        made.filepath_raw = str(first.with_name(first.name.replace(f".{min(files)}.", ".<UDIM>.")))
        for tile in list(made.tiles):  # Blender takes all that lie beside it
            if tile.number not in files:
                made.tiles.remove(tile)
    made.colorspace_settings.is_data = True
    made.use_fake_user = True  # or Blender forgets what nobody has put into a material yet
    made[MADE] = name
    if image.reach:
        made[REACH] = image.reach
    return made


def _load_in_place(name: str, image: BakedImage, files: dict[int, Path]) -> None:
    _put_in_place(_loaded(name, image, files).name, name)


def _put_in_place(made_name: str, name: str) -> None:
    """Gives the image its name, and everything that shows the former one the new one."""
    made, former = bpy.data.images[made_name], bpy.data.images.get(name)
    if former is not None and former != made:
        former.user_remap(made)
        bpy.data.images.remove(former)
    made.name = name
