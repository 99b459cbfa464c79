// Finds which way closed bodies face, by which lie within which. Boxes only choose what to try; whether a body lies
// within another is found by the other's winding number at one of its corners [vanoosterom1983].

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "mesh/repair/repair_steps.h"

namespace saddleback {
namespace {

struct Body {
  Eigen::AlignedBox3d box;
  Index begin = 0, end = 0;  ///< faces, as places in the order by body
  double volume = 0, area = 0;
  bool closed = true, mixed = false;  ///< mixed: its faces came with both orientations

  /// A flat body has no inside: rounding must not decide.
  bool is_solid() const {
    constexpr double k_hollow = 1e-9;
    return closed && std::abs(volume) > k_hollow * area * box.diagonal().norm();
  }
  double size() const { return box.diagonal().squaredNorm(); }
};

class Nesting {
 public:
  Nesting(const RepairState& state, Sheets& sheets, const std::vector<Index>& labels, Index label_count)
      : state_(state), sheets_(sheets), bodies_(label_count) {
    gather(labels);
  }

  /// Turns bodies over until the outermost face outward. What lies within a body keeps its side of it (both walls of a
  /// hollow ball are turned together); a wall that faces inward stays so only directly within one that faces outward.
  void turn_outward(const JobStage& stage) {
    std::vector<Index> solid;
    for (Index b = 0; b < static_cast<Index>(bodies_.size()); ++b)
      if (bodies_[b].is_solid()) solid.push_back(b);
    if (std::none_of(solid.begin(), solid.end(), [&](Index b) { return bodies_[b].volume < 0; })) return;
    const std::vector<std::vector<Index>> around = boxes_around(solid, stage);
    std::stable_sort(solid.begin(), solid.end(),
                     [&](Index a, Index b) { return bodies_[a].size() > bodies_[b].size(); });
    std::vector<std::uint8_t> turned(bodies_.size(), 0);
    for (const Index b : solid) {  // the containing ones come first
      const auto matters = [&](Index outer) { return turned[outer] != 0; };
      if (bodies_[b].volume > 0 && std::none_of(around[b].begin(), around[b].end(), matters)) continue;
      const Index parent = innermost_around(b, around[b], stage);
      if (parent != k_none && !bodies_[b].mixed) turned[b] = turned[parent];
      const bool inward = (bodies_[b].volume < 0) != (turned[b] != 0);
      const bool wall_of_cavity =
          parent != k_none && !bodies_[b].mixed && (bodies_[parent].volume > 0) != (turned[parent] != 0);
      if (inward && !wall_of_cavity) turned[b] ^= 1;
    }
    for (const Index b : solid)
      for (Index i = bodies_[b].begin; turned[b] && i < bodies_[b].end; ++i) sheets_.turned[order_[i]] ^= 1;
  }

 private:
  void gather(const std::vector<Index>& labels) {
    std::vector<Index> begins(bodies_.size() + 1, 0);
    for (const Index label : labels) ++begins[label + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    for (std::size_t b = 0; b < bodies_.size(); ++b) bodies_[b].begin = bodies_[b].end = begins[b];
    order_.resize(labels.size());
    for (Index i = 0; i < static_cast<Index>(labels.size()); ++i) {
      Body& body = bodies_[labels[i]];
      order_[body.end++] = i;
      const Vec3 origin = place(order_[body.begin], 0);
      const Vec3 p = place(i, 0) - origin, q = place(i, 1) - origin, r = place(i, 2) - origin;
      body.volume += (sheets_.turned[i] ? -1 : 1) * p.dot(q.cross(r));
      body.area += (q - p).cross(r - p).norm();
      body.mixed = body.mixed || sheets_.turned[i] != sheets_.turned[order_[body.begin]];
      for (int k = 0; k < 3; ++k) {
        body.box.extend(place(i, k));
        body.closed = body.closed && sheets_.twins[3 * i + k] != k_none;
      }
    }
  }

  const Vec3& place(Index face, int corner) const { return state_.positions[sheets_.coarse[face][corner]]; }

  // For each body those whose boxes contain its own, found by a sweep along x.
  std::vector<std::vector<Index>> boxes_around(std::vector<Index> solid, const JobStage& stage) const {
    std::sort(solid.begin(), solid.end(), [&](Index a, Index b) {
      const double x = bodies_[a].box.min()[0], y = bodies_[b].box.min()[0];
      return x != y ? x < y : bodies_[a].size() > bodies_[b].size();
    });
    std::vector<std::vector<Index>> around(bodies_.size());
    std::vector<Index> open;
    for (const Index b : solid) {
      stage.check();
      std::erase_if(open, [&](Index a) { return bodies_[a].box.max()[0] < bodies_[b].box.min()[0]; });
      for (const Index a : open)
        if (bodies_[a].box.contains(bodies_[b].box)) around[b].push_back(a);
      open.push_back(b);
    }
    return around;
  }

  Index innermost_around(Index body, std::vector<Index> candidates, const JobStage& stage) const {
    std::stable_sort(candidates.begin(), candidates.end(),
                     [&](Index a, Index b) { return bodies_[a].size() < bodies_[b].size(); });
    for (const Index candidate : candidates) {
      stage.check();
      if (contains(bodies_[candidate], bodies_[body])) return candidate;
    }
    return k_none;
  }

  // By the corner of the inner one, of a few, at which the winding number is clearest: bodies may touch.
  bool contains(const Body& outer, const Body& inner) const {
    constexpr int k_corners = 3;
    double clearest = 0.5;
    const Index faces = inner.end - inner.begin;
    for (int i = 0; i < k_corners; ++i) {
      const Index face = order_[inner.begin + static_cast<Index>(std::int64_t{faces - 1} * i / (k_corners - 1))];
      const double winding = std::abs(winding_number(outer, place(face, i)));
      if (std::abs(winding - 0.5) > std::abs(clearest - 0.5)) clearest = winding;
    }
    return clearest > 0.5;
  }

  double winding_number(const Body& body, const Vec3& point) const {
    double sum = 0;
    for (Index i = body.begin; i < body.end; ++i) {
      const Index face = order_[i];
      const Vec3 a = place(face, 0) - point, b = place(face, 1) - point, c = place(face, 2) - point;
      const double x = a.norm(), y = b.norm(), z = c.norm();
      const double angle = std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
      sum += sheets_.turned[face] ? -angle : angle;
    }
    return sum / (2 * std::numbers::pi);
  }

  const RepairState& state_;
  Sheets& sheets_;
  std::vector<Body> bodies_;
  std::vector<Index> order_;  ///< faces by body
};

}  // namespace

void turn_outward(const RepairState& state, Sheets& sheets, const std::vector<Index>& labels, Index label_count,
                  const JobStage& stage) {
  Nesting(state, sheets, labels, label_count).turn_outward(stage);
}

}  // namespace saddleback
