// Rounds over all open cells: those that are proven covered are dropped; into each of the others a dart is thrown; what
// remains is split in four. Cells over which a copy can move by less than the tolerance are leaves: one copy is tried
// at the centre, and if it does not fit, nothing fits there with that clearance.

#include "gap_search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "saddleback/trace.h"

#include "edge_distances.h"
#include "support/parallel.h"
#include "support/random_numbers.h"

namespace saddleback::distribution {
namespace {

/// Where the tracing of a point ends differs from where the flat plane puts it by a quarter of K r^2 of its distance;
/// lengths across are off by as much as K r^2. So the one tells the other.
constexpr double k_bending = 4;
/// And the stretch of a map is a sixth of K r^2 at its rim: points are certainly not farther off than this many times
/// that, of their distance. What is deeper needs no tracing.
constexpr double k_drift = 4;
/// Ways along edges are at most so much longer than others on meshes of sound triangles.
constexpr double k_edge_excess = 1.5;
constexpr Index k_border_corners = 24;
/// A round that lays less than this share of all is the last one, unless everything is wanted.
constexpr double k_tired = 0.02;
/// Cells are not split after a round that lays more than this share, for so many rounds.
constexpr double k_busy = 0.01;
constexpr int k_most_rounds_unsplit = 8;

Pose pose_at(const CellView& view, const Copy& copy, const Vec2& origin, const Eigen::Matrix2d& turn) {
  const double c = copy.placement.scale * std::cos(copy.placement.angle),
               s = copy.placement.scale * std::sin(copy.placement.angle);
  Eigen::Matrix2d own;
  own << c, -s, s, c;
  return {origin + turn * view.place, turn * own};
}

}  // namespace

GapSearch::GapSearch(const Mesh& mesh, const PlacingRules& rules, Laying& laying, const DistributionOptions& options)
    : mesh_(&mesh), rules_(&rules), laying_(&laying), options_(&options) {
  if (options.packing > 0) front_ = sweep_coordinate(mesh);
  if (options.maximal)
    certificate_.tolerance = options.tolerance * options.smallest *
                             *std::max_element(options.size.begin(), options.size.end()) * rules.largest_shape_radius();
  flag_borders();
  make_base_cells();
}

void GapSearch::flag_borders() {
  std::vector<Index> rim = mesh_->boundary_vertices(), allowed;
  if (!options_->forbidden.empty()) {
    std::vector<std::uint8_t> has_forbidden(static_cast<std::size_t>(mesh_->vertex_count()), 0);
    std::vector<std::uint8_t> has_allowed = has_forbidden;
    for (Index h = 0; h < mesh_->halfedge_count(); ++h)
      (options_->forbidden[Mesh::face_of(h)] ? has_forbidden : has_allowed)[mesh_->from(h)] = 1;
    for (Index v = 0; v < mesh_->vertex_count(); ++v) {
      if (has_forbidden[v]) rim.push_back(v);
      if (has_allowed[v]) allowed.push_back(v);
    }
    forbidden_depth_ = edge_distances(*mesh_, allowed, std::numeric_limits<double>::infinity());
    for (double& depth : forbidden_depth_) depth /= k_edge_excess;
  }
  if (rim.empty()) return;
  const std::vector<double> distances = edge_distances(*mesh_, rim, k_edge_excess * rules_->largest_radius());
  near_border_.resize(static_cast<std::size_t>(mesh_->face_count()));
  for (Index f = 0; f < mesh_->face_count(); ++f)
    for (const Index vertex : mesh_->triangles()[f])
      if (std::isfinite(distances[vertex])) near_border_[f] = 1;
  for (Index f = 0; f < mesh_->face_count(); ++f) {  // large faces reach out of the range
    const double reach = rules_->largest_radius();
    if (mesh_->length(3 * f) > reach || mesh_->length(3 * f + 1) > reach || mesh_->length(3 * f + 2) > reach)
      near_border_[f] = 1;
  }
}

/// Small enough for several darts a copy; a sweep needs many more to choose from.
double GapSearch::base_radius() const { return rules_->smallest_radius() * (options_->packing > 0 ? 0.2 : 0.5); }

void GapSearch::make_base_cells() {
  const std::size_t count = rules_->kinds().size();
  const std::uint64_t all = count >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << count) - 1;
  for (Index f = 0; f < mesh_->face_count(); ++f) {
    if (!options_->forbidden.empty() && options_->forbidden[f]) continue;
    const double edge = std::max({mesh_->length(3 * f), mesh_->length(3 * f + 1), mesh_->length(3 * f + 2)});
    int level = 0;
    // Similar triangles of a needle would be as many as its length asks for, with hardly any area each.
    const double least_area = 0.1 * base_radius() * base_radius();
    while (level < 12 && edge / (1 << level) > 1.7 * base_radius() &&
           std::ldexp(mesh_->face_area(f), -2 * level) > least_area)
      ++level;
    const std::int32_t n = 1 << level;
    const auto depth = static_cast<std::uint8_t>(level);
    for (std::int32_t j = 0; j < n; ++j)
      for (std::int32_t i = 0; i + j < n; ++i) {
        open_.push_back({{f, i, j, depth, false}, all});
        if (i + j + 1 < n) open_.push_back({{f, i + 1, j + 1, depth, true}, all});
      }
  }
}

