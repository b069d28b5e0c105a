// All sessions, shared between clients: one preprocessing job for each, whoever and how many wait for it.
#pragma once

#include <absl/status/statusor.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/base/job_queue.h"
#include "server/session/eviction.h"
#include "server/session/mesh_files.h"
#include "server/session/session.h"
#include "server/session/session_cache.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Someone who waits for a session. Called with the store's lock held, from any thread: must not call the store.
class SessionWaiter {
 public:
  virtual ~SessionWaiter() = default;
  /// The start and the end of every stage and, about 20 times a second, what lies between.
  virtual void on_progress(std::string_view stage, double fraction) = 0;
  /// The last call: the session is ready, or why it never will be.
  virtual void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) = 0;
};

/// Thread-safe.
class SessionStore {
 public:
  /// The signature of curvecast::preprocess.
  using Preprocess =
      std::function<absl::StatusOr<Preprocessed>(const MeshFile&, const PreprocessOptions&, const ExecutionContext&)>;

  /// Jobs run on `queue`, which must outlive the store, each with `threads` threads (0 = one per core). With a cache, which must
  /// outlive the store too, sessions are saved when they become ready, and loaded instead of made.
  SessionStore(JobQueue& queue, Preprocess preprocess, const SessionLimits& limits, int threads,
               std::shared_ptr<spdlog::logger> log, SessionCache* cache = nullptr);
  ~SessionStore();  // cancels all preprocessing and waits until it has stopped; nobody may wait for a session any more

  /// Joins the session for these files and options or starts to make it, and returns its id. From then on `waiter` is called, if
  /// the session is ready even before join() returns, until on_done or leave(). On an error it is never called:
  /// ResourceExhausted when there are too many sessions that are in use or being made. Where it is new, only `owner` may change
  /// or close it; everybody where that is empty.
  absl::StatusOr<std::string> join(MeshFiles files, const PreprocessOptions& options, SessionWaiter* waiter,
                                   const std::string& owner = {});
  /// Stops waiting; the last one to leave cancels the job, and the session vanishes. False when on_done has been called.
  bool leave(const std::string& id, SessionWaiter* waiter);

  /// A ready session, loaded if it is only in the cache: see must_load(). NotFound, or FailedPrecondition while it is being made;
  /// ResourceExhausted as of join().
  absl::StatusOr<std::shared_ptr<const Session>> find(const std::string& id);
  /// Whether find() would read a file, which may take its time: for callers who must not wait.
  bool must_load(const std::string& id);
  /// Of sessions in memory only.
  absl::StatusOr<SessionInfo> info(const std::string& id);
  /// By id, at most `most` of those after one with this id.
  std::vector<SessionInfo> list(const std::string& after = {}, std::size_t most = std::numeric_limits<std::size_t>::max());
  /// Changes what is set, and tells what became of it. NotFound, FailedPrecondition while it is being made, or PermissionDenied
  /// where it is somebody else's; ResourceExhausted where pinned sessions would take more than half of the limits.
  absl::StatusOr<SessionInfo> update(const std::string& id, std::optional<bool> pinned, std::optional<double> time_to_live,
                                     const std::string& who = {});
  /// Saves a session whose curve has become finer; not one that has been closed or evicted, not even if it has been made anew.
  void save(const Session& session);
  /// Forgets a session, in memory and cache; those who wait for it get Aborted. NotFound when it is in neither, PermissionDenied
  /// where it is somebody else's.
  absl::Status close(const std::string& id, const std::string& who = {});
  /// To be called now and then: closes sessions that nobody has used for their time to live, and evicts some where those that
  /// have grown are too much together. Returns those that were closed.
  std::vector<std::string> tend(std::chrono::steady_clock::time_point now);
  std::uint64_t memory_bytes();  // of all sessions

 private:
  struct Job;
  struct Entry {
    SessionInfo info;
    std::shared_ptr<Job> job;  // until ready
    std::string owner;         // who had it made; empty: nobody in particular
    std::uint64_t last_used = 0;
    std::chrono::steady_clock::time_point used_at = std::chrono::steady_clock::now();

    bool may_change(const std::string& who) const { return owner.empty() || owner == who; }
    bool is_idle() const { return job == nullptr && info.session.use_count() == 1; }
  };
  using Entries = std::map<std::string, Entry>;
  // Curves take their time to go: they outlive the lock.
  using Evicted = std::vector<std::shared_ptr<const Session>>;

  void touch(Entry& entry);
  bool evict(const SessionLimits& limits, Evicted& evicted);
  /// With the lock.
  absl::Status may_pin(const Session& session) const;
  absl::Status make_room(Evicted& evicted);
  absl::StatusOr<std::shared_ptr<const Session>> find_here(const std::string& id);
  absl::StatusOr<std::shared_ptr<const Session>> load(const std::string& id);
  absl::Status submit(const std::shared_ptr<Job>& job);
  void run(const std::shared_ptr<Job>& job);
  void run_load(const std::shared_ptr<Job>& job);
  static std::shared_ptr<const Session> make_session(const Job& job, Preprocessed preprocessed);
  void settle(Job& job, absl::StatusOr<std::shared_ptr<const Session>> result);
  void report(Job& job, std::string_view stage, double fraction);
  void broadcast(Job& job, std::string_view stage, double fraction);
  void abandon(Job& job);

  JobQueue& queue_;
  const Preprocess preprocess_;
  const SessionLimits limits_;
  const int threads_;
  const std::shared_ptr<spdlog::logger> log_;
  SessionCache* const cache_;  // may be null
  std::mutex load_mutex_;      // find() loads one at a time, so that nothing is loaded twice; taken before mutex_
  std::mutex mutex_;
  std::condition_variable idle_;
  std::size_t jobs_ = 0;  // accepted by the queue and not yet over or withdrawn
  Entries entries_;
  std::uint64_t clock_ = 0;  // counts uses
};

}  // namespace curvecast::server
