#include "charts/stroke_sheet.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "saddleback/mesh/trace.h"

#include "geodesics/wavefront/curve_windows.h"
#include "geodesics/wavefront/directions_at_point.h"
#include "mesh/cutting/barrier_cuts.h"
#include "mesh/tables/edge_key.h"
#include "mesh/tables/face_shape.h"
#include "support/disjoint_sets.h"

namespace saddleback::charts {
namespace {

// A line across an end is shortest as long as distances along it are, up to rounding.
constexpr double k_shortest = 1e-6;
// A closed curve is cut open in any direction in which the distance grows by such a share of the way, at least: where
// it bends it is nearer than its corner.
constexpr double k_increase = 0.1;
// Nodes whose nearest points lie this many times as far apart as they do themselves have the cut locus between them:
// near the evolute, where the map would become as narrow.
constexpr double k_apart = 4;
// As a share of the radius: nodes this near to it lie on it.
constexpr double k_at_radius = 1e-6;
// As a share of the longest edge: what makes any triangle higher than a mesh demands.
constexpr double k_mollified = 4 * k_degenerate_height;

constexpr double k_nowhere = std::numeric_limits<double>::quiet_NaN();

/// Points along a curve, so near to each other that balls about them hold all that is within a radius of it.
class Beads {
 public:
  Beads(const SurfaceCurve& curve, double radius) : reach_(radius * (1 + k_spacing)), step_(2 * k_spacing * radius) {
    double next = 0;
    for (const CurveSegment& s : curve.segments()) {
      const Vec3 a = position(curve.mesh(), {s.face, s.begin}), b = position(curve.mesh(), {s.face, s.end});
      while (next <= s.start + s.length) {
        beads_.push_back(a + (next - s.start) / s.length * (b - a));
        next += step_;
      }
      if (&s == &curve.segments().back()) beads_.push_back(b);
    }
  }

  bool may_reach(const Vec3& a, const Vec3& b, const Vec3& c) const {
    const Vec3 center = (a + b + c) / 3;
    return may_reach(
        center,
        std::sqrt(std::max({(a - center).squaredNorm(), (b - center).squaredNorm(), (c - center).squaredNorm()})));
  }
  /// Tells so of the ball about an edge. Every point of a triangle is in that of one of its edges.
  bool may_reach(const Vec3& a, const Vec3& b) const { return may_reach((a + b) / 2, (a - b).norm() / 2); }

 private:
  static constexpr double k_spacing = 0.125;  ///< half of it, as a share of the radius
  bool may_reach(const Vec3& center, double size) const { return may_reach(center, reach_ + size, 0, beads_.size()); }
  /// Halves a run of beads unless it is farther away than it is long on the one side of its middle.
  bool may_reach(const Vec3& center, double reach, std::size_t begin, std::size_t end) const {
    if (begin == end) return false;
    const std::size_t middle = begin + (end - begin) / 2;
    const double away = (beads_[middle] - center).norm();
    if (away <= reach) return true;
    // By one step more, as faces of a curve may hang together up to rounding alone.
    if (away - reach > step_ * static_cast<double>(middle - begin + 1)) return false;
    return may_reach(center, reach, begin, middle) || may_reach(center, reach, middle + 1, end);
  }

  double reach_, step_;
  std::vector<Vec3> beads_;
};

/// Tells where the edge of two nodes, the smaller first, is divided: a share in (0, 1), or 0 for nowhere.
using Where = std::function<double(Index a, Index b)>;

/// Divides edges, and with them their triangles. With walls, new edges between new nodes are walls.
class Divider {
 public:
  Divider(Sheet& sheet, const Mesh& near, bool with_walls) : sheet_(sheet), near_(near), with_walls_(with_walls) {}

  void divide(const JobStage& stage, const Where& where) {
    std::vector<Triangle> old;
    std::vector<Index> faces;
    old.swap(sheet_.triangles);
    faces.swap(sheet_.faces);
    for (std::size_t t = 0; t < old.size(); ++t) {
      stage.check();
      std::array<Index, 3> middles;
      for (int i = 0; i < 3; ++i) middles[i] = node_between(old[t][i], old[t][(i + 1) % 3], faces[t], where);
      divide(old[t], middles, faces[t]);
    }
    if (!nodes_.empty()) divide_lines();
  }

