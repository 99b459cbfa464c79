#pragma once
// Cells that the next relaxation may begin with.

#include <array>
#include <memory>
#include <mutex>

namespace saddleback {

/// Keeps the cells that a relaxation ended with. The next one on the same graph with the same density finds anew only
/// those whose sites, or whose neighbors' sites, are elsewhere: of 5,000 sites one that is moved, added or removed
/// costs its surroundings. The sites that stay must be in the same order as before. What is kept is about as much
/// memory as a relaxation takes: 1 KB a vertex.
///
/// The graph must outlive what is kept of it. Two calls at a time may have the same cache: one of them begins with
/// nothing.
class CellCache {
 public:
  struct Content;  // of the library
  CellCache();
  ~CellCache();
  CellCache(const CellCache&) = delete;
  CellCache& operator=(const CellCache&) = delete;
  /// Forgets what is kept.
  void clear();

  /// Tells two uses of the library apart: cells that a relaxation looked at last, and those that it showed of its
  /// result.
  enum class Cells { relaxed, shown };
  /// Returns what is kept, and nothing from then on; and something to keep. Null is nothing.
  std::unique_ptr<Content> take(Cells which);
  void put(Cells which, std::unique_ptr<Content> content);

 private:
  std::mutex mutex_;
  std::array<std::unique_ptr<Content>, 2> contents_;
};

}  // namespace saddleback
