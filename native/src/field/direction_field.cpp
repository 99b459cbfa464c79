// A field as it is kept: its singularities, and its value between the centers of faces.
//
// On every edge the field is linear between two values at its ends, which both faces share. About a vertex the values
// on the edges follow a model that turns evenly with the angle, as often as the vertex' index says; what the turns of
// the faces say beside that is evened out. Inside a face the values of the edges are blended by barycentric
// coordinates.

#include "saddleback/field/direction_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"

#include "field/connection/filled_surface.h"
#include "field/linear/row_blocks.h"

namespace saddleback {
namespace {

constexpr double k_turn = 2 * std::numbers::pi;

}  // namespace

DirectionField::DirectionField(const Mesh& mesh, int symmetry, std::vector<double> angles, std::vector<double> turns,
                               const JobStage& stage)
    : mesh_(&mesh),
      symmetry_(symmetry),
      angles_(std::move(angles)),
      turns_(std::move(turns)),
      along_(mesh.halfedge_count()),
      before_(mesh.halfedge_count()) {
  stage.check();
  const FilledSurface filled(mesh);
  stage.check();
  std::vector<double> sums = filled.curvature;
  for (Index h = 0; h < mesh.halfedge_count(); ++h) {
    if (mesh.twin(h) == k_none) continue;
    sums[filled.node_of[mesh.to(h)]] += turns_[h];
    largest_turn_ = std::max(largest_turn_, std::abs(turns_[h]));
  }
  const auto units_of = [&](Index node) { return static_cast<Index>(std::lround(symmetry * sums[node] / k_turn)); };
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.is_boundary(v) && units_of(filled.node_of[v]) != 0)
      singularities_.push_back({v, units_of(filled.node_of[v])});
  for (const Index node : filled.loop_nodes) loop_units_.push_back(units_of(node) - symmetry);
  const int threads = thread_count(0);
  std::vector<std::vector<double>> differences(threads);
  parallel_for(mesh.vertex_count(), threads, k_rows_a_block, [&](Index v, int thread) {
    if (v % k_rows_a_block == 0) stage.check();
    measure_fan(v, differences[thread]);
  });
}

std::vector<Index> DirectionField::sharp_edges() const {
  std::vector<Index> result;
  for (Index h = 0; h < mesh_->halfedge_count(); ++h)
    if (mesh_->twin(h) > h && std::abs(turns_[h]) >= std::numbers::pi / symmetry_) result.push_back(h);
  return result;
}

Index DirectionField::units_at(Index vertex) const {
  const auto found = std::lower_bound(singularities_.begin(), singularities_.end(), vertex,
                                      [](const Singularity& s, Index v) { return s.vertex < v; });
  return found != singularities_.end() && found->vertex == vertex ? found->units : 0;
}

void DirectionField::measure_fan(Index vertex, std::vector<double>& differences) {
  // How much the model turns, relative to the edges, per angle about the vertex.
  const double turn = mesh_->is_boundary(vertex) ? -1
                                                 : (static_cast<double>(units_at(vertex)) / symmetry_ - 1) * k_turn /
                                                       mesh_->total_angle(vertex);
  differences.assign(1, 0.0);
  const Index first = mesh_->first_halfedge(vertex);
  double mean = 0, weights = 0;
  Index h = first;
  do {
    const double angle = mesh_->corner_angle(h);
    const double found = 0.5 * (turns_[Mesh::prev(h)] - turns_[h]) - angle;
    const double difference = differences.back() + found - turn * angle;
    mean += 0.5 * angle * (differences.back() + difference);
    weights += angle;
    differences.push_back(difference);
    h = mesh_->rotate(h);
  } while (h != k_none && h != first);
  mean /= weights;
  h = first;
  for (std::size_t j = 0; j + 1 < differences.size(); ++j) {
    along_[h] = 0.5 * turns_[h] + mean - differences[j];
    before_[h] = 0.5 * turns_[Mesh::prev(h)] + mean - differences[j + 1];
    h = mesh_->rotate(h);
  }
}

std::vector<Vec3> DirectionField::vectors() const {
  std::vector<Vec3> result(angles_.size());
  for (Index f = 0; f < mesh_->face_count(); ++f) result[f] = direction_in_space(*mesh_, f, angles_[f]);
  return result;
}

double DirectionField::angle_at(const SurfacePoint& point) const {
  const Vec3& b = point.barycentric;
  double value = 0, center = 0;
  for (int i = 0; i < 3; ++i) {
    const Index h = 3 * point.face + i;
    const double next = b[(i + 1) % 3], last = b[(i + 2) % 3];
    const double share = next + last > 0 ? last / (next + last) : 0.5;
    value += b[i] * (along_[h] + share * (before_[h] - along_[h]));
    center += (along_[h] + before_[h]) / 6;
  }
  return angles_[point.face] + value - 27 * b[0] * b[1] * b[2] * center;
}

DirectionField DirectionField::turned(double angle) const {
  if (!std::isfinite(angle)) throw InputError(message("angle is ", angle, ", but must be finite"));
  DirectionField result = *this;
  const double turn = std::remainder(angle, k_turn);  // of many turns, sums would keep nothing of the field
  for (double& own : result.angles_) own = std::remainder(own + turn, k_turn);
  return result;
}

}  // namespace saddleback
