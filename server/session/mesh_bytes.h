// The bytes of a mesh file: in memory, or in a file without a name that the system can take out of memory.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace curvecast::server {

/// Immutable; copies share.
class MeshBytes {
 public:
  MeshBytes() = default;

  std::span<const char> all() const { return {data_.get(), size_}; }
  std::size_t size() const { return size_; }
  /// Lets go of what was read of a file so far; it can be read again.
  void release_pages() const;

 private:
  friend class GrowingBytes;
  std::shared_ptr<const char> data_;
  std::size_t size_ = 0;
  bool is_mapped_ = false;
};

/// Bytes that come one after the other. A file is gone as soon as nobody holds it, however the process ends.
class GrowingBytes {
 public:
  GrowingBytes() = default;
  GrowingBytes(GrowingBytes&& other) noexcept { *this = std::move(other); }
  GrowingBytes& operator=(GrowingBytes&& other) noexcept;
  ~GrowingBytes();

  /// Has them in a file in that folder. ResourceExhausted and so on, as the system says; nothing has come so far.
  absl::Status open_in(const std::string& folder);
  bool is_file() const { return file_ >= 0; }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return is_file() ? size_ : capacity_; }
  /// Takes more bytes. In memory there is room for them: see reserve(). ResourceExhausted: the disk is full.
  absl::Status append(std::string_view bytes);
  /// In memory: makes room for so many bytes in all. ResourceExhausted.
  absl::Status reserve(std::size_t capacity);
  /// Returns the bytes; nothing may be appended any more.
  absl::StatusOr<MeshBytes> finish();

 private:
  struct Free {
    void operator()(char* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<char[], Free> memory_;
  std::size_t size_ = 0, capacity_ = 0;
  int file_ = -1;
};

}  // namespace curvecast::server
