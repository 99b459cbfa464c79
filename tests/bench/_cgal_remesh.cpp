// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic remeshing by CGAL, for the benchmark of tessellation: cgal_remesh MESH MADE EDGE_LENGTH. Both meshes:
// counts (int64), positions (float64), triangles (int32). Tells its CPU seconds.
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

using Kernel = CGAL::Simple_cartesian<double>;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
using Vertex = Surface::Vertex_index;

bool read(const char* name, Surface& mesh) {
  std::FILE* file = std::fopen(name, "rb");
  std::int64_t counts[2];
  if (std::fread(counts, sizeof counts[0], 2, file) != 2) return false;
  std::vector<double> positions(3 * counts[0]);
  std::vector<std::int32_t> corners(3 * counts[1]);
  if (std::fread(positions.data(), sizeof(double), positions.size(), file) != positions.size()) return false;
  if (std::fread(corners.data(), sizeof(std::int32_t), corners.size(), file) != corners.size()) return false;
  std::fclose(file);
  for (std::int64_t v = 0; v < counts[0]; ++v)
    mesh.add_vertex(Kernel::Point_3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
  for (std::int64_t f = 0; f < counts[1]; ++f)
    mesh.add_face(Vertex(corners[3 * f]), Vertex(corners[3 * f + 1]), Vertex(corners[3 * f + 2]));
  return true;
}

void write(const char* name, const Surface& mesh) {
  std::FILE* file = std::fopen(name, "wb");
  const std::int64_t counts[2] = {static_cast<std::int64_t>(mesh.number_of_vertices()),
                                  static_cast<std::int64_t>(mesh.number_of_faces())};
  std::fwrite(counts, sizeof counts[0], 2, file);
  for (const Vertex v : mesh.vertices()) {
    const double place[3] = {mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z()};
    std::fwrite(place, sizeof place[0], 3, file);
  }
  for (const auto face : mesh.faces())
    for (const Vertex v : mesh.vertices_around_face(mesh.halfedge(face))) {
      const auto corner = static_cast<std::int32_t>(v.idx());
      std::fwrite(&corner, sizeof corner, 1, file);
    }
  std::fclose(file);
}

int main(int, char** arguments) {
  namespace pmp = CGAL::Polygon_mesh_processing;
  Surface mesh;
  if (!read(arguments[1], mesh)) return 1;
  const std::clock_t start = std::clock();
  pmp::isotropic_remeshing(mesh.faces(), std::atof(arguments[3]), mesh,
                           pmp::parameters::number_of_iterations(10).number_of_relaxation_steps(3));
  std::printf("%f\n", static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  mesh.collect_garbage();
  write(arguments[2], mesh);
}
