// The map is linear in every face of the surface, so what a chord misses is largest where it crosses an edge of the
// surface, and what a triangle misses at a vertex: samples find about where, and a search the place itself. Split
// there, the pieces lie in faces.

#include "shape_mapping/surface_fit.h"

#include <algorithm>
#include <cmath>

#include "saddleback/shape_mapping/conform.h"

#include "support/planar.h"

namespace saddleback {
namespace {

constexpr int k_most_depth = 9;
constexpr int k_least_samples = 3, k_most_samples = 16, k_most_rows = 6;
/// Samples are so far apart, in heights of the surface's triangles.
constexpr double k_sample_step = 0.8;
/// Says what samples are held to, as a share of the tolerance: they are seldom at the worst place.
constexpr double k_sampled = 0.85;
constexpr int k_search_steps = 12;  ///< a thousandth of the way between samples
/// The share of an edge nearer to a corner than which nothing is split: slivers would not lie better.
constexpr double k_margin = 0.08;

double distance_to_plane(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  return length > 0 ? std::abs(normal.dot(point - a)) / length : 0;
}

}  // namespace

SolidEdges::SolidEdges(const Solid& solid) : triangle(solid.triangles.size()) {
  struct Side {
    Index low, high, place;
  };
  std::vector<Side> sides;
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const Index a = solid.triangles[t][i], b = solid.triangles[t][(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<Index>(3 * t) + i});
    }
  std::ranges::sort(sides, [](const Side& a, const Side& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.place < b.place;
  });
  for (const Side& side : sides) {
    if (ends.empty() || ends.back()[0] != side.low || ends.back()[1] != side.high)
      ends.push_back({side.low, side.high});
    triangle[side.place / 3][side.place % 3] = static_cast<Index>(ends.size()) - 1;
  }
}

void SurfaceFit::bend(OutlineMapper& mapper, const Placement& placement, const Solid& solid, const SolidEdges& edges,
                      double tolerance) {
  mapper_ = &mapper;
  center_ = placement.center;
  scale_ = placement.scale;
  tolerance_ = k_sampled * tolerance;
  deviation_ = 0;
  hint_ = mapper.plane().center_face();
  vertices_.clear();
  edges_.clear();
  faces_.clear();
  for (const Vec3& vertex : solid.vertices) add(vertex);
  for (const auto& [begin, end] : edges.ends) add_edge(begin, end, 0);
  for (std::size_t t = 0; t < solid.triangles.size(); ++t) {
    parts_.push_back({{solid.triangles[t], static_cast<Index>(t), {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}},
                      edges.triangle[t],
                      0});
    while (!parts_.empty()) {
      const Part part = parts_.back();
      parts_.pop_back();
      divide(part);
    }
  }
}

/// Returns where a point of the shape's space comes to lie; in mesh order of the walk from the last one.
SurfaceFit::Vertex SurfaceFit::lay(const Vec3& given) {
  const Vec2 place = mapper_->laid(given.head<2>());
  const MapFailure failure = mapper_->find(place, hint_);
  Vertex result{given, center_, scale_ * given.z(), Vec3::Zero(), failure != MapFailure::none};
  if (!result.is_lost) result.anchor = mapper_->plane().surface_point(place, hint_);
  result.position = position(*mesh_, result.anchor);
  if (result.height != 0) result.position += result.height * normal_at(*mesh_, normals_, result.anchor);
  return result;
}

Index SurfaceFit::add(const Vec3& given) {
  vertices_.push_back(lay(given));
  return static_cast<Index>(vertices_.size()) - 1;
}

Index SurfaceFit::add_edge(Index begin, Index end, int depth) {
  edges_.push_back({begin, end, depth, tolerance_ <= 0, k_none, k_none});
  return static_cast<Index>(edges_.size()) - 1;
}

double SurfaceFit::sample_length(const Vertex& vertex) const {
  const Index h = 3 * vertex.anchor.face;
  const double longest = std::max({mesh_->length(h), mesh_->length(h + 1), mesh_->length(h + 2)});
  return k_sample_step * 2 * mesh_->face_area(vertex.anchor.face) / longest;
}

