#pragma once
// Threads that wait for work, lent to one caller at a time.

namespace saddleback {

/// Number of processors that this process may use.
int processor_count();

/// Holds what a member of a team does: a plain function and what it works on.
struct TeamWork {
  void (*function)(void* context, int member);
  void* context;
};

/// Calls work for the members 0 to `members` - 1, member 0 in the calling thread, the others each in a thread of its
/// own, and returns when all are done. Where the system gives no more threads (a limit of memory, or of processes), or
/// other programs hold a thread up until the rest is done, some members are left out: the work must be done whole by
/// those that remain. The work must not throw.
///
/// Any number of threads may call at the same time, also from within a member. The threads stay for later calls; a
/// forked child begins with none, and the end of the program does not wait for them.
void run_team(int members, TeamWork work);

/// Makes what the library keeps for the calling thread, as for exceptions in flight. Else that comes with its first use
/// and, where there is no memory for it, glibc ends the program. Threads of the team have theirs.
void touch_thread_data();

}  // namespace saddleback
