#pragma once
// The Saddle Vertex Graph (Ying, Wang and He 2013): geodesic distances as shortest paths in a sparse graph.

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh.h"
#include "saddleback/surface_points.h"

namespace saddleback {

class Unfolding;

/// Rounds lengths to multiples of one power of two, 2^-32 of the mean edge, so that sums of arcs are exact in double
/// precision: a path has the same length from both ends and by every method, to the bit.
class LengthQuantum {
 public:
  explicit LengthQuantum(double mean_edge);
  /// At least one quantum: no arc is free.
  double round(double length) const;

 private:
  double step_;
};

struct SaddleVertexGraphOptions {
  Index k = 50;     ///< vertices per geodesic disk, not counting the centre
  int threads = 0;  ///< 0: all cores; the result does not depend on it
};

enum class QueryMethod { label_correcting, dijkstra };

struct QueryOptions {
  double limit = std::numeric_limits<double>::infinity();  ///< vertices farther than this stay at infinity
  QueryMethod method = QueryMethod::label_correcting;
};

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
/// would only confirm what two arcs say). Immutable once built: any number of threads may query it.
class SaddleVertexGraph {
 public:
  /// Builds the graph by window propagation from every vertex. The mesh must outlive the graph.
  /// \throw InputError for k < 1 or k > V; Cancelled. O(V k log k) time, about 12 bytes an arc.
  explicit SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options = {}, Job* job = nullptr);
  ~SaddleVertexGraph();
  SaddleVertexGraph(SaddleVertexGraph&&) noexcept;

  const Mesh& mesh() const { return *mesh_; }
  const Unfolding& unfolding() const { return *unfolding_; }
  Index k() const { return k_; }
  std::int64_t arc_count() const { return static_cast<std::int64_t>(targets_.size()); }
  double mean_degree() const { return static_cast<double>(arc_count()) / mesh_->vertex_count(); }
  std::size_t nbytes() const;  ///< memory of the arcs
  double build_seconds() const { return build_seconds_; }

  // Arcs of a vertex, sorted by target: flat arrays, [first_arc(v), first_arc(v + 1)).
  std::int64_t first_arc(Index vertex) const { return offsets_[vertex]; }
  std::span<const Index> targets() const { return targets_; }
  /// Equal to the bit for an arc and its reverse.
  double length(std::int64_t arc) const { return unit_ * static_cast<double>(lengths_[arc]); }
  /// Direction in which the arc leaves its vertex: surface angle from first_halfedge, 0 to total_angle.
  double angle(std::int64_t arc) const { return static_cast<double>(angles_[arc]); }
  double longest_arc() const { return longest_arc_; }
  const LengthQuantum& quantum() const { return quantum_; }
  /// The arc from one vertex to another, -1 when they are not linked. O(log degree).
  std::int64_t find_arc(Index from, Index to) const;

  /// Distance of every vertex from the nearest source: (V,), infinity where none reaches. Sources that are not vertices
  /// are linked by a window propagation of their own. Both methods return the same bits. \throw InputError for no
  /// sources, a source off the mesh, limit < 0 or not a number; Cancelled. O(arcs log V).
  std::vector<double> distances(const SurfacePoints& sources, const QueryOptions& options = {},
                                Job* job = nullptr) const;

  /// As `distances`, and which source it is.
  NearestField nearest(const SurfacePoints& sources, const QueryOptions& options = {}, Job* job = nullptr) const;

 private:
  const Mesh* mesh_;
  std::unique_ptr<Unfolding> unfolding_;
  Index k_ = 0;
  std::vector<std::int64_t> offsets_;
  std::vector<Index> targets_;
  std::vector<float> lengths_, angles_;
  double unit_ = 1;  ///< of lengths_, a power of two near the mean edge: floats neither overflow nor vanish
  LengthQuantum quantum_;
  double longest_arc_ = 0;
  double build_seconds_ = 0;
};

}  // namespace saddleback
