#include "tessellation/cell_moments.h"

#include <array>

#include "support/parallel.h"

namespace saddleback {
namespace {

/// Six points, exact to degree 4 (D. A. Dunavant: High degree efficient symmetrical Gaussian quadrature rules, 1985).
struct QuadraturePoint {
  double a, b, weight;  ///< barycentric coordinates a, b, 1 - a - b
};
constexpr double k_a = 0.445948490915965, k_b = 0.091576213509771;
constexpr double k_weight_a = 0.223381589678011, k_weight_b = 0.109951743655322;
constexpr std::array<QuadraturePoint, 6> k_quadrature{{{k_a, k_a, k_weight_a},
                                                       {k_a, 1 - 2 * k_a, k_weight_a},
                                                       {1 - 2 * k_a, k_a, k_weight_a},
                                                       {k_b, k_b, k_weight_b},
                                                       {k_b, 1 - 2 * k_b, k_weight_b},
                                                       {1 - 2 * k_b, k_b, k_weight_b}}};

/// What is known at the corners of a face, for one site.
struct FaceData {
  Vec3 squared_distance, squared_edges, density;  ///< squared_edges[i]: of the side opposite corner i
  std::array<Vec2, 3> log;
  double area;
};

FaceData face_data(const CellComplex& complex, Index face, Index site, std::span<const double> density) {
  const Mesh& mesh = complex.mesh();
  FaceData data;
  data.area = mesh.face_area(face);
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * face + i, v = mesh.from(h);
    data.log[i] = complex.maps().known_log(v, site);
    data.squared_distance[i] = data.log[i].squaredNorm();
    data.density[i] = density.empty() ? 1 : density[v];
    const double opposite = mesh.length(Mesh::next(h));
    data.squared_edges[i] = opposite * opposite;
  }
  return data;
}

/// Adds the integrals over the triangle a, b, c (barycentric coordinates in the face).
void add_triangle(const FaceData& data, const Vec3& a, const Vec3& b, const Vec3& c, CellMoments& sum) {
  const double area = data.area * a.dot(b.cross(c));
  for (const QuadraturePoint& q : k_quadrature) {
    const Vec3 x = q.a * a + q.b * b + (1 - q.a - q.b) * c;
    const double density = data.density.dot(x);
    const double weight = area * q.weight * density * density;
    // The squared distance to a point of the plane, from its values at the corners.
    const double bulge =
        x[1] * x[2] * data.squared_edges[0] + x[2] * x[0] * data.squared_edges[1] + x[0] * x[1] * data.squared_edges[2];
    sum.mass += weight;
    sum.moment += weight * (x[0] * data.log[0] + x[1] * data.log[1] + x[2] * data.log[2]);
    sum.energy += weight * (data.squared_distance.dot(x) - bulge);
  }
}

}  // namespace

std::vector<CellMoments> cell_moments(const CellComplex& complex, std::span<const double> density, int threads,
                                      const JobStage& stage) {
  const Index faces = complex.mesh().face_count();
  const auto pieces = static_cast<Index>(complex.pieces().size());
  std::vector<CellMoments> parts(faces + pieces);
  parallel_for(faces, threads, 1024, [&](Index face, int) {
    stage.check();
    const Index site = complex.face_site(face);
    if (site == k_none) return;
    add_triangle(face_data(complex, face, site, density), Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2), parts[face]);
  });
  parallel_for(pieces, threads, 256, [&](Index i, int) {
    stage.check();
    const CellComplex::Piece& piece = complex.pieces()[i];
    const FaceData data = face_data(complex, piece.face, piece.site, density);
    const Vec3* corner = &complex.loop_barycentric()[piece.first];
    for (Index j = 1; j + 1 < piece.count; ++j)
      add_triangle(data, corner[0], corner[j], corner[j + 1], parts[faces + i]);
  });
  std::vector<CellMoments> cells(complex.site_count());
  const auto add = [&](Index site, const CellMoments& part) {
    cells[site].mass += part.mass;
    cells[site].moment += part.moment;
    cells[site].energy += part.energy;
  };
  for (Index f = 0; f < faces; ++f) {
    if (complex.face_site(f) != k_none) add(complex.face_site(f), parts[f]);
  }
  for (Index i = 0; i < pieces; ++i) add(complex.pieces()[i].site, parts[faces + i]);
  return cells;
}

}  // namespace saddleback
