// What all calls share: the stores, the workers, the log. No transport.
#pragma once

#include <absl/status/statusor.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/admission.h"
#include "server/base/job_queue.h"
#include "server/base/memory_budget.h"
#include "server/base/queued_bytes.h"
#include "server/base/replaceable.h"
#include "server/base/stall_watch.h"
#include "server/base/tokens.h"
#include "server/base/view_workers.h"
#include "server/engine/caller_watch.h"
#include "server/engine/metrics.h"
#include "server/frame/client_stream.h"
#include "server/frame/frame_cache.h"
#include "server/frame/point_blocks.h"
#include "server/frame/surface_file.h"
#include "server/frame/tileset_cache.h"
#include "server/net/connection_table.h"
#include "server/net/trusted_proxies.h"
#include "server/session/making_marks.h"
#include "server/session/mesh_folder.h"
#include "server/session/mesh_store.h"
#include "server/session/rank_jobs.h"
#include "server/session/refiner.h"
#include "server/session/session_cache.h"
#include "server/session/session_store.h"
#include "server/store/watched_store.h"

namespace curvecast::server {

struct ServerOptions;

/// Thread-safe. The parts of a server are public members, for this is only the place where they meet. Their order is the order in
/// which they need each other: each part is made after those that it uses, and destroyed, which ends its threads, before them. So
/// settings and counters come first, then workers and stores, then what improves sessions, and the housekeeper at the end.
class Engine {
  // First: jobs notify streams to their end.
  std::atomic<std::uint64_t> sources_ = 0;
  Mutex mutex_;
  struct Stream {
    std::weak_ptr<ClientStream> stream;
    std::chrono::steady_clock::time_point until;  // when it has reached its age
  };
  std::vector<Stream> streams_ ABSL_GUARDED_BY(mutex_);
  std::size_t sweep_at_ ABSL_GUARDED_BY(mutex_) = 64;  // number of streams at which those that have gone are forgotten
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  const std::uint64_t memory_share_;  // bytes that the process may take

 public:
  /// `session_cache`, `known`, `kept_meshes` and `shared` may be null: without a cache; everybody may call; meshes are gone with
  /// the server; there is no store behind the cache and the meshes, which use it.
  Engine(const ServerOptions& options, std::shared_ptr<spdlog::logger> logger, std::unique_ptr<SessionCache> session_cache,
         std::shared_ptr<const Tokens> known = nullptr, TrustedProxies trusted = {},
         std::unique_ptr<MeshFolder> kept_meshes = nullptr, std::unique_ptr<WatchedStore> shared = nullptr);

  /// Whether callers must prove who they are.
  bool knows_callers() const { return asks_for_certificates || tokens.get() != nullptr; }

  /// Whether the session would survive a restart and, where there is a store, this server.
  bool is_cached(const std::string& session_id) const { return cache != nullptr && cache->is_safe(session_id); }

  /// Makes a conversation that stop_streams() ends; Unavailable after stop_streams(). The caller's connections share what it has
  /// of the workers and of the bytes that wait.
  absl::StatusOr<std::shared_ptr<ClientStream>> make_stream(ClientStream::Transport* transport, const Caller& client);
  /// Returns what make_frame() and make_point_blocks() call where an answer falls short of `request`: they have the session's
  /// curve refined, and more ranked candidates made.
  ImprovementRequests improvement_requests(const std::shared_ptr<const Session>& session, const PointSetRequest& request,
                                           std::uint64_t source);
  /// Makes a number by which Refiner::request() tells conversations and calls apart.
  std::uint64_t new_source() { return ++sources_; }
  /// Returns the bytes of memory that sessions and answers take, in use or not.
  std::uint64_t held_bytes();
  /// Counts what is held and what waits at this moment.
  Gauges gauges();
  /// Closes a session, as SessionStore::close(), and ends its refinement.
  absl::Status close_session(const std::string& id, const std::string& who);
  /// Ends all conversations once the frames under way have left, and refuses new ones. Returns when they have, or after
  /// `patience`.
  void retire_streams(const absl::Status& reason, std::chrono::milliseconds patience);
  /// Ends all conversations and refuses new ones.
  void stop_streams(const absl::Status& reason);

  const std::shared_ptr<spdlog::logger> log;
  const std::string own_key;  // by which calls from this process are known; not to be guessed
  Metrics metrics;
  const int threads;                          // of one preprocessing job, and workers for views
  MemoryBudget memory;                        // of all jobs
  QueuedBytes queued;                         // before all that sends
  StallWatch sends;                           // as well
  StallWatch receipts;                        // of the next bytes of uploads
  ViewCache view_cache;                       // of the jobs in `views` and `calls`
  FrameCache frame_cache;                     // of streams
  SurfaceFiles surface_files;                 // of all sessions
  TilesetCache tilesets;                      // of all sessions
  ViewWorkers views;                          // of streams: each takes milliseconds
  JobQueue calls;                             // single point sets, neighbours, inspection: views go before them
  JobQueue chunks;                            // of uploads: each takes a millisecond, or waits for the disk
  JobQueue preprocessing;                     // one at a time: each uses all cores by itself
  const std::unique_ptr<WatchedStore> store;  // before all that uses it; null: none
  const std::unique_ptr<SessionCache> cache;  // null: none
  const std::unique_ptr<MakingMarks> marks;   // null: no cache, or nobody else to protect
  Replaceable<Tokens> tokens;                 // of those who may call; null, for ever: everybody
  const bool asks_for_certificates;           // of those who connect over TCP
  const TrustedProxies proxies;               // that say for whom they call
  CallerWatch callers;                        // of streams and sockets
  const double max_view_rate;                 // of a stream, per second
  const std::shared_ptr<Admission> streams, uploads;
  const std::unique_ptr<ConnectionTable> connections;  // of the gRPC port
  const std::string mesh_folder;                       // of which clients may import meshes; empty: none
  const bool isolates;                                 // owners from each other
  MeshStore meshes;
  SessionStore sessions;
  Refiner refiner;
  RankJobs rank_jobs;

 private:
  /// The conversations at this moment.
  std::vector<std::shared_ptr<ClientStream>> all_streams() ABSL_LOCKS_EXCLUDED(mutex_);
  /// From now on there are no new ones.
  void refuse_streams() ABSL_LOCKS_EXCLUDED(mutex_);
  /// When a stream that is made now has reached its age.
  std::chrono::steady_clock::time_point end_of_age() const;
  /// What is held where sessions take so much.
  std::uint64_t held_bytes(std::uint64_t session_bytes) const;
  /// Ends those that have reached their age.
  void retire_old_streams(std::chrono::steady_clock::time_point now) ABSL_LOCKS_EXCLUDED(mutex_);
  void notify_streams(const Session& session) ABSL_LOCKS_EXCLUDED(mutex_);
  void run_housekeeping(const std::stop_token& stop) ABSL_LOCKS_EXCLUDED(mutex_);
  void warn_of_overdue();

  const std::chrono::milliseconds max_stall_;
  const std::chrono::seconds max_stream_age_;
  std::jthread housekeeper_;  // last: it uses the others
};

}  // namespace curvecast::server
