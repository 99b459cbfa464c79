#include "support/files.h"

#include <cerrno>
#include <cstring>
#ifdef _WIN32
#ifndef NOMINMAX  // libstdc++ defines it
#define NOMINMAX
#endif
#include <windows.h>
#endif

#include "saddleback/error.h"

namespace saddleback {

namespace fs = std::filesystem;

#ifdef _WIN32

fs::path system_path(const std::string& path) {
  try {
    return {std::u8string(path.begin(), path.end())};
  } catch (const fs::filesystem_error&) {
    throw InputError(message("path: ", path, " is no text in UTF-8; rename the file"));
  }
}

namespace {

// Of a name that is too long Windows says that there is no such file, that the name is wrong, or nothing.
int reason_of(const fs::path& path, int reason) {
  constexpr std::size_t k_longest_path = 259;
  constexpr std::size_t k_longest_name = 255;
  std::error_code error;
  const bool is_too_long =
      fs::absolute(path, error).native().size() > k_longest_path || path.filename().native().size() > k_longest_name;
  return is_too_long && (reason == ENOENT || reason == EINVAL || reason == EIO) ? ENAMETOOLONG : reason;
}

}  // namespace

// The C library that every Windows has knows no "x" in a mode.
FileHandle open_file(const fs::path& path, const char* mode) {
  FileHandle file(_wfopen(path.c_str(), std::wstring(mode, mode + std::strcspn(mode, "x")).c_str()));
  if (!file) errno = reason_of(path, errno);
  return file;
}

bool move_file(const fs::path& from, const fs::path& to) {
  if (MoveFileExW(from.c_str(), to.c_str(), MOVEFILE_REPLACE_EXISTING) != 0) return true;
  const DWORD error = GetLastError();
  const DWORD told =
      error == ERROR_USER_MAPPED_FILE ? ERROR_ACCESS_DENIED : error;  // the C library knows only this one
  const auto reason = std::system_category().default_error_condition(static_cast<int>(told));
  errno = reason_of(to, reason.category() == std::generic_category() ? reason.value() : EIO);
  return false;
}

#else

fs::path system_path(const std::string& path) { return path; }

FileHandle open_file(const fs::path& path, const char* mode) { return FileHandle(std::fopen(path.c_str(), mode)); }

bool move_file(const fs::path& from, const fs::path& to) { return std::rename(from.c_str(), to.c_str()) == 0; }

#endif

}  // namespace saddleback
