# SPDX-License-Identifier: GPL-3.0-or-later
"""From paint to density, in numbers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from saddleback_blender.core.fields.density import DensityError, average_to_vertices, channel, shape


@given(arrays.arrays(np.float64, st.integers(1, 20), elements=st.floats(0, 1)), st.booleans(), st.floats(0.25, 4))
def test_density_stays_within_what_can_be_painted(values, invert, contrast):
    try:
        density = shape(values, invert, contrast, 1.0)
    except DensityError as error:
        assert "zero everywhere" in str(error)
        return
    assert ((density >= 0) & (density <= 1)).all()
    order = np.argsort(values)
    steps = np.diff(density[order])
    assert (steps <= 0).all() if invert else (steps >= 0).all()


def test_inverting_attributes_mirrors_them_between_zero_and_their_largest():
    np.testing.assert_allclose(shape(np.array([0.0, 2.0, 5.0]), True, 1.0, None), [5, 3, 0])


def test_colors_beyond_white_are_not_negative_once_inverted():
    np.testing.assert_allclose(shape(np.array([0.25, 3.0]), True, 1.0, 1.0), [0.75, 0])


@pytest.mark.parametrize(
    ("values", "invert", "contrast", "words"),
    [
        ([0.0, 0.0], False, 1.0, "zero everywhere; paint something"),
        ([1.0, 1.0], True, 1.0, "zero everywhere once inverted"),
        ([1.0, -2.0], False, 1.0, "-2 at vertex 1"),
        ([1.0, np.nan], False, 1.0, "nan at vertex 1"),
        ([1.0, 1e200], False, 2.0, "with this contrast is inf at vertex 1"),
        ([1e-200, 0.0], False, 2.0, "with this contrast is zero everywhere"),
    ],
)
def test_useless_density_is_named(values, invert, contrast, words):
    with pytest.raises(DensityError, match=words):
        shape(np.array(values), invert, contrast, 1.0)


def test_luminance_of_white_is_one_and_of_gray_its_value():
    colors = np.array([[1, 1, 1, 0.5], [0.3, 0.3, 0.3, 1]], np.float32)
    np.testing.assert_allclose(channel(colors, "LUMINANCE"), [1, 0.3], rtol=1e-6)
    np.testing.assert_allclose(channel(colors, "A"), [0.5, 1])


@given(st.integers(1, 12), st.integers(0, 40), st.integers(0, 2**32 - 1))
def test_averages_are_means(vertex_count, count, seed):
    rng = np.random.default_rng(seed)
    vertices = rng.integers(0, vertex_count, count)
    values = rng.random((count, 3))
    means = average_to_vertices(values, vertices, vertex_count)
    for vertex in range(vertex_count):
        mine = values[vertices == vertex]
        np.testing.assert_allclose(means[vertex], mine.mean(axis=0) if len(mine) else 0, atol=1e-12)


def test_smaller_by_says_how_much_smaller_cells_are_where_the_paint_is_full():
    painted = np.array([0.0, 0.5, 1.0])
    np.testing.assert_allclose(shape(painted, False, 1.0, 1.0, 4.0), [1.0, 2.5**2, 16.0])
    np.testing.assert_allclose(shape(painted, True, 1.0, 1.0, 4.0), [16.0, 2.5**2, 1.0])
    np.testing.assert_allclose(shape(5 * painted, False, 1.0, None, 4.0), [1.0, 2.5**2, 16.0])  # of any attribute
    np.testing.assert_allclose(shape(painted, False, 2.0, 1.0, 3.0), [1.0, 1.5**2, 9.0])
    np.testing.assert_array_equal(shape(painted, False, 1.0, 1.0), painted)  # as scripts have it: the paint itself
