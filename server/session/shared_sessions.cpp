#include "server/session/shared_sessions.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <future>
#include <system_error>
#include <utility>

#include "core/storage/curve_file.h"
#include "core/storage/surface_file.h"
#include "server/session/session_record.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::seconds kMissLife{1};
constexpr std::size_t kMostMisses = 4096;
constexpr std::size_t kMostKnown = 100'000;  // sessions of which something is remembered
// Of what is got, until it is known to be good; removed by the next start where the process is killed meanwhile.
constexpr char kFetched[] = ".fetched.curvecast-tmp";
constexpr char kEmpty[] = "empty";

std::string name_of(const std::string& path) { return absl::StrCat("sessions/", fs::path(path).filename().string()); }
std::string closed_name(const std::string& id) { return absl::StrCat("sessions/", id, ".closed"); }

std::uint64_t size_of(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return error ? 0 : size;
}

absl::Status rename_file(const std::string& from, const std::string& to) {
  std::error_code error;
  fs::rename(from, to, error);
  return error ? absl::UnavailableError(absl::StrCat(to, ": ", error.message())) : absl::OkStatus();
}

absl::Status or_not_found(absl::Status status) { return absl::IsNotFound(status) ? absl::OkStatus() : status; }

/// What who wanted a session is told: nothing of permissions that this server lacks.
absl::Status for_caller(const absl::Status& status) {
  if (status.ok() || absl::IsNotFound(status) || absl::IsResourceExhausted(status)) return status;
  return absl::UnavailableError(status.message());
}

/// Whose a session is, as its curve's file says; an error where that is none.
absl::StatusOr<std::string> owner_in(const std::string& path, const std::string& id) {
  const absl::StatusOr<std::string> note = load_note(path);
  if (!note.ok()) return note.status();
  const absl::StatusOr<std::shared_ptr<Session>> session = session_of(*note, id);
  if (!session.ok()) return session.status();
  return (*session)->owner;
}

}  // namespace

SharedSessions::SharedSessions(WatchedStore& store, const CacheFolder& folder, std::uint64_t max_bytes,
                               std::shared_ptr<spdlog::logger> log)
    : store_(store),
      folder_(folder),
      max_bytes_(max_bytes),
      log_(std::move(log)),
      puts_(
          {.undo = {},
           .on_tried = [this](const std::string& id, const absl::Status& status, bool /*is_lost*/) { note_tried(id, status); }}),
      looking_([this] { look_for_closed(); }) {
  for (const std::string& id : folder_.unstored(store_.url())) put(id);
}

SharedSessions::~SharedSessions() { stop(); }

void SharedSessions::stop() {
  {
    const MutexLock lock(mutex_);
    is_stopping_ = true;
    changed_.notify_all();
  }
  puts_.stop();
  store_.end();
  const MutexLock lock(join_mutex_);
  if (looking_.joinable()) looking_.join();
}

void SharedSessions::put(const std::string& id) {
  puts_.put(id, [this, id](const std::atomic<bool>& cancel) { return put_files(id, cancel); });
}

void SharedSessions::note_tried(const std::string& id, const absl::Status& status) {
  if (absl::IsCancelled(status)) return;
  if (status.ok()) {
    failing_ = false;
  } else if (!failing_.exchange(true)) {
    log_->error("session {} is not in the store: {}; trying again", id, std::string(status.message()));
  }
}

bool SharedSessions::may_have(const std::string& id) const {
  const MutexLock lock(mutex_);
  const auto miss = misses_.find(id);
  return is_content_id(id) && (miss == misses_.end() || miss->second.until < Clock::now());
}

absl::Status SharedSessions::why_missing(const std::string& id) const {
  const MutexLock lock(mutex_);
  const auto miss = misses_.find(id);
  if (miss == misses_.end() || miss->second.until < Clock::now()) return absl::NotFoundError("it is not in the store");
  return miss->second.status;
}

absl::Status SharedSessions::fetch(const std::string& id) {
  {
    const MutexLock lock(mutex_);
    while (fetching_.contains(id)) changed_.wait(mutex_);  // another thread gets it
    const auto miss = misses_.find(id);
    if (miss != misses_.end() && miss->second.until >= Clock::now()) return miss->second.status;
    fetching_.insert(id);
  }
  const bool is_there = is_file(folder_.curve_path(id)) && !folder_.is_closed(id);
  const absl::Status status = is_there ? absl::OkStatus() : for_caller(fetch_files(id));
  const MutexLock lock(mutex_);
  if (!is_there && status.ok()) {
    fresh_.insert(id);
    know_curve(id);
  }
  fetching_.erase(id);
  changed_.notify_all();
  if (misses_.size() >= kMostMisses) misses_.clear();
  misses_.erase(id);
  if (!status.ok()) misses_.emplace(id, Miss{status, Clock::now() + kMissLife});
  return status;
}

