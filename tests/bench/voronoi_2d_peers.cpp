// SPDX-License-Identifier: GPL-3.0-or-later
// Voronoi diagrams by CGAL (exact) and Boost.Polygon (of coordinates rounded to 30 bits), for comparison:
// `voronoi_2d_peers FILE [cgal]`, the file holding pairs of doubles; by CGAL alone if so asked. Prints, one line each:
//   cgal SECONDS VERTICES EDGES      after merging vertices of more than three cells
//   boost SECONDS
// Seconds of processor time from the points to vertices (as coordinates) and edges (as pairs of vertices).

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Unique_hash_map.h>
#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cstdio>
#include <ctime>
#include <utility>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;

static double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

static void run_cgal(const std::vector<Kernel::Point_2>& points) {
  const double start = cpu_seconds();
  const Triangulation triangulation(points.begin(), points.end());
  std::vector<Kernel::Point_2> vertices;
  vertices.reserve(triangulation.number_of_faces());
  CGAL::Unique_hash_map<Triangulation::Face_handle, int> numbers(-1, triangulation.number_of_faces());
  for (auto face = triangulation.finite_faces_begin(); face != triangulation.finite_faces_end(); ++face) {
    numbers[face] = static_cast<int>(vertices.size());
    vertices.push_back(triangulation.circumcenter(face));
  }
  std::vector<std::pair<int, int>> edges;
  edges.reserve(3 * triangulation.number_of_vertices());
  for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end(); ++edge) {
    const int left = numbers[edge->first];  // a value: a face at infinity is new to the map, which may move the others
    edges.emplace_back(left, numbers[edge->first->neighbor(edge->second)]);
  }
  const double seconds = cpu_seconds() - start;

  std::size_t flat = 0;  // edges of no length: a tree within each cluster of coinciding vertices
  if (triangulation.dimension() == 2) {
    for (auto edge = triangulation.finite_edges_begin(); edge != triangulation.finite_edges_end(); ++edge) {
      const auto face = edge->first, other = face->neighbor(edge->second);
      if (triangulation.is_infinite(face) || triangulation.is_infinite(other)) continue;
      const auto& across = other->vertex(other->index(face))->point();
      flat += triangulation.side_of_oriented_circle(face, across) == CGAL::ON_ORIENTED_BOUNDARY;
    }
  }
  std::printf("cgal %.9f %zu %zu\n", seconds, vertices.size() - flat, edges.size() - flat);
}

static void run_boost(const std::vector<Kernel::Point_2>& points) {
  double low[2] = {points[0].x(), points[0].y()}, high[2] = {low[0], low[1]};
  for (const auto& p : points)
    for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  const double scale = 1073741823.0 / std::max({high[0] - low[0], high[1] - low[1], 1e-300});
  std::vector<boost::polygon::point_data<int>> rounded;
  for (const auto& p : points)
    rounded.emplace_back(static_cast<int>((p.x() - low[0]) * scale), static_cast<int>((p.y() - low[1]) * scale));
  const double start = cpu_seconds();
  boost::polygon::voronoi_diagram<double> diagram;
  boost::polygon::construct_voronoi(rounded.begin(), rounded.end(), &diagram);
  std::printf("boost %.9f\n", cpu_seconds() - start);
}

int main(int count, char** arguments) {
  std::FILE* file = count >= 2 ? std::fopen(arguments[1], "rb") : nullptr;
  if (!file) return 1;
  std::vector<Kernel::Point_2> points;
  for (double xy[2]; std::fread(xy, sizeof(double), 2, file) == 2;) points.emplace_back(xy[0], xy[1]);
  std::fclose(file);
  std::setvbuf(stdout, nullptr, _IONBF, 0);  // what one says is not lost when another crashes
  run_cgal(points);
  if (count == 2) run_boost(points);
}
