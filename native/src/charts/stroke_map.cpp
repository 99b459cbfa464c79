// Each side of the curve is swept by distance, so that the distance has no extremum within what is taken, and goes into
// the band between the curve and a line far away by convex combinations that keep the distances as they are: a map that
// is one to one [tutte1963], [floater2003]. Its border away from the curve is free: reflected on that line, the map is
// that of a rectangle twice as high, in which those vertices are inner ones.

#include "saddleback/charts/stroke_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "saddleback/error.h"

#include "charts/stroke_sheet.h"
#include "charts/stroke_sweep.h"
#include "charts/turn.h"
#include "mesh/tables/edge_table.h"
#include "support/sparse_cholesky.h"

namespace saddleback {
namespace {

using charts::Held;
using charts::PartedSheet;
using charts::Sheet;
using charts::SweptSide;

// Edges as a share of the radius, or of the length of shorter curves, but for a quarter of the radius: so fine that
// a circle about a bend is round enough.
constexpr double k_size = 1.0 / 3;
// As harmonic_map has it.
constexpr double k_least_weight = 1e-3;
// Of corners without a width but for rounding.
constexpr double k_most_cotangent = 1e9, k_least_edge = std::numeric_limits<double>::min();
// What a vertex on the free border gives beyond what it gets, at least, as a share of that.
constexpr double k_least_surplus = 1e-3;
// Triangles of a map for each radius along the curve where all faces are larger, and how many it may have: by then it
// takes ten seconds and a gigabyte.
constexpr double k_triangles_per_radius = 125, k_most_triangles = 1e6;
constexpr double k_printed = 1e-8;  // what messages round numbers by, at most
// Corrections of coordinates, as a share of the length, that are rounding; and how many are made at most.
constexpr double k_refined = 1e-14;
constexpr int k_most_refinements = 5;
// A band is long from so many times its width on one side on.
constexpr double k_long = 16;
// As a share of the length: nearest points this near to an end of the curve are that end.
constexpr double k_at_end = 1e-9;

/// Positive weights of edges with which each inner vertex's distance is the weighted mean of its neighbors'.
class Weights {
 public:
  Weights(const Sheet& sheet, const PartedSheet& parted, const SweptSide& swept, const JobStage& stage)
      : swept_(swept), number_(parted.nodes.size(), k_none) {
    for (const Index v : swept.vertices) number(v);
    std::vector<Triangle> triangles;
    for (const Index t : swept.triangles) {
      triangles.emplace_back();
      for (int k = 0; k < 3; ++k) triangles.back()[k] = number(parted.from(3 * t + k));
    }
    const EdgeTable edges = build_edge_table(triangles, static_cast<Index>(vertices_.size()));
    rows_.resize(vertices_.size());
    for (const Index v : vertices_) distances_.push_back(sheet.distance[parted.nodes[v]]);
    for (Index e = 0; e < edges.edge_count(); ++e) {
      stage.check();
      double weight = 0;
      for (const Index h : edges.edge(e)) {
        const auto at = [&](Index i) -> const Vec3& { return sheet.positions[parted.nodes[vertices_[i]]]; };
        const Vec3& apex = at(halfedge_apex(triangles, h));
        const Vec3 a = at(halfedge_from(triangles, h)) - apex, b = at(halfedge_to(triangles, h)) - apex;
        const double along = a.dot(b);
        weight += along / std::max({a.cross(b).norm(), std::abs(along) / k_most_cotangent, k_least_edge});
      }
      weight = std::max(weight, k_least_weight);
      const Index h = edges.edge(e).front(), a = halfedge_from(triangles, h), b = halfedge_to(triangles, h);
      rows_[a].push_back({b, weight});
      rows_[b].push_back({a, weight});
    }
    balance();
  }

  struct Neighbor {
    Index number;
    double weight;
  };
  /// The sheet's vertices by number: those that were taken, in that order, then the curve's.
  const std::vector<Index>& vertices() const { return vertices_; }
  const std::vector<Neighbor>& row(Index i) const { return rows_[i]; }

 private:
  Index number(Index vertex) {
    if (number_[vertex] == k_none) {
      number_[vertex] = static_cast<Index>(vertices_.size());
      vertices_.push_back(vertex);
    }
    return number_[vertex];
  }

