#include "field/smoothing/given_directions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <utility>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "support/hypotenuse.h"

namespace saddleback {
namespace {

using Complex = std::complex<double>;

// Less of a vector's length than this is rounding of a vector that stands on its face.
constexpr double k_least_part = 1e-9;

void check_given(const GivenDirections& given, const char* of_what) {
  const std::size_t count = given.vectors.size();
  if (!given.weights.empty() && given.weights.size() != count)
    throw InputError(message("weights: wanted one for each of the ", count, " directions, got ", given.weights.size()));
  for (std::size_t i = 0; i < count; ++i) {
    if (!given.vectors[i].allFinite())
      throw InputError(message("directions: the one of ", of_what, i, " is not finite"));
    if (given.weights.empty()) continue;
    const double weight = given.weights[i];
    if (!(weight >= 0) || std::isinf(weight))
      throw InputError(message("weights: wanted finite numbers of 0 or more, got ", weight, " for ", of_what, i));
  }
}

/// The power of a direction; as long as the part of the vector that lies within the face.
Complex power_of(Complex part, int symmetry) {
  const double length = hypotenuse(part.real(), part.imag());
  return length > 0 ? std::polar(length, symmetry * std::atan2(part.imag(), part.real())) : Complex(0);
}

/// The angles of powers over the symmetry, each face's next to that of one beside it: large powers first, so that what
/// cannot be next to all around lies where they cancel.
std::vector<double> followed_angles(const Mesh& mesh, int symmetry, const std::vector<Complex>& powers,
                                    const JobStage& stage) {
  const double quantum = 2 * std::numbers::pi / symmetry;
  std::vector<double> result(mesh.face_count());
  std::vector<bool> is_reached(mesh.face_count(), false);
  std::priority_queue<std::pair<double, Index>> steps;  // by the size beyond the half-edge
  const auto reach = [&](Index face, double before) {
    const double own = std::arg(powers[face]) / symmetry;
    result[face] = before + std::remainder(own - before, quantum);
    is_reached[face] = true;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      if (mesh.twin(h) == k_none) continue;
      const Index beyond = Mesh::face_of(mesh.twin(h));
      if (!is_reached[beyond]) steps.emplace(std::norm(powers[beyond]), h);
    }
  };
  for (Index first = 0; first < mesh.face_count(); ++first) {
    if (is_reached[first]) continue;
    stage.check();
    reach(first, 0);
    while (!steps.empty()) {
      const Index h = steps.top().second;
      steps.pop();
      const Index beyond = Mesh::face_of(mesh.twin(h));
      if (!is_reached[beyond]) reach(beyond, result[Mesh::face_of(h)]);
    }
  }
  return result;
}

}  // namespace

Complex part_within(const Mesh& mesh, Index face, const Vec3& vector) {
  return {vector.dot(direction_in_space(mesh, face, 0)),
          vector.dot(direction_in_space(mesh, face, std::numbers::pi / 2))};
}

bool has_part_within(Complex part, const Vec3& vector) {
  return hypotenuse(part.real(), part.imag()) > k_least_part * vector.norm();
}

std::vector<Complex> powers_of_directions(const Mesh& mesh, int symmetry, const GivenDirections& given) {
  mesh.require_space("directions: a vector");
  std::vector<Complex> result(mesh.face_count());
  const std::size_t count = given.vectors.size();
  const bool is_of_faces = count == result.size();
  if (!is_of_faces && count != static_cast<std::size_t>(mesh.vertex_count()))
    throw InputError(message("directions: wanted one for each of the ", mesh.face_count(), " faces or of the ",
                             mesh.vertex_count(), " vertices, got ", count));
  check_given(given, is_of_faces ? "face " : "vertex ");
  const auto stiffness = [&](std::size_t i) {
    const double weight = given.weights.empty() ? 1 : given.weights[i];
    return weight > 0 ? k_drawn_stiffness * weight_within_bounds(weight) : 0;
  };
  if (!is_of_faces) {
    const std::vector<Vec3> normals = vertex_normals(mesh.positions(), mesh.triangles());
    for (std::size_t v = 0; v < count; ++v) {
      const Vec3 unit = given.vectors[v].stableNormalized();
      if (!given.vectors[v].isZero(0) && !(unit.cross(normals[v]).norm() > k_least_part))
        throw InputError(message("directions: the one of vertex ", v, " has no direction along the surface"));
    }
  }
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (is_of_faces) {
      if (given.vectors[f].isZero(0)) continue;
      const Vec3 unit = given.vectors[f].stableNormalized();
      const Complex part = part_within(mesh, f, unit);
      if (!has_part_within(part, unit))
        throw InputError(message("directions: the one of face ", f, " has no direction within the face"));
      const Complex power = power_of(part, symmetry);
      result[f] = stiffness(f) / std::abs(power) * power;
    } else {
      for (const Index v : mesh.triangles()[f]) {
        if (given.vectors[v].isZero(0)) continue;
        result[f] += stiffness(v) / 3 * power_of(part_within(mesh, f, given.vectors[v].stableNormalized()), symmetry);
      }
    }
  }
  return result;
}

std::vector<double> turns_towards(const Mesh& mesh, const SurfaceConnection& connection, int symmetry,
                                  std::span<const double> angles, const std::vector<Complex>& wanted,
                                  const FaceSprings<double>& springs,
                                  const MultigridSolver<Complex>::Accuracy& accuracy, const JobStage& stage) {
  FaceSprings<Complex> relative(mesh);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const double drawn = springs.stiffness[f], given = std::abs(wanted[f]);
    const Complex own = std::polar(1.0, symmetry * springs.target[f]);
    relative.stiffness[f] = drawn + given;
    if (drawn == k_fixed)
      relative.target[f] = own;
    else if (drawn + given > 0)
      relative.target[f] = (drawn * own + wanted[f] * std::polar(1.0, -symmetry * angles[f])) / (drawn + given);
  }
  SurfaceConnection flat = connection;  // what the field turns by has no frame to be carried in
  std::ranges::fill(flat.transport, 0.0);
  const std::vector<Complex> powers = relax_powers(mesh, {flat, symmetry}, relative, accuracy, stage);
  return followed_angles(mesh, symmetry, powers, stage);
}

}  // namespace saddleback
