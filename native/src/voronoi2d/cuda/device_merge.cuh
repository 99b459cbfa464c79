#pragma once
// Two Delaunay triangulations side by side made one, from their lower common tangent up: [guibas1985].

#include <cstdint>

#include "voronoi2d/cuda/device_plane_signs.cuh"

namespace saddleback::voronoi2d {
namespace {

/// Holds one of an edge's two, which are side by side: where it goes, and what leaves the same site next and before,
/// counter-clockwise.
struct __align__(16) HalfEdge {
  std::int32_t to, next, before;
  std::int16_t is_used, is_side;  ///< the latter of the cells, once there are no parts left to merge
};

/// Triangulations of sites in a row each.
struct MergedMesh {
  const double2* sites;
  HalfEdge* halves;
  std::int32_t* leaving;  ///< from a corner of a triangulation, counter-clockwise along its border; -1: there is none
  const int* failed;      ///< not 0: what is merged is of no use any more
  int most_steps;         ///< of one merge

  static constexpr int k_edges = 3;  ///< room, for each site
  static SADDLEBACK_HOST_DEVICE std::int32_t twin(std::int32_t half) { return half ^ 1; }
  SADDLEBACK_HOST_DEVICE Point2 point(std::int32_t site) const {
    const double2 p = sites[site];
    return {p.x, p.y};
  }
};

/// One of them: the sites that are the first and last by x, then y, and by y alone, and the edges that are free.
struct MergedPart {
  std::int32_t first_x, last_x, first_y, last_y, free, last_free;
};

/// Merges parts. What it leaves where it fails is of no use.
class Merger {
 public:
  SADDLEBACK_HOST_DEVICE explicit Merger(const MergedMesh& mesh) : mesh_(mesh) {}

  SADDLEBACK_HOST_DEVICE MergedPart part_of(std::int32_t site) const {
    const std::int32_t first = MergedMesh::k_edges * site;
    mesh_.leaving[site] = -1;
    for (int k = 0; k < MergedMesh::k_edges; ++k) {
      mesh_.halves[2 * (first + k)] = {k + 1 < MergedMesh::k_edges ? first + k + 1 : -1, 0, 0, 0, 0};
      mesh_.halves[2 * (first + k) + 1].is_used = 0;
    }
    return {site, site, site, site, first, first + MergedMesh::k_edges - 1};
  }

  /// Merges two neighbors; false when something cannot be decided, or takes too long.
  SADDLEBACK_HOST_DEVICE bool merge(const MergedPart& a, const MergedPart& b, MergedPart& both) {
    steps_ = 0;
    fails_ = false;
    if (!face(a, b)) return false;
    both.first_x = comes_first(a.first_x, b.first_x) ? a.first_x : b.first_x;
    both.last_x = comes_first(a.last_x, b.last_x) ? b.last_x : a.last_x;
    both.first_y = lies_lower(a.first_y, b.first_y) ? a.first_y : b.first_y;
    both.last_y = lies_lower(a.last_y, b.last_y) ? b.last_y : a.last_y;
    free_ = a.free;
    if (free_ >= 0) {
      mesh_.halves[2 * a.last_free].to = b.free;
      both.last_free = b.free >= 0 ? b.last_free : a.last_free;
    } else {
      free_ = b.free;
      both.last_free = b.last_free;
    }
    last_free_ = both.last_free;
    const std::int32_t base = join_at_tangent(), first_left = left_;
    const std::int32_t last = fails_ ? base : go_up(base);
    mesh_.leaving[first_left] = MergedMesh::twin(base);
    mesh_.leaving[right_] = last;
    both.free = free_;
    both.last_free = last_free_;
    return !fails_;
  }
  /// Tells, of the last merge, where it failed.
  SADDLEBACK_HOST_DEVICE bool took_too_long() const { return steps_ > mesh_.most_steps; }

 private:
  static constexpr int k_steps_between_looks = 1 << 12;

  SADDLEBACK_HOST_DEVICE void count_step() {
    if (++steps_ > mesh_.most_steps) fails_ = true;
    if (steps_ % k_steps_between_looks == 0 && *static_cast<const volatile int*>(mesh_.failed) != 0) fails_ = true;
  }

  SADDLEBACK_HOST_DEVICE bool comes_first(std::int32_t a, std::int32_t b) const {
    const double2 p = mesh_.sites[a], q = mesh_.sites[b];
    return p.x < q.x || (p.x == q.x && p.y < q.y);
  }

  SADDLEBACK_HOST_DEVICE bool lies_lower(std::int32_t a, std::int32_t b) const {
    const double2 p = mesh_.sites[a], q = mesh_.sites[b];
    return p.y < q.y || (p.y == q.y && p.x > q.x);
  }

