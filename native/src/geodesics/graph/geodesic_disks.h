#pragma once
// The vertices that sources see about them, found for several sources at a time by whole generations of windows.

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/support/large_array.h"

#include "geodesics/graph/lattice.h"
#include "geodesics/graph/window_columns.h"
#include "geodesics/graph/window_mesh.h"
#include "geodesics/unfolding/strip_walk.h"

namespace saddleback {

/// Holds what a source keeps of the vertices that it sees: with k > 0 those among the k nearest, otherwise those that
/// no way by shorter arcs reaches within the tolerance.
struct DiskRule {
  Index k = 0;
  double tolerance = 0;  ///< relative
  /// Says whether the mesh is a lattice, on which what follows an arc has the same detour again, and nothing averages
  /// out: each must be smaller.
  Lattice lattice = Lattice::none;
};

/// Returns what windows of the rule look up: labels and limits are still to be set.
WaveScene wave_scene(const EdgeRecord* records, const DiskRule& rule);
/// Returns what an arc may be longer by than the shortest way found.
double arc_slack(const DiskRule& rule);

/// Returns by how much the plane of a source is enlarged whose longest edge, in units of the WindowMesh, is that: where
/// all edges about it are shorter than k_small_edges, single precision would lose them, and bounds that are meant for
/// mean edges would keep windows for far too long. A power of two, so that nothing is rounded; 1 on nearly all meshes.
double scale_about(double longest_edge);

/// A source inside a face or on its border, in a plane of its own with the source at the origin.
struct FaceSource {
  double scale;                  ///< scale_about
  std::array<Vec2, 3> corner;    ///< counter-clockwise, in units of the WindowMesh, enlarged by the scale
  std::array<Index, 3> node;     ///< of the corners
  std::array<Index, 3> edge;     ///< from each corner to the next, inside the face
  std::array<Index, 3> entered;  ///< the same from the other side; -1 at the boundary
};

/// Propagates the windows of k_batch sources without any order but that of generations: first every window looks at the
/// far corner of its face, then the vertices' distances are lowered, then every window is split. Filters by upper
/// bounds of distances hold in any order, and since all of a generation sees the same bounds, what is seen does not
/// depend on how many windows are taken at a time, nor on the other sources. Holds scratch memory of O(V); one a
/// thread.
class GeodesicDisks {
 public:
  /// Windows of nodes by accuracy cross `strips` at once, if there are any.
  GeodesicDisks(const WindowMesh& mesh, const WaveKernel& kernel, const DiskRule& rule,
                const BorderStrips* strips = nullptr);

  /// Begins with new sources: nodes, or points of faces, whose sightings tell where the half-edges lie.
  enum class Sources { nodes, points };
  void begin(Sources sources);
  void add_node(int lane, Index node);
  /// Adds what is seen from a point; what lies beyond `limit` (in units of the WindowMesh) is not looked for, but for
  /// the face's corners.
  void add_point(int lane, const FaceSource& source, double limit);
  /// Returns false when windows were so many that it was stopped: no arc is wrong then, but some may be missing. \throw
  /// Cancelled.
  bool run(const JobStage& stage);
  /// Tells whether windows came to where no tables are laid: nothing of the run is to be used then.
  bool left_tables() const { return left_tables_; }
  /// The sightings that make a lane's arcs, in the order in which they were sighted, and k_row_padding more entries
  /// that are valid. The links are always among them.
  std::span<const std::int32_t> chosen(int lane) const { return {chosen_[lane].data(), chosen_counts_[lane]}; }
  /// Returns, of a point, in the same order: the shortest sightings of vertices that no arc is kept to, because a way
  /// over another vertex will do.
  std::span<const std::int32_t> served(int lane) const { return served_[lane]; }
  /// Returns the unit of the places of a lane's sightings.
  double unit(int lane) const { return mesh_.unit() / scales_[lane]; }
  SightingRows sightings() { return sightings_.rows(sources_ == Sources::points); }

