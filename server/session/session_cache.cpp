#include "server/session/session_cache.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <malloc.h>
#include <spdlog/logger.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>
#include <vector>

#include "core/base/stopwatch.h"
#include "core/storage/atomic_file.h"
#include "core/storage/curve_file.h"
#include "core/storage/rank_file.h"
#include "core/storage/surface_file.h"
#include "server/base/status_from_exceptions.h"
#include "server/session/session_record.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxPendingSaves = 16;
constexpr std::size_t kMaxPendingLoads = 1024;
constexpr std::size_t kIdDigits = 32;
constexpr char kMark[] = ".closed";
constexpr std::chrono::hours kMarkLife{24};

/// Nothing else may become part of a path: ids come from clients.
bool is_session_id(const std::string& id) {
  return id.size() == kIdDigits && std::all_of(id.begin(), id.end(), [](char c) {
           return absl::ascii_isdigit(static_cast<unsigned char>(c)) || (c >= 'a' && c <= 'f');
         });
}

bool is_file(const std::string& path) {
  struct stat status = {};
  return ::stat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

/// A session's files, of any version.
struct Stored {
  std::vector<std::string> paths;
  std::uint64_t bytes = 0;
  std::int64_t last_used = 0;  // nanoseconds: loading a session touches its file
};

std::map<std::string, Stored> scan(const std::string& folder) {
  std::map<std::string, Stored> sessions;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const std::string id = name.substr(0, kIdDigits);
    const bool is_ours = is_session_id(id) && (absl::EndsWith(name, ".curve") || absl::EndsWith(name, ".refined") ||
                                               absl::EndsWith(name, ".ranks") || absl::EndsWith(name, ".surface"));
    struct stat status = {};
    if (!is_ours || ::lstat(it->path().c_str(), &status) != 0 || !S_ISREG(status.st_mode)) continue;
    Stored& stored = sessions[id];
    stored.paths.push_back(it->path().string());
    stored.bytes += static_cast<std::uint64_t>(status.st_size);
    stored.last_used = std::max<std::int64_t>(stored.last_used, status.st_mtim.tv_sec * 1'000'000'000 + status.st_mtim.tv_nsec);
  }
  return sessions;
}

/// Removes the marks of sessions that were closed so long ago that no server has them in memory.
void remove_old_marks(const std::string& folder) {
  const fs::file_time_type oldest = fs::file_time_type::clock::now() - kMarkLife;
  std::error_code error, ignored;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_mark = is_session_id(name.substr(0, kIdDigits)) && name.substr(kIdDigits) == kMark;
    if (is_mark && fs::last_write_time(it->path(), ignored) < oldest) fs::remove(it->path(), ignored);
  }
}

/// The folder's absolute path; it exists and can be written to.
absl::StatusOr<std::string> make_folder(const std::string& folder) {
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

absl::Status check_faces(const SurfaceCurve& curve, std::uint64_t faces, const std::string& path) {
  if (*std::max_element(curve.triangle.begin(), curve.triangle.end()) < faces) return absl::OkStatus();
  return absl::DataLossError(absl::StrCat(path, ": its curve lies on a face that is not there"));
}

/// A session without its curve, from the note in its file.
absl::StatusOr<std::shared_ptr<Session>> read_record(const std::string& note, const std::string& id, const std::string& path) {
  absl::StatusOr<std::shared_ptr<Session>> session = session_of(note, id);
  if (session.ok()) return session;
  return absl::Status(session.status().code(), absl::StrCat(path, ": ", session.status().message()));
}

absl::StatusOr<std::shared_ptr<Session>> to_session(CurveFile file, const std::string& id, const std::string& path) {
  absl::StatusOr<std::shared_ptr<Session>> session = read_record(file.note, id, path);
  if (!session.ok()) return session;
  if (absl::Status status = check_faces(*file.curve, (*session)->preprocessed.report.mesh.faces, path); !status.ok())
    return status;
  (*session)->revisions->publish(std::move(file.curve));
  (*session)->peak_bytes = peak_memory_bytes();
  return session;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SessionCache>> SessionCache::open(const std::string& folder, std::uint64_t max_bytes,
                                                                 std::shared_ptr<spdlog::logger> log) {
  const absl::StatusOr<std::string> path = make_folder(folder);
  if (!path.ok()) return path.status();
  const std::size_t stale = remove_stale_temporaries(*path);
  remove_old_marks(*path);
  std::unique_ptr<SessionCache> cache(new SessionCache(*path, max_bytes, std::move(log)));
  std::size_t sessions = 0, foreign = 0;
  std::uint64_t bytes = 0;
  for (const auto& [id, stored] : scan(*path)) {
    const auto ours = cache->paths(id);
    for (const std::string& file : stored.paths) {
      sessions += file == cache->curve_path(id);
      foreign += std::ranges::find(ours, file) == ours.end();
    }
    bytes += stored.bytes;
  }
  cache->log_->info("cache {}: {} sessions, {} MiB of {} MiB; {} files of other versions ignored, {} unfinished ones removed",
                    *path, sessions, bytes >> 20, max_bytes >> 20, foreign, stale);
  return cache;
}

SessionCache::SessionCache(std::string folder, std::uint64_t max_bytes, std::shared_ptr<spdlog::logger> log)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      log_(std::move(log)),
      loading_({.max_waiting = kMaxPendingLoads}),
      saving_queue_({.max_waiting = kMaxPendingSaves}) {}

SessionCache::~SessionCache() { stop(); }

void SessionCache::stop() {
  loading_.stop();
  saving_queue_.stop();
}

std::string SessionCache::curve_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kCurveFileVersion, ".curve");
}

