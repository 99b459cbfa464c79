#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"

namespace saddleback {
namespace {

void check_cells(std::span<const Triangle> triangles, std::span<const Index> triangle_cell) {
  if (triangle_cell.size() == triangles.size()) return;
  throw InputError(message("triangle_cell: wanted one cell for each of the ", triangles.size(), " triangles, got ",
                           triangle_cell.size()));
}

CellBoundary find_boundary(const CornerTable& table, std::span<const Index> triangle_cell) {
  CellBoundary result;
  for (Index vertex = 0; vertex < table.vertex_count(); ++vertex) {
    const auto corners = table.at(vertex);
    const auto cell_of = [&](const CornerTable::Corner& corner) { return triangle_cell[corner.triangle]; };
    const auto is_first = [&](const CornerTable::Corner& corner) { return cell_of(corner) == cell_of(corners[0]); };
    if (std::ranges::all_of(corners, is_first)) continue;
    const SharedEdges shared(corners);
    for (const CornerTable::Corner& corner : corners) {
      shared.any(corner, [&](const CornerTable::Corner& other) {
        // Edges are met from both ends and by both triangles: once is enough.
        const bool is_met_again =
            other.previous == corner.next ? vertex > corner.next : other.triangle < corner.triangle;
        if (cell_of(corner) == cell_of(other) || is_met_again) return false;
        result.segments.push_back({vertex, corner.next});
        result.cells.push_back({cell_of(corner), cell_of(other)});
        return false;
      });
    }
  }
  return result;
}

double squared_distance_to(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a, to_point = point - a;
  const double squared_length = along.squaredNorm();
  const double share = squared_length > 0 ? std::clamp(to_point.dot(along) / squared_length, 0.0, 1.0) : 0;
  return (to_point - share * along).squaredNorm();
}

/// The nearest segment found so far for each vertex.
class BoundarySearch {
 public:
  BoundarySearch(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                 std::span<const Index> triangle_cell)
      : vertices_(vertices),
        table_(triangles, static_cast<Index>(vertices.size())),
        boundary_(find_boundary(table_, triangle_cell)),
        cells_(vertices.size(), k_none),
        nearest_(vertices.size(), k_none),
        squared_(vertices.size(), std::numeric_limits<double>::infinity()),
        first_(vertices.size() + 1, 0),
        at_(2 * boundary_.segments.size()) {
    for (std::size_t t = 0; t < triangles.size(); ++t)
      for (const Index v : triangles[t]) cells_[v] = triangle_cell[t];
    for (const auto& ends : boundary_.segments)
      for (const Index v : ends) ++first_[v + 1], squared_[v] = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) first_[v + 1] += first_[v];
    std::vector<Index> cursor(first_.begin(), first_.end() - 1);
    for (Index i = 0; i < static_cast<Index>(boundary_.segments.size()); ++i)
      for (const Index v : boundary_.segments[i]) at_[cursor[v]++] = i;
  }

  /// Ring after ring, from the vertices beside the boundary on.
  void spread(double limit, const JobStage& stage) {
    std::vector<Index> ring, next;
    std::vector<std::uint8_t> waits(vertices_.size(), 0);
    const auto reach = [&](Index vertex) {
      follow_boundary(vertex);
      if (!waits[vertex]) next.push_back(vertex);
      waits[vertex] = 1;
    };
    for (Index v = 0; v < static_cast<Index>(vertices_.size()); ++v) {
      stage.check();
      if (offer_neighbors_segments(v)) reach(v);
    }
    while (!next.empty()) {
      ring.swap(next);
      next.clear();
      for (const Index v : ring) waits[v] = 0;
      for (const Index v : ring) {
        stage.check();
        if (squared_[v] < limit * limit)
          visit_neighbors(v, [&](Index w) {
            if (!touches(w) && nearest_[w] != nearest_[v] && offer(w, nearest_[v])) reach(w);
          });
      }
    }
  }

  struct Nearest {
    Index segment;
    double squared;
    bool operator<(const Nearest& other) const { return squared < other.squared; }
  };

  /// The segment nearest to a place amid some vertices of a cell: the boundary is followed from what each of them
  /// knows, for these may be sides of the cell with a farther place between.
  Nearest nearest_amid(const Vec3& middle, std::span<const Index> around, Index cell) const {
    Nearest best{k_none, std::numeric_limits<double>::infinity()};
    Index last = k_none;
    for (const Index v : around) {
      Nearest start{k_none, std::numeric_limits<double>::infinity()};
      if (nearest_[v] != k_none)
        start = to_segment(middle, nearest_[v]);
      else if (touches(v))
        start = nearest_at(middle, v, cell);
      if (start.segment != last) best = std::min(best, followed(middle, start, cell));
      last = start.segment;
    }
    return best;
  }

