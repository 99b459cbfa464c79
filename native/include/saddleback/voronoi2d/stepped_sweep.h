#pragma once
// Sweep circles of the plane, event by event, to be looked at.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"
#include "saddleback/voronoi2d/planar_domain.h"

namespace saddleback::voronoi2d {
class DiagramSweep;
}

namespace saddleback {

/// The step that computes Voronoi diagrams, one event at a time and from any center. Positions are rounded and so is
/// the order of nearly simultaneous events; `voronoi_2d` gives the exact diagram. With weights, and where rounding
/// would lose a vertex, the events are derived from that diagram; hidden sites have none, and a vertex of many cells is
/// one event.
class SteppedSweep {
 public:
  struct Event {
    bool is_touch;             ///< a site is touched; else an arc vanishes
    double radius;             ///< of the circle; less than 0 for a site whose disk holds the center
    std::vector<Index> sites;  ///< the one touched, or the three (of derived events: or more) whose vertex is found
    Vec2 point;                ///< the site, or the vertex
  };
  struct Arc {
    Index site;
    double begin, end;  ///< directions from the center, radians, counter-clockwise; begin < end
  };
  struct Edge {
    Vec2 begin, end;
    std::array<Index, 2> sites;
    bool is_finished;  ///< else it still grows, at its end or at both
  };

  /// Takes the sites, with weights one for each site, or none. \throw InputError as voronoi_2d does, Cancelled.
  /// O(n log n).
  SteppedSweep(std::span<const Vec2> sites, const Vec2& center, std::span<const double> weights = {},
               Job* job = nullptr);
  ~SteppedSweep();  // NOLINT(performance-trivially-destructible): State is known in the .cpp only
  SteppedSweep(SteppedSweep&&) noexcept;
  SteppedSweep& operator=(SteppedSweep&&) noexcept;

  /// Goes on to the next event; none after the last. \throw Cancelled. O(1) expected, the first O(n log n).
  std::optional<Event> step(Job* job = nullptr);
  /// Tells whether the next step or growth is not the first, so that a step takes no time worth watching.
  bool is_begun() const;
  /// Grows the circle to a radius, through all events on the way; a smaller radius changes nothing. Cancelled on the
  /// way it stays where it has come to. \throw InputError for a radius that is negative or not finite. Cancelled.
  void grow(double radius, Job* job = nullptr);

  double radius() const;
  const Vec2& center() const;
  /// The ellipse arcs about the center, counter-clockwise. O(arcs).
  std::vector<Arc> arcs() const;
  /// Points of the beach curve in directions equally far apart, from 0. O(samples + arcs). \throw InputError for fewer
  /// than 1 or more than 100,000.
  std::vector<Vec2> beach_curve(Index samples) const;
  /// Edges within the beach curve, those that begin at it with no length, too: after the last event as many as the
  /// diagram has. O(sites touched).
  std::vector<Edge> edges() const;
  /// Points along each of `edges`, no part of which is farther from their chords than a tolerance; one finer than 2^-26
  /// of the radius is taken as that. O(sites touched + points).
  std::vector<std::vector<Vec2>> edge_polylines(double tolerance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Sweep circles that grow together, each about its center, until it has found the cells of the sites nearest to it, as
/// much of them as lies in a domain. Without a domain one with an open cell among these goes on to the last vertex.
///
/// With one a circle does without the events that the others tell (theorem 3.3 of [ying2014]): of 1,000 random sites in
/// a square one circle tells 2,900, each of 4 circles 1,000, each of 25 circles 250.
class SweepCircles {
 public:
  struct Event {
    Index circle;
    SteppedSweep::Event event;
  };

  /// \throw InputError as voronoi_2d does, and for no center or one that is not finite. Cancelled. O(n log n) for each
  /// center.
  SweepCircles(std::span<const Vec2> sites, std::span<const Vec2> centers, std::span<const double> weights = {},
               const PlanarDomain* domain = nullptr, Job* job = nullptr);
  ~SweepCircles();  // NOLINT(performance-trivially-destructible): State is known in the .cpp only
  SweepCircles(SweepCircles&&) noexcept;
  SweepCircles& operator=(SweepCircles&&) noexcept;

  /// Goes on to the next event of any circle; none after the last. O(centers).
  std::optional<Event> step();
  /// Grows all circles to a radius, through all events on the way; a smaller radius changes nothing.
  void grow(double radius);

  Index count() const;
  std::span<const Vec2> centers() const;
  /// Returns the radius of all circles, or the one at which this circle stopped; minus infinity for one whose
  /// center is the nearest to no site.
  double radius(Index circle) const;
  bool is_done(Index circle) const;
  /// Returns the same as of SteppedSweep.
  std::vector<SteppedSweep::Arc> arcs(Index circle) const;
  std::vector<Vec2> beach_curve(Index circle, Index samples) const;
  std::vector<SteppedSweep::Edge> edges(Index circle) const;
  std::vector<std::vector<Vec2>> edge_polylines(Index circle, double tolerance) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace saddleback
