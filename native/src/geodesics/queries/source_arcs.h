#pragma once
// Arcs from points and curves of the surface to vertices of the graph.

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "geodesics/queries/graph_search.h"
#include "geodesics/queries/point_arcs.h"
#include "geodesics/wavefront/curve_windows.h"

namespace saddleback {

/// The arcs between a source and vertices, rounded as the graph's arcs are. A point that is a vertex has one of length
/// 0; a curve has one to every vertex of a strip along it, as long as that vertex is far from the curve.
struct PointFan {
  struct Arc {
    Index vertex;
    double length;
  };
  std::vector<Arc> arcs;  ///< by vertex
  double reach = 0;       ///< the longest
  bool is_vertex = false;
};

struct FanOptions {
  double limit = std::numeric_limits<double>::infinity();  ///< curves need no longer arcs
  int threads = 0;                                         ///< 0: all cores
  const WatchedPlaces* places = nullptr;  ///< points whose straight distances from curves are wanted, too
};

/// Finds the fans of curves one after the other; one a thread.
class CurveFanFinder {
 public:
  /// \throw Cancelled.
  PointFan find(const SaddleVertexGraph& graph, const SurfaceCurve& curve, const FanOptions& options,
                const JobStage& stage);
  /// Returns distances of options.places, for the last curve: infinity where none is straight or near.
  std::span<const double> place_distances() const { return curve_windows_->place_distances(); }

 private:
  std::unique_ptr<CurveWindows> curve_windows_;
  std::vector<CurveFoot> feet_;
};

/// A point's row of direct_fans, rounded.
PointFan point_fan(const SaddleVertexGraph& graph, const SurfacePoint& point, std::span<const DirectArc> arcs);

/// The fans of many points, by all cores. \throw Cancelled.
std::vector<PointFan> find_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, const JobStage& stage,
                                const FanOptions& options = {});

struct SourceFans {
  std::vector<PointFan> fans;     ///< of the points, then of the curves
  std::vector<double> at_places;  ///< of options.places: the least distance from a curve, as CurveFanFinder tells it
};
SourceFans find_fans(const SaddleVertexGraph& graph, const QuerySources& sources, const JobStage& stage,
                     const FanOptions& options);

/// Says what the fans of these sources cost, as a number of nodes that a search expands in the time. The first of
/// points may have to wait for what all need, unless others come before them.
enum class FirstFans { maybe, later };
double cost_of_fans(const SaddleVertexGraph& graph, const QuerySources& sources);
double cost_of_fans(const SaddleVertexGraph& graph, const SurfacePoints& points, FirstFans first = FirstFans::maybe);

/// Returns what a search needs at least that begins with the arcs of these points' fans, as above.
double cost_of_seeds(const SaddleVertexGraph& graph, const SurfacePoints& points);
/// Each fan's arcs as seeds of its own source.
std::vector<Seed> seeds_of(std::span<const PointFan> fans);

}  // namespace saddleback
