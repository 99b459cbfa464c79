#pragma once
// Memory of large arrays to come, touched for the first time while other work goes on.

#include <cstddef>
#include <vector>

#include "saddleback/support/large_array.h"

namespace saddleback {

/// The first touch of a page can take as long as all that is done with it later: a system clears it, and a virtual
/// machine may have to ask its host for it. So arrays whose size grows with the work before them get their pages in
/// step with that work, which then tells how far it is. Freed pages stay at hand for the next large arrays; for more
/// than stay nothing is done.
class PrefaultedPages {
 public:
  /// Towards as many pages as arrays of so many bytes have, a few at a time: to be called often. \throw std::bad_alloc
  void extend(std::size_t bytes);
  /// Leaves the pages to whoever makes a large array next.
  void release() { chunks_ = {}; }

 private:
  std::vector<LargeArray<std::byte>> chunks_;
};

}  // namespace saddleback
