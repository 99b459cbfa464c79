#pragma once
// How long work has taken so far, for those who tell progress.

namespace saddleback {

/// Processor time of the thread that asks, which other work on the machine does not change; where a system does not
/// tell it, the time of day. Only the thread that made a clock may ask it. To look takes less than a
/// microsecond.
class WorkClock {
 public:
  explicit WorkClock(bool is_asked = true) : begin_(is_asked ? now() : 0) {}
  double seconds() const { return now() - begin_; }  ///< since the clock was made

 private:
  static double now();
  double begin_;
};

}  // namespace saddleback
