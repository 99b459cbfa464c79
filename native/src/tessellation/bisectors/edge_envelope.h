#pragma once
// The nearest of several sites along a mesh edge: a lower envelope.

#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// A site's squared distances at the two ends of an edge; in between they differ from another site's by an affine
/// function.
struct EdgeLine {
  Index site;
  double at_start, at_end;
};

/// A piece of an edge to which `site` is nearest: from `begin` (0 for the first) up to the next piece's begin.
struct EdgePiece {
  Index site;
  double begin;
};

/// Breaks keep this far, relative to the edge or to the part of it between two others, from each other and from the
/// ends: no vertex of the diagram coincides with another, ties at mesh vertices included. Far below any length that
/// matters, far above rounding.
inline constexpr double k_least_gap = 1e-9;

/// Lower envelope of the lines, in order along the edge, exactly. Ties go to the smaller site, as though every line lay
/// higher than those of smaller sites by far less than any difference; lines that are nowhere least change nothing, so
/// that two faces that share an edge agree to the bit. Many lines are sorted, and those dropped. O(m log m) for m
/// lines, or O(k m) where some are equal and k are somewhere least; m is 2 or 3 nearly always.
void lower_envelope(std::vector<EdgeLine>& lines, std::vector<EdgePiece>& pieces);

}  // namespace saddleback
