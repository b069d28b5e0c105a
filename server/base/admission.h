// How many of something there may be at once, in all and of one client.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Thread-safe. Held by shared_ptr, because tickets may outlive the one who holds it.
class Admission : public std::enable_shared_from_this<Admission> {
 public:
  /// `what` names in messages what is counted, such as "streams". Admits `most` of it, and `most_of_client` for each client.
  Admission(std::string what, std::size_t most, std::size_t most_of_client);

  /// Counts as one until it is destroyed.
  class Ticket {
   public:
    Ticket(std::shared_ptr<Admission> from, std::string client) : from_(std::move(from)), client_(std::move(client)) {}
    Ticket(Ticket&&) noexcept = default;
    Ticket& operator=(Ticket&& other) noexcept {
      from_.swap(other.from_);
      client_.swap(other.client_);
      return *this;
    }
    ~Ticket();

   private:
    std::shared_ptr<Admission> from_;  // null: moved from
    std::string client_;
  };

  /// Lets one in. ResourceExhausted where there are too many, in all or of this client.
  absl::StatusOr<Ticket> admit(const std::string& client);
  /// How many tickets there are.
  std::size_t count() const;
  /// How often admit() has refused.
  std::uint64_t refused() const { return refused_; }

 private:
  const std::string what_;
  const std::size_t most_, most_of_client_;
  std::atomic<std::uint64_t> refused_ = 0;
  mutable Mutex mutex_;
  std::size_t count_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::size_t> of_client_ ABSL_GUARDED_BY(mutex_);
};

/// The part of a gRPC peer's name that all connections of one machine share.
std::string client_of_peer(const std::string& peer);

}  // namespace curvecast::server
