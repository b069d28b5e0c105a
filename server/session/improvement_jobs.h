// Jobs that improve sessions in the background: what several ask for is made together.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"
#include "server/session/session.h"

namespace curvecast::server {

/// What the clients of a session demand of it: of each client the newest demand, the oldest one first.
template <typename Demand>
class Demands {
 public:
  /// Replaces the client's earlier demand; `source` tells clients apart. Where there are too many, the oldest gives way.
  void add(std::uint64_t source, Demand demand) {
    if (const auto found = std::find(sources_.begin(), sources_.end(), source); found != sources_.end()) {
      erase(found - sources_.begin());
    }
    if (all_.size() == kMost) erase(0);
    sources_.push_back(source);
    all_.push_back(std::move(demand));
  }
  std::size_t size() const { return all_.size(); }
  auto begin() const { return all_.begin(); }
  auto end() const { return all_.end(); }

 private:
  static constexpr std::size_t kMost = 8;  // met together: each costs a pass over the curve or its candidates

  void erase(std::ptrdiff_t i) {
    sources_.erase(sources_.begin() + i);
    all_.erase(all_.begin() + i);
  }

  std::vector<std::uint64_t> sources_;  // of each demand
  std::vector<Demand> all_;
};

struct Improvement {
  bool is_better = false;
  bool is_last = false;  // the session cannot be improved further: what has been asked for meanwhile is dropped
};

/// Runs one thread of low priority. Each session has at most one job, which runs or waits; Demands<Demand> collects what is asked
/// for until the job takes it. Thread-safe.
template <class Demand>
class ImprovementJobs {
 public:
  struct Hooks {
    /// Improves the session, without threads of oneTBB's, which would run at the priority of views. `cancel` is set once the
    /// improvement is not wanted any more. Not called for a job that is cancelled before its turn.
    std::function<Improvement(const Session& session, const Demands<Demand>& demands, const std::atomic<bool>& cancel)> improve;
    /// Called without locks after each improvement, also where the session has not become better or the job was cancelled.
    std::function<void(const Session& session, bool is_better)> on_done;
    /// Called when a session gets a job and when it has none any more. Called with a lock held: must not call the jobs.
    std::function<void(const Session& session, bool has_job)> mark = [](const Session&, bool) {};
  };

  explicit ImprovementJobs(Hooks hooks) : hooks_(std::move(hooks)), queue_({.max_waiting = kMaxPending, .low_priority = true}) {}
  ~ImprovementJobs() { stop(); }

  /// Asks for an improvement, instead of what the client `source` asked for before. Returns whether on_done will be called after
  /// it: false when too many sessions wait for their turn, or after stop().
  bool request(const std::shared_ptr<const Session>& session, std::uint64_t source, Demand demand) ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    if (is_stopped_) return false;
    const Key key = session->revisions.get();
    const auto [at, is_new] = jobs_.try_emplace(key);
    if (is_new) {
      if (!queue_.submit([this, key] { run(key); }).ok()) {
        jobs_.erase(at);
        return false;
      }
      at->second.session = session;
      hooks_.mark(*session, true);
    }
    at->second.demands.add(source, std::move(demand));
    at->second.is_asked = true;
    return true;
  }
  /// Cancels the session's job, if there is one.
  void cancel(const Session& session) ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    if (const auto found = jobs_.find(session.revisions.get()); found != jobs_.end()) found->second.cancel = true;
  }
  /// Cancels all jobs and joins the thread; refuses what comes later.
  void stop() ABSL_LOCKS_EXCLUDED(mutex_) {
    {
      const MutexLock lock(mutex_);
      is_stopped_ = true;
      for (auto& [key, job] : jobs_) job.cancel = true;
    }
    queue_.stop();
  }

 private:
  // Sessions whose turn has not come. More are refused: they are asked for again with the next view.
  static constexpr std::size_t kMaxPending = 1024;

  using Key = const void*;  // tells sessions apart; copies of a session have the same
  struct Job {
    std::shared_ptr<const Session> session;
    Demands<Demand> demands = {};
    bool is_asked = false;  // for anything since the job took its demands
    std::atomic<bool> cancel = false;
  };

  void run(Key key) ABSL_LOCKS_EXCLUDED(mutex_) {
    bool is_last = false;
    while (!is_last) {
      MutexLock lock(mutex_);
      Job& job = jobs_.at(key);  // stays where it is until this thread erases it
      const std::shared_ptr<const Session> session = job.session;
      const Demands<Demand> demands = std::exchange(job.demands, {});
      const std::atomic<bool>& cancel = job.cancel;
      job.is_asked = false;
      lock.unlock();
      const Improvement made = cancel ? Improvement{} : hooks_.improve(*session, demands, cancel);
      lock.lock();
      is_last = made.is_last || cancel || !job.is_asked;
      if (is_last) {
        jobs_.erase(key);
        hooks_.mark(*session, false);
      }
      lock.unlock();
      hooks_.on_done(*session, made.is_better);
    }
  }

  const Hooks hooks_;
  Mutex mutex_;
  std::map<Key, Job> jobs_ ABSL_GUARDED_BY(mutex_);
  bool is_stopped_ ABSL_GUARDED_BY(mutex_) = false;
  JobQueue queue_;  // last: its jobs use the others
};

}  // namespace curvecast::server
