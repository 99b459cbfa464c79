# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines from edges in any order."""

import numpy as np

from saddleback_blender.core.solids.edge_chains import chains


def lines(count, *edges):
    return chains(count, np.array(edges, np.int32).reshape(-1, 2))


def test_open_and_closed_lines_run_as_they_are_numbered():
    assert lines(7, (0, 1), (1, 2), (3, 4), (4, 5), (5, 6), (6, 3)) == [([0, 1, 2], False), ([3, 4, 5, 6], True)]
    assert lines(0) == [] and lines(3) == []


def test_the_order_of_edges_and_of_their_ends_is_no_matter():
    # As a subdivision numbers them: the new ones after the old.
    assert lines(5, (4, 2), (1, 4), (3, 1), (0, 3)) == [([0, 3, 1, 4, 2], False)]
    assert lines(4, (3, 0), (1, 0), (1, 2), (2, 3), (0, 1)) == [([0, 1, 2, 3], True)]


def test_lines_end_where_others_meet_them():
    star = lines(4, (0, 1), (0, 2), (0, 3))
    assert star == [([0, 1], False), ([0, 2], False), ([0, 3], False)]
    assert lines(4, (0, 1), (1, 2), (2, 0), (0, 3)) == [([0, 1, 2, 0], False), ([0, 3], False)]
    assert lines(2, (0, 0), (0, 1), (1, 0)) == [([0, 1], False)]
