#include "saddleback/job.h"

#include <algorithm>

#include "saddleback/error.h"

namespace saddleback {

std::string Job::text() const {
  constexpr int k_most_dots = 3;
  State& state = *state_;
  const std::lock_guard lock(state.text_mutex);
  const bool stands_still = fraction() == state.read_fraction && !state.text.empty();
  const bool is_alive = state.alive.exchange(false, std::memory_order_relaxed);
  state.read_fraction = fraction();
  if (!stands_still) {
    state.dots = 0;
  } else if (is_alive) {
    state.dots = state.dots % k_most_dots + 1;
  }
  return state.text + std::string(static_cast<std::size_t>(state.dots), '.');
}

Job Job::part(double begin, double end) const {
  if (!(0 <= begin && begin <= end && end <= 1))
    throw InputError(message("begin, end: wanted 0 <= begin <= end <= 1, got ", begin, " and ", end));
  Job result = *this;
  result.begin_ = begin_ + (end_ - begin_) * begin;
  result.end_ = begin_ + (end_ - begin_) * end;
  return result;
}

void Job::update(double fraction) const {
  JobStage stage;
  stage.job_ = state_.get();
  stage.begin_ = begin_;
  stage.end_ = end_;
  stage.update(fraction);
}

JobStage::JobStage(Job* job, const std::string& text) {
  if (!job) return;
  job_ = job->state_.get();
  begin_ = job->begin_;
  end_ = job->end_;
  check();
  if (begin_ == 0) job_->fraction.store(0.0, std::memory_order_relaxed);
  update(0);
  set_text(text);
}

JobStage JobStage::part(double begin, double end, const std::string& text) const {
  JobStage result = *this;
  result.begin_ = begin_ + (end_ - begin_) * begin;
  result.end_ = begin_ + (end_ - begin_) * end;
  if (!text.empty()) result.set_text(text);
  return result;
}

void JobStage::update(double fraction) const {
  check();
  raise(fraction);
}

void JobStage::raise(double fraction) const {
  if (!job_) return;
  const double wanted = begin_ + (end_ - begin_) * std::clamp(fraction, 0.0, 1.0);
  double seen = job_->fraction.load(std::memory_order_relaxed);
  while (wanted > seen && !job_->fraction.compare_exchange_weak(seen, wanted, std::memory_order_relaxed)) {}
}

void JobStage::set_text(const std::string& text) const {
  if (!job_) return;
  const std::lock_guard lock(job_->text_mutex);
  job_->text = text;
  job_->read_fraction = -1;
}

void JobStage::throw_cancelled() { throw Cancelled(); }

}  // namespace saddleback
