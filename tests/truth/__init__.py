# SPDX-License-Identifier: MIT
"""Slow, obvious truths that guard the public answers, and the machine that sends random input past both.

`registry` names the checks and what they guard, `families` makes the random input, `fuzz` runs and makes a
finding small, `table` lists every public entry point with its guards. The other modules hold the truths, one a field
of knowledge, written apart from the library's code and mathematics.
"""
