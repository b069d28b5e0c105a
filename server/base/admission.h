// How many of something there may be at once, in all and of one client.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>

namespace curvecast::server {

/// Thread-safe. Held by shared_ptr, because tickets may outlive who gave them out.
class Admission : public std::enable_shared_from_this<Admission> {
 public:
  /// `what`: of which there are many, such as "streams".
  Admission(std::string what, std::size_t most, std::size_t most_of_client);

  /// Counts as one until it goes.
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

  /// ResourceExhausted where there are too many.
  absl::StatusOr<Ticket> admit(const std::string& client);
  std::size_t count() const;

 private:
  const std::string what_;
  const std::size_t most_, most_of_client_;
  mutable std::mutex mutex_;
  std::size_t count_ = 0;
  std::map<std::string, std::size_t> of_client_;
};

/// The part of a gRPC peer's name that all connections of one machine share.
std::string client_of_peer(const std::string& peer);

}  // namespace curvecast::server
