// Several circles over one diagram.

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/stepped_sweep.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/diagram/diagram_sweep.h"

namespace saddleback {

using voronoi2d::DiagramSweep;

struct SweepCircles::State {
  struct Circle {
    DiagramSweep sweep;
    double stop;           ///< radius
    std::size_t next = 0;  ///< event
    bool is_done() const { return next == sweep.events().size() || sweep.events()[next].radius > stop; }
    double next_radius() const { return sweep.events()[next].radius; }
  };

  Voronoi2d diagram;
  std::vector<Vec2> centers;
  std::vector<Circle> circles;
  double radius = 0;

  void add_circles(const JobStage& stage);
  std::vector<Index> nearest_circles(const JobStage& stage) const;
  void stop_at_vertices(const std::vector<Index>& nearest);
  void stop_within(const PlanarDomain& domain, const std::vector<Index>& nearest, const JobStage& stage);
  Index soonest() const;
  double radius_of(const Circle& circle) const { return std::min(radius, circle.stop); }
};

void SweepCircles::State::add_circles(const JobStage& stage) {
  for (const Vec2& center : centers)
    circles.push_back({DiagramSweep(diagram, center, stage), -std::numeric_limits<double>::infinity()});
}

/// (n) the circle whose center is nearest to each site that has a cell.
std::vector<Index> SweepCircles::State::nearest_circles(const JobStage& stage) const {
  std::vector<Index> nearest(diagram.sites.size(), k_none);
  for (const Index site : diagram.cell_sites) {
    stage.check();
    const auto distance = [&](const Vec2& center) { return (center - diagram.sites[site]).squaredNorm(); };
    const auto found = std::min_element(centers.begin(), centers.end(),
                                        [&](const Vec2& a, const Vec2& b) { return distance(a) < distance(b); });
    nearest[site] = static_cast<Index>(found - centers.begin());
  }
  return nearest;
}

void SweepCircles::State::stop_at_vertices(const std::vector<Index>& nearest) {
  for (const Index site : diagram.cell_sites) {
    Circle& circle = circles[nearest[site]];
    circle.stop = std::max(circle.stop, circle.sweep.last_radius(site));
  }
}

/// The beach curve passes a point of a site's cell at the sum of its distances to center and site. That is convex:
/// where the curve has passed the corners of what lies of a cell in the domain, it has passed all of it.
void SweepCircles::State::stop_within(const PlanarDomain& domain, const std::vector<Index>& nearest,
                                      const JobStage& stage) {
  constexpr double k_rounding = 1e-12;  // the circle's event in a corner is told by other operations
  const ClippedCells cells = diagram.clip(domain, {}, stage);
  for (std::size_t loop = 0; loop < cells.loop_sites.size(); ++loop) {
    const Index site = cells.loop_sites[loop];
    const Vec2& center = centers[nearest[site]];
    const double weight = diagram.weights.empty() ? 0 : diagram.weights[site];
    Circle& circle = circles[nearest[site]];
    for (Index i = cells.loop_offsets[loop]; i < cells.loop_offsets[loop + 1]; ++i) {
      const double sum = (cells.points[i] - center).norm() + (cells.points[i] - diagram.sites[site]).norm();
      circle.stop = std::max(circle.stop, sum * (1 + k_rounding) - weight);
    }
  }
}

/// The circle with the next event, or k_none.
Index SweepCircles::State::soonest() const {
  Index best = k_none;
  for (std::size_t k = 0; k < circles.size(); ++k)
    if (!circles[k].is_done() && (best == k_none || circles[k].next_radius() < circles[best].next_radius()))
      best = static_cast<Index>(k);
  return best;
}

SweepCircles::SweepCircles(std::span<const Vec2> sites, std::span<const Vec2> centers, std::span<const double> weights,
                           const PlanarDomain* domain, Job* job)
    : state_(std::make_unique<State>()) {
  if (centers.empty()) throw InputError("centers: wanted one or more, got none");
  for (std::size_t k = 0; k < centers.size(); ++k)
    if (!centers[k].allFinite())
      throw InputError(
          message("centers: center ", k, " is (", centers[k].x(), ", ", centers[k].y(), "), wanted finite numbers"));
  state_->diagram = voronoi2d::weighted_diagram(sites, weights, job);
  state_->centers.assign(centers.begin(), centers.end());
  const JobStage stage(job, "Sweeping circles");
  state_->add_circles(stage);
  const std::vector<Index> nearest = state_->nearest_circles(stage);
  if (domain)
    state_->stop_within(*domain, nearest, stage);
  else
    state_->stop_at_vertices(nearest);
  for (const State::Circle& circle : state_->circles)
    if (!circle.is_done()) state_->radius = std::min(state_->radius, circle.next_radius());
}

SweepCircles::~SweepCircles() = default;
SweepCircles::SweepCircles(SweepCircles&&) noexcept = default;
SweepCircles& SweepCircles::operator=(SweepCircles&&) noexcept = default;

std::optional<SweepCircles::Event> SweepCircles::step() {
  const Index soonest = state_->soonest();
  if (soonest == k_none) return std::nullopt;
  State::Circle& circle = state_->circles[soonest];
  const SteppedSweep::Event& event = circle.sweep.events()[circle.next++];
  state_->radius = std::max(state_->radius, event.radius);
  return Event{soonest, event};
}

void SweepCircles::grow(double radius) {
  if (!std::isfinite(radius)) throw InputError(message("radius: wanted a finite number, got ", radius));
  for (State::Circle& circle : state_->circles)
    while (!circle.is_done() && circle.next_radius() <= radius) ++circle.next;
  state_->radius = std::max(state_->radius, radius);
}

Index SweepCircles::count() const { return static_cast<Index>(state_->circles.size()); }
std::span<const Vec2> SweepCircles::centers() const { return state_->centers; }
double SweepCircles::radius(Index circle) const { return state_->radius_of(state_->circles[circle]); }
bool SweepCircles::is_done(Index circle) const { return state_->circles[circle].is_done(); }

std::vector<SteppedSweep::Arc> SweepCircles::arcs(Index circle) const {
  return state_->circles[circle].sweep.arcs(radius(circle));
}

std::vector<Vec2> SweepCircles::beach_curve(Index circle, Index samples) const {
  voronoi2d::check_samples(samples);
  return state_->circles[circle].sweep.beach_curve(radius(circle), samples);
}

std::vector<SteppedSweep::Edge> SweepCircles::edges(Index circle) const {
  return state_->circles[circle].sweep.edges(radius(circle));
}

std::vector<std::vector<Vec2>> SweepCircles::edge_polylines(Index circle, double tolerance) const {
  if (!(tolerance > 0)) throw InputError(message("tolerance: wanted a positive length, got ", tolerance));
  return state_->circles[circle].sweep.polylines(radius(circle), tolerance);
}

}  // namespace saddleback
