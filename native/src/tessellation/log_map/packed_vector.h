#pragma once

#include "saddleback/types.h"

namespace saddleback {

/// In large tables: aligned as its numbers are, so that what stands beside it needs no padding.
using PackedVec2 = Eigen::Matrix<double, 2, 1, Eigen::DontAlign>;

}  // namespace saddleback
