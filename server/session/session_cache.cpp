#include "server/session/session_cache.h"

#include <absl/strings/str_cat.h>
#include <malloc.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

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

constexpr std::size_t kMaxPendingLoads = 1024;
constexpr int kFetchThreads = 8;  // which mostly wait
constexpr std::size_t kMaxFetchesOfOne = 256;
constexpr std::chrono::seconds kLookInterval{5};
// Of candidates made for views: 56 MB.
constexpr std::size_t kMostDeeperPoints = 1'000'000;
static_assert(RankedCandidates::kMostLevelsAtFirst <= kFirstFreeLevel, "those can be restored");

/// Checks that a curve, which is sound by itself, can lie on a surface: it has all that the curve names of it.
absl::Status check_lies_on(const CurveBase& surface, const SurfaceCurve& curve, const std::string& path) {
  if (curve.disc_begin.size() != surface.charts.size() + 1 || curve.scalars.size() != surface.data.scalars.size() ||
      curve.colour.empty() != (surface.data.colour == nullptr)) {
    return absl::DataLossError(absl::StrCat(path, ": its curve is another surface's"));
  }
  if (*std::max_element(curve.triangle.begin(), curve.triangle.end()) < surface.triangle_of.size()) return absl::OkStatus();
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
  (*session)->revisions->publish(std::move(file.curve));
  (*session)->files.push_back(std::move(file.file));
  (*session)->peak_bytes = peak_memory_bytes();
  return session;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SessionCache>> SessionCache::open(const std::string& folder, std::uint64_t max_bytes,
                                                                 std::shared_ptr<spdlog::logger> log, WatchedStore* store) {
  const absl::StatusOr<std::string> path = make_cache_folder(folder);
  if (!path.ok()) return path.status();
  const std::size_t stale = remove_stale_temporaries(*path);
  std::unique_ptr<SessionCache> cache(new SessionCache(*path, max_bytes, std::move(log), store));
  cache->folder_.remove_old_marks();
  const CacheFolder::Contents contents = cache->folder_.contents();
  cache->used_bytes_ = contents.bytes;
  cache->log_->info("cache {}: {} sessions, {} MiB of {} MiB; {} files of other versions ignored, {} unfinished ones removed",
                    *path, contents.sessions, contents.bytes >> 20, max_bytes >> 20, contents.foreign, stale);
  return cache;
}

SessionCache::SessionCache(std::string folder, std::uint64_t max_bytes, std::shared_ptr<spdlog::logger> log, WatchedStore* store)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      log_(std::move(log)),
      shared_(store != nullptr ? std::make_unique<SharedSessions>(*store, folder_, max_bytes, log_) : nullptr),
      loading_({.max_waiting = kMaxPendingLoads}),
      fetching_(store != nullptr ? std::make_unique<JobQueue>(JobQueue::Options{.workers = kFetchThreads,
                                                                                .max_waiting = kMaxPendingLoads,
                                                                                .max_waiting_of_one = kMaxFetchesOfOne,
                                                                                .max_running_of_one = kFetchThreads / 2})
                                 : nullptr),
      saving_candidates_({.max_waiting = kMaxPendingLoads, .low_priority = true}),
      saves_({.undo = [this](const std::string& id) { folder_.remove_files(id); },
              .on_tried = [this](const std::string& id, const absl::Status& status,
                                 bool is_lost) { note_saved(id, status, is_lost); }}) {}

SessionCache::~SessionCache() { stop(); }

void SessionCache::stop() {
  loading_.stop();
  if (fetching_ != nullptr) fetching_->stop();
  saving_candidates_.stop();
  saves_.stop();
  if (shared_ != nullptr) shared_->stop();
}

absl::Status SessionCache::fetch(const std::string& id) {
  if (!is_content_id(id) || shared_ == nullptr) return absl::NotFoundError("it is not in the cache");
  absl::Status status = shared_->fetch(id);
  if (status.ok()) make_room();
  return status;
}

absl::Status SessionCache::why_missing(const std::string& id) const {
  return shared_ != nullptr ? shared_->why_missing(id) : absl::NotFoundError("it is not in the cache");
}

std::vector<std::string> SessionCache::unstored_ids() const {
  return shared_ != nullptr ? shared_->unstored_ids() : std::vector<std::string>();
}

void SessionCache::watch(const std::vector<std::string>& ids, std::chrono::steady_clock::duration interval) const {
  if (shared_ != nullptr) shared_->watch(ids, interval);
}

absl::Status SessionCache::close_for_all(const std::string& id) const {
  return shared_ != nullptr ? shared_->close(id) : absl::OkStatus();
}

void SessionCache::reopen(const std::string& id) const {
  if (shared_ != nullptr && !holds(id)) shared_->reopen(id);
  folder_.remove_mark(id);
}

bool SessionCache::holds(const std::string& id) const {
  return is_content_id(id) && is_file(folder_.curve_path(id)) && !saves_.is_withdrawn(id) && !is_closed(id);
}

absl::StatusOr<std::string> SessionCache::owner(const std::string& id) {
  if (!holds(id)) {
    if (absl::Status fetched = fetch(id); !fetched.ok()) return fetched;
  }
  const std::string path = folder_.curve_path(id);
  const absl::StatusOr<std::string> note = load_note(path);
  const absl::StatusOr<std::shared_ptr<Session>> session = note.ok() ? read_record(*note, id, path) : note.status();
  if (session.ok()) return (*session)->owner;
  discard(path, session.status());
  return is_file(path) ? session.status() : absl::NotFoundError("it is not in the cache any more");
}

bool SessionCache::remove(const std::string& id) {
  if (!is_content_id(id)) return false;
  const RetryQueue::Found found = saves_.withdraw(id);
  const bool is_there = is_file(folder_.curve_path(id));
  // First the mark: what another server writes meanwhile does not count, and goes.
  if (found != RetryQueue::Found::kNothing || is_there) folder_.mark_closed(id);
  folder_.remove_files(id);
  if (found == RetryQueue::Found::kNothing) return is_there;
  return found != RetryQueue::Found::kWithdrawn;
}

void SessionCache::remove_damaged(const std::string& id) {
  saves_.withdraw(id);
  folder_.remove_files(id);
}

void SessionCache::discard(const std::string& path, const absl::Status& reason, bool is_fetched) const {
  if (absl::IsNotFound(reason)) return;
  const bool is_useless = absl::IsDataLoss(reason) || absl::IsFailedPrecondition(reason);
  if (is_useless && is_fetched) shared_->remove_file(path);
  std::error_code ignored;
  const bool removed = is_useless && fs::remove(path, ignored);
  log_->warn("cache: {}{}", std::string(reason.message()), removed ? "; removed" : "");
}

absl::StatusOr<std::shared_ptr<const Session>> SessionCache::load(const std::string& id) {
  absl::StatusOr<std::shared_ptr<const Session>> session = absl::NotFoundError("it is not in the cache");
  if (holds(id)) session = load_here(id);
  // What was damaged here may be sound there.
  if (session.ok() || shared_ == nullptr || holds(id)) return session;
  if (absl::Status fetched = fetch(id); !fetched.ok()) return absl::IsNotFound(fetched) ? session : fetched;
  return load_here(id);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionCache::load_here(const std::string& id) {
  const bool is_fetched = shared_ != nullptr && shared_->take_fresh(id);
  auto session = status_from_exceptions([&] { return read(id, is_fetched); });
  loads_.add(session.ok());
  if (session.ok()) {
    touch(id);
  } else {
    discard(folder_.curve_path(id), session.status());
    if (is_fetched && !is_file(folder_.curve_path(id))) shared_->remove_damaged(id);
  }
  return session;
}

absl::StatusOr<std::shared_ptr<const Session>> SessionCache::read(const std::string& id, bool is_fetched) {
  const std::string path = folder_.curve_path(id);
  absl::StatusOr<CurveFile> file = load_curve(path);
  if (!file.ok()) return file.status();
  absl::StatusOr<std::shared_ptr<Session>> loaded = to_session(*std::move(file), id, path);
  if (!loaded.ok()) return loaded.status();
  Session& session = **loaded;
  session.surface = std::make_shared<SessionSurface>([this, id](const ExecutionContext&) { return open_surface(id); });
  // Now, when the session can still be made anew: it is only mapped.
  const absl::StatusOr<std::shared_ptr<const CurveBase>> surface = session.curve_base();
  if (!surface.ok()) return surface.status();
  if (absl::Status status = check_lies_on(**surface, *session.curve(), path); !status.ok()) {
    folder_.remove_files(id);  // either may be the wrong one
    return status;
  }
  load_ranks(session, **surface, is_fetched);
  load_refined(session, **surface, is_fetched);
  if (absl::Status status = session.status(); !status.ok()) return status;
  return *std::move(loaded);
}

void SessionCache::load_refined(Session& session, const CurveBase& surface, bool is_fetched) {
  const std::string path = folder_.refined_path(session.id);
  if (!is_file(path)) return;
  absl::StatusOr<CurveFile> file = load_curve(path);
  absl::Status status = file.status();
  if (file.ok() && file->note != session.id) status = absl::DataLossError(absl::StrCat(path, ": it is of another session"));
  if (status.ok()) status = check_lies_on(surface, *file->curve, path);
  if (status.ok()) {
    session.revisions->publish(std::move(file->curve));
    session.files.push_back(std::move(file->file));
  } else {
    discard(path, status, is_fetched);
  }
}

void SessionCache::load_ranks(const Session& session, const CurveBase& surface, bool is_fetched) {
  const std::shared_ptr<const SurfaceCurve> curve = session.revisions->first();
  // Those that have grown include the others.
  for (const std::string& path : {folder_.grown_path(session.id), folder_.ranks_path(session.id)}) {
    if (!is_file(path)) continue;
    absl::StatusOr<RankFile> file = curvecast::load_ranks(path, *curve, surface.triangle_of.size(), session.id);
    if (file.ok()) {
      session.candidates->restore({curve, std::move(file->tree)}, file->level, session.options.seed,
                                  [below = session.surface, curve] { return below->leaves(curve); });
      return;
    }
    discard(path, file.status(), is_fetched);
  }
}

void SessionCache::discard_surface(const std::string& id, const absl::Status& reason) const {
  discard(folder_.surface_path(id), reason);
  if (!is_file(folder_.surface_path(id))) folder_.remove_files(id);  // without it the curve is of no use
}

absl::StatusOr<std::shared_ptr<const CurveBase>> SessionCache::open_surface(const std::string& id) {
  if (!is_content_id(id)) return absl::NotFoundError("it is not in the cache");
  auto surface = status_from_exceptions([&] {
    return curvecast::open_surface(folder_.surface_path(id), id,
                                   [this, id](const absl::Status& status) { discard_surface(id, status); });
  });
  if (!surface.ok()) discard_surface(id, surface.status());
  return surface;
}

void SessionCache::save(const Session& session) {
  if (session.revisions->first()->byte_size() > max_bytes_) {
    note_failure(session.id, "it alone is larger than the cache may be", false);
  } else {
    saves_.put(session.id, [this, copy = std::make_shared<const Session>(session)](const std::atomic<bool>& /*cancel*/) {
      return write_and_move(*copy);
    });
  }
}

void SessionCache::save_candidates(const Session& session) {
  RankedCurve grown = session.candidates->take_grown();
  if (grown.tree == nullptr) return;
  static_cast<void>(saving_candidates_.submit([this, id = session.id, tree = std::move(grown.tree)] {
    absl::Status status = status_from_exceptions([&] { return write_candidates(id, *tree); });
    if (!status.ok()) log_->warn("cache: candidates of session {} are not kept: {}", id, std::string(status.message()));
  }));
}

absl::Status SessionCache::write_candidates(const std::string& id, const RankTree& tree) const {
  // Without the session's other files nobody would load it.
  const auto is_wanted = [&] { return !is_closed(id) && holds(id); };
  if (!is_wanted()) return absl::OkStatus();
  const std::string path = folder_.grown_path(id);
  absl::Status status =
      save_ranks(path, tree, {.whole_levels = RankedCandidates::kMostLevelsAtFirst, .most_deeper_points = kMostDeeperPoints}, id);
  if (!is_wanted()) remove_path(path);
  return status;
}

absl::Status SessionCache::check_wanted(const std::string& id) const {
  return saves_.is_withdrawn(id) || is_closed(id) ? absl::CancelledError("it was closed") : absl::OkStatus();
}

absl::Status SessionCache::write_and_move(const Session& session) {
  Stopwatch watch;
  absl::Status status = status_from_exceptions([&] { return write(session); });
  const double seconds = watch.lap();
  if (status.ok()) status = check_wanted(session.id);
  if (status.ok()) {
    move_to_file(session);
    log_->info("session {} cached in {:.3f} s: revision {}", session.id, seconds, session.curve()->revision);
  }
  if (is_closed(session.id)) {
    folder_.remove_files(session.id);
    status = absl::CancelledError("it was closed");
  }
  if (status.ok() && shared_ != nullptr) shared_->put(session.id);
  make_room();
  return status;
}

void SessionCache::will_change(const std::string& id) const {
  if (shared_ != nullptr) folder_.unmark_stored(id);
}

void SessionCache::move_to_file(const Session& session) {
  if (session.surface->byte_size() == 0) return;
  absl::Status status = status_from_exceptions([&] {
    absl::StatusOr<std::shared_ptr<const CurveBase>> base = open_surface(session.id);
    if (!base.ok()) return base.status();
    // The same, to the bit.
    session.surface->move_to(*std::move(base));
    return session.candidates->move_to([&] { return session.surface->leaves(session.revisions->first()); });
  });
  // The surface lay in many pieces, each too small for the allocator to hand it back at once.
  if (status.ok()) ::malloc_trim(0);
  if (!status.ok()) log_->warn("cache: session {} stays in memory: {}", session.id, std::string(status.message()));
}

absl::Status SessionCache::write(const Session& session) const {
  const std::string& id = session.id;
  const std::shared_ptr<const SurfaceCurve> first = session.revisions->first(), newest = session.curve();
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  // The first curve's file comes after the surface's: where it is, the other one is too. A revision has a new curve on the old
  // surface; the first one stays, since ranked points lie on it.
  if (!is_file(folder_.surface_path(id))) {
    const absl::StatusOr<std::shared_ptr<const CurveBase>> base = session.surface->base();
    if (!base.ok()) return base.status();
    if (absl::Status status = save_surface(folder_.surface_path(id), **base, id); !status.ok()) return status;
  }
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  if (!is_file(folder_.curve_path(id))) {
    will_change(id);
    if (absl::Status status = save_curve(folder_.curve_path(id), *first, record_of(session)); !status.ok()) {
      folder_.remove_files(id);
      return status;
    }
  }
  // Those of the lowest ranks, which first views show: the surface's file is read only when views come nearer.
  if (absl::Status status = check_wanted(id); !status.ok()) return status;
  if (const auto ranks = session.candidates->made(); ranks.tree != nullptr && !is_file(folder_.ranks_path(id))) {
    will_change(id);
    absl::Status status =
        save_ranks(folder_.ranks_path(id), *ranks.tree, {.whole_levels = RankedCandidates::kMostLevelsAtFirst}, id);
    if (!status.ok()) return status;
  }
  if (newest != first) {
    if (absl::Status status = check_wanted(id); !status.ok()) return status;
    will_change(id);
    if (absl::Status status = save_curve(folder_.refined_path(id), *newest, id); !status.ok()) return status;
  }
  // What was written may have been taken from files that are gone.
  absl::Status status = session.status();
  if (!status.ok()) folder_.remove_files(id);
  return status;
}

void SessionCache::note_saved(const std::string& id, const absl::Status& status, bool is_lost) {
  if (absl::IsCancelled(status)) return;
  saves_tried_.add(status.ok());
  if (status.ok()) {
    failing_ = false;
  } else {
    note_failure(id, std::string(status.message()), !is_lost);
  }
}

void SessionCache::note_failure(const std::string& id, const std::string& reason, bool is_tried_again) {
  if (failing_.exchange(true)) return;
  log_->error("session {} is not cached: {}{}", id, reason, is_tried_again ? "; trying again" : "");
}

void SessionCache::make_room() {
  // What is not in the store yet would be lost.
  const auto may_go = [this](const std::string& id) { return shared_ == nullptr || shared_->is_stored(id); };
  used_bytes_ = folder_.make_room(max_bytes_, may_go, [this](const std::string& id) {
    log_->info("session {} removed from the cache: the least recently used", id);
  });
}

void SessionCache::refresh_used_bytes(std::chrono::steady_clock::time_point now) {
  {
    const MutexLock lock(look_mutex_);
    if (now - looked_at_ < kLookInterval) return;
    looked_at_ = now;
  }
  used_bytes_ = folder_.contents().bytes;
}

std::map<std::pair<std::string, std::string>, std::uint64_t> SessionCache::operations() const {
  const auto [removed, not_removed] = folder_.removals();
  return {{{"load", "ok"}, loads_.ok},       {{"load", "error"}, loads_.error},
          {{"save", "ok"}, saves_tried_.ok}, {{"save", "error"}, saves_tried_.error},
          {{"remove", "ok"}, removed},       {{"remove", "error"}, not_removed}};
}

}  // namespace curvecast::server
