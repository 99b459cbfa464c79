#include "geodesics/graph/geodesic_disks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

#include "geodesics/unfolding/unfolded_corner.h"
#include "support/planar.h"

namespace saddleback {
namespace {

constexpr float k_infinity = std::numeric_limits<float>::infinity();
const std::int32_t k_unreached = std::bit_cast<std::int32_t>(k_infinity);
// Vertices as far as the k-th, but for rounding, belong to the disk: on regular meshes there are many.
constexpr float k_as_far = 1 + 1e-5f;
constexpr float k_longer = 1 + 1e-6f;
constexpr double k_rounding = 1e-6;
// Windows end where a flank serves within this many times the tolerance. Less costs windows and arcs: with 1 a tenth
// more of both; more lets errors come near the accuracy here and there, with 1.5 to a fiftieth.
constexpr double k_radius_tolerance = 1.1;
// The same on lattices, and what two shorter arcs may be longer by, as parts of the tolerance. Found on grids of cells
// from 1 : 1 to 20 : 1.
constexpr double k_lattice_radius_tolerance = 0.5, k_stretched_radius_tolerance = 0.3, k_lattice_detour = 0.7;

double radius_tolerance(Lattice lattice) {
  switch (lattice) {
    case Lattice::even:
      return k_lattice_radius_tolerance;
    case Lattice::stretched:
      return k_stretched_radius_tolerance;
    default:
      return k_radius_tolerance;
  }
}
double detour_of(const DiskRule& rule) {
  return rule.tolerance * (rule.lattice == Lattice::none ? 1 : k_lattice_detour);
}

float distance_of(std::int32_t label) { return std::bit_cast<float>(label); }
std::int32_t label_of(float distance, bool makes_arc) {
  const std::int32_t bits = std::bit_cast<std::int32_t>(distance) & ~1;
  return makes_arc ? bits : bits | 1;
}
bool makes_arc(std::int32_t label) { return (label & 1) == 0; }

}  // namespace

WaveScene wave_scene(const EdgeRecord* records, const DiskRule& rule) {
  return {records,
          nullptr,
          nullptr,
          static_cast<float>(1 + detour_of(rule)),
          static_cast<float>(1 / (1 + detour_of(rule))),
          static_cast<float>(radius_tolerance(rule.lattice) * rule.tolerance)};
}

double scale_about(double longest_edge) {
  return longest_edge < k_small_edges ? std::ldexp(1.0, -std::ilogb(longest_edge)) : 1;
}

double arc_slack(const DiskRule& rule) { return 1 + std::max(detour_of(rule), k_rounding); }

GeodesicDisks::GeodesicDisks(const WindowMesh& mesh, const WaveKernel& kernel, const DiskRule& rule,
                             const BorderStrips* strips)
    : mesh_(mesh), kernel_(kernel), rule_(rule) {
  if (strips && !strips->empty() && !by_count()) {
    strips_ = strips;
    walk_.emplace(*strips, 1 + detour_of(rule));
  }
  const std::size_t slots = static_cast<std::size_t>(mesh.node_count()) * k_batch;
  labels_.resize(slots + k_row_padding);
  arcs_.resize(slots);
  std::fill(labels_.end() - k_row_padding, labels_.end(), k_unreached);
  // What windows do not come to is not touched: for a part of a large mesh this memory takes longer than its arcs.
  for (Index node = 0; node < mesh.node_count(); ++node) {
    if (!mesh.laid().is_laid(node)) continue;
    std::fill_n(&labels_[static_cast<std::size_t>(node) * k_batch], k_batch, k_unreached);
    std::fill_n(&arcs_[static_cast<std::size_t>(node) * k_batch], k_batch, BestArc{k_unreached, 0});
  }
}

void GeodesicDisks::begin(Sources sources) {
  clear();
  sources_ = sources;
  sighting_count_ = 0;
  now_->left_count = now_->right_count = 0;
  limits_.fill(k_infinity);
  generation_ = 0;
  left_tables_ = false;
}

void GeodesicDisks::add_node(int lane, Index node) {
  double longest = 0;
  for_each_neighbor(node, [&](Index, double length) { longest = std::max(longest, length); });
  const double scale = scales_[lane] = scale_about(longest);
  const std::int32_t center = node * k_batch + lane;
  labels_[center] = label_of(0, false);
  touched_[by_count() ? lane : 0].push_back(center);
  for (Index e = mesh_.begin(node); e < mesh_.end(node); ++e) {
    const Vec2 along(scale * mesh_.length(e), 0), apex = scale * mesh_.apex(e), other(apex.norm(), 0);
    const Index apex_node = mesh_.records()[e].apex;
    add_link(mesh_.target(e) * k_batch + lane, along, along, 0, ~e);
    if (!mesh_.has_left(e)) add_link(apex_node * k_batch + lane, other, other, 1, ~e);
    if (mesh_.opposite(e) < 0) continue;
    const FirstWindow window{along, apex, mesh_.target(e), apex_node, mesh_.opposite(e), e};
    if (along.dot(apex) < 0) {
      add_wide_window(lane, window);
    } else {
      add_window(lane, window);
    }
  }
}

void GeodesicDisks::add_point(int lane, const FaceSource& source, double limit) {
  scales_[lane] = source.scale;
  limits_[lane] = static_cast<float>(limit * source.scale);
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    add_link(source.node[i] * k_batch + lane, source.corner[i], source.corner[next], source.edge[next] * k_batch + lane,
             ~0);
    if (source.entered[i] >= 0) {
      add_wide_window(lane, {source.corner[i], source.corner[next], source.node[i], source.node[next],
                             source.entered[i], source.edge[i]});
    }
  }
}

