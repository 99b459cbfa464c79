#include "tessellation/cells/exact_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "support/threads/parallel.h"
#include "tessellation/bisectors/face_partition.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Of parts, some for each face and site: a hundred times what usual cells have. Only where rounding decides which site
// is nearer would there be more, wherever it does.
constexpr std::size_t k_some_parts = 1 << 17, k_parts_each = 128;

// How much shorter parts may get in a round than in the one before.
constexpr double k_finer = 4;

// Of the tolerance, where no way bends: bisectors are straight there, so that it costs few parts.
constexpr double k_unbent = 0.1;

// Of a distance: by so much it may be told longer than the way over another corner that is as long.
constexpr double k_rounding = 1e-12;

// Of the tolerance: a way that is the shortest is as long as the distance, but for rounding.
constexpr double k_explained = 1e-3;

/// Tells whether another candidate is nearer at all corners: then it is in the whole part.
bool is_beaten(const FaceCandidate& candidate, const std::vector<FaceCandidate>& candidates) {
  return std::ranges::any_of(candidates, [&](const FaceCandidate& other) {
    for (int i = 0; i < 3; ++i)
      if (!(other.squared_distance[i] < candidate.squared_distance[i])) return false;
    return true;
  });
}

double sum(const std::array<double, 3>& x) { return x[0] + x[1] + x[2]; }

/// Tells whether a candidate owns something of its part that is not owed to rounding alone. Where two sites are as far
/// along a whole edge, or in a whole part, another is no farther at any corner, but for rounding, and nearer in all.
bool is_rival(const FaceCandidate& candidate, const std::vector<FaceCandidate>& candidates) {
  return std::ranges::none_of(candidates, [&](const FaceCandidate& other) {
    for (int i = 0; i < 3; ++i)
      if (!(other.squared_distance[i] <= (1 + k_rounding) * candidate.squared_distance[i])) return false;
    return std::pair(sum(other.squared_distance), other.site) <
           std::pair(sum(candidate.squared_distance), candidate.site);
  });
}

/// The entry of a source in a list by source; null where there is none.
template <class List>
auto find_source(List& list, Index source) {
  const auto found = std::ranges::lower_bound(list, source, {}, [](const auto& entry) { return entry.source; });
  return found != list.end() && found->source == source ? &*found : nullptr;
}

/// The places where a part is looked at, barycentric: the middles of its edges and of itself.
std::array<Vec3, 4> samples_of_part() {
  return {Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(1, 1, 1) / 3};
}

Vec3 place_in(const FaceRefinement::Part& part, const Vec3& x) {
  return x[0] * part.place[0] + x[1] * part.place[1] + x[2] * part.place[2];
}

/// Tells what the squared distances at the corners say in between, as for a point in the plane.
double distance_at(const FaceRefinement::Part& part, const FaceCandidate& candidate, const Vec3& x) {
  double squared = 0;
  for (int i = 0; i < 3; ++i)
    squared += x[i] * candidate.squared_distance[i] - x[i] * x[(i + 1) % 3] * part.length[i] * part.length[i];
  return std::sqrt(std::max(0.0, squared));
}

/// Places that show who owns what in a part, barycentric: beside the ends of the bisectors, on all sides of them, and
/// in the middle of each site's piece, however thin it is.
std::vector<Vec3> places_by_bisectors(const std::vector<FaceCandidate>& candidates, const JobStage& stage) {
  constexpr double k_aside = 0.1;
  std::vector<FacePlane> planes;
  for (const FaceCandidate& candidate : candidates) planes.push_back({candidate.site, candidate.squared_distance});
  FacePartition partition;
  std::vector<Vec3> places;
  if (!partition.build(planes, stage))
    return places;  // distances so unlike that no place says more than the corners do
  const std::vector<FacePartition::Vertex>& vertices = partition.vertices();
  std::vector<std::uint8_t> is_placed(vertices.size(), 0);
  for (const FacePartition::Piece& piece : partition.pieces()) {
    Vec3 middle = Vec3::Zero();
    for (const Index v : piece.loop) {
      middle += vertices[v].barycentric / static_cast<double>(piece.loop.size());
      if (vertices[v].side == FacePartition::k_corner || is_placed[v]++) continue;
      for (int i = 0; i < 3; ++i) places.push_back((1 - k_aside) * vertices[v].barycentric + k_aside * Vec3::Unit(i));
    }
    places.push_back(middle);
  }
  return places;
}

}  // namespace

