# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what was made in its place where a source's transform is applied, or its origin set.

Blender leaves the children where they are; but what follows the surface is told by places in the source's space, which
are others from then on, and would be transformed twice. It stays as it was made until it is made again.
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .. import jobs, rollback
from ..bridge.outputs.out_collection import marks_of, outputs_of, was_applied
from ..bridge.tokens import token_of
from ..nodes import FOLLOW, modifier_of, remove_modifier

_last: dict[str, bytes] = {}  # by the names of sources


@persistent  # type: ignore[untyped-decorator]
def settle(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Ends the following of what would jump. After each change in Blender, so that it has to be quick."""
    if depsgraph.mode == "RENDER" or rollback.is_writing():
        return
    changed = [update.id.original for update in depsgraph.updates if update.is_updated_geometry]
    for item in changed:
        if isinstance(item, bpy.types.Object) and item.type == "MESH" and token_of(item) and _is_new(item):
            _end_following(item)


def _is_new(source: bpy.types.Object) -> bool:
    """Tells whether a mesh is another than when it was asked last: not where modifiers alone move it in each frame."""
    marks = marks_of(source).tobytes()
    is_new = _last.get(source.name) != marks
    _last[source.name] = marks
    return is_new


def _end_following(source: bpy.types.Object) -> None:
    for item in outputs_of(source):
        modifier = modifier_of(item, FOLLOW)
        if modifier is not None and was_applied(item, source):
            remove_modifier(item, modifier)
            jobs.state.line = (
                f"'{source.name}' has another transform or origin in its mesh: what was made of it stays where it is "
                "and follows again once it is made again"
            )


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.app.handlers.depsgraph_update_post.append(settle)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.app.handlers.depsgraph_update_post.remove(settle)
    _last.clear()
