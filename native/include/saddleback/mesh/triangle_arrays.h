#pragma once
// Functions of plain triangle arrays, such as those that `split` gives: no Mesh need be made of them.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

// All throw InputError naming the first triangle whose corner is out of range.

/// Unit normals (V,), weighted by the areas of the triangles about a vertex; zero where none has an area. O(V + T).
std::vector<Vec3> vertex_normals(std::span<const Vec3> vertices, std::span<const Triangle> triangles);

/// Means (V, k) of the numbers (V, k) at the other corners of the triangles about a vertex, of which one on two of them
/// counts twice; zero where no triangle is. \throw InputError for a width that does not divide the numbers. O(V k +
/// T k).
std::vector<double> neighbor_means(std::span<const double> values, Index width, std::span<const Triangle> triangles);

/// Directions (V,) smoothed in so many rounds: each becomes the unit vector along the mean of its neighbors' (as
/// neighbor_means) and a fifth of itself, or as it was given where those cancel out. \throw Cancelled. O(rounds T), all
/// cores.
std::vector<Vec3> smoothed_directions(std::span<const Vec3> directions, std::span<const Triangle> triangles, int rounds,
                                      const JobStage& stage = {});

struct TriangleEdges {
  std::vector<std::array<Index, 2>> ends;  ///< each edge once
  std::vector<Index> corner_edges;         ///< (3 T,) the edge from each triangle's corner to its next one
};

/// The edges of triangles, numbered in the order in which these come upon them, whichever way round. O(V + T) for
/// surfaces.
TriangleEdges triangle_edges(std::span<const Triangle> triangles, Index vertex_count);

struct BorderEdges {
  std::vector<std::array<Index, 2>> ends;  ///< from, to, in the triangle's orientation
  std::vector<Index> triangles;            ///< the one that uses the edge
};

/// The edges that only one triangle uses, by triangle. O(V + T) for bounded valence.
BorderEdges border_edges(std::span<const Triangle> triangles, Index vertex_count);

/// The part (T,) of each triangle, numbered in the order in which these come upon them: those of one part lead to each
/// other over common vertices. O(V + T).
std::vector<Index> connected_parts(std::span<const Triangle> triangles, Index vertex_count);

/// Triangles refined along a level line.
struct LevelCut {
  std::vector<double> fields;        ///< (W, k) the given vertices, then the new ones
  std::vector<Triangle> triangles;   ///< (U,) in the order of those that they are parts of
  std::vector<Index> parents;        ///< (U,) the given triangle that each is part of
  std::vector<std::uint8_t> aboves;  ///< (U,) whether it lies above the level
};

/// Cuts all triangles where a function, linear over each, equals `level` (marching triangles). `fields` (V, k) holds
/// all numbers of a vertex side by side, the position first, the function in `column`: new vertices interpolate each,
/// and are shared by both sides, so that no crack opens. A vertex nearer to the level than 1e-9 of the greatest value
/// is on it; a triangle wholly on it counts as below. Values may be infinite, as distances beyond a limit are: an edge
/// from a finite value to such a one crosses the level at its finite end. \throw InputError for a column that is not
/// there, and a level that is not finite. O(V k + T).
LevelCut cut_at_level(std::span<const double> fields, Index width, std::span<const Triangle> triangles, Index column,
                      double level);

struct CellBoundary {
  std::vector<std::array<Index, 2>> segments;  ///< edges between triangles of different cells
  std::vector<std::array<Index, 2>> cells;     ///< beside each
};

/// Returns where the cells (T,) of triangles meet; the border of the mesh is no boundary of a cell. O(V + T).
CellBoundary cell_boundary(std::span<const Triangle> triangles, std::span<const Index> triangle_cell,
                           Index vertex_count);

/// Distance (V,) to the boundary of the vertex's own cell, on which it is 0; infinity farther than one ring of vertices
/// beyond `limit`, and where a cell has no boundary.
///
/// Every vertex remembers its nearest segment of the boundary; segments spread over the edges from the boundary
/// inwards, as in vector distance transforms, and each vertex tries those that follow its own along the boundary, too.
/// So the distance is a straight one to a segment that was reached on the surface, and never jumps from one fold to
/// another. Never too short; at most a few percent too long near the middle line of a cell with a ragged boundary,
/// where the nearest segment may be nearest to no vertex on the way. \throw InputError for a wrong number of cells,
/// Cancelled.
std::vector<double> cell_boundary_distance(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                           std::span<const Index> triangle_cell, double limit,
                                           const JobStage& stage = {});

/// Distance (n,) of points to the nearest segment of their group (n,), straight through space; infinity where that has
/// none. `ends` (m,) are those of the segments, `segment_group` (m,) says to which group each belongs, 0 or more.
/// \throw InputError for groups below 0, and a wrong number of them; Cancelled. O(n + m) and the segments of each
/// point's group, all cores.
std::vector<double> segment_distances(std::span<const Vec3> points, std::span<const Index> point_group,
                                      std::span<const std::array<Vec3, 2>> ends, std::span<const Index> segment_group,
                                      const JobStage& stage = {});

struct BoundaryRefinement {
  std::vector<double> fields;       ///< (W, k) the given vertices, then the new ones
  std::vector<Triangle> triangles;  ///< (U,)
  std::vector<Index> cells;         ///< (U,)
};

/// Halves edges until `cut_at_level` finds the lines of the `levels` of `cell_boundary_distance` to about `tolerance`
/// times the level: on triangles as large as the cells that distance is not linear; where all corners lie on the
/// boundary it would be 0 all over. `fields` (V, k) holds all numbers of a vertex side by side, the position first; new
/// vertices get the means of theirs. The last is filled with the distance. An edge is halved where the distance in its
/// middle differs by more from the mean of both ends, and the level is crossed. \throw InputError for a wrong number of
/// cells, and a tolerance that is not above 0; Cancelled. O(V + U) for a fixed number of rings.
BoundaryRefinement refine_to_cell_boundary(std::span<const double> fields, Index width,
                                           std::span<const Triangle> triangles, std::span<const Index> triangle_cell,
                                           std::span<const double> levels, double tolerance,
                                           const JobStage& stage = {});

/// Pairs of triangles that pass through each other, the smaller number first, in order: an edge of one goes from one
/// side of the other to its other side. Exact for coordinates as they are; triangles that only touch, lie in one plane
/// or share an edge are no such pair. Only pairs of which one is `among` these, if given, and of different `owners`
/// (T,), if given. The same for any number of threads (0: all cores). \throw Cancelled, InputError for a vertex that is
/// not finite, an `among` that does not rise, and a wrong number of owners. About O(T log n), n of them `among`.
std::vector<std::array<Index, 2>> self_crossings(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                                                 std::optional<std::span<const Index>> among,
                                                 std::optional<std::span<const Index>> owners, int threads,
                                                 const JobStage& stage);

}  // namespace saddleback
