#include "server/store/bounded_calls.h"

#include <absl/strings/str_cat.h>

#include <optional>
#include <thread>
#include <utility>

#include "core/base/mutex.h"
#include "server/base/status_from_exceptions.h"

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kLook{10};  // how often who waits looks whether that is still worth while

/// Shared by the thread that works and the one that waits.
struct Call {
  CallProgress progress;
  Mutex mutex;
  CondVar done;
  std::optional<absl::Status> result ABSL_GUARDED_BY(mutex);
  bool is_stuck ABSL_GUARDED_BY(mutex) = false;  // it counts as that
};

}  // namespace

absl::Status BoundedCalls::run(Work work, const std::atomic<bool>* cancel) const {
  if (cancel != nullptr && *cancel) return absl::CancelledError("cancelled");
  if (*stuck_ >= most_stuck_) return absl::UnavailableError(absl::StrCat("it does not answer: ", most_stuck_, " calls hang"));
  const auto call = std::make_shared<Call>();
  auto run_to_end = [call, work = std::move(work), stuck = stuck_] {
    absl::Status result = status_from_exceptions([&] { return work(call->progress); });
    const MutexLock lock(call->mutex);
    if (call->is_stuck) --*stuck;
    call->result = std::move(result);
    call->done.notify_all();
  };
  if (absl::Status begun = status_from_exceptions([&] {
        std::thread(std::move(run_to_end)).detach();
        return absl::OkStatus();
      });
      !begun.ok()) {
    return absl::UnavailableError(begun.message());
  }
  const MutexLock lock(call->mutex);
  std::uint64_t steps = 0;
  Clock::time_point end = Clock::now() + patience_;
  while (!call->result) {
    call->done.wait_until(call->mutex, Clock::now() + kLook);
    if (call->result) break;
    const bool is_cancelled = cancel != nullptr && *cancel;
    if (const std::uint64_t now = call->progress.steps_; now != steps) {
      steps = now;
      end = Clock::now() + patience_;
    }
    if (!is_cancelled && Clock::now() < end) continue;
    call->progress.is_given_up_ = true;
    call->is_stuck = true;
    ++*stuck_;
    return is_cancelled ? absl::CancelledError("cancelled")
                        : absl::UnavailableError(absl::StrCat("it has not answered for ", patience_.count() / 1000.0, " s"));
  }
  return *std::move(call->result);
}

}  // namespace curvecast::server