/// Corners of the source's own face are sightings as well. `from` is the start of the half-edge opposite, where there
/// is one; `root` as of sightings.
void GeodesicDisks::add_link(std::int32_t slot, const Vec2& place, const Vec2& from, std::int32_t edge,
                             std::int32_t root) {
  add_sighting(slot, place, from, edge, root);
  lower_labels(sighting_count_ - 1, sighting_count_);
}

/// Its label is still to be lowered.
void GeodesicDisks::add_sighting(std::int32_t slot, const Vec2& place, const Vec2& from, std::int32_t edge,
                                 std::int32_t root) {
  sightings_.reserve(sighting_count_ + 1);
  const SightingRows rows = sightings();
  const int i = sighting_count_++;
  rows.x[i] = place.x();
  rows.y[i] = place.y();
  rows.back_x[i] = static_cast<float>(from.x() - place.x());
  rows.back_y[i] = static_cast<float>(from.y() - place.y());
  if (rows.from_x) {
    rows.from_x[i] = from.x();
    rows.from_y[i] = from.y();
  }
  rows.slot[i] = slot;
  rows.label[i] = label_of(static_cast<float>(place.norm()), true);
  rows.edge[i] = edge;
  rows.root[i] = root;
}

/// Passes the faces whose far corners are on both rays, in double precision.
void GeodesicDisks::add_wide_window(int lane, FirstWindow window) {
  constexpr int k_most_faces = 1000;
  for (int faces = 0; faces < k_most_faces; ++faces) {
    if (window.entered == mesh_.beyond()) break;
    const EdgeRecord& record = mesh_.records()[window.entered];
    const Vec2 along = window.right - window.left;
    const Vec2 apex = window.left + record.a * along + record.b * Vec2(-along.y(), along.x());
    if (!is_on_both_rays(window.right.x(), window.right.y(), window.left.x(), window.left.y(), apex.x(), apex.y()))
      break;
    add_link(record.apex * k_batch + lane, apex, window.left, window.entered * k_batch + lane, window.root);
    const FirstWindow left{apex, window.left, record.apex, window.left_node, record.left, window.root},
        right{window.right, apex, window.right_node, record.apex, record.right, window.root};
    const bool is_right_wide = apex.dot(window.left) > 0;
    const FirstWindow &narrow = is_right_wide ? left : right, &wide = is_right_wide ? right : left;
    if (narrow.entered >= 0) add_window(lane, narrow);
    if (wide.entered < 0) return;
    window = wide;
  }
  add_window(lane, window);
}

