// All sessions, shared between clients: those who ask for the same one share it, and the job that makes it.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"
#include "server/session/eviction.h"
#include "server/session/maker.h"
#include "server/session/mesh_files.h"
#include "server/session/session.h"
#include "server/session/session_cache.h"
#include "server/session/session_jobs.h"
#include "server/session/session_table.h"
#include "server/session/session_waiters.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. Joins the table of sessions, the jobs that make them and their cache. `who`: the owner who asks. Where owners are
/// isolated, sessions of others are as if they were not there, but for those of kOperator; else `who` matters for changes only.
class SessionStore {
 public:
  using Preprocess = SessionJobs::Preprocess;
  using GetMemory = SessionJobs::GetMemory;

  /// Called without locks when a preview gives way to the real session, or to the reason why there is none.
  using OnReplaced = std::function<void(const Session& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real)>;

  /// Called without locks before a session is made: refuses what will never be.
  using MayMake = std::function<absl::Status(const MeshFiles& files, const PreprocessOptions& options)>;

  struct Options {
    SessionCache* cache = nullptr;  // where there is one, sessions are saved when they are ready, and loaded instead of made
    MakingMarks* marks = nullptr;   // of the sessions that are made; may be null. Both must outlive the store
    GetMemory memory = {};          // may be empty: there is enough
    OnReplaced on_replaced = {};    // may be empty
    MayMake may_make = {};          // may be empty
    bool isolate = false;           // owners are
  };

  /// Jobs run on `queue`, which must outlive the store, each with `threads` threads (0 = one per core).
  SessionStore(JobQueue& queue, Preprocess preprocess, const SessionLimits& limits, int threads,
               std::shared_ptr<spdlog::logger> log, Options options);
  ~SessionStore();  // cancels all preprocessing and waits until it has stopped. Waiters that are left are not called any more

  /// Joins the session for these files and options or starts to make it, and returns its id. From then on `waiter` is called,
  /// even before join() returns if the session is ready, until on_done or leave(). On an error it is never called:
  /// ResourceExhausted when there are too many sessions that are in use or being made, or being made for this caller, and what
  /// Options::may_make says. A session that is new belongs to its maker's owner: only he may change or close it; every client
  /// where that is empty. One that is in the cache, from whichever server, stays whose it was.
  absl::StatusOr<std::string> join(MeshFiles files, const PreprocessOptions& options, SessionWaiter* waiter,
                                   const Maker& maker = {});
  /// Stops waiting: `waiter` is not called any more. When the last one leaves, the job is cancelled, and the session vanishes.
  /// False when on_done has been called.
  bool leave(const std::string& id, SessionWaiter* waiter);

  /// Finds a ready session, or loads it if it is only in the cache, or in the store behind that: see must_load(). NotFound, or
  /// FailedPrecondition while it is being made; Unavailable where the store is away; ResourceExhausted as of join().
  absl::StatusOr<std::shared_ptr<const Session>> find(const std::string& id, const std::string& who = {});
  /// As find(), but finds the preview, if there is one, of a session that is being made.
  absl::StatusOr<std::shared_ptr<const Session>> find_for_views(const std::string& id, const std::string& who = {});
  /// Whether find() would read a file, or ask the store, which may take its time: for callers who must not wait.
  bool must_load(const std::string& id);
  /// Tells about a session in memory. NotFound, also where it is in the cache.
  absl::StatusOr<SessionInfo> info(const std::string& id, const std::string& who = {});
  /// Lists sessions in memory by id, at most `most` of those after the id `after`.
  std::vector<SessionInfo> list(const std::string& after = {}, std::size_t most = std::numeric_limits<std::size_t>::max(),
                                const std::string& who = {});
  /// Changes the settings that are given, and returns all of them. NotFound, FailedPrecondition while the session is being made,
  /// or PermissionDenied where another client than `who` owns it; ResourceExhausted where pinned sessions would take more than
  /// half of the limits.
  absl::StatusOr<SessionInfo> update(const std::string& id, std::optional<bool> pinned, std::optional<double> time_to_live,
                                     const std::string& who = {});
  /// OK, or DataLoss where the session turns out to be damaged: see Session::status(). Then it is taken from memory and cache,
  /// and who asks for it has it made anew. To be asked before an answer made of it is sent.
  absl::Status check(const Session& session) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Saves a session whose curve has become finer to the cache. Does nothing for one that has been closed or evicted, even if a
  /// new one for the same files and options has been made.
  void save(const Session& session);
  /// Removes a session from memory and cache, and for all servers that share a store; waiters get Aborted. NotFound when it is
  /// nowhere, PermissionDenied where another client than `who` owns it, Unavailable where the store is away. Reads and removes
  /// files, and waits for one that is being written.
  absl::Status close(const std::string& id, const std::string& who = {});
  /// Takes from memory the sessions that have not been used for their time to live, those that another server has closed, and
  /// those that are damaged; evicts some where those that have grown are too much together. Tells the cache which are in use. To
  /// be called now and then. Returns the ids of those whose time was over.
  std::vector<std::string> run_housekeeping(std::chrono::steady_clock::time_point now);
  std::uint64_t memory_bytes();  // of all sessions
  /// How many have had to leave the memory.
  std::uint64_t evicted() const { return evicted_; }
  /// Evicts idle sessions until they have freed so many bytes, or there are none left.
  void make_room(std::uint64_t bytes);

