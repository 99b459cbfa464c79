// Faces that one cell owns whole are summed about their vertices: what a vertex weighs does not change. Shared faces
// are cut, and about the vertices beside them the whole ones are summed one by one.

#include "tessellation/cells/cell_moments.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "support/threads/parallel.h"
#include "tessellation/cells/quadrature.h"

namespace saddleback {
namespace {

using Face = CellIntegrals::Face;

// How many nodes ahead those of a cell are fetched from memory: by distance they follow in no order of memory.
constexpr std::size_t k_ahead = 8;

/// A face that cells share, for integrals over its parts.
struct FaceShape {
  const Face& face;
  Vec3 squared_edges, density;
  bool uniform;

  FaceShape(const Face& the_face, const std::array<double, 3>* densities)
      : face(the_face), squared_edges(the_face.squared_edges.data()), density(Vec3::Ones()), uniform(!densities) {
    if (densities) density = Vec3(densities->data());
  }
  /// The amount by which the squared distance to a point of the plane is below the interpolation of its values at the
  /// corners.
  double bulge(const Vec3& x) const {
    return x[1] * x[2] * squared_edges[0] + x[2] * x[0] * squared_edges[1] + x[0] * x[1] * squared_edges[2];
  }
  double weight(const Vec3& x) const {
    const double value = density.dot(x);
    return value * value;
  }
};

Vec3 squared_distances(const CellCandidate& candidate) {
  return {candidate.squared_distance(0), candidate.squared_distance(1), candidate.squared_distance(2)};
}

struct CandidateFace {
  const FaceShape& shape;
  const CellCandidate& candidate;
  const Vec3& squared_distance;
};

template <std::size_t Count>
void integrate(const CandidateFace& face, const std::array<QuadraturePoint, Count>& rule, double area, const Vec3& a,
               const Vec3& b, const Vec3& c, CellMoments& sum) {
  for (const QuadraturePoint& q : rule) {
    const Vec3 x = at(q, a, b, c);
    const double weight = area * q.weight * face.shape.weight(x);
    sum.mass += weight;
    sum.moment +=
        weight * (x[0] * face.candidate.corner[0] + x[1] * face.candidate.corner[1] + x[2] * face.candidate.corner[2]);
    sum.energy += weight * (face.squared_distance.dot(x) - face.shape.bulge(x));
  }
}

/// Adds the integrals over the triangle a, b, c (barycentric coordinates in the face).
void add_triangle(const CandidateFace& face, const Vec3& a, const Vec3& b, const Vec3& c, CellMoments& sum) {
  const double area = face.shape.face.area * a.dot(b.cross(c));
  sum.area += area;
  if (face.shape.uniform) {
    integrate(face, k_quadratic, area, a, b, c, sum);
  } else {
    integrate(face, k_quartic, area, a, b, c, sum);
  }
}

void add_whole(const CandidateFace& face, CellMoments& sum) {
  const Face& whole = face.shape.face;
  for (int i = 0; i < 3; ++i) {
    sum.mass += whole.weight[i];
    sum.moment += whole.weight[i] * face.candidate.corner[i];
    sum.energy += whole.weight[i] * face.squared_distance[i];
  }
  sum.energy -= whole.bulge;
  sum.area += whole.area;
}

/// The places where a straight cut parts one corner from the others.
struct Cut {
  int lone, left, right;
  double on_left, on_right;  ///< as shares of the sides from the lone corner
  Vec3 left_end() const { return (1 - on_left) * Vec3::Unit(lone) + on_left * Vec3::Unit(left); }
  Vec3 right_end() const { return (1 - on_right) * Vec3::Unit(lone) + on_right * Vec3::Unit(right); }
};

/// Bit i: whether the number is above 0.
unsigned positive(const Vec3& v) {
  return static_cast<unsigned>(v[0] > 0) | static_cast<unsigned>(v[1] > 0) << 1 | static_cast<unsigned>(v[2] > 0) << 2;
}

/// `lead`: above 0 where the second of two candidates is nearer; not so at all corners, nor at none.
Cut cut_where_zero(const Vec3& lead) {
  constexpr std::array<int, 8> k_lone{-1, 0, 1, 2, 2, 1, 0, -1};  // which corner it is cannot be foretold
  const int lone = k_lone[positive(lead)], left = (lone + 1) % 3, right = (lone + 2) % 3;
  return {lone, left, right, lead[lone] / (lead[lone] - lead[left]), lead[lone] / (lead[lone] - lead[right])};
}

/// The triangle that a cut leaves with the lone corner, for a uniform density: integrals of the position from its
/// corners' mean, of the squared distance from its corners and sides.
class Tip {
 public:
  Tip(const FaceShape& shape, const Cut& cut) : cut_(cut), area_(shape.face.area * cut.on_left * cut.on_right) {
    const double l = cut.on_left, r = cut.on_right;
    const double left_side = shape.squared_edges[cut.right], right_side = shape.squared_edges[cut.left];
    const double twice_dot = left_side + right_side - shape.squared_edges[cut.lone];
    const double sides = 2 * (l * l * left_side + r * r * right_side) - l * r * twice_dot;
    bulge_ = (l * (1 - l) * left_side + r * (1 - r) * right_side) / 3 + sides / 12;
  }
  double area() const { return area_; }
  CellMoments moments(const CandidateFace& face) const {
    Vec3 share;  // of each corner of the face in the tip's mean
    share[cut_.lone] = (3 - cut_.on_left - cut_.on_right) / 3;
    share[cut_.left] = cut_.on_left / 3;
    share[cut_.right] = cut_.on_right / 3;
    const auto& corner = face.candidate.corner;
    const Vec2 mean = share[0] * corner[0] + share[1] * corner[1] + share[2] * corner[2];
    return {area_, area_, area_ * mean, area_ * (share.dot(face.squared_distance) - bulge_)};
  }

