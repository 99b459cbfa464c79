#pragma once
// Which sites may own a part of which face.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "tessellation/cells/edge_envelope.h"
#include "tessellation/log_map/site_maps.h"

namespace saddleback {

/// \throw InputError naming the first offender: no sites, a site off the mesh, a component without a site.
void check_sites(const Mesh& mesh, const SurfacePoints& sites);

/// A site that may own a part of a face, and how far the face's corners are from it. Squared, as they are compared:
/// roots would lose ties.
struct FaceClaim {
  Index face, site;
  std::array<double, 3> squared_distance;  ///< of the corners
  EdgeLine line_along(Index halfedge) const {
    return {site, squared_distance[halfedge % 3], squared_distance[Mesh::next(halfedge) % 3]};
  }
};

/// The same with where the corners are, from the site in its tangent plane. There are many: nothing is told twice.
struct CellClaim {
  Index face, site;
  std::array<PackedVec2, 3> corner;
  double squared_distance(int i) const { return corner[i].squaredNorm(); }
  EdgeLine line_along(Index side) const {
    return {site, squared_distance(side % 3), squared_distance(Mesh::next(side) % 3)};
  }
};

/// The claims on every face that several sites may share; the other faces belong to one cell.
class FaceClaims {
 public:
  FaceClaims(const Mesh& mesh, Index site_count)
      : mesh_(mesh), site_count_(site_count), shared_index_(mesh.face_count(), k_none), first_{0} {}
  virtual ~FaceClaims() = default;

  const Mesh& mesh() const { return mesh_; }
  Index site_count() const { return site_count_; }
  /// The site nearest to a vertex (ties: the smaller) and its distance. A face whose corners' labels differ is shared.
  virtual Index label(Index vertex) const = 0;
  virtual double distance(Index vertex) const = 0;

  /// The shared faces, in increasing order.
  Index shared_count() const { return static_cast<Index>(faces_.size()); }
  Index face(Index shared) const { return faces_[shared]; }
  /// Its claims, by site.
  std::span<const FaceClaim> claims(Index shared) const {
    return {claims_.data() + first_[shared], claims_.data() + first_[shared + 1]};
  }
  /// Claims are numbered face after face.
  Index claim_count() const { return static_cast<Index>(claims_.size()); }
  Index first_claim(Index shared) const { return first_[shared]; }
  /// Number of a face among the shared ones, k_none for others.
  Index shared_index(Index face) const { return shared_index_[face]; }
  /// The cell that owns a face whole, k_none for shared ones.
  Index face_site(Index face) const {
    return shared_index_[face] == k_none ? label(mesh().triangles()[face][0]) : k_none;
  }

  /// The claims' squared distances along a half-edge of a shared face, by site.
  void lines_along(Index shared, Index halfedge, std::vector<EdgeLine>& lines) const;

 protected:
  const Mesh& mesh_;
  const Index site_count_;
  std::vector<Index> shared_index_, faces_, first_;
  std::vector<FaceClaim> claims_;
};

/// Claims by the labels and distances of the graph, on faces in the order of VertexRings.
///
/// Claims on a face start with the labels of its corners and the sites that lie in it; a site that is nearest on a part
/// of an edge claims the face beyond, too, until nothing changes. Thus cells smaller than a face, or without any
/// vertex, are found: a cell is connected, and its site's own face begins the walk.
///
/// Keeps its memory for other sites, and the cells whose own sites and borders are as they were: where few sites move,
/// few cells are found anew, and the others are the same to the bit.
class CellClaims {
 public:
  /// Nothing is claimed before `find`. Both must outlive the claims.
  /// `lengths`, `cuda_device` as for SiteMaps.
  CellClaims(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int threads,
             int cuda_device);
  ~CellClaims();

  /// The sites must have passed check_sites. \throw Cancelled, and then holds nothing of use.
  void find(const SurfacePoints& sites, const JobStage& stage);
  /// Finds cells that have grown beyond what their sites were asked for anew: then they are as if those had been asked
  /// without end. Of a `find` in which most sites moved; others do so themselves. \throw Cancelled, as `find`.
  void look_farther(const JobStage& stage);
  /// The next `find` keeps nothing.
  void forget() { is_complete_ = false; }
  /// As SiteMaps::renumber. The next `find` must be of as many sites.
  void renumber(std::span<const Index> before);
  /// Whether the last `find` left the cell, the parts of faces that it owns and how it sees them, as it was.
  bool is_as_before(Index site) const { return is_as_before_[site] != 0; }

  const SiteMaps& maps() const { return maps_; }
  const VertexRings& rings() const { return rings_; }
  Index site_count() const { return maps_.site_count(); }

