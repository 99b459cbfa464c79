// Window propagation after [chen1990] with the filters of [xin2009].
//
// A window is a part of a half-edge that one root sees along straight lines; it is passed on through the face beyond,
// to one or both of the other edges. A root is a source or a vertex at which a shortest path bends: a saddle vertex or
// one on the boundary. What keeps the windows few: of all windows that cover the angle opposite a half-edge only the
// nearest is split in two ("one angle, one split"), and a child that some corner of the face offers a shorter way to is
// not made.
//
// Departures. (1) Distances of vertices are upper bounds that only fall, a vertex whose distance falls bends anew, and
// the order of windows changes the work alone: buckets replace the heap. (2) Rays through a vertex belong to the
// windows on both its sides, and nothing is dropped that does not lose by more than rounding: that makes regular grids
// right. (3) A ray to the apex that just misses its window still counts, with the detour round the window's end, which
// is a real path. (4) No window is lost, whatever lies near to what:
//  - Directions of short edges come from positions (see unfold): each face turns an image of a root by a few roundings,
//    not by a rounding of the longest edge over the shortest.
//  - Windows are told apart by the angle of their rays, which is the same on every edge. Neighbors share the ray
//    through a vertex v, each with its own rounding. Where they overlap, both go on. Where they leave a gap, or where
//    one narrower than k_narrow is dropped, the gap's rays lie within k_narrow of a ray that is kept: a vertex in it is
//    an apex of faces that this ray crosses, and takes the detour; an edge in it has ends closer than k_narrow times
//    the distance, and what is seen through it alone lies in the gap as well. The detour over a ray at the angle a is
//    longer by a^2 / 2 of the way, or by no more than the gap where the vertex is next to v.
//  - "One angle, one split" holds for rays that differ; two that are one but for rounding hide nothing.
//  - What is left is looked for (see cover_again).
// (5) Rays that have gone all round a tip, a vertex of a small angle, or a thin tube are dropped: needles to one apex
// or along the tube would send them round it for ever.

#include "geodesics/exact/exact_propagation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"

#include "geodesics/exact/exact_windows.h"
#include "geodesics/exact/window_trim.h"
#include "geodesics/unfolding/common_length.h"
#include "geodesics/unfolding/tips.h"
#include "support/memory/memory.h"

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
// The margin by which a filter must win, relative to the distance: rounding over thousands of faces stays below it.
constexpr double k_slack = 1e-11;
// Two sources this close, relative to the distance, are equally near.
constexpr double k_tie = 1e-12;
// Radians. Narrower windows are not made: the rays of two windows through one flat vertex lie this far apart at most,
// by the rounding of some thousand faces. A share of the edge instead would be a whole near-coincident pair of vertices
// farther on.
constexpr double k_narrow = 1e-12;
// Radians. A ray to the apex that misses its window by no more counts, with the detour round the window's end; rays no
// farther apart may be one but for rounding.
constexpr double k_miss = 1e-7;
// Where rays meet an edge is rounded to a share of the edge, at most this many roundings. Nearer to the root than a
// share of the edge that is more than k_narrow: there windows are as much wider, so that neighbors overlap.
constexpr double k_rounding = 16 * std::numeric_limits<double>::epsilon(), k_near = 1.0 / 16;
constexpr double k_narrow_fan = 1e-12;  ///< radians; rounding of the sum of a vertex's angles
constexpr double k_buckets_per_edge = 4;
// A face this many times as long as high is a needle. Rays that go round what is thinner than its edges are long do so
// among needles alone.
constexpr double k_needle = 64;
constexpr std::uint16_t k_usual_windows = 64;  ///< through one half-edge of a needle
constexpr Index k_ahead = 4;                   ///< windows, enough for memory to answer

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
double squared(double x, double y) { return x * x + y * y; }
double length_of(double x, double y) { return std::sqrt(squared(x, y)); }
/// Tells whether a length, which may be negative, is less than the root of a square.
bool is_less(double length, double square) { return length < 0 || length * length < square; }

/// Tells whether the rays from (x, y), y < 0, through two places of the x axis lie no more than that angle apart.
bool is_within(double angle, double x, double y, double b, double c) {
  const double area = (c - b) * y;
  return area * area <= angle * angle * (squared(b - x, y) * squared(c - x, y));
}

}  // namespace