std::string SessionCache::refined_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kCurveFileVersion, ".refined");
}

std::string SessionCache::ranks_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kRankFileVersion, ".ranks");
}

std::string SessionCache::surface_path(const std::string& id) const {
  return absl::StrCat(folder_, "/", id, ".v", kSurfaceFileVersion, ".surface");
}

std::string SessionCache::closed_path(const std::string& id) const { return absl::StrCat(folder_, "/", id, kMark); }

std::array<std::string, 4> SessionCache::paths(const std::string& id) const {
  return {curve_path(id), refined_path(id), ranks_path(id), surface_path(id)};
}

bool SessionCache::holds(const std::string& id) const {
  if (!is_session_id(id)) return false;
  const MutexLock lock(mutex_);
  return !is_going(id) && is_file(curve_path(id)) && !is_closed(id);
}

absl::StatusOr<std::string> SessionCache::owner(const std::string& id) const {
  if (!holds(id)) return absl::NotFoundError("it is not in the cache");
  const std::string path = curve_path(id);
  const absl::StatusOr<std::string> note = load_note(path);
  const absl::StatusOr<std::shared_ptr<Session>> session = note.ok() ? read_record(*note, id, path) : note.status();
  if (session.ok()) return (*session)->owner;
  discard(path, session.status());
  return is_file(path) ? session.status() : absl::NotFoundError("it is not in the cache any more");
}

void SessionCache::touch(const std::string& id) const { ::utimensat(AT_FDCWD, curve_path(id).c_str(), nullptr, 0); }

bool SessionCache::is_closed(const std::string& id) const { return is_session_id(id) && is_file(closed_path(id)); }

void SessionCache::reopen(const std::string& id) const {
  std::error_code ignored;
  fs::remove(closed_path(id), ignored);
}

void SessionCache::wait_until_removed(const std::string& id) {
  const MutexLock lock(mutex_);
  while (is_going(id)) saved_.wait(mutex_);
}

absl::Status SessionCache::check_wanted(const std::string& id) const {
  const MutexLock lock(mutex_);
  return is_going(id) || is_closed(id) ? absl::CancelledError("it was closed") : absl::OkStatus();
}

bool SessionCache::is_going(const std::string& id) const { return saving_ == id && unwanted_; }

bool SessionCache::remove_files(const std::string& id) const {
  std::error_code ignored;
  const bool removed = fs::remove(curve_path(id), ignored);
  for (const std::string& path : paths(id)) fs::remove(path, ignored);
  return removed;
}

bool SessionCache::remove(const std::string& id) {
  if (!is_session_id(id)) return false;
  const MutexLock lock(mutex_);
  const bool was_gone = is_going(id);
  const bool was_pending = pending_.erase(id) > 0;
  const bool was_there = was_pending || saving_ == id || is_file(curve_path(id));
  if (saving_ == id) unwanted_ = true;
  // First the mark: what another server writes meanwhile does not count, and goes.
  if (was_there) std::ofstream(closed_path(id), std::ios::app);
  remove_files(id);
  return was_pending || (was_there && !was_gone);
}

