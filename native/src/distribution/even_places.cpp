// Many more points than wanted, in the order of a curve that fills the surface: runs of them are compact pieces of
// equal mass. Then each point goes to the piece whose middle is nearest, and middles move to those of their pieces, a
// few times [lloyd1982], which rounds the pieces off. Points count by the density once more on the way: without,
// middles would drift from where it is high.

#include "distribution/even_places.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/sample.h"

namespace saddleback::distribution {
namespace {

constexpr Index k_points_a_place = 24, k_most_points = 2'000'000;
constexpr int k_rounds = 3;

struct Middle {
  Vec3 at, normal;
};

/// Finds the nearest middle on the same side of the surface: a tree that halves them along their longest extent.
class MiddleTree {
 public:
  explicit MiddleTree(std::span<const Middle> middles) : middles_(middles), order_(middles.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    axes_.resize(middles.size());
    build(0, order_.size());
  }

  /// `hint` if nothing is nearer.
  Index nearest(const Vec3& point, const Vec3& normal, Index hint) const {
    Search search{point, normal, hint, (middles_[hint].at - point).squaredNorm()};
    descend(0, order_.size(), search);
    return search.best;
  }

 private:
  struct Search {
    Vec3 point, normal;
    Index best;
    double square;
  };

  void build(std::size_t begin, std::size_t end) {
    if (end - begin < 2) return;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (std::size_t i = begin; i < end; ++i) {
      low = low.cwiseMin(middles_[order_[i]].at);
      high = high.cwiseMax(middles_[order_[i]].at);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                     order_.begin() + static_cast<std::ptrdiff_t>(half),
                     order_.begin() + static_cast<std::ptrdiff_t>(end), [&](Index a, Index b) {
                       const double at = middles_[a].at[axis], bt = middles_[b].at[axis];
                       return at != bt ? at < bt : a < b;
                     });
    axes_[half] = axis;
    build(begin, half);
    build(half + 1, end);
  }

  void descend(std::size_t begin, std::size_t end, Search& search) const {
    if (begin == end) return;
    const std::size_t half = begin + (end - begin) / 2;
    const Middle& middle = middles_[order_[half]];
    const double square = (middle.at - search.point).squaredNorm();
    const bool is_nearer = square < search.square || (square == search.square && order_[half] < search.best);
    if (is_nearer && middle.normal.dot(search.normal) > 0) {
      search.square = square;
      search.best = order_[half];
    }
    if (end - begin == 1) return;
    const double beyond = search.point[axes_[half]] - middle.at[axes_[half]];
    const bool is_low = beyond < 0;
    is_low ? descend(begin, half, search) : descend(half + 1, end, search);
    if (beyond * beyond <= search.square) is_low ? descend(half + 1, end, search) : descend(begin, half, search);
  }

  std::span<const Middle> middles_;
  std::vector<Index> order_;
  std::vector<int> axes_;
};

class Relaxation {
 public:
  Relaxation(const Mesh& mesh, const SurfacePoints& points, Index each, std::span<const double> density)
      : points_(points), pieces_(points.size()) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Triangle& t = mesh.triangles()[points[i].face];
      const Vec3& b = points[i].barycentric;
      const Vec3 &p = mesh.position(t[0]), &q = mesh.position(t[1]), &r = mesh.position(t[2]);
      at_.push_back(b[0] * p + b[1] * q + b[2] * r);
      normals_.push_back((q - p).cross(r - p).normalized());
      weights_.push_back(b[0] * density[t[0]] + b[1] * density[t[1]] + b[2] * density[t[2]]);
      pieces_[i] = static_cast<Index>(i) / each;
    }
    middles_.resize(points.size() / static_cast<std::size_t>(each));
  }

  void find_middles() {
    for (Middle& middle : middles_) middle = {Vec3::Zero(), Vec3::Zero()};
    std::vector<double> masses(middles_.size(), 0.0);
    for (std::size_t i = 0; i < at_.size(); ++i) {
      middles_[pieces_[i]].at += weights_[i] * at_[i];
      middles_[pieces_[i]].normal += weights_[i] * normals_[i];
      masses[pieces_[i]] += weights_[i];
    }
    for (std::size_t k = 0; k < middles_.size(); ++k)
      if (masses[k] > 0) middles_[k].at /= masses[k];
  }

  void share_out() {
    const MiddleTree tree(middles_);
    for (std::size_t i = 0; i < at_.size(); ++i) pieces_[i] = tree.nearest(at_[i], normals_[i], pieces_[i]);
  }

  /// Finds of each piece the point nearest to its middle. A piece that has lost all of its points keeps the first it
  /// had.
  SurfacePoints places(Index each) const {
    std::vector<std::size_t> best(middles_.size());
    std::vector<double> least(middles_.size(), std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < best.size(); ++k) best[k] = k * static_cast<std::size_t>(each);
    for (std::size_t i = 0; i < at_.size(); ++i) {
      const double square = (at_[i] - middles_[pieces_[i]].at).squaredNorm();
      if (square < least[pieces_[i]]) {
        least[pieces_[i]] = square;
        best[pieces_[i]] = i;
      }
    }
    SurfacePoints result;
    for (const std::size_t i : best) result.push_back(points_[i]);
    return result;
  }

 private:
  const SurfacePoints& points_;
  std::vector<Index> pieces_;
  std::vector<Vec3> at_, normals_;
  std::vector<double> weights_;
  std::vector<Middle> middles_;
};

}  // namespace

SurfacePoints even_places(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed) {
  if (count == 0) return {};
  // Where lengths were given, what is near in space may be far: places are even by chance alone.
  const Index each = mesh.is_intrinsic() ? 1 : std::clamp(k_most_points / count, Index{1}, k_points_a_place);
  SurfacePoints points = sample(mesh, count * each, density, seed);
  if (each == 1) return points;
  Relaxation relaxation(mesh, points, each, density);
  relaxation.find_middles();
  for (int round = 0; round < k_rounds; ++round) {
    relaxation.share_out();
    relaxation.find_middles();
  }
  return relaxation.places(each);
}

}  // namespace saddleback::distribution
