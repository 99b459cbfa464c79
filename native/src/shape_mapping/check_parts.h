#pragma once
// The parts of check_distribution.

#include <set>
#include <tuple>

#include "saddleback/check_distribution.h"

namespace saddleback {

/// Faults as they are found: each kind once for each pair of shapes.
class FaultList {
 public:
  explicit FaultList(std::size_t most) : most_(most) {}
  void add(Fault fault, Index first, Index second, const SurfacePoint& where) {
    if (second != k_none && second < first) std::swap(first, second);
    if (!known_.insert({fault, first, second}).second) return;
    if (list_.size() < most_) list_.push_back({fault, first, second, where});
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

/// All pieces, sorted by face, and where each face's begin.
struct CheckedPieces {
  std::vector<CheckedPiece> pieces;
  std::vector<std::size_t> begins;  ///< (F + 1)
  std::span<const CheckedPiece> of(Index face) const {
    return std::span(pieces).subspan(begins[face], begins[face + 1] - begins[face]);
  }
};
CheckedPieces list_pieces(const Mesh& mesh, std::span<const MappedShape> mapped);

void check_chains(const Mesh& mesh, std::span<const MappedShape> mapped, FaultList& faults);
void check_crossings(const CheckedPieces& pieces, const CheckOptions& options, const JobStage& stage,
                     FaultList& faults);
void check_nesting(const Mesh& mesh, std::span<const MappedShape> mapped, const CheckedPieces& pieces,
                   FaultList& faults);
/// Orientation and areas of the patches, and the samples.
void check_patches(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                   std::span<const MappedShape> mapped, const CheckOptions& options, const JobStage& stage,
                   FaultList& faults, CheckReport& report);

}  // namespace saddleback
