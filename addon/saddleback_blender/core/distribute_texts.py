# SPDX-License-Identifier: GPL-3.0-or-later
"""Distributions of shapes in a person's words: how it went, how dense it is, what went wrong and what to do."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from .settings import DistributeSettings
from .shapes.shape_sizes import MOST_ROOM, Laid
from .shapes.shape_templates import ShapeTemplate

# What the library's reasons to stop mean to a person; that every count is met needs no word.
STOPS = {
    "full": "nothing more fits",
    "unproven": "no more room was found, but whether there is any cannot be told for shapes or gaps so large",
    "tired": "no more room was found",
}
REJECTIONS = {
    "collision": "met another",
    "boundary": "went over the border",
    "forbidden": "lay where none may",
    "fold": "would have folded",
    "stretched": "would have been stretched",
}
FAULTS = {
    "not_laid": "could not be laid on the surface",
    "open": "has no closed outline",
    "crossing": "crosses",
    "nesting": "lies within",
    "overturned": "is turned over in a place",
    "incomplete": "is not all there",
    "covered_twice": "overlaps",
}
MOST_FAULTS = 8  # that are told
NO_SHARE = 5e-5  # of the surface: less is not worth a word


def told(laid: Laid, counts: np.ndarray, settings: DistributeSettings) -> str:
    """One line: how many, of which class, why no more."""
    total = int(counts.sum())
    text = "1 shape" if total == 1 else f"{total:,} shapes"
    if total < settings.count and not settings.maximal and not laid.is_about:
        text = f"{total:,} of {settings.count:,} shapes"
    if len(counts) > 1:
        names = (f"{count:,} {template.name}" for count, template in zip(counts, laid.templates, strict=True))
        text += f" ({', '.join(names)})"
    stop = STOPS.get(str(laid.result.stop_reason), "")
    return f"{text}, {stop}" if stop else text


def figures(laid: Laid, is_maximal: bool) -> tuple[str, ...]:
    """Returns how dense it is, why others were refused, what is proved."""
    placements = laid.result.placements
    areas = np.array([shape.area for shape in laid.shapes])[placements.shape] * placements.scale**2
    lines = [f"Covered: {areas.sum() / laid.mesh.area:.1%}; radius of the largest {laid.size:.3g}"]
    causes = _causes(laid)
    if causes:
        lines.append(f"Tries refused: {causes}")
    certificate = laid.result.certificate
    if is_maximal and certificate is not None:
        share = certificate.uncertified_area / laid.mesh.area
        where = f", on all but {max(share, 1e-4):.2%} of the surface" if share > NO_SHARE else ""
        if laid.result.stop_reason == "unproven":
            lines.append(f"Not proved full: shapes or gaps are too large for how {share:.0%} of the surface bends")
        else:
            lines.append(f"Proved full: none fits with {certificate.tolerance:.2g} to spare{where}")
    return tuple(lines)


def warnings_of(laid: Laid, mapped: Any, settings: DistributeSettings) -> tuple[str, ...]:
    """Returns what a person may not have wanted."""
    found = []
    if len(mapped.failures):
        found.append(f"{len(mapped.failures)} shapes could not be laid out and are missing in what was made")
    placed = len(laid.result.placements)
    if settings.maximal or laid.is_about:
        return tuple(found)
    if placed < settings.count:
        more = "" if settings.packing == 1.0 or settings.density_source != "UNIFORM" else ", or raise Packing"
        left = settings.count - placed
        found.append(f"{left:,} of {settings.count:,} shapes found no room; make them smaller{more}")
    elif settings.packing > 0 and settings.size and settings.density_source == "UNIFORM":
        found.append(
            "Shapes are laid side by side and the count was met: what they did not reach is bare. Raise Count, set "
            "Size to 0, or choose Fill"
        )
    return tuple(found)


def made_smaller(count: int) -> tuple[str, ...]:
    """Tells how many shapes that overlap were drawn smaller, if any."""
    are = "1 shape is" if count == 1 else f"{count:,} shapes are"
    return (f"{are} drawn smaller, not to pass through others",) if count else ()


def filled(count: int) -> tuple[str, ...]:
    """Tells how many small shapes lie in gaps, if any."""
    lie = "1 small shape lies" if count == 1 else f"{count:,} small shapes lie"
    return (f"{lie} where skin would be bare",) if count else ()


def unfilled(most: int) -> tuple[str, ...]:
    """Warns of gaps that are left, since copies in all of them would have more than so many faces, if any."""
    return (f"Gaps are left: with small shapes in all there would be over {most:,} faces; lay fewer",) if most else ()


def left_out(count: int) -> tuple[str, ...]:
    """Warns of shapes that would pass through others however small they were, if any."""
    are = "1 shape is" if count == 1 else f"{count:,} shapes are"
    return (f"{are} missing that would pass through others at any size, where the surface does",) if count else ()


def no_room(laid: Laid) -> str:
    """Says why not one shape is there, and what to do."""
    causes = _causes(laid)
    return (
        f"no shape found room at a radius of {laid.size:.3g}{f' (tries refused: {causes})' if causes else ''}; make "
        "them smaller, or the gap, or keep them off less of the surface"
    )


def too_small(size: float) -> str:
    """Says why shapes of such a size are not laid."""
    return (
        f"at a radius of {size:.3g} there is room for more than {MOST_ROOM / 1e6:.0f} million shapes, too many to look "
        "for; make them larger, or vary their sizes less"
    )


def _causes(laid: Laid) -> str:
    refused = {REJECTIONS[name]: number for name, number in laid.result.rejections.items() if number}
    return ", ".join(f"{number:,} {words}" for words, number in refused.items())


def refusal(text: str, templates: Sequence[ShapeTemplate]) -> str:
    """The library's refusal in the artist's words: shapes by their names, settings as the panel calls them."""

    def name(found: re.Match[str]) -> str:
        return f"'{templates[int(found[1])].name}'"

    text = re.sub(r"\d+\.\d{4,}(e[+-]?\d+)?", lambda found: f"{float(found[0]):.4g}", text)
    text = re.sub(r"\bshape (\d+)", name, text)
    if text.startswith("size: "):
        return f"{text.removeprefix('size: ')}; make Size smaller"
    if text.startswith("gap is "):
        return f"{text}; make Gap or Size smaller"
    if text.startswith("forbidden: "):
        return "the group Keep Off leaves no place for a shape; paint less of it"
    return re.sub(r"^\w+: ", "", text)


def outline_refusal(text: str) -> str:
    """Says why the library takes no outline or image, in the artist's words."""
    if "meets the edge" in text:
        return "its outline crosses or touches itself, or another of its outlines; pull them apart"
    if "no pixel is over" in text:
        return "nothing in it is opaque or dark"
    if "every pixel is over" in text:
        return "all of it is opaque or dark"
    return re.sub(r"^\w+: ", "", text)


def fault(kind: str, first: int, second: int | None, where: tuple[float, float, float]) -> str:
    """One fault that the check found."""
    other = "" if second is None else f" shape {second}"
    place = ", ".join(f"{coordinate:.4g}" for coordinate in where)
    return f"Shape {first} {FAULTS[kind]}{other} at ({place})"
