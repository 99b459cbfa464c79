#include "distribution/placing_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback::distribution {
namespace {

/// Copies of sizes that differ by no more share the outline that holds the gap, made for the smallest.
constexpr double k_size_step = 1.15;
/// The field is sampled about the corners of a cell; between them it may go a little beyond.
constexpr double k_field_slack = 1.2;
/// Corners of a cell, see Cell::weights.
constexpr double k_corners[3][2] = {{0, 0}, {1, 0}, {0, 1}};

}  // namespace

PlacingRules::PlacingRules(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
                           const JobStage& stage)
    : mesh_(&mesh),
      flat_(mesh, options.threads),
      fields_(options.fields),
      shapes_(shapes),
      bends_(options.bend),
      size_(options.size),
      smallest_factor_(options.smallest),
      largest_factor_(options.largest) {
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    radii_.push_back(shapes[shape].circumradius());
    inradii_.push_back(shapes[shape].inradius());
    areas_.push_back(shapes[shape].area());
    const int directions = one_or_each(fields_, static_cast<Index>(shape))->symmetry();
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
  std::vector<double> most_scales;
  bool is_any_mirrored = options.mirror;
  for (std::size_t shape = 0; shape < shapes.size(); ++shape) {
    const auto& sizes = one_or_each(size_, static_cast<Index>(shape));
    const auto [least, most] = std::minmax_element(sizes.begin(), sizes.end());
    least_scales_.push_back(*least * smallest_factor_);
    most_scales.push_back(*most * largest_factor_);
  }
  for (const Placement& lying : options.around) {
    least_scales_[lying.shape] = std::min(least_scales_[lying.shape], lying.scale);
    most_scales[lying.shape] = std::max(most_scales[lying.shape], lying.scale);
    is_any_mirrored = is_any_mirrored || lying.mirrored;
  }
  bodies_.resize(2 * shapes.size());
  if (options.gap > 0 && !options.around.empty()) bare_.resize(bodies_.size());
  smallest_radius_ = std::numeric_limits<double>::infinity();
  std::vector<std::pair<std::size_t, int>> work;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const double least = least_scales_[i / 2], most = most_scales[i / 2];
    smallest_radius_ = std::min(smallest_radius_, radii_[i / 2] * least);
    if (i % 2 == 1 && !is_any_mirrored) continue;
    const int levels = options.gap > 0 ? 1 + static_cast<int>(std::log(most / least) / std::log(k_size_step)) : 1;
    bodies_[i].resize(static_cast<std::size_t>(levels));
    for (int level = 0; level < levels; ++level) work.push_back({i, level});
  }
  parallel_for(static_cast<Index>(work.size()), options.threads, 1, [&](Index k, int) {
    stage.check();
    const auto [i, level] = work[k];
    const Shape side = i % 2 == 0 ? shapes[i / 2] : shapes[i / 2].mirrored();
    const double scale = least_scales_[i / 2] * std::pow(k_size_step, level);
    bodies_[i][level] =
        std::make_unique<CollisionShape>(options.gap > 0 ? grown(side, 0.5 * options.gap / scale) : side);
    if (level == 0 && !bare_.empty()) bare_[i] = std::make_unique<CollisionShape>(side);
  });
  smallest_body_area_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto& sizes = bodies_[i];
    const double least = least_scales_[i / 2], most = most_scales[i / 2];
    if (!sizes.empty()) smallest_body_area_ = std::min(smallest_body_area_, sizes[0]->shape.area() * least * least);
    for (std::size_t level = 0; level < sizes.size(); ++level) {
      largest_body_radius_ = std::max(largest_body_radius_, sizes[level]->shape.circumradius());
      const double scale = std::min(most, least * std::pow(k_size_step, level + 1));
      largest_radius_ =
          std::max(largest_radius_, sizes[level]->shape.circumradius() * (sizes.size() == 1 ? most : scale));
    }
  }
}

double PlacingRules::radius_of_smallest_copies() const {
  double radius = 0;
  for (std::size_t shape = 0; shape < radii_.size(); ++shape) {
    const auto& sizes = one_or_each(size_, static_cast<Index>(shape));
    radius = std::max(radius, smallest_factor_ * *std::max_element(sizes.begin(), sizes.end()) * radii_[shape]);
  }
  return radius;
}

double PlacingRules::mean_square_size(Index face) const {
  double sum = 0;
  for (std::size_t shape = 0; shape < size_.size(); ++shape) {
    const double size = size_at(static_cast<Index>(shape), face, Vec2::Constant(1.0 / 3));
    sum += size * size;
  }
  return sum / static_cast<double>(size_.size());
}

