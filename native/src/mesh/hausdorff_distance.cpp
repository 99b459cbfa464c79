// Method: the distance from a triangle's points to another triangle is a convex function, greatest at a corner; so the
// farthest corner from any one face of the other mesh bounds the whole triangle. So does the distance of its farthest
// corner and the way from there: by Jung's theorem some corner of a triangle is no farther from any of its points than
// its longest side over the root of three. Triangles whose bound exceeds what was
// found by more than the tolerance are divided into four, all of one size before those of the next.

#include "saddleback/mesh/hausdorff_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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
    for (const Probe& corner : patch.corner) {
      double by_way = 0;
      for (const Probe& other : patch.corner)
        by_way = std::max(by_way, corner.distance + (other.place - corner.place).norm());
      patch.most = std::min({patch.most, most_from(corner.nearest, patch), by_way});
    }
  }

  /// The distance from one face of the other mesh beyond which no point of the patch is.
  double most_from(Index face, const Patch& patch) const {
    double most = 0;
    for (const Probe& corner : patch.corner)
      most = std::max(most, (position(to_, nearest_on_face(to_, face, corner.place)) - corner.place).norm());
    return most;
  }

  /// Tells whether the face that is nearest to the middle settles a patch: so it is where the meshes are the same,
  /// though at its corners other faces are as near.
  bool is_settled_by_middle(const Patch& patch) const {
    const Vec3 middle = (patch.corner[0].place + patch.corner[1].place + patch.corner[2].place) / 3;
    return most_from(probe(middle, patch.corner[0].nearest).nearest, patch) <= known_;
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
      if (is_settled_by_middle(patch)) return;  // none of its quarters is farther than 0
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