ExactParts::ExactParts(const ExactField& field, const std::vector<Index>& sites, std::vector<double> tolerances,
                       int threads, const JobStage& stage)
    : field_(field),
      sites_(sites),
      tolerances_(std::move(tolerances)),
      threads_(threads),
      stage_(stage),
      refinement_(field.mesh()) {
  look_at_mesh_vertices(stage.part(0, 0.3));
  const std::size_t most = k_some_parts + k_parts_each * (field.mesh().face_count() + sites.size());
  state_.assign(field.mesh().face_count(), State::due);
  ways_of_.assign(field.mesh().face_count(), k_none);
  const double faces = field.mesh().face_count();
  std::int64_t looks = 0;  // how many parts more will be looked at than there are faces is not known
  const auto share = [&] {
    const double of_faces = static_cast<double>(looks) / faces;
    return of_faces <= 1 ? of_faces / 2 : 1 - 0.5 / of_faces;
  };
  // Parts are looked at by length, so that where parts run out all places are divided alike.
  double least = 0;
  for (const FaceRefinement::Part& part : refinement_.parts()) least = std::max(least, length_of(part));
  Look look;
  for (bool goes_on = true; goes_on;) {  // what is told anew in one part is looked at in those beside
    goes_on = false;
    least = least > 1 ? least / k_finer : 0;
    Index seen = 0;  // parts before it were looked at ahead
    for (Index part = 0; part < static_cast<Index>(state_.size()); ++part) {
      if (part == seen) seen = look_ahead(part, least);
      Look& at = next_->part == part ? *next_++ : look;
      if (state_[part] == State::done) continue;
      goes_on = true;
      if (length_of(refinement_.parts()[part]) < least) continue;
      if (looks++ % 64 == 0) stage.update(0.3 + 0.7 * share());
      if (state_[part] == State::due) look_at(part, at);
      state_[part] = State::done;
      if (at.is_right)
        tell_corners(at);
      else if (refinement_.parts().size() < most)
        divide(at);
    }
  }
  sort_parts();
}

/// Looks at some parts from one on by all threads, in case nothing changes about them until it is their turn. Returns
/// the part after them.
Index ExactParts::look_ahead(Index part, double least) {
  constexpr std::size_t k_looks = 1024;  // few of which are lost: one in a hundred on scans
  std::size_t count = 0;
  looks_.resize(k_looks + 1);  // the last for none
  for (; part < static_cast<Index>(state_.size()) && count < k_looks; ++part) {
    if (state_[part] == State::done || length_of(refinement_.parts()[part]) < least) continue;
    state_[part] = State::looked_at;
    looks_[count++].part = part;
  }
  looks_[count].part = k_none;
  parallel_for(static_cast<Index>(count), threads_, 16, [&](Index i, int) {
    stage_.check();
    fetch(looks_.data() + i, looks_.data() + count);
    look_at(looks_[i].part, looks_[i]);
  });
  next_ = looks_.data();
  return part;
}

/// Asks for what the looks after one need: a third of the time would be waiting for memory.
void ExactParts::fetch(const Look* look, const Look* end) const {
  constexpr Index k_ahead = 4;
  const auto corners = [&](Index ahead) -> std::span<const Index> {
    if (end - look <= ahead) return {};
    return refinement_.parts()[look[ahead].part].corner;
  };
  for (const Index corner : corners(2 * k_ahead)) __builtin_prefetch(&vertices_[corner]);
  for (const Index corner : corners(k_ahead)) __builtin_prefetch(&known_[vertices_[corner].first]);
}

