// Sessions that survive the server, in a folder: see CacheFolder.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"
#include "server/base/retry_queue.h"
#include "server/session/cache_folder.h"
#include "server/session/session.h"
#include "server/session/shared_sessions.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. Several processes may share a folder: files appear and go whole, and nobody touches what another one is writing.
/// Files of other versions of the format have other names, and those of other versions of the algorithm belong to other sessions:
/// they are left alone until they are the least recently used. Behind it there may be a store that servers share, where each has
/// a folder of its own.
class SessionCache {
 public:
  /// Makes the folder if it is missing (mode 0700) and removes what killed processes left half-written. FailedPrecondition when
  /// the folder cannot be used. `store`, which may be null, must outlive it: sessions are put there when they are saved, and got
  /// from there where the folder has none.
  static absl::StatusOr<std::unique_ptr<SessionCache>> open(const std::string& folder, std::uint64_t max_bytes,
                                                            std::shared_ptr<spdlog::logger> log, WatchedStore* store = nullptr);
  ~SessionCache();  // stop()

  /// Saves the session in the background, replacing what was saved of it before; then its surface is taken from the file, and
  /// what it took in memory is free. When it cannot, because the disk is full, say, the log says so (once until it works again),
  /// and it is tried again after seconds, until it is saved or removed. What alone is too large for the cache is just not cached.
  void save(const Session& session);
  /// Saves the candidates that were made for views, where a good part of them is new, so that whoever loads the session goes on
  /// from there. In the background, and once: where that fails they are made again when they are needed.
  void save_candidates(const Session& session);
  /// Whether a session waits to be saved, or is being saved.
  bool is_unsaved(const std::string& id) const { return saves_.has(id); }
  /// Which do.
  std::vector<std::string> unsaved_ids() const { return saves_.ids(); }
  /// How many do.
  std::size_t unsaved() const { return saves_.size(); }
  /// A session has had to leave the memory: where a try to save it has failed, it is given up.
  void let_go(const std::string& id) { saves_.let_go(id); }
  /// Whether there is a file from which a session can be loaded, unless it turns out to be damaged. Takes microseconds.
  bool holds(const std::string& id) const;
  /// Whether a session that the folder has not may be in the store; see SharedSessions::may_have(). Takes microseconds.
  bool may_fetch(const std::string& id) const { return shared_ != nullptr && shared_->may_have(id); }
  /// Has a session's files in the folder, where the store has them. Errors as of SharedSessions::fetch().
  absl::Status fetch(const std::string& id);
  /// Whether there is a store.
  bool is_shared() const { return shared_ != nullptr; }
  /// Whether a session would survive this server: it is saved and, where there is a store, in that.
  bool is_safe(const std::string& id) const { return holds(id) && (shared_ == nullptr || shared_->is_stored(id)); }
  /// Why there is no session: see SharedSessions::why_missing().
  absl::Status why_missing(const std::string& id) const;
  /// Loads a session, from the store where the folder has none. NotFound when there is none; DataLoss, FailedPrecondition and so
  /// on for files that cannot be used: the log says why, and they are removed. Other errors as of fetch().
  absl::StatusOr<std::shared_ptr<const Session>> load(const std::string& id);
  /// Opens the surface on which a session's curve lies, see open_surface(). Errors as of load(). Where a chart turns out to be
  /// damaged later, the session's files are removed.
  absl::StatusOr<std::shared_ptr<const CurveBase>> open_surface(const std::string& id);
  /// Who had a session made first, as its file says, which is got from the store where need be. NotFound when there is none that
  /// can be used; other errors where nobody can tell now.
  absl::StatusOr<std::string> owner(const std::string& id);
  /// Counts a session as used now: the least recently used go first when there is no room.
  void touch(const std::string& id) const { touch_file(folder_.curve_path(id)); }
  /// Has sessions looked after that are in memory: see SharedSessions::watch().
  void watch(const std::vector<std::string>& ids, std::chrono::steady_clock::duration interval) const;
  /// Closes a session for all servers that share the store: before remove(). Unavailable where that cannot be now.
  absl::Status close_for_all(const std::string& id) const;
  /// Removes a session's files, also those still to be saved, and marks it as closed for a day: no server that has it in memory
  /// writes it back. False when there were none.
  bool remove(const std::string& id);
  /// Removes the files of a session that turned out to be damaged while it was in use; it may be made anew.
  void remove_damaged(const std::string& id);
  /// Waits until a save is over that was under way when the session was removed: only then all its files are gone.
  void wait_until_removed(const std::string& id) { saves_.wait_until_undone(id); }
  /// Whether some server has removed the session, and nobody has asked for it since.
  bool is_closed(const std::string& id) const { return folder_.is_closed(id); }
  /// Lets a session be saved that was removed before: somebody asks for it anew.
  void reopen(const std::string& id) const;