/// Returns its row.
int GeodesicDisks::add_window(int lane, const FirstWindow& window) {
  left_tables_ |= window.entered == mesh_.beyond();
  WindowColumns& columns = now_->lefts;
  columns.reserve(now_->left_count + 1);
  const WindowRows rows = columns.rows();
  const int i = now_->left_count++;
  const double right_reach = window.right.norm(), left_reach = window.left.norm();
  rows.from_x[i] = window.left.x();
  rows.from_y[i] = window.left.y();
  rows.to_x[i] = window.right.x();
  rows.to_y[i] = window.right.y();
  rows.right_x[i] = static_cast<float>(window.right.x() / right_reach);
  rows.right_y[i] = static_cast<float>(window.right.y() / right_reach);
  rows.left_x[i] = static_cast<float>(window.left.x() / left_reach);
  rows.left_y[i] = static_cast<float>(window.left.y() / left_reach);
  rows.right_reach[i] = rows.right_way[i] = static_cast<float>(right_reach);
  rows.left_reach[i] = rows.left_way[i] = static_cast<float>(left_reach);
  rows.right_served[i] = rows.left_served[i] = 0;
  rows.most[i] = limits_[lane];
  rows.edge[i] = window.entered * k_batch + lane;
  rows.from[i] = window.left_node * k_batch + lane;
  rows.to[i] = window.right_node * k_batch + lane;
  rows.root[i] = window.root;
  return i;
}

bool GeodesicDisks::run(const JobStage& stage) {
  window_count_ = 0;
  for (; now_->size() > 0 && window_count_ < k_most_windows && !left_tables_; std::swap(now_, next_)) {
    stage.check();
    window_count_ += now_->size();
    advance();
  }
  if (by_count() && !left_tables_) finish_disks();
  if (left_tables_) return false;
  if (walk_) lower_along_borders();
  choose();
  if (sources_ == Sources::points) list_served();
  return now_->size() == 0;
}

/// Lets windows that enter strips cross them. What comes out behind goes on with this generation.
void GeodesicDisks::cross_strips() {
  left_strips_.clear();
  now_->left_count = take_into_strips(now_->lefts, now_->left_count);
  now_->right_count = take_into_strips(now_->rights, now_->right_count);
  for (const auto& [window, lane, root, most] : left_strips_) {
    const Index edge = window.edge;
    left_tables_ |= edge == mesh_.beyond() || !mesh_.laid().is_open(mesh_.origin(edge));
    if (left_tables_) return;
    const int i =
        add_window(lane, {window.ends[1], window.ends[0], mesh_.target(edge), mesh_.origin(edge), edge, root});
    const WindowRows rows = now_->lefts.rows();
    const double left_reach = window.flanks[0].norm(), right_reach = window.flanks[1].norm();
    rows.left_x[i] = static_cast<float>(window.flanks[0].x() / left_reach);
    rows.left_y[i] = static_cast<float>(window.flanks[0].y() / left_reach);
    rows.right_x[i] = static_cast<float>(window.flanks[1].x() / right_reach);
    rows.right_y[i] = static_cast<float>(window.flanks[1].y() / right_reach);
    rows.left_reach[i] = static_cast<float>(left_reach);
    rows.right_reach[i] = static_cast<float>(right_reach);
    rows.left_way[i] = static_cast<float>(window.ways[0]);
    rows.right_way[i] = static_cast<float>(window.ways[1]);
    rows.most[i] = most;
  }
}

