// The files of sessions in a store that servers share, behind the folder in which this one has them.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/retry_queue.h"
#include "server/session/cache_folder.h"
#include "server/store/watched_store.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. A session that was closed has an empty file "sessions/ID.closed" in the store instead of its own: no server puts
/// it back that has it still, and all that use it forget it within seconds.
class SharedSessions {
 public:
  using Clock = std::chrono::steady_clock;

  /// Store and folder must outlive this. What is in the folder and not in the store is put there. Files of more than `max_bytes`
  /// are not taken from the store.
  SharedSessions(WatchedStore& store, const CacheFolder& folder, std::uint64_t max_bytes, std::shared_ptr<spdlog::logger> log);
  ~SharedSessions();  // stop()

  /// Has what is in the folder of a session put into the store in the background, again and again until that succeeds. To be
  /// called after each change: before it the session had better be CacheFolder::unmark_stored().
  void put(const std::string& id);
  /// How many sessions wait for that, or are being put.
  std::size_t unstored() const { return puts_.size(); }
  std::vector<std::string> unstored_ids() const { return puts_.ids(); }
  /// Whether the session's files are in the store, as they are in the folder.
  bool is_stored(const std::string& id) const { return folder_.is_stored(id, store_.url()) && !puts_.has(id); }

  /// Whether fetch() may bring a session: not where it has failed to within the last second.
  bool may_have(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Why fetch() has failed lately; NotFound where it has not.
  absl::Status why_missing(const std::string& id) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Gets a session's files into the folder, where its curve is not there. They are whole and on the surface's every byte as they
  /// were written; the rest is checked by who loads them. NotFound where the store has none or it was closed; ResourceExhausted:
  /// the folder's disk is full; Unavailable. Waits for the store.
  absl::Status fetch(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Whether a session has been fetched since this was last asked, or since the start: what is wrong with its files then is wrong
  /// in the store.
  bool take_fresh(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Somebody asks for a session anew: that it was closed before does not count.
  void reopen(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Marks a session as closed and removes its files from the store. Unavailable, and nothing has changed, where that cannot be.
  absl::Status close(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Removes a session's files, which are damaged, from the store.
  void remove_damaged(const std::string& id) const;
  /// Removes one file, by its path in the folder.
  void remove_file(const std::string& path) const;
  /// Has the store asked soon whether another server has closed these sessions, where it was last asked that so long ago: they
  /// are marked as closed in the folder then, and go from there.
  void watch(const std::vector<std::string>& ids, Clock::duration interval) ABSL_LOCKS_EXCLUDED(mutex_);

  /// Tries each put once more, and ends the threads.
  void stop() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Miss {
    absl::Status status;
    Clock::time_point until;
  };

  absl::Status fetch_files(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Gets one file beside the one that it is to become; NotFound where there is none.
  absl::Status fetch_file(const std::string& path) const;
  absl::Status put_files(const std::string& id, const std::atomic<bool>& cancel) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Puts a file unless the store has one of that size.
  absl::Status put_if_other(const std::string& path, const std::atomic<bool>& cancel) const;
  absl::Status put_curve(const std::string& id, const std::atomic<bool>& cancel) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Puts it, or takes the store's where another server was first and the session is somebody else's there.
  absl::Status put_curve_or_take(const std::string& id, const std::atomic<bool>& cancel) const;
  void know_curve(const std::string& id) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status put_refined(const std::string& id, const std::atomic<bool>& cancel) const;
  /// OK, or Cancelled where the session was closed by any server after it was asked for; then it is from the folder, too.
  absl::Status check_open(const std::string& id, const std::atomic<bool>* cancel) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Returns whether the store says that it was closed. Takes that away where it is wanted anew.
  absl::StatusOr<bool> is_closed(const std::string& id, const std::atomic<bool>* cancel) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status remove_files(const std::string& id) const;
  /// Takes a session from the folder, and marks it as closed there, unless somebody has asked for it anew.
  void forget_closed(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  void note_tried(const std::string& id, const absl::Status& status);
  void look_for_closed() ABSL_LOCKS_EXCLUDED(mutex_);

  WatchedStore& store_;
  const CacheFolder& folder_;
  const std::uint64_t max_bytes_;
  const std::shared_ptr<spdlog::logger> log_;
  std::atomic<bool> failing_ = false;  // the last put failed, and the log says so
  mutable Mutex mutex_;
  CondVar changed_;
  std::set<std::string> fetching_ ABSL_GUARDED_BY(mutex_);
  std::set<std::string> fresh_ ABSL_GUARDED_BY(mutex_);  // fetched, and not loaded yet
  /// Whose curve was got, put, or compared with the store's, since the start.
  std::set<std::string> curves_known_ ABSL_GUARDED_BY(mutex_);
  std::map<std::string, Miss> misses_ ABSL_GUARDED_BY(mutex_);
  std::set<std::string> reopened_ ABSL_GUARDED_BY(mutex_);                   // asked for anew, and the store does not know yet
  std::map<std::string, Clock::time_point> looked_ ABSL_GUARDED_BY(mutex_);  // when, for being closed
  std::deque<std::string> to_look_ ABSL_GUARDED_BY(mutex_);
  bool is_stopping_ ABSL_GUARDED_BY(mutex_) = false;
  RetryQueue puts_;
  Mutex join_mutex_;
  std::thread looking_ ABSL_GUARDED_BY(join_mutex_);  // last: it uses the others
};

}  // namespace curvecast::server
