#include "saddleback/tessellation/relaxation_watch.h"

#include <utility>

namespace saddleback {

void RelaxationWatch::show(RelaxationStep step) {
  auto shown = std::make_shared<const RelaxationStep>(std::move(step));
  const std::lock_guard lock(mutex_);
  latest_.swap(shown);  // what was shown before is freed outside, if nobody looks at it
}

std::shared_ptr<const RelaxationStep> RelaxationWatch::latest() const {
  const std::lock_guard lock(mutex_);
  return latest_;
}

}  // namespace saddleback
