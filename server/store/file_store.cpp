#include "server/store/file_store.h"

#include <absl/strings/str_cat.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "core/storage/atomic_file.h"
#include "server/store/bounded_calls.h"
#include "server/store/source_file.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;  // bytes of one step

absl::Status failed(const std::string& path, const char* what) {
  return absl::ErrnoToStatus(errno, absl::StrCat(path, ": cannot ", what));
}

absl::Status given_up() { return absl::CancelledError("nobody waits for it any more"); }

/// The next bytes, none at the end.
absl::StatusOr<std::span<const std::byte>> read(const SourceFile& file, std::span<std::byte> room) {
  for (;;) {
    const ssize_t got = ::read(file.descriptor(), room.data(), room.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return failed(file.path(), "read");
    return room.first(static_cast<std::size_t>(got));
  }
}

/// What a copy says of where it failed: errors of the store's side and of the other one mean different things.
struct Copied {
  absl::Status read, written;
};

Copied copy(const SourceFile& from, AtomicFile& to, CallProgress& progress) {
  std::vector<std::byte> room(kChunk);
  for (std::uint64_t at = 0;;) {
    const auto bytes = read(from, room);
    if (!bytes.ok()) return {bytes.status(), absl::OkStatus()};
    if (bytes->empty()) return {};
    if (absl::Status written = to.write_at(at, *bytes); !written.ok()) return {absl::OkStatus(), written};
    at += bytes->size();
    progress.step();
    if (progress.is_given_up()) return {given_up(), absl::OkStatus()};
  }
}

/// As Store says it.
absl::Status of_store(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kNotFound:
      return status;
    default:
      return absl::UnavailableError(status.message());
  }
}

/// A folder of files; all calls may hang.
class SharedFolder {
 public:
  explicit SharedFolder(std::string path) : path_(std::move(path)) {}

  absl::Status put(const std::string& name, const std::string& path, CallProgress& progress) {
    const absl::StatusOr<SourceFile> from = SourceFile::open(path);
    if (!from.ok()) return from.status();
    const std::string target = path_of(name);
    if (absl::Status made = make_folders(target); !made.ok()) return made;
    if (!cleaned_.exchange(true)) remove_stale_temporaries(temporaries());
    progress.step();
    absl::StatusOr<AtomicFile> to = AtomicFile::create_in(temporaries());
    if (!to.ok()) return or_away(to.status());
    const auto [read, written] = copy(*from, *to, progress);
    if (!read.ok()) return read;
    if (!written.ok()) return or_away(written);
    return or_away(to->commit_as(target));
  }

  absl::Status get(const std::string& name, const std::string& path, CallProgress& progress) const {
    const absl::StatusOr<SourceFile> from = SourceFile::open(path_of(name));
    if (!from.ok()) return or_away(from.status());
    absl::StatusOr<AtomicFile> to = AtomicFile::create(path);
    if (!to.ok()) return absl::UnavailableError(to.status().message());
    const auto [read, written] = copy(*from, *to, progress);
    if (!read.ok()) return or_away(read);
    if (!written.ok()) return written;
    return progress.is_given_up() ? given_up() : to->publish();
  }

  absl::StatusOr<std::uint64_t> size(const std::string& name) const {
    struct stat status = {};
    if (::stat(path_of(name).c_str(), &status) != 0) return or_away(failed(path_of(name), "look at"));
    if (!S_ISREG(status.st_mode)) return absl::NotFoundError(absl::StrCat(path_of(name), ": is no file"));
    return static_cast<std::uint64_t>(status.st_size);
  }

  absl::Status remove(const std::string& name) const {
    if (::unlink(path_of(name).c_str()) == 0) return absl::OkStatus();
    const absl::Status status = or_away(failed(path_of(name), "remove"));
    return absl::IsNotFound(status) ? absl::OkStatus() : status;
  }

 private:
  std::string path_of(const std::string& name) const { return absl::StrCat(path_, "/", name); }
  std::string temporaries() const { return path_ + "/tmp"; }

  /// That there is no file means nothing where the folder itself is gone.
  absl::Status or_away(const absl::Status& status) const {
    if (!absl::IsNotFound(status) || ::access(path_.c_str(), F_OK) == 0) return status;
    return absl::UnavailableError(absl::StrCat("the folder ", path_, " is not there; is it mounted?"));
  }

  /// Those of a file and of temporaries, within the folder itself, which has to be there.
  absl::Status make_folders(const std::string& target) const {
    for (const std::string& folder : {temporaries(), std::filesystem::path(target).parent_path().string()}) {
      for (std::size_t slash = path_.size(); slash != std::string::npos;) {
        slash = folder.find('/', slash + 1);
        const std::string part = folder.substr(0, slash);
        if (::mkdir(part.c_str(), 0700) != 0 && errno != EEXIST) return or_away(failed(part, "make the folder"));
      }
    }
    return absl::OkStatus();
  }

  const std::string path_;
  std::atomic<bool> cleaned_ = false;
};

class FileStore final : public Store {
 public:
  FileStore(std::string folder, std::chrono::milliseconds patience)
      : folder_(std::make_shared<SharedFolder>(std::move(folder))), calls_(patience) {}

  absl::Status put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override {
    return run(name, cancel,
               [folder = folder_, name, path](CallProgress& progress) { return folder->put(name, path, progress); });
  }
  absl::Status get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override {
    return run(name, cancel,
               [folder = folder_, name, path](CallProgress& progress) { return folder->get(name, path, progress); });
  }
  absl::StatusOr<std::uint64_t> size(const std::string& name, const std::atomic<bool>* cancel) override {
    const auto size = std::make_shared<std::uint64_t>(0);
    const absl::Status status = run(name, cancel, [folder = folder_, name, size](CallProgress&) {
      const absl::StatusOr<std::uint64_t> found = folder->size(name);
      *size = found.value_or(0);
      return found.status();
    });
    if (!status.ok()) return status;
    return *size;
  }
  absl::Status remove(const std::string& name, const std::atomic<bool>* cancel) override {
    return run(name, cancel, [folder = folder_, name](CallProgress&) { return folder->remove(name); });
  }

 private:
  absl::Status run(const std::string& name, const std::atomic<bool>* cancel, BoundedCalls::Work work) const {
    if (!is_store_name(name)) return absl::NotFoundError(absl::StrCat("there is no such name in a store: ", name));
    return of_store(calls_.run(std::move(work), cancel));
  }

  const std::shared_ptr<SharedFolder> folder_;  // calls that were given up have it too
  const BoundedCalls calls_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> make_file_store(const std::string& folder, std::chrono::milliseconds patience) {
  if (folder.empty() || folder.front() != '/') {
    return absl::InvalidArgumentError(absl::StrCat("file://", folder, ": the path of a store is absolute: file:///DIR"));
  }
  std::string path = std::filesystem::path(folder).lexically_normal().string();
  while (path.size() > 1 && path.back() == '/') path.pop_back();
  return std::make_unique<FileStore>(std::move(path), patience);
}

}  // namespace curvecast::server