/// Returns how many windows are left, which have to pass the next face singly.
int GeodesicDisks::take_into_strips(WindowColumns& windows, int count) {
  const WindowRows rows = windows.rows();
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    const Index edge = rows.edge[i] / k_batch;
    auto end = StripWalk::End::refused;
    StripWindow window;
    if (strips_->place(edge).strip >= 0) {
      const auto flank = [](float reach, float x, float y) { return Vec2(double{reach} * x, double{reach} * y); };
      window = {edge,
                {Vec2(rows.from_x[i], rows.from_y[i]), Vec2(rows.to_x[i], rows.to_y[i])},
                {flank(rows.left_reach[i], rows.left_x[i], rows.left_y[i]),
                 flank(rows.right_reach[i], rows.right_x[i], rows.right_y[i])},
                {rows.left_way[i], rows.right_way[i]}};
      seen_.clear();
      end = walk_->cross(window, seen_);
    }
    if (end == StripWalk::End::refused) {
      windows.move(i, kept++);
      continue;
    }
    const int lane = rows.edge[i] % k_batch;
    for (const StripSighting& sighting : seen_) {
      left_tables_ |= sighting.edge == mesh_.beyond() || !mesh_.laid().is_laid(sighting.node);
      const std::int32_t slot = sighting.node * k_batch + lane;
      add_sighting(slot, sighting.place, sighting.from, sighting.edge * k_batch + lane, rows.root[i]);
      seen_on_borders_[lane].push_back({strips_->along_border(sighting.node), 0, slot});
    }
    if (end == StripWalk::End::behind) left_strips_.push_back({window, lane, rows.root[i], rows.most[i]});
  }
  return kept;
}

/// Lowers labels of what was seen in strips to ways along the border: where windows come from both sides, round a ring,
/// arcs are not kept that are longer than those.
void GeodesicDisks::lower_along_borders() {
  for (int lane = 0; lane < k_batch; ++lane) {
    std::vector<SeenOnBorder>& seen = seen_on_borders_[lane];
    std::ranges::sort(seen, {}, &SeenOnBorder::along);
    for (SeenOnBorder& there : seen) there.way = distance_of(labels_[there.slot]) / scales_[lane];
    for (auto begin = seen.begin(); begin != seen.end();) {
      const auto [from, to] = strips_->loop_at(begin->along);
      const auto end = std::ranges::lower_bound(begin, seen.end(), to, {}, &SeenOnBorder::along);
      const auto lower = [&, from, to](const auto& first, const auto& last) {
        double way = std::numeric_limits<double>::infinity(), along = from;
        for (const bool is_again : {false, true}) {  // round the loop
          for (auto there = first; there != last; ++there) {
            const double gap = std::abs(there->along - along);
            way = there->way = std::min(there->way, way + gap);
            along = there->along;
          }
          if (!is_again) along += first->along < along ? from - to : to - from;
        }
      };
      lower(begin, end);
      lower(std::reverse_iterator(end), std::reverse_iterator(begin));
      begin = end;
    }
    for (const SeenOnBorder& there : seen) {
      const auto way = static_cast<float>(there.way * scales_[lane]);
      labels_[there.slot] = std::min(labels_[there.slot], label_of(way * k_longer, false));
    }
  }
}

