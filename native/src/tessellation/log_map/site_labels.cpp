// Method: labels by shortest paths in the graph, from the vertices that sites see.

#include "tessellation/log_map/site_labels.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "geodesics/queries/parted_search.h"
#include "support/threads/parallel.h"
#include "tessellation/log_map/relabeling.h"

namespace saddleback {
namespace {

/// Lists what all sites see, one after the other, in memory that is kept: fresh pages take longer than the seeds.
void list_seeds(const SeenFromSites& sites, Index site_count, int threads, FlatSeeds& seeds) {
  std::vector<std::size_t> first{0};
  for (Index site = 0; site < site_count; ++site)
    first.push_back(first.back() + sites.of(site).arc_count + (sites.of(site).center != k_none ? 1 : 0));
  seeds.resize(first.back());
  parallel_for(site_count, threads, 64, [&](Index site, int) {
    std::size_t at = first[site];
    const SeenVertices& seen = sites.of(site);
    for (std::size_t i = 0; i < seen.arc_count; ++i) seeds.set(at++, {seen.nodes[i], site, seen.rounded[i]});
    if (seen.center != k_none) seeds.set(at, {seen.center, site, 0});
  });
}

/// Sorts sites along the curve of the faces. The order of the last time has what is next to each other now nearly in
/// order already.
void order_sites(const SurfacePoints& sites, const VertexRings& rings, std::vector<Index>& order) {
  if (order.size() != sites.size()) {
    order.resize(sites.size());
    std::iota(order.begin(), order.end(), 0);
  }
  std::vector<std::pair<Index, Index>> keys;
  keys.reserve(order.size());
  for (const Index site : order) keys.emplace_back(rings.face_of(sites[site].face), site);
  std::ranges::sort(keys);
  std::ranges::transform(keys, order.begin(), &std::pair<Index, Index>::second);
}

}  // namespace

void SiteLabels::begin(const SurfacePoints& sites, const std::optional<std::vector<Index>>& others) {
  keeps_any_ = others && 2 * others->size() <= sites.size();  // else labels are found as soon from the start
  sites_ = sites;
  order_sites(sites_, rings_, order_);
  is_kept_.assign(sites.size(), keeps_any_);
  if (keeps_any_)
    for (const Index site : *others) is_kept_[site] = 0;
}

void SiteLabels::find(const SeenFromSites& seen, const std::optional<std::vector<Index>>& others, int threads,
                      const JobStage& stage) {
  if (keeps_any_) return label_again(seen, *others, stage);
  label_all(seen, threads, stage);
}

void SiteLabels::label_all(const SeenFromSites& seen, int threads, const JobStage& stage) {
  bare_.clear();
  if (cuda_device_ >= 0) {
    list_seeds(seen, site_count(), threads, seeds_);
    cuda_nearest_sources(graph_, cuda_device_, seeds_, stage, distance_, label_);
  } else {
    label_what_is_seen(seen, threads);
    const auto seeds_of = [&](Index first, Index last, std::vector<NodeSeed>& seeds) {
      for (Index node = first; node < last; ++node)
        if (label_[node] != k_none) seeds.push_back({node, label_[node], distance_[node]});
    };
    nearest_sources(graph_, seeds_of, threads, stage, distance_, label_);
  }
  group_all(threads);
}

/// Labels a node with the nearest of the sites that have an arc to it. Each thread has a stretch of the nodes.
void SiteLabels::label_what_is_seen(const SeenFromSites& sites, int threads) {
  constexpr Index k_least_stretch = 4096;
  const Index count = graph_.mesh().vertex_count();
  const Index stretches = std::clamp(count / k_least_stretch, 1, thread_count(threads));
  distance_.resize(count);
  label_.resize(count);
  const auto end = [&](Index stretch) { return static_cast<Index>(std::int64_t{count} * stretch / stretches); };
  parallel_for(stretches, threads, 1, [&](Index stretch, int) {
    const Index first = end(stretch), last = end(stretch + 1);
    std::fill(distance_.begin() + first, distance_.begin() + last, std::numeric_limits<double>::infinity());
    std::fill(label_.begin() + first, label_.begin() + last, k_none);
    const auto offer = [&](Index node, Index site, double distance) {
      if (node < first || node >= last || distance > distance_[node]) return;
      if (distance == distance_[node] && site >= label_[node]) return;
      distance_[node] = distance;
      label_[node] = site;
    };
    for (const Index site : order_) {
      const SeenVertices& seen = sites.of(site);
      if (seen.center != k_none) offer(seen.center, site, 0);
      if (seen.last < first || seen.first >= last) continue;  // of another part of the surface
      for (std::size_t i = 0; i < seen.arc_count; ++i) offer(seen.nodes[i], site, seen.rounded[i]);
    }
  });
}

/// Labels anew what was nearest to sites that have moved, and what is nearer to them now.
void SiteLabels::label_again(const SeenFromSites& sites, std::span<const Index> moved, const JobStage& stage) {
  std::vector<Index> loose = std::exchange(bare_, {});
  for (const Index site : moved) {
    const auto own = nodes(site);
    loose.insert(loose.end(), own.begin(), own.end());
  }
  Relabeling search(graph_, distance_, label_);
  search.loosen(loose);
  for (Index site = 0; site < site_count(); ++site) {
    const SeenVertices& seen = sites.of(site);
    if (seen.center != k_none) search.offer(seen.center, site, 0);
    for (std::size_t i = 0; i < seen.arc_count; ++i) search.offer(seen.nodes[i], site, seen.rounded[i]);
  }
  std::vector<std::uint8_t> moves(site_count(), 0);  // its nodes, away or here
  for (const Index site : moved) moves[site] = 1;
  std::vector<Index> moving = std::move(loose);
  search.run(stage, [&](Index site) {
    if (std::exchange(moves[site], 1) != 0) return;
    const auto own = nodes(site);
    moving.insert(moving.end(), own.begin(), own.end());
  });
  for (Index site = 0; site < site_count(); ++site) is_kept_[site] = moves[site] == 0;
  group_again(moving);
}

/// Groups the nodes anew; `moving` are those of cells that are made anew.
void SiteLabels::group_again(std::span<const Index> moving) {
  std::vector<Index> first(site_count() + 1, 0), grouped(label_.size());
  for (const Index node : moving) ++first[label_[node] + 1];
  for (Index site = 0; site < site_count(); ++site)
    first[site + 1] = first[site] + (is_kept(site) ? static_cast<Index>(nodes(site).size()) : first[site + 1]);
  for (Index site = 0; site < site_count(); ++site)
    if (is_kept(site)) std::ranges::copy(nodes(site), grouped.begin() + first[site]);
  std::vector<Index> cursor(first.begin(), first.end() - 1);
  for (const Index node : moving) grouped[cursor[label_[node]]++] = node;
  first_node_.swap(first);
  nodes_.swap(grouped);
}

void SiteLabels::renumber(std::span<const Index> before) {
  const auto count = static_cast<Index>(before.size());
  std::vector<Index> now(sites_.size(), k_none), first{0}, grouped;
  SurfacePoints sites(count, {k_none, Vec3::Zero()});
  grouped.reserve(nodes_.size());
  for (Index site = 0; site < count; ++site) {
    if (const Index old = before[site]; old != k_none) {
      now[old] = site;
      sites[site] = sites_[old];
      const auto own = nodes(old);
      grouped.insert(grouped.end(), own.begin(), own.end());
    }
    first.push_back(static_cast<Index>(grouped.size()));
  }
  for (Index node = 0; node < static_cast<Index>(label_.size()); ++node) {
    if (label_[node] == k_none) continue;  // bare already
    label_[node] = now[label_[node]];
    if (label_[node] == k_none) bare_.push_back(node);
  }
  std::ranges::transform(order_, order_.begin(), [&](Index old) { return now[old]; });
  std::erase(order_, k_none);
  for (Index site = 0; site < count; ++site)
    if (before[site] == k_none) order_.push_back(site);
  sites_.swap(sites);
  first_node_.swap(first);
  nodes_.swap(grouped);
}

/// Groups the nodes by label. Each thread counts, and later places, its own stretch of the nodes: a label's nodes are
/// in their order.
void SiteLabels::group_all(int threads) {
  constexpr Index k_least_stretch = 1 << 14;
  const auto sites = static_cast<std::size_t>(site_count());
  const Index count = graph_.mesh().vertex_count(), worth_it = count / std::max(k_least_stretch, site_count());
  const Index stretches = std::clamp(worth_it, 1, thread_count(threads));
  const auto begin = [&](Index stretch) { return static_cast<Index>(std::int64_t{count} * stretch / stretches); };
  std::vector<Index> cursors(static_cast<std::size_t>(stretches) * sites, 0);
  const auto in_stretches = [&](auto&& visit) {
    parallel_for(stretches, threads, 1, [&](Index stretch, int) {
      Index* const cursor = &cursors[static_cast<std::size_t>(stretch) * sites];
      for (Index node = begin(stretch); node < begin(stretch + 1); ++node) visit(node, cursor[label_[node]]);
    });
  };
  in_stretches([](Index, Index& cursor) { ++cursor; });
  first_node_.assign(sites + 1, 0);
  for (std::size_t site = 0; site < sites; ++site) {
    Index next = first_node_[site];
    for (std::size_t at = site; at < cursors.size(); at += sites) next += std::exchange(cursors[at], next);
    first_node_[site + 1] = next;
  }
  nodes_.resize(label_.size());
  in_stretches([&](Index node, Index& cursor) { nodes_[cursor++] = node; });
}

std::span<const Index> SiteLabels::sort_by_distance(Index site) {
  const std::span<Index> own{nodes_.data() + first_node_[site], nodes_.data() + first_node_[site + 1]};
  std::ranges::sort(
      own, [&](Index a, Index b) { return distance_[a] != distance_[b] ? distance_[a] < distance_[b] : a < b; });
  return own;
}

}  // namespace saddleback
