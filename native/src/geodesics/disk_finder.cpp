#include "geodesics/disk_finder.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace saddleback {
namespace {

constexpr float k_infinity = std::numeric_limits<float>::infinity();
const std::int32_t k_unreached = std::bit_cast<std::int32_t>(k_infinity);
// Windows per source are 200 to 1,000 on any sane mesh; needles by the thousand round one vertex may exceed that
// without end, and stopping only costs arcs, never correctness.
constexpr int k_most_windows = 1 << 20;
// Vertices as far as the k-th, but for rounding, belong to the disk: on regular meshes there are many.
constexpr float k_as_far = 1 + 1e-5f;
constexpr float k_much_shorter = 1 - 1e-6f;
constexpr double k_rounding = 1e-6;
// Finding the k-th nearest takes as long as a generation.
constexpr int k_generations_per_bound = 3;
// Windows end where a flank serves within this many times the tolerance. Less costs windows and arcs: with 1 a fifth
// more of both; more lets errors exceed the accuracy here and there.
constexpr double k_radius_tolerance = 1.5;

float distance_of(std::int32_t label) { return std::bit_cast<float>(label); }
std::int32_t label_of(float distance, bool makes_arc) {
  const std::int32_t bits = std::bit_cast<std::int32_t>(distance) & ~1;
  return makes_arc ? bits : bits | 1;
}
bool makes_arc(std::int32_t label) { return (label & 1) == 0; }

int to_sector(float sector) { return std::clamp(static_cast<int>(sector), 0, ArcCodec::k_sectors - 1); }

}  // namespace

DiskFinder::DiskFinder(const WaveMesh& mesh, const ArcCodec& codec, const WaveKernel& kernel, const DiskRule& rule)
    : mesh_(mesh), codec_(codec), kernel_(kernel), rule_(rule) {
  const std::size_t slots = static_cast<std::size_t>(mesh.node_count()) * k_batch;
  labels_.assign(slots + k_row_padding, k_unreached);
  arc_labels_.assign(slots, k_unreached);
  best_.resize(slots);
}

void DiskFinder::find(Index first, Index count, FoundArcs& found, const JobStage& stage) {
  sighting_count_ = 0;
  now_->left_count = now_->right_count = 0;
  limits_.fill(k_infinity);
  generation_ = 0;
  for (int lane = 0; lane < count; ++lane) seed(first + lane, lane);
  run(stage);
  if (by_count()) finish_disks();
  for (int lane = 0; lane < count; ++lane) write_row(first + lane, lane, found);
  clear();
}

void DiskFinder::seed(Index node, int lane) {
  const std::int32_t centre = node * k_batch + lane;
  labels_[centre] = label_of(0, false);
  touched_[lane].push_back(centre);
  for (Index e = mesh_.begin(node); e < mesh_.end(node); ++e) {
    const Vec2 apex = mesh_.apex(e);
    link(mesh_.target(e) * k_batch + lane, mesh_.length(e), e, false);
    if (!mesh_.has_left(e)) link(mesh_.records()[e].apex * k_batch + lane, apex.norm(), e, true);
    if (mesh_.opposite(e) >= 0) add_window(lane, e, mesh_.length(e), apex);
  }
}

/// An edge of the source, or the other one of its face where that has no half-edge of its own, is a sighting as well.
void DiskFinder::link(std::int32_t slot, double length, Index edge, bool other) {
  sightings_.reserve(sighting_count_ + 1);
  const SightingRows rows = sightings_.rows();
  rows.x[sighting_count_] = length;
  rows.y[sighting_count_] = 0;
  rows.back_x[sighting_count_] = rows.back_y[sighting_count_] = 0;
  rows.slot[sighting_count_] = slot;
  rows.label[sighting_count_] = label_of(static_cast<float>(length), true);
  rows.root[sighting_count_] = ~edge;
  rows.edge[sighting_count_] = other;
  lower_labels(sighting_count_, sighting_count_ + 1);
  ++sighting_count_;
}

