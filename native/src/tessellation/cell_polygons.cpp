#include "saddleback/tessellation/cell_polygons.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "saddleback/error.h"

#include "mesh/read/triangulate_polygon.h"
#include "tessellation/polygons/parted_surface.h"

namespace saddleback {
namespace {

// In parts of a cell: a barrier that leaves a side by less is straight but for rounding, as coordinates often come as
// float32.
constexpr double k_straight = 1e-6;

double distance_to_segment(const Vec3& point, const Vec3& a, const Vec3& b) {
  const Vec3 way = b - a;
  const double square = way.squaredNorm();
  const double share = square > 0 ? std::clamp((point - a).dot(way) / square, 0.0, 1.0) : 0;
  return (point - a - share * way).norm();
}

/// The inner ones of the points `way` whose polyline, with the ends, is nowhere farther than the tolerance from them;
/// of a way that ends where it begins, from its ends. O(n^2) at worst, O(n log n) as a rule. After [douglas1973].
std::vector<Index> bending_points(std::span<const Vec3> positions, std::span<const Index> way, double tolerance) {
  std::vector<Index> found;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, way.size() - 1}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    double most = tolerance;
    std::size_t farthest = begin;
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double off = distance_to_segment(positions[way[i]], positions[way[begin]], positions[way[end]]);
      if (off > most) most = off, farthest = i;
    }
    if (farthest == begin) {
      if (end + 1 < way.size()) found.push_back(way[end]);
      continue;
    }
    open.emplace_back(farthest, end);  // looked at after what comes before it
    open.emplace_back(begin, farthest);
  }
  return found;
}

class PolygonMaker {
 public:
  PolygonMaker(const Mesh& mesh, PartedSurface surface, const CellPolygonOptions& options)
      : mesh_(mesh), options_(options), surface_(std::move(surface)), split_(surface_.split), twins_(twins_of(split_)) {
    find_lines();
    count_characteristics();
    find_chains();
    simplify();
    add_needed();
    put_together();
  }
  CellPolygons take() { return std::move(result_); }
  SplitMesh take_split() { return std::move(surface_.split); }

 private:
  /// A boundary from corner to corner, or all around where it has none.
  struct Chain {
    std::vector<Index> vertices;  ///< of the split mesh, also the last
    std::vector<Index> inner;     ///< those that become corners, in order
    double bend;                  ///< how far its sides may leave it
    bool is_barrier;
  };
  /// The chain that a half-edge begins, for the cell on its left.
  struct Use {
    Index chain = k_none;
    bool is_forward = true;
    Index last = k_none;  ///< the half-edge that ends it
  };

  Index cell_of(Index h) const { return split_.triangle_cell[h / 3]; }
  Index from(Index h) const { return split_.triangles[h / 3][h % 3]; }
  Index to(Index h) const { return from(Mesh::next(h)); }
  bool is_barrier(Index h) const { return surface_.lines[h] == PartedSurface::barrier; }
  bool is_line(Index h) const {
    return surface_.lines[h] != PartedSurface::none || twins_[h] == k_none || cell_of(twins_[h]) != cell_of(h);
  }
  /// Tells whether lines meet or end there, or a barrier goes on as another line.
  bool is_corner(Index vertex) const { return degree_[vertex] > 2 || barriers_[vertex] == 1; }
  /// The next half-edge around the same cell.
  Index onward(Index h) const {
    Index next = Mesh::next(h);
    while (!is_line(next)) next = Mesh::next(twins_[next]);
    return next;
  }

  void find_lines() {
    degree_.assign(split_.vertices.size(), 0);
    barriers_ = degree_;
    for (Index h = 0; h < static_cast<Index>(twins_.size()); ++h) {
      if (!is_line(h) || (twins_[h] != k_none && twins_[h] < h)) continue;
      for (const Index end : {from(h), to(h)}) {
        ++degree_[end];
        if (is_barrier(h)) ++barriers_[end];
      }
    }
  }

  /// Faces - edges + vertices of each cell without its border: 1 for a disk.
  void count_characteristics() {
    std::vector<Index> twice_edges(surface_.areas.size(), 0);
    std::vector<std::uint8_t> seen(split_.vertices.size(), 0);
    characteristic_.assign(surface_.areas.size(), 0);
    for (Index h = 0; h < static_cast<Index>(twins_.size()); ++h) {
      if (h % 3 == 0) ++characteristic_[cell_of(h)];
      if (!is_line(h)) ++twice_edges[cell_of(h)];
      if (degree_[from(h)] == 0 && !std::exchange(seen[from(h)], 1)) ++characteristic_[cell_of(h)];
    }
    for (std::size_t cell = 0; cell < twice_edges.size(); ++cell) characteristic_[cell] -= twice_edges[cell] / 2;
  }

  void find_chains() {
    const auto count = static_cast<Index>(twins_.size());
    uses_.resize(count);
    std::vector<std::uint8_t> seen(count, 0);
    for (const bool is_loop : {false, true}) {
      for (Index h = 0; h < count; ++h)
        if (is_line(h) && !seen[h] && (is_loop || is_corner(from(h)))) follow(h, is_loop, seen);
    }
  }