/// Returns where the surface is farthest from the chord between two vertices.
SurfaceFit::Peak SurfaceFit::peak_of_edge(const Vertex& a, const Vertex& b) {
  Peak peak;
  if (a.is_lost || b.is_lost) return peak;
  const bool is_in_face = a.anchor.face == b.anchor.face;
  if (is_in_face && a.height == 0 && b.height == 0) return peak;
  const auto miss = [&](double along) {
    const Vertex there = lay((1 - along) * a.given + along * b.given);
    return there.is_lost ? 0 : distance_to_segment(there.position, a.position, b.position);
  };
  const double length = scale_ * (b.given - a.given).norm(), step = std::min(sample_length(a), sample_length(b));
  const int count =
      is_in_face ? 1 : static_cast<int>(std::clamp(length / step, 1.0 * k_least_samples, 1.0 * k_most_samples));
  for (int i = 1; i <= count; ++i) {
    const double along = static_cast<double>(i) / (count + 1), height = miss(along);
    if (height > peak.height) peak.height = height, peak.along = along;
  }
  // Between samples the surface may be as far again as at the best of them.
  if (peak.height <= 0.5 * tolerance_) return peak;
  double low = peak.along - 1.0 / (count + 1), high = peak.along + 1.0 / (count + 1);
  for (int i = 0; i < k_search_steps; ++i) {
    const double left = low + 0.382 * (high - low), right = high - 0.382 * (high - low);
    const double at_left = miss(left), at_right = miss(right);
    peak.height = std::max({peak.height, at_left, at_right});
    (at_left > at_right ? high : low) = at_left > at_right ? right : left;
  }
  peak.along = std::clamp(0.5 * (low + high), k_margin, 1 - k_margin);
  return peak;
}

/// Returns where the surface is farthest from the plane of a face.
SurfaceFit::Peak SurfaceFit::peak_of_face(const Face& face) {
  Peak peak;
  const Vertex a = vertices_[face.vertices[0]], b = vertices_[face.vertices[1]], c = vertices_[face.vertices[2]];
  if (a.is_lost || b.is_lost || c.is_lost) return peak;
  const bool is_in_face = a.anchor.face == b.anchor.face && a.anchor.face == c.anchor.face;
  if (is_in_face && a.height == 0 && b.height == 0 && c.height == 0) return peak;
  const double longest =
      scale_ * std::sqrt(std::max({(b.given - a.given).squaredNorm(), (c.given - b.given).squaredNorm(),
                                   (a.given - c.given).squaredNorm()}));
  const double step = std::min({sample_length(a), sample_length(b), sample_length(c)});
  const int rows = is_in_face ? 1 : static_cast<int>(std::clamp(longest / (2 * step), 1.0, k_most_rows - 1.0)) + 1;
  const auto look = [&](double along, double up) {  // in rows
    const Vec3 weights = Vec3(rows - along - up, along, up) / rows;
    const Vertex there = lay(weights[0] * a.given + weights[1] * b.given + weights[2] * c.given);
    const double height = there.is_lost ? 0 : distance_to_plane(there.position, a.position, b.position, c.position);
    if (height > peak.height) peak.height = height, peak.weights = weights;
  };
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i + j < rows; ++i) {
      look(i + 1.0 / 3, j + 1.0 / 3);
      if (i + j + 1 < rows) look(i + 2.0 / 3, j + 2.0 / 3);
    }
  return peak;
}

/// The vertex that splits an edge; k_none where it lies well.
Index SurfaceFit::middle_of(Index number) {
  if (!edges_[number].is_decided) {
    edges_[number].is_decided = true;
    const Index begin = edges_[number].begin, end = edges_[number].end;
    const int depth = edges_[number].depth + 1;
    const Vertex a = vertices_[begin], b = vertices_[end];
    const Peak peak = peak_of_edge(a, b);
    if (peak.height <= tolerance_ || depth > k_most_depth) {
      deviation_ = std::max(deviation_, peak.height);
    } else {
      const Index middle = add((1 - peak.along) * a.given + peak.along * b.given);
      const Index first = add_edge(begin, middle, depth);
      add_edge(middle, end, depth);
      edges_[number].middle = middle;
      edges_[number].children = first;
    }
  }
  return edges_[number].middle;
}

void SurfaceFit::divide(const Part& part) {
  int split = 0, one = 0, whole = 0;
  for (int i = 0; i < 3; ++i) {
    const bool is_split = middle_of(part.edges[i]) != k_none;
    split += is_split ? 1 : 0;
    (is_split ? one : whole) = i;
  }
  if (split == 1) return cut_one(part, one);
  if (split == 2) return cut_two(part, whole);
  if (split == 3) return cut_three(part);
  if (tolerance_ > 0) {
    const Peak peak = peak_of_face(part.face);
    if (peak.height > tolerance_ && part.depth < k_most_depth) return divide_inside(part, peak);
    deviation_ = std::max(deviation_, peak.height);
  }
  faces_.push_back(part.face);
}

/// `vertices` by their weights in the part's own face.
SurfaceFit::Part SurfaceFit::child(const Part& part, const std::array<Index, 3>& vertices,
                                   const std::array<Vec3, 3>& weights, const std::array<Index, 3>& edges) const {
  Part result{{{vertices[0], vertices[1], vertices[2]}, part.face.source, {}}, edges, part.depth + 1};
  const std::array<Vec3, 3>& own = part.face.weights;
  for (int i = 0; i < 3; ++i)
    result.face.weights[i] = weights[i][0] * own[0] + weights[i][1] * own[1] + weights[i][2] * own[2];
  return result;
}

/// The half of a split edge at its begin or end, as the part runs through it.
Index SurfaceFit::half(const Part& part, int edge, bool first) const {
  const Edge& split = edges_[part.edges[edge]];
  const bool runs_along = split.begin == part.face.vertices[edge];
  return split.children + (runs_along == first ? 0 : 1);
}

