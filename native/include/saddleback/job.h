#pragma once
// Progress and cancellation of long work, shared between the thread that computes and the one that watches.

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

namespace saddleback {

/// A token that one thread computes with and any other thread may read (`fraction`, `text`) or stop (`cancel`).
/// Work that takes a Job* accepts nullptr, meaning nobody watches. Reused Jobs start again from 0.
class Job {
 public:
  /// A job for a part of this one's work, from `begin` to `end` in its 0..1: several calls, each with the part that
  /// comes after the last one's, report one rising fraction. What is done to one of them is done to all.
  /// \throw InputError unless 0 <= begin <= end <= 1.
  Job part(double begin, double end) const;
  /// Says how far the work between calls has come, in 0..1. \throw Cancelled when asked to stop.
  void update(double fraction) const;

  /// Share of the whole work done, 0 to 1, never falling during one call, nor from part to part.
  double fraction() const { return state_->fraction.load(std::memory_order_relaxed); }
  /// Returns what is being done, for a person to read. While the fraction stands still but work goes on, dots that
  /// follow it change from call to call.
  std::string text() const;
  /// Asks the work to stop; it does so within 0.1 s by throwing Cancelled.
  void cancel() { state_->cancelled.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return state_->cancelled.load(std::memory_order_relaxed); }

 private:
  friend class JobStage;
  struct State {
    std::atomic<double> fraction{0.0};
    std::atomic<bool> cancelled{false};
    std::atomic<bool> alive{false};  ///< since the text was read, work has asked whether to stop
    std::mutex text_mutex;
    double read_fraction = -1;  ///< when the text was read last
    int dots = 0;
    std::string text;
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
  double begin_ = 0, end_ = 1;  ///< of the whole work
};

/// One part of a job's work: maps its own 0..1 onto [begin, end] of the job, so that algorithms built from others
/// report one rising fraction. A JobStage without a job costs nothing. Safe to use from several threads.
class JobStage {
 public:
  JobStage() = default;
  /// The whole of `job` (may be null); resets its fraction to 0, that of a part to where it begins.
  JobStage(Job* job, const std::string& text);
  /// A part of this stage, from `begin` to `end` in its own 0..1.
  JobStage part(double begin, double end, const std::string& text = {}) const;

  /// Reports progress in 0..1 of this stage and throws Cancelled when asked to stop.
  void update(double fraction) const;
  /// Reports that all of it is done, also where it was asked to stop meanwhile.
  void finish() const { raise(1); }
  /// Throws Cancelled when asked to stop. Cheap enough for every few microseconds of work.
  void check() const {
    if (!job_) return;
    if (job_->cancelled.load(std::memory_order_relaxed)) throw_cancelled();
    // Looked at first: threads that only read a line of memory do not take it from each other.
    if (!job_->alive.load(std::memory_order_relaxed)) job_->alive.store(true, std::memory_order_relaxed);
  }
  bool cancelled() const { return job_ && job_->cancelled.load(std::memory_order_relaxed); }

 private:
  friend class Job;
  [[noreturn]] static void throw_cancelled();
  void raise(double fraction) const;
  void set_text(const std::string& text) const;
  Job::State* job_ = nullptr;
  double begin_ = 0, end_ = 1;
};

}  // namespace saddleback
