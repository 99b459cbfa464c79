// Finds which shapes each vertex lies in, from the edges that outlines cross; then whether a loop of an outline begins
// within another shape.

#include <algorithm>
#include <numeric>

#include "distribution/check/check_parts.h"
#include "mesh/tables/outgoing.h"
#include "predicates/predicates.h"

namespace saddleback {
namespace {

/// Holds how often one outline crosses an edge inwards, seen along its smaller half-edge, less outwards.
struct EdgeCount {
  Index edge;
  int sum;
};

std::vector<EdgeCount> count_crossings(const Mesh& mesh, const SurfaceOutline& outline) {
  std::vector<EdgeCount> all;
  for (const OutlinePiece& piece : outline.pieces) {
    if (piece.exit == k_none) continue;
    // The shape is on the left of the piece: on the edge that it leaves by, towards its end.
    const Index twin = mesh.twin(piece.exit);
    const bool is_smaller = twin == k_none || piece.exit < twin;
    all.push_back({is_smaller ? piece.exit : twin, is_smaller ? 1 : -1});
  }
  std::sort(all.begin(), all.end(), [](const EdgeCount& a, const EdgeCount& b) { return a.edge < b.edge; });
  std::vector<EdgeCount> result;
  for (const EdgeCount& count : all) {
    if (result.empty() || result.back().edge != count.edge)
      result.push_back(count);
    else
      result.back().sum += count.sum;
  }
  return result;
}

class Nesting {
 public:
  Nesting(const Mesh& mesh, std::span<const MappedShape> mapped, const CheckedPieces& pieces, FaultList& faults)
      : mesh_(mesh),
        mapped_(mapped),
        pieces_(pieces),
        faults_(faults),
        last_owner_(static_cast<std::size_t>(mesh.vertex_count()), k_none) {}

  void run(const JobStage& stage) {
    for (std::size_t s = 0; s < mapped_.size(); ++s) {
      stage.check();
      spread(static_cast<Index>(s));
    }
    sort_owners();
    for (std::size_t s = 0; s < mapped_.size(); ++s) {
      const SurfaceOutline& outline = mapped_[s].outline;
      for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
        stage.check();
        look_around(static_cast<Index>(s), outline.pieces[outline.loop_begins[loop]]);
      }
    }
  }

 private:
  struct Owner {
    Index vertex, shape;
  };

  /// Spreads from vertices that the outline's crossings show to be inside, over edges that it does not cross.
  void spread(Index shape) {
    const std::vector<EdgeCount> counts = count_crossings(mesh_, mapped_[shape].outline);
    front_.clear();
    for (const auto& [edge, sum] : counts) {
      if (sum > 1 || sum < -1) faults_.add(Fault::open, shape, k_none, at_vertex(mesh_, mesh_.from(edge)));
      if (sum > 0) own(mesh_.to(edge), shape);
      if (sum < 0) own(mesh_.from(edge), shape);
    }
    while (!front_.empty()) {
      const Index vertex = front_.back();
      front_.pop_back();
      for (const Index h : outgoing(mesh_, vertex)) {
        if (!is_rim(counts, h)) own(mesh_.to(h), shape);
        const Index last = Mesh::prev(h);
        if (mesh_.twin(last) == k_none && !is_rim(counts, last)) own(mesh_.from(last), shape);
      }
    }
  }

  /// Tells whether one end of the edge is inside and one is not.
  bool is_rim(const std::vector<EdgeCount>& counts, Index h) const {
    const Index twin = mesh_.twin(h), edge = twin == k_none ? h : std::min(h, twin);
    const auto at = std::lower_bound(counts.begin(), counts.end(), edge,
                                     [](const EdgeCount& count, Index wanted) { return count.edge < wanted; });
    return at != counts.end() && at->edge == edge && at->sum != 0;
  }

  void own(Index vertex, Index shape) {
    if (last_owner_[vertex] == shape) return;
    last_owner_[vertex] = shape;
    found_.push_back({vertex, shape});
    front_.push_back(vertex);
  }

  void sort_owners() {
    owner_begins_.assign(static_cast<std::size_t>(mesh_.vertex_count()) + 1, 0);
    for (const Owner& owner : found_) ++owner_begins_[owner.vertex + 1];
    std::partial_sum(owner_begins_.begin(), owner_begins_.end(), owner_begins_.begin());
    std::vector<std::size_t> next(owner_begins_.begin(), owner_begins_.end() - 1);
    owners_.resize(found_.size());
    for (const Owner& owner : found_) owners_[next[owner.vertex]++] = owner.shape;
  }

  /// A point of one of the shape's loops against all others in its face and around it. Where no outlines meet, one that
  /// overlaps another has a loop within it, or the other way round; which of its loops, nobody knows.
  void look_around(Index shape, const OutlinePiece& piece) {
    const Vec3 weights = outline_point(piece.face, piece.begin).barycentric;
    // From the corner opposite to the edge that the point may lie on: the line runs inside of the face.
    const int corner = weights[0] == 0 ? 0 : weights[1] == 0 ? 1 : 2;
    const Vec2 from = corner == 0 ? Vec2(0, 0) : corner == 1 ? Vec2(1, 0) : Vec2(0, 1);
    inside_.clear();
    const Index vertex = mesh_.from(3 * piece.face + corner);
    for (std::size_t i = owner_begins_[vertex]; i < owner_begins_[vertex + 1]; ++i) inside_.push_back(owners_[i]);
    pieces_.boxes.visit(piece.face, box_around(from, piece.begin), [&](std::size_t i) {
      const CheckedPiece& other = pieces_.pieces[i];
      if (other.shape != shape && crosses(from, piece.begin, other)) inside_.push_back(other.shape);
    });
    // Each crossing leads in or out: those that are listed an odd number of times hold the point.
    std::sort(inside_.begin(), inside_.end());
    for (std::size_t i = 0, end; i < inside_.size(); i = end) {
      for (end = i; end < inside_.size() && inside_[end] == inside_[i];) ++end;
      if ((end - i) % 2 == 1 && inside_[i] != shape)
        faults_.add(Fault::nesting, shape, inside_[i], outline_point(piece.face, piece.begin));
    }
  }

  static bool crosses(const Vec2& from, const Vec2& to, const CheckedPiece& piece) {
    const auto is_left = [](const Vec2& a, const Vec2& b, const Vec2& p) {
      return predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {p.x(), p.y()}) == predicates::Sign::positive;
    };
    return is_left(from, to, piece.begin) != is_left(from, to, piece.end) &&
           is_left(piece.begin, piece.end, from) != is_left(piece.begin, piece.end, to);
  }

  const Mesh& mesh_;
  std::span<const MappedShape> mapped_;
  const CheckedPieces& pieces_;
  FaultList& faults_;
  std::vector<Index> last_owner_;  ///< per vertex the last shape that was found to hold it
  std::vector<Owner> found_;
  std::vector<std::size_t> owner_begins_;  ///< (V + 1)
  std::vector<Index> owners_;              ///< per vertex all shapes that hold it
  std::vector<Index> front_, inside_;
};

}  // namespace

void check_nesting(const Mesh& mesh, std::span<const MappedShape> mapped, const CheckedPieces& pieces,
                   const JobStage& stage, FaultList& faults) {
  Nesting(mesh, mapped, pieces, faults).run(stage);
}

}  // namespace saddleback