namespace {

/// Returns where on an edge of a face, from corner i, a point of the shape's space lies.
Vec3 weights_on_edge(int i, const Vec3& from, const Vec3& to, const Vec3& point) {
  const double along = (point - from).norm(), rest = (to - point).norm();
  const double share = along + rest > 0 ? along / (along + rest) : 0.5;
  return (1 - share) * Vec3::Unit(i) + share * Vec3::Unit((i + 1) % 3);
}

}  // namespace

void SurfaceFit::cut_one(const Part& part, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const Triangle& v = part.face.vertices;
  const Index m = edges_[part.edges[i]].middle;
  const Vec3 w = weights_on_edge(i, vertices_[v[i]].given, vertices_[v[j]].given, vertices_[m].given);
  const Index across = add_edge(m, v[k], part.depth + 1);
  parts_.push_back(
      child(part, {v[i], m, v[k]}, {Vec3::Unit(i), w, Vec3::Unit(k)}, {half(part, i, true), across, part.edges[k]}));
  parts_.push_back(
      child(part, {m, v[j], v[k]}, {w, Vec3::Unit(j), Vec3::Unit(k)}, {half(part, i, false), part.edges[j], across}));
}

/// The corner opposite the whole edge is cut off; of what remains the shorter diagonal is taken.
void SurfaceFit::cut_two(const Part& part, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const Triangle& v = part.face.vertices;
  const Index m = edges_[part.edges[j]].middle, n = edges_[part.edges[k]].middle;
  const Vec3 wm = weights_on_edge(j, vertices_[v[j]].given, vertices_[v[k]].given, vertices_[m].given);
  const Vec3 wn = weights_on_edge(k, vertices_[v[k]].given, vertices_[v[i]].given, vertices_[n].given);
  const Index across = add_edge(m, n, part.depth + 1);
  parts_.push_back(
      child(part, {m, v[k], n}, {wm, Vec3::Unit(k), wn}, {half(part, j, false), half(part, k, true), across}));
  const bool from_i = (vertices_[v[i]].position - vertices_[m].position).norm() <
                      (vertices_[v[j]].position - vertices_[n].position).norm();
  const Index diagonal = from_i ? add_edge(v[i], m, part.depth + 1) : add_edge(v[j], n, part.depth + 1);
  if (from_i) {
    parts_.push_back(child(part, {v[i], v[j], m}, {Vec3::Unit(i), Vec3::Unit(j), wm},
                           {part.edges[i], half(part, j, true), diagonal}));
    parts_.push_back(child(part, {v[i], m, n}, {Vec3::Unit(i), wm, wn}, {diagonal, across, half(part, k, false)}));
  } else {
    parts_.push_back(child(part, {v[i], v[j], n}, {Vec3::Unit(i), Vec3::Unit(j), wn},
                           {part.edges[i], diagonal, half(part, k, false)}));
    parts_.push_back(child(part, {v[j], m, n}, {Vec3::Unit(j), wm, wn}, {half(part, j, true), across, diagonal}));
  }
}

void SurfaceFit::cut_three(const Part& part) {
  const Triangle& v = part.face.vertices;
  std::array<Index, 3> middle, across;  // edge i of `across` joins the middles on both sides of corner i
  std::array<Vec3, 3> weights;
  for (int i = 0; i < 3; ++i) {
    middle[i] = edges_[part.edges[i]].middle;
    weights[i] = weights_on_edge(i, vertices_[v[i]].given, vertices_[v[(i + 1) % 3]].given, vertices_[middle[i]].given);
  }
  for (int i = 0; i < 3; ++i) across[i] = add_edge(middle[i], middle[(i + 2) % 3], part.depth + 1);
  for (int i = 0; i < 3; ++i)
    parts_.push_back(child(part, {v[i], middle[i], middle[(i + 2) % 3]},
                           {Vec3::Unit(i), weights[i], weights[(i + 2) % 3]},
                           {half(part, i, true), across[i], half(part, (i + 2) % 3, false)}));
  parts_.push_back(child(part, middle, weights, {across[1], across[2], across[0]}));
}

void SurfaceFit::divide_inside(const Part& part, const Peak& peak) {
  const Triangle& v = part.face.vertices;
  Vec3 w = peak.weights.cwiseMax(k_margin);
  w /= w.sum();
  const Vec3 given = w[0] * vertices_[v[0]].given + w[1] * vertices_[v[1]].given + w[2] * vertices_[v[2]].given;
  const Index m = add(given);
  std::array<Index, 3> spokes;
  for (int i = 0; i < 3; ++i) spokes[i] = add_edge(v[i], m, part.depth + 1);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    parts_.push_back(
        child(part, {v[i], v[j], m}, {Vec3::Unit(i), Vec3::Unit(j), w}, {part.edges[i], spokes[j], spokes[i]}));
  }
}

}  // namespace saddleback