 private:
  Index node_between(Index a, Index b, Index face, const Where& where) {
    if (a > b) std::swap(a, b);
    const double share = where(a, b);
    if (!(share > 0)) return k_none;
    const auto [entry, is_new] = nodes_.try_emplace(edge_key(a, b), k_none);
    if (is_new) entry->second = new_node(a, b, share, face);
    return entry->second;
  }

  Index new_node(Index a, Index b, double share, Index face) {
    Sheet& s = sheet_;
    const auto node = static_cast<Index>(s.points.size());
    s.points.push_back({face, (1 - share) * *barycentric_in(near_, s.points[a], face) +
                                  share * *barycentric_in(near_, s.points[b], face)});
    s.positions.push_back((1 - share) * s.positions[a] + share * s.positions[b]);
    if (s.distance.empty()) return node;
    s.distance.push_back((1 - share) * s.distance[a] + share * s.distance[b]);
    s.along.push_back(with_walls_ ? k_nowhere : (1 - share) * s.along[a] + share * s.along[b]);
    s.side.push_back(with_walls_ ? std::int8_t{0} : s.side[a] != 0 ? s.side[a] : s.side[b]);
    return node;
  }

  void add(Index a, Index b, Index c, Index face) {
    sheet_.triangles.push_back({a, b, c});
    sheet_.faces.push_back(face);
  }

  void wall(Index a, Index b) {
    if (with_walls_) sheet_.walls.insert(edge_key(a, b));
  }

  void divide(const Triangle& t, const std::array<Index, 3>& middles, Index face) {
    const auto count = 3 - std::ranges::count(middles, k_none);
    if (count == 0) return add(t[0], t[1], t[2], face);
    if (count == 3) return divide_thrice(t, middles, face);
    // Turned so that the only node, or the first of two, is on the edge from corner 0.
    int first = 0;
    while (middles[first] == k_none || (count == 2 && middles[(first + 1) % 3] == k_none)) ++first;
    const Index a = t[first], b = t[(first + 1) % 3], c = t[(first + 2) % 3], m = middles[first];
    if (count == 1) {
      add(a, m, c, face);
      return add(m, b, c, face);
    }
    const Index n = middles[(first + 1) % 3];
    wall(m, n);
    add(m, b, n, face);
    const std::vector<Vec3>& at = sheet_.positions;
    if ((at[m] - at[c]).squaredNorm() < (at[a] - at[n]).squaredNorm()) {
      add(a, m, c, face);
      add(m, n, c, face);
    } else {
      add(a, m, n, face);
      add(a, n, c, face);
    }
  }

  void divide_thrice(const Triangle& t, const std::array<Index, 3>& m, Index face) {
    if (!with_walls_) {
      add(m[0], m[1], m[2], face);
      for (int i = 0; i < 3; ++i) add(t[i], m[i], m[(i + 2) % 3], face);
      return;
    }
    const Index half = new_node(m[0], m[1], 0.5, face), center = new_node(half, m[2], 1.0 / 3, face);
    for (int i = 0; i < 3; ++i) {
      wall(m[i], center);
      add(t[i], m[i], center, face);
      add(t[i], center, m[(i + 2) % 3], face);
    }
  }

  /// The curve, the lines across its ends and walls run on through new nodes.
  void divide_lines() {
    const auto divided = [&](const std::vector<Index>& line) {
      std::vector<Index> finer;
      for (std::size_t i = 0; i < line.size(); ++i) {
        if (i > 0)
          if (const Index node = known_between(line[i - 1], line[i]); node != k_none) finer.push_back(node);
        finer.push_back(line[i]);
      }
      return finer;
    };
    sheet_.curve = divided(sheet_.curve);
    for (std::vector<Index>& line : sheet_.across) line = divided(line);
    for (const auto& [key, node] : nodes_) {
      if (sheet_.walls.erase(key) == 0) continue;
      sheet_.walls.insert(edge_key(static_cast<Index>(key >> 32), node));
      sheet_.walls.insert(edge_key(static_cast<Index>(key & 0xffffffffU), node));
    }
  }

