#include "tessellation/exact_claims.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Of parts, some for each face and site: a hundred times what usual cells have. Only where rounding decides which site
// is nearer would there be more, wherever it does.
constexpr std::size_t k_some_parts = 1 << 17, k_parts_each = 128;

/// Whether another claim is nearer at all corners: then it is in the whole part.
bool is_beaten(const FaceClaim& claim, const std::vector<FaceClaim>& claims) {
  return std::ranges::any_of(claims, [&](const FaceClaim& other) {
    for (int i = 0; i < 3; ++i)
      if (!(other.squared_distance[i] < claim.squared_distance[i])) return false;
    return true;
  });
}

const ExactField::Sight* find_sight(const std::vector<ExactField::Sight>& sights, Index source) {
  const auto found = std::ranges::lower_bound(sights, source, {}, &ExactField::Sight::source);
  return found != sights.end() && found->source == source ? &*found : nullptr;
}

/// What the squared distances at the corners say in between, as for a point in the plane.
double distance_at(const FaceRefinement::Part& part, const FaceClaim& claim, const Vec3& x) {
  double squared = 0;
  for (int i = 0; i < 3; ++i)
    squared += x[i] * claim.squared_distance[i] - x[i] * x[(i + 1) % 3] * part.length[i] * part.length[i];
  return std::sqrt(std::max(0.0, squared));
}

}  // namespace

ExactParts::ExactParts(const ExactField& field, const std::vector<Index>& sites, double tolerance,
                       const JobStage& stage)
    : field_(field), sites_(sites), tolerance_(tolerance), refinement_(field.mesh()) {
  look_at_mesh_vertices(stage.part(0, 0.3));
  const Index faces = field.mesh().face_count();
  const std::size_t most = k_some_parts + k_parts_each * (faces + sites.size());
  std::vector<Index> pending, changed;
  for (Index face = 0; face < faces; ++face) {
    if (face % 256 == 0) stage.update(0.3 + 0.7 * face / faces);
    pending.push_back(face);
    while (!pending.empty()) {
      stage.check();
      const Index part = pending.back();
      pending.pop_back();
      if (refinement_.parts().size() >= most || is_right(refinement_.parts()[part])) continue;
      changed.clear();
      refinement_.halve(part, changed);
      look_at_added();
      pending.insert(pending.end(), changed.begin(), changed.end());
    }
  }
  order_.resize(refinement_.parts().size());
  std::iota(order_.begin(), order_.end(), 0);
  std::ranges::stable_sort(order_, {}, [&](Index part) { return refinement_.parts()[part].face; });
}

void ExactParts::find_sights(const SurfacePoint& place, Sights& sights) const {
  field_.sights_at(place, sights);
  for (ExactField::Sight& sight : sights) sight.source = sites_[sight.source];
}

void ExactParts::add_sights(const SurfacePoint& place, Sights& sights) const {
  Sights found;
  find_sights(place, found);
  if (sights.empty()) return sights.swap(found);
  for (const ExactField::Sight& sight : found) {
    const auto known = std::ranges::lower_bound(sights, sight.source, {}, &ExactField::Sight::source);
    if (known == sights.end() || known->source != sight.source)
      sights.insert(known, sight);
    else
      known->distance = std::min(known->distance, sight.distance);
  }
}

void ExactParts::set_nearest(Index vertex) {
  nearest_[vertex] = {k_none, k_infinity};
  for (const ExactField::Sight& sight : sights_[vertex])
    if (sight.distance < nearest_[vertex].distance) nearest_[vertex] = sight;
}

void ExactParts::look_at_mesh_vertices(const JobStage& stage) {
  const Mesh& mesh = field_.mesh();
  sights_.resize(mesh.vertex_count());
  nearest_.resize(mesh.vertex_count());
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (face % 256 == 0) stage.update(static_cast<double>(face) / mesh.face_count());
    for (int i = 0; i < 3; ++i) add_sights({face, Vec3::Unit(i)}, sights_[mesh.triangles()[face][i]]);
  }
  for (Index vertex = 0; vertex < mesh.vertex_count(); ++vertex) set_nearest(vertex);
}

void ExactParts::look_at_added() {
  for (auto vertex = static_cast<Index>(sights_.size()); vertex < refinement_.vertex_count(); ++vertex) {
    const FaceRefinement::Added& added = refinement_.added()[vertex - field_.mesh().vertex_count()];
    Sights& sights = sights_.emplace_back();
    for (int i = 0; i < added.faces; ++i) add_sights(added.at[i], sights);
    nearest_.emplace_back();
    set_nearest(vertex);
  }
}

