#include "convert/interrupt.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "convert/convert.h"
#include "support/threads/thread_team.h"

namespace saddleback::bindings {
namespace {

std::atomic<Job*> g_interrupted{nullptr};  ///< the innermost call of the main thread
static_assert(std::atomic<Job*>::is_always_lock_free, "a signal's handler takes no lock");

// Python's handler is called afterwards, as if this one were not there.
#if defined(_WIN32)
using Handler = void (*)(int);
Handler g_previous = SIG_DFL;

void on_interrupt(int signal) {
  if (Job* const job = g_interrupted.load()) job->cancel();
  if (g_previous != SIG_DFL && g_previous != SIG_IGN) g_previous(signal);
}
void install() { g_previous = std::signal(SIGINT, on_interrupt); }
void uninstall() { std::signal(SIGINT, g_previous); }
#else
struct sigaction g_previous;

void on_interrupt(int signal, siginfo_t* info, void* context) {
  if (Job* const job = g_interrupted.load()) job->cancel();
  if (g_previous.sa_flags & SA_SIGINFO)
    g_previous.sa_sigaction(signal, info, context);
  else if (g_previous.sa_handler != SIG_DFL && g_previous.sa_handler != SIG_IGN)
    g_previous.sa_handler(signal);
}
void install() {
  struct sigaction wanted {};
  wanted.sa_sigaction = on_interrupt;
  wanted.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&wanted.sa_mask);
  sigaction(SIGINT, &wanted, &g_previous);
}
void uninstall() { sigaction(SIGINT, &g_previous, nullptr); }
#endif

// Kept for the life of the process.
py::handle g_get_handler, g_default_handler, g_main_thread;

/// Tells whether this is the main thread and Ctrl-C would raise KeyboardInterrupt in it.
bool would_interrupt() {
  if (py::cast<unsigned long>(g_main_thread().attr("ident")) != PyThread_get_thread_ident()) return false;
  return g_get_handler(SIGINT).is(g_default_handler);
}

}  // namespace

void prepare_interrupts() {
  const py::module_ signals = py::module_::import("_signal");
  g_get_handler = signals.attr("getsignal").cast<py::object>().release();
  g_default_handler = signals.attr("default_int_handler").cast<py::object>().release();
  g_main_thread = py::module_::import("threading").attr("main_thread").cast<py::object>().release();
}

CancelOnInterrupt::CancelOnInterrupt(Job& job) {
  if (!would_interrupt()) return;
  is_installed_ = true;
  outer_ = g_interrupted.exchange(&job);
  if (!outer_) install();
}

CancelOnInterrupt::~CancelOnInterrupt() {
  if (!is_installed_) return;
  if (!outer_) uninstall();
  g_interrupted.store(outer_);
}

JobIn::JobIn(const py::object& value) : job_(value.is_none() ? &own_ : as_job(value)), interrupt_(*job_) {
  touch_thread_data();  // each long call begins here, in any thread of Python's
}

void lock_python_again(PyThreadState* state) noexcept {
  // When the interpreter ends, CPython before 3.14 ends a daemon thread that asks for the lock, by pthread_exit, which
  // unwinds our frames and so touches Python objects without the lock, or aborts where unwinding is forbidden. The
  // thread stays here instead, as with CPython 3.14: the process ends soon. (The handler is never left.)
  try {
    PyEval_RestoreThread(state);
  } catch (...) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

}  // namespace saddleback::bindings
