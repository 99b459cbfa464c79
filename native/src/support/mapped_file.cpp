#include "support/mapped_file.h"

#include <cerrno>
#include <cstring>
#if defined(_WIN32)
#ifndef NOMINMAX  // libstdc++ defines it
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

#include "saddleback/error.h"

#include "support/files.h"

namespace saddleback {

#if defined(_WIN32)

MappedFile::MappedFile(const std::string& path) {
  const auto refuse = [&]() -> void {
    throw InputError(message("path: ", path, " cannot be mapped: Windows error ", GetLastError()));
  };
  const HANDLE file = CreateFileW(system_path(path).c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr,
                                  OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (file == INVALID_HANDLE_VALUE) refuse();
  LARGE_INTEGER size{};
  const bool is_measured = GetFileSizeEx(file, &size) != 0;
  const HANDLE mapping = is_measured ? CreateFileMappingW(file, nullptr, PAGE_READONLY, 0, 0, nullptr) : nullptr;
  CloseHandle(file);
  if (!mapping) refuse();
  start_ = static_cast<const std::byte*>(MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, 0));
  CloseHandle(mapping);  // the view keeps what it needs
  if (!start_) refuse();
  size_ = static_cast<std::size_t>(size.QuadPart);
}

MappedFile::~MappedFile() { UnmapViewOfFile(start_); }

#else

MappedFile::MappedFile(const std::string& path) {
  const int file = open(system_path(path).c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  const bool is_measured = file >= 0 && fstat(file, &status) == 0;
  void* const start = is_measured
                          ? mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, file, 0)
                          : MAP_FAILED;
  const int reason = errno;
  if (file >= 0) close(file);  // the mapping keeps what it needs
  if (start == MAP_FAILED) throw InputError(message("path: ", path, " cannot be mapped: ", std::strerror(reason)));
  start_ = static_cast<const std::byte*>(start);
  size_ = static_cast<std::size_t>(status.st_size);
}

MappedFile::~MappedFile() { munmap(const_cast<std::byte*>(start_), size_); }

#endif

}  // namespace saddleback
