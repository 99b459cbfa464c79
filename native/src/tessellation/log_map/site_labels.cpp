// Method: labels by shortest paths in the graph, from the vertices that sites see.

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "geodesics/queries/parted_search.h"
#include "support/threads/parallel.h"
#include "tessellation/log_map/relabeling.h"
#include "tessellation/log_map/site_maps.h"

namespace saddleback {

void SiteMaps::label_all(int threads, const JobStage& stage) {
  bare_.clear();
  if (cuda_device_ >= 0) {
    cuda_nearest_sources(graph_, cuda_device_, flat_seeds(threads), stage, distance_, label_);
  } else {
    label_what_is_seen(threads);
    if (!sweep_labels(threads, stage)) search_labels(threads, stage);
  }
  group_nodes(threads);
}

/// The nearest of the sites that have an arc to a node. Each thread has a stretch of the nodes.
void SiteMaps::label_what_is_seen(int threads) {
  constexpr Index k_least_stretch = 4096;
  const Index count = mesh_.vertex_count();
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
      const Fan& fan = fans_[site];
      if (fan.center != k_none) offer(fan.center, site, 0);
      if (fan.last < first || fan.first >= last) continue;  // of another part of the surface
      for (std::size_t i = 0; i < fan.arc_count; ++i) offer(fan.nodes[i], site, fan.rounded[i]);
    }
  });
}

/// False where it does not pay, or has not led everywhere.
bool SiteMaps::sweep_labels(int threads, const JobStage& stage) {
  constexpr Index k_most_nodes = 32;  // a site: cells of more are found sooner from bucket to bucket
  if (std::int64_t{k_most_nodes} * site_count() < mesh_.vertex_count()) return false;
  if (!std::exchange(has_labeled_, true)) return false;  // the tables pay from the second time on
  if (!sweep_) sweep_.emplace(graph_, threads, stage);
  return sweep_->run(distance_, label_, stage);
}

/// From what has a label.
void SiteMaps::search_labels(int threads, const JobStage& stage) {
  const auto seeds_of = [&](Index first, Index last, std::vector<NodeSeed>& seeds) {
    for (Index node = first; node < last; ++node)
      if (label_[node] != k_none) seeds.push_back({node, label_[node], distance_[node]});
  };
  nearest_sources(graph_, seeds_of, threads, stage, distance_, label_);
}

/// All fans', one after the other, in memory that is kept: fresh pages take longer than the seeds.
const FlatSeeds& SiteMaps::flat_seeds(int threads) {
  std::vector<std::size_t> first{0};
  for (const Fan& fan : fans_) first.push_back(first.back() + fan.arc_count + (fan.center != k_none ? 1 : 0));
  seeds_.resize(first.back());
  parallel_for(site_count(), threads, 64, [&](Index site, int) {
    std::size_t at = first[site];
    const Fan& fan = fans_[site];
    for (std::size_t i = 0; i < fan.arc_count; ++i) seeds_.set(at++, {fan.nodes[i], site, fan.rounded[i]});
    if (fan.center != k_none) seeds_.set(at, {fan.center, site, 0});
  });
  return seeds_;
}

/// What was nearest to sites that have moved, and what is nearer to them now.
void SiteMaps::label_again(std::span<const Index> moved, const JobStage& stage) {
  std::vector<Index> loose = std::exchange(bare_, {});
  for (const Index site : moved) {
    const auto own = nodes(site);
    loose.insert(loose.end(), own.begin(), own.end());
  }
  Relabeling search(graph_, distance_, label_);
  search.loosen(loose);
  for (Index site = 0; site < site_count(); ++site) {
    const Fan& fan = fans_[site];
    if (fan.center != k_none) search.offer(fan.center, site, 0);
    for (std::size_t i = 0; i < fan.arc_count; ++i) search.offer(fan.nodes[i], site, fan.rounded[i]);
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

/// All nodes of cells that are made anew are `moving`.
void SiteMaps::group_again(std::span<const Index> moving) {
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

void SiteMaps::renumber(std::span<const Index> before) {
  const auto count = static_cast<Index>(before.size());
  std::vector<Index> now(sites_.size(), k_none), first{0}, grouped;
  SurfacePoints sites(count, {k_none, Vec3::Zero()});
  std::vector<Fan> fans(count);
  std::vector<double> limits(count, 0);
  grouped.reserve(nodes_.size());
  for (Index site = 0; site < count; ++site) {
    if (const Index old = before[site]; old != k_none) {
      now[old] = site;
      sites[site] = sites_[old];
      fans[site] = std::move(fans_[old]);
      limits[site] = limits_[old];
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
  fans_.swap(fans);
  limits_.swap(limits);
  first_node_.swap(first);
  nodes_.swap(grouped);
}

/// Each thread counts, and later places, its own stretch of the nodes: a label's nodes are in their order.
void SiteMaps::group_nodes(int threads) {
  constexpr Index k_least_stretch = 1 << 14;
  const auto sites = static_cast<std::size_t>(site_count());
  const Index count = mesh_.vertex_count(), worth_it = count / std::max(k_least_stretch, site_count());
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

/// The order of the last time has what is next to each other now nearly in order already.
void SiteMaps::order_sites() {
  if (order_.size() != sites_.size()) {
    order_.resize(sites_.size());
    std::iota(order_.begin(), order_.end(), 0);
  }
  std::vector<std::pair<Index, Index>> keys;
  keys.reserve(order_.size());
  for (const Index site : order_) keys.emplace_back(rings_.face_of(sites_[site].face), site);
  std::ranges::sort(keys);
  std::ranges::transform(keys, order_.begin(), &std::pair<Index, Index>::second);
}

}  // namespace saddleback