/// Sights all windows of this generation, then splits them into the next.
void GeodesicDisks::advance() {
  ++generation_;
  WaveScene scene = wave_scene(mesh_.records(), rule_);
  scene.labels = labels_.data();
  scene.limits = limits_.data();
  constexpr float k_nothing_served = 1e10f;
  if (sources_ == Sources::points) scene.per_detour = k_nothing_served;
  const int before = sighting_count_;
  if (walk_ && sources_ == Sources::nodes) cross_strips();
  sightings_.reserve(sighting_count_ + now_->size() + k_row_padding);
  apexes_.reserve(now_->size() + 2 * k_row_padding);
  // Rows of the right half begin behind the padding of the left one.
  const ApexRows apexes = apexes_.rows(0), right_apexes = apexes_.rows(now_->left_count + k_row_padding);
  const auto sight = by_count() ? kernel_.sight_all : kernel_.sight;
  sighting_count_ = sight(scene, now_->lefts.rows(), now_->left_count, apexes, sightings(), sighting_count_);
  sighting_count_ = sight(scene, now_->rights.rows(), now_->right_count, right_apexes, sightings(), sighting_count_);
  lower_labels(before, sighting_count_);
  if (by_count()) bound_disks();

  next_->left_count = next_->right_count = 0;
  next_->lefts.reserve(now_->size() + k_row_padding);
  next_->rights.reserve(now_->size() + k_row_padding);
  const bool free = sources_ == Sources::nodes && generation_ <= k_free_generations;
  const auto split = by_count() ? kernel_.split_all : free ? kernel_.split_free : kernel_.split;
  const WindowRows lefts = next_->lefts.rows(), rights = next_->rights.rows();
  split(scene, now_->lefts.rows(), now_->left_count, apexes, lefts, &next_->left_count, rights, &next_->right_count);
  split(scene, now_->rights.rows(), now_->right_count, right_apexes, lefts, &next_->left_count, rights,
        &next_->right_count);
  fetch_records(lefts.edge, next_->left_count);
  fetch_records(rights.edge, next_->right_count);
}

/// The next generation looks these up in no order: unless they are on their way by then, that is half of all time.
void GeodesicDisks::fetch_records(const std::int32_t* edges, int count) {
  const EdgeRecord* const records = mesh_.records();
  std::int32_t last = 0;
  for (int i = 0; i < count; ++i) {
    __builtin_prefetch(records + (edges[i] >> k_batch_bits));
    last = std::max(last, edges[i]);
  }
  left_tables_ |= last >> k_batch_bits == mesh_.beyond();
}

void GeodesicDisks::lower_labels(int from, int to) {
  if (by_count()) {
    lower_labels_of<k_batch>(from, to);
  } else {
    lower_labels_of<1>(from, to);
  }
}

/// Tells whether shortest ways may bend at a slot's vertex, so that its label has to be offered to its neighbors.
bool GeodesicDisks::bends(std::int32_t slot, std::int32_t label) const {
  return !makes_arc(label) || mesh_.is_saddle(slot / k_batch);
}

// What is new and what is better cannot be foretold: nothing here depends on it but what is written.
template <int Lists>
void GeodesicDisks::lower_labels_of(int from, int to) {
  const SightingRows rows = sightings();
  const std::int32_t *const slots = rows.slot, *const seen = rows.label;
  std::int32_t* const labels = labels_.data();
  BestArc* const arcs = arcs_.data();
  std::array<std::int32_t*, Lists> ends;
  for (int list = 0; list < Lists; ++list) {
    const std::size_t count = touched_[list].size();
    touched_[list].resize(count + static_cast<std::size_t>(to - from) + 1);
    ends[list] = touched_[list].data() + count;
  }
  for (int i = from; i < to; ++i) {
    const std::int32_t slot = slots[i], label = seen[i], known = labels[slot];
    const BestArc best = arcs[slot];
    const bool is_better = makes_arc(label) & (label < best.label);
    arcs[slot] = {is_better ? label : best.label, is_better ? i : best.sighting};
    labels[slot] = std::min(known, label);
    std::int32_t*& end = ends[slot & (Lists - 1)];
    *end = slot;
    end += known == k_unreached;
    if constexpr (Lists > 1)
      if (label < known && bends(slot, label)) changed_.push_back(slot);
  }
  for (int list = 0; list < Lists; ++list)
    touched_[list].resize(static_cast<std::size_t>(ends[list] - touched_[list].data()));
}

