# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads how often a field turns about a singularity: from a number, a fraction, or the name of an empty."""

from __future__ import annotations

import re
from fractions import Fraction

NUMBER = re.compile(r"[-+\u2212]?\d+\s*/\s*\d+|[-+\u2212]?\d*\.?\d+")
COPY = re.compile(r"\.\d{3,}$")  # what Blender adds to a name that is taken
FINEST = 1000  # of denominators


def index_of_name(name: str) -> Fraction | None:
    """`Singularity -1/2.003` -> -1/2: the first number in a name, None where it has none."""
    found = NUMBER.search(COPY.sub("", name))
    return None if found is None else as_index(found[0])


def as_index(value: object) -> Fraction | None:
    """A number, or a text like "1/2" -> the fraction, None for anything else. Decimals are taken as near fractions."""
    try:
        text = str(value).replace("\u2212", "-").replace(" ", "")
        return Fraction(text).limit_denominator(FINEST)
    except (ValueError, ZeroDivisionError):
        return None
