// Every face with pieces of outlines is triangulated for itself. Points on edges are the same numbers in both faces
// (OutlinePiece), so neighbours fit. Which shape a triangle belongs to spreads from the left sides of the pieces.

#include "saddleback/cut_shapes.h"

#include <algorithm>

#include "saddleback/error.h"

#include "shape_mapping/constrained_triangulation.h"

namespace saddleback {
namespace {

/// A piece with the ids of its ends: vertices of the mesh, then the ends of all pieces.
struct FacePiece {
  Index face, shape;
  Index begin_id, end_id;
  Vec2 begin, end;
};

constexpr Index k_unknown = -2;

class Cutter {
 public:
  Cutter(const Mesh& mesh, std::span<const MappedShape> shapes, CutPart part)
      : mesh_(mesh),
        shapes_(shapes),
        part_(part),
        face_shape_(static_cast<std::size_t>(mesh.face_count()), k_none),
        vertex_shape_(static_cast<std::size_t>(mesh.vertex_count()), k_none) {}

  CutMesh run() {
    list_pieces();
    add_vertices();
    std::size_t next = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      const std::size_t begin = next;
      while (next < pieces_.size() && pieces_[next].face == f) ++next;
      if (begin == next)
        add_whole(f);
      else
        cut(f, std::span(pieces_).subspan(begin, next - begin));
    }
    if (part_ == CutPart::shapes) drop_unused();
    return std::move(result_);
  }