  /// Takes over what a neighbor knows where that is nearer to an added vertex, for between them the nearest side of the
  /// cell may change. Returns whether it is.
  bool offer_from(Index neighbor, Index added, const Vec3& place, Index cell) {
    const Index segment = nearest_[neighbor];
    if (segment == k_none || segment == nearest_[added]) return false;
    const Nearest found = to_segment(place, segment);
    if (!(found.squared < squared_[added])) return false;
    const Nearest best = followed(place, found, cell);
    nearest_[added] = best.segment;
    squared_[added] = best.squared;
    return true;
  }

  /// Makes room for a vertex inside a cell.
  void add_vertex(const Nearest& nearest) {
    nearest_.push_back(nearest.segment);
    squared_.push_back(nearest.squared);
  }

  double distance(Index vertex) const { return std::sqrt(squared_[vertex]); }

  std::vector<double> distances() {
    for (double& value : squared_) value = std::sqrt(value);
    return std::move(squared_);
  }

 private:
  bool bounds(Index segment, Index cell) const {
    return boundary_.cells[segment][0] == cell || boundary_.cells[segment][1] == cell;
  }

  /// Tells whether a vertex lies on the boundary; those that were added do not.
  bool touches(Index vertex) const {
    return vertex < static_cast<Index>(vertices_.size()) && first_[vertex] < first_[vertex + 1];
  }

  Nearest to_segment(const Vec3& place, Index segment) const {
    const auto& [from, to] = boundary_.segments[segment];
    return {segment, squared_distance_to(place, vertices_[from], vertices_[to])};
  }

  /// The nearest of a cell's segments at a vertex of the boundary.
  Nearest nearest_at(const Vec3& place, Index vertex, Index cell) const {
    Nearest best{k_none, std::numeric_limits<double>::infinity()};
    for (Index i = first_[vertex]; i < first_[vertex + 1]; ++i)
      if (bounds(at_[i], cell)) best = std::min(best, to_segment(place, at_[i]));
    return best;
  }

  /// Follows a cell's boundary from a segment, as long as that comes nearer to the place.
  Nearest followed(const Vec3& place, Nearest best, Index cell) const {
    for (Index before = k_none; before != best.segment;) {
      before = best.segment;
      for (const Index end : boundary_.segments[before]) best = std::min(best, nearest_at(place, end, cell));
    }
    return best;
  }

  template <class Visit>
  void visit_neighbors(Index vertex, Visit&& visit) const {
    for (const CornerTable::Corner& corner : table_.at(vertex)) {
      visit(corner.next);
      visit(corner.previous);
    }
  }

  bool offer(Index vertex, Index segment) {
    const auto& [a, b] = boundary_.segments[segment];
    const double found = squared_distance_to(vertices_[vertex], vertices_[a], vertices_[b]);
    if (!(found < squared_[vertex])) return false;
    squared_[vertex] = found;
    nearest_[vertex] = segment;
    return true;
  }

  /// The segments at a vertex of the boundary that bound the other's own cell.
  bool offer_segments_at(Index vertex, Index on_boundary) {
    bool nearer = false;
    for (Index i = first_[on_boundary]; i < first_[on_boundary + 1]; ++i)
      if (bounds(at_[i], cells_[vertex])) nearer = offer(vertex, at_[i]) || nearer;
    return nearer;
  }

  bool offer_neighbors_segments(Index vertex) {
    if (touches(vertex)) return false;
    bool nearer = false;
    visit_neighbors(vertex, [&](Index w) { nearer = offer_segments_at(vertex, w) || nearer; });
    return nearer;
  }

  /// Follows it along the boundary from the segment found, as long as that comes nearer.
  void follow_boundary(Index vertex) {
    for (Index before = k_none; before != nearest_[vertex];) {
      before = nearest_[vertex];
      for (const Index end : boundary_.segments[before]) offer_segments_at(vertex, end);
    }
  }