  /// Bytes of all files of sessions in the folder, whichever process wrote them, as they were when somebody last looked.
  std::uint64_t used_bytes() const { return used_bytes_; }
  /// Looks at each, if the last look is some seconds ago.
  void refresh_used_bytes(std::chrono::steady_clock::time_point now) ABSL_LOCKS_EXCLUDED(look_mutex_);
  /// How often each operation ended so: "load", "save", "remove"; "ok", "error".
  std::map<std::pair<std::string, std::string>, std::uint64_t> operations() const;

  const std::string& folder() const { return folder_.path(); }
  /// How many sessions wait to be put into the store, or are being put.
  std::size_t unstored() const { return shared_ != nullptr ? shared_->unstored() : 0; }
  /// Which do.
  std::vector<std::string> unstored_ids() const;
  /// The queue on which those load a session who must not wait. Apart from the one that saves, which waits for the disk; what the
  /// folder has does not wait for the store.
  JobQueue& loading(const std::string& id) { return shared_ == nullptr || holds(id) ? loading_ : *fetching_; }
  /// The queue of what waits for the store. Precondition: is_shared().
  JobQueue& fetching() { return *fetching_; }
  /// Finishes the loads that have been accepted, tries each save once more, and refuses later ones.
  void stop();

 private:
  struct Count {
    std::atomic<std::uint64_t> ok = 0, error = 0;
    void add(bool is_ok) { ++(is_ok ? ok : error); }
  };

  SessionCache(std::string folder, std::uint64_t max_bytes, std::shared_ptr<spdlog::logger> log, WatchedStore* store);
  absl::StatusOr<std::shared_ptr<const Session>> load_here(const std::string& id);
  /// `is_fetched`: just now, so that what is wrong with a file is wrong in the store, too.
  absl::StatusOr<std::shared_ptr<const Session>> read(const std::string& id, bool is_fetched);
  /// Takes up the points that views show, as far as they are there. `surface`: the session's.
  void load_ranks(const Session& session, const CurveBase& surface, bool is_fetched);
  absl::Status write_candidates(const std::string& id, const RankTree& tree) const;
  /// Takes up the newest revision of a session's curve, if it is there.
  void load_refined(Session& session, const CurveBase& surface, bool is_fetched);
  void discard(const std::string& path, const absl::Status& reason, bool is_fetched = false) const;
  void discard_surface(const std::string& id, const absl::Status& reason) const;
  /// The surface in memory makes way for the file.
  void move_to_file(const Session& session);
  absl::Status write_and_move(const Session& session);
  /// Before a session's files change.
  void will_change(const std::string& id) const;
  absl::Status write(const Session& session) const;
  /// Cancelled where the session that is being saved has been removed meanwhile.
  absl::Status check_wanted(const std::string& id) const;
  void make_room();
  void note_saved(const std::string& id, const absl::Status& status, bool is_lost);
  void note_failure(const std::string& id, const std::string& reason, bool is_tried_again);

  const CacheFolder folder_;
  const std::uint64_t max_bytes_;
  const std::shared_ptr<spdlog::logger> log_;
  std::atomic<bool> failing_ = false;  // the last save failed, and the log says so
  std::atomic<std::uint64_t> used_bytes_ = 0;
  Mutex look_mutex_;
  std::chrono::steady_clock::time_point looked_at_ ABSL_GUARDED_BY(look_mutex_) = {};
  mutable Count loads_, saves_tried_;
  const std::unique_ptr<SharedSessions> shared_;  // null: no store
  JobQueue loading_;
  const std::unique_ptr<JobQueue> fetching_;  // null: no store
  JobQueue saving_candidates_;
  RetryQueue saves_;  // last: it and the other queues use all of the above
};

}  // namespace curvecast::server
