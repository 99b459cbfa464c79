// Every face with pieces of outlines is triangulated for itself. Points on edges are the same numbers in both faces
// (OutlinePiece), so neighbors fit. Which shape a triangle belongs to spreads from the left sides of the pieces.

#include "saddleback/shape_mapping/cut_shapes.h"

#include <algorithm>

#include "saddleback/error.h"

#include "mesh/cutting/constrained_triangulation.h"
#include "predicates/predicates.h"

namespace saddleback {
namespace {

/// A piece with the ids of its ends: vertices of the mesh, then the ends of all pieces.
struct FacePiece {
  Index face, shape;
  Index begin_id, end_id;
  Vec2 begin, end;
};

constexpr Index k_unknown = -2;
constexpr Index k_faces_between_looks = 1024;

class Cutter {
 public:
  Cutter(const Mesh& mesh, std::span<const MappedShape> shapes, Job* job)
      : mesh_(mesh),
        shapes_(shapes),
        stage_(job, "cutting outlines into the surface"),
        face_shape_(static_cast<std::size_t>(mesh.face_count()), k_none),
        vertex_shape_(static_cast<std::size_t>(mesh.vertex_count()), k_none),
        vertex_plane_(static_cast<std::size_t>(mesh.vertex_count()), Vec2::Zero()),
        vertex_ids_(static_cast<std::size_t>(mesh.vertex_count()), k_none) {}

  CutMesh whole() {
    for (Index v = 0; v < mesh_.vertex_count(); ++v) vertex_ids_[v] = v;
    for (std::size_t s = 0; s < shapes_.size(); ++s) mark(s);
    for (Index v = 0; v < mesh_.vertex_count(); ++v) add_vertex(at_vertex(mesh_, v), v, vertex_plane_[v]);
    for (std::size_t s = 0; s < shapes_.size(); ++s) list_pieces(s);
    sort_pieces();
    std::size_t next = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) {
      if (f % k_faces_between_looks == 0) stage_.update(static_cast<double>(f) / mesh_.face_count());
      next = cut_face(f, next);
    }
    stage_.update(1);
    return std::move(result_);
  }

  /// One after the other, so that nothing of another shape is in the way.
  CutMesh patches() {
    is_only_shapes_ = true;
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      stage_.update(static_cast<double>(s) / static_cast<double>(shapes_.size()));
      mark(s);
      pieces_.clear();
      list_pieces(s);
      sort_pieces();
      faces_ = shapes_[s].outline.faces;
      std::sort(faces_.begin(), faces_.end());
      std::size_t next = 0;
      for (const Index face : faces_) next = cut_face(face, next);
      for (const Index vertex : used_) vertex_ids_[vertex] = k_none;
      used_.clear();
    }
    stage_.update(1);
    return std::move(result_);
  }

 private:
  void mark(std::size_t s) {
    const SurfaceOutline& outline = shapes_[s].outline;
    for (const Index face : outline.faces) face_shape_[face] = static_cast<Index>(s);
    for (std::size_t i = 0; i < outline.inside.size(); ++i) {
      Index& shape = vertex_shape_[outline.inside[i]];
      if (shape != k_none && !is_only_shapes_)
        refuse(shape, static_cast<Index>(s), Mesh::face_of(mesh_.first_halfedge(outline.inside[i])));
      shape = static_cast<Index>(s);
      vertex_plane_[outline.inside[i]] = outline.inside_plane[i];
    }
  }

