#include "server/base/crew.h"

#include <algorithm>
#include <atomic>
#include <latch>
#include <memory>
#include <vector>

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxWaiting = 1024;  // more go without help

}  // namespace

Crew::Crew(int helpers)
    : helpers_(helpers), queue_({.workers = std::max(helpers, 1), .max_waiting = kMaxWaiting, .low_priority = true}) {}

void Crew::for_all(std::size_t n, const std::function<void(std::size_t i)>& work) {
  const std::size_t wanted = n > 0 ? std::min(n - 1, static_cast<std::size_t>(helpers_)) : 0;
  // Shared: a helper may still be leaving the latch when the caller has gone.
  struct Turns {
    explicit Turns(std::size_t helpers) : done(static_cast<std::ptrdiff_t>(helpers)) {}
    std::atomic<std::size_t> next = 0;
    std::latch done;
  };
  const auto turns = std::make_shared<Turns>(wanted);
  const auto take = [n, &work](Turns& shared) {
    for (std::size_t i = shared.next++; i < n; i = shared.next++) work(i);
  };
  std::vector<std::uint64_t> tickets;
  for (std::size_t h = 0; h < wanted; ++h) {
    const absl::StatusOr<std::uint64_t> ticket = queue_.submit([turns, take] {
      take(*turns);
      turns->done.count_down();
    });
    if (ticket.ok()) {
      tickets.push_back(*ticket);
    } else {
      turns->done.count_down();
    }
  }
  take(*turns);
  // Helpers that have not begun, because they help others, are not waited for.
  for (const std::uint64_t ticket : tickets) {
    if (queue_.withdraw(ticket)) turns->done.count_down();
  }
  turns->done.wait();
}

}  // namespace curvecast::server