bool SharedSessions::take_fresh(const std::string& id) {
  const MutexLock lock(mutex_);
  return fresh_.erase(id) > 0;
}

absl::Status SharedSessions::fetch_files(const std::string& id) {
  const absl::StatusOr<bool> was_closed = is_closed(id, store_.ending());
  if (!was_closed.ok()) return was_closed.status();
  if (*was_closed) return absl::NotFoundError("it was closed");
  const std::string curve = folder_.curve_path(id), surface = folder_.surface_path(id);
  if (absl::Status there = store_.size(name_of(curve), store_.ending()).status(); !there.ok()) return there;
  const std::array<std::string, 4> paths = {surface, folder_.ranks_path(id), folder_.refined_path(id), curve};
  const absl::Cleanup clean_up = [&] {
    for (const std::string& path : paths) remove_path(path + kFetched);
  };
  std::array<std::future<absl::Status>, 4> gets;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    gets[i] = std::async(std::launch::async, [this, path = paths[i]] { return fetch_file(path); });
  }
  absl::Status status;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const bool is_needed = paths[i] == surface || paths[i] == curve;
    const absl::Status got = gets[i].get();
    status.Update(is_needed ? got : or_not_found(got));
  }
  // Every byte, now: what is found wrong with it later is the folder's fault.
  if (status.ok()) status = check_surface_file(surface + kFetched);
  if (absl::IsDataLoss(status) || absl::IsFailedPrecondition(status)) {
    log_->warn("store: session {}: {}; removed", id, std::string(status.message()));
    remove_damaged(id);
    return absl::NotFoundError("what the store had was damaged");
  }
  if (!status.ok()) return status;
  for (const std::string& path : paths) {
    if (!is_file(path + kFetched)) continue;
    if (absl::Status renamed = rename_file(path + kFetched, path); !renamed.ok()) return renamed;
  }
  folder_.mark_stored(id, store_.url());
  folder_.remove_mark(id);
  return absl::OkStatus();
}

absl::Status SharedSessions::fetch_file(const std::string& path) const {
  const absl::StatusOr<std::uint64_t> size = store_.size(name_of(path), store_.ending());
  if (!size.ok()) return size.status();
  if (*size > max_bytes_) return absl::NotFoundError("it is larger than the cache may be");
  return store_.get(name_of(path), path + kFetched, store_.ending());
}

absl::StatusOr<bool> SharedSessions::is_closed(const std::string& id, const std::atomic<bool>* cancel) {
  const absl::Status mark = store_.size(closed_name(id), cancel).status();
  if (!mark.ok() && !absl::IsNotFound(mark)) return mark;
  bool is_wanted = false;
  {
    const MutexLock lock(mutex_);
    is_wanted = reopened_.contains(id);
  }
  if (mark.ok() && is_wanted) {
    if (absl::Status removed = store_.remove(closed_name(id), cancel); !removed.ok()) return removed;
  }
  // From now on it counts if somebody closes it.
  const MutexLock lock(mutex_);
  reopened_.erase(id);
  return mark.ok() && !is_wanted;
}

void SharedSessions::forget_closed(const std::string& id) {
  const MutexLock lock(mutex_);
  curves_known_.erase(id);
  if (reopened_.contains(id)) return;  // meanwhile
  folder_.mark_closed(id);
  folder_.remove_files(id);
}

absl::Status SharedSessions::check_open(const std::string& id, const std::atomic<bool>* cancel) {
  const absl::StatusOr<bool> was_closed = is_closed(id, cancel);
  if (!was_closed.ok()) return was_closed.status();
  if (!*was_closed) return absl::OkStatus();
  forget_closed(id);
  return absl::CancelledError("it was closed");
}

absl::Status SharedSessions::put_files(const std::string& id, const std::atomic<bool>& cancel) {
  if (!is_file(folder_.curve_path(id))) return absl::CancelledError("it is not in the cache any more");
  if (absl::Status open = check_open(id, &cancel); !open.ok()) return open;
  // The curve's comes after those without which it is of no use.
  absl::Status status = put_if_other(folder_.surface_path(id), cancel);
  if (status.ok() && is_file(folder_.ranks_path(id))) status = put_if_other(folder_.ranks_path(id), cancel);
  if (status.ok()) status = put_curve(id, cancel);
  if (status.ok()) status = put_refined(id, cancel);
  if (!status.ok()) return status;
  if (absl::Status open = check_open(id, &cancel); !open.ok()) {
    if (absl::IsCancelled(open)) remove_files(id).IgnoreError();  // who closed it may have been before us
    return open;
  }
  folder_.mark_stored(id, store_.url());
  log_->info("session {} is in the store", id);
  return absl::OkStatus();
}

