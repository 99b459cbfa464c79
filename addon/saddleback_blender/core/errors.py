# SPDX-License-Identifier: GPL-3.0-or-later
"""The one exception that carries a sentence for the user."""

from __future__ import annotations


class BadInputError(Exception):
    """Says that what was asked cannot be done; one sentence that names the object and says what to do."""
