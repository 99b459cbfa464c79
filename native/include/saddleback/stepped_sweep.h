#pragma once
// One sweep circle of the plane, event by event, to be looked at.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// The step that computes Voronoi diagrams, one event at a time and from any centre. Positions are rounded and so is
/// the order of nearly simultaneous events; `voronoi_2d` gives the exact diagram.
class SteppedSweep {
 public:
  struct Event {
    bool is_touch;             ///< a site is touched; else an arc vanishes
    double radius;             ///< of the circle
    std::vector<Index> sites;  ///< the one touched, or the three whose vertex is found
    Vec2 point;                ///< the site, or the vertex
  };
  struct Arc {
    Index site;
    double begin, end;  ///< directions from the centre, radians, counter-clockwise; begin < end
  };
  struct Edge {
    Vec2 begin, end;
    std::array<Index, 2> sites;
    bool is_finished;  ///< else it still grows, at its end or at both
  };

  /// \throw InputError as voronoi_2d does. O(n log n).
  SteppedSweep(std::span<const Vec2> sites, const Vec2& centre);
  ~SteppedSweep();  // NOLINT(performance-trivially-destructible): State is known in the .cpp only
  SteppedSweep(SteppedSweep&&) noexcept;
  SteppedSweep& operator=(SteppedSweep&&) noexcept;

  /// Goes on to the next event; none after the last. O(1) expected.
  std::optional<Event> step();
  /// Grows the circle to a radius, through all events on the way; a smaller radius changes nothing.
  void grow(double radius);

  double radius() const;
  const Vec2& centre() const;
  /// The ellipse arcs about the centre, counter-clockwise. O(arcs).
  std::vector<Arc> arcs() const;
  /// Points of the beach curve in directions equally far apart, from 0. O(samples + arcs).
  std::vector<Vec2> beach_curve(Index samples) const;
  /// Edges within the beach curve. O(sites touched).
  std::vector<Edge> edges() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace saddleback