  /// Lists them with the ends of the pieces as vertices.
  void list_pieces(std::size_t s) {
    const SurfaceOutline& outline = shapes_[s].outline;
    const auto id = static_cast<Index>(result_.vertices.size());
    for (const OutlinePiece& piece : outline.pieces)
      add_vertex(outline_point(piece.face, piece.end), k_none, piece.plane_end);
    for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
      const std::size_t first = outline.loop_begins[loop], last = outline.loop_begins[loop + 1] - 1;
      for (std::size_t k = first; k <= last; ++k) {
        const OutlinePiece& piece = outline.pieces[k];
        const auto before = static_cast<Index>(k == first ? last : k - 1);
        pieces_.push_back(
            {piece.face, static_cast<Index>(s), id + before, id + static_cast<Index>(k), piece.begin, piece.end});
      }
    }
  }

  void sort_pieces() {
    std::stable_sort(pieces_.begin(), pieces_.end(),
                     [](const FacePiece& a, const FacePiece& b) { return a.face < b.face; });
  }

  void add_vertex(const SurfacePoint& point, Index origin, const Vec2& plane) {
    result_.vertices.push_back(point);
    result_.vertex_origin.push_back(origin);
    result_.vertex_plane.push_back(plane);
  }

  /// The id of a vertex of the mesh.
  Index id_of(Index vertex) {
    Index& id = vertex_ids_[vertex];
    if (id == k_none) {
      id = static_cast<Index>(result_.vertices.size());
      used_.push_back(vertex);
      add_vertex(at_vertex(mesh_, vertex), vertex, vertex_plane_[vertex]);
    }
    return id;
  }

  /// `next`: the first piece that is not in an earlier face; gives that of the next face.
  std::size_t cut_face(Index face, std::size_t next) {
    const std::size_t begin = next;
    while (next < pieces_.size() && pieces_[next].face == face) ++next;
    if (begin != next) {
      cut(face, std::span(pieces_).subspan(begin, next - begin));
    } else {
      ids_.assign(mesh_.triangles()[face].begin(), mesh_.triangles()[face].end());
      add_triangle({0, 1, 2}, face, face_shape_[face]);
    }
    return next;
  }

  /// A triangle of points of ids_, of which the first three are vertices of the mesh.
  void add_triangle(const Triangle& points, Index face, Index shape) {
    if (shape == k_none && is_only_shapes_) return;
    Triangle triangle;
    for (int i = 0; i < 3; ++i) triangle[i] = points[i] < 3 ? id_of(ids_[points[i]]) : ids_[points[i]];
    result_.triangles.push_back(triangle);
    result_.triangle_face.push_back(face);
    result_.triangle_shape.push_back(shape);
  }

  void cut(Index face, std::span<const FacePiece> pieces) {
    const FaceChart chart(mesh_, face);
    flat_.begin({chart.corner[0], chart.corner[1], chart.corner[2]});
    const Triangle& corners = mesh_.triangles()[face];
    ids_.assign(corners.begin(), corners.end());
    ends_.clear();
    for (const FacePiece& piece : pieces)
      ends_.push_back({add_point(piece.begin, piece.begin_id), add_point(piece.end, piece.end_id)});
    for (std::size_t i = 0; i < pieces.size(); ++i)
      if (!flat_.connect(ends_[i][0], ends_[i][1])) refuse(pieces[i], pieces.first(i));
    flat_.improve();
    label(face, pieces);
    for (std::size_t t = 0; t < flat_.triangle_count(); ++t) add_triangle(flat_.triangle(t), face, labels_[t]);
  }

  Index add_point(const Vec2& weights, Index id) {
    const Index point = flat_.add(weights);
    if (point == static_cast<Index>(ids_.size())) ids_.push_back(id);
    return point;
  }

  /// A piece and one that runs back along it (a corner that rounding has put on an edge) bound nothing.
  void label(Index face, std::span<const FacePiece> pieces) {
    labels_.assign(flat_.triangle_count(), k_unknown);
    left_.assign(3 * flat_.triangle_count(), k_unknown);
    front_.clear();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      edges_.clear();
      flat_.edges_along(ends_[i][0], ends_[i][1], edges_);
      for (const Index h : edges_) {
        if (left_[h] != k_unknown && left_[h] != pieces[i].shape) refuse(left_[h], pieces[i].shape, face);
        left_[h] = pieces[i].shape;
      }
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
    spread(set);
    // What no piece bounds from within is as the corners of the face are: rounding may have turned a sliver over, or
    // another shape lies around all of this.
    const std::array<Index, 3> corners = {corner_shape(face, 0, pieces), corner_shape(face, 1, pieces),
                                          corner_shape(face, 2, pieces)};
    for (std::size_t t = 0; t < labels_.size(); ++t)
      if (labels_[t] == k_unknown)
        for (const Index point : flat_.triangle(t))
          if (point < 3 && corners[point] != k_none) set(static_cast<Index>(t), corners[point]);
    spread(set);
    const auto is_other = [&](Index shape) { return shape != k_none && shape != pieces.front().shape; };
    if (std::ranges::any_of(corners, is_other) || is_other(pieces.back().shape)) check_labels(face, corners);
    for (std::size_t t = 0; t < labels_.size(); ++t) set(static_cast<Index>(t), k_none);
  }

  /// The shape that a corner of the face lies in; of those that are cut out one by one, only the one that is.
  Index corner_shape(Index face, Index corner, std::span<const FacePiece> pieces) const {
    const Index shape = vertex_shape_[mesh_.from(3 * face + corner)];
    return is_only_shapes_ && shape != pieces.front().shape ? k_none : shape;
  }

  /// Checks a face's labels: of shapes that do not overlap, what lies right of an outline is in none (or left of
  /// another one that touches it), and what lies at a corner of the face in the one that the corner is in. Since
  /// whatever an outline or a vertex bounds is looked at so, overlapping ones differ somewhere. What differs only from
  /// itself has been rounded so.
  void check_labels(Index face, const std::array<Index, 3>& corners) const {
    const auto differ = [](Index a, Index b) { return a >= 0 && b >= 0 && a != b; };
    for (std::size_t h = 0; h < left_.size(); ++h) {
      const Index label = labels_[h / 3], point = flat_.triangle(h / 3)[h % 3],
                  twin = flat_.twin(static_cast<Index>(h));
      if (left_[h] == k_unknown && twin != k_none && differ(label, left_[twin])) refuse(label, left_[twin], face);
      if (point >= 3) continue;
      if (differ(label, corners[point])) refuse(label, corners[point], face);
    }
  }

  template <class Set>
  void spread(Set&& set) {
    while (!front_.empty()) {
      const Index t = front_.back();
      front_.pop_back();
      for (int k = 0; k < 3; ++k) set(flat_.neighbor(static_cast<std::size_t>(t), k), labels_[t]);
    }
  }

  [[noreturn]] static void refuse(Index one, Index other, Index face) {
    throw InputError(
        message("shapes ", std::min(one, other), " and ", std::max(one, other), " overlap in face ", face));
  }

  /// Collects the parts of a piece that crosses one of the earlier ones.
  [[noreturn]] static void refuse(const FacePiece& piece, std::span<const FacePiece> earlier) {
    const auto parts = [](const FacePiece& one, const FacePiece& other) {
      const auto side = [&](const Vec2& p) {
        return static_cast<int>(
            predicates::orient_2d({one.begin.x(), one.begin.y()}, {one.end.x(), one.end.y()}, {p.x(), p.y()}));
      };
      return side(other.begin) * side(other.end) < 0;
    };
    for (const FacePiece& other : earlier)
      if (other.shape != piece.shape && parts(piece, other) && parts(other, piece))
        refuse(other.shape, piece.shape, piece.face);
    throw InputError(message("the outline of shape ", piece.shape, " crosses itself in face ", piece.face));
  }

  const Mesh& mesh_;
  std::span<const MappedShape> shapes_;
  JobStage stage_;
  bool is_only_shapes_ = false;
  std::vector<Index> face_shape_;  ///< of faces without pieces
  std::vector<Index> vertex_shape_;
  std::vector<Vec2> vertex_plane_;
  std::vector<Index> vertex_ids_, used_;  ///< k_none: not in the result yet
  std::vector<Index> faces_;
  std::vector<FacePiece> pieces_;  ///< by face
  ConstrainedTriangulation flat_;
  std::vector<Index> ids_;  ///< of the points of flat_
  std::vector<std::array<Index, 2>> ends_;
  std::vector<Index> labels_, left_, front_, edges_;
  CutMesh result_;
};

}  // namespace

CutMesh cut_shapes(const Mesh& mesh, std::span<const MappedShape> shapes, CutPart part, Job* job) {
  Cutter cutter(mesh, shapes, job);
  return part == CutPart::everything ? cutter.whole() : cutter.patches();
}

}  // namespace saddleback