double PlacingRules::weight_of(const Kind& kind) const {
  const double square = radii_[kind.shape] * radii_[kind.shape];
  if (size_.size() == 1) return square;
  const std::vector<double>& sizes = one_or_each(size_, kind.shape);
  const double mean = std::accumulate(sizes.begin(), sizes.end(), 0.0) / static_cast<double>(sizes.size());
  return square * mean * mean;
}

double PlacingRules::mean_area() const {
  double area = 0;
  for (const Kind& kind : kinds_) area += areas_[kind.shape];
  return area * mean_square_factor() / static_cast<double>(kinds_.size());
}

const CollisionShape& PlacingRules::body(Index shape, bool is_mirrored, double scale) const {
  const auto& sizes = bodies_[2 * static_cast<std::size_t>(shape) + (is_mirrored ? 1 : 0)];
  if (sizes.size() == 1) return *sizes[0];
  const auto level = static_cast<int>(std::log(scale / least_scales_[shape]) / std::log(k_size_step));
  return *sizes[static_cast<std::size_t>(std::clamp(level, 0, static_cast<int>(sizes.size()) - 1))];
}

Copy PlacingRules::copy(Index kind, const SurfacePoint& center, double field_angle, double scale) const {
  const Kind& what = kinds_[kind];
  const int symmetry = one_or_each(fields_, what.shape)->symmetry();
  const double angle = field_angle + 2 * std::numbers::pi * what.turn / symmetry;
  return {{what.shape, center, angle, scale, what.is_mirrored}, &body(what.shape, what.is_mirrored, scale), 0};
}

std::optional<CenterLine> PlacingRules::line(const Placement& placement) const {
  if (!bends_) return std::nullopt;
  // Of the shape itself, not of what holds the gap: the line that it will be laid along in the end.
  const Shape& shape = shapes_[static_cast<std::size_t>(placement.shape)];
  return center_line(*one_or_each(fields_, placement.shape), placement, box_of(shape.loops(), placement));
}

double PlacingRules::size_at(Index shape, Index face, const Vec2& weights) const {
  const std::vector<double>& size = one_or_each(size_, shape);
  if (size.size() == 1) return size[0];
  const Triangle& t = mesh_->triangles()[face];
  return size[t[0]] * (1 - weights.x() - weights.y()) + size[t[1]] * weights.x() + size[t[2]] * weights.y();
}

double PlacingRules::reach_at(Index face, const Vec2& weights) const {
  double size = 0;
  for (std::size_t shape = 0; shape < size_.size(); ++shape)
    size = std::max(size, size_at(static_cast<Index>(shape), face, weights));
  return smallest_factor_ * size * largest_body_radius_;
}

CellView PlacingRules::view(const Cell& cell) const {
  CellView view{point_at(cell.face, cell.center()), flat_.place(cell.face, cell.center()), 0};
  for (const auto& [along, up] : k_corners)
    view.radius = std::max(view.radius, (flat_.place(cell.face, cell.weights(along, up)) - view.place).norm());
  return view;
}

void PlacingRules::see(const Cell& cell, Index shape, CellView& view) const {
  const bool is_first = view.shape == k_none;
  if (is_first || (size_.size() > 1 && view.shape != shape)) {
    view.size = size_at(shape, cell.face, cell.center());
    view.size_spread = 0;
    for (const auto& [along, up] : k_corners) {
      const double there = size_at(shape, cell.face, cell.weights(along, up));
      view.size_spread = std::max(view.size_spread, std::abs(there - view.size));
    }
  }
  if (is_first || (fields_.size() > 1 && view.shape != shape)) turn(cell, *one_or_each(fields_, shape), view);
  view.shape = shape;
}

void PlacingRules::turn(const Cell& cell, const DirectionField& field, CellView& view) const {
  view.angle = field.angle_at(view.center);
  view.angle_spread = 0;
  // Beside a vertex the field depends on the side from which one comes, so it is asked for a little off the corners.
  constexpr double k_off = 0.01;
  for (int i = 0; i < 3; ++i) {
    for (int k = 1; k < 3; ++k) {
      const int other = (i + k) % 3;
      const double along = k_corners[i][0] + k_off * (k_corners[other][0] - k_corners[i][0]);
      const double up = k_corners[i][1] + k_off * (k_corners[other][1] - k_corners[i][1]);
      const double angle = field.angle_at(point_at(cell.face, cell.weights(along, up)));
      view.angle_spread = std::max(view.angle_spread, k_field_slack * std::abs(angle - view.angle));
    }
  }
}

}  // namespace saddleback::distribution