 private:
  const Cut& cut_;
  double area_, bulge_;
};

/// The moments of the shared faces' parts.
class SharedFace {
 public:
  /// Calls add(site, moments) for every part.
  template <class Add>
  void integrate(const FaceShape& shape, std::span<const CellCandidate> candidates, Add&& add);

 private:
  struct Corner {
    Vec3 at;
    double lead;
  };
  template <class Add>
  static void integrate_two(const FaceShape& shape, const CellCandidate& a, const CellCandidate& b, Add&& add);
  template <class Add>
  static void cut_in_two(const CandidateFace& first, const CandidateFace& second, Add&& add);
  bool is_beaten(std::span<const CellCandidate> candidates, std::size_t candidate) const;
  CellMoments part_of(const FaceShape& shape, std::span<const CellCandidate> candidates, Index at);
  void clip(const Vec3& lead);
  bool may_cut(const Vec3& lead) const;

  std::vector<Vec3> squared_distances_;  ///< of all candidates
  std::vector<Index> rivals_;            ///< candidates that are nearest somewhere, as far as corners tell
  std::vector<Corner> polygon_, clipped_;
  Vec3 least_, most_;  ///< coordinates of the polygon's corners
};

/// Tells whether a candidate is nowhere nearer than one of the others.
bool SharedFace::is_beaten(std::span<const CellCandidate> candidates, std::size_t candidate) const {
  const Vec3& own = squared_distances_[candidate];
  for (std::size_t other = 0; other < candidates.size(); ++other) {
    const Vec3& theirs = squared_distances_[other];
    if (other == candidate || own[0] < theirs[0] || own[1] < theirs[1] || own[2] < theirs[2]) continue;
    const bool ties = own[0] == theirs[0] && own[1] == theirs[1] && own[2] == theirs[2];
    if (!ties || candidates[other].site < candidates[candidate].site) return true;
  }
  return false;
}

CellMoments& operator+=(CellMoments& sum, const CellMoments& part) {
  sum.area += part.area;
  sum.mass += part.mass;
  sum.moment += part.moment;
  sum.energy += part.energy;
  return sum;
}

CellMoments& operator-=(CellMoments& sum, const CellMoments& part) {
  sum.area -= part.area;
  sum.mass -= part.mass;
  sum.moment -= part.moment;
  sum.energy -= part.energy;
  return sum;
}

template <class Add>
void SharedFace::integrate(const FaceShape& shape, std::span<const CellCandidate> candidates, Add&& add) {
  if (candidates.size() == 2) return integrate_two(shape, candidates[0], candidates[1], add);
  squared_distances_.clear();
  for (const CellCandidate& candidate : candidates) squared_distances_.push_back(squared_distances(candidate));
  rivals_.clear();
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (!is_beaten(candidates, i)) rivals_.push_back(static_cast<Index>(i));
  if (rivals_.size() == 1) {
    CellMoments all;
    add_whole({shape, candidates[rivals_.front()], squared_distances_[rivals_.front()]}, all);
    add(candidates[rivals_.front()].site, all);
  } else if (rivals_.size() == 2) {
    const Index a = rivals_[0], b = rivals_[1];
    cut_in_two({shape, candidates[a], squared_distances_[a]}, {shape, candidates[b], squared_distances_[b]}, add);
  } else {
    for (Index at = 0; at < std::ssize(rivals_); ++at)
      add(candidates[rivals_[at]].site, part_of(shape, candidates, at));
  }
}

/// Most faces have two candidates, by site: of ties the first has all.
template <class Add>
void SharedFace::integrate_two(const FaceShape& shape, const CellCandidate& a, const CellCandidate& b, Add&& add) {
  const Vec3 of_a = squared_distances(a), of_b = squared_distances(b);
  const bool has_a = positive(of_b - of_a) != 0, has_b = positive(of_a - of_b) != 0;
  const CandidateFace first{shape, a, of_a}, second{shape, b, of_b};
  if (has_a && has_b) return cut_in_two(first, second, add);
  CellMoments all;
  add_whole(has_b ? second : first, all);
  add(has_b ? b.site : a.site, all);
}

/// One straight cut: a corner on one side of it, two on the other.
template <class Add>
void SharedFace::cut_in_two(const CandidateFace& first, const CandidateFace& second, Add&& add) {
  constexpr double k_most_of_it = 0.9;  // what is left is too little to be told from a difference
  const FaceShape& shape = first.shape;
  const Vec3 lead = first.squared_distance - second.squared_distance;
  const Cut cut = cut_where_zero(lead);
  const bool second_is_lone = lead[cut.lone] > 0;
  const CandidateFace &lone = second_is_lone ? second : first, &rest = second_is_lone ? first : second;
  CellMoments of_lone, of_rest;
  if (shape.uniform && cut.on_left * cut.on_right < k_most_of_it) {
    const Tip tip(shape, cut);
    of_lone = tip.moments(lone);
    add_whole(rest, of_rest);
    of_rest -= tip.moments(rest);
  } else {
    const Vec3 on_left = cut.left_end(), on_right = cut.right_end();
    add_triangle(lone, Vec3::Unit(cut.lone), on_left, on_right, of_lone);
    add_triangle(rest, on_left, Vec3::Unit(cut.left), Vec3::Unit(cut.right), of_rest);
    add_triangle(rest, on_left, Vec3::Unit(cut.right), on_right, of_rest);
  }
  add(lone.candidate.site, of_lone);
  add(rest.candidate.site, of_rest);
}

/// The part that the other rivals leave of the face. Of many those come first whose numbers are next to its own: sites
/// are numbered so that these are near, as a rule, and make it small enough for the others to be passed over.
CellMoments SharedFace::part_of(const FaceShape& shape, std::span<const CellCandidate> candidates, Index at) {
  constexpr Index k_few = 64;
  const Index rival = rivals_[at];
  const CandidateFace face{shape, candidates[rival], squared_distances_[rival]};
  polygon_.resize(3);
  for (int i = 0; i < 3; ++i) polygon_[i].at = Vec3::Unit(i);
  least_.setZero();
  most_.setOnes();
  const auto clip_by = [&](Index other) {
    const Vec3 lead = squared_distances_[other] - face.squared_distance;
    if (may_cut(lead)) clip(lead);
  };
  const auto count = static_cast<Index>(rivals_.size());
  if (count <= k_few) {
    for (Index other = 0; other < count; ++other)
      if (other != at) clip_by(rivals_[other]);
  }
  for (Index step = 1; step < count && count > k_few; ++step) {
    if (at >= step) clip_by(rivals_[at - step]);
    if (at + step < count) clip_by(rivals_[at + step]);
  }
  CellMoments sum;
  for (std::size_t i = 1; i + 1 < polygon_.size(); ++i)
    add_triangle(face, polygon_[0].at, polygon_[i].at, polygon_[i + 1].at, sum);
  return sum;
}

/// Tells whether another candidate may lead somewhere in the box about the polygon. Of the many rivals on a large face
/// few do, once some have made the polygon small.
bool SharedFace::may_cut(const Vec3& lead) const {
  const double slope_1 = lead[1] - lead[0], slope_2 = lead[2] - lead[0];
  return lead[0] + slope_1 * (slope_1 > 0 ? least_ : most_)[1] + slope_2 * (slope_2 > 0 ? least_ : most_)[2] <= 0;
}

/// Leaves of the polygon where another candidate does not lead.
void SharedFace::clip(const Vec3& lead) {
  for (Corner& corner : polygon_) corner.lead = lead.dot(corner.at);
  clipped_.clear();
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    const Corner &from = polygon_[i], &to = polygon_[i + 1 < polygon_.size() ? i + 1 : 0];
    if (from.lead >= 0) clipped_.push_back(from);
    if ((from.lead >= 0) == (to.lead >= 0)) continue;
    clipped_.push_back({from.at + from.lead / (from.lead - to.lead) * (to.at - from.at), 0});
  }
  polygon_.swap(clipped_);
  if (polygon_.empty()) return;
  least_ = most_ = polygon_.front().at;
  for (const Corner& corner : polygon_) {
    least_ = least_.cwiseMin(corner.at);
    most_ = most_.cwiseMax(corner.at);
  }
}

/// The sums of a stretch of shared faces, of the few cells that are met there.
class StretchSums {
 public:
  using Entry = std::pair<Index, CellMoments>;
  void begin(Index site_count) {
    known_.resize(site_count, {0, 0});
    ++round_;
    entries_.clear();
  }
  void add(Index site, const CellMoments& part) {
    auto& [round, at] = known_[site];
    if (round != round_) {
      round = round_;
      at = static_cast<Index>(entries_.size());
      entries_.push_back({site, {}});
    }
    entries_[at].second += part;
  }
  const std::vector<Entry>& entries() const { return entries_; }

