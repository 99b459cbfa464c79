#pragma once
// Where vertices lie in the tangent planes of the sites: the discrete logarithm map of each cell.

#include <optional>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/graph_search_cuda.h"
#include "geodesics/queries/nearest_sweep.h"
#include "geodesics/queries/point_arcs.h"
#include "geodesics/unfolding/arc_unfolding.h"
#include "tessellation/log_map/packed_vector.h"
#include "tessellation/log_map/vertex_rings.h"

namespace saddleback {

/// Where a vertex lies, seen from a site.
struct SiteVector {
  PackedVec2 log = PackedVec2::Zero();  ///< in the site's tangent plane; as long as the distance, to rounding
  double distance = 0;
};

/// What a site's distances to vertices are that it does not see: lengths of ways in the graph, which are never too
/// short but leap a little where sites move; or, for a relaxation, lengths in its own plane, which do not leap and
/// differ from those by less than the graph's error, on either side.
enum class CellLengths { of_ways, smooth };

/// Labels every vertex with its nearest site by the graph and places it in that site's tangent plane.
///
/// A path in the graph may bend at a vertex where a shortest path would not (an angle below pi on one side). Vertices
/// are therefore placed one after another, by distance: straight from the site where an arc of its own leads there,
/// else beyond an edge whose ends are placed (the site seen across that edge in one plane), else after the vertex
/// before on the path, its bend developed. So the distance is the straight one, exactly so on flat parts. Where a bend
/// is legal at a vertex with much excess of angle (a saddle, a reflex boundary), that vertex becomes the anchor of what
/// lies behind: distances go on from it, and directions at the site are its own.
///
/// The plane's axes are those of the site's FaceChart or, for a site that is a vertex, of its first half-edge, with
/// angles scaled to 2 pi when it is not on the boundary.
class SiteMaps {
  struct Place {
    Vec2 at = Vec2::Zero();  ///< from the anchor, in its plane; as seen, see above
    double distance = 0;     ///< from the site, never less than it is
    Index anchor = k_none;   ///< node from which it is seen straight on; k_none: the site
    Index found_by = 0;      ///< a wedge across whose edge it was placed, or one of the below
  };
  static constexpr Index k_unplaced = -1, k_straight = -2, k_after_another = -3, k_center = -4;

 public:
  /// Nothing is known before label_nodes. Both must outlive the maps. A CUDA device, unless it is below 0, finds the
  /// labels where all are made anew.
  SiteMaps(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int cuda_device);
  bool is_smooth() const { return lengths_ == CellLengths::smooth; }

  /// Begins with new sites. `reaches`: for each site how far it is asked for arcs of its own, which are most of the
  /// work where cells are small, or somewhat farther; empty: without end. What lies beyond is placed as what is hidden
  /// from the site.
  ///
  /// `others`: sites that are not as they were the last time, since when all cells were placed. The cells whose site
  /// and nodes are as they were stay so, unless most are not; without a value all are made anew. Labels are the same in
  /// either case. \throw Cancelled, DeviceError, and then holds nothing to keep. O(sites k log k + arcs), of the cells
  /// that are made anew.
  void label_nodes(const SurfacePoints& sites, std::span<const double> reaches,
                   const std::optional<std::vector<Index>>& others, int threads, const JobStage& stage);
  /// Whether the cell is as it was before the last call of label_nodes; else it must be placed.
  bool is_kept(Index site) const { return is_kept_[site] != 0; }
  bool keeps_any() const { return keeps_any_; }
  /// Of the last call of label_nodes.
  const SurfacePoints& sites() const { return sites_; }
  /// How far a site was asked for arcs.
  double limit(Index site) const { return limits_[site]; }
  /// Gives the sites of the last time other numbers, for the next time: site i was before[i], in increasing order, or
  /// k_none for new ones; those not named are gone. O(V).
  void renumber(std::span<const Index> before);

  // Vertices are the graph's nodes from here on.
  const SaddleVertexGraph& graph() const { return graph_; }
  const VertexRings& rings() const { return rings_; }
  Index site_count() const { return static_cast<Index>(sites_.size()); }
  /// Nearest site by the graph; ties: the smaller.
  Index label(Index node) const { return label_[node]; }
  /// The sites in an order in which cells one after the other use the same memory.
  const std::vector<Index>& sites_along_curve() const { return order_; }
  /// The nodes of a label; by distance, once they are placed.
  std::span<const Index> nodes(Index site) const {
    return {nodes_.data() + first_node_[site], nodes_.data() + first_node_[site + 1]};
  }