absl::Status SharedSessions::put_if_other(const std::string& path, const std::atomic<bool>& cancel) const {
  const absl::StatusOr<std::uint64_t> size = store_.size(name_of(path), &cancel);
  if (size.ok() && *size == size_of(path)) return absl::OkStatus();  // the same, whoever made it
  if (!size.ok() && !absl::IsNotFound(size.status())) return size.status();
  return store_.put(name_of(path), path, &cancel);
}

absl::Status SharedSessions::put_curve(const std::string& id, const std::atomic<bool>& cancel) {
  bool is_known = false;
  {
    const MutexLock lock(mutex_);
    is_known = curves_known_.contains(id);
  }
  // To see whose it is in the store takes all of it: once, not after each refinement.
  const absl::Status status = is_known ? put_if_other(folder_.curve_path(id), cancel) : put_curve_or_take(id, cancel);
  const MutexLock lock(mutex_);
  if (status.ok()) know_curve(id);
  return status;
}

void SharedSessions::know_curve(const std::string& id) {
  if (curves_known_.size() >= kMostKnown) curves_known_.clear();
  curves_known_.insert(id);
}

absl::Status SharedSessions::put_curve_or_take(const std::string& id, const std::atomic<bool>& cancel) const {
  const std::string path = folder_.curve_path(id), other = path + kFetched;
  const absl::Cleanup clean_up = [&] { remove_path(other); };
  const absl::Status got = store_.get(name_of(path), other, &cancel);
  if (!got.ok() && !absl::IsNotFound(got) && !absl::IsDataLoss(got)) return got;
  if (got.ok() && load_curve(other).ok()) {
    const absl::StatusOr<std::string> owner = owner_in(other, id), ours = owner_in(path, id);
    // Another server was first: the session is whose it is there.
    if (owner.ok()) return ours.ok() && *owner == *ours ? absl::OkStatus() : rename_file(other, path);
  }
  return store_.put(name_of(path), path, &cancel);
}

absl::Status SharedSessions::put_refined(const std::string& id, const std::atomic<bool>& cancel) const {
  const std::string path = folder_.refined_path(id);
  if (!is_file(path)) return absl::OkStatus();
  const absl::StatusOr<std::uint64_t> size = store_.size(name_of(path), &cancel);
  if (!size.ok() && !absl::IsNotFound(size.status())) return size.status();
  if (size.ok() && *size >= size_of(path)) return absl::OkStatus();  // the greater curve stays
  return store_.put(name_of(path), path, &cancel);
}

void SharedSessions::reopen(const std::string& id) {
  const MutexLock lock(mutex_);
  curves_known_.erase(id);
  reopened_.insert(id);
}

absl::Status SharedSessions::close(const std::string& id) {
  {
    const MutexLock lock(mutex_);
    reopened_.erase(id);
    curves_known_.erase(id);
  }
  const std::string empty = absl::StrCat(folder_.path(), "/", kEmpty);
  std::ofstream(empty, std::ios::trunc);
  if (absl::Status marked = store_.put(closed_name(id), empty, store_.ending()); !marked.ok()) {
    return absl::UnavailableError(absl::StrCat("session ", id, " cannot be closed now: ", marked.message()));
  }
  puts_.withdraw(id);
  puts_.wait_until_undone(id);
  if (absl::Status removed = remove_files(id); !removed.ok()) {
    log_->warn("store: files of session {}, which was closed, are left: {}", id, std::string(removed.message()));
  }
  return absl::OkStatus();
}

absl::Status SharedSessions::remove_files(const std::string& id) const {
  absl::Status status;
  for (const std::string& path : folder_.paths(id)) status.Update(store_.remove(name_of(path), store_.ending()));
  return status;
}

void SharedSessions::remove_damaged(const std::string& id) const { remove_files(id).IgnoreError(); }

void SharedSessions::remove_file(const std::string& path) const { store_.remove(name_of(path), store_.ending()).IgnoreError(); }

void SharedSessions::watch(const std::vector<std::string>& ids, Clock::duration interval) {
  const MutexLock lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (looked_.size() > kMostKnown) looked_.clear();
  for (const std::string& id : ids) {
    const auto [looked, is_new] = looked_.try_emplace(id, now);
    if (!is_new && now - looked->second < interval) continue;
    looked->second = now;
    to_look_.push_back(id);
  }
  changed_.notify_all();
}

void SharedSessions::look_for_closed() {
  const MutexLock lock(mutex_);
  while (!is_stopping_) {
    if (to_look_.empty()) {
      changed_.wait(mutex_);
      continue;
    }
    const std::string id = std::move(to_look_.front());
    to_look_.pop_front();
    const bool is_wanted = reopened_.contains(id);  // its mark is taken away by who puts it
    mutex_.unlock();
    if (!is_wanted && store_.size(closed_name(id), store_.ending()).ok()) forget_closed(id);
    mutex_.lock();
  }
}

}  // namespace curvecast::server