  /// Lets something flow down from the free border to the curve, weights times differences of distances, which no inner
  /// vertex adds to or takes from. Each shares what it gets among the vertices below as the cotangents say.
  void balance() {
    std::vector<double> flow(vertices_.size(), 0), factor(vertices_.size(), 1);
    const auto height = [&](Index i, const Neighbor& n) { return std::max(distances_[i] - distances_[n.number], 0.0); };
    for (auto i = static_cast<Index>(swept_.vertices.size()); i-- > 0;) {
      double own = 0;
      for (const Neighbor& n : rows_[i]) own += n.weight * height(i, n);
      const Index v = vertices_[i];
      // Along a ridge of very many vertices the flow may become less than doubles hold.
      const bool is_free =
          swept_.is_last[v] || swept_.held[v] != Held::nothing || flow[i] < std::numeric_limits<double>::min();
      factor[i] = (is_free ? std::max(own, flow[i] * (1 + k_least_surplus)) : flow[i]) / own;
      for (const Neighbor& n : rows_[i]) flow[n.number] += factor[i] * n.weight * height(i, n);
    }
    const auto is_higher = [&](Index a, Index b) { return std::pair(distances_[a], a) > std::pair(distances_[b], b); };
    for (Index i = 0; i < static_cast<Index>(rows_.size()); ++i)
      for (Neighbor& n : rows_[i]) n.weight *= factor[is_higher(i, n.number) ? i : n.number];
  }

  const SweptSide& swept_;
  std::vector<Index> number_, vertices_;
  std::vector<double> distances_;
  std::vector<std::vector<Neighbor>> rows_;
};

/// (vertices of the parted sheet) coordinates along the curve on one side of it: those of the curve's vertices, and of
/// lines across its ends, are given.
void solve_along(const Sheet& sheet, const PartedSheet& parted, const SweptSide& swept, std::vector<double>& along,
                 double at_start, double at_end, const JobStage& stage) {
  if (swept.vertices.empty()) return;
  const Weights weights(sheet, parted, swept, stage);
  const std::vector<Index>& vertices = weights.vertices();
  std::vector<Index> row(vertices.size(), k_none), unknowns;
  // Long bands are halved across on the map: in space they may turn back beside themselves, or run along the cut.
  std::vector<Vec3> places;
  const bool is_long = std::abs(at_end - at_start) > k_long * sheet.distance[parted.nodes[swept.vertices.back()]];
  const auto place_on_map = [&](Index i) {
    double foot = sheet.along[parted.nodes[vertices[i]]];
    for (const auto& [number, weight] : weights.row(i))
      if (std::isnan(foot)) foot = sheet.along[parted.nodes[vertices[number]]];
    return Vec3(std::isnan(foot) ? at_start : foot, sheet.distance[parted.nodes[vertices[i]]], 0);
  };
  for (Index i = 0; i < static_cast<Index>(swept.vertices.size()); ++i) {
    const Index v = vertices[i];
    if (swept.held[v] == Held::nothing) {
      row[i] = static_cast<Index>(unknowns.size());
      unknowns.push_back(i);
      places.push_back(is_long ? place_on_map(i) : sheet.positions[parted.nodes[v]]);
    } else {
      along[v] = swept.held[v] == Held::at_start ? at_start : at_end;
    }
  }
  if (unknowns.empty()) return;
  SymmetricMatrix matrix;
  std::vector<Vec2> right;
  matrix.offsets.push_back(0);
  for (const Index i : unknowns) {
    stage.check();
    double sum = 0;
    Vec2 given(0, 0);
    for (const auto& [number, weight] : weights.row(i)) {
      sum += weight;
      if (row[number] == k_none) {
        given.x() += weight * along[vertices[number]];
      } else {
        matrix.columns.push_back(row[number]);
        matrix.values.push_back(-weight);
      }
    }
    matrix.offsets.push_back(static_cast<Index>(matrix.columns.size()));
    matrix.diagonal.push_back(sum);
    right.push_back(given);
  }
  std::vector<Index> order = dissection_order(matrix, places);
  stage.check();
  const SparseCholesky factors(matrix, std::move(order), stage);
  std::vector<Vec2> correction = factors.solve(right);
  for (std::size_t i = 0; i < unknowns.size(); ++i) along[vertices[unknowns[i]]] = correction[i].x();
  // Beside needles, whose weights are as large as they are thin, what hangs on a narrow neck would fold by rounding.
  // What flows through the edges, from differences, tells how far off it is.
  for (int round = 0; round < k_most_refinements; ++round) {
    for (std::size_t k = 0; k < unknowns.size(); ++k) {
      stage.check();
      const Index i = unknowns[k];
      right[k].x() = 0;
      for (const auto& [number, weight] : weights.row(i))
        right[k].x() += weight * (along[vertices[number]] - along[vertices[i]]);
    }
    correction = factors.solve(right);
    double most = 0;
    for (const Vec2& c : correction) most = std::max(most, std::abs(c.x()));
    if (most <= k_refined * std::abs(at_end - at_start)) break;
    for (std::size_t i = 0; i < unknowns.size(); ++i) along[vertices[unknowns[i]]] += correction[i].x();
  }
}

/// The lines about a side, as the curve goes or, for its right side, against it.
charts::SideBorder border_of(const Sheet& sheet, const PartedSheet& parted, bool is_left) {
  charts::SideBorder border;
  const auto half = [&](Index a, Index b) { return parted.halfedge(a, b); };
  for (std::size_t i = 1; i < sheet.curve.size(); ++i)
    border.curve.push_back(is_left ? half(sheet.curve[i - 1], sheet.curve[i])
                                   : half(sheet.curve[i], sheet.curve[i - 1]));
  // Where no line cuts a closed curve open, a piece is left out instead.
  if (const Index first = border.curve.front(), last = border.curve.back();
      first != k_none && last != k_none &&
      (is_left ? parted.from(first) == parted.from(PartedSheet::next(last))
               : parted.from(last) == parted.from(PartedSheet::next(first))))
    border.curve.back() = k_none;
  // A closed curve has its lines at the start alone: they are at its end from their other sides.
  const bool closed = sheet.curve.front() == sheet.curve.back();
  const auto& at_first = sheet.across[is_left ? 0 : 1];
  const auto& at_last = closed ? at_first : sheet.across[is_left ? 2 : 3];
  const auto& starts = is_left ? at_first : at_last;
  const auto& ends = is_left ? at_last : at_first;
  for (std::size_t i = 1; i < starts.size(); ++i) border.start.push_back(half(starts[i], starts[i - 1]));
  for (std::size_t i = 1; i < ends.size(); ++i) border.end.push_back(half(ends[i - 1], ends[i]));
  return border;
}

double area(const Sheet& sheet, const Triangle& t) {
  const std::vector<Vec3>& at = sheet.positions;
  return (at[t[1]] - at[t[0]]).cross(at[t[2]] - at[t[0]]).norm() / 2;
}

/// Tells whether a triangle lies beyond an end of an open curve.
bool is_beyond_ends(const Sheet& sheet, const Triangle& t, double length) {
  return std::ranges::all_of(
      t, [&](Index n) { return !(sheet.along[n] > k_at_end * length && sheet.along[n] < (1 - k_at_end) * length); });
}

/// Puts the triangles together that have the right orientation; vertices of the curve meet again.
class Patch {
 public:
  Patch(StrokeMap& map, const Mesh& mesh, const Sheet& sheet, const PartedSheet& parted, const charts::NearPart& near)
      : map_(map), mesh_(mesh), sheet_(sheet), parted_(parted), near_(near) {}

