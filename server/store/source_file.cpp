#include "server/store/source_file.h"

#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace curvecast::server {

absl::StatusOr<SourceFile> SourceFile::open(const std::string& path) {
  // Non-blocking: nothing is to be waited for that is not a file.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot open"));
  SourceFile file(path, descriptor);
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot look at"));
  if (!S_ISREG(status.st_mode)) return absl::NotFoundError(absl::StrCat(path, ": is no file"));
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

SourceFile::SourceFile(SourceFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

SourceFile::~SourceFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace curvecast::server