  void follow(Index first, bool is_loop, std::vector<std::uint8_t>& seen) {
    std::vector<Index> vertices{from(first)};
    Index last = first;
    for (Index h = first;; h = onward(h)) {
      seen[h] = 1;
      last = h;
      vertices.push_back(to(h));
      if (is_loop ? to(h) == from(first) : is_corner(to(h))) break;
    }
    Use& use = uses_[first];
    use.last = last;
    firsts_.push_back(first);
    // From the other side the same chain begins where this one ends.
    const Index back = twins_[last];
    if (is_loop && twins_[first] != k_none && characteristic_[cell_of(twins_[first])] == 1)
      unfit_.push_back(cell_of(first));
    if (!is_loop && back != k_none && uses_[back].chain != k_none) {
      use.chain = uses_[back].chain;
      use.is_forward = false;
      return;
    }
    double area = surface_.areas[cell_of(first)];
    if (twins_[first] != k_none) area = std::min(area, surface_.areas[cell_of(twins_[first])]);
    const double bend = is_barrier(first) ? k_straight : options_.bend;
    use.chain = static_cast<Index>(chains_.size());
    chains_.push_back(
        {std::move(vertices), {}, std::min(bend * std::sqrt(area), options_.tolerance), is_barrier(first)});
  }

  void simplify() {
    for (Chain& chain : chains_) chain.inner = bending_points(split_.vertices, chain.vertices, chain.bend);
  }

  /// Gives corners to chains that would join the same corners as another one, or end where they begin.
  void add_needed() {
    std::map<std::pair<Index, Index>, std::vector<Chain*>> bare;
    for (Chain& chain : chains_) {
      const auto [low, high] = std::minmax(chain.vertices.front(), chain.vertices.back());
      if (low == high) {
        if (chain.inner.size() < 2) chain.inner = {along(chain, 1. / 3), along(chain, 2. / 3)};
      } else if (chain.inner.empty()) {
        bare[{low, high}].push_back(&chain);
      }
    }
    for (const auto& [ends, same] : bare)
      if (same.size() > 1)
        for (Chain* const chain : same) chain->inner = {along(*chain, 0.5)};
  }

  /// The inner vertex of a chain that is nearest to a share of its way; a new one in the middle of a chain without any.
  Index along(const Chain& chain, double share) {
    const std::vector<Index>& way = chain.vertices;
    if (way.size() == 2) return middle(way[0], way[1]);
    std::vector<double> length{0};
    for (std::size_t i = 1; i < way.size(); ++i)
      length.push_back(length.back() + (split_.vertices[way[i]] - split_.vertices[way[i - 1]]).norm());
    // A loop has two inner vertices at least: the first third is looked for in the first half.
    const std::size_t begin = share > 0.5 ? way.size() / 2 : 1, end = share < 0.5 ? way.size() / 2 : way.size() - 1;
    std::size_t best = begin;
    const auto off = [&](std::size_t i) { return std::abs(length[i] - share * length.back()); };
    for (std::size_t i = begin; i < end; ++i)
      if (off(i) < off(best)) best = i;
    return way[best];
  }

  Index middle(Index a, Index b) {
    const SurfacePoint begin = place(a), end = place(b);
    const Index face = shared_face(mesh_, begin, end, k_barycentric_tolerance);
    const Vec3 half = 0.5 * (*barycentric_in(mesh_, begin, face, k_barycentric_tolerance) +
                             *barycentric_in(mesh_, end, face, k_barycentric_tolerance));
    added_.push_back({face, normalized_barycentric(half)});
    return static_cast<Index>(split_.vertices.size() + added_.size() - 1);
  }

  SurfacePoint place(Index vertex) const {
    const Index of_mesh = mesh_.vertex_count(), of_split = static_cast<Index>(split_.vertices.size());
    if (vertex < of_mesh) return at_vertex(mesh_, vertex);
    return vertex < of_split ? surface_.places[vertex - of_mesh] : added_[vertex - of_split];
  }

  void put_together() {
    std::vector<std::vector<Index>> starts(surface_.areas.size());  // a half-edge for each boundary of a cell
    std::vector<std::uint8_t> done(twins_.size(), 0);
    for (const Index first : firsts_) {
      if (done[first]) continue;
      starts[cell_of(first)].push_back(first);
      for (Index h = first; !done[h]; h = onward(uses_[h].last)) done[h] = 1;
    }
    std::vector<std::uint8_t> is_unfit(starts.size(), 0);
    for (const Index cell : unfit_) is_unfit[cell] = 1;
    result_.offsets.push_back(0);
    for (Index cell = 0; cell < static_cast<Index>(starts.size()); ++cell) {
      if (surface_.areas[cell] == 0) continue;  // coincides with another site
      std::vector<Index> around;
      std::vector<std::uint8_t> barred;
      if (starts[cell].size() == 1 && characteristic_[cell] == 1 && !is_unfit[cell])
        around = loop(starts[cell][0], barred);
      std::vector<Index> sorted = around;
      std::ranges::sort(sorted);
      if (around.size() < 3 || std::ranges::adjacent_find(sorted) != sorted.end()) {
        result_.missing.push_back(cell);
        continue;
      }
      result_.corners.insert(result_.corners.end(), around.begin(), around.end());
      result_.is_barrier.insert(result_.is_barrier.end(), barred.begin(), barred.end());
      result_.offsets.push_back(static_cast<Index>(result_.corners.size()));
      result_.polygon_cell.push_back(cell);
    }
    number_vertices();
  }