  /// Faces that several sites may share; the others belong to one cell.
  Index shared_count() const { return static_cast<Index>(rows_.size()); }
  Index face(Index shared) const { return rows_[shared].face; }
  /// Number of a face among the shared ones, k_none for others.
  Index shared_index(Index face) const { return shared_index_[face]; }
  /// Of a shared face, by site. Their corners are the face's.
  std::span<const CellClaim> claims(Index shared) const {
    return {claims_.data() + rows_[shared].first, static_cast<std::size_t>(rows_[shared].count)};
  }
  /// All, and where those of a shared face begin; some between belong to no face.
  Index claim_count() const { return static_cast<Index>(claims_.size()); }
  Index first_claim(Index shared) const { return rows_[shared].first; }
  /// Whether a face about the node is shared.
  bool is_at_border(Index node) const { return at_border_[node] != 0; }
  /// The shared faces from one face up to another, by their numbers: in order, those that labels made shared, then
  /// those that cells without a vertex of theirs cross.
  struct Stretch {
    Index first, last, first_late, last_late;
  };
  Stretch shared_within(Index first_face, Index end_face) const;

 private:
  struct Worker;
  struct Row {
    Index face, first, count;
  };
  struct Wish {
    Index face, site;
    Index side;  ///< of the face, beyond which the site is nearest; k_none: it lies in the face
    auto operator<=>(const Wish&) const = default;
  };
  class Laid;
  /// What is looked up of the cells before.
  struct Before {
    LargeArray<Index> shared_index;
    LargeArray<Row> rows;
    LargeArray<CellClaim> claims;
    std::span<const CellClaim> on(Index face) const {
      if (shared_index.empty() || shared_index[face] == k_none) return {};
      const Row& row = rows[shared_index[face]];
      return {claims.data() + row.first, static_cast<std::size_t>(row.count)};
    }
  };
  void find_once(const SurfacePoints& sites, std::span<const double> reaches,
                 const std::optional<std::vector<Index>>& others, const JobStage& stage);
  std::vector<double> reaches(const SurfacePoints& sites) const;
  std::vector<Index> sites_that_moved(const SurfacePoints& sites) const;
  bool is_kept(Index site) const { return is_kept_[site] != 0; }
  void remember();
  void find_mixed_faces();
  void keep_claims();
  const CellClaim* kept_claim(Index face, Index site) const;
  void compare();
  void claim_by_cells(const JobStage& stage);
  double claim_from(Index node, Index site, Worker& worker);
  void find_wishes_of_sites(const SurfacePoints& sites);
  void spread(const SurfacePoints& sites, const JobStage& stage);
  void forget_late();
  std::vector<Wish> all_wishes();
  void merge_late();
  std::span<CellClaim> claims_of(const Row& row) {
    return {claims_.data() + row.first, static_cast<std::size_t>(row.count)};
  }
  void reach_corners(const CellClaim& claim);
  void mark_border(Index face);
  void grant(const std::vector<Wish>& wishes, Laid& laid);
  bool make_claim(Index face, Index site, const Laid& laid, Worker& worker, CellClaim& claim) const;
  void lay_corners(Index side, Laid& laid, CellClaim& claim) const;
  void yield_to_labels(CellClaim& claim);
  template <class Visit>
  void visit_claims(Index face, Visit&& visit) const;
  bool is_settled(Index face) const;
  bool is_claimed(Index face, Index site) const;
  void find_wishes(Index face, Worker& worker) const;
  void wish_for(const Wish& wish, std::vector<Wish>& wishes) const;
  Index face_site(Index face) const { return maps_.label(rings_.face(face).nodes[0]); }

  const SaddleVertexGraph& graph_;
  const VertexRings& rings_;
  const int threads_;
  SiteMaps maps_;
  std::vector<Worker> workers_;
  LargeArray<Index> shared_index_;  ///< by face
  LargeArray<Row> rows_;
  Index mixed_count_ = 0;  ///< of rows_, those of faces whose corners' labels differ
  LargeArray<CellClaim> claims_;
  std::vector<std::uint8_t> at_border_;  ///< by node
  std::vector<double> reach_;  ///< by site: how far it sees the farthest corner that it claims; 0 where it claims none
  std::vector<std::uint8_t> has_laid_;      ///< by site: corners were laid for it; who asks first has a say
  std::vector<std::uint8_t> is_as_before_;  ///< by site
  std::vector<std::uint8_t> is_kept_;       ///< by site: how it sees corners is as it was
  bool is_complete_ = false;
  Before before_;
  // Found while claims spread:
  struct Late {
    CellClaim claim;
    Index before;  ///< the face's one before, k_none for the first
  };
  std::vector<Index> late_index_;  ///< by face: its last one in late_, or k_none
  std::vector<Late> late_;
  Index first_fresh_ = 0;          ///< of late_, since faces were last looked at; 0: all claims are new
  std::vector<Index> late_faces_;  ///< in increasing order
};

/// The same by the faces and vertices of the mesh. The cells must outlive it.
class ClaimsOfCells final : public FaceClaims {
 public:
  explicit ClaimsOfCells(const CellClaims& cells);
  Index label(Index vertex) const override { return cells_.maps().label(graph_.node_of(vertex)); }
  double distance(Index vertex) const override { return cells_.maps().own_distance(graph_.node_of(vertex)); }

 private:
  const CellClaims& cells_;
  const SaddleVertexGraph& graph_;
};

}  // namespace saddleback
