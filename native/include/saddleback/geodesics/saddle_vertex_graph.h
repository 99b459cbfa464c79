#pragma once
// The Saddle Vertex Graph [ying2013]: geodesic distances as shortest paths in a sparse graph.

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_curve.h"
#include "saddleback/mesh/surface_points.h"
#include "saddleback/support/device_times.h"

namespace saddleback {

class ArcCodec;
class ArcRows;
class QueryCache;
class Unfolding;
struct ArcHint;
struct WaveKernel;

/// Holds how a graph is built: by one of k, accuracy and exact; by k_default_accuracy when none is given.
struct SaddleVertexGraphOptions {
  Index k = 0;                         ///< vertices per geodesic disk, not counting the center
  double accuracy = 0;                 ///< largest relative error of a distance that is accepted
  bool exact = false;                  ///< all straight geodesics: exact between vertices, and much larger
  int threads = 0;                     ///< 0: all cores; the result does not depend on it
  std::vector<int> cuda_devices = {};  ///< numbers of those that find the arcs, a part each; none: the processor does
  bool is_pinned = false;              ///< whether arcs that those find come into pinned memory, which is kept
  std::string instructions = "auto";   ///< "avx512", "avx2", "plain", "neon": the result does not depend on it
  static constexpr double k_default_accuracy = 5e-3;
};

enum class QueryMethod { label_correcting, dijkstra };

struct QueryOptions {
  double limit = std::numeric_limits<double>::infinity();  ///< vertices farther than this stay at infinity
  QueryMethod method = QueryMethod::label_correcting;
  /// Number of the CUDA device that searches, -1: the processor does. The result does not depend on it. Of `distances`,
  /// `nearest` and `fields`.
  int cuda_device = -1;
};

/// Holds where distances are measured from. Sources are counted points first, then curves.
struct QuerySources {
  SurfacePoints points;
  std::vector<const SurfaceCurve*> curves;  ///< on the graph's mesh: the distance is to the curve, not to its points
  explicit QuerySources(SurfacePoints the_points) : points(std::move(the_points)) {}
  explicit QuerySources(std::vector<const SurfaceCurve*> the_curves) : curves(std::move(the_curves)) {}
  std::size_t size() const { return points.size() + curves.size(); }
};

/// Fields of many sources.
struct DistanceFields {
  std::size_t count = 0, vertex_count = 0;
  std::unique_ptr<double[]> values;  ///< (count, vertex_count), row after row
};

struct PointDistance {
  double distance;
  Index settled;  ///< vertices that the search expanded
};

/// Defined beside the queries.
std::shared_ptr<QueryCache> make_query_cache();

/// Distances from the nearest of several sources.
struct NearestField {
  std::vector<double> distance;  ///< (V,), infinity where no source reaches
  std::vector<Index> source;  ///< (V,) index into the sources, k_none where no source reaches; ties: the smaller index
};

/// Every vertex is linked to the vertices of its geodesic disk that it sees along one straight geodesic; a shortest
/// path on a mesh is a chain of such links that bends only at saddle vertices. Arcs are real paths on the surface, so
/// that distances are never too short, and the graph is symmetric to the bit, so that they form a metric.
///
/// Departures from the paper: found arcs are united with their reverses (the paper's graph is not symmetric), mesh
/// edges are always arcs (the graph is as connected as the mesh), and windows behind saddles are not propagated (they
/// would only confirm what two arcs say). With an accuracy instead of k, arcs that two shorter ones replace within a
/// tolerance are left out while windows spread [adikusuma2020]: fewer arcs for less error. Immutable once built: any
/// number of threads may query it.
class SaddleVertexGraph {
 public:
  /// Builds the graph by window propagation from every vertex. The mesh must outlive the graph. \throw InputError for k
  /// or accuracy out of range, several of k, accuracy and exact, or when memory would not do for the exact graph;
  /// Cancelled. Time O(V) times the windows of a disk (about 250 for the default); 8 bytes an arc.
  explicit SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options = {}, Job* job = nullptr);
  /// Does the same as a part of other work.
  SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, const JobStage& stage);
  /// Joins the parts that find_arcs found of this mesh (see graph_parts.h), or unite_arcs united, all of them in any
  /// order: the same graph as at once. The mesh must outlive it. \throw InputError for a part that is missing, given
  /// twice, damaged, of another mesh or found otherwise; VersionError for one of another version; Cancelled. O(arcs).
  static SaddleVertexGraph from_parts(const Mesh& mesh, std::span<const std::span<const std::byte>> parts,
                                      int threads = 0, Job* job = nullptr);
  ~SaddleVertexGraph();
  SaddleVertexGraph(SaddleVertexGraph&&) noexcept;

  /// Writes the graph to a file, without its mesh. An old file stays until the new one is whole. O(arcs).
  /// \throw InputError when the file cannot be written (no space, no such folder); Cancelled.
  void save(const std::string& path, Job* job = nullptr) const;
  /// Reads a graph that `save` wrote for this mesh; the mesh must outlive it. Nothing in the file is taken on trust.
  /// \throw InputError when the file cannot be read, is none of ours, of a newer version, of another mesh, cut off or
  /// damaged; Cancelled. O(arcs), far less than building takes.
  static SaddleVertexGraph load(const std::string& path, const Mesh& mesh, Job* job = nullptr);
  /// Maps the file of such a graph into memory, where the system brings what queries read: O(V). Rows are looked at
  /// when they are read first, so that nothing in the file leads astray; `check_file` looks at all. Older files are
  /// loaded. The file must not be changed in place. \throw InputError as `load` does, queries as well.
  static SaddleVertexGraph open(const std::string& path, const Mesh& mesh, Job* job = nullptr);
  /// Checks what `load` would have checked of a mapped file; returns at once for other graphs. O(arcs).
  /// \throw InputError when the file is damaged; Cancelled.
  void check_file(Job* job = nullptr) const;

  const Mesh& mesh() const { return *mesh_; }
  const Unfolding& unfolding() const;
  Index k() const { return k_; }                 ///< 0 when built otherwise
  double accuracy() const { return accuracy_; }  ///< 0 when built otherwise
  bool is_exact() const { return exact_; }
  std::int64_t arc_count() const;
  double mean_degree() const { return static_cast<double>(arc_count()) / mesh_->vertex_count(); }
  /// Memory of the arcs and the order of the nodes.
  std::size_t nbytes() const;
  double build_seconds() const { return build_seconds_; }  ///< 0 when it was not built here
  bool built_by_cuda() const { return built_by_cuda_; }
  const DeviceTimes& device_times() const { return device_times_; }  ///< zero when no device built it

  /// The graph's own numbering of the vertices, along a curve that fills space: neighbors lie close in memory.
  Index node_of(Index vertex) const { return nodes_[vertex]; }
  Index vertex_of(Index node) const { return vertices_[node]; }
  std::span<const Index> nodes() const { return nodes_; }        ///< of the vertices
  std::span<const Index> vertices() const { return vertices_; }  ///< of the nodes
  /// Rows and targets are nodes.
  const ArcRows& arcs() const { return *arcs_; }
  /// Returns what unfold_arc needs to find the faces of an arc of `node`.
  ArcHint hint(Index node, std::int64_t arc) const;
  /// Returns what fans of points are found with: the instructions that the graph was built by.
  const WaveKernel& kernel() const { return *kernel_; }

  /// Distance of every vertex from the nearest source: (V,), infinity where none reaches. Points that are not vertices
  /// are linked by a window propagation of their own. Both methods return the same bits. \throw InputError for no
  /// sources, a source off the mesh, limit < 0 or not a number; Cancelled. O(arcs).
  std::vector<double> distances(const QuerySources& sources, const QueryOptions& options = {},
                                Job* job = nullptr) const;

  /// Works as `distances`, and tells which source it is.
  NearestField nearest(const QuerySources& sources, const QueryOptions& options = {}, Job* job = nullptr) const;

  /// A field as `distances` gives for every source alone, over threads (0: all cores). \throw InputError also when
  /// there is not the memory for it.
  DistanceFields fields(const QuerySources& sources, const QueryOptions& options = {}, int threads = 0,
                        Job* job = nullptr) const;

  /// Distance between two points by A*: the same bits as distances({a}) at b and as distance(b, a). Infinity from one
  /// component to another. The first call makes landmarks (17 fields, 64 bytes a vertex). \throw InputError for a point
  /// off the mesh; Cancelled. O(arcs near the path).
  PointDistance distance(const SurfacePoint& a, const SurfacePoint& b, Job* job = nullptr) const;

  /// Distance of each target from the nearest source, points that see each other included. Between two points the same
  /// bits in both directions. \throw InputError as `distances`; Cancelled. O(arcs).
  std::vector<double> distances_to(const QuerySources& sources, const SurfacePoints& targets, Job* job = nullptr) const;

  /// Tells whether a CUDA device keeps the arcs, since a query there.
  bool is_on_device() const;
  /// Returns how long the last query by a CUDA device took there; nothing when there was none.
  std::optional<DeviceTimes> query_times() const;

  /// Memory that queries leave to the next.
  QueryCache& query_cache() const { return *queries_; }

 private:
  SaddleVertexGraph();  ///< empty, for what makes them otherwise
  ArcCodec codec_of_mesh(const JobStage& stage) const;

  const Mesh* mesh_ = nullptr;
  const WaveKernel* kernel_ = nullptr;
  std::unique_ptr<Unfolding> unfolding_;  ///< none of mapped graphs: it waits in the cache of queries
  Index k_ = 0;
  double accuracy_ = 0;
  bool exact_ = false;
  std::vector<Index> nodes_, vertices_;
  std::unique_ptr<ArcRows> arcs_;
  double build_seconds_ = 0;
  bool built_by_cuda_ = false;
  DeviceTimes device_times_;
  std::shared_ptr<QueryCache> queries_ = make_query_cache();
};

}  // namespace saddleback
