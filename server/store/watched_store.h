// A store whose calls are counted, and which is left in peace for a while when it is away.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "core/base/mutex.h"
#include "server/store/store.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. After a call that was Unavailable others are at once, with the same words, until a thread of its own has found
/// the store answering again: where it hangs, few have to wait for that.
class WatchedStore final : public Store {
 public:
  using Clock = std::chrono::steady_clock;
  /// A call that was made: "put", "get", "size" or "remove"; "ok", "not_found", "cancelled" or "error"; and how long it took.
  using OnCall = std::function<void(std::string_view operation, std::string_view result, double seconds)>;

  /// `url`: what it was opened with. It is asked again after `first_pause`, then after twice as long each time, but never more
  /// than `longest_pause`.
  WatchedStore(std::string url, std::unique_ptr<Store> store, std::shared_ptr<spdlog::logger> log,
               Clock::duration first_pause = std::chrono::milliseconds(100),
               Clock::duration longest_pause = std::chrono::seconds(2));
  ~WatchedStore() override;

  const std::string& url() const { return url_; }
  /// To be given as `cancel` by those who need not go on with their calls once the server ends: end() sets it.
  const std::atomic<bool>* ending() const { return &is_ending_; }
  void end() { is_ending_ = true; }
  /// Who is told of calls from now on; empty: nobody. Returns when nobody else is told any more.
  void observe(OnCall on_call) ABSL_LOCKS_EXCLUDED(observer_mutex_);
  /// OK, or the words with which calls are Unavailable now.
  absl::Status state() const ABSL_LOCKS_EXCLUDED(mutex_);

  absl::Status put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override;
  absl::Status get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) override;
  absl::StatusOr<std::uint64_t> size(const std::string& name, const std::atomic<bool>* cancel) override;
  absl::Status remove(const std::string& name, const std::atomic<bool>* cancel) override;

 private:
  template <typename Call>
  auto watch(std::string_view operation, const Call& call) -> decltype(call());
  void count(std::string_view operation, const absl::Status& status, double seconds) ABSL_LOCKS_EXCLUDED(mutex_, observer_mutex_);
  void ask_again() ABSL_LOCKS_EXCLUDED(mutex_);

  const std::string url_;
  const std::unique_ptr<Store> store_;
  const std::shared_ptr<spdlog::logger> log_;
  const Clock::duration first_pause_, longest_pause_;
  Mutex observer_mutex_;
  OnCall on_call_ ABSL_GUARDED_BY(observer_mutex_);
  mutable Mutex mutex_;
  CondVar changed_;
  absl::Status away_ ABSL_GUARDED_BY(mutex_);  // OK: it is there
  std::atomic<bool> is_ending_ = false;
  bool is_over_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread asking_;  // last: it uses the others
};

}  // namespace curvecast::server