 private:
  std::uint32_t round_ = 0;
  std::vector<std::pair<std::uint32_t, Index>> known_;  ///< by site
  std::vector<Entry> entries_;
};

}  // namespace

CellIntegrals::CellIntegrals(const SaddleVertexGraph& graph, const VertexRings& rings, std::span<const double> density,
                             int threads)
    : rings_(rings),
      threads_(threads),
      faces_(rings.face_count()),
      density_(density.empty() ? 0 : rings.face_count()),
      nodes_(graph.mesh().vertex_count()) {
  const Mesh& mesh = graph.mesh();
  parallel_for(rings.face_count(), threads, 4096, [&](Index face, int) {
    Face& sum = faces_[face];
    const Index in_mesh = rings.face(face).in_mesh;
    sum = {.squared_edges = {}, .weight = {}, .bulge = 0, .area = mesh.face_area(in_mesh)};
    for (int i = 0; i < 3; ++i) {
      const double opposite = mesh.length(Mesh::next(3 * in_mesh + i));
      sum.squared_edges[i] = opposite * opposite;
      if (!density.empty()) density_[face][i] = density[mesh.triangles()[in_mesh][i]];
    }
    const FaceShape shape(sum, density.empty() ? nullptr : &density_[face]);
    for (const QuadraturePoint& q : k_quartic) {
      const Vec3 x = at(q, Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2));
      const double weight = sum.area * q.weight * shape.weight(x);
      for (int i = 0; i < 3; ++i) sum.weight[i] += weight * x[i];
      sum.bulge += weight * shape.bulge(x);
    }
  });
  parallel_for(static_cast<Index>(nodes_.size()), threads, 4096, [&](Index node, int) {
    for (const VertexRings::Wedge& wedge : rings.around(node)) {
      const Face& face = faces_[wedge.side / 3];
      nodes_[node].weight += face.weight[Mesh::prev(wedge.side) % 3];
      nodes_[node].bulge += face.bulge / 3;
      nodes_[node].area += face.area / 3;
    }
  });
}

