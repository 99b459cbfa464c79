#pragma once
// Files of numbers, least significant byte first, with a CRC-32 of everything that passes.

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>

#include "saddleback/job.h"

#include "support/files.h"

namespace saddleback {

/// A file that takes the place of an old one only when it is whole: it is written beside it under another name, which
/// `commit` changes. Whatever happens before that (no space, an interruption) leaves the old file as it was. It keeps
/// the old file's permissions.
class NumberFileWriter {
 public:
  /// \throw InputError when the place is taken by something else than a file, or nothing can be written there.
  explicit NumberFileWriter(const std::string& path);
  NumberFileWriter(const NumberFileWriter&) = delete;
  NumberFileWriter& operator=(const NumberFileWriter&) = delete;

  /// \throw InputError when the disk is full or fails; Cancelled.
  template <class Number>
  void write(std::span<const Number> numbers, const JobStage& stage = {});
  template <class Number>
  void write(Number number) {
    write(std::span<const Number>(&number, 1));
  }
  std::uint32_t crc() const { return crc_; }
  /// Brings the file to disk and to its place. \throw InputError as `write` does.
  void commit();

 private:
  /// The file being written, which goes with whatever fails, even in the constructor; no path once it has moved.
  struct PartialFile {
    std::filesystem::path path;
    PartialFile() = default;
    PartialFile(const PartialFile&) = delete;
    PartialFile& operator=(const PartialFile&) = delete;
    ~PartialFile();
  };
  [[noreturn]] void fail() const;
  void keep_permissions(std::filesystem::perms old);
  void write_bytes(std::span<const std::byte> bytes);

  std::string path_;              ///< as given, for messages
  std::filesystem::path target_;  ///< what it stands for when it is a link
  PartialFile partial_;
  FileHandle file_;  ///< closed before the partial file goes
  std::uint32_t crc_ = 0;
};

class NumberFileReader {
 public:
  /// \throw InputError when there is no such file, or it cannot be opened.
  explicit NumberFileReader(const std::string& path);

  std::uint64_t size() const { return size_; }  ///< bytes
  /// Fills `numbers`. \throw InputError when the file fails or ends too early; Cancelled.
  template <class Number>
  void read(std::span<Number> numbers, const JobStage& stage = {});
  template <class Number>
  Number read() {
    Number number{};
    read(std::span<Number>(&number, 1));
    return number;
  }
  std::uint32_t crc() const { return crc_; }

 private:
  void read_bytes(std::span<std::byte> bytes);

  std::string path_;
  FileHandle file_;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;
};

// Small enough to stay in the first caches, large enough that a look at the job costs nothing.
inline constexpr std::size_t k_file_block = std::size_t{1} << 16;

template <class Number>
void NumberFileWriter::write(std::span<const Number> numbers, const JobStage& stage) {
  std::array<std::byte, k_file_block> block;
  constexpr std::size_t k_most = k_file_block / sizeof(Number);
  for (std::size_t begin = 0; begin < numbers.size(); begin += k_most) {
    const auto part = numbers.subspan(begin, std::min(k_most, numbers.size() - begin));
    for (std::size_t i = 0; i < part.size(); ++i) {
      std::byte* const place = block.data() + i * sizeof(Number);
      std::memcpy(place, &part[i], sizeof(Number));
      if constexpr (std::endian::native == std::endian::big) std::reverse(place, place + sizeof(Number));
    }
    write_bytes(std::span(block).first(part.size_bytes()));
    stage.update(static_cast<double>(begin + part.size()) / static_cast<double>(numbers.size()));
  }
}

template <class Number>
void NumberFileReader::read(std::span<Number> numbers, const JobStage& stage) {
  constexpr std::size_t k_most = k_file_block / sizeof(Number);
  for (std::size_t begin = 0; begin < numbers.size(); begin += k_most) {
    const auto part = numbers.subspan(begin, std::min(k_most, numbers.size() - begin));
    read_bytes(std::as_writable_bytes(part));
    if constexpr (std::endian::native == std::endian::big) {
      for (Number& number : part) {
        const auto bytes = std::as_writable_bytes(std::span(&number, 1));
        std::reverse(bytes.begin(), bytes.end());
      }
    }
    stage.update(static_cast<double>(begin + part.size()) / static_cast<double>(numbers.size()));
  }
}

}  // namespace saddleback
