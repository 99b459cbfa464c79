// Method: the distance from a triangle's points to another triangle is a convex function, greatest at a corner; so the
// farthest corner from any one face of the other mesh bounds the whole triangle. So does the distance of its farthest
// corner and the way from there: by Jung's theorem some corner of a triangle is no farther from any of its points than
// its longest side over the root of three. Where the meshes are nearly the same, but their edges cross, no face is as
// near as that to all of a triangle: there the triangle is cut by the planes that halve the angles between faces of the
// other mesh, so that each piece has its face, and what bounds the pieces bounds the triangle. Triangles whose bound
// exceeds what was found by more than the tolerance are divided into four, all of one size before those of the next.

#include "saddleback/mesh/hausdorff_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "saddleback/error.h"
#include "saddleback/mesh/project.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// A point of the first mesh with the face of the other that is nearest to it.
struct Probe {
  Vec3 place;
  Index nearest = k_none;
  double distance = 0;
};

struct Patch {
  Index face;
  std::array<Vec3, 3> barycentric;
  std::array<Probe, 3> corner;
  double most = 0;  ///< no point of it is farther
};

using Polygon = std::vector<Vec3>;

/// Cuts off what lies beyond a plane from a convex polygon, and returns it.
Polygon cut_off(Polygon& corners, const Vec3& in_plane, const Vec3& normal) {
  Polygon kept, beyond;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double at_a = normal.dot(a - in_plane), at_b = normal.dot(b - in_plane);
    (at_a > 0 ? beyond : kept).push_back(a);
    if ((at_a > 0) == (at_b > 0)) continue;
    const Vec3 crossing = a + (at_a / (at_a - at_b)) * (b - a);
    kept.push_back(crossing);
    beyond.push_back(crossing);
  }
  corners = std::move(kept);
  return beyond;
}