ExactPropagation::ExactPropagation(const ExactSurface& surface, const SurfacePoints& sources,
                                   const ExactPropagationOptions& options)
    : surface_(surface),
      sources_(sources),
      options_(options),
      queue_(std::make_unique<WindowQueue>(common_length(surface.mesh()) / k_buckets_per_edge)),
      distances_(surface.vertex_count(), k_far),
      bent_at_(surface.vertex_count(), k_far),
      arrivals_(surface.vertex_count(), {0, 0, Arrival::k_unreached, k_none}),
      occupants_(surface.halfedge_count(), {k_far, 0}) {}

void ExactPropagation::run(const JobStage& stage) {
  start(stage);
  do {
    while (queue_->advance() && queue_->reached() <= options_.limit) {
      while (WindowBlock* const block = queue_->take()) drain(block, stage);
      // Last in the bucket: by now their distances are final, nearly always.
      for (const Index vertex : due_) bend(vertex);
      due_.clear();
    }
  } while (cover_again());
  stage.update(1);
}

/// Tells whether some vertex is farther than by an edge from its neighbor. No window that comes to the neighbor went
/// on, then: it becomes a root, which emits windows all round it. So whatever rounding does, no vertex of a component
/// stays unreached and no two ends of an edge are farther from each other than it is long.
bool ExactPropagation::cover_again() {
  const auto look = [&](Index a, Index b, double length) {
    if (!(std::abs(distances_[a] - distances_[b]) > length)) [[likely]]
      return;
    const Index from = distances_[a] < distances_[b] ? a : b, to = from == a ? b : a;
    const double way = distances_[from] + length;
    if (way <= options_.limit && way < distances_[to] * (1 - k_tie)) due_.push_back(from);
  };
  for (Index h = 0; h < surface_.halfedge_count(); h += 3) {
    const EdgeFrame& frame = surface_.frame(h);
    look(frame.from, frame.to, frame.length);
    look(frame.from, frame.apex, frame.left_length);
    look(frame.to, frame.apex, frame.right_length);
  }
  if (due_.empty()) return false;
  queue_->clear();
  for (const Index vertex : due_) bend(vertex);
  due_.clear();
  return true;
}

void ExactPropagation::release() {
  queue_.reset();
  kept_ = {};
  bent_at_ = {};
  occupants_ = {};
  passed_ = {};
  earlier_ = {};
  due_ = {};
}

std::size_t ExactPropagation::nbytes() const {
  return distances_.size() * sizeof(double) + arrivals_.size() * sizeof(Arrival) + bent_at_.size() * sizeof(double) +
         occupants_.size() * sizeof(Occupant);
}

/// Asks for what a window needs before it is its turn: half of the time would be waiting for memory.
void ExactPropagation::fetch(Index halfedge) const {
  if (halfedge < 0) return;
  __builtin_prefetch(&surface_.frame(halfedge));
  __builtin_prefetch(&occupants_[halfedge]);
}

/// Propagates a chain of blocks.
void ExactPropagation::drain(WindowBlock* block, const JobStage& stage) {
  constexpr std::int64_t k_blocks_a_look = 16;
  while (block) {
    if (block_count_++ % k_blocks_a_look == 0) stage.update(share_done());
    for (Index i = 0; i < block->size; ++i) {
      const Window& window = block->items[i];
      if (i + k_ahead < block->size) fetch(block->items[i + k_ahead].halfedge);
      if (window.halfedge >= 0) {
        if (surface_.has_sources_beside(window.halfedge)) [[unlikely]] {
          stage.check();  // there may be many
          pass_sources(window);
        } else {
          propagate(window);
        }
        ++window_count_;
      } else if (distances_[~window.halfedge] == window.sigma) {
        due_.push_back(~window.halfedge);
      }
    }
    WindowBlock* const next = block->next;
    if (options_.keep_windows) {
      keep(block);
    } else {
      queue_->give_back(block);
    }
    block = next;
  }
}

