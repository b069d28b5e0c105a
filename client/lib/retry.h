// SPDX-License-Identifier: Apache-2.0
// Which calls are worth making again, and how long to wait before.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <optional>
#include <random>
#include <stop_token>

namespace curvecast::client {

/// Whether a call was lost on the way: Unavailable, Cancelled that nobody here asked for (a proxy lost its server), Internal for
/// a reset HTTP/2 stream, and Unknown for an answer that broke off without a status.
bool is_lost(const absl::Status& status);

/// The payload of a status that says when to try again: a v1::RetryInfo.
inline constexpr char kRetryInfo[] = "type.googleapis.com/google.rpc.RetryInfo";

/// After how long the server asks to try again what it had no room for, at most an hour; none where it does not say.
std::optional<std::chrono::milliseconds> retry_after(const absl::Status& status);
void set_retry_after(absl::Status& status, std::chrono::duration<double> delay);

/// Pauses between attempts: twice as long every time, less up to half, which spreads the load of many clients that lost the same
/// server.
class Backoff {
 public:
  Backoff(std::chrono::milliseconds first, std::chrono::milliseconds longest);
  std::chrono::milliseconds next();
  void reset() { delay_ = first_; }

 private:
  std::chrono::milliseconds first_, longest_, delay_;
  std::minstd_rand random_;
};

/// False when `stop` was requested meanwhile.
bool sleep_for(std::chrono::milliseconds delay, const std::stop_token& stop);

}  // namespace curvecast::client
