// SPDX-License-Identifier: Apache-2.0
#include "client/lib/file_bytes.h"

#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace curvecast::client {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

absl::Status write_all(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return absl::FailedPreconditionError(reason(errno));
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return absl::OkStatus();
}

/// A descriptor that closes itself.
struct Descriptor {
  explicit Descriptor(int opened) : number(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
  const int number;
};

/// Whether an open file still has that name: who wrote it before may have renamed or removed it.
bool has_name(int descriptor, const std::string& name) {
  struct stat file = {}, named = {};
  return ::fstat(descriptor, &file) == 0 && ::lstat(name.c_str(), &named) == 0 && file.st_dev == named.st_dev &&
         file.st_ino == named.st_ino;
}

absl::Status fill(int descriptor, std::string_view bytes) {
  if (::ftruncate(descriptor, 0) != 0) return absl::FailedPreconditionError(reason(errno));
  if (absl::Status status = write_all(descriptor, bytes); !status.ok()) return status;
  return ::fsync(descriptor) == 0 ? absl::OkStatus() : absl::FailedPreconditionError(reason(errno));
}

std::string folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  return folder.empty() ? "." : folder.string();
}

/// Makes the names in a folder durable.
absl::Status sync_folder(const std::string& path) {
  const Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // It may be one that nobody may list. EINVAL: this file system has no need for it.
  if (folder.number < 0 || ::fsync(folder.number) == 0 || errno == EINVAL) return absl::OkStatus();
  return absl::FailedPreconditionError(reason(errno));
}

}  // namespace

InputFile::InputFile(std::string path, int descriptor, std::uint64_t size)
    : path_(std::move(path)), descriptor_(descriptor), size_(size) {}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)), size_(other.size_) {}

InputFile::~InputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

absl::StatusOr<InputFile> InputFile::open(const std::string& path) {
  // Without O_NONBLOCK a FIFO that nobody writes to would be waited for.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const std::string message = absl::StrCat(path, ": cannot be opened: ", reason(errno));
    return errno == ENOENT ? absl::NotFoundError(message) : absl::InvalidArgumentError(message);
  }
  InputFile file(path, descriptor, 0);
  struct stat info {};
  if (::fstat(descriptor, &info) != 0) return absl::InvalidArgumentError(absl::StrCat(path, ": ", reason(errno)));
  if (S_ISDIR(info.st_mode)) return absl::InvalidArgumentError(absl::StrCat(path, ": is a directory, not a file"));
  if (!S_ISREG(info.st_mode)) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": is a pipe or device; save its content to a file first"));
  }
  if (info.st_size == 0) return absl::InvalidArgumentError(absl::StrCat(path, ": the file is empty"));
  file.size_ = static_cast<std::uint64_t>(info.st_size);
  return file;
}

absl::Status InputFile::read_at(std::uint64_t offset, std::span<char> out) const {
  while (!out.empty()) {
    const ssize_t got = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return absl::FailedPreconditionError(absl::StrCat(path_, ": cannot be read: ", reason(errno)));
    if (got == 0) return absl::FailedPreconditionError(absl::StrCat(path_, ": became shorter while it was read"));
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> read_bytes(const std::string& path, std::uint64_t limit) {
  absl::StatusOr<InputFile> file = InputFile::open(path);
  if (!file.ok()) return file.status();
  if (file->size() > limit) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", file->size(), " bytes are more than the limit of ", limit));
  }
  std::string bytes(file->size(), '\0');
  if (absl::Status status = file->read_at(0, bytes); !status.ok()) return status;
  return bytes;
}

absl::Status write_bytes(const std::string& path, std::string_view bytes) {
  const auto failure = [&](absl::string_view why) {
    return absl::FailedPreconditionError(absl::StrCat(path, ": cannot be written: ", why));
  };
  // Under another name first, so that a full disk does not cost the file that was there: always the same one, so that what a
  // killed process left does not stay.
  const std::string temporary = absl::StrCat(path, ".curvecast-tmp");
  while (true) {
    const Descriptor file(::open(temporary.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
    if (file.number < 0) return failure(reason(errno));
    // The lock ends with its process. On a file system without locks writers are not told apart.
    if (::flock(file.number, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      return absl::UnavailableError(absl::StrCat(path, ": another process is writing it"));
    }
    if (!has_name(file.number, temporary)) continue;
    absl::Status status = fill(file.number, bytes);
    if (status.ok() && std::rename(temporary.c_str(), path.c_str()) != 0) status = absl::FailedPreconditionError(reason(errno));
    if (!status.ok()) {
      ::unlink(temporary.c_str());
    } else {
      status = sync_folder(folder_of(path));
    }
    return status.ok() ? status : failure(status.message());
  }
}

absl::Status check_writable(const std::string& path) {
  const auto failure = [&](absl::string_view why) {
    return absl::FailedPreconditionError(absl::StrCat(path, ": cannot be written: ", why));
  };
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return failure("is a directory");
  const std::string folder = folder_of(path);
  if (!std::filesystem::is_directory(folder, error)) return failure(absl::StrCat("there is no folder ", folder));
  // The file is written under another name in its folder and then renamed.
  if (::access(folder.c_str(), W_OK | X_OK) != 0) return failure(reason(errno));
  if (std::filesystem::exists(path, error) && ::access(path.c_str(), W_OK) != 0) return failure(reason(errno));
  return absl::OkStatus();
}

}  // namespace curvecast::client
