#include "tessellation/bisectors/edge_envelope.h"

#include <algorithm>
#include <utility>

#include "predicates/plane_predicates.h"

namespace saddleback {
namespace {

bool is_lower(double value, const EdgeLine& of, double other_value, const EdgeLine& other) {
  return value != other_value ? value < other_value : of.site < other.site;
}

/// Where lines are points, of their values at the two ends, their lower envelope is a convex chain: positive where it
/// turns toward what lies above.
predicates::Sign turn_of(const EdgeLine& a, const EdgeLine& b, const EdgeLine& c) {
  const auto point = [](const EdgeLine& line) { return predicates::Point2{line.at_start, line.at_end}; };
  return predicates::orient_2d(point(a), point(b), point(c));
}

/// Tells whether `a` is the first of two lines to cross below the current one. Where all three meet in one point the
/// line of the greatest site lies highest: the others cross it too late or, when it is the current one, in order of
/// slope.
bool crosses_sooner(const EdgeLine& current, const EdgeLine& a, const EdgeLine& b) {
  const predicates::Sign turn = turn_of(current, a, b);
  if (turn != predicates::Sign::zero) return turn == predicates::Sign::positive;
  const bool same = a.at_start == b.at_start && a.at_end == b.at_end;
  if (same || current.site < std::max(a.site, b.site)) return a.site < b.site;
  return a.at_start < b.at_start || a.at_end > b.at_end;
}

/// Leaves those of many lines that are somewhere least, in order along the edge. False where some are equal at a place
/// that matters; then all are left. O(m log m).
bool leave_lowest(std::vector<EdgeLine>& lines) {
  const auto by_values = [](const EdgeLine& a, const EdgeLine& b) {
    return std::pair(a.at_start, a.at_end) < std::pair(b.at_start, b.at_end);
  };
  std::ranges::sort(lines, by_values);
  std::vector<EdgeLine> chain;
  for (const EdgeLine& line : lines) {
    if (!chain.empty() && line.at_end >= chain.back().at_end) {
      if (line.at_end == chain.back().at_end || line.at_start == chain.front().at_start) return false;
      continue;
    }
    while (chain.size() > 1) {
      const predicates::Sign turn = turn_of(chain[chain.size() - 2], chain.back(), line);
      if (turn == predicates::Sign::zero) return false;
      if (turn == predicates::Sign::positive) break;
      chain.pop_back();
    }
    chain.push_back(line);
  }
  lines = std::move(chain);
  return true;
}

/// The second of two neighbors on the envelope. Where they cross depends on these two lines alone.
EdgePiece piece_after(const EdgeLine& current, const EdgeLine& next) {
  const double above = next.at_start - current.at_start, end_above = next.at_end - current.at_end;
  return {next.site, above <= 0 ? 0 : above / (above - end_above)};
}

/// Goes from line to line: to the one that crosses the current one first.
void wrap(const std::vector<EdgeLine>& lines, std::vector<EdgePiece>& pieces) {
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
    if (!next) return;
    pieces.push_back(piece_after(*current, *next));
    current = next;
  }
}

}  // namespace

void lower_envelope(std::vector<EdgeLine>& lines, std::vector<EdgePiece>& pieces) {
  constexpr std::size_t k_many = 12;
  pieces.clear();
  if (lines.size() > k_many && leave_lowest(lines)) {
    pieces.push_back({lines.front().site, 0});
    for (std::size_t i = 1; i < lines.size(); ++i) pieces.push_back(piece_after(lines[i - 1], lines[i]));
  } else {
    wrap(lines, pieces);
  }
  const auto last = static_cast<Index>(pieces.size()) - 1;
  for (Index i = 1; i <= last; ++i) {
    pieces[i].begin = std::clamp(pieces[i].begin, pieces[i - 1].begin + k_least_gap, 1 - (last + 1 - i) * k_least_gap);
  }
}

}  // namespace saddleback