/// A distance changes by no more than the way between two points: a site that is far behind at a corner owns nothing.
void ExactParts::find_claims(const FaceRefinement::Part& part, std::vector<FaceClaim>& claims) const {
  claims.clear();
  for (const Index corner : part.corner) {
    for (const ExactField::Sight& sight : sights_[corner]) {
      if (std::ranges::find(claims, sight.source, &FaceClaim::site) != claims.end()) continue;
      FaceClaim claim{part.face, sight.source, {}};
      std::array<double, 3> distance;
      for (int i = 0; i < 3; ++i) {
        const ExactField::Sight* const known = find_sight(sights_[part.corner[i]], sight.source);
        distance[i] = known ? known->distance : k_infinity;
      }
      bool may_own = true, is_nearest = false;  // the latter whatever rounding says of the former
      for (int i = 0; i < 3; ++i) {
        const double to_next = part.length[i], to_last = part.length[(i + 2) % 3];
        const double least = std::min({distance[i], distance[(i + 1) % 3] + to_next, distance[(i + 2) % 3] + to_last});
        const ExactField::Sight& nearest = nearest_[part.corner[i]];
        const double lead = least - nearest.distance;
        may_own = may_own && lead <= 2 * std::max(to_next, to_last);
        // Whatever rounding says of ties, all parts about a vertex agree on whose it is.
        const double of_nearest = nearest.distance * nearest.distance;
        claim.squared_distance[i] =
            nearest.source == claim.site ? of_nearest : std::max(least * least, std::nextafter(of_nearest, k_infinity));
        is_nearest = is_nearest || nearest.source == claim.site;
      }
      if (may_own || is_nearest) claims.push_back(claim);
    }
  }
  std::ranges::sort(claims, {}, &FaceClaim::site);
}

/// Looks at the middles of the edges and of the part, at what the sites' distances are more than the corners say. Among
/// sites that own something there it must be the same: what it is moves no bisector. Others may be behind by less, but
/// by no more than half of what they are farther away.
bool ExactParts::is_right(const FaceRefinement::Part& part) const {
  if (std::ranges::max(part.length) <= tolerance_ / 2) return true;
  std::vector<FaceClaim> claims;
  find_claims(part, claims);
  if (claims.size() == 1) return true;
  std::vector<std::uint8_t> is_rival;
  for (const FaceClaim& claim : claims) is_rival.push_back(!is_beaten(claim, claims));
  const std::array<Vec3, 4> samples{Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(1, 1, 1) / 3};
  Sights sights;
  for (const Vec3& x : samples) {
    find_sights({part.face, x[0] * part.place[0] + x[1] * part.place[1] + x[2] * part.place[2]}, sights);
    double first = k_infinity, least = k_infinity, most = -k_infinity;
    for (std::size_t i = 0; i < claims.size(); ++i) {
      const ExactField::Sight* const sight = find_sight(sights, claims[i].site);
      if (!is_rival[i] || !sight) continue;
      const double expected = distance_at(part, claims[i], x), more = sight->distance - expected;
      first = std::min(first, expected);
      least = std::min(least, more);
      most = std::max(most, more);
    }
    if (most - least > tolerance_) return false;
    for (std::size_t i = 0; i < claims.size(); ++i) {
      const ExactField::Sight* const sight = find_sight(sights, claims[i].site);
      if (is_rival[i] || !sight) continue;
      const double expected = distance_at(part, claims[i], x), more = sight->distance - expected;
      if (most - more > std::max(tolerance_, (expected - first) / 2)) return false;
    }
  }
  return true;
}

ExactClaims::ExactClaims(const ExactParts& parts, const Mesh& mesh, Index site_count)
    : FaceClaims(mesh, site_count), parts_(parts) {
  std::vector<Index> first{0};
  std::vector<FaceClaim> all, claims;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const FaceRefinement::Part& part = parts.refinement().parts()[parts.order()[face]];
    parts.find_claims(part, claims);
    for (FaceClaim& claim : claims) {
      claim.face = face;
      if (!is_beaten(claim, claims)) all.push_back(claim);
    }
    first.push_back(static_cast<Index>(all.size()));
  }
  const auto count = [&](Index face) { return first[face + 1] - first[face]; };
  // A face that does not know of a site that its neighbour sees on their edge must be divided there all the same.
  std::vector<std::uint8_t> is_shared(mesh.face_count(), 0);
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (count(face) == 1) continue;
    is_shared[face] = 1;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = mesh.twin(h);
      if (twin == k_none || count(Mesh::face_of(twin)) > 1) continue;
      lines.clear();
      for (Index i = first[face]; i < first[face + 1]; ++i) lines.push_back(all[i].line_along(h));
      lower_envelope(lines, pieces);
      if (pieces.size() > 1) is_shared[Mesh::face_of(twin)] = 1;
    }
  }
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (!is_shared[face]) continue;
    shared_index_[face] = shared_count();
    faces_.push_back(face);
    claims_.insert(claims_.end(), all.begin() + first[face], all.begin() + first[face + 1]);
    first_.push_back(claim_count());
  }
}

}  // namespace saddleback