 private:
  void list_pieces() {
    Index id = mesh_.vertex_count();
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      const SurfaceOutline& outline = shapes_[s].outline;
      for (const Index face : outline.faces) face_shape_[face] = static_cast<Index>(s);
      for (const Index vertex : outline.inside) vertex_shape_[vertex] = static_cast<Index>(s);
      for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
        const std::size_t first = outline.loop_begins[loop], last = outline.loop_begins[loop + 1] - 1;
        for (std::size_t k = first; k <= last; ++k) {
          const OutlinePiece& piece = outline.pieces[k];
          const auto before = static_cast<Index>(k == first ? last : k - 1);
          pieces_.push_back(
              {piece.face, static_cast<Index>(s), id + before, id + static_cast<Index>(k), piece.begin, piece.end});
        }
      }
      id += static_cast<Index>(outline.pieces.size());
    }
    std::stable_sort(pieces_.begin(), pieces_.end(),
                     [](const FacePiece& a, const FacePiece& b) { return a.face < b.face; });
  }

  void add_vertices() {
    const auto add = [&](const SurfacePoint& point, Index origin, const Vec2& plane) {
      result_.vertices.push_back(point);
      result_.vertex_origin.push_back(origin);
      result_.vertex_plane.push_back(plane);
    };
    for (Index v = 0; v < mesh_.vertex_count(); ++v) add(at_vertex(mesh_, v), v, Vec2::Zero());
    for (const MappedShape& shape : shapes_) {
      const SurfaceOutline& outline = shape.outline;
      for (const OutlinePiece& piece : outline.pieces)
        add(outline_point(piece.face, piece.end), k_none, piece.plane_end);
      for (std::size_t i = 0; i < outline.inside.size(); ++i)
        result_.vertex_plane[outline.inside[i]] = outline.inside_plane[i];
    }
  }

  void add_triangle(const Triangle& triangle, Index face, Index shape) {
    if (shape == k_none && part_ == CutPart::shapes) return;
    result_.triangles.push_back(triangle);
    result_.triangle_face.push_back(face);
    result_.triangle_shape.push_back(shape);
  }

  void add_whole(Index face) { add_triangle(mesh_.triangles()[face], face, face_shape_[face]); }

  void cut(Index face, std::span<const FacePiece> pieces) {
    const FaceChart chart(mesh_, face);
    flat_.begin({chart.corner[0], chart.corner[1], chart.corner[2]});
    const Triangle& corners = mesh_.triangles()[face];
    ids_.assign(corners.begin(), corners.end());
    ends_.clear();
    for (const FacePiece& piece : pieces)
      ends_.push_back({add_point(piece.begin, piece.begin_id), add_point(piece.end, piece.end_id)});
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (!flat_.connect(ends_[i][0], ends_[i][1])) refuse(face, pieces);
    flat_.improve();
    label(face, pieces);
    for (std::size_t t = 0; t < flat_.triangle_count(); ++t) {
      const Triangle local = flat_.triangle(t);
      add_triangle({ids_[local[0]], ids_[local[1]], ids_[local[2]]}, face, labels_[t]);
    }
  }

  Index add_point(const Vec2& weights, Index id) {
    const Index point = flat_.add(weights);
    if (point == static_cast<Index>(ids_.size())) ids_.push_back(id);
    return point;
  }

  /// A piece and one that runs back along it (a corner that rounding has put on an edge) bound nothing. Where no others
  /// are left the face is as its corners are.
  void label(Index face, std::span<const FacePiece> pieces) {
    labels_.assign(flat_.triangle_count(), k_unknown);
    left_.assign(3 * flat_.triangle_count(), k_unknown);
    front_.clear();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      edges_.clear();
      flat_.edges_along(ends_[i][0], ends_[i][1], edges_);
      for (const Index h : edges_) left_[h] = pieces[i].shape;
    }
    const auto set = [&](Index t, Index shape) {
      if (t == k_none || labels_[t] != k_unknown) return;
      labels_[t] = shape;
      front_.push_back(t);
    };
    for (std::size_t h = 0; h < left_.size(); ++h) {
      const Index twin = flat_.twin(static_cast<Index>(h));
      const bool is_undone = twin != k_none && left_[twin] == left_[h];
      if (left_[h] != k_unknown && !is_undone) set(static_cast<Index>(h / 3), left_[h]);
    }
    const Index rest = front_.empty() ? vertex_shape_[mesh_.from(3 * face)] : k_none;
    spread(set);
    for (std::size_t t = 0; t < labels_.size(); ++t) set(static_cast<Index>(t), rest);
  }

  template <class Set>
  void spread(Set&& set) {
    while (!front_.empty()) {
      const Index t = front_.back();
      front_.pop_back();
      for (int k = 0; k < 3; ++k) set(flat_.neighbour(static_cast<std::size_t>(t), k), labels_[t]);
    }
  }

  [[noreturn]] void refuse(Index face, std::span<const FacePiece> pieces) const {
    Index other = pieces.front().shape;
    for (const FacePiece& piece : pieces)
      if (piece.shape != other)
        throw InputError(message("shapes ", other, " and ", piece.shape, " overlap in face ", face));
    throw InputError(message("the outline of shape ", other, " crosses itself in face ", face));
  }

  void drop_unused() {
    std::vector<Index> number(result_.vertices.size(), k_none);
    for (const Triangle& triangle : result_.triangles)
      for (const Index v : triangle) number[v] = 0;
    Index count = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
      if (number[v] == k_none) continue;
      result_.vertices[count] = result_.vertices[v];
      result_.vertex_origin[count] = result_.vertex_origin[v];
      result_.vertex_plane[count] = result_.vertex_plane[v];
      number[v] = count++;
    }
    result_.vertices.resize(static_cast<std::size_t>(count));
    result_.vertex_origin.resize(static_cast<std::size_t>(count));
    result_.vertex_plane.resize(static_cast<std::size_t>(count));
    for (Triangle& triangle : result_.triangles)
      for (Index& v : triangle) v = number[v];
  }

  const Mesh& mesh_;
  std::span<const MappedShape> shapes_;
  CutPart part_;
  std::vector<Index> face_shape_;  ///< of faces without pieces
  std::vector<Index> vertex_shape_;
  std::vector<FacePiece> pieces_;  ///< by face
  ConstrainedTriangulation flat_;
  std::vector<Index> ids_;  ///< of the points of flat_
  std::vector<std::array<Index, 2>> ends_;
  std::vector<Index> labels_, left_, front_, edges_;
  CutMesh result_;
};

}  // namespace

CutMesh cut_shapes(const Mesh& mesh, std::span<const MappedShape> shapes, CutPart part) {
  return Cutter(mesh, shapes, part).run();
}

}  // namespace saddleback