/// Keeps a block as long as memory is left to copy all windows that are kept: smooth surfaces of a million vertices
/// have a thousand windows for each.
void ExactPropagation::keep(WindowBlock* block) {
  constexpr std::size_t k_blocks_a_look = 1 << 12;  // 16 MB
  queue_->keep(block);
  kept_.push_back(block);
  if (kept_.size() % k_blocks_a_look != 0) return;
  const auto windows = static_cast<double>(kept_.size()) * WindowBlock::k_capacity;
  const auto available = static_cast<double>(available_memory());
  if (available <= 0 || windows * KeptWindows::k_bytes_each <= available) return;
  throw InputError(message("mesh: the windows of exact distances take ", in_gigabytes(windows * sizeof(Window)),
                           " when ", reached_count_, " of ", surface_.vertex_count(), " vertices are reached, and ",
                           in_gigabytes(available),
                           " of memory are left; exact_distances keeps no windows, a distance ", "graph needs none"));
}

/// Returns the share of the vertices that are reached; within a limit, the share of the disk behind the front if
/// larger.
double ExactPropagation::share_done() const {
  const double vertices = static_cast<double>(reached_count_) / std::max<Index>(1, surface_.vertex_count());
  const double radius = queue_->reached() / options_.limit;
  return std::max(vertices, radius * radius);
}

void ExactPropagation::start(const JobStage& stage) {
  for (Index i = 0; i < static_cast<Index>(sources_.size()); ++i) {
    const Index vertex = vertex_at(surface_.mesh(), sources_[i]);
    if (vertex != k_none) offer(surface_.vertex_of(vertex), 0, {0, 0, Arrival::k_at_source, i});
  }
  const SourceInFace* last = nullptr;
  for (const SourceInFace& place : surface_.sources_in_faces()) {
    const bool is_repeated = last && last->face == place.face && last->barycentric == place.barycentric;
    stage.check();
    if (!is_repeated) start_in_face(place);
    last = &place;
  }
}

/// Cones of the three edges of a face what no other source in it is nearer to.
void ExactPropagation::start_in_face(const SourceInFace& place) {
  const Index root = surface_.vertex_count() + place.source;
  const std::span<const SourceInFace> others = surface_.sources_in(place.face);
  for (Index h = 3 * place.face; h < 3 * place.face + 3; ++h) {
    const EdgeFrame& frame = surface_.frame(h);
    const Vec2 center = surface_.in_frame(h, place.barycentric), to_apex = Vec2(frame.apex_x, frame.apex_y) - center;
    offer(frame.apex, to_apex.norm(), {to_apex.x(), to_apex.y(), h, root});
    const Index entered = surface_.twin(h);
    if (entered == k_none || center.y() == 0) continue;
    double begin = 0, end = frame.length;
    for (const SourceInFace& other : others) {
      const Vec2 there = surface_.in_frame(h, other.barycentric);
      const double dx = there.x() - center.x();
      const double middle = (there.squaredNorm() - center.squaredNorm()) / (2 * dx);  // as far from either
      if (dx > 0) end = std::min(end, middle);
      if (dx < 0) begin = std::max(begin, middle);
      if (dx == 0 && there.y() < center.y()) end = begin;
    }
    if (begin < end)
      cone({frame.length - center.x(), -center.y(), frame.length - end, frame.length - begin, 0, entered, root});
  }
}

void ExactPropagation::cone(const Window& w) {
  queue_->push(w, w.sigma + length_of(std::clamp(w.sx, w.b0, w.b1) - w.sx, w.sy));
}

/// A vertex can be reached this way: remembers the shortest.
void ExactPropagation::offer(Index vertex, double distance, const Arrival& arrival) {
  const double known = distances_[vertex];
  if (distance >= known) {
    if (options_.break_ties && distance <= known * (1 + k_tie) && owns_before(arrival, arrivals_[vertex]))
      arrivals_[vertex] = arrival;  // no bend is due again: what bends here is right for either path
    return;
  }
  const bool keeps_owner =
      options_.break_ties && distance >= known * (1 - k_tie) && owns_before(arrivals_[vertex], arrival);
  reached_count_ += known == k_far;
  distances_[vertex] = distance;
  if (!keeps_owner) arrivals_[vertex] = arrival;
  if (surface_.may_bend(vertex) || arrival.halfedge == Arrival::k_at_source)
    queue_->push({0, 0, 0, 0, distance, ~vertex, k_none}, distance);
}

/// Tells whether the first of two arrivals as long as each other belongs to the smaller source.
bool ExactPropagation::owns_before(const Arrival& a, const Arrival& b) const {
  if (a.halfedge == Arrival::k_at_source || b.halfedge == Arrival::k_at_source)
    return a.halfedge == b.halfedge && a.root < b.root;
  return owner(a.root) < owner(b.root);
}