/// Chooses in the order in which they were sighted. As in lower_labels, nothing but what is written depends on what is
/// chosen.
///
/// An arc that is not the shortest way stays as long as others may rely on it: no distance in the graph exceeds the
/// shortest by more than the tolerance, so that longer arcs serve nothing.
void GeodesicDisks::choose() {
  const SightingRows rows = sightings();
  const std::int32_t *const slots = rows.slot, *const seen = rows.label, *const roots = rows.root;
  const std::int32_t* const labels = labels_.data();
  const BestArc* const arcs = arcs_.data();
  const double slack = arc_slack(rule_);
  std::array<float, k_batch> limits;
  for (int lane = 0; lane < k_batch; ++lane) limits[lane] = std::min(limits_[lane], std::numeric_limits<float>::max());
  const std::size_t room = static_cast<std::size_t>(sighting_count_) + k_row_padding;
  std::array<std::int32_t*, k_batch> ends;
  for (int lane = 0; lane < k_batch; ++lane) {
    if (chosen_[lane].size() < room) chosen_[lane].resize(2 * room);
    ends[lane] = chosen_[lane].data();
  }
  for (int i = 0; i < sighting_count_; ++i) {
    const std::int32_t slot = slots[i], lane = slot & (k_batch - 1);
    const BestArc best = arcs[slot];
    const float reach = distance_of(best.label);
    const float limit = limits[lane];
    const bool kept = (reach <= slack * distance_of(labels[slot])) & (reach <= limit);
    const bool is_shortest = (best.sighting == i) & makes_arc(seen[i]);
    // Edges stay even where something shorter, but no arc, was found.
    const bool is_chosen = (is_shortest & kept) | (is_link(roots[i]) & (is_shortest | !kept));
    *ends[lane] = i;
    ends[lane] += is_chosen;
  }
  for (int lane = 0; lane < k_batch; ++lane) {
    chosen_counts_[lane] = static_cast<std::size_t>(ends[lane] - chosen_[lane].data());
    std::fill_n(ends[lane], k_row_padding, 0);
  }
}

/// Each vertex once.
void GeodesicDisks::list_served() {
  const SightingRows rows = sightings();
  const double slack = arc_slack(rule_);
  for (auto& lane : served_) lane.clear();
  for (std::int32_t i = 0; i < sighting_count_; ++i) {
    const std::int32_t slot = rows.slot[i], label = rows.label[i];
    if (makes_arc(label) || label != labels_[slot]) continue;
    if (distance_of(arcs_[slot].label) <= slack * distance_of(label)) continue;
    arcs_[slot] = {label, i};  // both windows beside a vertex on their ray see it: the first does
    served_[slot % k_batch].push_back(i);
  }
}

void GeodesicDisks::clear() {
  changed_.clear();
  for (auto& seen : seen_on_borders_) seen.clear();
  for (auto& slots : touched_) {
    for (const std::int32_t slot : slots) {
      labels_[slot] = k_unreached;
      arcs_[slot].label = k_unreached;
    }
    slots.clear();
  }
}

/// Lowers the radius of a lane's disk to that of the k-th nearest vertex, as far as is known.
bool GeodesicDisks::bound_disk(int lane) {
  const auto& slots = touched_[lane];
  const Index before = nearest_before();
  if (static_cast<Index>(slots.size()) <= before) return false;
  // What lies beyond the radius so far does not count, and is nearly half.
  radii_.resize(slots.size());
  const float limit = limits_[lane];
  auto end = radii_.begin();
  for (const std::int32_t slot : slots) {
    *end = distance_of(labels_[slot]);
    end += *end <= limit;
  }
  if (end - radii_.begin() <= before) return false;
  const auto kth = radii_.begin() + before;
  std::nth_element(radii_.begin(), kth, end);
  const float radius = *kth * k_as_far;
  limits_[lane] = std::min(limit, radius);
  return radius < limit;
}

/// No window is left: distances are final once every bend is known.
void GeodesicDisks::finish_disks() {
  bool smaller = true;
  while (smaller) {
    smaller = false;
    for (int lane = 0; lane < k_batch; ++lane) smaller |= bound_disk(lane);
    relax_bends();
  }
}

void GeodesicDisks::bound_disks() {
  if (generation_ % k_generations_per_bound != k_first_bound) return;
  for (int lane = 0; lane < k_batch; ++lane) bound_disk(lane);
  if (generation_ >= k_blind_generations) bound_blind_disks();
  relax_bends();
}

