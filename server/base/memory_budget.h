// The memory of a server, asked for before it is taken.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "core/base/memory_claim.h"
#include "core/base/mutex.h"

namespace curvecast::server {

/// How a job takes memory.
struct MemoryTerms {
  bool waits = true;   // else what does not fit now is refused: it may use what waiting jobs leave, see MemoryBudget::Options
  bool keeps = false;  // what it gives back stays its own, to be taken again, until the job goes
};

/// Divides what there is between what is held (sessions, meshes, answers that wait), which others count, and what running jobs
/// have asked for. A job that would fit if only others were done waits for them. Thread-safe.
class MemoryBudget {
 public:
  struct Options {
    /// How many bytes there are, in memory and in the file of core/base/spill.h. Called without locks.
    std::function<std::uint64_t()> most;
    /// Counts what is held at this moment. Called without locks.
    std::function<std::uint64_t()> held;
    /// Frees as much as can be of what is held and not in use, of so many bytes. Called without locks.
    std::function<void(std::uint64_t bytes)> make_room;
    /// The part of `most` that jobs which wait leave to those which do not: a great session in the making must not have a view of
    /// some hundred kilobytes refused.
    double left_by_waiting = 0;
    std::chrono::milliseconds patience = std::chrono::seconds(60);  // how long a job waits for others
  };

  explicit MemoryBudget(Options options) : options_(std::move(options)) {}

  /// What one job takes. Its threads may ask side by side; the job must not go on without it. Gives all back when it goes.
  class Job final : public MemorySource {
   public:
    /// `cancel` ends waiting; may be null.
    Job(MemoryBudget& budget, const std::atomic<bool>* cancel, MemoryTerms terms = {})
        : budget_(budget), cancel_(cancel), terms_(terms) {}
    ~Job() override;

    absl::Status take(std::uint64_t bytes, const std::string& what) override;
    void give_back(std::uint64_t bytes) override;
    std::uint64_t most() const override { return budget_.most(terms_); }

   private:
    friend class MemoryBudget;
    MemoryBudget& budget_;
    const std::atomic<bool>* const cancel_;
    const MemoryTerms terms_;
    std::uint64_t taken_ ABSL_GUARDED_BY(budget_.mutex_) = 0;
    std::uint64_t spare_ ABSL_GUARDED_BY(budget_.mutex_) = 0;  // of that, given back and kept
  };

  /// Refuses what could never be taken, before anybody waits for it. Takes nothing.
  class Outlook final : public MemorySource {
   public:
    explicit Outlook(MemoryBudget& budget) : budget_(budget) {}

    absl::Status take(std::uint64_t bytes, const std::string& what) override;
    void give_back(std::uint64_t) override {}
    std::uint64_t most() const override { return budget_.most({}); }

   private:
    MemoryBudget& budget_;
  };

  std::uint64_t most() const { return options_.most(); }
  /// What jobs of such terms may take together, with what is held.
  std::uint64_t most(const MemoryTerms& terms) const;
  /// What running jobs have asked for.
  std::uint64_t reserved() const ABSL_LOCKS_EXCLUDED(mutex_);
  /// How often there was too little.
  std::uint64_t refused() const { return refused_; }

 private:
  /// The error of what is more than `most`.
  absl::Status refuse(const std::string& what, std::uint64_t most);
  void release(Job& job, std::uint64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  /// Whether the job would take more than there may ever be.
  bool exceeds(const Job& job, std::uint64_t bytes, std::uint64_t most) const ABSL_LOCKS_EXCLUDED(mutex_);
  /// Takes the bytes where they are there now. `held`: see Options.
  bool try_take(Job& job, std::uint64_t bytes, std::uint64_t most, std::uint64_t held) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Waits a while for others to give something back. False: none of them will, or the time is over. `looks_alone` counts how
  /// often none of them would.
  bool wait_for_others(const Job& job, std::chrono::steady_clock::time_point end, int& looks_alone) ABSL_LOCKS_EXCLUDED(mutex_);

  const Options options_;
  std::atomic<std::uint64_t> refused_ = 0;
  mutable Mutex mutex_;
  CondVar given_back_;
  std::uint64_t reserved_ ABSL_GUARDED_BY(mutex_) = 0;
  int active_ ABSL_GUARDED_BY(mutex_) = 0;   // jobs that have taken something
  int blocked_ ABSL_GUARDED_BY(mutex_) = 0;  // of them, those that wait for more
};

}  // namespace curvecast::server
