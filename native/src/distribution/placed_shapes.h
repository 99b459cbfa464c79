#pragma once
// The copies that lie on the surface: their outlines face by face, and where points near them are in their planes.

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "distribution/collision/collision_shape.h"
#include "distribution/face_buckets.h"
#include "distribution/flat_faces.h"
#include "distribution/local_layout.h"
#include "shape_mapping/outline_mapper.h"

namespace saddleback::distribution {

/// Holds what is laid, or is to be.
struct Copy {
  Placement placement;
  const CollisionShape* body = nullptr;
  double bend = 0;  ///< by how much lengths on it differ from those of its plane, as a share
  double radius() const { return placement.scale * body->shape.circumradius(); }
};

/// Bounds the rounding of where things lie in planes of copies: less than this share of what is looked at from there.
inline constexpr double k_rounding = 1e-6;

class PlacedShapes {
 public:
  /// `least` and `most`: circumradii of what copies may be met by.
  PlacedShapes(const Mesh& mesh, const FlatFaces& flat, double least, double most);

  const Mesh& mesh() const { return *mesh_; }
  std::span<const Copy> copies() const { return copies_; }

  /// Tells exactly whether the outline has no common point with those that lie there and neither lies within the other.
  /// `faces`: those that it touches.
  bool is_free(const Copy& copy, const SurfaceOutline& outline, std::span<const FacePlace> faces) const;

  /// Puts a copy there.
  void add(const Copy& copy, const SurfaceOutline& outline);

  /// Returns how far from its center a copy can be met.
  double reach(const Copy& copy) const { return copy.radius() + reach_; }
  /// Makes known for the copy of this number where faces lie about it, or those that it touches. May be called from
  /// several threads while none looks.
  void add_places(Index copy, const std::vector<FacePlace>& places, bool are_touched);

  /// Calls visit(copy number, FacePlace's origin and turn) for copies that something of the circumradius `reach` about
  /// the point may meet, in no order, until it gives true; then returns true.
  template <class Visit>
  bool visit(Index face, const Vec2& weights, double reach, Visit&& visit) const {
    const Index* const heads = place_heads_.data() + static_cast<std::size_t>(buckets_.at(face, weights)) * rings_;
    const int last = ring_of(reach);
    for (int ring = 0; ring <= last; ++ring)
      for (Index i = heads[ring]; i != k_none; i = place(i).next)
        if (visit(place(i).copy(), place(i).origin.template cast<double>(), place(i).turn.template cast<double>()))
          return true;
    return false;
  }

  /// Calls visit(copy number, place in its plane) for copies that touch the point's face, until it gives true; then
  /// returns true. Elsewhere a plane may cover the surface twice: what seems to lie within the copy is somewhere else.
  template <class Visit>
  bool visit_touching(Index face, const Vec2& weights, Visit&& visit) const {
    const Vec2 in_face = flat_->place(face, weights);
    for (Index i = place_heads_[static_cast<std::size_t>(buckets_.at(face, weights)) * rings_]; i != k_none;
         i = place(i).next) {
      const Place& at = place(i);
      if (at.number < 0 && visit(at.copy(), Vec2(at.origin.cast<double>() + at.turn.cast<double>() * in_face)))
        return true;
    }
    return false;
  }
  /// Finds the place in the plane of one copy.
  bool place_within(Index copy, const SurfacePoint& point, Vec2& found) const {
    return visit_touching(point.face, {point.barycentric[1], point.barycentric[2]},
                          [&](Index number, const Vec2& place) {
                            found = place;
                            return number == copy;
                          });
  }

 private:
  struct Piece {
    Vec2 begin, end;
    Index next;
  };
  /// Holds a place in single precision: there are millions, and all that is decided by them allows for k_rounding.
  struct Place {
    Eigen::Matrix2f turn;
    Eigen::Vector2f origin;
    Index number, next;  ///< of the copy, ~number where it touches the face
    Index copy() const { return number < 0 ? ~number : number; }
  };
  static constexpr Index k_block = 1 << 15;
  struct Start {
    Vec2 weights;
    Index next;
  };

  /// Copies are listed by how large something has to be to meet them: in ring k up to the circumradius least * 2^k.
  int ring_of(double reach) const {
    int ring = 0;
    double radius = least_;
    while (radius < reach && ring + 1 < rings_) {
      radius *= 2;
      ++ring;
    }
    return ring;
  }
  const Place& place(Index i) const { return places_[static_cast<std::size_t>(i / k_block)][i % k_block]; }
  Index make_room(Index count);
  bool is_reached(const FacePlace& place, double reach, Vec2& low, Vec2& high) const;
  bool meets(const OutlinePiece& piece) const;
  bool is_within_another(const OutlinePiece& piece) const;
  bool holds_another(const Copy& copy, std::span<const FacePlace> faces) const;

  const Mesh* mesh_;
  const FlatFaces* flat_;
  double least_, reach_;
  int rings_;
  FaceBuckets buckets_;
  std::vector<Copy> copies_;
  std::vector<Start> starts_;                                   ///< a point of every loop
  std::vector<Index> start_heads_, piece_heads_, place_heads_;  ///< per bucket, of places per ring
  std::vector<Piece> pieces_;
  std::vector<std::unique_ptr<Place[]>> places_;  ///< in blocks, which never move
  Index place_count_ = 0;
  std::mutex places_mutex_;  ///< held while the two grow
};

}  // namespace saddleback::distribution
