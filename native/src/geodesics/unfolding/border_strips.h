#pragma once
// Strips of faces between two borders, as rings of needles and fans are made of, laid flat as a whole.

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "geodesics/unfolding/unfolding.h"

namespace saddleback {

/// A row of faces that a window crosses one after the other, since the third side of each lies on the border, in one
/// plane. Rows are cut where a side turns the other way, or turns back. A side of a strip of this kind is seen from
/// within in one go, and distances to its vertices grow by less than the side does.
class BorderStrips {
 public:
  /// A vertex on a side of a strip.
  struct Corner {
    Vec2 place;    ///< in units
    double along;  ///< the side, from its first corner
    Index node;
    Index step;  ///< number of the face whose far corner it is; -1 for the first on either side
  };
  struct Side {
    Index begin = 0, end = 0;   ///< corners
    Index period = 0;           ///< the same vertices follow again so many corners later; 0 for never
    bool turns_inwards = true;  ///< or goes straight on
  };
  struct Strip {
    Index begin = 0, end = 0;   ///< entries, one a face
    std::array<Side, 2> sides;  ///< left and right
    Index exit = k_none;        ///< edge behind the last face; negative at the border
  };
  struct Entry {
    Index edge;  ///< that is entered
    Index left;  ///< corner where it begins
  };
  struct Place {
    Index strip = k_none, entry = 0;
  };

  /// Half-edges are counted by `edge_of` them, vertices by `nodes`; lengths are in units. O(F), O(1) without a border.
  BorderStrips(const Unfolding& unfolding, std::span<const Index> edge_of, std::span<const Index> nodes, double unit);

  bool empty() const { return strips_.empty(); }
  const Place& place(Index edge) const { return places_[edge]; }
  const Strip& strip(Index strip) const { return strips_[strip]; }
  const Entry& entry(Index entry) const { return entries_[entry]; }
  const Corner& corner(Index corner) const { return corners_[corner]; }
  /// The last corners of the left side (0) and the right one (1) that faces before an entry have come to.
  Index corner_at(const Strip& strip, Index entry, int side) const {
    const Index left = entries_[entry].left;
    return side == 0 ? left : strip.sides[1].begin + (entry - strip.begin) - (left - strip.sides[0].begin);
  }
  /// Returns where a node of the border is, in units along all loops, one after the other.
  double along_border(Index node) const { return along_border_[node]; }
  /// Returns where the loop begins and ends that a place is on.
  std::pair<double, double> loop_at(double along_border) const {
    const auto end = std::ranges::upper_bound(loop_ends_, along_border);
    return {end == loop_ends_.begin() ? 0 : *std::prev(end), *end};
  }

 private:
  class LaidSide;
  Index lay(const Unfolding& unfolding, std::span<const Index> row, Index first, bool is_ring);
  void keep(Strip strip, const LaidSide& left, const LaidSide& right, std::span<const Entry> entries, Index covered);
  void measure_borders(const Mesh& mesh);

  std::span<const Index> edge_of_, nodes_;  ///< while it is built
  double unit_;
  std::vector<Place> places_;  ///< per edge
  std::vector<Strip> strips_;
  std::vector<Entry> entries_;
  std::vector<Corner> corners_;
  std::vector<double> along_border_;  ///< per node
  std::vector<double> loop_ends_;
};

/// A row of half-edges that a window enters one after the other, each face having one side on the border.
struct BorderRow {
  std::vector<Index> halfedges;
  bool is_ring;
};
/// Returns the rows that are long enough for strips, both ways. O(F), O(1) without a border.
std::vector<BorderRow> border_rows(const Mesh& mesh);

}  // namespace saddleback
