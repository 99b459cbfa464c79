// SPDX-License-Identifier: GPL-3.0-or-later
// One field by CGAL, for the benchmark of geodesics: cgal_geodesics MESH FIELD SOURCE, built with -DKIND_EXACT or
// -DKIND_HEAT. The mesh: counts (int64), positions (float64), triangles (int32). Tells its times and memory as JSON.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <sys/resource.h>
#include <vector>
#ifdef KIND_EXACT
#include <CGAL/Surface_mesh_shortest_path.h>
#else
#include <CGAL/Heat_method_3/Surface_mesh_geodesic_distances_3.h>
#endif

using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }
long peak() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

int main(int, char** arguments) {
  std::FILE* file = std::fopen(arguments[1], "rb");
  std::int64_t counts[2];
  if (std::fread(counts, sizeof counts[0], 2, file) != 2) return 1;
  std::vector<double> positions(3 * counts[0]);
  std::vector<std::int32_t> corners(3 * counts[1]);
  if (std::fread(positions.data(), sizeof(double), positions.size(), file) != positions.size()) return 1;
  if (std::fread(corners.data(), sizeof(std::int32_t), corners.size(), file) != corners.size()) return 1;
  std::fclose(file);
  const long before = peak();
  double start = seconds();
  Surface mesh;
  for (std::int64_t v = 0; v < counts[0]; ++v)
    mesh.add_vertex(Kernel::Point_3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
  using Vertex = Surface::Vertex_index;
  for (std::int64_t f = 0; f < counts[1]; ++f)
    mesh.add_face(Vertex(corners[3 * f]), Vertex(corners[3 * f + 1]), Vertex(corners[3 * f + 2]));
  const Vertex source(std::atoi(arguments[3]));
  std::vector<double> field(counts[0]);
#ifdef KIND_EXACT
  using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Surface>;
  CGAL::Surface_mesh_shortest_path<Traits> paths(mesh);
  const double prepared = seconds() - start;
  start = seconds();
  paths.add_source_point(source);
  paths.build_sequence_tree();
  for (const Vertex v : mesh.vertices()) field[v] = paths.shortest_distance_to_source_points(v).first;
#else
  using Heat = CGAL::Heat_method_3::Surface_mesh_geodesic_distances_3<Surface, CGAL::Heat_method_3::Intrinsic_Delaunay>;
  Heat heat(mesh);
  auto distances = mesh.add_property_map<Vertex, double>("v:distance", 0).first;
  heat.add_source(Vertex(source.idx() == 0 ? 1 : 0));
  heat.estimate_geodesic_distances(distances);  // the first call factors the matrices
  const double prepared = seconds() - start;
  start = seconds();
  heat.clear_sources();
  heat.add_source(source);
  heat.estimate_geodesic_distances(distances);
  for (const Vertex v : mesh.vertices()) field[v] = distances[v];
#endif
  const double taken = seconds() - start;
  file = std::fopen(arguments[2], "wb");
  std::fwrite(field.data(), sizeof(double), field.size(), file);
  std::fclose(file);
  std::printf("{\"prepare\": %.6f, \"field\": %.6f, \"bytes\": %ld}\n", prepared, taken, 1024 * (peak() - before));
}