  Index known_between(Index a, Index b) const {
    const auto found = nodes_.find(edge_key(a, b));
    return found == nodes_.end() ? k_none : found->second;
  }

  Sheet& sheet_;
  const Mesh& near_;
  bool with_walls_;
  std::unordered_map<std::uint64_t, Index> nodes_;
};

/// The sheet's triangles as a mesh, on which every one has an area. Where one has none in space but for rounding all
/// edges are taken for longer by next to nothing (mollification [sharpcrane2020]).
Mesh mesh_with_areas(const std::vector<double>& xyz, const std::vector<Index>& triangles, const JobStage& stage) {
  const auto at = [&](std::size_t corner) {
    return Vec3(xyz.data() + 3 * static_cast<std::size_t>(triangles[corner]));
  };
  bool has_areas = true;
  std::vector<double> lengths;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    stage.check();
    const Vec3 a = at(t), b = at(t + 1), c = at(t + 2);
    has_areas &= !is_degenerate_face(a, b, c);
    lengths.insert(lengths.end(), {(b - a).norm(), (c - b).norm(), (a - c).norm()});
  }
  if (has_areas) return {xyz, triangles, stage};
  const double more = k_mollified * std::ranges::max(lengths);
  for (double& length : lengths) length += more;
  return {xyz, triangles, {.lengths = lengths}};
}

/// Tells whether two points of a line are farther apart than by rounding: of coordinates in their face, since places
/// far from the origin are rounded by more.
bool is_step(const Mesh& mesh, const SurfacePoint& a, const SurfacePoint& b, double least) {
  constexpr double k_rounding = 1e-13;
  const Index face = shared_face(mesh, a, b, k_barycentric_tolerance);
  if (face == k_none) return false;
  const FaceChart chart(mesh, face);
  const double longest = std::ranges::max(mesh.lengths().subspan(3 * static_cast<std::size_t>(face), 3));
  const auto place = [&](const SurfacePoint& point) {
    return chart.to_plane(*barycentric_in(mesh, point, face, k_barycentric_tolerance));
  };
  return (place(b) - place(a)).norm() > std::max(least, k_rounding * longest);
}

/// Ends a line where it comes back to a face: no shortest one does.
void drop_returns(const Mesh& mesh, SurfacePoints& line) {
  std::unordered_set<Index> passed;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Index face = shared_face(mesh, line[i - 1], line[i], k_barycentric_tolerance);
    if (!passed.insert(face).second) return line.resize(i);
  }
}

/// Straightest lines from an end of the curve, or from where a closed one starts: to the left and to the right.
std::array<SurfacePoints, 2> lines_across(const Unfolding& unfolding, const SurfaceCurve& curve, bool at_start,
                                          double reach) {
  const Mesh& mesh = unfolding.mesh();
  const CurveSegment &first = curve.segments().front(), &last = curve.segments().back();
  const SurfacePoint point = end_point(at_start ? first : last, at_start);
  const DirectionsAtPoint star(unfolding, point);
  double left, right;
  if (curve.closed()) {
    const double ahead = direction_of(mesh, star, first, true), back = direction_of(mesh, star, last, false);
    const double between = back >= ahead ? back - ahead : back - ahead + star.total_angle();
    left = ahead + between / 2;
    right = left + star.total_angle() / 2;
  } else {
    const double along = direction_of(mesh, star, at_start ? first : last, at_start);
    const double quarter = at_start ? std::numbers::pi / 2 : -std::numbers::pi / 2;
    left = along + quarter;
    right = along - quarter;
  }
  double most = 0;  // that a line through each face once can be long
  for (const double length : mesh.lengths()) most += length;
  std::array<SurfacePoints, 2> lines;
  for (int i = 0; i < 2; ++i) {
    double angle = i == 0 ? left : right;
    const double begin = star.begin(), end = begin + star.total_angle();
    if (star.is_round())
      angle = begin + std::fmod(std::fmod(angle - begin, end - begin) + (end - begin), end - begin);
    else if (angle < begin || angle > end)
      continue;
    lines[i] = trace(mesh, point, angle, std::min(reach, most)).path.surface;
    drop_returns(mesh, lines[i]);
  }
  return lines;
}

