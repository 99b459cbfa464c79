#pragma once
// Which sites may own a part of which face.

#include <array>
#include <span>
#include <vector>

#include "tessellation/edge_envelope.h"
#include "tessellation/site_maps.h"

namespace saddleback {

/// \throw InputError naming the first offender: no sites, a site off the mesh, a component without a site.
void check_sites(const Mesh& mesh, const SurfacePoints& sites);

/// A site that may own a part of a face, and how it sees the face's corners.
struct FaceClaim {
  Index face, site;
  std::array<SiteVector, 3> corner;
  double squared_distance(int i) const { return corner[i].distance * corner[i].distance; }
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

/// Claims by the labels and distances of the graph.
///
/// Claims on a face start with the labels of its corners and the sites that lie in it; a site that is nearest on a part
/// of an edge claims the face beyond, too, until nothing changes. Thus cells smaller than a face, or without any
/// vertex, are found: a cell is connected, and its site's own face begins the walk.
class CellClaims final : public FaceClaims {
 public:
  /// The sites must have passed check_sites; the graph and its rings must outlive the claims. \throw Cancelled.
  /// `reaches` as for SiteMaps.
  CellClaims(const SaddleVertexGraph& graph, const VertexRings& rings, const SurfacePoints& sites,
             std::span<const double> reaches, int threads, const JobStage& stage);

  const SiteMaps& maps() const { return maps_; }
  Index label(Index vertex) const override { return maps_.label(vertex); }
  double distance(Index vertex) const override { return maps_.own(vertex).distance; }

 private:
  struct Worker;
  struct Wish {
    Index face, site;
    Index halfedge;  ///< of the face, beyond which the site is nearest; k_none: it lies in the face
    auto operator<=>(const Wish&) const = default;
  };
  struct Laid;
  void find_mixed_faces(int threads);
  void claim_by_corners(std::vector<Worker>& workers, int threads, const JobStage& stage);
  std::vector<Wish> wishes_of_sites(const SurfacePoints& sites) const;
  void spread(const SurfacePoints& sites, std::vector<Worker>& workers, int threads, const JobStage& stage);
  void merge_late();
  void grant(const std::vector<Wish>& wishes, Laid& laid, std::vector<Worker>& workers, int threads);
  bool make_claim(Index face, Index site, const Laid& laid, Worker& worker, FaceClaim& claim) const;
  void lay_corners(Index halfedge, Laid& laid, FaceClaim& claim) const;
  template <class Visit>
  void visit_claims(Index face, Visit&& visit) const;
  void find_wishes(Index face, Worker& worker) const;
  void wish_for(const Wish& wish, std::vector<Wish>& wishes) const;

  SiteMaps maps_;
  // Found while claims spread:
  std::vector<Index> late_index_;  ///< per face, into late_; k_none
  std::vector<std::vector<FaceClaim>> late_;
};

}  // namespace saddleback
