// Makes sets of tiles, each once for all who want it at the same time.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/status.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/mutex.h"
#include "server/frame/tileset_cache.h"
#include "server/web/resources/resource.h"
#include "server/web/resources/tileset_terms.h"

namespace curvecast::server {

class TilesetMaking;

/// Thread-safe.
class TilesetJobs : public std::enable_shared_from_this<TilesetJobs> {
 public:
  /// `channel` as of WebResource. `engine` must outlive it, and keeps what was made.
  TilesetJobs(Engine& engine, std::shared_ptr<grpc::Channel> channel) : engine_(engine), channel_(std::move(channel)) {}

  /// Null with an error.
  using Done = std::function<void(const grpc::Status& status, const std::shared_ptr<const Tileset>& set)>;

  /// Has the set of a session made of the newest points, or joins who has the same made already, and calls `done` unless the
  /// client goes before. Waits, a minute at most, for a curve that is being refined for these points. What nobody waits for any
  /// more is cancelled. `text`: the terms, as of tileset_text(); they have a budget. Preconditions: the client may see the
  /// session.
  void make(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const TilesetTerms& terms,
            const std::string& text, Done done) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  friend class TilesetMaking;
  using Key = std::pair<std::string, std::string>;  // the session and the text

  struct Waiter {
    std::shared_ptr<WebResource> resource;
    Done done;
  };
  struct Job {
    std::shared_ptr<TilesetMaking> making;
    std::map<std::uint64_t, Waiter> waiters;  // by number
  };

  /// Ends the wait of a client that has gone.
  void leave(const Key& key, std::uint64_t waiter) ABSL_LOCKS_EXCLUDED(mutex_);
  void finish(const Key& key, const TilesetMaking& making, const grpc::Status& status, const std::shared_ptr<const Tileset>& set)
      ABSL_LOCKS_EXCLUDED(mutex_);

  Engine& engine_;
  const std::shared_ptr<grpc::Channel> channel_;
  Mutex mutex_;
  std::uint64_t last_ ABSL_GUARDED_BY(mutex_) = 0;  // number of a waiter
  std::map<Key, Job> jobs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
