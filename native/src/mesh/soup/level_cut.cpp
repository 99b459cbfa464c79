#include <algorithm>
#include <bit>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "mesh/tables/corner_table.h"

namespace saddleback {
namespace {

// So that rounding makes no needle triangles.
constexpr double k_snap = 1e-9;

/// Triangles on their way to being cut.
class Cutter {
 public:
  Cutter(std::span<const double> fields, Index width, Index column, double level)
      : width_(width),
        column_(column),
        level_(level),
        count_(static_cast<Index>(fields.size() / width)),
        last_cut_(std::bit_ceil(static_cast<std::size_t>(count_) + 1), k_none) {
    out_.fields.reserve(fields.size() + fields.size() / 4);
    out_.fields.assign(fields.begin(), fields.end());
    double greatest = std::abs(level);
    for (Index v = 0; v < count_; ++v)
      if (const double value = std::abs(at(v)); std::isfinite(value)) greatest = std::max(greatest, value);
    const double snap = k_snap * greatest;
    signs_.resize(count_);
    for (Index v = 0; v < count_; ++v) {
      const double offset = at(v) - level;
      signs_[v] = std::abs(offset) <= snap ? 0 : offset > 0 ? 1 : -1;
      if (signs_[v] == 0) at(v) = level;
    }
  }

  void expect(std::size_t triangles) {
    out_.triangles.reserve(triangles);
    out_.parents.reserve(triangles);
    out_.aboves.reserve(triangles);
  }

  void add(Index parent, const Triangle& t) {
    const auto [lowest, highest] = std::minmax({signs_[t[0]], signs_[t[1]], signs_[t[2]]});
    if (highest <= 0 || lowest >= 0) return put(parent, t, highest > 0);
    for (int i = 0; i < 3; ++i)
      if (signs_[t[i]] == 0) return cut_through_vertex(parent, {t[i], t[(i + 1) % 3], t[(i + 2) % 3]});
    int lone = 0;
    while (signs_[t[lone]] == signs_[t[(lone + 1) % 3]] || signs_[t[lone]] == signs_[t[(lone + 2) % 3]]) ++lone;
    cut_off(parent, {t[lone], t[(lone + 1) % 3], t[(lone + 2) % 3]});
  }

  LevelCut take() { return std::move(out_); }

 private:
  double& at(Index vertex) { return out_.fields[static_cast<std::size_t>(vertex) * width_ + column_]; }

  void put(Index parent, const Triangle& t, bool above) {
    out_.triangles.push_back(t);
    out_.parents.push_back(parent);
    out_.aboves.push_back(above);
  }

  /// One without an inside is none: where a value is infinite, an edge may be cut at its other end.
  void put_part(Index parent, const Triangle& t, bool above) {
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) put(parent, t, above);
  }

  void cut_through_vertex(Index parent, const Triangle& t) {
    const Index cut = between(t[1], t[2]);
    put_part(parent, {t[0], t[1], cut}, signs_[t[1]] > 0);
    put_part(parent, {t[0], cut, t[2]}, signs_[t[2]] > 0);
  }

  /// The first corner from the two others; what they keep is parted along its shorter diagonal.
  void cut_off(Index parent, const Triangle& t) {
    const bool lone_above = signs_[t[0]] > 0;
    const Index y = between(t[0], t[1]), z = between(t[0], t[2]);
    put_part(parent, {t[0], y, z}, lone_above);
    const bool is_forced = y == t[0] || z == t[0];  // the other diagonal would run along a side
    if (is_forced ? z == t[0] : squared_distance(y, t[2]) <= squared_distance(t[1], z)) {
      put_part(parent, {y, t[1], t[2]}, !lone_above);
      put_part(parent, {y, t[2], z}, !lone_above);
    } else {
      put_part(parent, {y, t[1], z}, !lone_above);
      put_part(parent, {t[1], t[2], z}, !lone_above);
    }
  }

  double squared_distance(Index a, Index b) const {
    const double *p = row(a), *q = row(b);
    return (Vec3(p[0], p[1], p[2]) - Vec3(q[0], q[1], q[2])).squaredNorm();
  }
  const double* row(Index vertex) const { return out_.fields.data() + static_cast<std::size_t>(vertex) * width_; }

  /// The vertex where an edge crosses the level; the same bits from both sides. On the way to an infinite value the
  /// level is crossed at once, between two of them in the middle.
  Index between(Index a, Index b) {
    if (std::isfinite(at(a)) != std::isfinite(at(b))) return std::isfinite(at(a)) ? a : b;
    if (a > b) std::swap(a, b);
    // Spread by both ends: thousands of edges may share one.
    Index& last =
        last_cut_[(static_cast<std::size_t>(a) + k_spread * static_cast<std::size_t>(b)) & (last_cut_.size() - 1)];
    for (Index i = last; i != k_none; i = cuts_[i].before)
      if (cuts_[i].from == a && cuts_[i].to == b) return count_ + i;
    const Index next = count_ + static_cast<Index>(cuts_.size());
    cuts_.push_back({a, b, last});
    last = next - count_;
    const double share = std::isfinite(at(a)) ? (level_ - at(a)) / (at(b) - at(a)) : 0.5;
    out_.fields.resize(out_.fields.size() + width_);
    const double *from = row(a), *to = row(b);
    double* const mine = out_.fields.data() + static_cast<std::size_t>(next) * width_;
    for (Index i = 0; i < width_; ++i) mine[i] = std::isfinite(from[i]) ? from[i] + share * (to[i] - from[i]) : from[i];
    mine[column_] = level_;
    return next;
  }

  const Index width_, column_;
  const double level_;
  const Index count_;  ///< of the given vertices
  std::vector<std::int8_t> signs_;
  static constexpr std::size_t k_spread = 0x9e3779b1;
  struct Cut {
    Index from, to, before;  ///< the ends of its edge, the smaller one first; an earlier cut in the same place
  };
  std::vector<Cut> cuts_;        ///< one for each new vertex
  std::vector<Index> last_cut_;  ///< by place, which its edge's ends tell
  LevelCut out_;
};

}  // namespace

LevelCut cut_at_level(std::span<const double> fields, Index width, std::span<const Triangle> triangles, Index column,
                      double level) {
  if (width < 4) throw InputError(message("fields: wanted a position and a value for each vertex, got ", width));
  if (column < 3 || column >= width) throw InputError(message("column: wanted 3 to ", width - 1, ", got ", column));
  if (!std::isfinite(level)) throw InputError(message("level: wanted a finite number, got ", level));
  check_corners(triangles, static_cast<Index>(fields.size() / width));
  Cutter cutter(fields, width, column, level);
  cutter.expect(triangles.size() + triangles.size() / 2);
  for (Index t = 0; t < static_cast<Index>(triangles.size()); ++t) cutter.add(t, triangles[t]);
  return cutter.take();
}

}  // namespace saddleback
