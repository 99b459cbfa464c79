#include "saddleback/job.h"

#include <algorithm>

#include "saddleback/error.h"

namespace saddleback {

std::string Job::text() const {
  constexpr int k_most_dots = 3;
  const std::lock_guard lock(text_mutex_);
  const bool stands_still = fraction() == read_fraction_ && !text_.empty();
  const bool is_alive = alive_.exchange(false, std::memory_order_relaxed);
  read_fraction_ = fraction();
  if (!stands_still) {
    dots_ = 0;
  } else if (is_alive) {
    dots_ = dots_ % k_most_dots + 1;
  }
  return text_ + std::string(static_cast<std::size_t>(dots_), '.');
}

JobStage::JobStage(Job* job, const std::string& text) : job_(job) {
  if (!job_) return;
  check();
  job_->fraction_.store(0.0, std::memory_order_relaxed);
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
  if (!job_) return;
  check();
  const double wanted = begin_ + (end_ - begin_) * std::clamp(fraction, 0.0, 1.0);
  double seen = job_->fraction_.load(std::memory_order_relaxed);
  while (wanted > seen && !job_->fraction_.compare_exchange_weak(seen, wanted, std::memory_order_relaxed)) {}
}

void JobStage::set_text(const std::string& text) const {
  if (!job_) return;
  const std::lock_guard lock(job_->text_mutex_);
  job_->text_ = text;
  job_->read_fraction_ = -1;
}

void JobStage::throw_cancelled() { throw Cancelled(); }

}  // namespace saddleback