/// Through the side of `root`'s face that is opposite the source.
void DiskFinder::add_window(int lane, Index root, double length, const Vec2& apex) {
  WindowColumns& columns = now_->lefts;
  columns.reserve(now_->left_count + 1);
  const WindowRows rows = columns.rows();
  const int i = now_->left_count++;
  const double reach = apex.norm();
  rows.from_x[i] = apex.x();
  rows.from_y[i] = apex.y();
  rows.to_x[i] = length;
  rows.to_y[i] = 0;
  rows.right_x[i] = 1;
  rows.right_y[i] = 0;
  rows.left_x[i] = static_cast<float>(apex.x() / reach);
  rows.left_y[i] = static_cast<float>(apex.y() / reach);
  rows.right_reach[i] = rows.right_way[i] = static_cast<float>(length);
  rows.left_reach[i] = rows.left_way[i] = static_cast<float>(reach);
  rows.most[i] = k_infinity;
  rows.edge[i] = mesh_.opposite(root) * k_batch + lane;
  rows.from[i] = mesh_.records()[root].apex * k_batch + lane;
  rows.to[i] = mesh_.target(root) * k_batch + lane;
  rows.root[i] = root;
}

void DiskFinder::run(const JobStage& stage) {
  for (int windows = 0; now_->size() > 0 && windows < k_most_windows;) {
    stage.check();
    windows += now_->size();
    advance();
    std::swap(now_, next_);
  }
}

/// Sights all windows of this generation, then splits them into the next.
void DiskFinder::advance() {
  const WaveScene scene{mesh_.records(), labels_.data(), limits_.data(), static_cast<float>(1 + rule_.tolerance),
                        static_cast<float>(k_radius_tolerance * rule_.tolerance)};
  const int before = sighting_count_;
  sightings_.reserve(sighting_count_ + now_->size() + k_row_padding);
  apexes_.reserve(now_->size() + 2 * k_row_padding);
  // Rows of the right half begin behind the padding of the left one.
  const ApexRows apexes = apexes_.rows(0), right_apexes = apexes_.rows(now_->left_count + k_row_padding);
  const auto sight = by_count() ? kernel_.sight_all : kernel_.sight;
  sighting_count_ = sight(scene, now_->lefts.rows(), now_->left_count, apexes, sightings_.rows(), sighting_count_);
  sighting_count_ =
      sight(scene, now_->rights.rows(), now_->right_count, right_apexes, sightings_.rows(), sighting_count_);
  lower_labels(before, sighting_count_);
  if (by_count()) bound_disks();

  next_->left_count = next_->right_count = 0;
  next_->lefts.reserve(now_->size() + k_row_padding);
  next_->rights.reserve(now_->size() + k_row_padding);
  const auto split = by_count() ? kernel_.split_all : kernel_.split;
  const WindowRows lefts = next_->lefts.rows(), rights = next_->rights.rows();
  split(scene, now_->lefts.rows(), now_->left_count, apexes, lefts, &next_->left_count, rights, &next_->right_count);
  split(scene, now_->rights.rows(), now_->right_count, right_apexes, lefts, &next_->left_count, rights,
        &next_->right_count);
}

void DiskFinder::lower_labels(int from, int to) {
  const SightingRows rows = sightings_.rows();
  for (int i = from; i < to; ++i) {
    const std::int32_t slot = rows.slot[i], label = rows.label[i];
    if (makes_arc(label) && label < arc_labels_[slot]) {
      arc_labels_[slot] = label;
      best_[slot] = i;
    }
    if (label >= labels_[slot]) continue;
    if (labels_[slot] == k_unreached) touched_[slot % k_batch].push_back(slot);
    labels_[slot] = label;
    if (by_count()) changed_.push_back(slot);
  }
}

/// An arc that is not the shortest way stays as long as others may rely on it: no distance in the graph exceeds the
/// shortest by more than the tolerance, so that longer arcs serve nothing.
bool DiskFinder::is_kept(std::int32_t slot) const {
  const double slack = 1 + std::max(rule_.tolerance, k_rounding);
  const float reach = distance_of(arc_labels_[slot]);
  return reach < k_infinity && reach <= slack * distance_of(labels_[slot]) && reach <= limits_[slot % k_batch];
}

