#pragma once
// The steps of a repair, in their order. They work on one state in which vertices and faces keep their first numbers:
// what is added comes after them, what is dropped is only marked, so that the maps need no bookkeeping on the way.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

struct RepairState {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> alive;  ///< per face
  std::vector<std::uint8_t> flat;   ///< per face: was ever seen without area
  std::vector<Index> cluster;       ///< per vertex: the vertex that it is welded to (itself, or a smaller one)
  std::vector<Index> moved_to;      ///< per vertex: the vertex that took its place in an edge collapse, or itself
  std::vector<Index> copied_from;   ///< per vertex: the vertex that it is a copy of, or itself
  std::map<std::string, Index> changes;

  Index vertex_count() const { return static_cast<Index>(positions.size()); }
  Index face_count() const { return static_cast<Index>(triangles.size()); }
  Index add_vertex(const Vec3& position, Index source);
  Index add_face(const Triangle& triangle);
  std::vector<Index> live_faces() const;
  void count(const char* kind, Index number = 1) {
    if (number > 0) changes[kind] += number;
  }
};

/// Finds for each vertex marked in `used` the vertex that it is welded to: the smallest one at the same place or, with
/// a distance, the first in order that lies within it. Those that stay are further apart than the distance. O(V)
/// expected. \throw Cancelled, as all of these steps.
std::vector<Index> weld_clusters(std::span<const Vec3> positions, std::span<const std::uint8_t> used, double distance,
                                 const JobStage& stage);

/// Live faces as a surface under construction: which half-edges are glued to which, and which faces are turned over.
/// Half-edges are numbered by the place of their face in `faces`.
struct Sheets {
  std::vector<Index> faces;          ///< numbers in the state
  std::vector<Triangle> fine;        ///< the corners' own vertices
  std::vector<Triangle> coarse;      ///< the clusters of those
  std::vector<Index> twins;          ///< glued half-edge or k_none
  std::vector<std::uint8_t> turned;  ///< per face
};

/// Drops faces that use a place twice and duplicates, then glues at most two half-edges an edge and orients the faces.
Sheets glue_sheets(RepairState& state, const JobStage& stage);

/// Turns closed bodies so that the outermost face outward, with what lies within them; see repair_orient.cpp. `labels`:
/// the body of each face of `sheets`.
void turn_outward(const RepairState& state, Sheets& sheets, const std::vector<Index>& labels, Index label_count,
                  const JobStage& stage);

/// Turns open bodies so that the side of which more is seen from outside is their front; see repair_seen.cpp.
void turn_seen_outward(const RepairState& state, Sheets& sheets, const std::vector<Index>& labels, Index label_count,
                       const JobStage& stage);

/// Gives every fan of glued corners a vertex of its own, writes the faces back, turned as they should be, and divides
/// edges that two vertices share more than once (`divide` false: drops their faces). Afterwards the state is manifold.
/// The returned vector says for each vertex of before which vertex stands for it now, k_none if none does.
std::vector<Index> separate_fans(RepairState& state, Sheets sheets, bool divide, const JobStage& stage);

/// Mends faces without area by edge collapses and flips in OpenMesh's half-edges, dropping the ones that resist
/// (`patient` false: drops them all). \pre manifold. Returns whether there were any: manifoldness may then be lost.
bool mend_areas(RepairState& state, bool patient, const JobStage& stage);

}  // namespace saddleback