/// Bounds the disk by edges: in creases fewer than k vertices are in sight: no radius would ever end the windows there.
void GeodesicDisks::bound_blind_disks() {
  std::array<bool, k_batch> blind{};
  for (WindowColumns* side : {&now_->lefts, &now_->rights}) {
    const std::int32_t* const edges = side->rows().edge;
    const int count = side == &now_->lefts ? now_->left_count : now_->right_count;
    for (int i = 0; i < count; ++i) blind[edges[i] % k_batch] = true;
  }
  for (int lane = 0; lane < k_batch; ++lane)
    if (blind[lane] && limits_[lane] == k_infinity) limits_[lane] = radius_by_edges(lane);
}

/// Returns the radius of the disk, from above: the k-th distance by mesh edges from the vertices with labels. The
/// largest number where there are not so many.
float GeodesicDisks::radius_by_edges(int lane) {
  if (by_edges_.empty()) by_edges_.assign(mesh_.node_count(), k_infinity);
  std::vector<std::pair<float, Index>> queue;
  std::vector<Index> reached;
  const auto offer = [&](Index node, float distance) {
    if (distance >= by_edges_[node]) return;
    if (by_edges_[node] == k_infinity) reached.push_back(node);
    by_edges_[node] = distance;
    queue.emplace_back(distance, node);
    std::push_heap(queue.begin(), queue.end(), std::greater<>());
  };
  for (const std::int32_t slot : touched_[lane]) offer(slot / k_batch, distance_of(labels_[slot]));
  float radius = std::numeric_limits<float>::max();
  for (Index left = nearest_before() + 1; !queue.empty();) {
    std::pop_heap(queue.begin(), queue.end(), std::greater<>());
    const auto [distance, node] = queue.back();
    queue.pop_back();
    if (distance > by_edges_[node]) continue;
    if (--left == 0) {
      radius = distance * k_as_far;
      break;
    }
    for_each_neighbor(
        node, [&](Index there, double length) { offer(there, distance + static_cast<float>(scales_[lane] * length)); });
  }
  for (const Index node : reached) by_edges_[node] = k_infinity;
  return radius;
}

/// Relaxes bends: behind saddle vertices windows bring no distances: there, bounds by edges count the vertices of the
/// disk and end the windows that serve nothing. Done only where the disk's radius is known: without it this would flood
/// the mesh.
void GeodesicDisks::relax_bends() {
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

void GeodesicDisks::relax_from(std::int32_t slot) {
  const Index node = slot / k_batch;
  const int lane = slot % k_batch;
  const std::int32_t label = labels_[slot];
  if (distance_of(label) >= limits_[lane] || !bends(slot, label)) return;
  const auto offer = [&](Index target, double length) {
    const std::int32_t there = target * k_batch + lane;
    // Longer by more than rounding: what is collinear stays an arc. Beyond the disk nothing is wanted.
    const std::int32_t bent =
        label_of((distance_of(label) + static_cast<float>(scales_[lane] * length)) * k_longer, false);
    if (bent >= labels_[there] || distance_of(bent) >= limits_[lane]) return;
    if (labels_[there] == k_unreached) touched_[lane].push_back(there);
    labels_[there] = bent;
    changed_.push_back(there);
  };
  for_each_neighbor(node, offer);
}

/// Calls offer(neighbor, length) for the mesh edges about a node.
template <class Offer>
void GeodesicDisks::for_each_neighbor(Index node, Offer&& offer) {
  left_tables_ |= !mesh_.laid().is_open(node);
  if (left_tables_) return;
  for (Index e = mesh_.begin(node); e < mesh_.end(node); ++e) {
    offer(mesh_.target(e), mesh_.length(e));
    if (!mesh_.has_left(e)) offer(mesh_.records()[e].apex, mesh_.apex(e).norm());
  }
}

}  // namespace saddleback
