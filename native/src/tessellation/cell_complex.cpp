#include "tessellation/cell_complex.h"

#include <algorithm>

#include "saddleback/error.h"

#include "support/parallel.h"

namespace saddleback {
namespace {

void check_components(const Mesh& mesh, const SurfacePoints& sites) {
  std::vector<std::uint8_t> has_site(mesh.component_count(), 0);
  for (const SurfacePoint& site : sites) has_site[mesh.component_of(mesh.triangles()[site.face][0])] = 1;
  const auto bare = static_cast<Index>(std::find(has_site.begin(), has_site.end(), 0) - has_site.begin());
  if (bare == mesh.component_count()) return;
  Index vertex = 0;
  while (mesh.component_of(vertex) != bare) ++vertex;
  const auto count = std::count(has_site.begin(), has_site.end(), 0);
  throw InputError(message("sites: ", count, " of the mesh's ", mesh.component_count(), " separate parts ",
                           count == 1 ? "has" : "have", " no site, first the part of vertex ", vertex,
                           "; put at least one site on every part"));
}

}  // namespace

void check_sites(const Mesh& mesh, const SurfacePoints& sites) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  if (static_cast<Index>(sites.size()) > mesh.vertex_count()) {
    throw InputError(message("sites: ", sites.size(), " sites are more than the mesh has vertices (",
                             mesh.vertex_count(), "); subdivide the mesh or ask for fewer"));
  }
  check_surface_points(mesh, sites, "sites");
  check_components(mesh, sites);
}

CellComplex::CellComplex(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, const JobStage& stage)
    : mesh_(graph.mesh()),
      maps_(graph, sites, threads, stage.part(0, 0.6)),
      site_count_(static_cast<Index>(sites.size())),
      face_shared_(mesh_.face_count(), k_none),
      face_site_(mesh_.face_count()) {
  find_candidates(sites, stage);
  stage.update(0.7);
  break_edges();
  stage.update(0.75);
  divide_faces(threads, stage.part(0.75, 1));
  label_vertices();
  stage.update(1);
}

/// Marks a face as shared; its candidates begin with the labels of its corners.
Index CellComplex::share(Index face) {
  if (face_shared_[face] != k_none) return face_shared_[face];
  face_shared_[face] = static_cast<Index>(shared_.size());
  shared_.push_back({face, {}});
  for (Index h = 3 * face; h < 3 * face + 3; ++h) add_candidate(shared_.back(), maps_.label(mesh_.from(h)), h);
  return face_shared_[face];
}

/// `halfedge` is one of the face's whose ends know the site already (or any, when all corners can be reached).
bool CellComplex::add_candidate(Shared& shared, Index site, Index halfedge) {
  const auto place = std::lower_bound(shared.candidates.begin(), shared.candidates.end(), site);
  if (place != shared.candidates.end() && *place == site) return false;
  shared.candidates.insert(place, site);
  maps_.log(mesh_.from(halfedge), site, Mesh::next(halfedge));
  maps_.log(mesh_.to(halfedge), site, Mesh::prev(halfedge));
  maps_.log(mesh_.apex(halfedge), site, halfedge);
  return true;
}