Index ExactPropagation::owner(Index root) const {
  while (root < surface_.vertex_count()) {
    const Arrival& arrival = arrivals_[root];
    if (arrival.halfedge == Arrival::k_at_source) return arrival.root;
    root = arrival.root;
  }
  return root - surface_.vertex_count();
}

/// Tells whether an end of its edge offers every point of the window a shorter way.
inline bool ExactPropagation::is_beaten_by_corners(const Window& w) const {
  const EdgeFrame& frame = surface_.frame(w.halfedge);
  const double at_from = distances_[frame.from] * (1 + k_slack) - w.sigma;
  const double at_to = distances_[frame.to] * (1 + k_slack) - w.sigma;
  return is_less(at_from + w.b1, squared(w.b1 - w.sx, w.sy)) ||
         is_less(at_to + (frame.length - w.b0), squared(w.b0 - w.sx, w.sy));
}

/// Tells whether the rays have gone all round a tip that they end at.
inline bool ExactPropagation::circles_tip(const Window& w) const {
  const EdgeFrame& frame = surface_.frame(w.halfedge);
  return (w.b1 == frame.length && circles(surface_.tangent_of_tip(frame.to), frame.length - w.sx, -w.sy)) ||
         (w.b0 == 0 && circles(surface_.tangent_of_tip(frame.from), w.sx, -w.sy));
}

/// Tells whether an earlier window of the same root offers all of this one a shorter way. So it is where rays have gone
/// round a tube or a tip and come to an edge once more. Asked only where windows are unusually many.
bool ExactPropagation::goes_round(const Window& w) {
  if (passed_.empty()) passed_.resize(occupants_.size(), 0);
  if (passed_[w.halfedge] < k_usual_windows) {
    ++passed_[w.halfedge];
    return false;
  }
  const std::uint64_t key = (static_cast<std::uint64_t>(w.root) << 32) | static_cast<std::uint32_t>(w.halfedge);
  const auto [at, is_new] = earlier_.try_emplace(key, w);
  if (is_new) return false;
  Window& earlier = at->second;
  // Between the ends of both windows the lead is linear in its sign; beyond the earlier one's it only grows.
  const auto is_longer = [&](double x) {
    const double through = std::clamp(x, earlier.b0, earlier.b1);
    const double way = length_of(through - earlier.sx, earlier.sy) + std::abs(x - through);
    return way * (1 + k_slack) < length_of(x - w.sx, w.sy);
  };
  if (earlier.sigma == w.sigma && is_longer(w.b0) && is_longer(w.b1)) return true;
  earlier = w;
  return false;
}

/// Propagates the part of a window that sources leave. The corners are asked first: they beat most windows that sources
/// beat, and their test is cheaper.
void ExactPropagation::pass_sources(const Window& window) {
  if (is_beaten_by_corners(window)) return;
  const Window part = left_by_sources(window);
  if (part.b0 < part.b1) propagate(part);
}

/// The part of a window that no source in the faces on the two sides of its half-edge is nearer to. So none ever lies
/// between the rays of one window, which "one angle, one split" needs: in line behind a source all is nearer to that.
/// Of windows that are kept, which tell what is nearly nearest too, no more is cut off than this needs.
Window ExactPropagation::left_by_sources(Window window) const {
  const Index own = window.root - surface_.vertex_count();
  surface_.for_sources_beside(window.halfedge, [&](const SourceBeside& other) {
    if (other.source == own) return;
    Window part = window;
    trim(part, other.place);
    if (!options_.keep_windows || part.b0 >= part.b1) {
      window = part;
    } else if (const double ahead = other.place.y() - window.sy; ahead > 0 && other.place.y() <= 0) {
      const double line = window.sx - (other.place.x() - window.sx) * (window.sy / ahead);
      if (line <= part.b0) window.b0 = std::max(window.b0, line);
      if (line >= part.b1) window.b1 = std::min(window.b1, line);
    }
  });
  return window;
}

