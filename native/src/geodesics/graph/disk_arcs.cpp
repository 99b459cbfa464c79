#include "geodesics/graph/disk_arcs.h"

#include <algorithm>

namespace saddleback {
namespace {

int to_sector(float sector) { return std::clamp(static_cast<int>(sector), 0, ArcCodec::k_sectors - 1); }

}  // namespace

void DiskRows::find(Index first, Index count, FoundArcs& found, const JobStage& stage) {
  finder_.begin(GeodesicDisks::Sources::nodes);
  for (int lane = 0; lane < count; ++lane) finder_.add_node(lane, first + lane);
  finder_.run(stage);
  for (int lane = 0; lane < count; ++lane) write_row(first + lane, lane, found);
}

void DiskRows::write_row(Index node, int lane, FoundArcs& found) {
  const SightingRows rows = finder_.sightings();
  const std::span<const std::int32_t> chosen = finder_.chosen(lane);
  const std::size_t count = chosen.size(), room = count + k_row_padding;
  found.counts.push_back(static_cast<std::int32_t>(count));
  lengths_.resize(room);
  leaving_.resize(room);
  back_.resize(room);
  kernel_.aim(rows, chosen.data(), static_cast<int>(count), lengths_.data(), leaving_.data(), back_.data());
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
