#include "geodesics/graph/build_progress.h"

#include <algorithm>
#include <cmath>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/unfolding/needles.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Microseconds on one machine, of which only ratios matter.
constexpr double k_laying = 1;  ///< a vertex
constexpr double k_joined_arc = 0.024;

/// Where edges differ much in length windows are many more: how many times. `growth` is that of the number's logarithm
/// with the spread of the lengths' logarithms.
double unevenness(const Mesh& mesh, double growth) {
  constexpr Index k_samples = 4096;
  constexpr double k_even = 0.85;
  const Index stride = std::max<Index>(1, mesh.halfedge_count() / k_samples);
  double count = 0, sum = 0, squares = 0;
  for (Index h = 0; h < mesh.halfedge_count(); h += stride) {
    const double value = std::log(mesh.length(h) / mesh.mean_edge_length());
    ++count;
    sum += value;
    squares += value * value;
  }
  const double variance = squares / count - sum * sum / (count * count);
  return std::exp(growth * std::max(0.0, std::sqrt(std::max(0.0, variance)) - k_even));
}

double among_needles(const Mesh& mesh, double longer) { return has_needles(mesh) ? longer : 1; }

}  // namespace

double BuildProgress::by_accuracy(const Mesh& mesh, double accuracy) {
  constexpr double k_growth = 0.25, k_longer = 4, k_usual = 5.2, k_power = 0.75;  // for the accuracies in use
  return among_needles(mesh, k_longer) * k_usual *
         std::pow(SaddleVertexGraphOptions::k_default_accuracy / accuracy, k_power) * unevenness(mesh, k_growth);
}

double BuildProgress::by_count(const Mesh& mesh, Index k) {
  constexpr double k_growth = 0.75, k_longer = 16, k_each = 0.14;  // disks end by themselves
  return among_needles(mesh, k_longer) * k_each * k * unevenness(mesh, k_growth);
}

double BuildProgress::by_all(const Mesh& mesh) { return mesh.vertex_count(); }

double BuildProgress::by_rule(const Mesh& mesh, Index k, double accuracy) {
  if (k > 0) return by_count(mesh, k);
  return accuracy > 0 ? by_accuracy(mesh, accuracy) : by_all(mesh);
}

BuildProgress::BuildProgress(const Mesh& mesh, double expected, int threads, const JobStage& stage)
    : stage_(stage), source_count_(mesh.vertex_count()), threads_(thread_count(threads)), expected_(expected) {
  constexpr double k_joining = 0.15;  // of finding, about
  laid_ = k_laying / (k_laying + (1 + k_joining) * expected);
}

void BuildProgress::laid() {
  laying_ = clock_.seconds();
  stage_.update(laid_);
}

void BuildProgress::found(const ArcCount& more, double seconds) {
  const std::lock_guard lock(guard_);
  done_.sources += more.sources;
  done_.arcs += more.arcs;
  finding_ += seconds;
  stage_.update(share());
}

double BuildProgress::share() const {
  const auto sources = static_cast<double>(done_.sources), arcs = static_cast<double>(done_.arcs);
  if (sources == 0) return laid_;
  // What was expected counts as a few sources more: among the first ones may be none of the few that take long.
  constexpr double k_belief = 0.02;
  const double some = k_belief * source_count_, slowness = laying_ / (k_laying * source_count_);
  constexpr double k_least_share = 0.7;  // fresh pages may hold up the tables: finding tells that
  const double finding = finding_ / threads_, as_found = finding / sources / expected_;
  const double joining = k_joined_arc * std::clamp(as_found, k_least_share * slowness, slowness) * arcs / sources;
  const double per_source = (finding + some * expected_ * slowness) / (sources + some) + joining;
  return std::min(1.0, (laying_ + finding) / (laying_ + per_source * source_count_));
}

}  // namespace saddleback