double GapSearch::order(const Cell& cell, const SurfacePoint& point, double area, std::uint64_t key) const {
  const double chance = uniform(key, 3);
  if (options_->packing <= 0) return -std::log1p(-chance) / area;  // when the first of even rain falls there
  const Triangle& t = mesh_->triangles()[cell.face];
  const double front =
      front_[t[0]] * point.barycentric[0] + front_[t[1]] * point.barycentric[1] + front_[t[2]] * point.barycentric[2];
  return (1 - options_->packing) * chance + options_->packing * front;
}

void GapSearch::throw_dart(const OpenCell& open, Index number, Look& look) const {
  const std::uint64_t key = mixed(options_->seed + static_cast<std::uint64_t>(rounds_) * 0x9E37, open.cell.key());
  double total = 0;
  for (std::size_t k = 0; k < kind_weights_.size(); ++k)
    if (look.open >> k & 1) total += kind_weights_[k];
  double pick = uniform(key, 0) * total;
  Index kind = k_none;
  for (std::size_t k = 0; k < kind_weights_.size(); ++k) {
    if (!(look.open >> k & 1) || kind_weights_[k] <= 0) continue;
    kind = static_cast<Index>(k);
    pick -= kind_weights_[k];
    if (pick < 0) break;
  }
  if (kind == k_none) return;
  double along = uniform(key, 1), up = uniform(key, 2);
  if (along + up > 1) along = 1 - along, up = 1 - up;
  const SurfacePoint point = point_at(open.cell.face, open.cell.weights(along, up));
  const double range = options_->largest - options_->smallest;
  const double scale = rules_->size_at(point) * (options_->smallest + range * uniform(key, 4));
  const double area = mesh_->face_area(open.cell.face) * open.cell.unit() * open.cell.unit();
  look.has_dart = true;
  look.dart = {order(open.cell, point, area, key), kind, number, point, scale};
}

bool GapSearch::is_beyond_border(const CellView& view, const Copy& copy, const Motion& motion) const {
  Index corners = 0;
  const Index stride = 1 + copy.body->shape.corner_count() / k_border_corners;
  for (const Shape::Loop& loop : copy.body->shape.loops())
    for (const Vec2& corner : loop) {
      if (corners++ % stride != 0) continue;
      const double length = corner.norm() * copy.placement.scale, moved = motion.of(corner);
      const TraceEnd end = trace_end(
          *mesh_, view.centre,
          angle_about(*mesh_, view.centre, copy.placement.angle + std::atan2(corner.y(), corner.x())), length);
      if (end.hit_boundary && length - end.length > moved) return true;
      if (end.hit_boundary || forbidden_depth_.empty() || !options_->forbidden[end.point.face]) continue;
      double depth = std::numeric_limits<double>::infinity();
      for (const Index vertex : mesh_->triangles()[end.point.face]) depth = std::min(depth, forbidden_depth_[vertex]);
      if (depth > moved) return true;
    }
  return false;
}