void ExactPropagation::propagate(const Window& window) {
  const EdgeFrame& frame = surface_.frame(window.halfedge);
  const auto [sx, sy, b0, b1, sigma, halfedge, root] = window;
  const double length = frame.length, ax = frame.apex_x, ay = frame.apex_y;
  // Distances of the corners, from the root's on.
  const double at_from = distances_[frame.from] * (1 + k_slack) - sigma;
  const double at_to = distances_[frame.to] * (1 + k_slack) - sigma;
  if (is_beaten_by_corners(window) || (surface_.has_tips() && circles_tip(window))) return;
  if (ay * k_needle < length && goes_round(window)) [[unlikely]]
    return;
  const double ox = ax - sx, oy = ay - sy;
  const double split = sx - ox * (sy / oy);  // where the ray to the apex crosses the half-edge
  // Nearly always told by this bound of the product of the two rays.
  const double wide = k_narrow * (squared(b0 - sx, sy) + squared(b1 - sx, sy));
  const bool has_left = split > b0 && ((b0 - split) * sy > wide || !is_within(k_narrow, sx, sy, b0, split));
  const bool has_right = split < b1 && ((split - b1) * sy > wide || !is_within(k_narrow, sx, sy, b1, split));
  bool go_left = has_left && frame.left != k_none, go_right = has_right && frame.right != k_none;
  const double b = std::clamp(split, b0, b1);
  if (split == b || is_within(k_miss, sx, sy, b, split)) {
    const double reach = sigma + length_of(ox, oy);
    if (split == b) {
      offer(frame.apex, reach, {ox, oy, halfedge, root});
    } else {
      offer(frame.apex, sigma + length_of(b - sx, sy) + length_of(ax - b, ay), {ox, oy, halfedge, root});
    }
    if (has_left && has_right) {
      Occupant& occupant = occupants_[halfedge];
      if (reach < occupant.distance) {
        occupant = {reach, split};
      } else if (!is_within(k_miss, sx, sy, split, occupant.split)) {  // as the same ray, neighbors that overlap
        // Beyond the ray of a nearer window all is nearer by that one.
        (split < occupant.split ? go_right : go_left) = false;
      }
    }
  }
  const double at_apex = distances_[frame.apex] * (1 + k_slack) - sigma;
  // Makes a child on the edge from a corner `near` of the half-edge to the apex. Coordinates start at that corner: the
  // half-edge on the x axis, the edge of length `l` in direction (ux, uy), the parent between `begin` and `end`.
  const auto child = [&](double l, double ux, double uy, double x, double begin, double end, bool to_apex,
                         double at_near, double at_far, auto&& make) {
    const auto hit = [&](double at) {  // where the ray through (at, 0) meets the edge
      const double divisor = uy * (x - at) - sy * ux;
      return divisor > 0 ? std::min(-sy * at / divisor, l) : l;
    };
    double q0 = hit(begin), q1 = to_apex ? l : hit(end);
    const double cx = ux * x + uy * sy, cy = std::min(0.0, ux * sy - uy * x);
    double to_q0 = squared(cx - q0, cy), to_q1 = squared(cx - q1, cy);
    if (std::min(to_q0, to_q1) < k_near * k_near * l * l) [[unlikely]] {
      const double share = k_rounding * l / std::max(-cy, k_rounding * l);
      q0 = std::max(0.0, q0 - share * std::sqrt(to_q0)), q1 = std::min(l, q1 + share * std::sqrt(to_q1));
      to_q0 = squared(cx - q0, cy), to_q1 = squared(cx - q1, cy);
    }
    if (!(q1 > q0)) return;
    if (is_less(at_near + q1, to_q1) || is_less(at_apex + (l - q0), to_q0)) return;
    if (is_less(at_far + length_of(length - q0 * ux, q0 * uy), to_q0)) return;
    make(cx, cy, q0, q1, sigma + (cx < q0 ? std::sqrt(to_q0) : cx > q1 ? std::sqrt(to_q1) : -cy));
  };
  if (go_left) {
    const double l = frame.left_length, to_unit = 1 / l;
    child(l, ax * to_unit, ay * to_unit, sx, b0, b1, has_right, at_from, at_to,
          [&](double cx, double cy, double q0, double q1, double key) {
            queue_->push({cx, cy, q0, q1, sigma, frame.left, root}, key);
          });
  }
  if (go_right) {  // the mirror image
    const double l = frame.right_length, to_unit = 1 / l;
    child(l, frame.to_end() * to_unit, ay * to_unit, length - sx, length - b1, length - b0, has_left, at_to, at_from,
          [&](double cx, double cy, double q0, double q1, double key) {
            queue_->push({l - cx, cy, l - q1, l - q0, sigma, frame.right, root}, key);
          });
  }
}