/// Sorts the parts by face, those of one face by number.
void ExactParts::sort_parts() {
  const std::vector<FaceRefinement::Part>& parts = refinement_.parts();
  std::vector<Index> begins(field_.mesh().face_count() + 1, 0);
  for (const FaceRefinement::Part& part : parts) ++begins[part.face + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  order_.resize(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) order_[begins[parts[part].face]++] = static_cast<Index>(part);
}

void ExactParts::divide(const Look& look) {
  Index& ways = ways_of_[look.part];
  if (ways == k_none || 4 * look.ways().size() <= 3 * ways_to_[ways].size()) {
    ways = static_cast<Index>(ways_to_.size());
    ways_to_.push_back(look.ways());
  }
  changed_.clear();
  refinement_.halve(look.part, changed_);
  ways_of_.resize(refinement_.parts().size());
  state_.resize(refinement_.parts().size());
  for (std::size_t i = 0; i < changed_.size(); i += 2) ways_of_[changed_[i + 1]] = ways_of_[changed_[i]];
  for (const Index other : changed_) state_[other] = State::due;
  look_at_added();
}

void ExactParts::find_ways(const WaysToFace& to_face, const Vec3& place, Ways& ways) const {
  to_face.at(place, ways);
  for (Way& way : ways) way.source = sites_[way.source];
}

void ExactParts::add_distances(const WaysToFace& to_face, const Vec3& place, Distances& distances) {
  find_ways(to_face, place, found_);
  for (const Way& way : found_) {
    const auto known = std::ranges::lower_bound(distances, way.source, {}, &Known::source);
    if (known == distances.end() || known->source != way.source)
      distances.insert(known, {way.source, false, way.distance, 0});
    else
      known->distance = std::min(known->distance, way.distance);
  }
}

void ExactParts::tell(Index vertex, const Distances& distances) {
  Vertex& at = vertices_[vertex];
  if (static_cast<Index>(distances.size()) != at.count) {
    at.first = known_.size();
    at.count = static_cast<Index>(distances.size());
    known_.resize(known_.size() + distances.size());
  }
  std::ranges::copy(distances, known_.data() + at.first);
}

void ExactParts::add_vertex(const Distances& distances) {
  ExactField::Sight nearest{k_none, k_infinity};
  for (const Known& known : distances)
    if (known.distance < nearest.distance) nearest = {known.source, known.distance};
  vertices_.push_back({nearest.distance, nearest.source, 0, 0});
  tell(static_cast<Index>(vertices_.size()) - 1, distances);
}

void ExactParts::look_at_mesh_vertices(const JobStage& stage) {
  const Mesh& mesh = field_.mesh();
  std::vector<Distances> distances(mesh.vertex_count());
  for (Index face = 0; face < mesh.face_count(); ++face) {
    if (face % 256 == 0) stage.update(static_cast<double>(face) / mesh.face_count());
    stage.check();
    const WaysToFace to_face = field_.ways_to(face);
    for (int i = 0; i < 3; ++i) add_distances(to_face, Vec3::Unit(i), distances[mesh.triangles()[face][i]]);
  }
  for (const Distances& at_vertex : distances) add_vertex(at_vertex);
}

void ExactParts::look_at_added() {
  Distances distances;
  for (auto vertex = static_cast<Index>(vertices_.size()); vertex < refinement_.vertex_count(); ++vertex) {
    const FaceRefinement::Added& added = refinement_.added()[vertex - field_.mesh().vertex_count()];
    distances.clear();
    for (int i = 0; i < added.faces; ++i) {
      const auto& [face, place] = added.at[i];
      const Index known = ways_of_[added.part[i]];
      add_distances(known == k_none ? field_.ways_to(face) : ways_to_[known], place, distances);
    }
    add_vertex(distances);
  }
}

ExactParts::Corners ExactParts::corners_of(const FaceRefinement::Part& part) const {
  return {distances_of(part.corner[0]), distances_of(part.corner[1]), distances_of(part.corner[2])};
}

void ExactParts::find_candidates(const FaceRefinement::Part& part, std::vector<FaceCandidate>& candidates) const {
  find_candidates(part, corners_of(part), candidates);
}

/// A distance changes by no more than the way between two points: a site that is far behind at a corner owns nothing.
void ExactParts::find_candidates(const FaceRefinement::Part& part, const Corners& corners,
                                 std::vector<FaceCandidate>& candidates) const {
  candidates.clear();
  const std::array<double, 3>& length = part.length;
  std::array<const Known*, 3> next, end;
  std::array<ExactField::Sight, 3> first;
  std::array<double, 3> squared, beyond;  // of the nearest site's distances, and the next number above
  for (int i = 0; i < 3; ++i) {
    next[i] = corners[i].data();
    end[i] = next[i] + corners[i].size();
    first[i] = nearest(part.corner[i]);
    squared[i] = first[i].distance * first[i].distance;
    beyond[i] = std::nextafter(squared[i], k_infinity);
  }
  while (true) {  // the corners' lists, which are by source, are read side by side
    Index source = std::numeric_limits<Index>::max();
    for (int i = 0; i < 3; ++i)
      if (next[i] != end[i]) source = std::min(source, next[i]->source);
    if (source == std::numeric_limits<Index>::max()) return;
    std::array<double, 3> distance, least;
    for (int i = 0; i < 3; ++i) {
      const bool is_known = next[i] != end[i] && next[i]->source == source;
      distance[i] = is_known ? (next[i]++)->distance : k_infinity;
    }
    bool may_own = true, is_nearest = false;  // the latter whatever rounding says of the former
    for (int i = 0; i < 3; ++i) {
      const double to_next = length[i], to_last = length[(i + 2) % 3];
      // What is known stays to the bit, so that the faces beside an edge tell the same of it.
      const double by_others = std::min(distance[(i + 1) % 3] + to_next, distance[(i + 2) % 3] + to_last);
      least[i] = by_others < (1 - k_rounding) * distance[i] ? by_others : distance[i];
      may_own = may_own && least[i] - first[i].distance <= 2 * std::max(to_next, to_last);
      is_nearest = is_nearest || first[i].source == source;
    }
    if (!may_own && !is_nearest) continue;
    FaceCandidate candidate{part.face, source, {}};
    // Whatever rounding says of ties, all parts about a vertex agree on whose it is.
    for (int i = 0; i < 3; ++i)
      candidate.squared_distance[i] = first[i].source == source ? squared[i] : std::max(least[i] * least[i], beyond[i]);
    candidates.push_back(candidate);
  }
}

void ExactParts::look_at(Index index, Look& look) const {
  look.part = index;
  look.tells = false;
  look.is_right = is_right(refinement_.parts()[index], look);
}

bool ExactParts::is_right(const FaceRefinement::Part& part, Look& look) const {
  const double whole = tolerance_of(part);
  if (std::ranges::max(part.length) <= k_unbent * whole / 2) return true;
  std::vector<FaceCandidate>& candidates = look.candidates;
  find_candidates(part, candidates);
  if (candidates.size() == 1) return true;
  const std::array<Vec3, 4> samples = samples_of_part();
  find_ways_inside(part, look);
  for (std::size_t i = 0; i < samples.size(); ++i)
    find_ways(look.ways(), place_in(part, samples[i]), look.at_samples[i]);
  const auto is_of_rival = [&](const Way& way) {
    const auto candidate = std::ranges::find(candidates, way.source, &FaceCandidate::site);
    return candidate != candidates.end() && is_rival(*candidate, candidates);
  };
  const bool bends = std::ranges::any_of(look.at_samples, [&](const Ways& ways) {
    return std::ranges::any_of(ways, [&](const Way& way) { return way.before > 0 && is_of_rival(way); });
  });
  if (bends && std::ranges::max(part.length) <= whole / 2) return true;
  const double tolerance = bends ? whole : k_unbent * whole;
  const bool is_as_told = fits(part, candidates, look, nullptr, tolerance) && owners_are_nearest(part, look, tolerance);
  return is_as_told || straighten(part, look, tolerance);
}

/// Finds the ways that matter in a part, among those that are known of what it is a half of.
void ExactParts::find_ways_inside(const FaceRefinement::Part& part, Look& look) const {
  const Index known = ways_of_[look.part];
  if (known == k_none) look.found = field_.ways_to(part.face);
  look.known = known == k_none ? &look.found : &ways_to_[known];
  look.are_fewer = look.known->size() > 2 * look.known->source_count();  // else finding out would not pay
  if (look.are_fewer) look.known->find_inside(part.place, look.inside);
}

/// Tells whether the sites that own the places beside the bisectors are nearest there: one that a sample does not see
/// may be told, from the corners, to come between the others where it does not.
bool ExactParts::owners_are_nearest(const FaceRefinement::Part& part, const Look& look, double tolerance) const {
  const std::vector<FaceCandidate>& candidates = look.candidates;
  const auto is_seen = [&](const FaceCandidate& candidate) {
    return !is_rival(candidate, candidates) || std::ranges::all_of(look.at_samples, [&](const Ways& ways) {
      return find_source(ways, candidate.site) != nullptr;
    });
  };
  if (std::ranges::all_of(candidates, is_seen)) return true;
  for (const Vec3& x : places_by_bisectors(candidates, stage_)) {
    stage_.check();
    const Index nearest = sites_[look.ways().nearest_at(place_in(part, x)).source];
    double least = k_infinity, of_nearest = k_infinity;
    for (const FaceCandidate& candidate : candidates) {
      const double distance = distance_at(part, candidate, x);
      least = std::min(least, distance);
      if (candidate.site == nearest) of_nearest = distance;
    }
    if (of_nearest > least + tolerance) return false;
  }
  return true;
}

/// Looks at what the sites' distances at the samples are more than the corners say. Among sites that own something
/// there it must be the same: what it is moves no bisector. Others may be behind the nearest by less than at any
/// corner, but by no less than half of that. `straight`: the ways by which the former go, else each by its shortest.
bool ExactParts::fits(const FaceRefinement::Part& part, const std::vector<FaceCandidate>& candidates, const Look& look,
                      const Ways* straight, double tolerance) const {
  std::vector<std::uint8_t> rivals;
  for (const FaceCandidate& candidate : candidates) {
    stage_.check();  // of many in a part each is compared with each
    rivals.push_back(is_rival(candidate, candidates));
  }
  // Corners are samples, too, where more is told of a site than its distance: what the others see lies between.
  if (!straight)
    for (const std::span<const Known> corner : corners_of(part))
      for (std::size_t i = 0; i < candidates.size(); ++i)
        if (const Known* const known = find_source(corner, candidates[i].site);
            rivals[i] && known && std::abs(known->excess) > tolerance)
          return false;
  const std::array<Vec3, 4> samples = samples_of_part();
  std::array<double, 4> of_nearest;
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const Vec3& x = samples[s];
    double least = k_infinity, most = -k_infinity;
    of_nearest[s] = k_infinity;
    for (const Way& way : look.at_samples[s]) of_nearest[s] = std::min(of_nearest[s], way.distance);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const Way* const way = find_source(straight ? *straight : look.at_samples[s], candidates[i].site);
      if (straight && rivals[i] && !way) return false;
      if (!rivals[i] || !way) continue;
      const double distance =
          straight ? way->straight_to(field_.place_of({part.face, place_in(part, x)})) : way->distance;
      const double expected = distance_at(part, candidates[i], x);
      least = std::min(least, distance - expected);
      most = std::max(most, distance - expected);
    }
    if (most - least > tolerance) return false;
  }
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (rivals[i]) continue;
    double behind = k_infinity;
    for (int corner = 0; corner < 3; ++corner)
      behind =
          std::min(behind, std::sqrt(candidates[i].squared_distance[corner]) - nearest(part.corner[corner]).distance);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Way* const way = find_source(look.at_samples[s], candidates[i].site);
      if (way && way->distance - of_nearest[s] < std::min(behind - tolerance, behind / 2)) return false;
    }
  }
  return true;
}

