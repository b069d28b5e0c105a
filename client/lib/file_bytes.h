// SPDX-License-Identifier: Apache-2.0
// Files as bytes, with errors that name the file and the reason.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace curvecast::client {

/// A regular file open for reading. Movable; read_at() is thread-safe.
class InputFile {
 public:
  /// NotFound when it is not there; InvalidArgument for what cannot be opened, is no regular file or is empty.
  static absl::StatusOr<InputFile> open(const std::string& path);
  InputFile(InputFile&& other) noexcept;
  InputFile& operator=(InputFile&&) = delete;
  ~InputFile();

  std::uint64_t size() const { return size_; }
  /// Fills `out` from `offset` on; FailedPrecondition when the file has become shorter or cannot be read.
  absl::Status read_at(std::uint64_t offset, std::span<char> out) const;

 private:
  InputFile(std::string path, int descriptor, std::uint64_t size);

  std::string path_;
  int descriptor_;
  std::uint64_t size_;  // when opened, bytes
};

/// The whole file. InvalidArgument above `limit` bytes, else as InputFile.
absl::StatusOr<std::string> read_bytes(const std::string& path, std::uint64_t limit);

/// Replaces the file, whole or not at all and durably, whatever becomes of the process or the machine meanwhile; what a process
/// that was killed has left half-written is written over. Nothing new at `path` when that fails: FailedPrecondition, or
/// Unavailable while another process writes the same file.
absl::Status write_bytes(const std::string& path, std::string_view bytes);

/// FailedPrecondition when `path` cannot be written. Found out without touching what is there.
absl::Status check_writable(const std::string& path);

}  // namespace curvecast::client
