#include "support/files.h"

#include <cerrno>
#include <cstring>

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

// The C library that every Windows has knows no "x" in a mode; and of a name that is too long it says that there is no
// such file.
FileHandle open_file(const fs::path& path, const char* mode) {
  constexpr std::size_t k_longest_path = 259;
  FileHandle file(_wfopen(path.c_str(), std::wstring(mode, mode + std::strcspn(mode, "x")).c_str()));
  std::error_code error;
  if (!file && errno == ENOENT && fs::absolute(path, error).native().size() > k_longest_path) errno = ENAMETOOLONG;
  return file;
}

#else

fs::path system_path(const std::string& path) { return path; }

FileHandle open_file(const fs::path& path, const char* mode) { return FileHandle(std::fopen(path.c_str(), mode)); }

#endif

}  // namespace saddleback
