#include "tessellation/cell_moments.h"

#include "support/parallel.h"
#include "tessellation/face_partition.h"
#include "tessellation/quadrature.h"

namespace saddleback {
namespace {

/// A flat face, for integrals over its parts.
struct FaceShape {
  Vec3 squared_edges, density;  ///< squared_edges[i]: of the side opposite corner i
  double area;
  bool uniform;

  FaceShape(const Mesh& mesh, Index face, std::span<const double> densities)
      : density(Vec3::Ones()), area(mesh.face_area(face)), uniform(densities.empty()) {
    for (int i = 0; i < 3; ++i) {
      const double opposite = mesh.length(Mesh::next(3 * face + i));
      squared_edges[i] = opposite * opposite;
      if (!uniform) density[i] = densities[mesh.triangles()[face][i]];
    }
  }
  /// By how much the squared distance to a point of the plane is below the interpolation of its values at the corners.
  double bulge(const Vec3& x) const {
    return x[1] * x[2] * squared_edges[0] + x[2] * x[0] * squared_edges[1] + x[0] * x[1] * squared_edges[2];
  }
  double weight(const Vec3& x) const {
    const double value = density.dot(x);
    return value * value;
  }
};

struct ClaimedFace {
  const FaceShape& shape;
  const FaceClaim& claim;
  Vec3 squared_distance;
  ClaimedFace(const FaceShape& the_shape, const FaceClaim& the_claim)
      : shape(the_shape),
        claim(the_claim),
        squared_distance(claim.squared_distance(0), claim.squared_distance(1), claim.squared_distance(2)) {}
};

template <std::size_t Count>
void integrate(const ClaimedFace& face, const std::array<QuadraturePoint, Count>& rule, double area, const Vec3& a,
               const Vec3& b, const Vec3& c, CellMoments& sum) {
  for (const QuadraturePoint& q : rule) {
    const Vec3 x = at(q, a, b, c);
    const double weight = area * q.weight * face.shape.weight(x);
    sum.mass += weight;
    sum.moment +=
        weight * (x[0] * face.claim.corner[0].log + x[1] * face.claim.corner[1].log + x[2] * face.claim.corner[2].log);
    sum.energy += weight * (face.squared_distance.dot(x) - face.shape.bulge(x));
  }
}

/// Adds the integrals over the triangle a, b, c (barycentric coordinates in the face).
void add_triangle(const ClaimedFace& face, const Vec3& a, const Vec3& b, const Vec3& c, CellMoments& sum) {
  const double area = face.shape.area * a.dot(b.cross(c));
  sum.area += area;
  if (face.shape.uniform) {
    integrate(face, k_quadratic, area, a, b, c, sum);
  } else {
    integrate(face, k_quartic, area, a, b, c, sum);
  }
}

/// Where a claim's difference to another's vanishes on the way from corner i to corner j.
Vec3 zero_between(const Vec3& difference, int i, int j) {
  const double t = difference[i] / (difference[i] - difference[j]);
  return (1 - t) * Vec3::Unit(i) + t * Vec3::Unit(j);
}

/// The moments of the shared faces' parts.
class SharedFace {
 public:
  void add(const CellClaims& claims, Index shared, std::span<const double> density, CellMoments* parts);

 private:
  void add_two(const FaceShape& shape, const CellClaims& claims, Index shared, CellMoments* parts);
  void add_many(const FaceShape& shape, const CellClaims& claims, Index shared, CellMoments* parts);

  std::vector<Index> rivals_;  ///< claims that are nearest somewhere, as far as corners tell
  std::vector<FacePlane> planes_;
  FacePartition partition_;
};

/// Whether one claim is nowhere nearer than another.
bool is_beaten(const FaceClaim& claim, const FaceClaim& by) {
  bool ties = true;
  for (int i = 0; i < 3; ++i) {
    const double difference = claim.squared_distance(i) - by.squared_distance(i);
    if (difference < 0) return false;
    ties = ties && difference == 0;
  }
  return !ties || by.site < claim.site;
}

void SharedFace::add(const CellClaims& claims, Index shared, std::span<const double> density, CellMoments* parts) {
  const auto all = claims.claims(shared);
  rivals_.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    bool beaten = false;
    for (std::size_t j = 0; j < all.size() && !beaten; ++j) beaten = j != i && is_beaten(all[i], all[j]);
    if (!beaten) rivals_.push_back(static_cast<Index>(i));
  }
  const FaceShape shape(claims.mesh(), claims.face(shared), density);
  if (rivals_.size() == 1) {
    const Index only = rivals_.front();
    add_triangle({shape, all[only]}, Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2), parts[only]);
  } else if (rivals_.size() == 2) {
    add_two(shape, claims, shared, parts);
  } else {
    add_many(shape, claims, shared, parts);
  }
}

