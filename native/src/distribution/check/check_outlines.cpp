// Outlines as chains of pieces: that they are closed, and that no two have a point in common.

#include <algorithm>
#include <numeric>

#include "distribution/check/check_parts.h"
#include "predicates/predicates.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

int side(const Vec2& a, const Vec2& b, const Vec2& p) {
  return static_cast<int>(predicates::orient_2d({a.x(), a.y()}, {b.x(), b.y()}, {p.x(), p.y()}));
}

bool is_between(const Vec2& a, const Vec2& b, const Vec2& p) {
  return p.x() >= std::min(a.x(), b.x()) && p.x() <= std::max(a.x(), b.x()) && p.y() >= std::min(a.y(), b.y()) &&
         p.y() <= std::max(a.y(), b.y());
}

enum class Meeting : std::uint8_t { none, touch, cross };

Meeting meeting_of(const CheckedPiece& p, const CheckedPiece& q) {
  for (int i = 0; i < 2; ++i)
    if (std::max(p.begin[i], p.end[i]) < std::min(q.begin[i], q.end[i]) ||
        std::max(q.begin[i], q.end[i]) < std::min(p.begin[i], p.end[i]))
      return Meeting::none;
  const int a = side(p.begin, p.end, q.begin), b = side(p.begin, p.end, q.end);
  const int c = side(q.begin, q.end, p.begin), d = side(q.begin, q.end, p.end);
  if (a * b < 0 && c * d < 0) return Meeting::cross;
  const bool touches = (a == 0 && is_between(p.begin, p.end, q.begin)) ||
                       (b == 0 && is_between(p.begin, p.end, q.end)) ||
                       (c == 0 && is_between(q.begin, q.end, p.begin)) || (d == 0 && is_between(q.begin, q.end, p.end));
  return touches ? Meeting::touch : Meeting::none;
}

/// Tells whether a meeting of pieces is a fault. Rounding may lay an outline along itself; one that crosses itself has
/// pieces that meet and do not follow each other.
bool is_fault(const CheckedPiece& p, const CheckedPiece& q, Meeting meeting) {
  if (p.shape != q.shape) return meeting != Meeting::none;
  return meeting == Meeting::cross && p.previous != q.number && q.previous != p.number;
}

/// Moves on to the same point in the face across the edge that the piece leaves by.
bool leads_on(const Mesh& mesh, const OutlinePiece& piece, const OutlinePiece& next) {
  if (piece.exit == k_none) return next.face == piece.face && next.begin == piece.end;
  const Index twin = mesh.twin(piece.exit);
  if (twin == k_none || Mesh::face_of(piece.exit) != piece.face || Mesh::face_of(twin) != next.face) return false;
  const Vec3 here = outline_point(piece.face, piece.end).barycentric;
  const Vec3 there = outline_point(next.face, next.begin).barycentric;
  const int i = piece.exit % 3, j = twin % 3;
  return here[(i + 2) % 3] == 0 && there[(j + 2) % 3] == 0 && here[i] == there[(j + 1) % 3] &&
         here[(i + 1) % 3] == there[j];
}

}  // namespace

CheckedPieces list_pieces(const Mesh& mesh, std::span<const MappedShape> mapped) {
  CheckedPieces result;
  for (std::size_t s = 0; s < mapped.size(); ++s) {
    const SurfaceOutline& outline = mapped[s].outline;
    for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
      const std::size_t first = outline.loop_begins[loop], end = outline.loop_begins[loop + 1];
      for (std::size_t k = first; k < end; ++k) {
        const OutlinePiece& piece = outline.pieces[k];
        result.pieces.push_back({piece.face, static_cast<Index>(s), static_cast<Index>(k),
                                 static_cast<Index>(k == first ? end - 1 : k - 1), piece.begin, piece.end});
      }
    }
  }
  std::stable_sort(result.pieces.begin(), result.pieces.end(),
                   [](const CheckedPiece& a, const CheckedPiece& b) { return a.face < b.face; });
  std::vector<std::size_t> begins(static_cast<std::size_t>(mesh.face_count()) + 1, 0);
  for (const CheckedPiece& piece : result.pieces) ++begins[piece.face + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  result.boxes = FaceBoxes(std::move(begins),
                           [&](std::size_t i) { return box_around(result.pieces[i].begin, result.pieces[i].end); });
  return result;
}

void check_chains(const Mesh& mesh, std::span<const MappedShape> mapped, FaultList& faults) {
  for (std::size_t s = 0; s < mapped.size(); ++s) {
    const SurfaceOutline& outline = mapped[s].outline;
    for (std::size_t loop = 0; loop + 1 < outline.loop_begins.size(); ++loop) {
      const std::size_t first = outline.loop_begins[loop], end = outline.loop_begins[loop + 1];
      for (std::size_t k = first; k < end; ++k) {
        const OutlinePiece &piece = outline.pieces[k], &next = outline.pieces[k + 1 < end ? k + 1 : first];
        if (!leads_on(mesh, piece, next))
          faults.add(Fault::open, static_cast<Index>(s), k_none, outline_point(piece.face, piece.end));
      }
    }
  }
}

void check_crossings(const CheckedPieces& checked, const CheckOptions& options, const JobStage& stage,
                     FaultList& faults) {
  constexpr std::size_t k_chunk = 1024;
  const std::vector<CheckedPiece>& pieces = checked.pieces;
  std::vector<FaultList> found(pieces.size() / k_chunk + 1);
  parallel_for(static_cast<Index>(found.size()), options.threads, 1, [&](Index chunk, int) {
    std::vector<std::size_t> met;
    const std::size_t begin = static_cast<std::size_t>(chunk) * k_chunk;
    for (std::size_t i = begin; i < std::min(pieces.size(), begin + k_chunk); ++i) {
      stage.check();
      const CheckedPiece& piece = pieces[i];
      met.clear();
      checked.boxes.visit(piece.face, box_around(piece.begin, piece.end), [&](std::size_t j) {
        if (j > i && is_fault(piece, pieces[j], meeting_of(piece, pieces[j]))) met.push_back(j);
      });
      std::sort(met.begin(), met.end());
      for (const std::size_t j : met)
        found[chunk].add(Fault::crossing, piece.shape, pieces[j].shape == piece.shape ? k_none : pieces[j].shape,
                         outline_point(piece.face, 0.5 * (piece.begin + piece.end)));
    }
  });
  for (const FaultList& list : found) faults.add(list);
}

}  // namespace saddleback
