#include "support/number_files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

#include "saddleback/error.h"

#include "support/crc32.h"

namespace saddleback {
namespace {

namespace fs = std::filesystem;

#ifdef _WIN32
bool bring_to_disk(std::FILE* file) { return std::fflush(file) == 0 && _commit(_fileno(file)) == 0; }
bool may_be_written(const fs::path& file) { return _waccess(file.c_str(), 2) == 0; }
constexpr const char* k_forbidden_advice = "close what has it open (a graph loaded with mmap=True does), allow it";
#else
bool bring_to_disk(std::FILE* file) { return std::fflush(file) == 0 && fsync(fileno(file)) == 0; }
bool may_be_written(const fs::path& file) { return access(file.c_str(), W_OK) == 0; }
constexpr const char* k_forbidden_advice = "allow it";
#endif

/// A name that nothing has, in the same folder and so on the same disk; short, however long the other name is.
fs::path name_beside(const fs::path& target) {
  std::random_device random;
  const std::uint64_t number = static_cast<std::uint64_t>(random()) << 32 | random();
  char name[48];
  std::snprintf(name, sizeof name, ".saddleback-%016llx.partial", static_cast<unsigned long long>(number));
  return target.parent_path() / name;
}

/// Returns where a link leads, so that the file is replaced and not the link; it may lead to nothing yet.
fs::path followed(fs::path path) {
  constexpr int k_most_links = 40;  // as Linux: more are a circle
  std::error_code error;
  for (int links = 0; links < k_most_links && fs::is_symlink(path, error); ++links)
    path = path.parent_path() / fs::read_symlink(path, error);
  return path;
}

}  // namespace

NumberFileWriter::NumberFileWriter(const std::string& path) : path_(path), target_(followed(system_path(path))) {
  std::error_code error;
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(message("path: ", path, " is ", fs::is_directory(status) ? "a folder" : "no regular file",
                             "; give the name of a file to write"));
  }
  if (system_path(path).filename().empty()) {
    throw InputError(message("path: '", path, "' names no file; give the name of a file to write"));
  }
  partial_.path = name_beside(target_);
  file_ = open_file(partial_.path, "wbx");
  if (!file_) {
    partial_.path.clear();
    fail();
  }
  if (fs::exists(status)) keep_permissions(status.permissions());
}

// The new file is as open to others as the old one, and replaces none that must not be written.
void NumberFileWriter::keep_permissions(fs::perms old) {
  if (!may_be_written(target_)) fail();
  std::error_code error;
  fs::permissions(partial_.path, old, error);
  if (error) {
    errno = error.value();
    fail();
  }
}

NumberFileWriter::PartialFile::~PartialFile() {
  std::error_code error;
  if (!path.empty()) fs::remove(path, error);
}

void NumberFileWriter::fail() const {
  const int reason = errno;
  const bool is_forbidden = reason == EACCES || reason == EPERM || reason == EROFS;
  const char* const advice = reason == ENOENT         ? "make its folder"
                             : reason == ENAMETOOLONG ? "shorten it"
                             : is_forbidden           ? k_forbidden_advice
                                                      : "make room";
  throw InputError(message("path: ", path_, " cannot be written: ", std::strerror(reason), "; ", advice,
                           " or choose another place (what was there before has not changed)"));
}

void NumberFileWriter::write_bytes(std::span<const std::byte> bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
  crc_ = crc32(bytes, crc_);
}

void NumberFileWriter::commit() {
  if (!bring_to_disk(file_.get()) || std::fclose(file_.release()) != 0) fail();
  if (!move_file(partial_.path, target_)) fail();
  partial_.path.clear();
}

NumberFileReader::NumberFileReader(const std::string& path) : path_(path) {
  std::error_code error;
  const fs::path file = system_path(path);
  const fs::file_status status = fs::status(file, error);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw InputError(
        message("path: ", path, " is ", fs::is_directory(status) ? "a folder" : "no regular file", "; give a file"));
  }
  file_ = open_file(file, "rb");
  if (!file_) throw InputError(message("path: ", path, " cannot be opened: ", std::strerror(errno)));
  size_ = fs::file_size(file, error);
  if (error) throw InputError(message("path: ", path, " cannot be measured: ", error.message()));
}

void NumberFileReader::read_bytes(std::span<std::byte> bytes) {
  if (std::fread(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) {
    if (std::ferror(file_.get())) throw InputError(message("path: ", path_, " cannot be read: ", std::strerror(errno)));
    throw InputError(message("path: ", path_, " ended while it was read; save it again"));
  }
  crc_ = crc32(bytes, crc_);
}

}  // namespace saddleback
