#pragma once
// Points of the plane along a space-filling curve.

#include <cstdint>
#include <span>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "support/key_order.h"

namespace saddleback::voronoi2d {

/// A point and where it lies: two bits for each halving of the square about all points.
using Placed = Keyed<std::uint32_t>;

/// Points along a Hilbert curve, by ascending place; equal points side by side, the smallest index first.
/// `threads`: 0: all cores. O(n log n). \throw Cancelled
LargeArray<Placed> curve_order(std::span<const Vec2> points, int threads, const JobStage& stage);

/// Points that share a square are in the order of a curve over their own box if there are more of them than this.
constexpr std::size_t k_curve_run = 48;
/// Their places on it; empty if they are not in that order. O(n). \throw Cancelled
LargeArray<std::uint32_t> places_in_square(std::span<const double> x, std::span<const double> y, const JobStage& stage);

}  // namespace saddleback::voronoi2d
