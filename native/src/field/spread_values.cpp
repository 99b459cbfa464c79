#include "saddleback/field/spread_values.h"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "saddleback/error.h"

#include "field/linear/row_blocks.h"
#include "field/smoothing/face_springs.h"

namespace saddleback {
namespace {

constexpr MultigridSolver<double>::Accuracy k_accuracy{.residual = 1e-8};

void check(const Mesh& mesh, const SurfacePoints& places, std::span<const double> values) {
  if (places.empty()) throw InputError("places: wanted at least one point");
  check_surface_points(mesh, places, "places");
  if (values.size() != places.size())
    throw InputError(message("values: wanted one for each of the ", places.size(), " places, got ", values.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]))
      throw InputError(message("values: value ", values[i], " at [", i, "] is not finite"));
}

Index component_of(const Mesh& mesh, const SurfacePoint& place) {
  return mesh.component_of(mesh.triangles()[place.face][0]);
}

double mean_of(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Components in which there is no place are held at the mean in one vertex.
struct Held {
  std::vector<double> stiffness, target;
  std::vector<bool> has_place;  ///< per component
};
Held held_vertices(const Mesh& mesh, const SurfacePoints& places, double mean) {
  Held result{std::vector<double>(mesh.vertex_count(), 0.0), std::vector<double>(mesh.vertex_count(), 0.0),
              std::vector<bool>(mesh.component_count(), false)};
  for (const SurfacePoint& place : places) result.has_place[component_of(mesh, place)] = true;
  std::vector<bool> has_place = result.has_place;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (has_place[mesh.component_of(v)]) continue;
    has_place[mesh.component_of(v)] = true;
    result.stiffness[v] = k_fixed;
    result.target[v] = mean;
  }
  return result;
}

std::vector<double> spread_harmonic(const Mesh& mesh, const SurfacePoints& places, std::span<const double> values,
                                    double mean, const JobStage& stage) {
  Held held = held_vertices(mesh, places, mean);
  std::vector<double> weight(mesh.vertex_count(), 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      const double share = places[i].barycentric[k];
      if (share <= 0) continue;
      const Index v = mesh.triangles()[places[i].face][k];
      weight[v] += share;
      held.stiffness[v] = k_fixed;
      held.target[v] += (values[i] - held.target[v]) * share / weight[v];
    }
  }
  SpringSystem<double> system =
      spring_system(vertex_graph(mesh, surface_connection(mesh, stage)), held.stiffness, held.target);
  const MultigridSolver<double> solver(std::move(system.matrix), stage.part(0, 0.2));
  std::vector<double> result = solver.solve(system.right, {}, k_accuracy, stage.part(0.2, 1));
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!held.has_place[mesh.component_of(v)]) result[v] = mean;
  return result;
}