  /// For tables of what is known of a site and a node: those next to each other fall into different slots.
  static std::size_t slot_of(Index site, Index node) {
    return static_cast<std::size_t>(node) + 97 * static_cast<std::size_t>(site);
  }

  /// Memory of a caller that asks for more; one a thread.
  struct Scratch {
    explicit Scratch(const SiteMaps& maps)
        : unfolder(maps.graph_.unfolding()), beside(k_beside), table(maps.graph_.mesh().vertex_count()) {}
    ArcUnfolder unfolder;
    UnfoldedArc unfolded;

    /// A vertex beside a cell is asked for by several faces: the last answers are kept.
    struct Beside {
      Index node = k_none, site = k_none;
      std::uint32_t age = 0;
      bool found = false;
      Place place;
    };
    static constexpr std::size_t k_beside = 1024;
    std::vector<Beside> beside;
    std::uint32_t age = 0;  ///< answers of earlier ones are forgotten

    /// What is known of the nodes about the last site: which of its fan they are or, below 0, ~ of the answer.
    struct Known {
      std::uint32_t round = 0;
      Index at = 0;
    };
    struct Answer {
      bool found;
      SiteVector vector;
    };
    Index site = k_none;      ///< placed last
    std::uint32_t round = 0;  ///< counts them
    std::vector<Known> table;
    std::vector<Answer> answers;
    /// Before other sites are labeled.
    void forget();
  };
  /// Asks memory for what place_cell looks up: cells have few nodes, so that while one is placed the next is fetched.
  void fetch_cell(Index site) const;
  /// Places the nodes of a label, once. What is asked for this site next is found faster.
  void place_cell(Index site, Scratch& scratch);
  /// From the site of its label, which must have been placed.
  SiteVector own(Index node) const { return vector_of(places_[node]); }
  /// Asks memory for the place of a node that is looked at soon.
  void fetch(Index node) const { __builtin_prefetch(&places_[node]); }
  double own_distance(Index node) const { return places_[node].distance; }
  /// From a site that has been placed, near whose cell the node lies. Depends on the node and the site alone: faces
  /// that share an edge get the same bits. False where the node is neither seen straight from the site nor next to a
  /// node of its label.
  bool find(Index site, Index node, Scratch& scratch, SiteVector& vector) const;
  /// Beyond an edge whose ends are known, the third corner of the half-edge's face laid in the plane, if it is seen
  /// there in truth: the site and the ends make a flat triangle, and the way to the corner crosses the edge. Where
  /// lengths are smooth, wherever the ends are.
  std::optional<PackedVec2> seen_beyond(Index halfedge, const PackedVec2& from, const PackedVec2& to) const;
  /// Calls visit(node, PackedVec2) for what a site sees straight: no longer than it is, and nothing that is hidden.
  template <class Visit>
  void visit_seen(Index site, Visit&& visit) const;

 private:
  using Wedge = VertexRings::Wedge;
  /// As SeenNodes. What is no arc is where it is seen, but labels are the graph's. What is looked at of all nodes lies
  /// apart from what few are asked for.
  struct Fan {
    std::vector<Index> nodes;
    std::vector<double> rounded;     ///< lengths as the graph's arcs are, for labels
    std::vector<PackedVec2> places;  ///< not rounded: that depends on the scale, which must not show in the cells
    std::size_t arc_count = 0;       ///< those are the first
    struct Across {
      PackedVec2 from;
      Index edge;
    };
    std::vector<Across> across;    ///< SeenNode::edge and its start
    Index center = k_none;         ///< the node that the site is
    std::array<Index, 3> corners;  ///< of its face
    Index first = 0, last = -1;    ///< the least and the greatest of the nodes
    void resize(std::size_t count);
    void set(std::size_t i, const SeenNode& node, double length_rounded);
    /// The first `count` are arcs.
    void set_arcs(std::ptrdiff_t count);
  };
  /// The anchor of an edge's ends, both placed from it, seen across the edge from the third corner.
  struct Sight {
    Vec2 anchor, ray;      ///< in the frame of the half-edge; from the anchor to the corner
    double distance = 0;   ///< the ray's length
    double beyond = 0;     ///< by how much of the edge's length the ray passes the edge's ends; below 0 past its start
    bool is_flat = false;  ///< nothing bends the surface between the anchor and the edge, nor the ray
  };

