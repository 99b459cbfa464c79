#pragma once
// The few types that every public header shares.

#include <Eigen/Core>
#include <Eigen/Geometry>  // cross products
#include <array>
#include <cstdint>

namespace saddleback {

using Index = std::int32_t;  ///< vertex, face, half-edge or site; -1 means none
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Triangle = std::array<Index, 3>;  ///< three vertices, counter-clockwise

inline constexpr Index k_none = -1;

}  // namespace saddleback