/// Splines as sums of what one place alone bends the surface's values by. In each component these are
/// Laplacian^-1 area Laplacian^-1 of the place, and their factors sum to zero beside a constant. Areas are shares of
/// the component's: bends in mesh units would drown the constants on large meshes, and be drowned on small ones.
class Splines {
 public:
  Splines(const Mesh& mesh, const SurfacePoints& places, const JobStage& stage)
      : mesh_(mesh), places_(places), areas_(mesh.vertex_count(), 0.0) {
    std::vector<double> component_areas(mesh.component_count(), 0.0);
    for (Index f = 0; f < mesh.face_count(); ++f) {
      for (const Index v : mesh.triangles()[f]) areas_[v] += mesh.face_area(f) / 3;
      component_areas[mesh.component_of(mesh.triangles()[f][0])] += mesh.face_area(f);
    }
    for (Index v = 0; v < mesh.vertex_count(); ++v) areas_[v] /= component_areas[mesh.component_of(v)];
    GraphMatrix<double> laplacian =
        graph_laplacian(mesh.vertex_count(), vertex_graph(mesh, surface_connection(mesh, stage)));
    std::vector<bool> is_held(mesh.component_count(), false);
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if (!is_held[mesh.component_of(v)]) laplacian.diagonal[v] += 1;
      is_held[mesh.component_of(v)] = true;
    }
    const MultigridSolver<double> solver(std::move(laplacian), stage.part(0, 0.1));
    const auto count = static_cast<Index>(places.size());
    bends_.resize(count);
    std::atomic<Index> done{0};
    const NestedThreads threads(count);
    parallel_for(count, threads.tasks, 1, [&](Index i, int) {
      const double begin = 0.1 + 0.9 * static_cast<double>(done) / count, half = 0.45 / count;
      bends_[i] =
          bend_of(i, solver, stage.part(begin, begin + half), stage.part(begin + half, begin + 2 * half), threads.rows);
      ++done;
    });
  }

  /// Components without a place get the mean.
  std::vector<double> through(std::span<const double> values, double mean) const {
    const auto count = static_cast<Eigen::Index>(places_.size());
    std::vector<Eigen::Index> column(mesh_.component_count(), -1);  // of each component's constant
    Eigen::Index size = count;
    for (const SurfacePoint& place : places_)
      if (Eigen::Index& own = column[component_of(mesh_, place)]; own < 0) own = size++;
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::Index constant = column[component_of(mesh_, places_[i])];
      for (Eigen::Index j = 0; j < count; ++j) system(i, j) = at(bends_[j], i);
      system(i, constant) = system(constant, i) = 1;
      right[i] = values[i];
    }
    // Places that say the same give way a little and meet at a mean: a share of what each bends, for components of
    // other proportions bend by very different amounts. Others must not: beside places that say nearly the same, whose
    // factors are as large as the share allows, theirs are large, too.
    constexpr double k_give = 1e-9, k_same = 1e-5;
    Eigen::VectorXd give = Eigen::VectorXd::Zero(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j < count; ++j) {
        if (i == j || system(i, column[component_of(mesh_, places_[j])]) == 0) continue;
        const double both = system(i, i) + system(j, j), apart = both - system(i, j) - system(j, i);
        give[i] = std::max(give[i], 1 - apart / (k_same * both));
      }
    }
    for (Eigen::Index i = 0; i < count; ++i) system(i, i) *= 1 + k_give * give[i];
    const Eigen::VectorXd factors = system.fullPivLu().solve(right);
    std::vector<double> result(mesh_.vertex_count());
    for (Index v = 0; v < mesh_.vertex_count(); ++v) {
      const Eigen::Index constant = column[mesh_.component_of(v)];
      result[v] = constant < 0 ? mean : factors[constant];
      for (Eigen::Index i = 0; constant >= 0 && i < count; ++i) result[v] += factors[i] * bends_[i][v];
    }
    return result;
  }

 private:
  double at(const std::vector<double>& values, Eigen::Index place) const {
    const SurfacePoint& point = places_[place];
    const Triangle& t = mesh_.triangles()[point.face];
    return point.barycentric[0] * values[t[0]] + point.barycentric[1] * values[t[1]] +
           point.barycentric[2] * values[t[2]];
  }

  double mean_of(const std::vector<double>& values, Index component) const {
    double mean = 0;
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      if (mesh_.component_of(v) == component) mean += areas_[v] * values[v];
    return mean;
  }

  std::vector<double> bend_of(Index place, const MultigridSolver<double>& solver, const JobStage& first,
                              const JobStage& second, int threads) const {
    const SurfacePoint& point = places_[place];
    const Index component = component_of(mesh_, point);
    std::vector<double> right(mesh_.vertex_count(), 0.0);
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      if (mesh_.component_of(v) == component) right[v] = -areas_[v];
    for (int k = 0; k < 3; ++k) right[mesh_.triangles()[point.face][k]] += point.barycentric[k];
    std::vector<double> once = solver.solve(right, {}, k_accuracy, first, threads);
    double mean = mean_of(once, component);
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      right[v] = mesh_.component_of(v) == component ? areas_[v] * (once[v] - mean) : 0;
    std::vector<double> bend = solver.solve(right, {}, k_accuracy, second, threads);
    mean = mean_of(bend, component);  // Constants are free, so that of the vertex that was held must not matter.
    for (Index v = 0; v < mesh_.vertex_count(); ++v)
      if (mesh_.component_of(v) == component) bend[v] -= mean;
    return bend;
  }

  const Mesh& mesh_;
  const SurfacePoints& places_;
  std::vector<double> areas_;  ///< per vertex, as a share of its component's
  std::vector<std::vector<double>> bends_;
};

}  // namespace

std::vector<double> spread_values(const Mesh& mesh, const SurfacePoints& places, std::span<const double> values,
                                  const SpreadOptions& options) {
  check(mesh, places, values);
  const JobStage stage(options.job, "Spreading values");
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double low = *least, high = *most;
  std::vector<double> result;
  if (options.method == SpreadMethod::harmonic) {
    // The solver's accuracy is a share of the values: those it has are shares of the range, however far that is from
    // zero. Halves, for it may be more than the largest number.
    const double half = high > low ? high / 2 - low / 2 : 1;
    std::vector<double> shares;
    for (const double value : values) shares.push_back((value / 2 - low / 2) / half);
    result = spread_harmonic(mesh, places, shares, mean_of(shares), stage);
    for (double& value : result) value = 2 * (low / 2 + half * value);
  } else {
    // Sums of the largest numbers would be more than any: beyond this exponent a power of two is taken out, exactly.
    constexpr int k_most = 900;
    const double largest = std::max(std::abs(low), std::abs(high));
    const int exponent = largest > 0 && std::ilogb(largest) > k_most ? std::ilogb(largest) : 0;
    std::vector<double> scaled;
    for (const double value : values) scaled.push_back(std::ldexp(value, -exponent));
    result = Splines(mesh, places, stage).through(scaled, mean_of(scaled));
    for (double& value : result) value = std::ldexp(value, exponent);
  }
  for (double& value : result) value = std::clamp(value, low, high);
  stage.update(1);
  return result;
}

}  // namespace saddleback