void CellComplex::find_candidates(const SurfacePoints& sites, const JobStage& stage) {
  for (Index f = 0; f < mesh_.face_count(); ++f) {
    const Triangle& t = mesh_.triangles()[f];
    const Index label = maps_.label(t[0]);
    face_site_[f] = label;
    if (maps_.label(t[1]) != label || maps_.label(t[2]) != label) share(f);
  }
  for (Index site = 0; site < site_count_; ++site) {
    const Index face = sites[site].face;
    if (face_site_[face] != site || face_shared_[face] != k_none) add_candidate(shared_[share(face)], site, 3 * face);
  }
  // shared_ grows while it is read: each face is looked at again whenever it gains a candidate.
  std::vector<Index> queue(shared_.size());
  for (std::size_t i = 0; i < queue.size(); ++i) queue[i] = static_cast<Index>(i);
  std::vector<EdgeLine> lines;
  std::vector<EdgePiece> pieces;
  for (std::size_t i = 0; i < queue.size(); ++i) {
    if (i % 1024 == 0) stage.check();
    const Index face = shared_[queue[i]].face;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const Index twin = mesh_.twin(h);
      if (twin == k_none) continue;
      lines_along(shared_[queue[i]], h, lines);
      lower_envelope(lines, pieces);
      const Index beyond = Mesh::face_of(twin);
      const bool alone = pieces.size() == 1 && face_shared_[beyond] == k_none && face_site_[beyond] == pieces[0].site;
      if (alone) continue;
      const Index other = share(beyond);
      bool grew = false;
      for (const EdgePiece& piece : pieces) grew = add_candidate(shared_[other], piece.site, twin) || grew;
      if (grew) queue.push_back(other);
    }
  }
}

/// The candidates' squared distances along a half-edge.
void CellComplex::lines_along(const Shared& shared, Index halfedge, std::vector<EdgeLine>& lines) const {
  lines.clear();
  for (const Index site : shared.candidates) {
    lines.push_back({site, squared_distance(mesh_.from(halfedge), site), squared_distance(mesh_.to(halfedge), site)});
  }
}

/// The half-edge along which an edge's breaks are stored.
Index CellComplex::edge_halfedge(Index h) const {
  const Index twin = mesh_.twin(h);
  return twin == k_none ? h : std::min(h, twin);
}

void CellComplex::break_edges() {
  edge_index_.assign(mesh_.halfedge_count(), k_none);
  std::vector<EdgeLine> lines;
  for (const Shared& shared : shared_) {
    for (Index h = 3 * shared.face; h < 3 * shared.face + 3; ++h) {
      const Index along = edge_halfedge(h);
      if (edge_index_[along] != k_none) continue;
      edge_index_[along] = static_cast<Index>(edges_.size());
      EdgeBreaks& edge = edges_.emplace_back();
      lines_along(shared, along, lines);
      lower_envelope(lines, edge.pieces);
      edge.first_vertex = mesh_.vertex_count() + static_cast<Index>(added_.size());
      for (std::size_t i = 1; i < edge.pieces.size(); ++i) {
        SurfacePoint point{Mesh::face_of(along), Vec3::Zero()};
        point.barycentric[along % 3] = 1 - edge.pieces[i].begin;
        point.barycentric[(along + 1) % 3] = edge.pieces[i].begin;
        added_.push_back(point);
      }
    }
  }
}

void CellComplex::divide_faces(int threads, const JobStage& stage) {
  std::sort(shared_.begin(), shared_.end(), [](const Shared& a, const Shared& b) { return a.face < b.face; });
  for (const Shared& shared : shared_) face_site_[shared.face] = k_none;
  const auto count = static_cast<Index>(shared_.size());
  constexpr Index k_block = 4096;  // partitions are kept for a block at a time and then numbered in order
  std::vector<FacePartition> partitions(std::min(count, k_block));
  for (Index begin = 0; begin < count; begin += k_block) {
    const Index size = std::min(k_block, count - begin);
    parallel_for(size, threads, 64, [&](Index i, int) { divide(shared_[begin + i], partitions[i]); });
    for (Index i = 0; i < size; ++i) add_pieces(shared_[begin + i].face, partitions[i]);
    stage.update(static_cast<double>(begin + size) / count);
  }
}

void CellComplex::divide(const Shared& shared, FacePartition& partition) const {
  const Triangle& t = mesh_.triangles()[shared.face];
  std::vector<FacePlane> planes;
  for (const Index site : shared.candidates) {
    planes.push_back(
        {site, {squared_distance(t[0], site), squared_distance(t[1], site), squared_distance(t[2], site)}});
  }
  partition.build(planes);
  if (agrees_with_edges(shared.face, partition)) return;
  partition.build_star({side_of(shared.face, 0), side_of(shared.face, 1), side_of(shared.face, 2)});
}

