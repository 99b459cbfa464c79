# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what was made in its place where a transform is applied, the source's or its own, or an origin set.

Blender leaves the children where they are; but what follows the surface is told by places in the source's space, and
follows in its own, which are others from then on: it would be transformed twice. It stays as it was made until it is
made again.
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .. import jobs, rollback
from ..bridge.outputs.out_collection import marks_of, outputs_of, was_applied, was_applied_itself
from ..bridge.tokens import OWN_MARKS, token_of
from ..nodes import FOLLOW, modifier_of, remove_modifier

_last: dict[str, bytes] = {}  # by the names of sources and outputs


@persistent  # type: ignore[untyped-decorator]
def settle(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Ends the following of what would jump. After each change in Blender, so that it has to be quick."""
    if depsgraph.mode == "RENDER" or rollback.is_writing():
        return
    changed = [update.id.original for update in depsgraph.updates if update.is_updated_geometry]
    # Chosen first: a node group among them is gone once the last modifier with it is.
    for item in [item for item in changed if isinstance(item, bpy.types.Object) and item.type in ("MESH", "CURVE")]:
        if (token_of(item) or OWN_MARKS in item) and _is_new(item):
            for output in [*outputs_of(item), item]:
                _leave(output, item)


@persistent  # type: ignore[untyped-decorator]
def settle_again(*_given: object) -> None:
    """Does so after Undo and Redo: a step holds what was before following ended, and updates need not name it."""
    _last.clear()
    for item in bpy.data.objects:
        if OWN_MARKS in item and item.parent is not None and item.parent.type == "MESH":
            _leave(item, item.parent)


def _is_new(item: bpy.types.Object) -> bool:
    """Tells whether points are others than when it was asked last: not where modifiers alone move them."""
    marks = marks_of(item).tobytes()
    is_new = _last.get(item.name) != marks
    _last[item.name] = marks
    return is_new


def _leave(item: bpy.types.Object, changed: bpy.types.Object) -> None:
    """Ends the following of an output where its transform was applied, or its source's; one of both is `changed`."""
    modifier = modifier_of(item, FOLLOW)
    if modifier is not None and (was_applied_itself(item) or (item != changed and was_applied(item, changed))):
        remove_modifier(item, modifier)
        jobs.state.line = (
            f"'{changed.name}' has another transform or origin in its {changed.type.lower()}: what was made stays "
            "where it is and follows again once it is made again"
        )


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.app.handlers.depsgraph_update_post.append(settle)
    for handlers in (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post):
        handlers.append(settle_again)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    for handlers in (bpy.app.handlers.redo_post, bpy.app.handlers.undo_post):
        handlers.remove(settle_again)
    bpy.app.handlers.depsgraph_update_post.remove(settle)
    _last.clear()