/// Whether what the flat planes foresee holds: the point is traced over the surface.
bool GapSearch::is_certain(const CellView& view, const Copy& copy, const Motion& motion, const Encounter& found,
                           const Pose& pose, Index other) const {
  const Copy& there = laying_->settled().copies()[other];
  const double length = found.point.norm() * copy.placement.scale;
  Vec2 place = pose.at;
  if (length > 0) {
    const double angle = copy.placement.angle + std::atan2(found.point.y(), found.point.x());
    const TraceEnd end = trace_end(*mesh_, view.centre, angle_about(*mesh_, view.centre, angle), length);
    if (end.hit_boundary) return false;
    const Vec2 in_face = FaceChart(*mesh_, end.point.face).to_plane(end.point.barycentric);
    const bool is_known = laying_->settled().visit(end.point.face, {end.point.barycentric[1], end.point.barycentric[2]},
                                                   [&](Index number, const Vec2& origin, const Eigen::Matrix2d& turn) {
                                                     if (number != other) return false;
                                                     place = origin + turn * in_face;
                                                     return true;
                                                   });
    if (!is_known) return false;
  }
  const double drift = (place - pose(found.point)).norm();
  const double bending = length > 0 ? std::min(0.5, k_bending * drift / length) : 0;
  double distance, moved;
  if (found.is_of_other) {
    const Vec2 own = found.point + pose.turn.inverse() * (found.other_point - place);
    distance = copy.placement.scale * copy.body->distance.exact(own);
    moved = motion.of(own);
  } else {
    distance = there.placement.scale * there.body->distance.exact(place / there.placement.scale);
    moved = motion.of(found.point);
  }
  return found.radius * (1 - bending) - distance - moved * (1 + bending) > 0;
}

/// Kinds of which the disk about the centre meets a copy wherever in the cell it is. It does not matter how they turn.
std::uint64_t GapSearch::centrally_covered(const CellView& view, std::uint64_t kinds) const {
  const SurfacePoint& centre = view.centre;
  const double scale = rules_->smallest_factor() * view.size;
  std::uint64_t covered = 0;
  laying_->settled().visit(centre.face, {centre.barycentric[1], centre.barycentric[2]},
                           [&](Index other, const Vec2& origin, const Eigen::Matrix2d& turn) {
                             const Copy& there = laying_->settled().copies()[other];
                             const Vec2 place = (origin + turn * view.place) / there.placement.scale;
                             const double away = place.norm() - there.body->shape.circumradius();
                             if (away * there.placement.scale > scale * rules_->largest_inradius()) return false;
                             const double distance = there.placement.scale * there.body->distance.upper(place);
                             for (std::uint64_t rest = kinds & ~covered; rest; rest &= rest - 1) {
                               const auto kind = static_cast<Index>(std::countr_zero(rest));
                               if (scale * rules_->inradius(kind) - view.radius > distance)
                                 covered |= std::uint64_t{1} << kind;
                             }
                             return covered == kinds;
                           });
  return covered;
}

bool GapSearch::is_covered(const CellView& view, const Copy& copy, const Motion& motion) const {
  const SurfacePoint& centre = view.centre;
  const double scale = copy.placement.scale;
  const bool meets = laying_->settled().visit(
      centre.face, {centre.barycentric[1], centre.barycentric[2]},
      [&](Index other, const Vec2& origin, const Eigen::Matrix2d& turn) {
        const Copy& there = laying_->settled().copies()[other];
        const Pose pose = pose_at(view, copy, origin, turn);
        // What the grids cannot tell, their distances being rounded up, the exact ones may.
        const double slack =
            std::max(scale * copy.body->distance.slack(), there.placement.scale * there.body->distance.slack());
        const double drift = k_drift * there.bend * scale;
        const Encounter found = encounter(*copy.body, scale, pose, motion, *there.body, there.placement.scale,
                                          {.least = -slack, .enough = slack + drift * copy.body->shape.circumradius()});
        if (found.depth > drift * found.point.norm()) return true;
        return found.depth > -slack && is_certain(view, copy, motion, found, pose, other);
      });
  return meets || (!near_border_.empty() && near_border_[centre.face] && is_beyond_border(view, copy, motion));
}

void GapSearch::look(const OpenCell& open, Index number, Look& look) const {
  const CellView view = rules_->view(open.cell);
  look.tests = std::popcount(open.kinds);
  for (std::uint64_t rest = open.kinds & ~centrally_covered(view, open.kinds); rest; rest &= rest - 1) {
    const auto kind = static_cast<Index>(std::countr_zero(rest));
    const Kind& what = rules_->kinds()[kind];
    if (!laying_->is_wanted(what.shape)) continue;
    const Copy copy = rules_->copy(kind, view.centre, view.angle, rules_->smallest_factor() * view.size);
    const Motion motion = rules_->motion(view, rules_->smallest_factor());
    if (is_covered(view, copy, motion)) continue;
    const double least = tolerance(view, what);
    if (motion.base + motion.per_length * copy.body->shape.circumradius() > least) {
      if (view.radius < 0.25 * least || open.cell.level >= k_most_levels)
        look.is_lost = true;
      else
        look.open |= std::uint64_t{1} << kind;
    } else if (is_covered(view, copy, {})) {
      ++look.leaves;
    } else {
      look.asked |= std::uint64_t{1} << kind;
    }
  }
  if (look.open) throw_dart(open, number, look);
}

