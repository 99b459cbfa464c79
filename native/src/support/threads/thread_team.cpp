#include "support/threads/thread_team.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#if defined(__linux__)
#include <sched.h>
#endif
#if defined(__unix__) || defined(__APPLE__)
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#define SADDLEBACK_POSIX
#endif
#ifdef _WIN32
#ifndef NOMINMAX  // libstdc++ defines it
#define NOMINMAX
#endif
#include <windows.h>
#endif

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// Looks that a thread takes before it sleeps, about a tenth of a millisecond: loops follow each other closely, and to
/// wake a thread takes long. After the first few it offers its core before each: where other programs are at work, the
/// one it waits for may need that very core.
constexpr int k_looks = 200, k_offers = 300;

void pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

#ifdef _WIN32
// The system's own: where libstdc++ 12 has no futex, its atomics may sleep through a call.
void sleep_while(const std::atomic<std::uint32_t>& counter, std::uint32_t seen) {
  WaitOnAddress(const_cast<std::atomic<std::uint32_t>*>(&counter), &seen, sizeof(seen), INFINITE);
}
void wake(std::atomic<std::uint32_t>& counter) { WakeByAddressSingle(&counter); }
#else
void sleep_while(const std::atomic<std::uint32_t>& counter, std::uint32_t seen) {
  counter.wait(seen, std::memory_order_acquire);
}
void wake(std::atomic<std::uint32_t>& counter) { counter.notify_one(); }
#endif

/// Waits until `counter` is no longer `seen`, and returns what it is then.
std::uint32_t wait_for_change(const std::atomic<std::uint32_t>& counter, std::uint32_t seen) {
  for (int i = 0; i < k_looks + k_offers; ++i) {
    if (const std::uint32_t now = counter.load(std::memory_order_acquire); now != seen) return now;
    if (i < k_looks)
      pause();
    else
      std::this_thread::yield();
  }
  for (;;) {
    sleep_while(counter, seen);
    if (const std::uint32_t now = counter.load(std::memory_order_acquire); now != seen) return now;
  }
}

/// A thread that waits to be asked. It is never destroyed: its thread may wait until the program's very end.
struct alignas(k_apart) Worker {
  std::atomic<std::uint32_t> asked{1};  // first to be there
  std::atomic<std::uint32_t> taken{1};  // the last request that it began with, or that was withdrawn before
  TeamWork work{};
  int member = 0;
  alignas(k_apart) std::atomic<std::uint32_t> answered{0};

  [[noreturn]] void serve() {
    touch_thread_data();
    for (std::uint32_t seen = 1;;) {
      answered.store(seen, std::memory_order_release);
      wake(answered);
      do seen = wait_for_change(asked, seen);
      while (!take(seen));
      work.function(work.context, member);
    }
  }

  void ask(const TeamWork& wanted, int number) {
    work = wanted;
    member = number;
    asked.fetch_add(1, std::memory_order_release);
    wake(asked);
  }

  /// Takes a request, for the worker to begin with or for the asker to withdraw: whoever is first.
  bool take(std::uint32_t request) {
    std::uint32_t before = request - 1;
    return taken.compare_exchange_strong(before, request, std::memory_order_acq_rel);
  }

  /// Withdraws the request where it has not begun, as while other programs have its core; else waits for its end.
  void wait_until_done() {
    const std::uint32_t last = asked.load(std::memory_order_relaxed);
    if (take(last)) return;
    for (std::uint32_t now = answered.load(std::memory_order_acquire); now != last;)
      now = wait_for_change(answered, now);
  }
};

#ifdef SADDLEBACK_POSIX
/// Tells whether a thread's stack fits into memory and leaves some for its own data, see touch_thread_data.
bool has_room_for_thread() {
  constexpr std::size_t k_own_data = 1 << 20;
  std::size_t stack = 0;
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return false;
  pthread_attr_getstacksize(&attributes, &stack);
  pthread_attr_destroy(&attributes);
  void* const room = mmap(nullptr, stack + k_own_data, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) return false;
  munmap(room, stack + k_own_data);
  return true;
}

