#include "support/files.h"

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

FileHandle open_file(const fs::path& path, const char* mode) {
  return FileHandle(_wfopen(path.c_str(), std::wstring(mode, mode + std::strlen(mode)).c_str()));
}

#else

fs::path system_path(const std::string& path) { return path; }

FileHandle open_file(const fs::path& path, const char* mode) { return FileHandle(std::fopen(path.c_str(), mode)); }

#endif

}  // namespace saddleback