double diagonal(const Mesh& a, const Mesh& b) {
  Vec3 low = a.position(0), high = low;
  for (const Mesh* const mesh : {&a, &b}) {
    for (const Vec3& p : mesh->positions()) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  return (high - low).norm();
}

class Search {
 public:
  Search(const Mesh& from, const Mesh& to, const HausdorffOptions& options, const JobStage& stage)
      : from_(from),
        to_(to),
        surface_(to, stage),
        tolerance_(options.tolerance * diagonal(from, to)),
        limit_(options.limit),
        threads_(options.threads) {}

  FarthestPoint run(const JobStage& stage) {
    std::vector<Patch> patches = faces(stage);
    for (int level = 0; !patches.empty(); ++level) {
      for (const Patch& patch : patches) take(patch);
      if (limit_ > 0 && best_.distance > limit_) break;
      known_ = std::max(best_.distance + tolerance_, limit_);
      std::erase_if(patches, [&](const Patch& patch) { return patch.most <= known_; });
      stage.update(1 - 0.5 / (level + 1));
      patches = divided(patches, stage);
    }
    return best_;
  }

 private:
  Probe probe(const Vec3& place, Index hint) const {
    const SurfacePoint nearest = surface_.nearest(place, hint);
    return {place, nearest.face, (position(to_, nearest) - place).norm()};
  }

  void bound(Patch& patch) const {
    constexpr double k_jung = 0.57735026918962585;  // rounded up
    double farthest = 0, longest = 0;
    for (int i = 0; i < 3; ++i) {
      farthest = std::max(farthest, patch.corner[i].distance);
      longest = std::max(longest, (patch.corner[i].place - patch.corner[(i + 1) % 3].place).norm());
    }
    patch.most = farthest + k_jung * longest;
    if (patch.most <= known_) return;
    const std::array<Vec3, 3> places{patch.corner[0].place, patch.corner[1].place, patch.corner[2].place};
    for (const Probe& corner : patch.corner) {
      double by_way = 0;
      for (const Probe& other : patch.corner)
        by_way = std::max(by_way, corner.distance + (other.place - corner.place).norm());
      patch.most = std::min({patch.most, most_from(corner.nearest, places), by_way});
    }
  }

  /// The distance from one face of the other mesh beyond which no point between some corners is.
  double most_from(Index face, std::span<const Vec3> corners) const {
    double most = 0;
    for (const Vec3& corner : corners)
      most = std::max(most, (position(to_, nearest_on_face(to_, face, corner)) - corner).norm());
    return most;
  }

  /// The normal of the plane that halves the angle between a face of the other mesh and the one across an edge, away
  /// from the former. Of any length.
  Vec3 towards_next(Index halfedge) const {
    const Index twin = to_.twin(halfedge);
    const Vec3 edge = to_.position(to_.to(halfedge)) - to_.position(to_.from(halfedge));
    const auto normal = [&](Index h, const Vec3& along) {
      return along.cross(to_.position(to_.apex(h)) - to_.position(to_.from(h))).normalized();
    };
    return edge.cross(normal(halfedge, edge) + normal(twin, -edge));
  }

  /// Tells whether faces of the other mesh settle a patch, each the piece of it that is nearer to that face than to the
  /// next ones: so it is where the meshes are nearly the same. Begins with one face and goes on across its edges.
  bool is_settled(const Patch& patch, Index face) const {
    constexpr int k_most_pieces = 64;  // some times as many as faces meet at a vertex
    struct Piece {
      Polygon corners;
      Index face, from;  ///< the half-edge of the face through which it was come to
    };
    std::vector<Piece> pieces{{{patch.corner[0].place, patch.corner[1].place, patch.corner[2].place}, face, k_none}};
    for (int looks = 0; !pieces.empty(); ++looks) {
      Piece piece = std::move(pieces.back());
      pieces.pop_back();
      if (most_from(piece.face, piece.corners) <= known_) continue;
      if (looks >= k_most_pieces) return false;
      for (Index h = 3 * piece.face; h < 3 * piece.face + 3; ++h) {
        const Index twin = to_.twin(h);
        if (twin == k_none || h == piece.from) continue;
        Polygon beyond = cut_off(piece.corners, to_.position(to_.from(h)), towards_next(h));
        if (!beyond.empty()) pieces.push_back({std::move(beyond), Mesh::face_of(twin), twin});
      }
      if (most_from(piece.face, piece.corners) > known_) return false;
    }
    return true;
  }

  /// Tells whether nothing in a patch is farther than what is known, by the faces about the one nearest to its middle.
  bool is_settled(const Patch& patch) const {
    const Vec3 middle = (patch.corner[0].place + patch.corner[1].place + patch.corner[2].place) / 3;
    return is_settled(patch, probe(middle, patch.corner[0].nearest).nearest);
  }

  std::vector<Patch> faces(const JobStage& stage) const {
    std::vector<Probe> vertices(from_.vertex_count());
    parallel_for(from_.vertex_count(), threads_, 256, [&](Index v, int) {
      stage.check();
      vertices[v] = probe(from_.position(v), k_none);
    });
    std::vector<Patch> patches(from_.face_count());
    parallel_for(from_.face_count(), threads_, 256, [&](Index face, int) {
      stage.check();
      const Triangle& t = from_.triangles()[face];
      patches[face] = {
          face, {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2)}, {vertices[t[0]], vertices[t[1]], vertices[t[2]]}};
      bound(patches[face]);
    });
    return patches;
  }

  void take(const Patch& patch) {
    for (int i = 0; i < 3; ++i) {
      if (patch.corner[i].distance > best_.distance) {
        best_ = {{patch.face, patch.barycentric[i]}, patch.corner[i].distance};
      }
    }
  }

  std::vector<Patch> divided(const std::vector<Patch>& patches, const JobStage& stage) const {
    const auto count = static_cast<Index>(patches.size());
    std::vector<Patch> quarters(4 * patches.size());
    parallel_for(count, threads_, 64, [&](Index i, int) {
      stage.check();
      const Patch& patch = patches[i];
      if (is_settled(patch)) return;  // none of its quarters is farther than 0
      std::array<Vec3, 3> middle;
      std::array<Probe, 3> at_middle;
      for (int side = 0; side < 3; ++side) {
        middle[side] = 0.5 * (patch.barycentric[side] + patch.barycentric[(side + 1) % 3]);
        at_middle[side] = probe(position(from_, {patch.face, middle[side]}), patch.corner[side].nearest);
      }
      for (int corner = 0; corner < 3; ++corner) {
        const int before = (corner + 2) % 3;
        quarters[4 * i + corner] = {patch.face,
                                    {patch.barycentric[corner], middle[corner], middle[before]},
                                    {patch.corner[corner], at_middle[corner], at_middle[before]}};
      }
      quarters[4 * i + 3] = {patch.face, middle, at_middle};
      for (int quarter = 0; quarter < 4; ++quarter) bound(quarters[4 * i + quarter]);
    });
    return quarters;
  }

  const Mesh &from_, &to_;
  const NearestSurface surface_;
  const double tolerance_, limit_;
  const int threads_;
  double known_ = 0;  ///< what is no farther needs no look
  FarthestPoint best_;
};

}  // namespace

FarthestPoint farthest_point(const Mesh& from, const Mesh& to, const HausdorffOptions& options, const JobStage& stage) {
  if (!(options.tolerance > 0)) throw InputError(message("tolerance: wanted more than 0, got ", options.tolerance));
  if (!(options.limit >= 0)) throw InputError(message("limit: wanted a length of 0 or more, got ", options.limit));
  from.require_space("hausdorff_distance");
  to.require_space("hausdorff_distance");
  return Search(from, to, options, stage).run(stage);
}

}  // namespace saddleback
