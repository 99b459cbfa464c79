#include "tessellation/bisectors/edge_envelope.h"

#include <algorithm>

#include "predicates/plane_predicates.h"

namespace saddleback {
namespace {

bool is_lower(double value, const EdgeLine& of, double other_value, const EdgeLine& other) {
  return value != other_value ? value < other_value : of.site < other.site;
}

/// Tells whether `a` is the first of two lines to cross below the current one. Where all three meet in one point the
/// line of the greatest site lies highest: the others cross it too late or, when it is the current one, in order of
/// slope.
bool crosses_sooner(const EdgeLine& current, const EdgeLine& a, const EdgeLine& b) {
  const auto point = [](const EdgeLine& line) { return predicates::Point2{line.at_start, line.at_end}; };
  const predicates::Sign turn = predicates::orient_2d(point(current), point(a), point(b));
  if (turn != predicates::Sign::zero) return turn == predicates::Sign::positive;
  const bool same = a.at_start == b.at_start && a.at_end == b.at_end;
  if (same || current.site < std::max(a.site, b.site)) return a.site < b.site;
  return a.at_start < b.at_start || a.at_end > b.at_end;
}

}  // namespace

void lower_envelope(const std::vector<EdgeLine>& lines, std::vector<EdgePiece>& pieces) {
  pieces.clear();
  const EdgeLine* current = &lines.front();
  for (const EdgeLine& line : lines)
    if (is_lower(line.at_start, line, current->at_start, *current)) current = &line;
  pieces.push_back({current->site, 0});
  while (true) {
    const EdgeLine* next = nullptr;
    for (const EdgeLine& line : lines) {
      if (is_lower(line.at_end, line, current->at_end, *current) && (!next || crosses_sooner(*current, line, *next)))
        next = &line;
    }
    if (!next) break;
    // The crossing's place depends on these two lines alone.
    const double above = next->at_start - current->at_start, end_above = next->at_end - current->at_end;
    pieces.push_back({next->site, above <= 0 ? 0 : above / (above - end_above)});
    current = next;
  }
  const auto last = static_cast<Index>(pieces.size()) - 1;
  for (Index i = 1; i <= last; ++i) {
    pieces[i].begin = std::clamp(pieces[i].begin, pieces[i - 1].begin + k_least_gap, 1 - (last + 1 - i) * k_least_gap);
  }
}

}  // namespace saddleback