/// Halves edges between two points of the curve, which would have no width in the map; where the curve comes near to
/// itself or turns back the cut locus is between.
void divide_between_curve(Sheet& sheet, const Mesh& near, bool closed, const JobStage& stage) {
  std::vector<double> along(sheet.points.size(), k_nowhere);
  double length = 0;
  for (std::size_t i = 0; i < sheet.curve.size(); ++i) {
    if (i > 0) length += (sheet.positions[sheet.curve[i]] - sheet.positions[sheet.curve[i - 1]]).norm();
    if (i == 0 || sheet.curve[i] != sheet.curve[0]) along[sheet.curve[i]] = length;
  }
  for (const bool with_walls : {true, false}) {
    const auto known = static_cast<Index>(along.size());
    Divider(sheet, near, with_walls).divide(stage, [&](Index a, Index b) -> double {
      if (b >= known || std::isnan(along[a]) || std::isnan(along[b]) || sheet.walls.contains(edge_key(a, b))) return 0;
      double apart = std::abs(along[a] - along[b]);
      if (closed) apart = std::min(apart, length - apart);
      return with_walls && apart <= k_apart * (sheet.positions[a] - sheet.positions[b]).norm() ? 0 : 0.5;
    });
  }
}

/// Returns where an edge of this size has the distance, as a share of it: its ends are at these distances, their
/// nearest points so far apart. Squares of distances from a point are quadratic along it; from a line, where those
/// points are as far apart as the edge is long beside it, the distances are linear; about a round bend the truth lies
/// between.
double share_at(double distance, double from, double to, double size, double apart) {
  const double climb = to - from, beside = std::sqrt(std::max(size * size - climb * climb, 0.0));
  // from^2 + linear t + square t^2 = distance^2
  const double square = climb * climb + (std::isfinite(apart) ? beside * (beside - apart) : 0);
  const double linear = to * to - from * from - square, rest = from * from - distance * distance;
  const double root = std::sqrt(std::max(linear * linear - 4 * square * rest, 0.0));
  // Of the roots the one between the ends, at which the distance rises from the first to the second as they say.
  const double share = climb > 0 ? -2 * rest / (linear + root) : -2 * rest / (linear - root);
  return share > 0 && share < 1 ? share : (distance - from) / climb;
}

}  // namespace

NearPart near_part(const Mesh& whole, const SurfaceCurve& curve, double radius, const JobStage& stage) {
  const Beads beads(curve, radius);
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(whole.face_count()), 0);
  std::vector<Index> faces;
  const auto look_at = [&](Index face) {
    if (seen[face]) return;
    seen[face] = 1;
    const Triangle& t = whole.triangles()[face];
    if (beads.may_reach(whole.position(t[0]), whole.position(t[1]), whole.position(t[2]))) faces.push_back(face);
  };
  for (const CurveSegment& segment : curve.segments()) look_at(segment.face);
  for (std::size_t next = 0; next < faces.size(); ++next) {
    if (next % 4096 == 0) stage.check();
    for (int i = 0; i < 3; ++i)
      if (const Index twin = whole.twin(3 * faces[next] + i); twin != k_none) look_at(Mesh::face_of(twin));
  }
  std::ranges::sort(faces);
  std::vector<Index> place(static_cast<std::size_t>(whole.face_count()), k_none);
  for (std::size_t i = 0; i < faces.size(); ++i) place[faces[i]] = static_cast<Index>(i);
  // Where two parts meet at a vertex alone, each has it for itself.
  DisjointSets corners(3 * static_cast<Index>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const Index twin = whole.twin(3 * faces[i] + k);
      if (twin == k_none || place[Mesh::face_of(twin)] == k_none) continue;
      const Index h = 3 * static_cast<Index>(i) + k, t = 3 * place[Mesh::face_of(twin)] + twin % 3;
      corners.join(h, Mesh::next(t));
      corners.join(Mesh::next(h), t);
    }
  }
  std::vector<Index> number(3 * faces.size());
  std::vector<double> xyz;
  const Vec3 origin = whole.position(whole.from(3 * curve.segments().front().face));
  for (Index c = 0; c < static_cast<Index>(number.size()); ++c) {
    const Index root = corners.root(c);
    if (root == c) {
      number[c] = static_cast<Index>(xyz.size() / 3);
      const Vec3 at = whole.position(whole.from(3 * faces[c / 3] + c % 3)) - origin;
      xyz.insert(xyz.end(), at.begin(), at.end());
    } else {
      number[c] = number[root];
    }
  }
  return {Mesh(xyz, number, stage), std::move(faces)};
}

