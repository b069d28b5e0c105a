// SPDX-License-Identifier: Apache-2.0
#include "client/lib/retry.h"

#include <absl/strings/cord.h>
#include <absl/strings/match.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <string>

#include "curvecast/v1/status.pb.h"

namespace curvecast::client {
namespace {

using std::chrono::milliseconds;

constexpr std::int64_t kMostSeconds = 3600;

}  // namespace

bool is_lost(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kCancelled:
      return true;
    case absl::StatusCode::kInternal:
      return absl::StrContains(status.message(), "RST_STREAM");
    case absl::StatusCode::kUnknown:  // a proxy lost its server in the middle of an answer
      return status.message() == "Stream removed" || status.message() == "No status received";
    default:
      return false;
  }
}

std::optional<milliseconds> retry_after(const absl::Status& status) {
  const auto payload = status.GetPayload(kRetryInfo);
  v1::RetryInfo info;
  if (!payload || !info.ParseFromString(std::string(*payload)) || !info.has_retry_delay()) return std::nullopt;
  const std::int64_t seconds = std::clamp<std::int64_t>(info.retry_delay().seconds(), 0, kMostSeconds);
  const std::int64_t rest = std::clamp(info.retry_delay().nanos() / 1'000'000, 0, 999);
  return std::min(milliseconds(1000 * seconds + rest), milliseconds(1000 * kMostSeconds));
}

void set_retry_after(absl::Status& status, std::chrono::duration<double> delay) {
  const double seconds = std::clamp(delay.count(), 0.0, double{kMostSeconds});
  v1::RetryInfo info;
  info.mutable_retry_delay()->set_seconds(static_cast<std::int64_t>(seconds));
  info.mutable_retry_delay()->set_nanos(static_cast<std::int32_t>(1e9 * (seconds - std::floor(seconds))));
  status.SetPayload(kRetryInfo, absl::Cord(info.SerializeAsString()));
}

Backoff::Backoff(milliseconds first, milliseconds longest)
    : first_(first),
      longest_(longest),
      delay_(first),
      random_(static_cast<unsigned>(std::chrono::steady_clock::now().time_since_epoch().count())) {}

milliseconds Backoff::next() {
  const double jitter = std::uniform_real_distribution<double>(0.5, 1.0)(random_);
  const milliseconds delay = std::chrono::duration_cast<milliseconds>(delay_ * jitter);
  delay_ = std::min(delay_ * 2, longest_);
  return delay;
}

bool sleep_for(milliseconds delay, const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, delay, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace curvecast::client