  /// The corners around a cell, and whether the sides after them are barriers.
  std::vector<Index> loop(Index first, std::vector<std::uint8_t>& barred) const {
    std::vector<Index> around;
    Index h = first;
    do {
      const Chain& chain = chains_[uses_[h].chain];
      around.push_back(from(h));
      if (uses_[h].is_forward)
        around.insert(around.end(), chain.inner.begin(), chain.inner.end());
      else
        around.insert(around.end(), chain.inner.rbegin(), chain.inner.rend());
      barred.resize(around.size(), chain.is_barrier);
      h = onward(uses_[h].last);
    } while (h != first);
    return around;
  }

  void number_vertices() {
    std::vector<Index> used = result_.corners;
    std::ranges::sort(used);
    used.erase(std::ranges::unique(used).begin(), used.end());
    for (Index& corner : result_.corners)
      corner = static_cast<Index>(std::ranges::lower_bound(used, corner) - used.begin());
    for (const Index vertex : used) {
      result_.points.push_back(place(vertex));
      result_.vertices.push_back(position(mesh_, result_.points.back()));
    }
  }

  const Mesh& mesh_;
  const CellPolygonOptions& options_;
  PartedSurface surface_;
  const SplitMesh& split_;  ///< the surface's
  const std::vector<Index> twins_;
  std::vector<Index> degree_, barriers_;  ///< of each vertex: the edges there that are lines, and those on barriers
  std::vector<Index> characteristic_;     ///< of each cell
  std::vector<Use> uses_;                 ///< by half-edge
  std::vector<Index> firsts_;             ///< the half-edges that begin chains
  std::vector<Chain> chains_;
  SurfacePoints added_;  ///< corners that are no vertices of the split mesh
  std::vector<Index> unfit_;
  CellPolygons result_;
};

void check(const CellPolygonOptions& options) {
  if (!(options.bend >= 0)) throw InputError(message("bend: wanted a number of 0 or more, got ", options.bend));
  if (!(options.tolerance >= 0))
    throw InputError(message("tolerance: wanted a length of 0 or more, got ", options.tolerance));
}

CellPolygons polygons_of(const Mesh& mesh, const GeodesicVoronoi& cells, const CellPolygonOptions& options) {
  CellPolygons result = PolygonMaker(mesh, parted_surface(mesh, cells), options).take();
  result.sites = cells.sites;
  return result;
}

}  // namespace

CellPolygons cell_polygons(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells,
                           const CellPolygonOptions& options, Job* job) {
  check(options);
  CellPolygons result = polygons_of(graph.mesh(), cells, options);
  if (result.missing.empty() || options.policy == DualPolicy::strict) {
    JobStage(job, "Making polygons").update(1);
    return result;
  }
  if (options.policy == DualPolicy::fail) {
    throw InputError(message("sites: ", result.missing.size(), " cells have no polygon, the first is ",
                             result.missing[0], ", which is no disk; use more cells, or policy='repair'"));
  }
  const DualMesh dual = dual_mesh(graph, cells, DualPolicy::repair, options.threads, job);
  result = polygons_of(graph.mesh(), *dual.repaired, options);
  result.added = dual.added;
  return result;
}

CellPolygons cell_polygons(const Mesh& whole, const BarredMesh& barred, const GeodesicVoronoi& cells,
                           const CellPolygonOptions& options, SplitMesh* split) {
  check(options);
  if (cells.vertex_cell.size() != barred.vertex_points.size())
    throw InputError(message("cells: of a mesh of ", cells.vertex_cell.size(), " vertices, the barred one has ",
                             barred.vertex_points.size()));
  PolygonMaker maker(whole, parted_surface(whole, barred, cells), options);
  CellPolygons result = maker.take();
  if (split) *split = maker.take_split();
  result.sites = points_on_whole(whole, barred, cells.sites, "cells");
  return result;
}

std::vector<Triangle> polygon_triangles(const CellPolygons& polygons) {
  if (polygons.vertices.empty()) return {};
  PolygonTriangulator triangulator;
  const std::span xyz(polygons.vertices.front().data(), 3 * polygons.vertices.size());
  std::vector<Index> corners;
  for (std::size_t i = 0; i + 1 < polygons.offsets.size(); ++i) {
    const Index begin = polygons.offsets[i], end = polygons.offsets[i + 1];
    triangulator.triangulate(std::span(polygons.corners).subspan(begin, end - begin), xyz, corners, {});
  }
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < corners.size(); i += 3) triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  return triangles;
}

}  // namespace saddleback
