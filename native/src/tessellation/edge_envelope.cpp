#include "tessellation/edge_envelope.h"

#include <algorithm>

namespace saddleback {
namespace {

double slope(const EdgeLine& line) { return line.at_end - line.at_start; }

}  // namespace

void lower_envelope(const std::vector<EdgeLine>& lines, std::vector<EdgePiece>& pieces) {
  pieces.clear();
  const EdgeLine* current = &*std::min_element(lines.begin(), lines.end(), [](const EdgeLine& a, const EdgeLine& b) {
    return a.at_start != b.at_start ? a.at_start < b.at_start : a.site < b.site;
  });
  pieces.push_back({current->site, 0});
  while (true) {
    // The first line to cross below the current one: the crossing's place depends on these two lines alone.
    const EdgeLine* next = nullptr;
    double at = 1;
    for (const EdgeLine& line : lines) {
      const double above = line.at_start - current->at_start, end_above = line.at_end - current->at_end;
      if (end_above >= 0 || slope(line) >= slope(*current)) continue;
      const double crossing = above <= 0 ? 0 : above / (above - end_above);
      if (crossing >= 1) continue;
      const bool sooner =
          !next || crossing < at ||
          (crossing == at && (slope(line) < slope(*next) || (slope(line) == slope(*next) && line.site < next->site)));
      if (sooner) next = &line, at = crossing;
    }
    if (!next) break;
    pieces.push_back({next->site, at});
    current = next;
  }
  // At the end, too, a tie belongs to the smaller site: all edges at a mesh vertex name the same site there.
  const EdgeLine& at_end = *std::min_element(lines.begin(), lines.end(), [](const EdgeLine& a, const EdgeLine& b) {
    return a.at_end != b.at_end ? a.at_end < b.at_end : a.site < b.site;
  });
  if (at_end.site != current->site) pieces.push_back({at_end.site, 1});
  const auto last = static_cast<Index>(pieces.size()) - 1;
  for (Index i = 1; i <= last; ++i) {
    pieces[i].begin = std::clamp(pieces[i].begin, pieces[i - 1].begin + k_least_gap, 1 - (last + 1 - i) * k_least_gap);
  }
}

}  // namespace saddleback