/// One straight cut: a corner on one side of it, two on the other.
void SharedFace::add_two(const FaceShape& shape, const CellClaims& claims, Index shared, CellMoments* parts) {
  const auto all = claims.claims(shared);
  const ClaimedFace first(shape, all[rivals_[0]]), second(shape, all[rivals_[1]]);
  const Vec3 lead = first.squared_distance - second.squared_distance;  // above 0: the second is nearer
  int lone = 0;
  while ((lead[lone] > 0) == (lead[(lone + 1) % 3] > 0) || (lead[lone] > 0) == (lead[(lone + 2) % 3] > 0)) ++lone;
  const int left = (lone + 1) % 3, right = (lone + 2) % 3;
  const Vec3 on_left = zero_between(lead, lone, left), on_right = zero_between(lead, lone, right);
  const bool second_is_lone = lead[lone] > 0;
  const ClaimedFace &tip = second_is_lone ? second : first, &rest = second_is_lone ? first : second;
  add_triangle(tip, Vec3::Unit(lone), on_left, on_right, parts[rivals_[second_is_lone ? 1 : 0]]);
  CellMoments& sum = parts[rivals_[second_is_lone ? 0 : 1]];
  add_triangle(rest, on_left, Vec3::Unit(left), Vec3::Unit(right), sum);
  add_triangle(rest, on_left, Vec3::Unit(right), on_right, sum);
}

void SharedFace::add_many(const FaceShape& shape, const CellClaims& claims, Index shared, CellMoments* parts) {
  const auto all = claims.claims(shared);
  planes_.clear();
  for (const Index i : rivals_) {
    planes_.push_back({i, {all[i].squared_distance(0), all[i].squared_distance(1), all[i].squared_distance(2)}});
  }
  partition_.build(planes_);
  for (const FacePartition::Piece& piece : partition_.pieces()) {
    const auto corner = [&](std::size_t i) { return partition_.vertices()[piece.loop[i]].barycentric; };
    const ClaimedFace face(shape, all[piece.site]);
    for (std::size_t j = 1; j + 1 < piece.loop.size(); ++j) {
      add_triangle(face, corner(0), corner(j), corner(j + 1), parts[piece.site]);
    }
  }
}

CellMoments& operator+=(CellMoments& sum, const CellMoments& part) {
  sum.area += part.area;
  sum.mass += part.mass;
  sum.moment += part.moment;
  sum.energy += part.energy;
  return sum;
}

/// Adds a face that one cell owns whole.
void add_whole_face(const CellClaims& claims, Index face, const FaceWeights::Weights& weights, CellMoments& sum) {
  const Triangle& t = claims.mesh().triangles()[face];
  for (int i = 0; i < 3; ++i) {
    const SiteVector seen = claims.maps().own(t[i]);
    sum.mass += weights.corner[i];
    sum.moment += weights.corner[i] * seen.log;
    sum.energy += weights.corner[i] * seen.distance * seen.distance;
  }
  sum.energy -= weights.bulge;
  sum.area += claims.mesh().face_area(face);
}

/// The faces in a fixed number of ranges, so that sums do not depend on the number of threads.
std::vector<CellMoments> moments_of_whole_faces(const CellClaims& claims, const FaceWeights& weights, int threads,
                                                const JobStage& stage) {
  constexpr Index k_ranges = 8;
  const std::int64_t count = claims.mesh().face_count();
  std::array<std::vector<CellMoments>, k_ranges> sums;
  parallel_for(k_ranges, threads, 1, [&](Index range, int) {
    sums[range].resize(claims.site_count());
    const auto first = static_cast<Index>(count * range / k_ranges),
               last = static_cast<Index>(count * (range + 1) / k_ranges);
    for (Index face = first; face < last; ++face) {
      if (face % 1024 == 0) stage.check();
      const Index site = claims.face_site(face);
      if (site != k_none) add_whole_face(claims, face, weights[face], sums[range][site]);
    }
  });
  for (Index range = 1; range < k_ranges; ++range) {
    for (Index site = 0; site < claims.site_count(); ++site) sums[0][site] += sums[range][site];
  }
  return std::move(sums[0]);
}

}  // namespace

FaceWeights::FaceWeights(const Mesh& mesh, std::span<const double> density, int threads)
    : density_(density), weights_(mesh.face_count()) {
  parallel_for(mesh.face_count(), threads, 4096, [&](Index face, int) {
    const FaceShape shape(mesh, face, density);
    Weights& sum = weights_[face];
    sum = {};
    for (const QuadraturePoint& q : k_quartic) {
      const Vec3 x = at(q, Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2));
      const double weight = shape.area * q.weight * shape.weight(x);
      for (int i = 0; i < 3; ++i) sum.corner[i] += weight * x[i];
      sum.bulge += weight * shape.bulge(x);
    }
  });
}

std::vector<CellMoments> cell_moments(const CellClaims& claims, const FaceWeights& weights, int threads,
                                      const JobStage& stage) {
  std::vector<CellMoments> cells = moments_of_whole_faces(claims, weights, threads, stage);
  std::vector<CellMoments> parts(claims.claim_count());
  std::vector<SharedFace> scratch(thread_count(threads));
  parallel_for(claims.shared_count(), threads, 256, [&](Index shared, int thread) {
    stage.check();
    scratch[thread].add(claims, shared, weights.density(), &parts[claims.first_claim(shared)]);
  });
  for (Index shared = 0; shared < claims.shared_count(); ++shared) {
    const CellMoments* part = &parts[claims.first_claim(shared)];
    for (const FaceClaim& claim : claims.claims(shared)) cells[claim.site] += *part++;
  }
  return cells;
}

}  // namespace saddleback
