# SPDX-License-Identifier: MIT
"""What `tests.digests` asks the library: every public answer, on the meshes, sites and files of the test suite.

Coordinates that come from sines, powers or normal deviates are rounded to 24 bits, so that every platform asks the
same. A question is marked `portable` when its answer depends on nothing of libm but square roots: that is promised to
be equal to the bit on every platform. Not so exact distances: angles decide where they bend around vertices, and with
sines and arc tangents off by one bit 5 of 140,688 exact arcs were off by one bit, too; nothing else of them was.
"""

from tests.digest_questions import plane, shapes, surfaces
from tests.digest_questions.asking import QUESTIONS, Question, Way

__all__ = ["QUESTIONS", "Question", "Way", "plane", "shapes", "surfaces"]
