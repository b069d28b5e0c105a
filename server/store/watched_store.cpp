#include "server/store/watched_store.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <utility>

#include "core/base/stopwatch.h"

namespace curvecast::server {
namespace {

constexpr char kProbe[] = "probe";  // no file of that name is ever there

std::string_view result_of(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return "ok";
    case absl::StatusCode::kNotFound:
      return "not_found";
    case absl::StatusCode::kCancelled:
      return "cancelled";
    default:
      return "error";
  }
}

const absl::Status& status_of(const absl::Status& status) { return status; }
template <typename T>
const absl::Status& status_of(const absl::StatusOr<T>& result) {
  return result.status();
}

}  // namespace

WatchedStore::WatchedStore(std::string url, std::unique_ptr<Store> store, std::shared_ptr<spdlog::logger> log,
                           Clock::duration first_pause, Clock::duration longest_pause)
    : url_(std::move(url)),
      store_(std::move(store)),
      log_(std::move(log)),
      first_pause_(first_pause),
      longest_pause_(longest_pause),
      asking_([this] { ask_again(); }) {}

WatchedStore::~WatchedStore() {
  end();
  {
    const MutexLock lock(mutex_);
    is_over_ = true;
    changed_.notify_all();
  }
  asking_.join();
}

void WatchedStore::observe(OnCall on_call) {
  const MutexLock lock(observer_mutex_);
  on_call_ = std::move(on_call);
}

absl::Status WatchedStore::state() const {
  const MutexLock lock(mutex_);
  return away_;
}

void WatchedStore::ask_again() {
  const MutexLock lock(mutex_);
  Clock::duration pause = first_pause_;
  while (!is_over_) {
    if (away_.ok()) {
      pause = first_pause_;
      changed_.wait(mutex_);
      continue;
    }
    const Clock::time_point next = Clock::now() + pause;
    while (!is_over_ && Clock::now() < next) changed_.wait_until(mutex_, next);
    if (is_over_) return;
    mutex_.unlock();
    Stopwatch stopwatch;
    const absl::Status status = store_->size(kProbe, ending()).status();
    count("size", status, stopwatch.lap());
    mutex_.lock();
    pause = std::min(2 * pause, longest_pause_);
  }
}

void WatchedStore::count(std::string_view operation, const absl::Status& status, double seconds) {
  {
    const MutexLock lock(observer_mutex_);
    if (on_call_) on_call_(operation, result_of(status), seconds);
  }
  const MutexLock lock(mutex_);
  if (absl::IsUnavailable(status)) {
    if (away_.ok()) log_->error("the store is away: {}", std::string(status.message()));
    away_ = absl::UnavailableError(absl::StrCat("the store that servers share is away: ", status.message()));
    changed_.notify_all();
  } else if (!absl::IsCancelled(status) && !away_.ok()) {
    log_->info("the store is back");
    away_ = absl::OkStatus();
  }
}

template <typename Call>
auto WatchedStore::watch(std::string_view operation, const Call& call) -> decltype(call()) {
  if (absl::Status away = state(); !away.ok()) return away;
  Stopwatch stopwatch;
  auto result = call();
  count(operation, status_of(result), stopwatch.lap());
  return result;
}

absl::Status WatchedStore::put(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) {
  return watch("put", [&] { return store_->put(name, path, cancel); });
}

absl::Status WatchedStore::get(const std::string& name, const std::string& path, const std::atomic<bool>* cancel) {
  return watch("get", [&] { return store_->get(name, path, cancel); });
}

absl::StatusOr<std::uint64_t> WatchedStore::size(const std::string& name, const std::atomic<bool>* cancel) {
  return watch("size", [&] { return store_->size(name, cancel); });
}

absl::Status WatchedStore::remove(const std::string& name, const std::atomic<bool>* cancel) {
  return watch("remove", [&] { return store_->remove(name, cancel); });
}

}  // namespace curvecast::server
