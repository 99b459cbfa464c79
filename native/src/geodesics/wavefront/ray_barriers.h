#pragma once
// Barriers that end rays: the curve itself, beyond which all is nearer to where they meet it.

#include <utility>
#include <vector>

#include "geodesics/unfolding/unfolding.h"
#include "geodesics/wavefront/ray_window.h"

namespace saddleback {

/// Straight pieces of faces that no ray need cross. With those rays gone no window has a root in the area that it
/// sweeps, which "one angle, one split" supposes.
class RayBarriers {
 public:
  explicit RayBarriers(const Unfolding& unfolding) : unfolding_(unfolding), mesh_(unfolding.mesh()) {}

  void clear();
  /// Ends of the piece, barycentric in the face. All of them before the first question.
  void add(Index face, const Vec3& begin, const Vec3& end);
  bool empty() const { return pieces_.empty(); }

  /// The face that the window's rays are in: the one that it enters, or the one that it comes out of.
  enum class Side { entered, left };
  /// Calls `use` with the parts of the window whose rays meet no piece in the face. A piece that the rays set out from,
  /// or from an end of, does not stop them.
  template <class Use>
  void for_each_free_part(RayWindow window, Side side, Use&& use) const {
    const Index half = side == Side::entered ? window.halfedge : mesh_.twin(window.halfedge);
    if (empty() || first_[Mesh::face_of(half)] == k_none) return use(window);
    const double end = window.b1;
    for (const auto& [from, to] : shadows(window, half, side)) {
      if (from > window.b0) {
        window.b1 = from;
        use(window);
      }
      window.b0 = to;
    }
    window.b1 = end;
    if (window.b1 > window.b0) use(window);
  }

 private:
  struct Piece {
    Vec3 begin, end;
    Index next;  ///< of the same face
  };
  using Intervals = std::vector<std::pair<double, double>>;

  Intervals shadows(const RayWindow& window, Index half, Side side) const;
  Vec2 place(const Vec3& barycentric, Index half, Side side) const;

  const Unfolding& unfolding_;
  const Mesh& mesh_;
  std::vector<Piece> pieces_;
  std::vector<Index> first_;  ///< piece of each face
  std::vector<Index> faces_;  ///< that have one
};

}  // namespace saddleback
