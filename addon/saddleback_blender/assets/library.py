# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library: a file with the node groups, its catalogs, and its place in the preferences."""

from __future__ import annotations

import uuid
from pathlib import Path

import bpy
import numpy as np

from .. import compat
from .groups import ASSETS
from .pictures import SIZE, picture

LIBRARY, FILE, CATALOGS = "Saddleback", "saddleback_nodes.blend", "blender_assets.cats.txt"
# One catalog for modifiers and one for materials; the numbers must never change, by which files know them.
CATALOG_NAMES = {"GEOMETRY": "Saddleback/Modifiers", "SHADER": "Saddleback/Materials"}
CATALOG_IDS = {kind: str(uuid.uuid5(uuid.NAMESPACE_URL, f"saddleback:{name}")) for kind, name in CATALOG_NAMES.items()}


def write(folder: Path) -> Path:
    """Writes the node groups as assets, and the list of their catalogs; leaves nothing in the open file.

    Errors: OSError where the folder cannot be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["VERSION 1", ""]
    lines += [f"{CATALOG_IDS[kind]}:{name}:{name.replace('/', '-')}" for kind, name in CATALOG_NAMES.items()]
    (folder / CATALOGS).write_text("\n".join(lines) + "\n", encoding="utf-8")
    groups: list[bpy.types.NodeTree] = []
    # Groups of the open file that were taken from the library have the names that the new ones shall have.
    taken = [(group, group.name) for group in bpy.data.node_groups if group.library is None]
    taken = [(group, name) for group, name in taken if any(name == asset.name for asset in ASSETS)]
    try:
        for group, name in taken:
            group.name = f"{name} (taken)"
        for asset in ASSETS:
            group = asset.make(asset.name)
            groups.append(group)
            group.asset_mark()
            data = group.asset_data
            data.author, data.description = "Saddleback", asset.description
            data.catalog_id = CATALOG_IDS[group.type]
            data.tags.new("saddleback")
            preview = group.preview_ensure()
            preview.image_size = (SIZE, SIZE)
            preview.image_pixels_float.foreach_set(picture(asset.name).astype(np.float32).ravel())
        target, half = folder / FILE, folder / f"{FILE}.part"
        bpy.data.libraries.write(str(half), set(groups), fake_user=True, compress=True)
        half.replace(target)
    except RuntimeError as error:  # what Blender says of files
        raise OSError(str(error)) from error
    finally:
        for group in groups:
            bpy.data.node_groups.remove(group)
        for group, name in taken:
            group.name = name
    return target


def register(folder: Path) -> None:
    """Adds the folder to the preferences' asset libraries, unless it is there."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    if any(Path(known.path) == folder for known in libraries):
        return
    compat.add_asset_library(LIBRARY, folder)
