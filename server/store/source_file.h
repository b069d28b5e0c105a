// A file that is put into a store, or got from a folder that is one.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <utility>

namespace curvecast::server {

/// Open to be read. Not thread-safe.
class SourceFile {
 public:
  /// NotFound also for what is not a file; nothing is waited for. Errors name the path.
  static absl::StatusOr<SourceFile> open(const std::string& path);
  SourceFile(SourceFile&& other) noexcept;
  SourceFile& operator=(SourceFile&&) = delete;
  ~SourceFile();

  const std::string& path() const { return path_; }
  int descriptor() const { return descriptor_; }
  /// Bytes, when it was opened.
  std::uint64_t size() const { return size_; }

 private:
  SourceFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {}

  std::string path_;
  int descriptor_;
  std::uint64_t size_ = 0;
};

}  // namespace curvecast::server