void SessionCache::discard(const std::string& path, const absl::Status& reason) const {
  if (absl::IsNotFound(reason)) return;
  const bool is_useless = absl::IsDataLoss(reason) || absl::IsFailedPrecondition(reason);
  std::error_code ignored;
  const bool removed = is_useless && fs::remove(path, ignored);
  log_->warn("cache: {}{}", std::string(reason.message()), removed ? "; removed" : "");
}

absl::StatusOr<std::shared_ptr<const Session>> SessionCache::load(const std::string& id) {
  if (!holds(id)) return absl::NotFoundError("it is not in the cache");
  const std::string path = curve_path(id);
  auto session = status_from_exceptions([&]() -> absl::StatusOr<std::shared_ptr<const Session>> {
    absl::StatusOr<CurveFile> file = load_curve(path);
    if (!file.ok()) return file.status();
    absl::StatusOr<std::shared_ptr<Session>> loaded = to_session(*std::move(file), id, path);
    if (!loaded.ok()) return loaded.status();
    (*loaded)->surface = std::make_shared<SessionSurface>([this, id](const ExecutionContext&) { return open_surface(id); });
    // Now, when the session can still be made anew: it is only mapped.
    if (absl::Status status = (*loaded)->curve_base().status(); !status.ok()) return status;
    load_ranks(**loaded);
    load_refined(**loaded);
    return *std::move(loaded);
  });
  if (session.ok()) {
    touch(id);
  } else {
    discard(path, session.status());
  }
  return session;
}

void SessionCache::load_refined(const Session& session) {
  const std::string path = refined_path(session.id);
  if (!is_file(path)) return;
  absl::StatusOr<CurveFile> file = load_curve(path);
  absl::Status status = file.status();
  if (file.ok() && file->note != session.id) status = absl::DataLossError(absl::StrCat(path, ": it is of another session"));
  if (status.ok()) status = check_faces(*file->curve, session.preprocessed.report.mesh.faces, path);
  if (status.ok()) {
    session.revisions->publish(std::move(file->curve));
  } else {
    discard(path, status);
  }
}

void SessionCache::load_ranks(const Session& session) {
  const std::string path = ranks_path(session.id);
  if (!is_file(path)) return;
  const std::shared_ptr<const SurfaceCurve> curve = session.revisions->first();
  absl::StatusOr<RankFile> file = curvecast::load_ranks(path, *curve, session.preprocessed.report.mesh.faces, session.id);
  if (!file.ok()) return discard(path, file.status());
  session.candidates->restore({curve, std::move(file->tree)}, file->level, session.options.seed,
                              [surface = session.surface, curve] { return surface->leaves(curve); });
}

void SessionCache::discard_surface(const std::string& id, const absl::Status& reason) const {
  discard(surface_path(id), reason);
  if (!is_file(surface_path(id))) remove_files(id);  // without it the curve is of no use
}

absl::StatusOr<std::shared_ptr<const CurveBase>> SessionCache::open_surface(const std::string& id) {
  if (!is_session_id(id)) return absl::NotFoundError("it is not in the cache");
  auto surface = status_from_exceptions([&] {
    return curvecast::open_surface(surface_path(id), id, [this, id](const absl::Status& status) { discard_surface(id, status); });
  });
  if (!surface.ok()) discard_surface(id, surface.status());
  return surface;
}

void SessionCache::save(const Session& session) {
  Snapshot snapshot = {session.revisions->first(), session.curve(), session.surface, session.candidates, record_of(session)};
  const std::string& id = session.id;
  absl::Status status;
  const MutexLock lock(mutex_);
  if (snapshot.first->byte_size() > max_bytes_) {
    status = absl::ResourceExhaustedError("it alone is larger than the cache may be");
  } else if (const auto [waiting, is_new] = pending_.insert_or_assign(id, std::move(snapshot)); is_new) {
    status = saving_queue_.submit([this, id] { save_next(id); }).status();
    if (!status.ok()) pending_.erase(waiting);
  }
  if (!status.ok()) note_failure(id, status);
}

