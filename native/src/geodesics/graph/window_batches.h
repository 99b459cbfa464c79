#pragma once
// Windows by whole generations: the data that the driver (geodesic_disks) and the vector kernels share.
//
// Only plain data and no inline functions: this header is compiled for several instruction sets, and a function that
// two of them define could be linked into code for a machine that lacks it.

#include <cstdint>

namespace saddleback {

/// Sources that share their generations, to fill the lanes. A *slot* is a node and one of them: node * k_batch + lane.
inline constexpr int k_batch = 8;
inline constexpr int k_batch_bits = 3;
/// Disks that end by count learn their radius in the first generation, the fourth, and so on, since finding the k-th
/// nearest takes as long as a generation. Which are best was measured with k from 20 to 100.
inline constexpr int k_generations_per_bound = 3, k_first_bound = 1;
/// A disk whose radius is not known by then is bounded by mesh edges. Half as many do for nearly all.
inline constexpr int k_blind_generations = 24;
/// Generations of a node's windows by accuracy that are split whatever is known of the vertices so far, so that it
/// makes no difference in what order windows are taken: filters remove one in thirty on bumpy scans, and mostly none.
/// About needles windows are many generations on their way, and filters end those that go round and round.
inline constexpr int k_free_generations = 32;
/// Windows of a batch after which no more are followed. There are 200 to 1,000 a source on any sane mesh; needles by
/// the thousand round one vertex may exceed that without end, and stopping only costs arcs, never correctness.
inline constexpr int k_most_windows = 1 << 20;
/// Bounds, in mean edges: a source whose edges are all shorter has a unit of its own, see scale_about.
inline constexpr double k_small_edges = 1.0 / (1 << 6);
/// Rows may be read and written so many entries past their end.
inline constexpr int k_row_padding = 16;

/// A half-edge about to be entered: where the far corner of its face lies, and the half-edges behind its other sides.
/// A face's corner is at from + a * (to - from) + b * (to - from turned left).
struct alignas(32) EdgeRecord {
  double a, b;
  std::int32_t left, right;  ///< edge records behind (from, apex) and (apex, to); -1 at the boundary
  std::int32_t apex;         ///< node
  /// Says how far it is at least from the edges behind the two sides to the next vertex beyond them: the upper halves
  /// of two floats, of the left one and the right one. A CUDA device notes in the lowest bit whether the apex is a
  /// saddle.
  std::uint32_t clearances;
};
inline constexpr std::uint32_t k_saddle_bit = 1;
/// Bounds the rounding of clearances, relative: of positions of single precision.
inline constexpr double k_clearance_rounding = 1e-3;

/// Windows, a row a quantity. The source is at the origin of a plane of its own; a window emits through the part of a
/// half-edge between two rays, each through a vertex that the source sees along it: its *flanks*.
struct WindowRows {
  double *from_x, *from_y, *to_x, *to_y;       ///< ends of the half-edge
  float *right_x, *right_y, *left_x, *left_y;  ///< unit vectors along the rays; left is counter-clockwise of right
  float *right_reach, *left_reach;             ///< distances of the flanks
  float *right_way, *left_way;  ///< bounds of the graph's distances to them; unused where every sighting is an arc
  float *right_served, *left_served;  ///< tangents of the angles off the rays within which the flanks serve all ahead
  float* most;                        ///< radius beyond which the window serves nothing
  std::int32_t* edge;                 ///< record * k_batch + lane
  std::int32_t *from, *to;            ///< slots of the half-edge's ends
  std::int32_t* root;                 ///< record of the source's half-edge whose face the window left
};

/// Holds what a window sees of its face's far corner; a row a window.
struct ApexRows {
  double *x, *y;
  float* way;                           ///< as of flanks
  float *reach, *from_right, *to_left;  ///< distance; its offsets from the rays, positive inside
  std::int32_t *left, *right;           ///< edge * k_batch + lane, negative at the boundary
  std::int32_t* slot;
  std::int32_t* clearances;  ///< of the record
};

/// Vertices seen, a row a sighting.
struct SightingRows {
  double *x, *y;
  float *back_x, *back_y;   ///< from the vertex to the start of the half-edge that the window came through
  double *from_x, *from_y;  ///< that start itself; null where directions are wanted to float precision only
  std::int32_t* slot;
  std::int32_t* label;  ///< the distance's bits, the lowest one set when the sighting makes no arc
  std::int32_t *edge, *root;
};

/// Holds what all windows of a batch look up.
struct WaveScene {
  const EdgeRecord* edges;
  const std::int32_t* labels;  ///< upper bounds of the distances of all slots
  const float* limits;         ///< k_batch radii that bound the disks, infinite as long as they are unknown
  float detour;                ///< what a way may be longer by than a straight geodesic: a factor
  float per_detour;            ///< its inverse; huge where what flanks serve is wanted as well
  float excess;                ///< the same for what lies beyond a window's end, less 1
};

/// The two halves of a generation's work. All windows are sighted, and the labels updated, before any is split.
struct WaveKernel {
  const char* name;
  /// Looks at the far corner of each window's face; appends the corners seen. \return the number of sightings then.
  int (*sight)(const WaveScene&, const WindowRows&, int count, const ApexRows&, const SightingRows&, int sightings);
  /// Does the same where every sighting makes an arc.
  int (*sight_all)(const WaveScene&, const WindowRows&, int count, const ApexRows&, const SightingRows&, int sightings);
  /// Appends the windows' children that may still serve, whatever the labels are: those behind the left sides, and
  /// those behind the right ones.
  void (*split_free)(const WaveScene&, const WindowRows&, int count, const ApexRows&, const WindowRows& lefts,
                     int* left_count, const WindowRows& rights, int* right_count);
  /// Does the same without those that labels tell to be of no use.
  void (*split)(const WaveScene&, const WindowRows&, int count, const ApexRows&, const WindowRows& lefts,
                int* left_count, const WindowRows& rights, int* right_count);
  /// Does the same with no bound but the disks' limits.
  void (*split_all)(const WaveScene&, const WindowRows&, int count, const ApexRows&, const WindowRows& lefts,
                    int* left_count, const WindowRows& rights, int* right_count);
  /// Lengths of chosen sightings, the angles at which they leave the source, from its half-edge in the root's face, and
  /// those at which they come in, from the half-edge to the start of the last one crossed. In radians, to 1e-5. Reads
  /// `chosen` up to its padding.
  void (*aim)(const SightingRows&, const std::int32_t* chosen, int count, double* lengths, float* leaving, float* back);
  /// Index of the first word whose bits below `mask` are `target`, -1 for none. Reads k_row_padding words more.
  int (*find_target)(const std::uint64_t* words, int count, std::uint64_t mask, std::uint64_t target);
};

}  // namespace saddleback
