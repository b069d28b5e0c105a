#include "server/engine/caller_watch.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace curvecast::server {

CallerWatch::Ticket::Ticket(CallerWatch& watch, const Caller& caller, End end) : watch_(watch) {
  const MutexLock lock(watch_.mutex_);
  number_ = ++watch_.last_;
  watch_.watched_[number_] = {caller, std::move(end)};
}

CallerWatch::Ticket::~Ticket() {
  const MutexLock lock(watch_.mutex_);
  watch_.watched_.erase(number_);
}

void CallerWatch::end_refused() {
  std::vector<Watched> all;
  {
    const MutexLock lock(mutex_);
    all.reserve(watched_.size());
    for (const auto& [number, watched] : watched_) all.push_back(watched);
  }
  std::reverse(all.begin(), all.end());
  for (const Watched& watched : all) {
    if (const absl::Status refused = check_(watched.caller); !refused.ok()) watched.end(refused);
  }
}

}  // namespace curvecast::server
