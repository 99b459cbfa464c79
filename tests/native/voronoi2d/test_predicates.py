# SPDX-License-Identifier: MIT
"""The predicates against exact rational arithmetic."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from saddleback._saddleback import predicates

# Far from under- and overflow, and with many low bits in use.
coordinates = st.one_of(
    st.integers(-3, 3).map(float),
    st.floats(-1e10, 1e10, allow_subnormal=False).filter(lambda x: x == 0 or abs(x) > 1e-30),
    st.integers(-4, 4).map(lambda i: 0.5 + i * 2.0**-53),
    st.integers(-4, 4).map(lambda i: 12.0 + i * 2.0**-49),
)
points2 = st.tuples(coordinates, coordinates)
points3 = st.tuples(coordinates, coordinates, coordinates)


def sign(value):
    return (value > 0) - (value < 0)


def cross(o, p, q, i=0, j=1):
    o, p, q = ([Fraction(x) for x in point] for point in (o, p, q))
    return (p[i] - o[i]) * (q[j] - o[j]) - (p[j] - o[j]) * (q[i] - o[i])


def in_circle(a, b, c, d):
    rows = [[Fraction(x) - Fraction(y) for x, y in zip(p, d, strict=True)] for p in (a, b, c)]
    (ax, ay), (bx, by), (cx, cy) = rows
    lift = [x * x + y * y for x, y in rows]
    return lift[0] * (bx * cy - by * cx) + lift[1] * (cx * ay - cy * ax) + lift[2] * (ax * by - ay * bx)


@given(points2, points2, points2)
def test_orientation_is_exact(a, b, c):
    assert predicates.orient_2d([a], [b], [c])[0] == sign(cross(a, b, c))


@given(points2, points2, points2, points2)
def test_circle_is_exact(a, b, c, d):
    assert predicates.in_circle([a], [b], [c], [d])[0] == sign(in_circle(a, b, c, d))


@given(points3, points3, points3)
def test_collinearity_is_exact(a, b, c):
    exact = all(cross(a, b, c, i, j) == 0 for i, j in ((0, 1), (1, 2), (2, 0)))
    assert bool(predicates.collinear_3d([a], [b], [c])[0]) == exact


@given(points3, st.integers(-8, 8), st.integers(-8, 8))
def test_whole_multiples_of_a_small_step_are_collinear(step, m, n):
    step = tuple(float(np.float16(x)) if abs(x) < 6e4 else 1.0 for x in step)  # so that the products are exact
    a, b, c = ([k * x for x in step] for k in (0, m, n))
    assert predicates.collinear_3d([a], [b], [c])[0] == 1


def test_grid_of_neighboring_doubles_about_a_line():
    """Shewchuk's picture: points near (0.5, 0.5) against the line through (12, 12) and (24, 24)."""
    i, j = (k.ravel() for k in np.meshgrid(np.arange(32), np.arange(32)))
    near = np.column_stack([0.5 + i * 2.0**-53, 0.5 + j * 2.0**-53])
    ends = [np.broadcast_to([x, x], near.shape) for x in (12.0, 24.0)]
    found = predicates.orient_2d(near, *ends)
    expected = [sign(cross(p, q, r)) for p, q, r in zip(near, *ends, strict=True)]
    assert found.tolist() == expected
    assert (found == 0).any()


def test_grid_of_neighboring_doubles_about_a_circle():
    i, j = (k.ravel() for k in np.meshgrid(np.arange(-8, 8), np.arange(-8, 8)))
    near = np.column_stack([1.0 + i * 2.0**-52, j * 2.0**-52])
    a, b, c = (np.broadcast_to(p, near.shape) for p in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)))
    expected = [sign(in_circle(*points)) for points in zip(a, b, c, near, strict=True)]
    assert predicates.in_circle(a, b, c, near).tolist() == expected
    assert {-1, 0, 1} <= set(expected)


@given(points2, st.integers(-1000, 500))
def test_lengths_are_right_to_the_last_place(vector, exponent):
    x, y = (float(np.ldexp(value, exponent)) for value in vector)
    length = Fraction(float(predicates.lengths_2d([(x, y)])[0]))
    unit = Fraction(2) ** -52 * length + Fraction(5e-324)
    square = Fraction(x) ** 2 + Fraction(y) ** 2
    assert max(length - unit, Fraction(0)) ** 2 <= square <= (length + unit) ** 2