/// Finds of each candidate's site the way at the sample where the site is nearest, or least behind the nearest.
ExactParts::Ways ExactParts::ways_seen(const Look& look) const {
  Ways seen;
  for (const FaceCandidate& candidate : look.candidates) {
    stage_.check();
    double least = k_infinity;
    const Way* best = nullptr;
    for (const Ways& ways : look.at_samples) {
      const Way* const way = find_source(ways, candidate.site);
      if (!way) continue;
      const double lead = way->distance - std::ranges::min(ways, {}, &Way::distance).distance;
      if (lead < least) least = lead, best = way;
    }
    if (best) seen.push_back(*best);
  }
  return seen;
}

/// Tells whether the shortest of straight ways is as long as the distance, at places in the part.
bool ExactParts::explain(const FaceRefinement::Part& part, const Look& look, const Ways& ways,
                         std::span<const Vec3> places) const {
  for (const Vec3& x : places) {
    stage_.check();
    const Vec3 inside = place_in(part, x);
    const Vec2 place = field_.place_of({part.face, inside});
    double least = k_infinity;
    for (const Way& way : ways) least = std::min(least, way.straight_to(place));
    if (std::abs(least - look.ways().nearest_at(inside).distance) > k_explained * tolerance_of(part)) return false;
  }
  return true;
}

