#include "server/session/making_marks.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/time/time.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "server/session/cache_folder.h"

namespace curvecast::server {
namespace {

constexpr char kEnding[] = ".making";
constexpr int kFactor = 4;        // from one pause to the next
constexpr int kMostDeaths = 100;  // that are counted

/// How often the process has ended while the session was made, as the mark says: before the making that it stands for.
int deaths_in(int file) {
  std::array<char, 8> text{};
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  int deaths = 0;
  if (size > 0 && absl::SimpleAtoi(absl::string_view(text.data(), static_cast<std::size_t>(size)), &deaths)) {
    return std::clamp(deaths, 0, kMostDeaths);
  }
  return 0;
}

absl::Time changed_at(int file) {
  struct stat status = {};
  return ::fstat(file, &status) == 0 ? absl::TimeFromTimespec(status.st_mtim) : absl::InfinitePast();
}

/// Whether the file is still the one of that name: whoever held the lock before may have removed it.
bool is_current(int file, const std::string& path) {
  struct stat here = {}, there = {};
  return ::fstat(file, &here) == 0 && ::stat(path.c_str(), &there) == 0 && here.st_ino == there.st_ino;
}

/// Opens a mark and locks it; -1 where another one holds it or that cannot be.
int open_locked(const std::string& path) {
  for (int tries = 0; tries < 10; ++tries) {
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (file < 0) return -1;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0 && is_current(file, path)) return file;
    const bool is_held = is_current(file, path);
    ::close(file);
    if (is_held) return -1;
  }
  return -1;
}

}  // namespace

MakingMarks::MakingMarks(std::string folder, std::chrono::seconds first_pause)
    : folder_(std::move(folder)), first_pause_(first_pause) {
  visit_old_marks(folder_, kEnding, kMostPause, [](const std::string& path) {
    const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (file < 0) return;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
    ::close(file);
  });
}

MakingMarks::~MakingMarks() { forgive(); }

std::string MakingMarks::path_of(const std::string& id) const { return absl::StrCat(folder_, "/", id, kEnding); }

absl::Status MakingMarks::begin(const std::string& id) {
  const std::string path = path_of(id);
  const int file = open_locked(path);
  if (file < 0) return absl::OkStatus();  // another server is making it as well
  struct stat status = {};
  const bool is_new = ::fstat(file, &status) == 0 && status.st_size == 0;
  const int deaths = is_new ? 0 : deaths_in(file) + 1;
  if (deaths > 0 && is_enforced_) {
    std::chrono::seconds pause = first_pause_;
    for (int d = 1; d < deaths && pause < kMostPause; ++d) pause *= kFactor;
    const absl::Time until = changed_at(file) + absl::FromChrono(std::min(pause, kMostPause));
    if (absl::Now() < until) {
      ::close(file);
      return absl::ResourceExhaustedError(absl::StrCat("session ", id,
                                                       ": the server ended while it was made; it is not made again before ",
                                                       absl::FormatTime("%Y-%m-%d %H:%M:%S UTC", until, absl::UTCTimeZone())));
    }
  }
  const std::string text = absl::StrCat(deaths, "\n");
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, text.data(), text.size(), 0) < 0) {
    ::unlink(path.c_str());  // of a full disk: it marks nothing
  }
  const MutexLock lock(mutex_);
  files_[id] = file;
  return absl::OkStatus();
}

void MakingMarks::end(const std::string& id) {
  const MutexLock lock(mutex_);
  const auto found = files_.find(id);
  if (found == files_.end()) return;
  ::unlink(path_of(id).c_str());
  ::close(found->second);
  files_.erase(found);
}

void MakingMarks::forgive() {
  const MutexLock lock(mutex_);
  for (const auto& [id, file] : files_) {
    ::unlink(path_of(id).c_str());
    ::close(file);
  }
  files_.clear();
}

void MakingMarks::touch() {
  const MutexLock lock(mutex_);
  for (const auto& [id, file] : files_) touch_file(path_of(id));
}

}  // namespace curvecast::server
