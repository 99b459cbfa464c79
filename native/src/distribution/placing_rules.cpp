#include "distribution/placing_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback::distribution {
namespace {

/// Copies of sizes that differ by no more share the outline that holds the gap, made for the smallest.
constexpr double k_size_step = 1.15;
constexpr std::size_t k_most_kinds = 64;  // a bit of a word each, see maximal_sampling
/// The field is sampled about the corners of a cell; between them it may go a little beyond.
constexpr double k_field_slack = 1.2;
/// Corners of a cell, see Cell::weights.
constexpr double k_corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};

}  // namespace

PlacingRules::PlacingRules(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
                           const DirectionField& field, const JobStage& stage)
    : mesh_(&mesh),
      flat_(mesh, options.threads),
      field_(&field),
      shapes_(shapes),
      bends_(options.bend),
      size_(options.size),
      smallest_factor_(options.smallest),
      largest_factor_(options.largest) {
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    radii_.push_back(shapes[shape].circumradius());
    inradii_.push_back(shapes[shape].inradius());
    areas_.push_back(shapes[shape].area());
    const int directions = field.symmetry();
    const int different = shapes[shape].has_half_turn() && directions % 2 == 0 ? directions / 2 : directions;
    for (const bool is_mirrored : {false, true})
      for (int turn = 0; turn < different && is_mirrored <= options.mirror; ++turn)
        kinds_.push_back({static_cast<Index>(shape), turn, is_mirrored});
  }
  if (kinds_.size() > k_most_kinds)
    throw InputError(message("shapes: ", shapes.size(), " of them make ", kinds_.size(),
                             " kinds by the field's directions and their mirror images, more than the ", k_most_kinds,
                             " that can be told apart; leave some out, or insert them one after the other"));
  make_bodies(shapes, options, stage);
}

void PlacingRules::make_bodies(std::span<const Shape> shapes, const DistributionOptions& options,
                               const JobStage& stage) {
  const auto [least, most] = std::minmax_element(size_.begin(), size_.end());
  least_scale_ = *least * smallest_factor_;
  const double most_scale = *most * largest_factor_;
  const int levels =
      options.gap > 0 ? 1 + static_cast<int>(std::log(most_scale / least_scale_) / std::log(k_size_step)) : 1;
  bodies_.resize(2 * shapes.size());
  smallest_radius_ = *std::min_element(radii_.begin(), radii_.end()) * least_scale_;
  std::vector<std::pair<std::size_t, int>> work;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (i % 2 == 1 && !options.mirror) continue;
    bodies_[i].resize(static_cast<std::size_t>(levels));
    for (int level = 0; level < levels; ++level) work.push_back({i, level});
  }
  parallel_for(static_cast<Index>(work.size()), options.threads, 1, [&](Index k, int) {
    stage.check();
    const auto [i, level] = work[k];
    const Shape side = i % 2 == 0 ? shapes[i / 2] : shapes[i / 2].mirrored();
    const double scale = least_scale_ * std::pow(k_size_step, level);
    bodies_[i][level] =
        std::make_unique<CollisionShape>(options.gap > 0 ? grown(side, 0.5 * options.gap / scale) : side);
  });
  smallest_body_area_ = std::numeric_limits<double>::infinity();
  for (const auto& sizes : bodies_)
    if (!sizes.empty())
      smallest_body_area_ = std::min(smallest_body_area_, sizes[0]->shape.area() * least_scale_ * least_scale_);
  for (const auto& sizes : bodies_)
    for (std::size_t level = 0; level < sizes.size(); ++level) {
      largest_body_radius_ = std::max(largest_body_radius_, sizes[level]->shape.circumradius());
      const double scale = std::min(most_scale, least_scale_ * std::pow(k_size_step, level + 1));
      largest_radius_ =
          std::max(largest_radius_, sizes[level]->shape.circumradius() * (levels == 1 ? most_scale : scale));
    }
}

const CollisionShape& PlacingRules::body(Index kind, double scale) const {
  const auto& sizes = bodies_[2 * static_cast<std::size_t>(kinds_[kind].shape) + (kinds_[kind].is_mirrored ? 1 : 0)];
  if (sizes.size() == 1) return *sizes[0];
  const auto level = static_cast<int>(std::log(scale / least_scale_) / std::log(k_size_step));
  return *sizes[static_cast<std::size_t>(std::clamp(level, 0, static_cast<int>(sizes.size()) - 1))];
}

Copy PlacingRules::copy(Index kind, const SurfacePoint& center, double field_angle, double scale) const {
  const Kind& what = kinds_[kind];
  const double angle = field_angle + 2 * std::numbers::pi * what.turn / field_->symmetry();
  return {{what.shape, center, angle, scale, what.is_mirrored}, &body(kind, scale), 0};
}

std::optional<CenterLine> PlacingRules::line(const Placement& placement) const {
  if (!bends_) return std::nullopt;
  // Of the shape itself, not of what holds the gap: the line that it will be laid along in the end.
  return center_line(*field_, placement, box_of(shapes_[static_cast<std::size_t>(placement.shape)].loops(), placement));
}

double PlacingRules::size_at(Index face, const Vec2& weights) const {
  if (size_.size() == 1) return size_[0];
  const Triangle& t = mesh_->triangles()[face];
  return size_[t[0]] * (1 - weights.x() - weights.y()) + size_[t[1]] * weights.x() + size_[t[2]] * weights.y();
}

CellView PlacingRules::view(const Cell& cell) const {
  CellView view{point_at(cell.face, cell.center()), flat_.place(cell.face, cell.center()), 0, 0, 0, 0, 0};
  view.size = size_at(cell.face, cell.center());
  for (const auto& [along, up] : k_corners) {
    const Vec2 corner = cell.weights(along, up);
    view.radius = std::max(view.radius, (flat_.place(cell.face, corner) - view.place).norm());
    view.size_spread = std::max(view.size_spread, std::abs(size_at(cell.face, corner) - view.size));
  }
  return view;
}

void PlacingRules::turn(const Cell& cell, CellView& view) const {
  view.angle = field_->angle_at(view.center);
  // Beside a vertex the field depends on the side from which one comes, so it is asked for a little off the corners.
  constexpr double k_off = 0.01;
  for (int i = 0; i < 3; ++i) {
    for (int k = 1; k < 3; ++k) {
      const int other = (i + k) % 3;
      const double along = k_corners[i][0] + k_off * (k_corners[other][0] - k_corners[i][0]);
      const double up = k_corners[i][1] + k_off * (k_corners[other][1] - k_corners[i][1]);
      const double angle = field_->angle_at(point_at(cell.face, cell.weights(along, up)));
      view.angle_spread = std::max(view.angle_spread, k_field_slack * std::abs(angle - view.angle));
    }
  }
}

}  // namespace saddleback::distribution