/// Tells how far sites are from the part's corners, where they are not nearest, as if the surface went on; only if the
/// part is right then.
bool ExactParts::straighten(const FaceRefinement::Part& part, Look& look, double tolerance) const {
  Ways ways = ways_seen(look);
  std::erase_if(ways, [&](const Way& way) {
    stage_.check();
    const auto candidate = std::ranges::find(look.candidates, way.source, &FaceCandidate::site);
    return !is_rival(*candidate, look.candidates);
  });
  if (!explain(part, look, ways, samples_of_part())) return false;
  std::array<Distances, 3>& told = look.told;
  for (int i = 0; i < 3; ++i) {
    const std::span<const Known> before = distances_of(part.corner[i]);
    told[i].assign(before.begin(), before.end());
    const ExactField::Sight at_corner = nearest(part.corner[i]);
    const Vec2 place = field_.place_of({part.face, part.place[i]});
    for (const Way& way : ways) {
      if (way.source == at_corner.source) continue;
      const double distance = way.straight_to(place);
      if (distance <= at_corner.distance) return false;
      const auto known = std::ranges::lower_bound(told[i], way.source, {}, &Known::source);
      if (known == told[i].end() || known->source != way.source)
        told[i].insert(known, {way.source, true, distance, 0});
      else if (!known->is_straight)
        *known = {way.source, true, distance, distance - known->distance};
    }
  }
  std::vector<FaceCandidate> straight;
  find_candidates(part, {told[0], told[1], told[2]}, straight);
  look.tells =
      fits(part, straight, look, &ways, tolerance) && explain(part, look, ways, places_by_bisectors(straight, stage_));
  return look.tells;
}

