#include "tessellation/relaxation/lbfgs.h"

#include <cmath>

namespace saddleback {
namespace {

void add_scaled(TangentField& sum, double factor, const TangentField& field) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * field[i];
}

}  // namespace

TangentField LbfgsMemory::direction(const TangentField& gradient, std::span<const double> stiffness) const {
  TangentField q = gradient;
  std::vector<double> alpha(pairs_.size());
  for (std::size_t k = pairs_.size(); k-- > 0;) {
    alpha[k] = dot(pairs_[k].step, q) / pairs_[k].curvature;
    add_scaled(q, -alpha[k], pairs_[k].change);
  }
  double scale = 1;
  if (!pairs_.empty()) {
    double weighted = 0;  // of the last change, by the inverse of the stiffness
    const Pair& last = pairs_.back();
    for (std::size_t i = 0; i < q.size(); ++i) {
      if (stiffness[i] > 0) weighted += last.change[i].squaredNorm() / stiffness[i];
    }
    if (weighted > 0) scale = last.curvature / weighted;
  }
  for (std::size_t i = 0; i < q.size(); ++i) q[i] *= stiffness[i] > 0 ? scale / stiffness[i] : 0;
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const double beta = dot(pairs_[k].change, q) / pairs_[k].curvature;
    add_scaled(q, alpha[k] - beta, pairs_[k].step);
  }
  for (Vec2& v : q) v = -v;
  return q;
}

void LbfgsMemory::add(const Moved& moved, TangentField gradient_change) {
  for (Pair& pair : pairs_) {
    transport(moved, pair.step);
    transport(moved, pair.change);
  }
  constexpr double k_least_curvature = 1e-10;
  const double curvature = dot(moved.steps, gradient_change);
  const double sizes = std::sqrt(dot(moved.steps, moved.steps) * dot(gradient_change, gradient_change));
  if (!(curvature > k_least_curvature * sizes)) return;
  pairs_.push_back({moved.steps, std::move(gradient_change), curvature});
  if (pairs_.size() > k_pairs) pairs_.pop_front();
}

}  // namespace saddleback
