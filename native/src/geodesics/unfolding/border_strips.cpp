#include "geodesics/unfolding/border_strips.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "support/planar.h"

namespace saddleback {
namespace {

// Shorter rows are crossed as fast face by face.
constexpr Index k_shortest = 32;
// Radians: less is rounding; a side that turns by less than a right angle hides none of its vertices from those that
// see it from within, or all that follow.
constexpr double k_straight = 1e-9, k_most_turned = 1.5;

bool passes(const Mesh& mesh, Index h) {
  return mesh.twin(h) != k_none && (mesh.twin(Mesh::next(h)) == k_none) != (mesh.twin(Mesh::prev(h)) == k_none);
}
Index entered_next(const Mesh& mesh, Index h) {
  const Index behind_left = mesh.twin(Mesh::prev(h));
  return behind_left != k_none ? behind_left : mesh.twin(Mesh::next(h));
}

}  // namespace

std::vector<BorderRow> border_rows(const Mesh& mesh) {
  std::vector<BorderRow> rows;
  if (mesh.boundary_loops().empty()) return rows;
  enum : std::uint8_t { does_not_pass, is_first, follows, is_in_row };
  std::vector<std::uint8_t> states(mesh.halfedge_count(), does_not_pass);
  for (Index h = 0; h < mesh.halfedge_count(); ++h)
    if (passes(mesh, h)) states[h] = is_first;
  for (Index h = 0; h < mesh.halfedge_count(); ++h)
    if (const Index next = states[h] == does_not_pass ? k_none : entered_next(mesh, h);
        next != k_none && states[next] != does_not_pass)
      states[next] = follows;
  for (const std::uint8_t state : {is_first, follows}) {  // those that are left follow each other in rings
    for (Index first = 0; first < mesh.halfedge_count(); ++first) {
      if (states[first] != state) continue;
      BorderRow row{{}, state == follows};
      for (Index h = first; states[h] == is_first || states[h] == follows; h = entered_next(mesh, h)) {
        states[h] = is_in_row;
        row.halfedges.push_back(h);
      }
      if (static_cast<Index>(row.halfedges.size()) >= k_shortest) rows.push_back(std::move(row));
    }
  }
  return rows;
}

/// A side while it is laid.
class BorderStrips::LaidSide {
 public:
  /// `inwards` is the sign of turns towards the strip.
  LaidSide(const Vec2& place, Index node, double inwards) : corners_{{place, 0, node, -1}}, inwards_(inwards) {}
  const std::vector<Corner>& corners() const { return corners_; }
  const Vec2& last() const { return corners_.back().place; }
  bool turns_inwards() const { return turned_ >= 0; }

  /// Returns false where that would turn the other way, or back.
  bool add(const Vec2& place, Index node, Index step) {
    const Vec2 edge = place - last();
    if (corners_.size() > 1) {
      const Vec2 before = last() - corners_[corners_.size() - 2].place;
      const double turn = inwards_ * std::atan2(cross(before, edge), before.dot(edge));
      if (std::abs(turn) > k_straight) {
        if (turn * turned_ < 0 || std::abs(turned_ + turn) > k_most_turned) return false;
        turned_ += turn;
      }
    }
    corners_.push_back({place, corners_.back().along + edge.norm(), node, step});
    return true;
  }

 private:
  std::vector<Corner> corners_;
  double inwards_, turned_ = 0;
};

BorderStrips::BorderStrips(const Unfolding& unfolding, std::span<const Index> edge_of, std::span<const Index> nodes,
                           double unit)
    : edge_of_(edge_of), nodes_(nodes), unit_(unit) {
  for (const BorderRow& row : border_rows(unfolding.mesh())) {
    places_.resize(edge_of.size());
    const auto count = static_cast<Index>(row.halfedges.size());
    for (Index first = 0; first < count;) first += lay(unfolding, row.halfedges, first, row.is_ring && first == 0);
  }
  if (!empty()) measure_borders(unfolding.mesh());
  edge_of_ = nodes_ = {};
}

/// Lays a strip from a half-edge of a row on, twice round where a ring is one strip, or none that is too short. Returns
/// how many of the row that was, at least 1.
Index BorderStrips::lay(const Unfolding& unfolding, std::span<const Index> row, Index first, bool is_ring) {
  const Mesh& mesh = unfolding.mesh();
  const auto count = static_cast<Index>(row.size()), room = is_ring ? 2 * count : count - first;
  const Index start = row[first];
  LaidSide left({0, 0}, nodes_[mesh.from(start)], -1),
      right({mesh.length(start) / unit_, 0}, nodes_[mesh.to(start)], 1);
  std::vector<Entry> entries;
  Strip strip;
  for (Index step = 0; step < room; ++step) {
    const Index h = row[(first + step) % count];
    const Vec2 along = right.last() - left.last(), far = unfolding.apex(h) / mesh.length(h);
    const Vec2 apex = left.last() + far.x() * along + far.y() * Vec2(-along.y(), along.x());
    entries.push_back({edge_of_[h], static_cast<Index>(left.corners().size()) - 1});
    if (is_ring && step == count) {
      strip.sides[0].period = static_cast<Index>(left.corners().size()) - 1;
      strip.sides[1].period = static_cast<Index>(right.corners().size()) - 1;
    }
    if (!(mesh.twin(Mesh::prev(h)) != k_none ? right : left).add(apex, nodes_[mesh.apex(h)], step)) {
      entries.pop_back();
      break;
    }
  }
  const auto laid = static_cast<Index>(entries.size()), covered = std::min(laid, count);
  if (laid < k_shortest) return std::max<Index>(laid, 1);
  strip.exit = edge_of_[entered_next(mesh, row[(first + laid - 1) % count])];
  keep(strip, left, right, entries, covered);
  return covered;
}

/// Keeps what was laid; windows that enter one of the first `covered` faces are in this strip.
void BorderStrips::keep(Strip strip, const LaidSide& left, const LaidSide& right, std::span<const Entry> entries,
                        Index covered) {
  strip.begin = static_cast<Index>(entries_.size());
  strip.end = strip.begin + static_cast<Index>(entries.size());
  for (const LaidSide* laid_side : {&left, &right}) {
    Side& side = strip.sides[laid_side == &right];
    side.begin = static_cast<Index>(corners_.size());
    corners_.insert(corners_.end(), laid_side->corners().begin(), laid_side->corners().end());
    side.end = static_cast<Index>(corners_.size());
    side.turns_inwards = laid_side->turns_inwards();
  }
  for (const auto& [edge, at] : entries) {
    const auto entry = static_cast<Index>(entries_.size());
    if (entry - strip.begin < covered) places_[edge] = {static_cast<Index>(strips_.size()), entry};
    entries_.push_back({edge, strip.sides[0].begin + at});
  }
  strips_.push_back(strip);
}

void BorderStrips::measure_borders(const Mesh& mesh) {
  along_border_.resize(nodes_.size());
  double along = 0;
  for (const std::vector<Index>& loop : mesh.boundary_loops()) {
    for (const Index vertex : loop) {
      along_border_[nodes_[vertex]] = along;
      along += mesh.length(mesh.first_halfedge(vertex)) / unit_;
    }
    loop_ends_.push_back(along);
  }
}

}  // namespace saddleback
