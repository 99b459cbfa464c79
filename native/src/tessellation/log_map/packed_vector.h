#pragma once

#include "saddleback/types.h"

namespace saddleback {

/// A vector for large tables: aligned as its numbers are, so that the members beside it need no padding.
using PackedVec2 = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

}  // namespace saddleback