/// What the edge says about the face's side, in the face's own direction.
FacePartition::Side CellComplex::side_of(Index face, int side) const {
  const Index h = 3 * face + side, along = edge_halfedge(h);
  const auto& pieces = edges_[edge_index_[along]].pieces;
  FacePartition::Side result;
  for (const EdgePiece& piece : pieces) result.sites.push_back(piece.site);
  for (std::size_t i = 1; i < pieces.size(); ++i)
    result.breaks.push_back(h == along ? pieces[i].begin : 1 - pieces[i].begin);
  if (h != along) {
    std::reverse(result.sites.begin(), result.sites.end());
    std::reverse(result.breaks.begin(), result.breaks.end());
  }
  return result;
}

bool CellComplex::agrees_with_edges(Index face, const FacePartition& partition) const {
  std::vector<Index> sites, breaks;
  for (int side = 0; side < 3; ++side) {
    if (!partition.read_side(side, sites, breaks) || sites != side_of(face, side).sites) return false;
  }
  return true;
}

/// Numbers the partition's vertices and appends its pieces. Vertices on sides become the edges' own.
void CellComplex::add_pieces(Index face, const FacePartition& partition) {
  const auto& vertices = partition.vertices();
  std::vector<Index> number(vertices.size(), k_none);
  std::vector<Vec3> place(vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    number[corner] = mesh_.triangles()[face][corner];
    place[corner] = Vec3::Unit(corner);
  }
  std::vector<Index> sites, breaks;
  for (int side = 0; side < 3; ++side) {
    partition.read_side(side, sites, breaks);
    const Index h = 3 * face + side, along = edge_halfedge(h);
    const EdgeBreaks& edge = edges_[edge_index_[along]];
    const auto count = static_cast<Index>(breaks.size());
    for (Index i = 0; i < count; ++i) {
      const Index on_edge = h == along ? i : count - 1 - i;
      const double t = edge.pieces[on_edge + 1].begin;
      number[breaks[i]] = edge.first_vertex + on_edge;
      place[breaks[i]] = Vec3::Zero();
      place[breaks[i]][side] = h == along ? 1 - t : t;
      place[breaks[i]][(side + 1) % 3] = h == along ? t : 1 - t;
    }
  }
  for (const FacePartition::Piece& piece : partition.pieces()) {
    pieces_.push_back({face, piece.site, static_cast<Index>(loop_.size()), static_cast<Index>(piece.loop.size())});
    for (const Index v : piece.loop) {
      if (number[v] == k_none) {
        number[v] = mesh_.vertex_count() + static_cast<Index>(added_.size());
        place[v] = vertices[v].barycentric;
        added_.push_back({face, place[v]});
      }
      loop_.push_back(number[v]);
      loop_barycentric_.push_back(place[v]);
    }
  }
}

void CellComplex::label_vertices() {
  vertex_site_.resize(mesh_.vertex_count());
  for (Index v = 0; v < mesh_.vertex_count(); ++v) vertex_site_[v] = maps_.label(v);
  std::vector<std::uint8_t> seen(mesh_.vertex_count(), 0);
  const auto offer = [&](Index vertex, Index site) {  // ties: the smaller site
    vertex_site_[vertex] = seen[vertex] ? std::min(vertex_site_[vertex], site) : site;
    seen[vertex] = 1;
  };
  for (Index h = 0; h < mesh_.halfedge_count(); ++h) {
    if (edge_index_[h] == k_none) continue;
    offer(mesh_.from(h), edges_[edge_index_[h]].pieces.front().site);
    offer(mesh_.to(h), edges_[edge_index_[h]].pieces.back().site);
  }
}

}  // namespace saddleback
