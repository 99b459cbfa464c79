#include <algorithm>
#include <compare>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"
#include "support/disjoint_sets.h"
#include "support/threads/parallel.h"

namespace saddleback {

std::vector<Vec3> vertex_normals(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
  check_corners(triangles, static_cast<Index>(vertices.size()));
  std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
  for (const Triangle& t : triangles) {
    const Vec3 doubled = (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
    for (const Index v : t) normals[v] += doubled;
  }
  for (Vec3& normal : normals) {
    const double length = normal.norm();
    if (length > 0) normal /= length;
  }
  return normals;
}

std::vector<double> neighbor_means(std::span<const double> values, Index width, std::span<const Triangle> triangles) {
  if (width <= 0 || values.size() % width != 0)
    throw InputError(message("values: ", values.size(), " numbers are no rows of ", width));
  const auto count = static_cast<Index>(values.size() / width);
  check_corners(triangles, count);
  std::vector<double> means(values.size(), 0.0);
  std::vector<Index> times(count, 0);
  for (const Triangle& t : triangles)
    for (int i = 0; i < 3; ++i) {
      const double *next = &values[std::size_t(t[(i + 1) % 3]) * width],
                   *last = &values[std::size_t(t[(i + 2) % 3]) * width];
      double* mean = &means[std::size_t(t[i]) * width];
      for (Index k = 0; k < width; ++k) mean[k] += next[k] + last[k];
      times[t[i]] += 2;
    }
  for (Index v = 0; v < count; ++v)
    if (times[v] > 0)
      for (Index k = 0; k < width; ++k) means[std::size_t(v) * width + k] /= times[v];
  return means;
}

std::vector<Vec3> smoothed_directions(std::span<const Vec3> directions, std::span<const Triangle> triangles, int rounds,
                                      const JobStage& stage) {
  constexpr double k_own = 0.2;
  constexpr Index k_at_once = 4096;
  if (rounds < 0) throw InputError(message("rounds: wanted 0 or more, got ", rounds));
  const CornerTable table(triangles, static_cast<Index>(directions.size()));
  std::vector<Vec3> smooth(directions.begin(), directions.end()), next(directions.size());
  for (int round = 0; round < rounds; ++round) {
    parallel_for(table.vertex_count(), 0, k_at_once, [&](Index v, int) {
      if (v % k_at_once == 0) stage.check();
      const std::span<const CornerTable::Corner> corners = table.at(v);
      Vec3 sum = Vec3::Zero();
      for (const CornerTable::Corner& corner : corners) sum += smooth[corner.next] + smooth[corner.previous];
      if (!corners.empty()) sum /= 2.0 * static_cast<double>(corners.size());
      sum += k_own * smooth[v];
      const double length = sum.norm();
      next[v] = length > 0 ? Vec3(sum / length) : directions[v];
    });
    smooth.swap(next);
    stage.update(static_cast<double>(round + 1) / rounds);
  }
  return smooth;
}

std::vector<Index> connected_parts(std::span<const Triangle> triangles, Index vertex_count) {
  check_corners(triangles, vertex_count);
  DisjointSets sets(vertex_count);
  for (const Triangle& t : triangles)
    for (const Index v : {t[1], t[2]}) sets.join(t[0], v);
  std::vector<Index> number(vertex_count, k_none), parts;
  parts.reserve(triangles.size());
  Index count = 0;
  for (const Triangle& t : triangles) {
    Index& mine = number[sets.root(t[0])];
    if (mine == k_none) mine = count++;
    parts.push_back(mine);
  }
  return parts;
}

BorderEdges border_edges(std::span<const Triangle> triangles, Index vertex_count) {
  const CornerTable table(triangles, vertex_count);
  struct Edge {
    Index triangle, from, to;
    auto operator<=>(const Edge&) const = default;
  };
  std::vector<Edge> edges;
  for (Index vertex = 0; vertex < vertex_count; ++vertex) {
    const auto corners = table.at(vertex);
    const SharedEdges shared(corners);
    for (const CornerTable::Corner& corner : corners) {
      const auto any = [](const CornerTable::Corner&) { return true; };
      if (!shared.any(corner, any)) edges.push_back({corner.triangle, vertex, corner.next});
    }
  }
  std::ranges::sort(edges);
  BorderEdges result;
  for (const Edge& edge : edges) {
    result.ends.push_back({edge.from, edge.to});
    result.triangles.push_back(edge.triangle);
  }
  return result;
}

}  // namespace saddleback
