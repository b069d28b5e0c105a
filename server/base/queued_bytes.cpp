#include "server/base/queued_bytes.h"

#include <absl/strings/str_cat.h>

namespace curvecast::server {

void QueuedBytes::add(const std::string& caller, std::int64_t bytes) {
  if (bytes == 0) return;
  const MutexLock lock(mutex_);
  bytes_ += bytes;
  const auto found = of_caller_.try_emplace(caller, 0).first;
  found->second += bytes;
  if (found->second == 0) of_caller_.erase(found);
}

absl::Status QueuedBytes::check(const std::string& caller) const {
  const MutexLock lock(mutex_);
  const auto found = of_caller_.find(caller);
  const bool is_full = bytes_ > most_;
  const bool has_share = bytes_ <= most_ / 2 || found == of_caller_.end() || found->second <= most_ / kShares;
  if (!is_full && has_share) return absl::OkStatus();
  ++refused_;
  if (is_full) return absl::ResourceExhaustedError("too much waits to be read by its clients; try again later");
  return absl::ResourceExhaustedError(absl::StrCat("you have ", found->second,
                                                   " bytes that wait to be read, more than a client may while the server has "
                                                   "many; read them first"));
}

bool QueuedBytes::is_half_full() const {
  const MutexLock lock(mutex_);
  return bytes_ > most_ / 2;
}

std::uint64_t QueuedBytes::bytes() const {
  const MutexLock lock(mutex_);
  return static_cast<std::uint64_t>(bytes_);
}

}  // namespace curvecast::server
