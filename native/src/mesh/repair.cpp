// Rounds of glue, separate and mend until nothing is wrong. A round that meets no face without area ends it; since
// mending can take faces away and so part a fan, the next round looks again. After k_patient_rounds whatever still
// resists is dropped, and as each such round drops faces, the repair ends.
#include "saddleback/mesh/repair.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"

#include "mesh/repair/repair_borders.h"
#include "mesh/repair/repair_steps.h"
#include "mesh/tables/face_shape.h"

namespace saddleback {

Index RepairState::add_vertex(const Vec3& position, Index source) {
  const Index vertex = vertex_count();
  positions.push_back(position);
  cluster.push_back(vertex);
  moved_to.push_back(vertex);
  copied_from.push_back(source == k_none ? vertex : source);
  return vertex;
}

Index RepairState::add_face(const Triangle& triangle) {
  triangles.push_back(triangle);
  alive.push_back(1);
  flat.push_back(0);
  return face_count() - 1;
}

std::vector<Index> RepairState::live_faces() const {
  std::vector<Index> faces;
  faces.reserve(triangles.size());
  for (Index f = 0; f < face_count(); ++f)
    if (alive[f]) faces.push_back(f);
  return faces;
}

namespace {

constexpr int k_patient_rounds = 8;
constexpr int k_most_looks = 8;

void check_arguments(std::span<const double> xyz, std::span<const Index> triangles, const RepairOptions& options) {
  constexpr std::size_t k_max = std::numeric_limits<Index>::max() / 8;  // room for copies and parts
  if (xyz.size() % 3) throw InputError(message("vertices: ", xyz.size(), " coordinates are not a multiple of 3"));
  if (triangles.size() % 3)
    throw InputError(message("triangles: ", triangles.size(), " indices are not a multiple of 3"));
  if (xyz.size() / 3 > k_max || triangles.size() / 3 > k_max)
    throw InputError(
        message("triangles: more than ", k_max, " vertices or faces cannot be repaired; decimate the mesh"));
  if (!(options.weld_distance >= 0) || !std::isfinite(options.weld_distance))
    throw InputError(message("weld_distance: wanted a finite number >= 0, got ", options.weld_distance));
  if (options.fill_holes < 0 || options.fill_holes > k_most_hole_edges)
    throw InputError(message("fill_holes: wanted 0 to ", k_most_hole_edges, " edges a hole, got ", options.fill_holes));
}

RepairState begin_state(std::span<const double> xyz, std::span<const Index> triangles) {
  RepairState state;
  for (std::size_t i = 0; i < xyz.size(); i += 3) state.add_vertex(Vec3(xyz[i], xyz[i + 1], xyz[i + 2]), k_none);
  for (std::size_t i = 0; i < triangles.size(); i += 3)
    state.add_face({triangles[i], triangles[i + 1], triangles[i + 2]});
  return state;
}

bool is_usable(const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= k_largest_coordinate; }

// Drops faces with vertices that do not exist or cannot be used; returns which vertices are left in use.
std::vector<std::uint8_t> drop_unusable(RepairState& state) {
  const Index vertex_count = state.vertex_count();
  std::vector<std::uint8_t> usable(vertex_count), used(vertex_count, 0);
  Index bad = 0;
  for (Index v = 0; v < vertex_count; ++v) bad += !(usable[v] = is_usable(state.positions[v]));
  state.count("vertices_not_finite", bad);
  for (Index f = 0; f < state.face_count(); ++f) {
    bool in_range = true, finite = true;
    for (const Index v : state.triangles[f]) {
      in_range = in_range && v >= 0 && v < vertex_count;
      finite = finite && in_range && usable[v];
    }
    if (!in_range) state.count("faces_with_bad_index");
    state.alive[f] = finite;
    if (!finite) continue;
    for (const Index v : state.triangles[f]) used[v] = 1;
  }
  state.count("vertices_unreferenced", [&] {
    Index unreferenced = 0;
    for (Index v = 0; v < vertex_count; ++v) unreferenced += usable[v] && !used[v];
    return unreferenced;
  }());
  return used;
}

void count_welded(RepairState& state, std::span<const Index> homes, std::span<const std::uint8_t> used) {
  Index welded = 0;
  for (std::size_t v = 0; v < used.size(); ++v)
    welded += used[v] && homes[v] != k_none && homes[v] != static_cast<Index>(v);
  state.count("vertices_welded", welded);
}

// The rounds; returns for each vertex of before the one that stands for it after the first.
std::vector<Index> mend_all(RepairState& state, const JobStage& stage) {
  std::vector<Index> homes;
  for (int round = 0;; ++round) {
    const bool patient = round < k_patient_rounds;
    const JobStage part = stage.part(round == 0 ? 0 : 0.8, round == 0 ? 0.8 : 1);
    std::vector<Index> now = separate_fans(state, glue_sheets(state, part.part(0, 0.7)), patient, part);
    if (round == 0) homes = std::move(now);
    part.update(0.8);
    if (!mend_areas(state, patient, part)) return homes;
  }
}

// Numbers what is left in its order.
struct Compact {
  std::vector<double> xyz;
  std::vector<Index> triangles, vertex_number, face_number;
};

Compact compact(const RepairState& state) {
  Compact result;
  result.vertex_number.assign(state.positions.size(), k_none);
  result.face_number.assign(state.triangles.size(), k_none);
  const std::vector<Index> faces = state.live_faces();
  for (const Index f : faces)
    for (const Index v : state.triangles[f]) result.vertex_number[v] = 0;
  Index count = 0;
  for (std::size_t v = 0; v < state.positions.size(); ++v) {
    if (result.vertex_number[v] == k_none) continue;
    result.vertex_number[v] = count++;
    result.xyz.insert(result.xyz.end(), state.positions[v].data(), state.positions[v].data() + 3);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    result.face_number[faces[i]] = static_cast<Index>(i);
    for (const Index v : state.triangles[faces[i]]) result.triangles.push_back(result.vertex_number[v]);
  }
  return result;
}

std::vector<Index> map_vertices(const RepairState& state, const std::vector<Index>& homes, const Compact& compact) {
  // Where a first copy lost all its faces, the next copy stands for it.
  std::vector<Index> number = compact.vertex_number;
  for (Index v = 0; v < state.vertex_count(); ++v) {
    Index& source = number[state.copied_from[v]];
    if (source == k_none) source = number[v];
  }
  std::vector<Index> map(homes.size(), k_none);
  for (std::size_t v = 0; v < homes.size(); ++v) {
    Index at = homes[v];
    if (at == k_none) continue;
    while (state.moved_to[at] != at) at = state.moved_to[at];
    map[v] = number[at];
  }
  return map;
}

bool is_unchanged(std::span<const double> xyz, std::span<const Index> triangles, const Compact& compact) {
  return std::equal(xyz.begin(), xyz.end(), compact.xyz.begin(), compact.xyz.end()) &&
         std::equal(triangles.begin(), triangles.end(), compact.triangles.begin(), compact.triangles.end());
}

std::string nothing_left(const RepairReport& report) {
  return message("no face of the mesh can be used", report.changes.empty() ? "" : " (" + report.text() + ")",
                 "; give it at least one triangle with area");
}

RepairResult repair_once(std::span<const double> xyz, std::span<const Index> triangles, const RepairOptions& options,
                         const JobStage& stage) {
  RepairState state = begin_state(xyz, triangles);
  const std::vector<std::uint8_t> used = drop_unusable(state);
  stage.update(0.05);
  state.cluster = weld_clusters(state.positions, used, options.weld_distance, stage);
  if (options.stitch) stitch_borders(state, options.weld_distance, stage);
  const std::vector<Index> homes = mend_all(state, stage.part(0.2, 0.8));
  count_welded(state, homes, used);
  if (options.fill_holes > 0) {
    fill_holes(state, options.fill_holes, stage);
    mend_all(state, stage.part(0.8, 0.85));  // the least area of a loop may be none
  }

  const Compact result = compact(state);
  RepairReport report;
  report.changes = std::move(state.changes);
  if (result.triangles.empty()) throw MeshError(nothing_left(report));
  report.vertex_map = map_vertices(state, homes, result);
  report.face_map.assign(result.face_number.begin(),
                         result.face_number.begin() + static_cast<std::ptrdiff_t>(triangles.size() / 3));
  // Copies made by an earlier repair are welded and split again on the way: that is no change.
  if (is_unchanged(xyz, triangles, result)) report.changes.clear();
  stage.update(0.85);
  return {Mesh(result.xyz, result.triangles, stage.part(0.85, 1)), std::move(report)};
}

// Cutting, stitching and mending may bring together what a second look takes for something else.
bool deserves_another_look(const RepairReport& report) {
  const auto counted = [&](const char* kind) { return report.changes.contains(kind); };
  return counted("edges_non_manifold") || counted("edges_cut") || counted("edges_divided") ||
         counted("faces_without_area") || counted("vertices_split");
}

void follow(std::vector<Index>& map, std::span<const Index> next) {
  for (Index& to : map)
    if (to != k_none) to = next[to];
}

}  // namespace

RepairResult repair(std::span<const double> xyz, std::span<const Index> triangles, const RepairOptions& options) {
  const JobStage stage(options.job, "Repairing the mesh");
  check_arguments(xyz, triangles, options);
  RepairResult repaired = repair_once(xyz, triangles, options, stage.part(0, 0.9));
  for (int look = 0; look < k_most_looks && deserves_another_look(repaired.report); ++look) {
    const std::span<const Vec3> positions = repaired.mesh.positions();
    const std::span<const Triangle> faces = repaired.mesh.triangles();
    RepairResult next = repair_once({positions.data()->data(), 3 * positions.size()},
                                    {faces.data()->data(), 3 * faces.size()}, {}, stage.part(0.9, 0.95));
    if (next.report.changes.empty()) break;
    follow(repaired.report.vertex_map, next.report.vertex_map);
    follow(repaired.report.face_map, next.report.face_map);
    for (const auto& [kind, count] : next.report.changes) repaired.report.changes[kind] += count;
    repaired.mesh = std::move(next.mesh);
  }
  repaired.report.close_borders = tell_close_borders(repaired.mesh.positions(), repaired.mesh.triangles(), stage);
  stage.update(1);
  return repaired;
}

std::string CloseBorders::text() const {
  std::string text;
  if (near_vertices)
    text += message("; ", near_vertices, " border ", near_vertices == 1 ? "vertex lies" : "vertices lie",
                    " close to another border without touching it: weld_distance=", weld_distance, " joins them");
  if (vertices_amid_edges)
    text += message("; ", vertices_amid_edges, " border ", vertices_amid_edges == 1 ? "vertex lies" : "vertices lie",
                    " amid the edge of another border (a T-junction): stitch=True joins them");
  return text;
}

std::string RepairReport::text() const {
  struct Kind {
    const char *key, *one, *many;
  };
  static constexpr Kind k_kinds[] = {
      {"vertices_not_finite", "vertex that is not finite or beyond 1e60 dropped",
       "vertices that are not finite or beyond 1e60 dropped"},
      {"vertices_unreferenced", "vertex of no usable face dropped", "vertices of no usable face dropped"},
      {"faces_with_bad_index", "face with an index out of range dropped", "faces with an index out of range dropped"},
      {"faces_repeating_a_vertex", "face that used a vertex twice dropped", "faces that used a vertex twice dropped"},
      {"faces_duplicate", "duplicate face dropped", "duplicate faces dropped"},
      {"vertices_welded", "vertex welded", "vertices welded"},
      {"faces_without_area", "face without area mended", "faces without area mended"},
      {"faces_dropped", "face that could not be mended dropped", "faces that could not be mended dropped"},
      {"edges_non_manifold", "non-manifold edge resolved", "non-manifold edges resolved"},
      {"edges_divided", "edge divided", "edges divided"},
      {"edges_cut", "edge cut along the seam of a surface without orientation",
       "edges cut along the seam of a surface without orientation"},
      {"vertices_split", "vertex copied where sheets met", "vertices copied where sheets met"},
      {"faces_flipped", "face turned over", "faces turned over"},
      {"edges_stitched", "edge divided where vertices lay on it", "edges divided where vertices lay on them"},
      {"holes_filled", "hole filled", "holes filled"},
      {"holes_left", "hole left open", "holes left open"},
  };
  std::string text;
  for (const Kind& kind : k_kinds) {
    const auto found = changes.find(kind.key);
    if (found == changes.end()) continue;
    text += message(text.empty() ? "" : ", ", found->second, " ", found->second == 1 ? kind.one : kind.many);
  }
  return (text.empty() ? "nothing to mend" : text) + close_borders.text();
}

}  // namespace saddleback
