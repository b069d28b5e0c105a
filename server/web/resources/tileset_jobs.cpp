#include "server/web/resources/tileset_jobs.h"

#include <utility>

#include "server/web/resources/tileset_making.h"

namespace curvecast::server {

void TilesetJobs::make(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const TilesetTerms& terms,
                       const std::string& text, Done done) {
  const Key key(session_id, text);
  std::shared_ptr<TilesetMaking> begun;
  std::uint64_t number = 0;
  {
    const MutexLock lock(mutex_);
    Job& job = jobs_[key];
    number = ++last_;
    job.waiters.emplace(number, Waiter{resource, std::move(done)});
    if (job.making == nullptr) {
      begun = job.making = std::make_shared<TilesetMaking>(
          resource, channel_, session_id, terms, text,
          [self = shared_from_this(), key](const TilesetMaking& making, const grpc::Status& status,
                                           const std::shared_ptr<const Tileset>& set) {
            self->finish(key, making, status, set);
          });
    }
  }
  if (begun != nullptr) begun->start();
  resource->on_gone([self = shared_from_this(), key, number] { self->leave(key, number); });
}

void TilesetJobs::leave(const Key& key, std::uint64_t waiter) {
  Waiter gone;
  std::shared_ptr<TilesetMaking> abandoned;
  {
    const MutexLock lock(mutex_);
    const auto job = jobs_.find(key);
    if (job == jobs_.end()) return;
    auto waiting = job->second.waiters.extract(waiter);
    if (waiting.empty()) return;  // of an earlier job
    gone = std::move(waiting.mapped());
    if (job->second.waiters.empty()) {
      abandoned = std::move(job->second.making);
      jobs_.erase(job);
    }
  }
  if (abandoned != nullptr) abandoned->cancel();
}

void TilesetJobs::finish(const Key& key, const TilesetMaking& making, const grpc::Status& status,
                         const std::shared_ptr<const Tileset>& set) {
  if (set != nullptr) engine_.tilesets.keep(set);
  Job done;
  {
    const MutexLock lock(mutex_);
    const auto job = jobs_.find(key);
    if (job == jobs_.end() || job->second.making.get() != &making) return;  // nobody waits
    done = std::move(job->second);
    jobs_.erase(job);
  }
  for (const auto& [number, waiter] : done.waiters) waiter.done(status, set);
}

}  // namespace curvecast::server