  /// Vertices are numbered anew for each side: off the curve one that both sides come to has two places.
  void begin_side() { number_.assign(parted_.nodes.size(), k_none); }
  void add(Index triangle, const std::vector<double>& along, int side) {
    std::array<Vec2, 3> places;
    for (int k = 0; k < 3; ++k) {
      const Index v = parted_.from(3 * triangle + k);
      const double distance = sheet_.distance[parted_.nodes[v]];
      places[k] = {along[v], distance > 0 ? side * distance : 0};
    }
    if (charts::turn(places[0], places[1], places[2]) != predicates::Sign::positive) return;
    Triangle corners;
    for (int k = 0; k < 3; ++k) corners[k] = number(parted_.from(3 * triangle + k), places[k]);
    map_.triangles.push_back(corners);
    map_.face_origin.push_back(near_.faces[sheet_.faces[triangle]]);
    map_.area += area(sheet_, sheet_.triangles[triangle]);
  }

 private:
  Index number(Index vertex, const Vec2& place) {
    if (number_[vertex] != k_none) return number_[vertex];
    const Index node = parted_.nodes[vertex];
    const auto next = static_cast<Index>(map_.points.size());
    number_[vertex] = place.y() == 0 ? on_curve_.try_emplace({node, place.x()}, next).first->second : next;
    if (number_[vertex] < next) return number_[vertex];
    const SurfacePoint& point = sheet_.points[node];
    map_.points.push_back({near_.faces[point.face], point.barycentric});
    map_.vertices.push_back(position(mesh_, map_.points.back()));
    map_.uv.push_back(place);
    return next;
  }

