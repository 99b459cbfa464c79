#pragma once
// Distances from which on two shapes in the plane are certainly apart.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/shapes/shape.h"

namespace saddleback {

/// Holds how far a shape reaches in every direction: for each of `k_angles` ranges of viewing angles and `k_columns`
/// strips along the view, the farthest that any point of the shape gets in any view of the range. Nothing of the shape
/// is beyond; rounding is outwards.
class FrontProfiles {
 public:
  static constexpr Index k_angles = 720, k_columns = 256;

  /// Strips from -half_width to half_width across the view. The same for any number of threads (0: all cores).
  /// O(k_angles (corners + strips crossed)). \throw Cancelled.
  FrontProfiles(const Shape& shape, double half_width, int threads = 0, const JobStage& stage = {});

  double half_width() const { return half_width_; }
  static Index range_of(double angle);
  /// Strips from right to left of the view; -inf where the shape has no point.
  std::span<const float> columns(Index range) const {
    return {fronts_.data() + static_cast<std::size_t>(range) * k_columns, static_cast<std::size_t>(k_columns)};
  }
  std::size_t byte_count() const { return fronts_.size() * sizeof(float); }

 private:
  double half_width_;
  std::vector<float> fronts_;
};

/// Safe distances of two shapes at any angles and scales. Two shapes slid together from afar first meet where their
/// fronts do, so the last distance at which they touch is the largest sum of two fronts over all strips; taken over
/// whole ranges of angles and strips it can only be too large. Nothing is searched for, pockets cannot be mistaken for
/// the outside, and scales enter exactly.
class SafeDistanceTable {
 public:
  /// Finds the same for any number of threads (0: all cores). O(k_angles (k_angles k_columns + corners)): some 20
  /// milliseconds of one core, 2.5 MB. \throw Cancelled.
  SafeDistanceTable(const Shape& a, const Shape& b, int threads = 0, Job* job = nullptr);

  /// A distance between the centers from which on the shapes have no common point. `alpha`: where the center of b is,
  /// seen in the plane of a: angle from a's x axis, radians. `beta`: where the center of a is, seen from b. Equal
  /// scales: one look-up; others: O(k_columns). \throw InputError for an angle that is not finite, or a scale that is
  /// not positive and finite.
  double distance(double alpha, double beta, double scale_a = 1, double scale_b = 1) const;

  std::size_t byte_count() const;

 private:
  SafeDistanceTable(const Shape& a, const Shape& b, int threads, const JobStage& stage);
  void fill(const FrontProfiles& a, const FrontProfiles& b, int threads, const JobStage& stage);

  double table_unit_;  ///< of the whole numbers in the table
  FrontProfiles a_, b_;
  std::vector<std::uint16_t> table_;  ///< at scales of 1, a row for each range of alpha
};

}  // namespace saddleback
