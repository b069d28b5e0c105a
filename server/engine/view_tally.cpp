#include "server/engine/view_tally.h"

namespace curvecast::server {
namespace {

// A client that acknowledges nothing may send views for ever: of so many all but a few have been overtaken.
constexpr std::size_t kMaxOpen = 256;

}  // namespace

ViewTally::ViewTally(Metrics& metrics) : metrics_(metrics) { metrics_.stream_opened(); }

ViewTally::~ViewTally() {
  const MutexLock lock(mutex_);
  metrics_.views_overtaken(open_.size());
  metrics_.stream_closed();
}

void ViewTally::received(std::uint64_t sequence) {
  const MutexLock lock(mutex_);
  if (!open_.empty() && sequence <= open_.back()) return;
  metrics_.view_received();
  open_.push_back(sequence);
  if (open_.size() <= kMaxOpen) return;
  open_.pop_front();
  metrics_.views_overtaken(1);
}

void ViewTally::answered(std::uint64_t sequence) {
  const MutexLock lock(mutex_);
  std::size_t overtaken = 0;
  while (!open_.empty() && open_.front() < sequence) {
    open_.pop_front();
    ++overtaken;
  }
  if (overtaken > 0) metrics_.views_overtaken(overtaken);
  if (open_.empty() || open_.front() != sequence) return;
  open_.pop_front();
  metrics_.view_answered();
}

}  // namespace curvecast::server
