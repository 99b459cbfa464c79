#pragma once
// Which site is nearest to which vertex, by the graph.

#include <optional>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/graph_search_cuda.h"
#include "tessellation/log_map/seen_vertices.h"
#include "tessellation/log_map/vertex_rings.h"

namespace saddleback {

/// Labels every node of the graph with its nearest site, and groups nodes by label. Where few sites move, few labels
/// are found anew; labels are the same in either case.
class SiteLabels {
 public:
  /// Nothing is known before `find`. Both must outlive the labels. A CUDA device, unless it is below 0, finds the
  /// labels where all are made anew.
  SiteLabels(const SaddleVertexGraph& graph, const VertexRings& rings, int cuda_device)
      : graph_(graph), rings_(rings), cuda_device_(cuda_device) {}

  /// Begins with new sites. `others`: those that are not as they were the last time; the cells whose site and nodes are
  /// as they were stay so, unless most are not; without a value all are made anew.
  void begin(const SurfacePoints& sites, const std::optional<std::vector<Index>>& others);
  /// Labels the nodes by what the sites see. \throw Cancelled, DeviceError, and then holds nothing to keep. O(arcs), of
  /// the cells that are made anew.
  void find(const SeenFromSites& seen, const std::optional<std::vector<Index>>& others, int threads,
            const JobStage& stage);
  /// Gives the sites of the last time other numbers, for the next time: site i was before[i], in increasing order, or
  /// k_none for new ones; those not named are gone. O(V).
  void renumber(std::span<const Index> before);

  const SurfacePoints& sites() const { return sites_; }
  Index node_count() const { return static_cast<Index>(label_.size()); }
  Index site_count() const { return static_cast<Index>(sites_.size()); }
  /// The sites in an order in which cells one after the other use the same memory.
  const std::vector<Index>& sites_along_curve() const { return order_; }
  /// Tells whether the cell is as it was before the last sites.
  bool is_kept(Index site) const { return is_kept_[site] != 0; }
  std::span<const std::uint8_t> kept() const { return is_kept_; }
  bool keeps_any() const { return keeps_any_; }
  /// The nearest site; ties: the smaller.
  Index label(Index node) const { return label_[node]; }
  /// Distance from there, in the graph.
  double distance(Index node) const { return distance_[node]; }
  /// The nodes of a label.
  std::span<const Index> nodes(Index site) const {
    return {nodes_.data() + first_node_[site], nodes_.data() + first_node_[site + 1]};
  }
  /// Sorts the nodes of a label by distance, then number. Safe for several sites at once.
  std::span<const Index> sort_by_distance(Index site);

 private:
  void label_all(const SeenFromSites& seen, int threads, const JobStage& stage);
  void label_what_is_seen(const SeenFromSites& seen, int threads);
  void label_again(const SeenFromSites& seen, std::span<const Index> moved, const JobStage& stage);
  void group_all(int threads);
  void group_again(std::span<const Index> moving);

  const SaddleVertexGraph& graph_;
  const VertexRings& rings_;
  const int cuda_device_;
  SurfacePoints sites_;
  std::vector<Index> order_;
  std::vector<std::uint8_t> is_kept_;  ///< by site
  bool keeps_any_ = false;
  std::vector<Index> bare_;  ///< nodes of sites that are gone
  std::vector<Index> label_;
  std::vector<double> distance_;           ///< in the graph
  std::vector<Index> nodes_, first_node_;  ///< by label
  FlatSeeds seeds_;                        ///< for a device
};

}  // namespace saddleback