  /// Finds out which part is left of the other, or below, and begins where they are nearest to one another.
  SADDLEBACK_HOST_DEVICE bool face(const MergedPart& a, const MergedPart& b) {
    if (comes_first(a.last_x, b.first_x)) return begin(a.last_x, b.first_x);
    if (comes_first(b.last_x, a.first_x)) return begin(b.last_x, a.first_x);
    if (lies_lower(a.last_y, b.first_y)) return begin(a.last_y, b.first_y);
    if (lies_lower(b.last_y, a.first_y)) return begin(b.last_y, a.first_y);
    return false;
  }
  SADDLEBACK_HOST_DEVICE bool begin(std::int32_t left, std::int32_t right) {
    left_ = left;
    right_ = right;
    return true;
  }

  /// Makes the tangent on the right hand of who looks from left to right; the half-edge from right to left.
  SADDLEBACK_HOST_DEVICE std::int32_t join_at_tangent() {
    const HalfEdge* const halves = mesh_.halves;
    const auto is_below = [&](std::int32_t site) {
      return turn_sign(mesh_.point(left_), mesh_.point(right_), mesh_.point(site)) < 0;
    };
    // Along the borders, which may pass a site twice. Where parts begin, they do so once.
    std::int32_t clockwise = mesh_.leaving[left_], onward = mesh_.leaving[right_];
    if (clockwise >= 0) clockwise = halves[clockwise].before;
    while (true) {
      count_step();
      if (fails_) break;
      if (clockwise >= 0 && is_below(halves[clockwise].to)) {
        left_ = halves[clockwise].to;
        clockwise = halves[MergedMesh::twin(clockwise)].before;
      } else if (onward >= 0 && is_below(halves[onward].to)) {
        right_ = halves[onward].to;
        onward = halves[MergedMesh::twin(onward)].next;
      } else {
        break;
      }
    }
    const std::int32_t base = make(right_, left_);
    enter(base, onward);
    enter(MergedMesh::twin(base), clockwise >= 0 ? halves[clockwise].next : -1);
    return base;
  }
  SADDLEBACK_HOST_DEVICE void enter(std::int32_t half, std::int32_t next) {
    if (next >= 0) {
      put(half, mesh_.halves[next].before, next);
    } else {
      mesh_.halves[half].next = mesh_.halves[half].before = half;
    }
  }

  /// Goes up from the edge from right to left, triangle after triangle, to the upper tangent.
  SADDLEBACK_HOST_DEVICE std::int32_t go_up(std::int32_t base) {
    const HalfEdge* const halves = mesh_.halves;
    base_ = base;
    next_left_ = halves[MergedMesh::twin(base)].next;
    next_right_ = halves[base].before;
    Question question;
    while (!go_up_quickly(question)) {
      const std::int32_t* const about = question.about;
      const Point2 a = mesh_.point(about[0]), b = mesh_.point(about[1]), c = mesh_.point(about[2]);
      bool is_known = true;
      question.signs[question.asked] = question.asked >= Question::turn_left
                                           ? exact_turn_sign(a, b, c)
                                           : rare_circle_sign(a, b, c, mesh_.point(about[3]), is_known);
      question.answered |= 1 << question.asked;
      if (!is_known) fails_ = true;
    }
    return base_;
  }

  /// Answers elsewhere what doubles do not tell in a step, so that it takes no registers here, and then is known when
  /// the step is begun again.
  struct Question {
    enum { in_left, in_right, in_side, turn_left, turn_right };
    int asked = 0, answered = 0;
    int signs[5];
    std::int32_t about[4];

    SADDLEBACK_HOST_DEVICE bool tells(int which, bool is_known, int& sign, std::int32_t a, std::int32_t b,
                                      std::int32_t c, std::int32_t d) {
      if (is_known) return true;
      sign = signs[which];
      if (answered >> which & 1) return true;
      asked = which;
      about[0] = a, about[1] = b, about[2] = c, about[3] = d;
      return false;
    }
  };

