#pragma once
// Files read as memory: the system brings what is looked at, and programs that map the same file share it.

#include <cstddef>
#include <span>
#include <string>

namespace saddleback {

/// The bytes of a file, to be read only. On Windows the file cannot be replaced as long as it is mapped; elsewhere a
/// file that takes its place leaves these bytes as they are. One that is cut off in place ends the program that reads
/// on.
class MappedFile {
 public:
  /// \throw InputError when there is no such file, it is empty, or it cannot be mapped.
  explicit MappedFile(const std::string& path);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  std::span<const std::byte> bytes() const { return {start_, size_}; }

 private:
  const std::byte* start_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace saddleback
