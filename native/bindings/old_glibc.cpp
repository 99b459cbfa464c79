// Lets the module run on glibc 2.28 (2018) and later, though it is linked against a newer one: the linker sends every
// reference to the names below here (--wrap), and from here they go to the version that old systems have.
//
// Which names these are, addon/package tells: it asks for manylinux_2_28, and auditwheel names whatever is newer. The
// old pow, log and log2 are the new ones in a wrapper that sets errno.
#include <cstdint>
#include <ctime>
#include <sys/random.h>
#include <sys/stat.h>

#define OLD_VERSION(alias, name) asm(".symver " #alias ", " #name "@GLIBC_2.2.5")

#define SEND_TO_OLD_VERSION(name)                                                                  \
  OLD_VERSION(old_##name, name);                                                                   \
  asm(".pushsection .text\n.globl __wrap_" #name "\n.hidden __wrap_" #name "\n.type __wrap_" #name \
      ", @function\n__wrap_" #name ": jmp *old_" #name "@GOTPCREL(%rip)\n.popsection")

SEND_TO_OLD_VERSION(log);
SEND_TO_OLD_VERSION(log2);
SEND_TO_OLD_VERSION(pow);
SEND_TO_OLD_VERSION(pthread_attr_getstacksize);
SEND_TO_OLD_VERSION(pthread_create);
SEND_TO_OLD_VERSION(pthread_detach);
SEND_TO_OLD_VERSION(pthread_getspecific);
SEND_TO_OLD_VERSION(pthread_join);
SEND_TO_OLD_VERSION(pthread_key_create);
SEND_TO_OLD_VERSION(pthread_key_delete);
SEND_TO_OLD_VERSION(pthread_once);
SEND_TO_OLD_VERSION(pthread_rwlock_rdlock);
SEND_TO_OLD_VERSION(pthread_rwlock_unlock);
SEND_TO_OLD_VERSION(pthread_rwlock_wrlock);
SEND_TO_OLD_VERSION(pthread_setspecific);
SEND_TO_OLD_VERSION(pthread_sigmask);

OLD_VERSION(old_pthread_mutex_timedlock, pthread_mutex_timedlock);
OLD_VERSION(old_fxstat, __fxstat);
OLD_VERSION(old_lxstat, __lxstat);
OLD_VERSION(old_xstat, __xstat);

extern "C" {
int old_pthread_mutex_timedlock(pthread_mutex_t*, const timespec*);
int old_fxstat(int version, int file, struct stat*);
int old_lxstat(int version, const char* path, struct stat*);
int old_xstat(int version, const char* path, struct stat*);

// The linker's option --wrap asks for these names.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)

// What did not exist under any version: "false" is right for every process, and means a lock more.
char __wrap___libc_single_threaded = 0;

std::uint32_t __wrap_arc4random() {
  std::uint32_t value;
  while (getrandom(&value, sizeof value, 0) != sizeof value) {}
  return value;
}

int __wrap_pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock, const timespec* until) {
  timespec now, wall;
  clock_gettime(clock, &now);
  clock_gettime(CLOCK_REALTIME, &wall);
  constexpr long k_second = 1'000'000'000;
  const long nanoseconds = wall.tv_nsec + until->tv_nsec - now.tv_nsec + k_second;  // 0 to 3 seconds
  const timespec wall_until{wall.tv_sec + until->tv_sec - now.tv_sec + nanoseconds / k_second - 1,
                            nanoseconds % k_second};
  return old_pthread_mutex_timedlock(mutex, &wall_until);
}

constexpr int k_stat_version = 1;
int __wrap_fstat(int file, struct stat* result) { return old_fxstat(k_stat_version, file, result); }
int __wrap_fstat64(int file, struct stat* result) { return old_fxstat(k_stat_version, file, result); }
int __wrap_lstat(const char* path, struct stat* result) { return old_lxstat(k_stat_version, path, result); }
int __wrap_stat(const char* path, struct stat* result) { return old_xstat(k_stat_version, path, result); }
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
}
