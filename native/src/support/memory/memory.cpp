#include "support/memory/memory.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "saddleback/error.h"

#if defined(_WIN32)
#ifndef NOMINMAX  // libstdc++ defines it
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <sys/resource.h>
#include <unistd.h>
#endif

namespace saddleback {

std::string in_gigabytes(double bytes) { return message(std::ceil(bytes / 1e8) / 10, " GB"); }

#if defined(_WIN32)

std::size_t available_memory() {
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof(status);
  return GlobalMemoryStatusEx(&status) ? static_cast<std::size_t>(status.ullAvailPhys) : 0;
}

#else

namespace {

constexpr std::size_t k_unlimited = std::numeric_limits<std::size_t>::max();

/// The number in a file, or behind a word in it; k_unlimited where there is none ("max", no such file).
std::size_t number_in(const std::string& path, const std::string& word = {}) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.compare(0, word.size(), word) != 0) continue;
    std::size_t digits = line.find_first_of("0123456789", word.size()), value = 0;
    for (; digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])); ++digits)
      value = 10 * value + static_cast<std::size_t>(line[digits] - '0');
    return line.find_first_of("0123456789", word.size()) == line.npos ? k_unlimited : value;
  }
  return k_unlimited;
}

/// Returns what a container's limit leaves, by the files of a control group; caches of files are given back when
/// needed.
std::size_t left_in_group(const std::string& folder, const char* limit, const char* usage) {
  const std::size_t most = number_in(folder + limit), used = number_in(folder + usage);
  if (most == k_unlimited || used == k_unlimited) return k_unlimited;
  const std::size_t cached = number_in(folder + "/memory.stat", "inactive_file ");
  const std::size_t needed = cached == k_unlimited ? used : used - std::min(used, cached);
  return most - std::min(most, needed);
}

/// Returns the memory left under this process's control group and all that contain it, of version 2 or 1 (Linux,
/// Documentation/admin-guide).
std::size_t left_in_groups() {
  std::size_t least = k_unlimited;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {  // number:controllers:/path
    const std::size_t first = line.find(':'), second = line.find(':', first + 1);
    if (second == line.npos) continue;
    const bool version_2 = second == first + 1, is_memory = line.compare(first + 1, second - first - 1, "memory") == 0;
    if (!version_2 && !is_memory) continue;
    const std::string root = version_2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
    for (std::string path = line.substr(second + 1);; path.resize(path.rfind('/'))) {
      while (!path.empty() && path.back() == '/') path.pop_back();
      least =
          std::min(least, version_2 ? left_in_group(root + path, "/memory.max", "/memory.current")
                                    : left_in_group(root + path, "/memory.limit_in_bytes", "/memory.usage_in_bytes"));
      if (path.empty()) break;
    }
  }
  return least;
}

std::size_t left_of_machine() {
  // Linux counts what caches would give back only here.
  if (const std::size_t kilobytes = number_in("/proc/meminfo", "MemAvailable:"); kilobytes != k_unlimited)
    return kilobytes * 1024;
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(size) : 0;
}

/// Returns what `ulimit -v` leaves.
std::size_t left_of_address_space() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return k_unlimited;
  const std::size_t pages = number_in("/proc/self/statm");
  const long size = sysconf(_SC_PAGESIZE);
  if (pages == k_unlimited || size <= 0) return k_unlimited;
  return limit.rlim_cur - std::min<std::size_t>(limit.rlim_cur, pages * static_cast<std::size_t>(size));
}

}  // namespace

std::size_t available_memory() { return std::min({left_of_machine(), left_in_groups(), left_of_address_space()}); }

#endif

}  // namespace saddleback
