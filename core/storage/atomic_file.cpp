#include "core/storage/atomic_file.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

namespace curvecast {
namespace {

constexpr char kEnding[] = ".curvecast-tmp";
constexpr int kAttempts = 100;
constexpr std::size_t kMaxWrite = std::size_t{1} << 30;  // one system call takes no more than 2 GiB

absl::Status failed(const std::string& path, const char* what) {
  return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot ", what));
}

/// The name of an open file may be taken away by who removes stale ones, until it is locked.
bool has_name(int descriptor) {
  struct stat status = {};
  return ::fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

/// The lock marks a file as being written. It ends with its process, however that ends. On a file system without locks nothing
/// is ever taken for stale.
bool lock(int descriptor) { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

absl::Status sync_folder(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return failed(parent.string(), "open the folder");
  const bool synced = ::fsync(folder) == 0 || errno == EINVAL;  // EINVAL: this file system has no need for it
  absl::Status status = synced ? absl::OkStatus() : failed(parent.string(), "make the folder durable");
  ::close(folder);
  return status;
}

}  // namespace

AtomicFile::AtomicFile(int descriptor, std::string path, std::string temporary)
    : descriptor_(descriptor), path_(std::move(path)), temporary_(std::move(temporary)) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      path_(std::move(other.path_)),
      temporary_(std::exchange(other.temporary_, {})) {}

AtomicFile::~AtomicFile() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  if (descriptor_ >= 0) ::close(descriptor_);
}

absl::StatusOr<AtomicFile> AtomicFile::create(const std::string& path) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    std::string name = absl::StrCat(path, ".XXXXXX", kEnding);
    const int descriptor = ::mkostemps(name.data(), sizeof kEnding - 1, O_CLOEXEC);
    if (descriptor < 0) return failed(path, "create a file beside it");
    AtomicFile file(descriptor, path, std::move(name));
    if (lock(descriptor) && has_name(descriptor)) return file;
  }
  return absl::UnavailableError(absl::StrCat(path, ": something removes new files in its folder at once"));
}

absl::StatusOr<AtomicFile> AtomicFile::create_in(const std::string& folder) {
#ifdef O_TMPFILE
  const bool can_be_named = ::access("/proc/self/fd", X_OK) == 0;  // see take_name()
  const int descriptor = can_be_named ? ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600) : -1;
  if (descriptor >= 0) {
    AtomicFile file(descriptor, absl::StrCat(folder, "/file"), "");
    // So that nobody takes it for stale when it gets a name. Nobody else can have it open.
    (void)lock(descriptor);
    return file;
  }
  if (can_be_named && errno != EOPNOTSUPP && errno != EISDIR) return failed(folder, "create a file in it");
#endif
  return create(absl::StrCat(folder, "/file"));
}

absl::Status AtomicFile::resize(std::uint64_t size) {
  int result = 0;
  do {
    result = ::ftruncate(descriptor_, static_cast<off_t>(size));
  } while (result != 0 && errno == EINTR);
  return result == 0 ? absl::OkStatus() : failed(path_, "write");
}

absl::Status AtomicFile::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), std::min(bytes.size(), kMaxWrite), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written == 0) errno = ENOSPC;
    if (written <= 0) return failed(path_, "write");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return absl::OkStatus();
}

absl::Status AtomicFile::take_name() {
  // By way of /proc: linking a descriptor itself is for those with privileges.
  const std::string self = absl::StrCat("/proc/self/fd/", descriptor_);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // Nobody else makes names with our number and the descriptor's, but a process that had both may have left one.
    std::string name = absl::StrCat(path_, ".", ::getpid(), "-", descriptor_, "-", attempt, kEnding);
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) {
      temporary_ = std::move(name);
      return absl::OkStatus();
    }
    if (errno != EEXIST) return failed(path_, "give it a name");
  }
  return absl::UnavailableError(absl::StrCat(path_, ": all names for a new file beside it are taken"));
}

absl::Status AtomicFile::commit_as(const std::string& path) {
  path_ = path;
  return commit();
}

absl::StatusOr<std::string> AtomicFile::sync() {
  if (::fsync(descriptor_) != 0) return failed(path_, "make it durable");
  if (temporary_.empty()) {
    if (absl::Status named = take_name(); !named.ok()) return named;
  }
  return temporary_;
}

absl::Status AtomicFile::commit() {
  if (absl::Status synced = sync().status(); !synced.ok()) return synced;
  if (absl::Status named = publish(); !named.ok()) return named;
  return sync_folder(path_);
}

absl::Status AtomicFile::publish() {
  if (temporary_.empty()) {
    if (absl::Status named = take_name(); !named.ok()) return named;
  }
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) return failed(path_, "give a new file this name");
  temporary_.clear();
  return absl::OkStatus();
}

bool is_temporary(const std::string& name) { return absl::EndsWith(name, kEnding); }

std::size_t remove_stale_temporaries(const std::string& folder) {
  std::size_t removed = 0;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (!is_temporary(it->path().filename().string())) continue;
    // Non-blocking: something else than a file may have such a name. To write: NFS locks no other descriptors.
    const int descriptor = ::open(it->path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) continue;
    struct stat status = {};
    const bool is_file = ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    // Removed under the lock: its writer, if it has only just made it, then sees that it has no name and takes another.
    if (is_file && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(it->path().c_str()) == 0) ++removed;
    ::close(descriptor);
  }
  return removed;
}

}  // namespace curvecast
