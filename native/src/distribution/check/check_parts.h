#pragma once
// The parts of check_distribution.

#include <limits>
#include <memory>
#include <set>
#include <tuple>

#include "saddleback/distribution/check_distribution.h"

#include "support/box_tree.h"

namespace saddleback {

/// Faults as they are found: each kind once for each pair of shapes.
class FaultList {
 public:
  explicit FaultList(std::size_t most = std::numeric_limits<std::size_t>::max()) : most_(most) {}
  void add(Fault fault, Index first, Index second, const SurfacePoint& where) {
    if (second != k_none && second < first) std::swap(first, second);
    if (!known_.insert({fault, first, second}).second) return;
    if (list_.size() < most_) list_.push_back({fault, first, second, where});
  }
  void add(const FaultList& found) {
    for (const FaultReport& report : found.list_) add(report.fault, report.first, report.second, report.where);
  }
  std::int64_t count() const { return static_cast<std::int64_t>(known_.size()); }
  std::vector<FaultReport> take() { return std::move(list_); }

 private:
  std::size_t most_;
  std::vector<FaultReport> list_;
  std::set<std::tuple<Fault, Index, Index>> known_;
};

/// A piece of an outline where it is compared with others.
struct CheckedPiece {
  Index face, shape;
  Index number;    ///< among all pieces of the shape
  Index previous;  ///< the number of the one before it in its loop
  Vec2 begin, end;
};

inline Box<Vec2> box_around(const Vec2& a, const Vec2& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }

/// Things in faces by the boxes of their weights: in a tree where a face has many.
class FaceBoxes {
 public:
  FaceBoxes() = default;
  /// `begins` (F + 1): where each face's things begin; box_of(i) is the box of one.
  template <class BoxOf>
  FaceBoxes(std::vector<std::size_t> begins, BoxOf&& box_of) : begins_(std::move(begins)) {
    constexpr std::size_t k_few = 32;
    for (std::size_t face = 0; face + 1 < begins_.size(); ++face) {
      if (begins_[face + 1] - begins_[face] <= k_few) continue;
      std::vector<Box<Vec2>> boxes;
      for (std::size_t i = begins_[face]; i < begins_[face + 1]; ++i) boxes.push_back(box_of(i));
      trees_.resize(begins_.size() - 1);
      trees_[face] = std::make_unique<BoxTree<Vec2>>(boxes);
    }
  }

  /// Calls visit(i) for the things of the face that may meet the box, in any order.
  template <class Visit>
  void visit(Index face, const Box<Vec2>& box, Visit&& visit) const {
    const std::size_t begin = begins_[face];
    if (!trees_.empty() && trees_[face])
      trees_[face]->visit(box, [&](Index i) { visit(begin + static_cast<std::size_t>(i)); });
    else
      for (std::size_t i = begin; i < begins_[face + 1]; ++i) visit(i);
  }

 private:
  std::vector<std::size_t> begins_;
  std::vector<std::unique_ptr<BoxTree<Vec2>>> trees_;  ///< per face; empty where no face has many
};

/// All pieces, sorted by face.
struct CheckedPieces {
  std::vector<CheckedPiece> pieces;
  FaceBoxes boxes;
};
CheckedPieces list_pieces(const Mesh& mesh, std::span<const MappedShape> mapped);

void check_chains(const Mesh& mesh, std::span<const MappedShape> mapped, FaultList& faults);
void check_crossings(const CheckedPieces& pieces, const CheckOptions& options, const JobStage& stage,
                     FaultList& faults);
void check_nesting(const Mesh& mesh, std::span<const MappedShape> mapped, const CheckedPieces& pieces,
                   const JobStage& stage, FaultList& faults);
/// Orientation and areas of the patches, and the samples.
void check_patches(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                   std::span<const MappedShape> mapped, const CheckOptions& options, const JobStage& stage,
                   FaultList& faults, CheckReport& report);

}  // namespace saddleback
