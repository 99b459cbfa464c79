#pragma once
// Collects what is wrong with a mesh and says it in one sentence that names the first three offenders.

#include <cstddef>
#include <string>

#include "saddleback/error.h"

namespace saddleback {

class Offenders {
 public:
  /// Counts one offender; the first ones are described, and only for them is `describe()` called.
  template <class Describe>
  void add(Describe&& describe) {
    if (count_ < k_named) text_ += (count_ ? ", " : "") + describe();
    ++count_;
  }
  bool empty() const { return count_ == 0; }

  /// \throw MeshError "2 non-manifold edges: edge (0, 1) has 3 faces, ...; saddleback.repair mends this", if there are
  /// any.
  void throw_if_any(const std::string& singular, const std::string& plural, const std::string& remedy) const {
    if (count_ == 0) return;
    throw MeshError(message(count_, " ", count_ == 1 ? singular : plural, ": ", text_, count_ > k_named ? ", ..." : "",
                            "; ", remedy));
  }

 private:
  static constexpr std::size_t k_named = 3;
  std::size_t count_ = 0;
  std::string text_;
};

}  // namespace saddleback