 private:
  /// Whether a session may be loaded that is not in memory.
  bool may_load(const std::string& id) const { return cache_ != nullptr && (cache_->holds(id) || cache_->may_fetch(id)); }
  /// Why a session is not there: NotFound, or Unavailable where nobody can tell.
  absl::Status missing(const std::string& id) const;
  /// Whether a job for what could not be loaded may make it.
  absl::Status may_make_after_all(SessionJob& job) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Starts to make a session that is not there.
  absl::StatusOr<std::shared_ptr<SessionJob>> start_job(const std::string& id, MeshFiles files, const PreprocessOptions& options,
                                                        SessionWaiter* waiter, const Maker& maker,
                                                        SessionTable::Sessions& evicted) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Whether what the job makes is still wanted: it was not cancelled, nor did somebody else load the session meanwhile.
  bool is_current(const SessionJob& job) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void take_in(const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> made)
      ABSL_LOCKS_EXCLUDED(mutex_);
  void take_in_preview(const std::shared_ptr<SessionJob>& job, std::shared_ptr<const Session> preview)
      ABSL_LOCKS_EXCLUDED(mutex_);
  /// Tells of a preview that is over, if there was one.
  void replace(const std::shared_ptr<const Session>& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real) const
      ABSL_LOCKS_EXCLUDED(mutex_);
  absl::StatusOr<std::shared_ptr<const Session>> find_here(const std::string& id, const std::string& who)
      ABSL_LOCKS_EXCLUDED(mutex_);
  absl::StatusOr<std::shared_ptr<const Session>> load(const std::string& id, const std::string& who)
      ABSL_LOCKS_EXCLUDED(load_mutex_, mutex_);
  bool may_see(const std::string& owner, const std::string& who) const;
  /// PermissionDenied where another client than `who` owns the session, NotFound where he may not see it; other errors where
  /// nobody can tell.
  absl::Status check_owner(const std::string& id, const std::string& who) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Takes a session from memory that another server has closed.
  void drop_closed(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Takes a session from memory and cache that turns out to be damaged.
  void drop_damaged(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// After sessions have had to go. Those that are not saved are lost.
  void note_evicted(const SessionTable::Sessions& evicted);

  /// Whether it is in memory, being made, or in the cache, or may be in the store behind that.
  bool is_there(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Whether it is in memory, being made, or in the cache. Precondition: there is one.
  bool is_here(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::shared_ptr<spdlog::logger> log_;
  SessionCache* const cache_;     // may be null
  const OnReplaced on_replaced_;  // may be empty
  const MayMake may_make_;        // may be empty
  const bool isolates_;
  std::atomic<std::uint64_t> evicted_ = 0;
  Mutex load_mutex_ ABSL_ACQUIRED_BEFORE(mutex_);  // find() loads one at a time, so that nothing is loaded twice
  Mutex mutex_;
  SessionTable table_ ABSL_GUARDED_BY(mutex_);
  std::chrono::steady_clock::time_point kept_house_ ABSL_GUARDED_BY(mutex_) = {};  // run_housekeeping() last
  SessionJobs jobs_;                                                               // last: they use the others
};

}  // namespace curvecast::server