void ExactParts::tell_corners(const Look& look) {
  if (!look.tells) return;
  const FaceRefinement::Part& part = refinement_.parts()[look.part];
  for (int i = 0; i < 3; ++i) {
    if (std::ranges::equal(distances_of(part.corner[i]), look.told[i], {}, &Known::distance, &Known::distance))
      continue;
    tell(part.corner[i], look.told[i]);
    refinement_.visit_about(look.part, i, [&](Index other) { state_[other] = State::due; });
  }
}

ExactCandidates::ExactCandidates(const ExactParts& parts, const FaceTable& faces, Index site_count, int threads)
    : FaceCandidates(faces, site_count), parts_(parts) {
  constexpr Index k_block = 4096;
  std::vector<std::vector<FaceCandidate>> blocks((faces.face_count() + k_block - 1) / k_block);
  parallel_for(static_cast<Index>(blocks.size()), threads, 1, [&](Index block, int) {
    std::vector<FaceCandidate> candidates;
    for (Index face = k_block * block; face < std::min(faces.face_count(), k_block * (block + 1)); ++face) {
      parts.find_candidates(parts.refinement().parts()[parts.order()[face]], candidates);
      for (FaceCandidate& candidate : candidates) {
        candidate.face = face;
        if (!is_beaten(candidate, candidates)) blocks[block].push_back(candidate);
      }
    }
  });
  std::vector<FaceCandidate> all;
  std::vector<Index> first(faces.face_count() + 1, 0);
  for (std::vector<FaceCandidate>& block : blocks) {
    for (const FaceCandidate& candidate : block) ++first[candidate.face + 1];
    all.insert(all.end(), block.begin(), block.end());
    block = {};
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  const auto count = [&](Index face) { return first[face + 1] - first[face]; };
  // A face that does not know of a site that its neighbor sees on their edge must be divided there all the same.
  std::vector<std::uint8_t> is_shared(faces.face_count(), 0);
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;
  for (Index face = 0; face < faces.face_count(); ++face) {
    if (count(face) == 1) continue;
    is_shared[face] = 1;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = faces.twins[h];
      if (twin == k_none || count(Mesh::face_of(twin)) > 1) continue;
      lines.clear();
      for (Index i = first[face]; i < first[face + 1]; ++i) lines.push_back(all[i].line_along(h));
      lower_envelope(lines, pieces);
      if (pieces.size() > 1) is_shared[Mesh::face_of(twin)] = 1;
    }
  }
  for (Index face = 0; face < faces.face_count(); ++face) {
    if (!is_shared[face]) continue;
    shared_index_[face] = shared_count();
    faces_.push_back(face);
    candidates_.insert(candidates_.end(), all.begin() + first[face], all.begin() + first[face + 1]);
    first_.push_back(candidate_count());
  }
}

}  // namespace saddleback
