#pragma once
// The arcs of a graph, found from several sources at a time by whole generations of windows.

#include <array>
#include <limits>
#include <vector>

#include "geodesics/arc_symmetry.h"
#include "geodesics/wave_columns.h"
#include "geodesics/wave_mesh.h"

namespace saddleback {

/// What a source keeps of the vertices that it sees: with k > 0 those among the k nearest, otherwise those that no way
/// by shorter arcs reaches within the tolerance.
struct DiskRule {
  Index k = 0;
  double tolerance = 0;  ///< relative
};

/// Propagates the windows of k_batch sources without any order but that of generations: first every window looks at the
/// far corner of its face, then the vertices' distances are lowered, then every window is split. Filters by upper
/// bounds of distances hold in any order, and since all of a generation sees the same bounds, the arcs do not depend on
/// how many windows are taken at a time. Holds scratch memory of O(V); one a thread.
class DiskFinder {
 public:
  DiskFinder(const WaveMesh& mesh, const ArcCodec& codec, const WaveKernel& kernel, const DiskRule& rule);

  /// Appends the arcs of nodes first to first + count - 1, at most k_batch. Mesh edges are always among them.
  /// \throw Cancelled.
  void find(Index first, Index count, FoundArcs& found, const JobStage& stage);

 private:
  struct Generation {
    WindowColumns lefts, rights;  ///< children behind left sides, and behind right ones
    int left_count = 0, right_count = 0;
    int size() const { return left_count + right_count; }
  };

  void seed(Index node, int lane);
  void link(std::int32_t slot, double length, Index edge, bool other);
  void add_window(int lane, Index root, double length, const Vec2& apex);
  void run(const JobStage& stage);
  void advance();
  void lower_labels(int from, int to);
  bool is_kept(std::int32_t slot) const;
  void write_row(Index node, int lane, FoundArcs& found);
  void clear();

  bool by_count() const { return rule_.k > 0; }
  bool bound_disk(int lane);
  void finish_disks();
  void bound_disks();
  void relax_bends();
  void relax_from(std::int32_t slot);

  const WaveMesh& mesh_;
  const ArcCodec& codec_;
  const WaveKernel& kernel_;
  DiskRule rule_;
  std::vector<std::int32_t> labels_;      ///< per slot: bits of the distance, the lowest one set when it makes no arc
  std::vector<std::int32_t> arc_labels_;  ///< the same of the shortest arc
  std::vector<std::int32_t> best_;        ///< the sighting of that arc
  std::array<std::vector<std::int32_t>, k_batch> touched_;  ///< slots with labels, per lane
  std::array<Generation, 2> generations_;
  Generation* now_ = generations_.data();
  Generation* next_ = generations_.data() + 1;
  ApexColumns apexes_;
  SightingColumns sightings_;
  int sighting_count_ = 0, generation_ = 0;
  alignas(64) std::array<float, k_batch> limits_{};
  std::vector<std::int32_t> changed_;  ///< slots whose neighbours may have to be told of their labels
  std::vector<float> radii_;
  std::vector<std::int32_t> chosen_;  ///< sightings of a row
  std::vector<double> lengths_;       ///< and what is made of them
  std::vector<float> leaving_, back_;
};

}  // namespace saddleback