/// Asks memory for what the first nodes of a cell need.
void CellIntegrals::fetch_cell(const CellCandidates& candidates, Index site) const {
  const std::span<const Index> own = candidates.labels().nodes(site);
  for (const Index node : own.first(std::min(own.size(), k_ahead))) {
    candidates.maps().fetch(node);
    __builtin_prefetch(&nodes_[node]);
  }
}

/// All faces about those of a cell's own vertices that are not at its border.
CellMoments CellIntegrals::within(const CellCandidates& candidates, Index site) const {
  CellMoments sum;
  const std::span<const Index> own = candidates.labels().nodes(site);
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (i + k_ahead < own.size()) {
      __builtin_prefetch(&nodes_[own[i + k_ahead]]);
      candidates.maps().fetch(own[i + k_ahead]);
    }
    const Index node = own[i];
    if (!candidates.rows().is_at_border(node)) add_about(nodes_[node], candidates.maps().own(node), sum);
  }
  return sum;
}

/// A face that one cell owns whole: the parts about those of its corners that are at the cell's border.
bool CellIntegrals::add_at_border(const CellCandidates& candidates, Index face, CellMoments& sum) const {
  bool any = false;
  for (int i = 0; i < 3; ++i) {
    const Index node = rings_.face(face).nodes[i];
    if (!candidates.rows().is_at_border(node)) continue;
    any = true;
    const Face& whole = faces_[face];
    add_about({whole.weight[i], whole.bulge / 3, whole.area / 3}, candidates.maps().own(node), sum);
  }
  return any;
}

