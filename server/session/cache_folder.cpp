#include "server/session/cache_folder.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>
#include <vector>

#include "core/storage/atomic_file.h"
#include "core/storage/curve_file.h"
#include "core/storage/rank_file.h"
#include "core/storage/surface_file.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kIdDigits = 32;
constexpr const char* kEndings[] = {".curve", ".refined", ".ranks", ".grown", ".surface"};
constexpr char kMark[] = ".closed", kStored[] = ".stored";
constexpr std::chrono::hours kMarkLife{24};

/// A session's files, of any version.
struct Stored {
  std::vector<std::string> paths;
  std::uint64_t bytes = 0;
  std::int64_t last_used = 0;  // nanoseconds: using a session touches its file
};

std::map<std::string, Stored> scan(const std::string& folder) {
  std::map<std::string, Stored> sessions;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const std::string id = name.substr(0, kIdDigits);
    const bool is_ours =
        is_content_id(id) && std::ranges::any_of(kEndings, [&](const char* e) { return absl::EndsWith(name, e); });
    struct stat status = {};
    if (!is_ours || ::lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    Stored& stored = sessions[id];
    stored.paths.push_back(it->path().string());
    stored.bytes += static_cast<std::uint64_t>(status.st_size);
    stored.last_used = std::max<std::int64_t>(stored.last_used, status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec);
  }
  return sessions;
}

}  // namespace

absl::StatusOr<std::string> make_cache_folder(const std::string& folder) {
  const auto unusable = [&](const std::string& why) {
    return absl::FailedPreconditionError(
        absl::StrCat("the cache folder ", folder, " cannot be used: ", why, "; choose another one or make it writable"));
  };
  std::error_code error;
  const fs::path path = fs::absolute(folder, error).lexically_normal();
  const fs::path wanted = path.has_filename() ? path : path.parent_path();
  fs::create_directories(wanted.parent_path(), error);
  if (error) return unusable(error.message());
  if (::mkdir(wanted.c_str(), 0700) != 0 && errno != EEXIST) return unusable(std::system_category().message(errno));
  if (!fs::is_directory(wanted, error)) return unusable("it is not a folder");
  const absl::Status writable = AtomicFile::create((wanted / "probe").string()).status();
  if (!writable.ok()) return unusable(std::string(writable.message()));
  return wanted.string();
}

bool is_content_id(const std::string& id) {
  return id.size() == kIdDigits && std::all_of(id.begin(), id.end(), [](char c) {
           return absl::ascii_isdigit(static_cast<unsigned char>(c)) || (c >= 'a' && c <= 'f');
         });
}

bool is_file(const std::string& path) {
  struct stat status = {};
  return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

void remove_path(const std::string& path) {
  std::error_code ignored;
  fs::remove(path, ignored);
}

void touch_file(const std::string& path) {
  // The kernel's own idea of now is milliseconds old.
  timespec times[2] = {{.tv_sec = 0, .tv_nsec = UTIME_OMIT}, {}};
  ::clock_gettime(CLOCK_REALTIME, &times[1]);
  ::utimensat(AT_FDCWD, path.c_str(), times, 0);
}

void visit_old_marks(const std::string& folder, std::string_view ending, std::chrono::seconds age,
                     const std::function<void(const std::string& path)>& visit) {
  const fs::file_time_type oldest = fs::file_time_type::clock::now() - age;
  std::error_code error, unknown;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_mark = is_content_id(name.substr(0, kIdDigits)) && name.substr(kIdDigits) == ending;
    if (is_mark && fs::last_write_time(it->path(), unknown) < oldest && !unknown) visit(it->path().string());
  }
}

std::string CacheFolder::curve_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kCurveFileVersion, ".curve");
}

std::string CacheFolder::refined_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kCurveFileVersion, ".refined");
}

std::string CacheFolder::ranks_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kRankFileVersion, ".ranks");
}

std::string CacheFolder::grown_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kRankFileVersion, ".grown");
}

std::string CacheFolder::surface_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kSurfaceFileVersion, ".surface");
}

std::string CacheFolder::closed_path(const std::string& id) const { return absl::StrCat(folder_, "/", id, kMark); }

std::string CacheFolder::stored_path(const std::string& id) const { return absl::StrCat(folder_, "/", id, kStored); }

std::array<std::string, 5> CacheFolder::paths(const std::string& id) const {
  return {curve_path(id), refined_path(id), ranks_path(id), grown_path(id), surface_path(id)};
}

template <typename Paths>
void CacheFolder::remove_all(const Paths& paths) const {
  bool any = false, failed = false;
  for (const std::string& path : paths) {
    std::error_code error;
    any = fs::remove(path, error) || any;
    failed = failed || error;
  }
  if (any) ++removed_;
  if (failed) ++not_removed_;
}

bool CacheFolder::remove_files(const std::string& id) const {
  const bool was_there = is_file(curve_path(id));
  unmark_stored(id);
  remove_all(paths(id));
  return was_there;
}

bool CacheFolder::is_closed(const std::string& id) const { return is_content_id(id) && is_file(closed_path(id)); }

void CacheFolder::mark_closed(const std::string& id) const { std::ofstream(closed_path(id), std::ios::app); }

void CacheFolder::remove_mark(const std::string& id) const { remove_path(closed_path(id)); }

void CacheFolder::remove_old_marks() const { visit_old_marks(folder_, kMark, kMarkLife, remove_path); }

bool CacheFolder::is_stored(const std::string& id, const std::string& url) const {
  std::ifstream mark(stored_path(id), std::ios::binary);
  return mark && std::string(std::istreambuf_iterator<char>(mark), {}) == url;
}

void CacheFolder::mark_stored(const std::string& id, const std::string& url) const {
  std::ofstream(stored_path(id), std::ios::binary | std::ios::trunc) << url;
}

void CacheFolder::unmark_stored(const std::string& id) const { remove_path(stored_path(id)); }

std::vector<std::string> CacheFolder::unstored(const std::string& url) const {
  std::vector<std::string> ids;
  for (const auto& [id, stored] : scan(folder_)) {
    if (std::ranges::find(stored.paths, curve_path(id)) != stored.paths.end() && !is_stored(id, url)) ids.push_back(id);
  }
  return ids;
}

CacheFolder::Contents CacheFolder::contents() const {
  Contents out;
  for (const auto& [id, stored] : scan(folder_)) {
    const auto ours = paths(id);
    for (const std::string& file : stored.paths) {
      out.sessions += file == ours.front();
      out.foreign += std::ranges::find(ours, file) == ours.end();
    }
    out.bytes += stored.bytes;
  }
  return out;
}

std::uint64_t CacheFolder::make_room(std::uint64_t max_bytes, const std::function<bool(const std::string& id)>& may_go,
                                     const std::function<void(const std::string& id)>& on_removed) const {
  const std::map<std::string, Stored> sessions = scan(folder_);
  std::uint64_t used = 0;
  std::vector<const std::pair<const std::string, Stored>*> by_age;
  for (const auto& entry : sessions) {
    used += entry.second.bytes;
    by_age.push_back(&entry);
  }
  std::sort(by_age.begin(), by_age.end(), [](const auto* a, const auto* b) { return a->second.last_used < b->second.last_used; });
  for (const auto* entry : by_age) {
    if (used <= max_bytes) break;
    if (!may_go(entry->first)) continue;
    unmark_stored(entry->first);
    remove_all(entry->second.paths);
    used -= entry->second.bytes;
    on_removed(entry->first);
  }
  return used;
}

}  // namespace curvecast::server
