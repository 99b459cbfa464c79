#pragma once
// Symmetric positive definite systems whose unknowns lie on a surface.

#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// Entries off the diagonal by rows, each pair in both; and the diagonal.
struct SymmetricMatrix {
  std::vector<Index> offsets;  ///< (n + 1) row i is [offsets[i], offsets[i + 1])
  std::vector<Index> columns;
  std::vector<double> values;
  std::vector<double> diagonal;

  Index size() const { return static_cast<Index>(diagonal.size()); }
  std::span<const Index> row(Index i) const {
    return std::span(columns).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
};

/// (n) unknowns in an order that keeps the factors of a matrix sparse: halves of the surface, one after the other, and
/// last what lies between them; the halves in the same way (nested dissection [george1973]). O(n log n).
std::vector<Index> dissection_order(const SymmetricMatrix& matrix, std::span<const Vec3> places);

/// Factors L D L^T, row by row [davis2005], with a look at the job between rows.
class SparseCholesky {
 public:
  /// O(n log n) numbers and O(n^1.5) time on a surface, in dissection order. \throw Cancelled.
  SparseCholesky(const SymmetricMatrix& matrix, std::vector<Index> order, const JobStage& stage);

  /// (n) solutions for right-hand sides. O(entries of L).
  std::vector<Vec2> solve(std::span<const Vec2> right) const;

 private:
  void count_entries(const SymmetricMatrix& matrix);
  Index spread(const SymmetricMatrix& matrix, Index row);
  std::int64_t eliminate(const SymmetricMatrix& matrix, Index row);

  std::vector<Index> order_, place_;  ///< unknown of each row, row of each unknown
  std::vector<Index> parent_;         ///< elimination tree
  std::vector<std::int64_t> offsets_;
  std::vector<Index> rows_;
  std::vector<double> values_, pivots_;
  // While factors are found:
  std::vector<std::int64_t> ends_;  ///< of the columns so far
  std::vector<double> work_;        ///< the row at hand
  std::vector<Index> pattern_, path_, flags_;
};

}  // namespace saddleback