/// Lets threads that begin while it lives receive no signals: those are for the program's own threads.
class SignalsHeldBack {
 public:
  SignalsHeldBack() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsHeldBack() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsHeldBack(const SignalsHeldBack&) = delete;
  SignalsHeldBack& operator=(const SignalsHeldBack&) = delete;

 private:
  sigset_t before_{};
};
#else
bool has_room_for_thread() { return true; }
struct SignalsHeldBack {};
#endif

/// The workers that nobody has borrowed. One for the process, made at the first parallel loop and never destroyed.
class IdleWorkers {
 public:
  /// Borrows up to `count` workers, new ones where too few are idle; fewer where the system refuses.
  void borrow(int count, std::vector<Worker*>& into) {
    {
      const std::lock_guard lock(mutex_);
      const int taken = std::min(count, static_cast<int>(idle_.size()));
      into.assign(idle_.end() - taken, idle_.end());
      idle_.resize(idle_.size() - taken);
    }
    try {
      while (static_cast<int>(into.size()) < count) into.push_back(begin_worker());
    } catch (const std::system_error&) {
      return;  // no more threads: those that there are do the work
    } catch (const std::bad_alloc&) {
      return;
    }
  }

  void give_back(const std::vector<Worker*>& workers) {
    const std::lock_guard lock(mutex_);
    idle_.insert(idle_.end(), workers.begin(), workers.end());  // there is room: see begin_worker
  }

  static IdleWorkers& of_process();

 private:
  Worker* begin_worker() {
    {
      const std::lock_guard lock(mutex_);
      idle_.reserve(++worker_count_);  // so that to give back never fails
    }
    if (!has_room_for_thread()) throw std::bad_alloc();
    Worker* const worker = new Worker;
    try {
      [[maybe_unused]] const SignalsHeldBack held_back;
      std::thread([worker] { worker->serve(); }).detach();
    } catch (...) {
      delete worker;
      throw;
    }
    worker->wait_until_done();  // before others take the memory that it needs
    return worker;
  }

  std::mutex mutex_;
  std::vector<Worker*> idle_;
  std::size_t worker_count_ = 0;
};

std::atomic<IdleWorkers*> g_idle_workers{nullptr};

#ifdef SADDLEBACK_POSIX
/// A forked child has its parent's memory but none of its threads, and a mutex may have been held at that moment.
void forget_workers() { g_idle_workers.store(nullptr, std::memory_order_relaxed); }
#endif

IdleWorkers& IdleWorkers::of_process() {
  if (IdleWorkers* const there = g_idle_workers.load(std::memory_order_acquire)) return *there;
#ifdef SADDLEBACK_POSIX
  [[maybe_unused]] static const int registered = pthread_atfork(nullptr, nullptr, forget_workers);
#endif
  auto* const fresh = new IdleWorkers;
  IdleWorkers* there = nullptr;
  if (g_idle_workers.compare_exchange_strong(there, fresh, std::memory_order_acq_rel)) return *fresh;
  delete fresh;
  return *there;
}

}  // namespace

void touch_thread_data() {
  [[maybe_unused]] const volatile int asked = std::uncaught_exceptions();  // else the call is left out
}

int processor_count() {
#if defined(__linux__)
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0) return std::max(1, CPU_COUNT(&allowed));
#endif
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void run_team(int members, TeamWork work) {
  IdleWorkers& idle = IdleWorkers::of_process();
  std::vector<Worker*> workers;
  workers.reserve(static_cast<std::size_t>(std::max(0, members - 1)));
  idle.borrow(members - 1, workers);
  for (std::size_t i = 0; i < workers.size(); ++i) workers[i]->ask(work, static_cast<int>(i) + 1);
  work.function(work.context, 0);
  for (Worker* const worker : workers) worker->wait_until_done();
  idle.give_back(workers);
}

}  // namespace saddleback
