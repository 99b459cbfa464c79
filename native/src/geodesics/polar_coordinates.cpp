#include "saddleback/geodesics/polar_coordinates.h"

#include <algorithm>

#include "saddleback/error.h"

#include "geodesics/wavefront/curve_windows.h"

namespace saddleback {
namespace {

// The share of the time until all is measured; the results are then sorted and written.
constexpr double k_measured = 0.97;

}  // namespace

PolarCoordinates polar_coordinates(const SaddleVertexGraph& graph, const SurfaceCurve& curve, double radius, Job* job) {
  if (&curve.mesh() != &graph.mesh() && curve.mesh().fingerprint() != graph.mesh().fingerprint())
    throw InputError("curve: it lies on another mesh than the graph's");
  if (!(radius > 0)) throw InputError(message("radius: wanted a distance above 0, got ", radius));
  const JobStage stage(job, "Measuring from the curve");
  CurveWindows windows(graph.unfolding());
  std::vector<CurveFoot> feet;
  const JobStage measuring = stage.part(0, k_measured);
  windows.from_curve(curve, {.radius = radius}, feet, stage.part(0, 0), nullptr, [&](double distance, Index vertices) {
    measuring.update(std::max(distance / radius, static_cast<double>(vertices) / graph.mesh().vertex_count()));
  });
  std::ranges::sort(feet, {}, &CurveFoot::vertex);
  PolarCoordinates result;
  for (const CurveFoot& foot : feet) {
    result.vertices.push_back(foot.vertex);
    result.distance.push_back(foot.side < 0 ? -foot.distance : foot.distance);
    result.along.push_back(foot.along);
    result.shadowed.push_back(foot.shadowed);
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
