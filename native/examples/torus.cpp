// Measures distances on a torus, tessellates it and covers it with stars.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "saddleback/saddleback.h"

namespace sb = saddleback;

/// Makes a torus of the radii 1 and 0.4, `rings` times `sides` vertices.
static sb::Mesh make_torus(sb::Index rings, sb::Index sides) {
  std::vector<double> xyz;
  std::vector<sb::Index> triangles;
  for (sb::Index i = 0; i < rings; ++i) {
    for (sb::Index j = 0; j < sides; ++j) {
      const double u = 2 * std::numbers::pi * i / rings, v = 2 * std::numbers::pi * j / sides;
      const double radius = 1 + 0.4 * std::cos(v);
      xyz.insert(xyz.end(), {radius * std::cos(u), radius * std::sin(u), 0.4 * std::sin(v)});
      const sb::Index a = i * sides + j, b = (i + 1) % rings * sides + j;
      const sb::Index c = (i + 1) % rings * sides + (j + 1) % sides, d = i * sides + (j + 1) % sides;
      triangles.insert(triangles.end(), {a, b, c, a, c, d});
    }
  }
  return {xyz, triangles};
}

int main() {
  try {
    const sb::Mesh mesh = make_torus(60, 24);
    const sb::SaddleVertexGraph graph(mesh);
    const std::vector<double> distances = graph.distances(sb::QuerySources(sb::SurfacePoints{at_vertex(mesh, 0)}));
    std::printf("farthest %.6f\n", *std::max_element(distances.begin(), distances.end()));

    const sb::CentroidalVoronoi cvt = sb::centroidal_voronoi(graph, 100);
    double area = 0;
    for (const double cell : cvt.cells.areas) area += cell;
    std::printf("cells %zu area %.9f of %.9f\n", cvt.cells.areas.size(), area, mesh.area());

    const sb::Shape star = sb::shapes::star();
    sb::DistributionOptions options;
    options.counts = {50};
    options.size = {{0.1}};
    const sb::DistributionResult stars = sb::distribute(mesh, {&star, 1}, options);
    std::printf("stars %zu\n", stars.placements.size());
  } catch (const sb::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
