#pragma once
// The nearest point of a mesh.

#include <array>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// Finds nearest surface points: a bounding volume hierarchy over the faces, built once (O(F log F) time, 12 bytes a
/// face) and then read by any number of threads. Keeps a reference to the mesh.
class NearestSurface {
 public:
  explicit NearestSurface(const Mesh& mesh, const JobStage& stage = {});

  /// The nearest point; of equally near ones that in the smallest face. On an edge or at a vertex (within rounding) its
  /// coordinates there are exactly 0 or 1. `hint` is a face thought near, k_none for no idea: it changes the time only.
  /// About O(log F).
  SurfacePoint nearest(const Vec3& query, Index hint = k_none) const;

 private:
  struct Node {
    float low[3], high[3];
    Index first;  ///< leaf: its first place in faces_; inner node: its second child (the first one follows it)
    Index count;  ///< faces of a leaf, 0 for an inner node
  };
  struct Item {  ///< of the build: a face by its center
    std::array<float, 3> center;
    Index face;
  };
  Index build(std::span<Item> items, Index begin, Index end, const JobStage& stage);
  void make_leaf(Node& node, std::span<const Item> items, Index begin, Index end);
  static Index halve(std::span<Item> items);
  Vec3 to_box_units(const Vec3& point) const;
  double squared_distance(const Node& node, const Vec3& local) const;

  const Mesh& mesh_;
  Vec3 center_ = Vec3::Zero();  ///< boxes are relative to it and in units of the mesh's extent, as float32 wants them
  double unit_ = 1;
  double slack_ = 0;  ///< boxes are wider by this, more than all rounding
  std::vector<Index> faces_;
  std::vector<Node> nodes_;
};

/// The nearest point of one face.
SurfacePoint nearest_on_face(const Mesh& mesh, Index face, const Vec3& query);

struct ProjectOptions {
  int threads = 0;  ///< 0: all cores; never changes the result
  Job* job = nullptr;
};

/// The nearest surface point for each of the queries, three coordinates each.
/// \throw InputError naming the first coordinate that is not finite, Cancelled. O((F + n) log F).
SurfacePoints project(const Mesh& mesh, std::span<const double> xyz, const ProjectOptions& options = {});

}  // namespace saddleback
