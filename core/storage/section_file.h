// A container of arrays that can be used where they lie in a mapped file. Little-endian, like everything in memory here.
//
//   64 bytes           magic, format version, kind and its version, size of the file, numbers of sections and blocks, checksum
//   64 bytes each      table: name, element size, count, offset
//   8 bytes each       checksums of the blocks
//   the sections       in the table's order, each at the next multiple of 64 bytes; zeros between them
//
// What follows the checksums, from the next multiple of 64 bytes on, is divided into blocks of 64 KiB. Checksums are XXH3-64:
// each block's of its bytes, the header's of all before the blocks (with zero for itself). So every bit of the file is checked:
// when it is opened, or block by block when it is first used.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/mapped_file.h"

namespace curvecast {

static_assert(std::endian::native == std::endian::little, "section files are used as they lie in memory");

/// What a file holds, and the version of that: another one is refused.
struct FileKind {
  char name[8];  // padded with zeros
  std::uint32_t version;
};

inline constexpr std::uint64_t kSectionFileBlock = 64 << 10;  // bytes that share a checksum

/// An array to be written.
struct Section {
  std::string name;  // 1 to 31 bytes, unique in the file
  std::uint32_t element_size = 1;
  std::vector<std::span<const std::byte>> parts;  // one after the other in the file; each holds whole elements
};

template <typename Values>
Section make_section(std::string name, const Values& values) {
  using T = std::remove_cvref_t<decltype(*values.data())>;
  static_assert(std::is_trivially_copyable_v<T>);
  return {std::move(name), sizeof(T), {std::as_bytes(std::span<const T>(values.data(), values.size()))}};
}

/// Writes by way of AtomicFile; errors are its errors.
absl::Status write_section_file(const std::string& path, const FileKind& kind, std::span<const Section> sections);

enum class FileAccess {
  kMap,  // the sections are the file's own pages, shared with all who map it. Another program that shortens the file in place
         // while it is in use takes some of them away: see is_lost(). One that rewrites it changes what was checked; ours never
         // do: they replace and remove files, and what is mapped lives on
  kMapLazily,  // the same, but blocks are checked only where check() is asked: opening takes the same time for any size
  kCopy,       // the sections are in memory of their own. So are those of files on other machines, whatever is asked for
};

/// An open file, checked. Immutable.
class SectionFile {
 public:
  /// Nothing of the file is believed before it is checked. NotFound; PermissionDenied; InvalidArgument: not a regular file;
  /// FailedPrecondition: of another kind or version; DataLoss: damaged, with what is wrong. Never waits for a pipe or device.
  static absl::StatusOr<std::shared_ptr<const SectionFile>> open(const std::string& path, const FileKind& kind,
                                                                 FileAccess access = FileAccess::kMap);
  ~SectionFile();
  SectionFile(const SectionFile&) = delete;
  SectionFile& operator=(const SectionFile&) = delete;

  /// Valid as long as this. DataLoss when there is no such section of elements of that size.
  template <typename T>
  absl::StatusOr<std::span<const T>> section(std::string_view name) const {
    static_assert(std::is_trivially_copyable_v<T>);
    const absl::StatusOr<std::span<const std::byte>> bytes = find(name, sizeof(T));
    if (!bytes.ok()) return bytes.status();
    return std::span<const T>(reinterpret_cast<const T*>(bytes->data()), bytes->size() / sizeof(T));
  }

  /// Checks the blocks in which values of sections lie, unless they are known to be good. Thread-safe. DataLoss.
  template <typename T>
  absl::Status check(std::span<const T> values) const {
    return is_known_good(values.data(), values.size_bytes()) ? absl::OkStatus() : check_bytes(std::as_bytes(values));
  }
  /// The error of a file that is damaged: says where and what.
  absl::Status damaged(const std::string& what) const;

  /// OK, or DataLoss where the file has become shorter, or the system could not give some of its bytes back: see
  /// MappedFile::is_lost(). To be asked before what came of the sections is used. Takes microseconds.
  absl::Status status() const;
  bool is_mapped() const { return !mapping_.bytes().empty(); }

  const std::string& path() const { return path_; }
  std::uint64_t size() const { return size_; }  // bytes of the file

 private:
  struct Entry;
  static constexpr std::uint64_t kBlock = kSectionFileBlock;

  explicit SectionFile(std::string path) : path_(std::move(path)) {}
  absl::Status read(int descriptor, const FileKind& kind, FileAccess access);
  absl::Status copy(int descriptor, std::uint64_t size);
  absl::Status check_header(const FileKind& kind);
  absl::Status check_table() const;
  absl::Status check_all() const;
  absl::Status check_bytes(std::span<const std::byte> bytes) const;
  bool check_block(std::uint64_t i) const;
  absl::Status wrong_block(std::uint64_t i) const;
  /// Whether no more than two blocks are asked for, and both have been checked.
  bool is_known_good(const void* values, std::size_t size) const {
    if (size == 0) return true;
    const auto first = static_cast<std::uint64_t>(static_cast<const std::byte*>(values) - data_) - blocks_begin_;
    const std::uint64_t a = first / kBlock, b = (first + size - 1) / kBlock;
    return b - a < 2 && is_good_[a].load(std::memory_order_acquire) && is_good_[b].load(std::memory_order_acquire);
  }
  std::span<const std::uint64_t> sums() const;
  std::span<const Entry> table() const;
  absl::StatusOr<std::span<const std::byte>> find(std::string_view name, std::size_t element_size) const;

  const std::string path_;
  MappedFile mapping_;  // of no file: the bytes are a copy
  std::uint64_t device_ = 0, inode_ = 0;
  const std::byte* data_ = nullptr;
  std::uint64_t size_ = 0;
  std::uint64_t blocks_begin_ = 0;
  std::unique_ptr<std::atomic<bool>[]> is_good_;  // each block
};

}  // namespace curvecast