Sheet cut_sheet(const Mesh& whole, const NearPart& part, const SurfaceCurve& curve, double radius, double size,
                const JobStage& stage) {
  const Mesh& near = part.mesh;
  const Unfolding unfolding(near);
  // Straight pieces one by one, since a line across may cross itself where it is no longer shortest.
  std::vector<SurfaceCurve> pieces;
  std::array<std::size_t, 5> begins{};
  std::array<SurfacePoints, 4> lines;
  for (const bool at_start : {true, false}) {
    if (!at_start && curve.closed()) break;
    // As far as edges that are cut at the radius: past an end of the curve distances are no longer linear.
    auto both = lines_across(unfolding, curve, at_start, radius + size);
    for (int i = 0; i < 2; ++i) lines[(at_start ? 0 : 2) + i] = std::move(both[i]);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    begins[i] = pieces.size();
    for (std::size_t k = 1; k < lines[i].size(); ++k)
      if (is_step(near, lines[i][k - 1], lines[i][k], k_at_radius * k_at_radius * radius))
        pieces.emplace_back(near, SurfacePoints{lines[i][k - 1], lines[i][k]});
  }
  begins[4] = pieces.size();
  std::vector<const SurfaceCurve*> all{&curve};
  for (const SurfaceCurve& piece : pieces) all.push_back(&piece);
  // Beyond the radius as well, that a triangle with a part within it has no vertex that is farther beyond than `size`.
  const Beads beads(curve, radius + size);
  const Fineness fineness{size, [&](const Vec3& a, const Vec3& b) { return beads.may_reach(a, b); }, whole, part.faces};
  BarrierCuts cuts(near, {}, all, stage, &fineness);
  Sheet sheet;
  for (Index f = 0; f < near.face_count(); ++f) {
    stage.check();
    if (cuts.is_cut(f))
      cuts.cut(f, sheet.triangles);
    else
      sheet.triangles.push_back(near.triangles()[f]);
    sheet.faces.resize(sheet.triangles.size(), f);
  }
  sheet.points = cuts.points();
  for (std::size_t i = 0; i < sheet.points.size(); ++i)
    sheet.positions.push_back(static_cast<Index>(i) < near.vertex_count() ? near.position(static_cast<Index>(i))
                                                                          : position(near, sheet.points[i]));
  sheet.curve = cuts.line(0);
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = begins[i]; k < begins[i + 1]; ++k)
      for (const Index node : cuts.line(k + 1))
        if (sheet.across[i].empty() || sheet.across[i].back() != node) sheet.across[i].push_back(node);
  for (std::size_t i = 1; i < sheet.curve.size(); ++i) sheet.walls.insert(edge_key(sheet.curve[i - 1], sheet.curve[i]));
  divide_between_curve(sheet, near, curve.closed(), stage);
  return sheet;
}

