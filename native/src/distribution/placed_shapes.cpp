#include "distribution/placed_shapes.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "predicates/planar_loops.h"

namespace saddleback::distribution {
namespace {

constexpr int k_most_rings = 8;

/// The points of a face that are within `reach` of the origin of the copy's plane, as a box of weights; false when
/// there are none. e1 and e2: where its edges from corner 0 lie.
bool reached_box(const FacePlace& place, const Vec2& e1, const Vec2& e2, double reach, Vec2& low, Vec2& high) {
  const double area = e1.x() * e2.y() - e1.y() * e2.x();
  const auto weights = [&](const Vec2& arm) {
    return Vec2((arm.x() * e2.y() - arm.y() * e2.x()) / area, (e1.x() * arm.y() - e1.y() * arm.x()) / area);
  };
  const Vec2 center = weights(-place.origin);
  // A circle of the plane is an ellipse in weights, as wide as the gradients of the weights are long.
  const Vec2 half(reach * e2.norm() / area, reach * e1.norm() / area);
  low = (center - half).cwiseMax(0.0);
  high = (center + half).cwiseMin(1.0);
  const Vec2 third = -Vec2(e1 - e2);  // the third weight's gradient is as long as this over the area
  const double sum_low = center.sum() - reach * third.norm() / area;
  return low.x() <= high.x() && low.y() <= high.y() && sum_low <= 1;
}

}  // namespace

PlacedShapes::PlacedShapes(const Mesh& mesh, const FlatFaces& flat, double least, double most)
    : mesh_(&mesh),
      flat_(&flat),
      least_(least),
      reach_(most),
      rings_(1 + std::clamp(static_cast<int>(std::ceil(std::log2(most / least) - 1e-9)), 0, k_most_rings - 1)),
      buckets_(mesh, least + most),
      start_heads_(static_cast<std::size_t>(buckets_.count()), k_none),
      piece_heads_(static_cast<std::size_t>(buckets_.count()), k_none),
      place_heads_(static_cast<std::size_t>(buckets_.count()) * rings_, k_none) {
  // So that the list of blocks does not move while threads look at it.
  places_.reserve(static_cast<std::size_t>(std::numeric_limits<Index>::max() / k_block) + 1);
}

/// Narrows a box of weights to what of the face is that near to the origin; false when there is none. A face that is
/// not divided is taken whole.
bool PlacedShapes::is_reached(const FacePlace& place, double reach, Vec2& low, Vec2& high) const {
  if (buckets_.divisions(place.face) == 1) return true;
  const Vec2 e1 = place.turn * flat_->place(place.face, {1, 0}), e2 = place.turn * flat_->place(place.face, {0, 1});
  return reached_box(place, e1, e2, reach, low, high);
}

bool PlacedShapes::is_free(const Copy& copy, const SurfaceOutline& outline, std::span<const FacePlace> faces) const {
  for (const OutlinePiece& piece : outline.pieces)
    if (meets(piece)) return false;
  // No outlines meet: one point of each loop tells the rest.
  for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop)
    if (is_within_another(outline.pieces[outline.loop_begins[loop]])) return false;
  return !holds_another(copy, faces);
}

bool PlacedShapes::meets(const OutlinePiece& piece) const {
  const Vec2 low = piece.begin.cwiseMin(piece.end), high = piece.begin.cwiseMax(piece.end);
  bool found = false;
  buckets_.visit(piece.face, low, high, [&](Index bucket) {
    for (Index i = piece_heads_[bucket]; i != k_none && !found; i = pieces_[i].next) {
      const Piece& other = pieces_[i];
      const bool apart = (other.begin.cwiseMin(other.end).array() > high.array()).any() ||
                         (other.begin.cwiseMax(other.end).array() < low.array()).any();
      found = !apart && predicates::segments_touch(piece.begin, piece.end, other.begin, other.end);
    }
  });
  return found;
}

bool PlacedShapes::is_within_another(const OutlinePiece& piece) const {
  return visit_touching(piece.face, piece.begin, [&](Index other, const Vec2& place) {
    const Copy& copy = copies_[other];
    return copy.body->distance.exact(place / copy.placement.scale) < k_rounding * copy.body->shape.circumradius();
  });
}

/// Tells whether another copy lies within: it then begins in a face that the outline holds.
bool PlacedShapes::holds_another(const Copy& copy, std::span<const FacePlace> faces) const {
  const double reach = (1 + k_rounding) * copy.radius();
  bool found = false;
  for (const FacePlace& at : faces) {
    Vec2 low = Vec2::Zero(), high = Vec2::Ones();
    if (!is_reached(at, reach, low, high)) continue;
    buckets_.visit(at.face, low, high, [&](Index bucket) {
      for (Index i = start_heads_[bucket]; i != k_none && !found; i = starts_[i].next) {
        const Vec2 place = at.origin + at.turn * flat_->place(at.face, starts_[i].weights);
        found = place.norm() <= reach && copy.body->shape.contains(place / copy.placement.scale);
      }
    });
    if (found) return true;
  }
  return false;
}

void PlacedShapes::add(const Copy& copy, const SurfaceOutline& outline) {
  copies_.push_back(copy);
  for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
    const OutlinePiece& piece = outline.pieces[outline.loop_begins[loop]];
    Index& head = start_heads_[buckets_.at(piece.face, piece.begin)];
    starts_.push_back({piece.begin, head});
    head = static_cast<Index>(starts_.size()) - 1;
  }
  for (const OutlinePiece& piece : outline.pieces)
    buckets_.visit(piece.face, piece.begin.cwiseMin(piece.end), piece.begin.cwiseMax(piece.end), [&](Index bucket) {
      pieces_.push_back({piece.begin, piece.end, piece_heads_[bucket]});
      piece_heads_[bucket] = static_cast<Index>(pieces_.size()) - 1;
    });
}

void PlacedShapes::add_places(Index copy, const std::vector<FacePlace>& places, bool are_touched) {
  const double radius = copies_[copy].radius();
  std::vector<std::pair<std::size_t, const FacePlace*>> found;
  found.reserve(places.size());
  for (const FacePlace& place : places) {
    const Vec2 e1 = place.turn * flat_->place(place.face, {1, 0}), e2 = place.turn * flat_->place(place.face, {0, 1});
    Vec2 low = Vec2::Zero(), high = Vec2::Ones();
    if (!is_reached(place, radius + reach_, low, high)) continue;
    buckets_.visit_cells(place.face, low, high, [&](Index bucket, const Vec2& middle, double share) {
      const double away = (place.origin + middle.x() * e1 + middle.y() * e2).norm() - share * (e1.norm() + e2.norm());
      if (away > radius + reach_) return;
      found.push_back({static_cast<std::size_t>(bucket) * rings_ + ring_of(away - radius), &place});
    });
  }
  Index number = make_room(static_cast<Index>(found.size()));
  for (const auto& [list, place] : found) {
    Place& added = places_[static_cast<std::size_t>(number / k_block)][number % k_block];
    added = {place->turn.cast<float>(), place->origin.cast<float>(), are_touched ? ~copy : copy, k_none};
    added.next = std::atomic_ref(place_heads_[list]).exchange(number++, std::memory_order_relaxed);
  }
}

/// Returns the number of the first of so many new places.
Index PlacedShapes::make_room(Index count) {
  const std::lock_guard lock(places_mutex_);
  const Index first = place_count_;
  place_count_ += count;
  while (static_cast<Index>(places_.size()) * k_block < place_count_)
    places_.push_back(std::make_unique_for_overwrite<Place[]>(k_block));
  return first;
}

}  // namespace saddleback::distribution