  /// Sightings of what a source is linked with by mesh edges or, of a point, by the lines to its face's corners. From a
  /// node: along `edge` or, where that has no half-edge of its own, along the other side of its face.
  struct Link {
    Index edge;
    bool other_side;
  };
  static bool is_link(std::int32_t root) { return root < 0; }
  /// Returns the link of a sighting that is the link of a node.
  static Link link_of(const SightingRows& rows, std::int32_t sighting) {
    return {~rows.root[sighting], rows.edge[sighting] != 0};
  }

 private:
  struct Generation {
    WindowColumns lefts, rights;  ///< children behind left sides, and behind right ones
    int left_count = 0, right_count = 0;
    int size() const { return left_count + right_count; }
  };
  struct BestArc {
    std::int32_t label;     ///< as labels_, of the shortest arc
    std::int32_t sighting;  ///< that makes it
  };
  /// A side of the source's face, seen from it from right to left.
  struct FirstWindow {
    Vec2 right, left;
    Index right_node, left_node;
    Index entered, root;
  };

  void clear();
  void add_link(std::int32_t slot, const Vec2& place, const Vec2& from, std::int32_t edge, std::int32_t root);
  void add_wide_window(int lane, FirstWindow window);
  void add_sighting(std::int32_t slot, const Vec2& place, const Vec2& from, std::int32_t edge, std::int32_t root);
  int add_window(int lane, const FirstWindow& window);
  void cross_strips();
  int take_into_strips(WindowColumns& windows, int count);
  void lower_along_borders();
  void advance();
  void fetch_records(const std::int32_t* edges, int count);
  void lower_labels(int from, int to);
  template <int Lists>
  void lower_labels_of(int from, int to);
  void choose();
  void list_served();

  bool by_count() const { return rule_.k > 0; }
  /// Returns how many are nearer than the last vertex of a disk: a node is its own nearest.
  Index nearest_before() const { return sources_ == Sources::nodes ? rule_.k : rule_.k - 1; }
  bool bound_disk(int lane);
  void finish_disks();
  void bound_disks();
  void bound_blind_disks();
  float radius_by_edges(int lane);
  void relax_bends();
  bool bends(std::int32_t slot, std::int32_t label) const;
  void relax_from(std::int32_t slot);
  template <class Offer>
  void for_each_neighbor(Index node, Offer&& offer);

  const WindowMesh& mesh_;
  const WaveKernel& kernel_;
  DiskRule rule_;
  Sources sources_ = Sources::nodes;
  LargeArray<std::int32_t> labels_;  ///< per slot: bits of the distance, the lowest one set when it makes no arc
  LargeArray<BestArc> arcs_;         ///< per slot
  /// Slots with labels: per lane where disks end by count, otherwise all in the first list.
  std::array<std::vector<std::int32_t>, k_batch> touched_;
  std::array<Generation, 2> generations_;
  Generation* now_ = generations_.data();
  Generation* next_ = generations_.data() + 1;
  ApexColumns apexes_;
  SightingColumns sightings_;
  int sighting_count_ = 0, generation_ = 0, window_count_ = 0;
  bool left_tables_ = false;
  alignas(64) std::array<float, k_batch> limits_{};
  std::array<double, k_batch> scales_{};  ///< of the lanes' planes, see scale_about
  std::vector<std::int32_t> changed_;     ///< slots whose labels may have to be offered to neighbors
  std::vector<float> radii_;
  std::vector<float> by_edges_;  ///< per node, where a disk was bounded by edges; infinite in between
  std::array<std::vector<std::int32_t>, k_batch> chosen_;  ///< with room behind what was chosen
  std::array<std::size_t, k_batch> chosen_counts_{};
  std::array<std::vector<std::int32_t>, k_batch> served_;

  const BorderStrips* strips_ = nullptr;  ///< null where windows pass all faces singly
  std::optional<StripWalk> walk_;
  std::vector<StripSighting> seen_;  ///< in a strip
  struct LeftStrip {
    StripWindow window;
    int lane;
    std::int32_t root;
    float most;
  };
  std::vector<LeftStrip> left_strips_;
  struct SeenOnBorder {
    double along, way;
    std::int32_t slot;
  };
  std::array<std::vector<SeenOnBorder>, k_batch> seen_on_borders_;
};

}  // namespace saddleback