  std::span<const Vec3> vertices_;
  const CornerTable table_;
  const CellBoundary boundary_;
  std::vector<Index> cells_, nearest_;
  std::vector<double> squared_;
  std::vector<Index> first_, at_;  ///< segments at each vertex
};

/// Halves edges, round after round, each only where the one before has changed something.
class BoundaryRefiner {
 public:
  BoundaryRefiner(std::span<const double> fields, Index width, std::span<const Triangle> triangles,
                  std::span<const Index> triangle_cell, std::span<const double> levels, double tolerance,
                  const JobStage& stage)
      : width_(width),
        levels_(levels),
        tolerance_(tolerance),
        stage_(stage),
        given_(positions_of(fields, width)),
        places_(given_),
        search_(given_, triangles, triangle_cell) {
    search_.spread(std::numeric_limits<double>::infinity(), stage_);
    out_.fields.assign(fields.begin(), fields.end());
    out_.triangles.assign(triangles.begin(), triangles.end());
    out_.cells.assign(triangle_cell.begin(), triangle_cell.end());
    for (Index v = 0; v < static_cast<Index>(given_.size()); ++v) row(v)[width_ - 1] = search_.distance(v);
  }

  BoundaryRefinement run() {
    std::vector<Index> active(out_.triangles.size()), next;
    std::iota(active.begin(), active.end(), 0);
    for (int round = 0; round < k_most_rounds && !active.empty(); ++round) {
      middles_.clear();
      next.clear();
      for (const Index t : active) {
        stage_.check();
        split(t, next);
      }
      spread(next);
      active.swap(next);
    }
    return std::move(out_);
  }

 private:
  static std::vector<Vec3> positions_of(std::span<const double> fields, Index width) {
    std::vector<Vec3> result(fields.size() / width);
    for (std::size_t v = 0; v < result.size(); ++v)
      result[v] = Eigen::Map<const Vec3>(fields.data() + v * static_cast<std::size_t>(width));
    return result;
  }

  double* row(Index vertex) { return out_.fields.data() + static_cast<std::size_t>(vertex) * width_; }

  /// New vertices tell each other what they know, whatever the order in which they came. Beside those that learned
  /// something all triangles are looked at again, for both sides of an edge must decide alike.
  void spread(std::vector<Index>& triangles) {
    std::vector<std::uint8_t> has_learned(places_.size(), 0);
    bool has_any = false;
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      for (const Index t : triangles)
        for (const Index v : out_.triangles[t])
          if (learn(v, t)) has_learned[v] = 1, goes_on = has_any = true;
    }
    if (!has_any) return;
    std::vector<std::uint8_t> is_listed(out_.triangles.size(), 0);
    for (const Index t : triangles) is_listed[t] = 1;
    for (Index t = 0; t < static_cast<Index>(out_.triangles.size()); ++t)
      if (!is_listed[t] && std::ranges::any_of(out_.triangles[t], [&](Index v) { return has_learned[v] != 0; }))
        triangles.push_back(t);
  }

  bool learn(Index vertex, Index triangle) {
    if (vertex < static_cast<Index>(given_.size())) return false;
    bool is_nearer = false;
    for (const Index neighbor : out_.triangles[triangle])
      is_nearer = search_.offer_from(neighbor, vertex, places_[vertex], out_.cells[triangle]) || is_nearer;
    if (is_nearer) row(vertex)[width_ - 1] = search_.distance(vertex);
    return is_nearer;
  }

  void split(Index t, std::vector<Index>& next) {
    const Triangle corners = out_.triangles[t];
    const Index cell = out_.cells[t];
    const auto put = [&](Index a, Index b, Index c, bool is_first = false) {
      next.push_back(is_first ? t : static_cast<Index>(out_.triangles.size()));
      if (is_first) return void(out_.triangles[t] = {a, b, c});
      out_.triangles.push_back({a, b, c});
      out_.cells.push_back(cell);
    };
    std::array<Index, 3> middle;  // of the side that begins at the corner
    int count = 0;
    for (int i = 0; i < 3; ++i) count += (middle[i] = middle_of(corners[i], corners[(i + 1) % 3], cell)) != k_none;
    if (count == 0) {  // linear along its sides, it may still have a ridge inside
      const Index center = amid(corners, cell);
      if (center == k_none) return;
      for (int i = 0; i < 3; ++i) put(corners[i], corners[(i + 1) % 3], center, i == 0);
      return;
    }
    // Turned so that the marked side comes first, and the one that is not marked last.
    int turn = 0;
    while (count < 3 && (middle[turn] == k_none || middle[(turn + 2) % 3] != k_none)) ++turn;
    const Index a = corners[turn], b = corners[(turn + 1) % 3], c = corners[(turn + 2) % 3];
    const Index ab = middle[turn], bc = middle[(turn + 1) % 3], ca = middle[(turn + 2) % 3];
    if (count == 1) {
      put(a, ab, c, true);
      put(ab, b, c);
    } else if (count == 2) {
      put(ab, b, bc, true);
      const bool is_short = (places_[a] - places_[bc]).squaredNorm() <= (places_[ab] - places_[c]).squaredNorm();
      put(a, ab, is_short ? bc : c);
      put(is_short ? a : ab, bc, c);
    } else {
      put(ab, bc, ca, true);
      put(a, ab, ca);
      put(ab, b, bc);
      put(ca, bc, c);
    }
  }

