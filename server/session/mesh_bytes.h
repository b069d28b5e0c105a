// The bytes of a mesh file: in memory, or in a file that the system can take out of memory.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/mapped_file.h"
#include "core/storage/atomic_file.h"

namespace curvecast::server {

/// Immutable; copies share.
class MeshBytes {
 public:
  MeshBytes() = default;
  /// The first bytes of a file that is open for reading, which may be closed then: mapped, or in memory where the file is on
  /// another machine. Errors as the system says. Precondition: size > 0.
  static absl::StatusOr<MeshBytes> of_file(int descriptor, std::size_t size);

  std::span<const char> all() const { return {data_.get(), size_}; }
  std::size_t size() const { return size_; }
  /// Says whether some of the bytes may be zeros that the file never had: see MappedFile.
  bool is_lost() const { return mapping_ != nullptr && mapping_->is_lost(); }
  /// Lets go of what was read of a file so far; it can be read again.
  void release_pages() const;

 private:
  friend class GrowingBytes;
  std::shared_ptr<const char> data_;
  std::size_t size_ = 0;
  std::shared_ptr<const MappedFile> mapping_;  // null: in memory
};

/// Bytes that come one after the other. A file is gone as soon as nobody holds it, however the process ends, unless it gets a
/// name.
class GrowingBytes {
 public:
  GrowingBytes() = default;
  GrowingBytes(GrowingBytes&& other) noexcept { *this = std::move(other); }
  GrowingBytes& operator=(GrowingBytes&& other) noexcept;
  ~GrowingBytes();

  /// Has them in a file without a name in that folder. ResourceExhausted and so on, as the system says; nothing has come so far.
  absl::Status open_in(const std::string& folder);
  /// Has them in a file that is to get a name, and is empty; nothing has come so far.
  void open(AtomicFile file);
  bool is_file() const { return file_ >= 0; }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return is_file() ? size_ : capacity_; }
  /// Takes more bytes. In memory there is room for them: see reserve(). ResourceExhausted: the disk is full.
  absl::Status append(std::string_view bytes);
  /// In memory: makes room for so many bytes in all. ResourceExhausted.
  absl::Status reserve(std::size_t capacity);
  /// Returns the bytes; nothing may be appended any more.
  absl::StatusOr<MeshBytes> finish();
  /// Gives away the file that is to get a name. Precondition: open().
  AtomicFile take_file();

 private:
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<char[], Free> memory_;
  std::size_t size_ = 0, capacity_ = 0;
  int file_ = -1;
  std::unique_ptr<AtomicFile> named_;  // whose descriptor `file_` is; null: it is our own
};

}  // namespace curvecast::server
