#include "geodesics/exact/exact_windows.h"

#include <algorithm>
#include <cmath>

#include "support/hypotenuse.h"

namespace saddleback {
namespace {

constexpr double k_slack = 1e-11;    // as in the propagation
constexpr double k_choosing = 0.75;  // the share of the time until windows are copied to their places

double root_distance(const ExactSurface& surface, const ExactPropagation& propagation, Index root) {
  return root < surface.vertex_count() ? propagation.distance(root) : 0.0;
}

/// Tells whether some corner of its edge offers all of a window a shorter way, or its root a longer one than it has by
/// now.
bool is_needless(const ExactSurface& surface, const ExactPropagation& propagation, const Window& w) {
  if (w.sigma > root_distance(surface, propagation, w.root))
    return true;  // the root was found nearer later on, and sent windows again
  const EdgeFrame& frame = surface.frame(w.halfedge);
  const double at_from = propagation.distance(frame.from) * (1 + k_slack) - w.sigma;
  const double at_to = propagation.distance(frame.to) * (1 + k_slack) - w.sigma;
  return at_from + w.b1 < hypotenuse(w.sx - w.b1, w.sy) ||
         at_to + (frame.length - w.b0) < hypotenuse(w.sx - w.b0, w.sy);
}

}  // namespace

KeptWindows::KeptWindows(const ExactSurface& surface, const ExactPropagation& propagation, const JobStage& stage)
    : surface_(surface), propagation_(propagation), begins_(surface.halfedge_count() + 1, 0) {
  const auto blocks = static_cast<double>(propagation.kept().size());
  const JobStage choosing = stage.part(0, k_choosing), copying = stage.part(k_choosing, 1);
  double done = 0;
  for (WindowBlock* const block : propagation.kept()) {
    choosing.update(done++ / blocks);
    Index count = 0;
    for (Index i = 0; i < block->size; ++i) {
      const Window& window = block->items[i];
      if (window.halfedge < 0 || is_needless(surface, propagation, window)) continue;
      ++begins_[window.halfedge + 1];
      block->items[count++] = window;
    }
    block->size = count;
  }
  for (Index h = 0; h < surface.halfedge_count(); ++h) begins_[h + 1] += begins_[h];
  windows_.resize(begins_.back());
  roots_.resize(begins_.back());
  std::vector<std::int64_t> next(begins_.begin(), begins_.end() - 1);
  done = 0;
  for (const WindowBlock* const block : propagation.kept()) {
    copying.update(done++ / blocks);
    for (Index i = 0; i < block->size; ++i) {
      const Window& window = block->items[i];
      const std::int64_t place = next[window.halfedge]++;
      windows_[place] = {window.sx, window.sy, window.b0, window.b1};
      roots_[place] = window.root;
    }
  }
  stage.update(1);
}

SightLine KeptWindows::way_through(std::int64_t i, Index halfedge, const Vec2& point) const {
  const KeptWindow& w = windows_[i];
  const WayThrough way(w, root_distance(surface_, propagation_, roots_[i]), point);
  return {way.distance, way.crossing, halfedge, roots_[i], {w.sx, w.sy}};
}

void KeptWindows::improve(Index halfedge, const Vec2& point, SightLine& best) const {
  for (std::int64_t i = begins_[halfedge]; i < begins_[halfedge + 1]; ++i)
    if (const SightLine way = way_through(i, halfedge, point); way.distance < best.distance) best = way;
}

std::size_t KeptWindows::nbytes() const {
  return windows_.size() * sizeof(KeptWindow) + roots_.size() * sizeof(Index) + begins_.size() * sizeof(std::int64_t);
}

}  // namespace saddleback