void SessionCache::note_failure(const std::string& id, const absl::Status& status) {
  if (!std::exchange(failing_, true)) log_->error("session {} is not cached: {}", id, std::string(status.message()));
}

void SessionCache::save_next(const std::string& id) {
  Snapshot snapshot;
  {
    const MutexLock lock(mutex_);
    auto node = pending_.extract(id);
    if (node.empty()) return;  // removed meanwhile
    snapshot = std::move(node.mapped());
    saving_ = id;
    unwanted_ = false;
  }
  Stopwatch watch;
  const absl::Status status = status_from_exceptions([&] { return write(id, snapshot); });
  const double seconds = watch.lap();
  if (status.ok() && check_wanted(id).ok()) move_to_file(id, snapshot);
  {
    const MutexLock lock(mutex_);
    saving_.clear();
    if (unwanted_ || is_closed(id)) {
      remove_files(id);
    } else if (status.ok()) {
      failing_ = false;
      log_->info("session {} cached in {:.3f} s: revision {}", id, seconds, snapshot.newest->revision);
    } else {
      note_failure(id, status);
    }
    saved_.notify_all();
  }
  make_room();
}

/// The surface in memory makes way for the file: the same, to the bit.
void SessionCache::move_to_file(const std::string& id, const Snapshot& snapshot) {
  if (snapshot.surface->byte_size() == 0) return;
  absl::Status status = status_from_exceptions([&] {
    absl::StatusOr<std::shared_ptr<const CurveBase>> base = open_surface(id);
    if (!base.ok()) return base.status();
    snapshot.surface->move_to(*std::move(base));
    return snapshot.candidates->move_to([&] { return snapshot.surface->leaves(snapshot.first); });
  });
  // The surface lay in many pieces, each too small for the allocator to hand it back at once.
  if (status.ok()) ::malloc_trim(0);
  if (!status.ok()) log_->warn("cache: session {} stays in memory: {}", id, std::string(status.message()));
}

absl::Status SessionCache::write(const std::string& id, const Snapshot& snapshot) const {
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  // The first curve's file comes after the surface's: where it is, the other one is too. A revision has a new curve on the old
  // surface; the first one stays, since ranked points lie on it.
  if (!is_file(surface_path(id))) {
    const absl::StatusOr<std::shared_ptr<const CurveBase>> base = snapshot.surface->base();
    if (!base.ok()) return base.status();
    if (absl::Status status = save_surface(surface_path(id), **base, id); !status.ok()) return status;
  }
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  if (!is_file(curve_path(id))) {
    if (absl::Status status = save_curve(curve_path(id), *snapshot.first, snapshot.record); !status.ok()) {
      remove_files(id);
      return status;
    }
  }
  // Those of the lowest ranks, which first views show: the surface's file is read only when views come nearer.
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  if (const auto ranks = snapshot.candidates->made(); ranks.tree != nullptr && !is_file(ranks_path(id))) {
    absl::Status status = save_ranks(ranks_path(id), *ranks.tree, RankedCandidates::kMostLevelsAtFirst, id);
    if (!status.ok()) return status;
  }
  if (snapshot.newest == snapshot.first) return absl::OkStatus();
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  return save_curve(refined_path(id), *snapshot.newest, id);
}

std::uint64_t SessionCache::used_bytes() const {
  std::uint64_t bytes = 0;
  for (const auto& [id, stored] : scan(folder_)) bytes += stored.bytes;
  return bytes;
}

void SessionCache::make_room() const {
  std::map<std::string, Stored> sessions = scan(folder_);
  std::uint64_t used = 0;
  std::vector<const std::pair<const std::string, Stored>*> by_age;
  for (const auto& entry : sessions) {
    used += entry.second.bytes;
    by_age.push_back(&entry);
  }
  std::sort(by_age.begin(), by_age.end(), [](const auto* a, const auto* b) { return a->second.last_used < b->second.last_used; });
  for (const auto* entry : by_age) {
    if (used <= max_bytes_) return;
    std::error_code ignored;
    for (const std::string& path : entry->second.paths) fs::remove(path, ignored);
    used -= entry->second.bytes;
    log_->info("session {} removed from the cache: the least recently used", entry->first);
  }
}

}  // namespace curvecast::server
