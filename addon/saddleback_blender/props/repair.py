"""The properties of `saddleback.repair`."""

from __future__ import annotations

from typing import Any

from .kinds import length

REPAIR: dict[str, Any] = {
    "weld_distance": length("Weld Distance", "Join vertices closer than this; 0 joins those at the same place", 0.0),
}