/// Direction in which the path comes to a vertex, as an angle about it from first_halfedge.
double ExactPropagation::arrival_angle(Index vertex) const {
  const Mesh& mesh = surface_.mesh();
  const Arrival& arrival = arrivals_[vertex];
  const bool along_edge = arrival.halfedge == Arrival::k_along_edge;
  const Index neighbor = along_edge ? surface_.mesh_vertex(arrival.root) : k_none;
  const Index through = along_edge ? k_none : Mesh::prev(surface_.mesh_halfedge(arrival.halfedge));
  const Index first = mesh.first_halfedge(surface_.mesh_vertex(vertex));
  Index h = first;
  double angle = 0;
  do {
    if (along_edge && mesh.to(h) == neighbor) return angle;
    if (h == through) {
      const EdgeFrame& frame = surface_.frame(arrival.halfedge);
      const Vec2 apex(frame.apex_x, frame.apex_y), offset(arrival.x, arrival.y);
      return angle + std::clamp(std::atan2(cross(apex, offset), apex.dot(offset)), 0.0, mesh.corner_angle(h));
    }
    angle += mesh.corner_angle(h);
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
  return angle;  // along the last edge of a boundary vertex
}

/// Makes a vertex a root: it emits windows in the directions that are at least pi from where the path comes, on both
/// sides.
void ExactPropagation::bend(Index vertex) {
  const double distance = distances_[vertex];
  if (bent_at_[vertex] <= distance) return;
  bent_at_[vertex] = distance;
  const Mesh& mesh = surface_.mesh();
  const Index original = surface_.mesh_vertex(vertex);
  const double total = mesh.total_angle(original);
  double beam[2][2] = {{0, total}, {0, 0}};
  const bool is_covered_again = !surface_.may_bend(vertex);
  if (arrivals_[vertex].halfedge != Arrival::k_at_source && !surface_.is_beside_source(vertex) && !is_covered_again) {
    const double angle = arrival_angle(vertex);
    if (mesh.is_boundary(original)) {  // round the outside any angle will do
      beam[0][1] = angle - k_pi;
      beam[1][0] = angle + k_pi;
      beam[1][1] = total;
    } else {
      beam[0][0] = angle + k_pi;
      beam[0][1] = angle + total - k_pi;
      beam[1][0] = beam[0][0] - total;
      beam[1][1] = beam[0][1] - total;
    }
  }
  const Index first = mesh.first_halfedge(original);
  Index h = first;
  double angle = 0;
  do {
    const double corner = mesh.corner_angle(h);
    const Index out = surface_.halfedge_of(h);
    const EdgeFrame& frame = surface_.frame(out);
    offer(frame.to, distance + frame.length, {0, 0, Arrival::k_along_edge, vertex});
    for (const auto& range : beam) {
      const double begin = std::max(0.0, range[0] - angle), end = std::min(corner, range[1] - angle);
      if (end - begin > k_narrow_fan) cone_opposite(vertex, out, begin, end);
    }
    if (mesh.twin(Mesh::prev(h)) == k_none)
      offer(frame.apex, distance + frame.left_length, {0, 0, Arrival::k_along_edge, vertex});
    angle += corner;
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
}

/// Cones the edge opposite `vertex` in the face of half-edge `out`, between two angles from `out`.
void ExactPropagation::cone_opposite(Index vertex, Index out, double begin, double end) {
  const EdgeFrame& frame = surface_.frame(out);
  const Index entered = frame.right;
  if (entered == k_none) return;
  const double corner = surface_.mesh().corner_angle(surface_.mesh_halfedge(out));
  const double length = frame.right_length;
  const auto place = [&](double angle) {  // from the apex on, as the entered half-edge runs
    if (angle <= 0) return length;
    if (angle >= corner) return 0.0;
    const double a = frame.length * std::sin(angle), c = frame.left_length * std::sin(corner - angle);
    return length * (c / (a + c));
  };
  const EdgeFrame& opposite = surface_.frame(Mesh::next(out));
  cone({opposite.to_end(), -opposite.apex_y, place(end), place(begin), distances_[vertex], entered, vertex});
}

}  // namespace saddleback