void CellIntegrals::add_about(const Node& about, const SiteVector& seen, CellMoments& sum) {
  sum.mass += about.weight;
  sum.moment += about.weight * seen.log;
  sum.energy += about.weight * seen.distance * seen.distance - about.bulge;
  sum.area += about.area;
}

std::vector<CellMoments> CellIntegrals::moments(const CellCandidates& candidates, std::vector<CellMoments> before,
                                                const JobStage& stage) {
  const bool has_none = before.empty();
  const auto keeps = [&](Index site) { return !has_none && candidates.is_as_before(site); };
  std::vector<CellMoments> cells = std::move(before);
  cells.resize(candidates.labels().site_count());
  parallel_for(candidates.labels().site_count(), threads_, 16, [&](Index i, int) {
    stage.check();
    const Index site = candidates.labels().sites_along_curve()[i];
    if (i + 1 < candidates.labels().site_count())
      fetch_cell(candidates, candidates.labels().sites_along_curve()[i + 1]);
    if (!keeps(site)) cells[site] = within(candidates, site);
  });
  // By stretches of faces that are always the same: sums depend neither on the number of threads nor on other cells.
  constexpr Index k_stretch = 4096;
  const Index stretches = (rings_.face_count() + k_stretch - 1) / k_stretch;
  struct alignas(k_apart) Worker {
    SharedFace face;
    StretchSums sums;
  };
  std::vector<Worker> workers(thread_count(threads_));
  std::vector<std::vector<StretchSums::Entry>> sums(stretches);
  parallel_for(stretches, threads_, 1, [&](Index stretch, int thread) {
    stage.check();
    auto& [shared_face, stretch_sums] = workers[thread];
    stretch_sums.begin(candidates.labels().site_count());
    const auto integrate = [&](Index first, Index last) {
      for (Index shared = first; shared < last; ++shared) {
        const auto rivals = candidates.rows().candidates(shared);
        if (std::ranges::all_of(rivals, [&](const CellCandidate& candidate) { return keeps(candidate.site); }))
          continue;
        const Index face = candidates.rows().face(shared);
        const FaceShape shape(faces_[face], density_.empty() ? nullptr : &density_[face]);
        shared_face.integrate(shape, rivals,
                              [&](Index site, const CellMoments& part) { stretch_sums.add(site, part); });
      }
    };
    const Index first = stretch * k_stretch, last = std::min(rings_.face_count(), first + k_stretch);
    for (Index face = first; face < last; ++face) {
      if (candidates.rows().shared_index(face) != k_none) continue;
      const Index site = candidates.labels().label(rings_.face(face).nodes[0]);
      CellMoments part;
      if (!keeps(site) && add_at_border(candidates, face, part)) stretch_sums.add(site, part);
    }
    const CandidateRows::Stretch shared = candidates.rows().within(first, last);
    integrate(shared.first, shared.last);
    integrate(shared.first_late, shared.last_late);
    sums[stretch] = stretch_sums.entries();
  });
  for (const auto& entries : sums) {
    for (const auto& [site, part] : entries)
      if (!keeps(site)) cells[site] += part;
  }
  return cells;
}

}  // namespace saddleback