  void label_all(int threads, const JobStage& stage);
  void label_what_is_seen(int threads);
  bool sweep_labels(int threads, const JobStage& stage);
  void search_labels(int threads, const JobStage& stage);
  const FlatSeeds& flat_seeds(int threads);
  void label_again(std::span<const Index> moved, const JobStage& stage);
  void make_fans(std::span<const double> reaches, int threads, const JobStage& stage);
  void make_fan_at_vertex(Fan& fan);
  void group_nodes(int threads);
  void group_again(std::span<const Index> moving);
  void order_sites();
  std::optional<Vec2> seen_truly(Index site, Index node, const Vec2& place) const;
  Index find_in_fan(Index site, Index node) const;
  Index find_seen(Index site, Index node, const Scratch& scratch) const;
  static Place place_straight(const Vec2& place) { return {place, place.norm(), k_none, k_straight}; }
  Index node_before(Index node, Index site, double shortest) const;
  Place place_after(Index node, Index previous, Scratch& scratch) const;
  Place place_after(Index node, Index previous, const Place& before, double back, Scratch& scratch) const;
  bool place_own(Index node, Index site, Place& place) const;
  bool place_beside(Index node, Index site, Scratch* deep, Place& place) const;
  bool beside_own(Index node, Index site, Scratch& scratch, Place& place) const;
  const Place* end_of_edge(Index node, Index site, Scratch* deep, Place& place) const;
  static bool see(const Wedge& wedge, const Place& from, const Place& to, Sight& sight);
  Place place_by(const Sight& sight, const Wedge& wedge, const Place& from, const Place& to) const;
  std::optional<double> line_to_anchor(const Wedge& wedge, const Sight& sight, Index anchor, Index site) const;
  double direction_back(Index node, Scratch& scratch) const;
  double direction_back_to(Index site, Index seen) const;
  bool place_near(Index node, Index site, Scratch& scratch, SiteVector& vector) const;
  bool place_by_cell(Index node, Index site, Scratch& scratch, Place& place) const;
  bool place_by_arc(Index node, Index site, Scratch& scratch, bool has_direction, Place& place) const;
  Place place_after_seen(Index node, Index site, Index seen, Scratch& scratch) const;
  bool lies_flat(Index node, Index site, const Place& place, const Scratch* scratch) const;
  bool in_own_face(Index node, Index site, SiteVector& vector) const;
  SiteVector vector_of(const Place& place) const;
  double anchor_distance(const Place& place) const {
    return place.anchor == k_none ? 0 : places_[place.anchor].distance;
  }
  bool is_anchor(Index vertex, double back, double out) const;

  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const VertexRings& rings_;
  const CellLengths lengths_;
  const int cuda_device_;
  double slack_;  ///< how far below the graph's a distance may be, relative
  const bool is_flat_disk_;
  SurfacePoints sites_;
  std::vector<Index> order_;
  std::vector<Fan> fans_;
  std::vector<double> limits_;         ///< of the fans' lengths
  std::vector<std::uint8_t> is_kept_;  ///< by site
  bool keeps_any_ = false;
  std::vector<Index> bare_;  ///< nodes of sites that are gone
  std::vector<Index> label_;
  std::vector<double> distance_;  ///< in the graph
  bool has_labeled_ = false;      ///< and may do so again
  std::optional<NearestSweep> sweep_;
  std::vector<Index> nodes_, first_node_;  ///< by label
  FlatSeeds seeds_;                        ///< for a device
  LargeArray<Place> places_;
};

template <class Visit>
void SiteMaps::visit_seen(Index site, Visit&& visit) const {
  const Fan& fan = fans_[site];
  if (fan.center != k_none) visit(fan.center, PackedVec2(PackedVec2::Zero()));
  for (std::size_t i = 0; i < fan.nodes.size(); ++i) visit(fan.nodes[i], fan.places[i]);
  SiteVector vector;
  for (const Index node : fan.corners)
    if (in_own_face(node, site, vector)) visit(node, vector.log);
}

}  // namespace saddleback
