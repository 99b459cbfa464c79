#pragma once
// Cells that the next relaxation may begin with.

#include <memory>

namespace saddleback {

/// Keeps the cells that a relaxation ended with. The next one on the same graph finds anew only those whose sites, or
/// whose neighbors' sites, are elsewhere: of 5,000 sites one that is moved, added or removed costs its surroundings.
/// With another density cells stay, too, but for their masses and centers. The sites that stay must be in the same
/// order as before. What is kept is about as much memory as a relaxation takes: 1 KB a vertex.
///
/// The graph must outlive what is kept of it. Two calls at a time may have the same cache: one of them begins with
/// nothing.
class CellCache {
 public:
  CellCache();
  ~CellCache();
  CellCache(const CellCache&) = delete;
  CellCache& operator=(const CellCache&) = delete;
  /// Forgets what is kept.
  void clear();

 private:
  friend class BorrowedCells;
  class Content;
  std::unique_ptr<Content> content_;
};

}  // namespace saddleback