void GapSearch::lose(const Cell& cell) {
  certificate_.uncertified_area += mesh_->face_area(cell.face) * cell.unit() * cell.unit();
  certificate_.uncertified.push_back(point_at(cell.face, cell.centre()));
}

void GapSearch::round(const JobStage& stage) {
  kind_weights_.clear();
  for (const Kind& kind : rules_->kinds())
    kind_weights_.push_back(laying_->share(kind.shape) * rules_->shape_radius(kind) * rules_->shape_radius(kind));
  std::vector<Look> looks(open_.size());
  const JobStage looking = stage.part(0, 0.5);
  parallel_for(static_cast<Index>(open_.size()), options_->threads, 64, [&](Index i, int) {
    if (i % 1024 == 0) looking.update(static_cast<double>(i) / static_cast<double>(open_.size()));
    look(open_[i], i, looks[i]);
  });
  std::vector<Candidate> candidates;
  for (Index i = 0; i < static_cast<Index>(open_.size()); ++i) {
    const Look& found = looks[i];
    certificate_.cells += found.tests;
    certificate_.leaves += found.leaves;
    if (found.is_lost) lose(open_[i].cell);
    if (found.has_dart) candidates.push_back(found.dart);
    for (std::uint64_t rest = found.asked; rest; rest &= rest - 1) {
      const auto kind = static_cast<Index>(std::countr_zero(rest));
      const CellView view = rules_->view(open_[i].cell);
      const double area = mesh_->face_area(open_[i].cell.face) * open_[i].cell.unit() * open_[i].cell.unit();
      const std::uint64_t key = mixed(options_->seed, open_[i].cell.key());
      const double scale = rules_->smallest_factor() * view.size;
      candidates.push_back({order(open_[i].cell, view.centre, area, key), kind, i, view.centre, scale, true});
    }
  }
  const std::vector<Outcome> outcomes = laying_->lay(candidates, stage.part(0.5, 1));
  std::vector<std::uint8_t> is_stuck(open_.size(), 0);
  laid_in_round_ = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const Candidate& candidate = candidates[k];
    const Outcome outcome = outcomes[k];
    laid_in_round_ += outcome == Outcome::laid ? 1 : 0;
    const bool is_odd = outcome == Outcome::fold || outcome == Outcome::stretched;
    if (!candidate.is_thorough) {
      is_stuck[candidate.cell] = is_odd;
    } else if (outcome == Outcome::laid || outcome == Outcome::not_wanted) {
      looks[candidate.cell].open |= std::uint64_t{1} << candidate.kind;  // the next round finds it covered
    } else {
      ++certificate_.leaves;
      if (is_odd) lose(open_[candidate.cell].cell);
    }
  }
  // As long as many find room, room is easier to find than to rule out.
  const auto total = static_cast<double>(laying_->settled().copies().size());
  const bool splits = static_cast<double>(laid_in_round_) < k_busy * total || rounds_ >= k_most_rounds_unsplit;
  std::vector<OpenCell> next;
  for (std::size_t i = 0; i < open_.size(); ++i) {
    if (!looks[i].open) continue;
    const CellView view = rules_->view(open_[i].cell);
    if (is_stuck[i] && view.radius < 8 * options_->tolerance * rules_->smallest_radius()) {
      lose(open_[i].cell);
      continue;
    }
    if (!splits) {
      next.push_back({open_[i].cell, looks[i].open});
      continue;
    }
    for (const Cell& child : open_[i].cell.children()) next.push_back({child, looks[i].open});
  }
  open_ = std::move(next);
  ++rounds_;
}

DistributionStop GapSearch::run(const JobStage& stage) {
  double done = 0;
  while (!open_.empty()) {
    if (!laying_->is_any_wanted()) return DistributionStop::counts;
    round(stage.part(done, done + 0.5 * (1 - done)));
    done += 0.5 * (1 - done);
    const auto total = static_cast<double>(laying_->settled().copies().size());
    const bool is_tired = static_cast<double>(laid_in_round_) < k_tired * total && rounds_ > 1;
    if (!options_->maximal && (is_tired || total == 0)) break;
  }
  if (!laying_->is_any_wanted()) return DistributionStop::counts;
  return options_->maximal ? DistributionStop::full : DistributionStop::tired;
}

}  // namespace saddleback::distribution
