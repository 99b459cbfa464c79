#pragma once
// Files by names of any letters. Ours are UTF-8 on Windows, which would take them for its code page, and elsewhere the
// bytes that the system has.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

namespace saddleback {

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

/// The name as the system takes it. \throw InputError where it is none (Windows: no UTF-8).
std::filesystem::path system_path(const std::string& path);

/// Opens a file like std::fopen; null when the file cannot be opened, and errno tells why.
FileHandle open_file(const std::filesystem::path& path, const char* mode);

/// Moves a file to another name on its disk, in place of what has that; false when it cannot, and errno tells why.
bool move_file(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace saddleback