  /// The new vertex in the middle of an edge that is to be halved; k_none for any other.
  Index middle_of(Index a, Index b, Index cell) {
    if (a > b) std::swap(a, b);
    const std::uint64_t key = static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b);
    if (const auto found = middles_.find(key); found != middles_.end()) return found->second;
    const Index added = amid(std::array{a, b}, cell);
    if (added != k_none) middles_.emplace(key, added);
    return added;
  }

  /// A new vertex amid two or three of a cell, where the distance is not linear between them and a level runs there.
  template <std::size_t Count>
  Index amid(const std::array<Index, Count>& around, Index cell) {
    constexpr double share = 1.0 / Count;
    Vec3 middle = Vec3::Zero();
    double mean = 0, lowest = std::numeric_limits<double>::infinity(), highest = 0, most = 0;
    for (const Index v : around) {
      const double distance = row(v)[width_ - 1];
      middle += share * places_[v], mean += share * distance;
      lowest = std::min(lowest, distance), highest = std::max(highest, distance);
    }
    // A distance changes by no more than the way.
    for (const Index v : around) most = std::max(most, (places_[v] - middle).norm());
    const auto is_in_reach = [&](double level) {
      return most > tolerance_ * level && lowest < level && level < mean + most;
    };
    if (!std::isfinite(mean) || std::ranges::none_of(levels_, is_in_reach)) return k_none;
    const BoundarySearch::Nearest nearest = search_.nearest_amid(middle, around, cell);
    const double found = std::sqrt(nearest.squared);
    lowest = std::min(lowest, found), highest = std::max(highest, found);
    const auto is_off = [&](double level) {
      return std::abs(found - mean) > tolerance_ * level && lowest < level && level < highest;
    };
    if (std::ranges::none_of(levels_, is_off)) return k_none;
    const auto added = static_cast<Index>(places_.size());
    places_.push_back(middle);
    search_.add_vertex(nearest);
    out_.fields.resize(out_.fields.size() + width_);
    for (const Index v : around)
      for (Index i = 0; i < width_ - 1; ++i) row(added)[i] += share * row(v)[i];
    row(added)[width_ - 1] = found;
    return added;
  }

  static constexpr int k_most_rounds = 12;
  const Index width_;
  const std::span<const double> levels_;
  const double tolerance_;
  const JobStage& stage_;
  const std::vector<Vec3> given_;
  std::vector<Vec3> places_;
  BoundarySearch search_;
  std::unordered_map<std::uint64_t, Index> middles_;  ///< of the edges halved in this round
  BoundaryRefinement out_;
};

}  // namespace

CellBoundary cell_boundary(std::span<const Triangle> triangles, std::span<const Index> triangle_cell,
                           Index vertex_count) {
  check_cells(triangles, triangle_cell);
  return find_boundary(CornerTable(triangles, vertex_count), triangle_cell);
}

std::vector<double> cell_boundary_distance(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                           std::span<const Index> triangle_cell, double limit, const JobStage& stage) {
  check_cells(triangles, triangle_cell);
  if (!(limit >= 0)) throw InputError(message("limit: wanted a length of 0 or more, got ", limit));
  BoundarySearch search(vertices, triangles, triangle_cell);
  search.spread(limit, stage);
  return search.distances();
}

BoundaryRefinement refine_to_cell_boundary(std::span<const double> fields, Index width,
                                           std::span<const Triangle> triangles, std::span<const Index> triangle_cell,
                                           std::span<const double> levels, double tolerance, const JobStage& stage) {
  if (width < 4) throw InputError(message("fields: wanted a position and room for a distance, got ", width));
  check_cells(triangles, triangle_cell);
  if (!(tolerance > 0)) throw InputError(message("tolerance: wanted a share above 0, got ", tolerance));
  check_corners(triangles, static_cast<Index>(fields.size() / width));
  return BoundaryRefiner(fields, width, triangles, triangle_cell, levels, tolerance, stage).run();
}

}  // namespace saddleback