void DiskFinder::write_row(Index node, int lane, FoundArcs& found) {
  const SightingRows rows = sightings_.rows();
  chosen_.clear();
  for (const std::int32_t slot : touched_[lane])
    if (is_kept(slot)) chosen_.push_back(best_[slot]);
  // Edges stay even where something shorter, but no arc, was found.
  for (int i = 0; i < sighting_count_ && rows.root[i] < 0; ++i)
    if (rows.slot[i] % k_batch == lane && !is_kept(rows.slot[i])) chosen_.push_back(i);
  const auto count = static_cast<int>(chosen_.size());
  found.counts.push_back(count);
  const std::size_t room = chosen_.size() + k_row_padding;
  chosen_.resize(room);
  lengths_.resize(room);
  leaving_.resize(room);
  back_.resize(room);
  kernel_.aim(rows, chosen_.data(), count, lengths_.data(), leaving_.data(), back_.data());
  const std::size_t before = found.words.size();
  found.words.resize(before + chosen_.size() - k_row_padding);
  found.back_sectors.resize(found.words.size());
  const float per_radian = mesh_.sectors_per_radian(node);
  for (int i = 0; i < count; ++i) {
    const std::int32_t sighting = chosen_[i];
    const Index target = rows.slot[sighting] / k_batch, root = rows.root[sighting];
    float leaving, back;
    if (root >= 0) {
      leaving = mesh_.sector(root) + leaving_[i] * per_radian;
      back = mesh_.apex_sector(rows.edge[sighting] / k_batch) + back_[i] * mesh_.sectors_per_radian(target);
    } else if (rows.edge[sighting] == 0) {  // an edge of the source
      leaving = mesh_.sector(~root);
      back = mesh_.reverse_sector(~root);
    } else {  // the other one of its face, at the boundary
      leaving = ArcCodec::k_sectors;
      back = mesh_.apex_sector(~root);
    }
    found.words[before + i] = codec_.pack(target, to_sector(leaving), lengths_[i] * mesh_.unit());
    found.back_sectors[before + i] = static_cast<std::uint8_t>(to_sector(back));
  }
}

void DiskFinder::clear() {
  changed_.clear();
  for (auto& slots : touched_) {
    for (const std::int32_t slot : slots) labels_[slot] = arc_labels_[slot] = k_unreached;
    slots.clear();
  }
}

/// Lowers the radius of a lane's disk to that of the k-th nearest vertex, as far as is known.
bool DiskFinder::bound_disk(int lane) {
  const auto& slots = touched_[lane];
  if (static_cast<Index>(slots.size()) <= rule_.k) return false;
  radii_.clear();
  for (const std::int32_t slot : slots) radii_.push_back(distance_of(labels_[slot]));
  const auto kth = radii_.begin() + rule_.k;  // the source is the nearest
  std::nth_element(radii_.begin(), kth, radii_.end());
  const float radius = *kth * k_as_far;
  const bool smaller = radius < limits_[lane];
  limits_[lane] = std::min(limits_[lane], radius);
  return smaller;
}

/// No window is left: distances are final once every bend is known.
void DiskFinder::finish_disks() {
  bool smaller = true;
  while (smaller) {
    smaller = false;
    for (int lane = 0; lane < k_batch; ++lane) smaller |= bound_disk(lane);
    relax_bends();
  }
}

void DiskFinder::bound_disks() {
  if (++generation_ % k_generations_per_bound != 0) return;
  for (int lane = 0; lane < k_batch; ++lane) bound_disk(lane);
  relax_bends();
}

/// Behind saddle vertices windows bring no distances: there, bounds by edges count the vertices of the disk and end the
/// windows that serve nothing. Done only where the disk's radius is known: without it this would flood the mesh.
void DiskFinder::relax_bends() {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    const std::int32_t slot = changed_[i];
    if (limits_[slot % k_batch] == k_infinity) {
      changed_[kept++] = slot;
    } else {
      relax_from(slot);
    }
  }
  changed_.resize(kept);
}

void DiskFinder::relax_from(std::int32_t slot) {
  const Index node = slot / k_batch;
  const int lane = slot % k_batch;
  const std::int32_t label = labels_[slot];
  if (distance_of(label) >= limits_[lane] || (makes_arc(label) && !mesh_.is_saddle(node))) return;
  const auto offer = [&](Index target, double length) {
    const std::int32_t there = target * k_batch + lane;
    const std::int32_t bent = label_of(distance_of(label) + static_cast<float>(length), false);
    // Shorter by more than rounding: what is collinear stays an arc.
    if (distance_of(bent) >= distance_of(labels_[there]) * k_much_shorter) return;
    if (labels_[there] == k_unreached) touched_[lane].push_back(there);
    labels_[there] = bent;
    changed_.push_back(there);
  };
  for (Index e = mesh_.begin(node); e < mesh_.end(node); ++e) {
    offer(mesh_.target(e), mesh_.length(e));
    if (!mesh_.has_left(e)) offer(mesh_.records()[e].apex, mesh_.apex(e).norm());
  }
}

}  // namespace saddleback
