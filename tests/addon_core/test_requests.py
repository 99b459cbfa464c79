# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces without their loose vertices, and content keys."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from saddleback_blender.core.requests import Surface, digest


@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_spread_and_gather_undo_each_other(vertex_count, seed):
    rng = np.random.default_rng(seed)
    used = np.nonzero(rng.random(vertex_count) < 0.6)[0].astype(np.int32)
    surface = Surface("S", rng.random((len(used), 3)), np.zeros((0, 3), np.int32), vertex_count, used)
    values = rng.random(len(used))
    full = surface.spread(values, np.inf)
    assert full.shape == (vertex_count,) and np.isinf(np.delete(full, used)).all()
    np.testing.assert_array_equal(surface.gather(full), values)
    numbers = surface.compact(np.arange(vertex_count))
    np.testing.assert_array_equal(np.nonzero(numbers >= 0)[0], used)
    np.testing.assert_array_equal(used[numbers[used]], used)


def test_keys_tell_content_and_nothing_else():
    vertices, triangles = np.random.default_rng(0).random((4, 3)), np.array([[0, 1, 2], [1, 3, 2]], np.int32)
    first = Surface("One", vertices, triangles, 4)
    assert first.key == Surface("Two", vertices.copy(), triangles.copy(), 9, np.arange(4, dtype=np.int32)).key
    assert first.key != Surface("One", vertices + 1e-12, triangles, 4).key
    assert first.key != Surface("One", vertices, triangles[::-1].copy(), 4).key


def test_digests_keep_types_and_borders_apart():
    parts = [
        (1, 2),
        (12,),
        ("1", "2"),
        (np.array([1, 2]),),
        (np.array([1.0, 2.0]),),
        (np.array([[1, 2]]),),
        (None,),
        (),
    ]
    assert len({digest(*part) for part in parts}) == len(parts)
    assert digest(np.arange(3), "a") == digest(np.arange(3), "a")
