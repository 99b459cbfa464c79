# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps what was made in its place where a source's transform is applied, or its origin set.

Blender leaves the children where they are; but what follows the surface is told by places in the source's space, which
are others from then on, and would be transformed twice. It stays as it was made until it is made again.
"""

from __future__ import annotations

import bpy
from bpy.app.handlers import persistent

from .. import jobs, rollback
from ..bridge.outputs.out_collection import outputs_of, was_applied
from ..bridge.tokens import token_of
from ..nodes import FOLLOW, modifier_of, remove_modifier


@persistent  # type: ignore[untyped-decorator]
def settle(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Ends the following of what would jump. After each change in Blender, so that it has to be quick."""
    if depsgraph.mode == "RENDER" or rollback.is_writing():
        return
    changed = [update.id.original for update in depsgraph.updates if update.is_updated_geometry]
    for source in (
        item for item in changed if isinstance(item, bpy.types.Object) and item.type == "MESH" and token_of(item)
    ):
        found = [(item, modifier_of(item, FOLLOW)) for item in outputs_of(source) if was_applied(item, source)]
        for item, modifier in found:
            if modifier is not None:
                remove_modifier(item, modifier)
                jobs.state.line = (
                    f"'{source.name}' has another transform or origin in its mesh: what was made of it stays where it "
                    "is and follows again once it is made again"
                )


def register() -> None:
    """Makes everything of this module known to Blender."""
    bpy.app.handlers.depsgraph_update_post.append(settle)


def unregister() -> None:
    """Takes it back, in the opposite order."""
    bpy.app.handlers.depsgraph_update_post.remove(settle)
