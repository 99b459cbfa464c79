#include "tessellation/polygons/barrier_ends.h"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "saddleback/mesh/mesh.h"

namespace saddleback {
namespace {

// Of a cell: a smaller part that is cut off goes to its neighbor instead of being a cell of its own.
constexpr double k_little = 0.25;

class EndCutter {
 public:
  explicit EndCutter(PartedSurface& surface)
      : surface_(surface), triangles_(surface.split.triangles), twins_(twins_of(surface.split)) {
    const auto count = surface.split.vertices.size();
    around_.resize(count);
    part_of_.resize(triangles_.size(), 0);
    for (Index h = 0; h < static_cast<Index>(twins_.size()); ++h) {
      around_[from(h)].push_back(h);
      if (twins_[h] == k_none) around_[to(h)].push_back(h);
    }
  }

  void cut_all() {
    for (Index vertex = 0; vertex < static_cast<Index>(around_.size()); ++vertex)
      if (degree(vertex) == 1) cut_to(vertex);
  }

 private:
  Index from(Index h) const { return triangles_[h / 3][h % 3]; }
  Index to(Index h) const { return triangles_[h / 3][Mesh::next(h) % 3]; }
  Index other(Index h, Index vertex) const { return from(h) == vertex ? to(h) : from(h); }
  Index& cell(Index h) { return surface_.split.triangle_cell[h / 3]; }
  bool is_line(Index h) {
    return surface_.lines[h] != PartedSurface::none || twins_[h] == k_none || cell(twins_[h]) != cell(h);
  }
  Index degree(Index vertex) {
    return static_cast<Index>(std::ranges::count_if(around_[vertex], [&](Index h) { return is_line(h); }));
  }

  /// The vertices along the line from its end to where others meet it.
  std::set<Index> line_from(Index end) {
    std::set<Index> line{end};
    for (Index vertex = end; vertex == end || degree(vertex) == 2;) {
      const auto next = std::ranges::find_if(around_[vertex],
                                             [&](Index h) { return is_line(h) && !line.contains(other(h, vertex)); });
      if (next == around_[vertex].end()) break;
      vertex = other(*next, vertex);
      line.insert(vertex);
    }
    return line;
  }

  /// The half-edges of the shortest way along edges within the cell from a line's end to another line.
  std::vector<Index> way_from(Index end) {
    const std::set<Index> own = line_from(end);
    std::map<Index, std::pair<double, Index>> best{{end, {0, k_none}}};
    using Reached = std::pair<double, Index>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
    open.emplace(0, end);
    while (!open.empty()) {
      const auto [length, vertex] = open.top();
      open.pop();
      if (length > best[vertex].first) continue;
      if (vertex != end && degree(vertex) > 0) {
        if (own.contains(vertex)) continue;
        std::vector<Index> way;
        for (Index h = best[vertex].second; h != k_none; h = best[from(h)].second) way.push_back(h);
        return way;
      }
      for (const Index h : around_[vertex]) {
        if (is_line(h)) continue;
        const double further = length + (surface_.split.vertices[to(h)] - surface_.split.vertices[vertex]).norm();
        const auto [known, is_new] = best.try_emplace(to(h), further, h);
        if (!is_new && known->second.first <= further) continue;
        known->second = {further, h};
        open.emplace(further, to(h));
      }
    }
    return {};
  }

  void cut_to(Index end) {
    const std::vector<Index> way = way_from(end);
    if (way.empty()) return;  // no other line: the cell is all there is, and gets a polygon by no cut
    for (const Index h : way) surface_.lines[h] = surface_.lines[twins_[h]] = PartedSurface::drawn;
    Part left(*this, way.front() / 3), right(*this, twins_[way.front()] / 3);
    while (!left.is_whole() && !right.is_whole())
      if (left.area <= right.area ? !left.grow(right) : !right.grow(left)) return;
    // The other one need not be known as a whole once the first is little beside it.
    Part &first = left.is_whole() ? left : right, &other = left.is_whole() ? right : left;
    while (!other.is_whole() && !is_little(first.area, other.area))
      if (!other.grow(first)) return;
    const bool is_left_smaller = left.area < right.area;
    give(is_left_smaller ? left.triangles : right.triangles, std::min(left.area, right.area),
         std::max(left.area, right.area));
  }

  static bool is_little(double size, double rest) { return size < k_little * (size + rest); }

  double area(Index t) const {
    const auto corner = [&](int i) { return surface_.split.vertices[triangles_[t][i]]; };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
  }

  /// The triangles that hang together with one, found one after the other.
  struct Part {
    Part(EndCutter& of, Index triangle) : cutter(of), number(++of.part_count_) { add(triangle); }
    bool is_whole() const { return next == triangles.size(); }
    void add(Index t) {
      cutter.part_of_[t] = number;
      triangles.push_back(t);
      area += cutter.area(t);
    }
    /// Adds those beside one; false where one of them belongs to the other part.
    bool grow(const Part& other) {
      const Index t = triangles[next++];
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        if (cutter.is_line(h)) continue;
        const Index beyond = cutter.twins_[h] / 3;
        if (cutter.part_of_[beyond] == other.number) return false;
        if (cutter.part_of_[beyond] != number) add(beyond);
      }
      return true;
    }
    EndCutter& cutter;
    Index number;
    std::vector<Index> triangles;
    std::size_t next = 0;
    double area = 0;
  };

  void give(const std::vector<Index>& part, double size, double rest) {
    Index owner = is_little(size, rest) ? neighbor(part) : k_none;
    if (owner == k_none) {
      owner = static_cast<Index>(surface_.areas.size());
      surface_.areas.push_back(0);
    }
    surface_.areas[cell(3 * part.front())] -= size;
    surface_.areas[owner] += size;
    for (const Index t : part) cell(3 * t) = owner;
  }

  /// The cell that a part shares the longest line with, a single one that is no barrier; k_none where there is none.
  Index neighbor(const std::vector<Index>& part) {
    struct Border {
      double length = 0;
      Index edges = 0;
      std::set<Index> vertices;
    };
    std::map<Index, Border> borders;
    for (const Index t : part) {
      for (Index h = 3 * t; h < 3 * t + 3; ++h) {
        if (twins_[h] == k_none || surface_.lines[h] != PartedSurface::none || cell(twins_[h]) == cell(h)) continue;
        Border& border = borders[cell(twins_[h])];
        border.length += (surface_.split.vertices[to(h)] - surface_.split.vertices[from(h)]).norm();
        ++border.edges;
        border.vertices.insert({from(h), to(h)});
      }
    }
    Index best = k_none;
    for (const auto& [owner, border] : borders)
      if (static_cast<Index>(border.vertices.size()) == border.edges + 1 &&
          (best == k_none || border.length > borders[best].length))
        best = owner;
    return best;
  }

  PartedSurface& surface_;
  const std::vector<Triangle>& triangles_;
  const std::vector<Index> twins_;
  std::vector<std::vector<Index>> around_;  ///< of each vertex: a half-edge for each edge there
  std::vector<Index> part_of_;              ///< of each triangle: the number of the part that found it last
  Index part_count_ = 0;
};

}  // namespace

void cut_to_barrier_ends(PartedSurface& surface) { EndCutter(surface).cut_all(); }

}  // namespace saddleback