  /// False when there is a question. On either side a candidate for the next triangle goes when the edge behind it ends
  /// inside the circle through it and the base. All that a step may need is looked up and tested at once: lanes stay
  /// together, and none waits for one thing after the other.
  SADDLEBACK_HOST_DEVICE bool go_up_quickly(Question& question) {
    HalfEdge* const halves = mesh_.halves;
    while (true) {
      const std::int32_t back = MergedMesh::twin(base_), left = next_left_, right = next_right_;
      if (left == back && right == base_) return true;
      count_step();
      if (fails_) return true;
      const HalfEdge on_left = halves[left], on_right = halves[right];
      const HalfEdge left_twin = halves[MergedMesh::twin(left)], right_twin = halves[MergedMesh::twin(right)];
      const std::int32_t behind_left = halves[on_left.next].to, behind_right = halves[on_right.before].to;
      const Point2 left_at = mesh_.point(left_), right_at = mesh_.point(right_);
      const Point2 from_left = mesh_.point(on_left.to), from_right = mesh_.point(on_right.to);
      bool knows[5];
      int in_left = quick_circle_sign(left_at, right_at, from_left, mesh_.point(behind_left), knows[Question::in_left]);
      int in_right =
          quick_circle_sign(left_at, right_at, from_right, mesh_.point(behind_right), knows[Question::in_right]);
      int in_side = quick_circle_sign(from_left, left_at, right_at, from_right, knows[Question::in_side]);
      int turn_left = quick_turn_sign(from_left, left_at, right_at, knows[Question::turn_left]);
      int turn_right = quick_turn_sign(from_right, left_at, right_at, knows[Question::turn_right]);
      const auto tells = [&](int which, int& sign, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
        return question.tells(which, knows[which], sign, a, b, c, d);
      };
      if (left == back) turn_left = 0, knows[Question::turn_left] = true;
      if (right == base_) turn_right = 0, knows[Question::turn_right] = true;
      if (!tells(Question::turn_left, turn_left, on_left.to, left_, right_, 0) ||
          !tells(Question::turn_right, turn_right, on_right.to, left_, right_, 0))
        return false;
      const bool has_left = turn_left > 0, has_right = turn_right > 0;
      const bool may_drop_left = has_left && on_left.next != back,
                 may_drop_right = has_right && on_right.before != base_;
      if ((may_drop_left && !tells(Question::in_left, in_left, left_, right_, on_left.to, behind_left)) ||
          (may_drop_right && !tells(Question::in_right, in_right, left_, right_, on_right.to, behind_right)))
        return false;
      const bool drops_left = may_drop_left && in_left > 0, drops_right = may_drop_right && in_right > 0;
      if (drops_left || drops_right) {
        if (drops_left) remove(left, on_left, left_twin), next_left_ = on_left.next;
        if (drops_right) remove(right, on_right, right_twin), next_right_ = on_right.before;
        question.answered = 0;
        continue;
      }
      if (!has_left && !has_right) return true;
      if (has_left && has_right && !tells(Question::in_side, in_side, on_left.to, left_, right_, on_right.to))
        return false;
      question.answered = 0;
      const bool is_right = !has_left || (has_right && in_side > 0);
      const std::int32_t before = base_;
      (is_right ? right_ : left_) = is_right ? on_right.to : on_left.to;
      base_ = make(right_, left_);
      put(base_, is_right ? right_twin.before : right, is_right ? MergedMesh::twin(right) : before);
      put(MergedMesh::twin(base_), is_right ? back : MergedMesh::twin(left), is_right ? left : left_twin.next);
      (is_right ? next_right_ : next_left_) = is_right ? right_twin.before : left_twin.next;
    }
  }

  SADDLEBACK_HOST_DEVICE std::int32_t make(std::int32_t from, std::int32_t to) {
    const std::int32_t half = 2 * free_;
    free_ = mesh_.halves[half].to;
    mesh_.halves[half] = {to, 0, 0, 1, 0};
    mesh_.halves[half + 1] = {from, 0, 0, 1, 0};
    return half;
  }
  SADDLEBACK_HOST_DEVICE void put(std::int32_t half, std::int32_t before, std::int32_t next) {
    HalfEdge* const halves = mesh_.halves;
    halves[half].before = before;
    halves[half].next = next;
    halves[before].next = half;
    halves[next].before = half;
  }

  SADDLEBACK_HOST_DEVICE void remove(std::int32_t half, const HalfEdge& it, const HalfEdge& twin) {
    HalfEdge* const halves = mesh_.halves;
    halves[it.next].before = it.before;
    halves[it.before].next = it.next;
    halves[twin.next].before = twin.before;
    halves[twin.before].next = twin.next;
    const std::int32_t edge = half / 2;
    halves[2 * edge] = {free_, 0, 0, 0, 0};
    halves[2 * edge + 1].is_used = 0;
    if (free_ < 0) last_free_ = edge;
    free_ = edge;
  }

  const MergedMesh& mesh_;
  std::int32_t left_ = 0, right_ = 0;                       ///< sites of the base
  std::int32_t base_ = 0, next_left_ = 0, next_right_ = 0;  ///< the base, and the next edge on either side
  std::int32_t free_ = -1, last_free_ = -1;
  int steps_ = 0;
  bool fails_ = false;
};

}  // namespace
}  // namespace saddleback::voronoi2d
