#pragma once
// The part of a known diagram that a sweep circle has found, with weights or without.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/voronoi2d/stepped_sweep.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/diagram/bisector.h"

namespace saddleback::voronoi2d {

/// The diagram of sites with weights, none or one for each, which it keeps even if they are equal: a circle touches a
/// site sooner by its weight.
Voronoi2d weighted_diagram(std::span<const Vec2> sites, std::span<const double> weights, Job* job);

/// Checks how many points of a beach curve are wanted, which takes no job. \throw InputError
void check_samples(Index samples);

/// Sweeps a circle: at radius R the points x with |x - c| + |x - s| - w = R form an ellipse about each site s that the
/// circle about c has touched; the outermost parts of these ellipses are the beach curve, and what lies within is
/// final. So all that a sweep shows at a radius follows from the diagram.
class DiagramSweep {
 public:
  using Event = SteppedSweep::Event;
  using Arc = SteppedSweep::Arc;
  using Edge = SteppedSweep::Edge;

  /// The diagram must outlive this. O(n log n).
  DiagramSweep(const Voronoi2d& diagram, const Vec2& center, const JobStage& stage);

  /// Lists them by radius: sites with a cell, and vertices.
  const std::vector<Event>& events() const { return events_; }
  /// Tells when the last part of a site's ellipse leaves the beach curve; infinite for open cells.
  double last_radius(Index site) const { return lasts_[site]; }

  /// O(sites touched).
  std::vector<Arc> arcs(double radius) const;
  /// O(sites touched + samples times arcs).
  std::vector<Vec2> beach_curve(double radius, Index samples) const;
  /// O(edges touched).
  std::vector<Edge> edges(double radius) const;
  /// Points along each of `edges`, within a tolerance, which is taken to be 2^-26 of the radius at least.
  std::vector<std::vector<Vec2>> polylines(double radius, double tolerance) const;

 private:
  /// The part of an edge within the beach curve, of no length where it has just begun.
  struct Part {
    Index edge;
    double from, to;            ///< parameters on the bisector
    bool grows_from, grows_to;  ///< its ends are on the beach curve
  };
  std::optional<Part> part_within(Index edge, double radius) const;
  template <class Visit>
  void for_parts(double radius, Visit&& visit) const;
  std::optional<double> reach(Index site, double radius, const Vec2& direction) const;
  std::vector<Index> sites_on_beach(double radius) const;
  std::optional<std::array<double, 2>> parameters_within(Index edge, const Bisector& curve, double radius) const;
  std::array<Vec2, 2> ends(const Part& part, const Bisector& curve) const;
  void add_vertices(const JobStage& stage);

  const Voronoi2d& diagram_;
  Vec2 center_;
  std::vector<double> touches_, lasts_;  ///< by site
  std::vector<double> vertex_radii_;     ///< when a vertex is found
  std::vector<Event> events_;
};

}  // namespace saddleback::voronoi2d