  StrokeMap& map_;
  const Mesh& mesh_;
  const Sheet& sheet_;
  const PartedSheet& parted_;
  const charts::NearPart& near_;
  std::vector<Index> number_;
  std::map<std::pair<Index, double>, Index> on_curve_;
};

/// The curve on the near part of its mesh.
SurfaceCurve curve_on(const charts::NearPart& near, const SurfaceCurve& curve) {
  SurfacePoints points;
  for (const CurveSegment& s : curve.segments()) {
    const auto face = static_cast<Index>(std::ranges::lower_bound(near.faces, s.face) - near.faces.begin());
    points.push_back({face, s.begin});
    if (!curve.closed() && &s == &curve.segments().back()) points.push_back({face, s.end});
  }
  return {near.mesh, std::move(points), curve.closed(), "curve"};
}

/// (vertices of the parted sheet) arc length of the curve's vertices on one side of it, 0 of others.
std::vector<double> along_curve(const Sheet& sheet, const PartedSheet& parted, const charts::SideBorder& border,
                                double length, bool is_left) {
  std::vector<double> there{0}, along(parted.nodes.size(), 0);
  for (std::size_t i = 1; i < sheet.curve.size(); ++i)
    there.push_back(there.back() + (sheet.positions[sheet.curve[i]] - sheet.positions[sheet.curve[i - 1]]).norm());
  for (double& at : there) at = &at == &there.back() ? length : at * (length / there.back());
  for (std::size_t i = 0; i < border.curve.size(); ++i) {
    const Index h = border.curve[i];
    if (h == k_none) continue;
    along[parted.from(h)] = there[is_left ? i : i + 1];
    along[parted.from(PartedSheet::next(h))] = there[is_left ? i + 1 : i];
  }
  return along;
}

}  // namespace

StrokeMap stroke_map(const Mesh& mesh, const SurfaceCurve& curve, double radius, Job* job) {
  mesh.require_space("stroke_map");
  if (&curve.mesh() != &mesh && curve.mesh().fingerprint() != mesh.fingerprint())
    throw InputError("curve: it lies on another mesh");
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(message("radius: wanted a finite distance above 0, got ", radius));
  if (const double most = k_most_triangles / k_triangles_per_radius; curve.length() > most * radius)
    throw InputError(message("radius: ", radius, " is small beside a curve ", curve.length(),
                             " long: the map may take ", std::round(k_triangles_per_radius * curve.length() / radius),
                             " triangles, of ", k_most_triangles, " at most; the least radius that works is ",
                             curve.length() / most * (1 + k_printed)));
  const JobStage stage(job, "Mapping along the curve");
  const double size = k_size * std::clamp(curve.length(), 0.25 * radius, radius), reach = radius + size;
  const charts::NearPart near = charts::near_part(mesh, curve, radius, stage.part(0, 0.1));
  const SurfaceCurve line = curve_on(near, curve);
  Sheet sheet = charts::cut_sheet(mesh, near, line, radius, size, stage.part(0.1, 0.3));
  const double length = curve.length();
  measure(sheet, curve.closed(), length, reach, stage.part(0.3, 0.7));
  cut_at_cut_locus(sheet, near.mesh, curve.closed(), length, stage);
  cut_at_radius(sheet, near.mesh, curve.closed(), length, radius, stage);
  stage.update(0.75);
  double farthest = 0;
  for (const Triangle& t : sheet.triangles)
    for (const Index node : t) farthest = std::max(farthest, sheet.distance[node]);
  const PartedSheet parted(sheet, stage);
  StrokeMap map;
  map.length = length;
  Patch patch(map, mesh, sheet, parted, near);
  std::vector<std::uint8_t> taken(sheet.triangles.size(), 0);
  for (const bool is_left : {false, true}) {
    const charts::SideBorder border = border_of(sheet, parted, is_left);
    SweptSide swept = sweep_side(sheet, parted, border, farthest, taken, stage);
    std::vector<double> along = along_curve(sheet, parted, border, length, is_left);
    solve_along(sheet, parted, swept, along, is_left ? 0 : length, is_left ? length : 0,
                stage.part(is_left ? 0.88 : 0.76, is_left ? 0.99 : 0.87));
    patch.begin_side();
    std::ranges::sort(swept.triangles);
    for (const Index t : swept.triangles) {
      stage.check();
      patch.add(t, along, is_left ? 1 : -1);
    }
  }
  double all = 0;
  for (const Triangle& t : sheet.triangles)
    if (curve.closed() || !is_beyond_ends(sheet, t, length)) all += area(sheet, t);
  map.coverage = all > 0 ? std::min(map.area / all, 1.0) : 0;
  stage.update(1);
  return map;
}

}  // namespace saddleback