void measure(Sheet& sheet, bool closed, double length, double reach, const JobStage& stage) {
  std::vector<Index> vertex(sheet.points.size(), k_none), node;
  std::vector<double> xyz;
  std::vector<Index> triangles;
  for (const Triangle& t : sheet.triangles) {
    stage.check();
    for (const Index corner : t) {
      if (vertex[corner] == k_none) {
        vertex[corner] = static_cast<Index>(node.size());
        node.push_back(corner);
        xyz.insert(xyz.end(), sheet.positions[corner].begin(), sheet.positions[corner].end());
      }
      triangles.push_back(vertex[corner]);
    }
  }
  const Mesh fine = mesh_with_areas(xyz, triangles, stage.part(0, 0.2));
  SurfacePoints line;
  for (const Index c : sheet.curve) line.push_back(at_vertex(fine, vertex[c]));
  if (closed) line.pop_back();
  const SurfaceCurve curve(fine, std::move(line), closed);
  const Unfolding unfolding(fine, 1, stage.part(0.2, 0.2));
  CurveWindows windows(unfolding);
  std::vector<CurveFoot> feet;
  windows.from_curve(curve, {.radius = reach}, feet, stage.part(0.2, 0.2), nullptr,
                     [&](double distance, Index) { stage.update(0.2 + 0.8 * distance / reach); });
  sheet.distance.assign(sheet.points.size(), std::numeric_limits<double>::infinity());
  sheet.along.assign(sheet.points.size(), k_nowhere);
  sheet.side.assign(sheet.points.size(), 0);
  for (const CurveFoot& foot : feet) {
    const Index n = node[foot.vertex];
    sheet.distance[n] = foot.distance;
    sheet.along[n] = foot.along * (length / curve.length());
    sheet.side[n] = foot.side;
  }
  for (const Index n : sheet.curve) sheet.distance[n] = 0;
  for (std::vector<Index>& across : sheet.across) {
    double there = 0;
    std::size_t good = across.empty() ? 0 : 1;
    for (; good < across.size(); ++good) {
      there += (sheet.positions[across[good]] - sheet.positions[across[good - 1]]).norm();
      if (!(sheet.distance[across[good]] >= there * (closed ? k_increase : 1 - k_shortest))) break;
      if (sheet.distance[across[good]] <= sheet.distance[across[good - 1]]) break;
      sheet.walls.insert(edge_key(across[good - 1], across[good]));
    }
    across.resize(good);
  }
}

void cut_at_cut_locus(Sheet& sheet, const Mesh& near, bool closed, double length, const JobStage& stage) {
  Divider(sheet, near, true).divide(stage, [&](Index a, Index b) -> double {
    if (sheet.distance[a] == 0 || sheet.distance[b] == 0) return 0;
    if (!std::isfinite(sheet.distance[a]) || !std::isfinite(sheet.distance[b])) return 0;
    const double size = (sheet.positions[a] - sheet.positions[b]).norm();
    double apart = std::abs(sheet.along[a] - sheet.along[b]);
    if (closed) apart = std::min(apart, length - apart);
    if (sheet.side[a] * sheet.side[b] >= 0 && apart <= k_apart * size) return 0;
    if (sheet.walls.contains(edge_key(a, b))) return 0;
    // Both distances grow towards the cut locus, at most as fast as one comes nearer.
    return std::clamp(0.5 + (sheet.distance[b] - sheet.distance[a]) / (2 * size), 0.1, 0.9);
  });
}

void cut_at_radius(Sheet& sheet, const Mesh& near, bool closed, double length, double radius, const JobStage& stage) {
  for (double& distance : sheet.distance)
    if (std::abs(distance - radius) <= k_at_radius * radius) distance = radius;
  const std::size_t count = sheet.points.size();
  Divider(sheet, near, false).divide(stage, [&](Index a, Index b) -> double {
    const double from = sheet.distance[a], to = sheet.distance[b];
    if (!std::isfinite(from + to) || (from - radius) * (to - radius) >= 0) return 0;
    double apart = std::abs(sheet.along[a] - sheet.along[b]);
    if (closed) apart = std::min(apart, length - apart);
    return share_at(radius, from, to, (sheet.positions[a] - sheet.positions[b]).norm(), apart);
  });
  std::fill(sheet.distance.begin() + static_cast<std::ptrdiff_t>(count), sheet.distance.end(), radius);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < sheet.triangles.size(); ++t) {
    const Triangle& of = sheet.triangles[t];
    if (!std::ranges::all_of(of, [&](Index n) { return sheet.distance[n] <= radius; })) continue;
    sheet.triangles[kept] = of;
    sheet.faces[kept++] = sheet.faces[t];
  }
  sheet.triangles.resize(kept);
  sheet.faces.resize(kept);
}

}  // namespace saddleback::charts
