#include "geodesics/graph/disk_arcs.h"

#include <algorithm>
#include <utility>

#include "geodesics/unfolding/unfolded_corner.h"

namespace saddleback {
namespace {

template <class Number>
int to_sector(Number sector) {
  return std::clamp(static_cast<int>(sector), 0, ArcCodec::k_sectors - 1);
}
int sector_of(double angle, double total_angle) { return to_sector(angle / total_angle * ArcCodec::k_sectors); }

}  // namespace

void append_arc(const ArcSearch& search, const ArcCodec& codec, Index vertex, const DirectArc& arc, FoundArcs& found) {
  const Mesh& mesh = search.unfolding.mesh();
  const int sector = sector_of(arc.start_angle, mesh.total_angle(vertex));
  found.words.push_back(codec.pack(search.nodes[arc.vertex], sector, arc.length));
  found.back_sectors.push_back(static_cast<std::uint8_t>(sector_of(arc.end_angle, mesh.total_angle(arc.vertex))));
}

bool DiskRows::find(Index first, Index count, FoundArcs& found, const JobStage& stage) {
  finder_.begin(GeodesicDisks::Sources::nodes);
  for (int lane = 0; lane < count; ++lane) finder_.add_node(lane, first + lane);
  finder_.run(stage);
  if (finder_.left_tables()) return false;
  for (int lane = 0; lane < count; ++lane) {
    write_row(first + lane, lane, found);
    if (is_at_thin_face(first + lane)) add_near(first + lane, found, stage);
  }
  return true;
}

bool DiskRows::is_at_thin_face(Index node) const {
  const EdgeRecord* const records = mesh_.records();
  return std::any_of(records + mesh_.begin(node), records + mesh_.end(node),
                     [](const EdgeRecord& record) { return is_too_thin(record.a, record.b); });
}

/// Adds arcs to vertices that are far nearer than the longest edge is long, found in double precision, to the last row;
/// of two to one vertex the shorter stays.
void DiskRows::add_near(Index node, FoundArcs& found, const JobStage& stage) {
  constexpr Index k_nearest = 200;
  constexpr double k_far_nearer = 1.0 / (1 << 10);
  if (!visible_) visible_ = std::make_unique<VisibleVertices>(search_.unfolding);
  const Index vertex = search_.vertices[node];
  visible_->from_vertex(vertex, std::min(k_nearest, static_cast<Index>(search_.vertices.size())), near_, stage);
  const auto end = static_cast<Index>(found.words.size());
  std::vector<std::pair<Index, Index>> known;  // targets, and where they are
  for (Index i = end - found.counts.back(); i < end; ++i) known.emplace_back(codec_.target(found.words[i]), i);
  std::ranges::sort(known);
  double longest = 0;
  for (Index e = mesh_.begin(node); e < mesh_.end(node); ++e) longest = std::max(longest, mesh_.length(e));
  for (const DirectArc& arc : near_) {
    if (arc.length > k_far_nearer * longest * mesh_.unit()) continue;
    append_arc(search_, codec_, vertex, arc, found);
    const Index target = search_.nodes[arc.vertex];
    const auto at = std::ranges::lower_bound(known, std::pair(target, Index(0)));
    if (at == known.end() || at->first != target) {
      ++found.counts.back();
      continue;
    }
    if (codec_.length_bits(found.words.back()) < codec_.length_bits(found.words[at->second])) {
      found.words[at->second] = found.words.back();
      found.back_sectors[at->second] = found.back_sectors.back();
    }
    found.words.pop_back();
    found.back_sectors.pop_back();
  }
}

void DiskRows::write_row(Index node, int lane, FoundArcs& found) {
  const SightingRows rows = finder_.sightings();
  const std::span<const std::int32_t> chosen = finder_.chosen(lane);
  const std::size_t count = chosen.size(), room = count + k_row_padding;
  found.counts.push_back(static_cast<std::int32_t>(count));
  lengths_.resize(room);
  leaving_.resize(room);
  back_.resize(room);
  search_.kernel.aim(rows, chosen.data(), static_cast<int>(count), lengths_.data(), leaving_.data(), back_.data());
  const std::size_t before = found.words.size();
  found.words.resize(before + count);
  found.back_sectors.resize(found.words.size());
  // What is written are bytes, which might be anything's as far as a compiler knows: all that is read is at hand.
  const WaveSectors& sectors = sectors_;
  const ArcPacking packing = codec_.packing();
  const double unit = finder_.unit(lane), *const lengths = lengths_.data();
  const float per_radian = sectors.per_radian(node), *const leaving_angles = leaving_.data(),
              *const back_angles = back_.data();
  std::uint64_t* const words = found.words.data() + before;
  std::uint8_t* const back_sectors = found.back_sectors.data() + before;
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t sighting = chosen[i];
    const Index target = rows.slot[sighting] >> k_batch_bits, root = rows.root[sighting];
    float leaving, back;
    if (!GeodesicDisks::is_link(root)) {
      leaving = sectors.sector(root) + leaving_angles[i] * per_radian;
      back = sectors.apex_sector(rows.edge[sighting] >> k_batch_bits) + back_angles[i] * sectors.per_radian(target);
    } else if (const auto [edge, other_side] = GeodesicDisks::link_of(rows, sighting); !other_side) {
      leaving = sectors.sector(edge);
      back = sectors.reverse_sector(edge);
    } else {  // at the boundary
      leaving = ArcCodec::k_sectors;
      back = sectors.apex_sector(edge);
    }
    words[i] = packing.pack(target, to_sector(leaving), lengths[i] * unit);
    back_sectors[i] = static_cast<std::uint8_t>(to_sector(back));
  }
}

}  // namespace saddleback
