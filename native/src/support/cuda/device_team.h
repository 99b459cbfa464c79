#pragma once
// One job on several CUDA devices: a thread for each, and moments at which all wait for all.

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <numeric>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "support/cuda/cuda_check.h"
#include "support/cuda/device_stream.h"

namespace saddleback {

/// Lets `device` read, over whatever links the two, what another's pool holds; where nothing does, copies go through
/// the host.
inline void let_read(int device, int other) {
  int is_linked = 0;
  if (device == other) return;
  check_cuda(cudaDeviceCanAccessPeer(&is_linked, device, other), "asking for links between devices");
  if (!is_linked) return;
  cudaMemPool_t pool = nullptr;
  check_cuda(cudaDeviceGetDefaultMemPool(&pool, other), "asking for the memory pool");
  cudaMemAccessDesc access{};
  access.location = {cudaMemLocationTypeDevice, device};
  access.flags = cudaMemAccessFlagsProtReadWrite;
  check_cuda(cudaMemPoolSetAccess(pool, &access, 1), "linking devices");
}

class DeviceTeam {
 public:
  explicit DeviceTeam(std::span<const int> devices) : devices_(devices.begin(), devices.end()) {}
  int members() const { return static_cast<int>(devices_.size()); }
  int device(int member) const { return devices_[static_cast<std::size_t>(member)]; }

  /// Runs part(member) for all, the first in the calling thread, until all have ended. \throw what the first to fail
  /// threw.
  template <class Part>
  void run(Part&& part) {
    const auto guarded = [&](int member) {
      try {
        part(member);
      } catch (...) {
        fail(std::current_exception());
      }
    };
    for (const int device : devices_)
      for (const int other : devices_) let_read(device, other);
    {
      std::vector<std::jthread> others;
      try {
        for (int member = 1; member < members(); ++member) others.emplace_back(guarded, member);
      } catch (...) {
        fail(std::current_exception());  // or those that run would wait for who never came
      }
      guarded(0);
    }
    if (failure_) std::rethrow_exception(failure_);
  }

  /// Waits until all are here. \throw Stopped when one of them failed.
  void meet() {
    std::unique_lock lock(mutex_);
    if (++here_ == members()) {
      here_ = 0;
      ++meetings_;
      changed_.notify_all();
    } else {
      const auto is_over = [&, met = meetings_.load()] { return meetings_ != met || has_failed_; };
      lock.unlock();
      look_for_others(is_over);
      lock.lock();
      changed_.wait(lock, is_over);
    }
    if (failure_) throw Stopped();
  }
  /// \throw Stopped when one of them failed.
  void check() {
    const std::lock_guard lock(mutex_);
    if (failure_) throw Stopped();
  }

 private:
  void fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_) failure_ = std::move(failure);
    has_failed_ = true;
    changed_.notify_all();
  }

  /// Looks for others for a while: who sleeps is woken some tenth of a millisecond late, and most of those waited for
  /// come sooner.
  template <class IsOver>
  static void look_for_others(IsOver&& is_over) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::milliseconds k_while{1};
    for (const auto end = Clock::now() + k_while; !is_over() && Clock::now() < end;) std::this_thread::yield();
  }

  std::vector<int> devices_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int here_ = 0;
  std::atomic<int> meetings_ = 0;
  std::atomic<bool> has_failed_ = false;  ///< whether there is a failure_
  std::exception_ptr failure_;
};

/// The caller of the CUDA module, asked by a team's threads, one at a time.
template <class Caller>
class TeamCaller {
 public:
  TeamCaller(const Caller& caller, DeviceTeam& team)
      : caller_(caller), team_(team), done_(static_cast<std::size_t>(team.members())) {}

  /// Tells the share that all have done. \throw Stopped
  void report(int member, double fraction) {
    team_.check();
    ask([&](const Caller& caller) {
      done_[static_cast<std::size_t>(member)] = fraction;
      return caller.keep_going(caller.self, std::accumulate(done_.begin(), done_.end(), 0.0) / team_.members());
    });
  }
  /// \throw Stopped when the answer is false.
  template <class Question>
  void ask(Question&& question) {
    const std::lock_guard lock(mutex_);
    if (!question(caller_)) throw Stopped();
  }

 private:
  const Caller& caller_;
  DeviceTeam& team_;
  std::mutex mutex_;
  std::vector<double> done_;  ///< by member
};

/// Holds what all members of a team say at a meeting.
template <class Word>
class TeamWords {
 public:
  explicit TeamWords(DeviceTeam& team) : team_(team), said_(static_cast<std::size_t>(team.members())) {}
  /// Gives each member's word to all; all members call it. \return by member
  std::vector<Word> say(int member, const Word& word) {
    Said& mine = said_[static_cast<std::size_t>(member)];
    const std::size_t turn = mine.times++ % 2;  // others may still look at what was said before
    mine.words[turn] = word;
    team_.meet();
    std::vector<Word> words;
    for (const Said& each : said_) words.push_back(each.words[turn]);
    return words;
  }

 private:
  struct Said {
    std::size_t times = 0;
    std::array<Word, 2> words{};
  };
  DeviceTeam& team_;
  std::vector<Said> said_;  ///< by member
};

/// A member's list, on its device.
template <class Item>
struct TeamList {
  int device = 0;
  std::span<const Item> items;
};

/// Arrays of which every member of a team fills a part, and then has the whole.
class TeamArrays {
 public:
  explicit TeamArrays(DeviceTeam& team) : team_(team), numbers_(team), lists_(team) {}

  /// Returns the numbers of all members; all members call it.
  std::vector<std::int64_t> numbers_of_all(int member, std::int64_t number) { return numbers_.say(member, number); }
  /// Returns the lists of all members; all members call it. Theirs are to stay as they are until the copies of others
  /// have been waited for.
  template <class Item>
  std::vector<TeamList<Item>> lists_of_all(int member, std::span<const Item> mine) {
    std::vector<TeamList<Item>> lists;
    for (const ListThere& there : lists_.say(member, {team_.device(member), mine.data(), mine.size()}))
      lists.push_back({there.device, {static_cast<const Item*>(there.items), there.count}});
    return lists;
  }
  /// Is called by all members: `mine` is the member's own copy of the array, `begins` tell where the parts begin and
  /// where the last ends. Complete on return.
  template <class Number>
  void share(int member, Number* mine, std::span<const std::int32_t> begins, cudaStream_t stream) {
    const int members = team_.members();
    if (members == 1) return;
    check_cuda(cudaStreamSynchronize(stream), "waiting for the device");
    const std::vector<TeamList<Number>> arrays =
        lists_of_all(member, std::span<const Number>(mine, static_cast<std::size_t>(begins.back())));
    for (int step = 1; step < members; ++step) {  // each reads from another
      const auto other = static_cast<std::size_t>((member + step) % members);
      const auto begin = static_cast<std::size_t>(begins[other]), end = static_cast<std::size_t>(begins[other + 1]);
      if (begin == end) continue;
      check_cuda(cudaMemcpyPeerAsync(mine + begin, team_.device(member), arrays[other].items.data() + begin,
                                     arrays[other].device, (end - begin) * sizeof(Number), stream),
                 "copying between devices");
    }
    check_cuda(cudaStreamSynchronize(stream), "copying between devices");
    team_.meet();
  }

 private:
  struct ListThere {
    int device = 0;
    const void* items = nullptr;
    std::size_t count = 0;
  };
  DeviceTeam& team_;
  TeamWords<std::int64_t> numbers_;
  TeamWords<ListThere> lists_;
};

}  // namespace saddleback
