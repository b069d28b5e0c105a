// The jobs that make sessions: each is loaded from the cache or, where that is not possible, preprocessed.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "core/base/memory_claim.h"
#include "core/base/mutex.h"
#include "server/base/job_queue.h"
#include "server/session/making_marks.h"
#include "server/session/mesh_files.h"
#include "server/session/session.h"
#include "server/session/session_cache.h"
#include "server/session/session_waiters.h"

namespace curvecast::server {

/// Held by shared_ptr: a job that was cancelled may go on for a while.
struct SessionJob {
  std::string id;      // of the session
  std::string owner;   // of the session
  std::string caller;  // whose share of the workers it takes
  PreprocessOptions options;
  MeshFiles files;
  const std::chrono::steady_clock::time_point created = std::chrono::steady_clock::now();
  SessionWaiters waiters = {};
  std::atomic<bool> cancel = false;     // set by SessionJobs::cancel()
  std::atomic<bool> has_begun = false;  // to preprocess
  std::atomic<bool> is_made = true;     // rather than loaded, as far as is known
  /// Refuses to make what was to be loaded; may be empty. Called without locks.
  std::function<absl::Status()> may_make = {};
  std::atomic<bool> is_loaded = false;  // from the cache; set before the session is handed over
};

/// Thread-safe.
class SessionJobs {
 public:
  /// The signature of curvecast::preprocess.
  using Preprocess = std::function<absl::StatusOr<Preprocessed>(const MeshFile&, const PreprocessOptions&,
                                                                const ExecutionContext&, const OnPreview&)>;
  /// Where a job asks for memory, until its session is in the store; `cancel`, which outlives it, ends waiting.
  using GetMemory = std::function<std::unique_ptr<MemorySource>(const std::atomic<bool>* cancel)>;
  /// Called without locks by the thread of a job that has a stand-in.
  using OnStandIn = std::function<void(const std::shared_ptr<SessionJob>& job, std::shared_ptr<const Session> preview)>;
  /// Called without locks by the thread of a job that is over and was not cancelled before that.
  using OnOver =
      std::function<void(const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> session)>;

  /// Preprocesses on `queue`, with `threads` threads (0 = one per core), and loads on the cache's thread. Both queue and cache
  /// must outlive this, and `marks`, of the sessions that it preprocesses; `cache` and `marks` may be null, `get_memory` empty.
  SessionJobs(JobQueue& queue, Preprocess preprocess, int threads, SessionCache* cache, MakingMarks* marks, GetMemory get_memory,
              OnStandIn on_stand_in, OnOver on_over);
  /// Waits until the jobs are over. Precondition: all have been cancelled.
  ~SessionJobs();

  /// Starts a job, and from now on tells its waiters how far it is. Errors as of JobQueue::submit().
  absl::Status start(const std::shared_ptr<SessionJob>& job) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Ends a job before its time; one that waits never runs.
  void cancel(SessionJob& job) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  /// Where a job runs or waits.
  struct Place {
    JobQueue* queue;
    std::uint64_t ticket;
  };

  absl::Status submit_load(const std::shared_ptr<SessionJob>& job) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status submit_preprocessing(const std::shared_ptr<SessionJob>& job) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void load(const std::shared_ptr<SessionJob>& job);
  void preprocess(const std::shared_ptr<SessionJob>& job);
  absl::StatusOr<std::shared_ptr<const Session>> make(const std::shared_ptr<SessionJob>& job, MemorySource* memory);
  /// Submits for preprocessing what could not be loaded. Cancelled where the job was, else errors as of JobQueue::submit() and
  /// SessionJob::may_make.
  absl::Status fall_back(const std::shared_ptr<SessionJob>& job) ABSL_LOCKS_EXCLUDED(mutex_);
  void finish(const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> session)
      ABSL_LOCKS_EXCLUDED(mutex_);

  JobQueue& queue_;
  const Preprocess preprocess_;
  const int threads_;
  SessionCache* const cache_;  // may be null
  MakingMarks* const marks_;   // may be null
  const GetMemory get_memory_;
  const OnStandIn on_stand_in_;
  const OnOver on_over_;
  Mutex mutex_;
  CondVar idle_;
  std::map<const SessionJob*, Place> places_ ABSL_GUARDED_BY(mutex_);  // of the jobs that are not over
};

}  // namespace curvecast::server
