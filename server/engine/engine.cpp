#include "server/engine/engine.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <limits>
#include <random>
#include <thread>
#include <utility>

#include "core/base/machine.h"
#include "core/base/random.h"
#include "core/pipeline/memory_estimate.h"
#include "server/base/log.h"
#include "server/base/memory_share.h"
#include "server/base/options.h"
#include "server/base/scratch_folder.h"
#include "server/base/spare_memory.h"

namespace curvecast::server {
namespace {

// Jobs that wait, in all and of one caller.
constexpr std::size_t kMaxWaiting = 1024, kMaxWaitingOfOne = 256;
constexpr std::chrono::seconds kHousekeepingInterval{1};
constexpr std::chrono::milliseconds kRetryInterval{100};  // what a view waits for longer than it has to
// Two sessions in the making at once, of which one takes less than this: a great mesh does not hold up small ones.
constexpr int kPreprocessingWorkers = 2;
constexpr std::chrono::seconds kLongPreprocessing{5};
constexpr int kChunkWorkers = 2;  // one may wait for the disk

using Clock = std::chrono::steady_clock;

// Of the memory, what sessions and answers that wait may take at most, whatever the options say.
constexpr std::uint64_t kSessionShare = 2, kQueuedShare = 8;
constexpr double kLeftToViews = 1.0 / 32;  // by what waits for memory, such as sessions in the making
// Densities that are the same in many views.
constexpr std::uint64_t kDensityShare = 16, kMostDensityBytes = std::uint64_t{256} << 20;
constexpr std::size_t kMostDensities = 16;
// Tiles that viewers may still come for.
constexpr std::uint64_t kTilesetShare = 16, kMostTilesetBytes = std::uint64_t{512} << 20;

int core_count(int threads) { return threads > 0 ? threads : machine_cores(); }

/// Printable, and not to be guessed.
std::string random_key() {
  std::random_device random;
  std::string key;
  for (int i = 0; i < 8; ++i) key += absl::StrCat(absl::Hex(random(), absl::kZeroPad8));
  return key;
}

double in_seconds(std::chrono::duration<double> duration) { return duration.count(); }

}  // namespace

Engine::Engine(const ServerOptions& options, std::shared_ptr<spdlog::logger> logger, std::unique_ptr<SessionCache> session_cache,
               std::shared_ptr<const Tokens> known, TrustedProxies trusted, std::unique_ptr<MeshFolder> kept_meshes,
               std::unique_ptr<WatchedStore> shared)
    : memory_share_(memory_share(options)),
      log(std::move(logger)),
      own_key(random_key()),
      threads(core_count(options.threads)),
      memory({.most = [this, options] { return memory_with_file(options, memory_share_); },
              .held = [this] { return held_bytes(); },
              .make_room =
                  [this](std::uint64_t bytes) {
                    std::uint64_t kept = view_cache.byte_size();
                    view_cache.clear();
                    if (kept < bytes) {
                      kept += tilesets.byte_size();
                      tilesets.clear();
                    }
                    sessions.make_room(bytes - std::min(bytes, kept));
                  },
              .left_by_waiting = kLeftToViews}),
      queued(std::min(options.max_queued_bytes, memory_share_ / kQueuedShare)),
      sends(absl::ResourceExhaustedError(
          "you have not read what was sent to you for too long, and the server needs its memory; read faster")),
      receipts(absl::UnavailableError("nothing has come of the upload for too long; go on with it")),
      view_cache{FixedDensityCache(kMostDensities, std::min(kMostDensityBytes, memory_share_ / kDensityShare)), {}},
      tilesets(std::min(kMostTilesetBytes, memory_share_ / kTilesetShare)),
      views({.workers = threads,
             .max_waiting = kMaxWaiting,
             .max_waiting_of_one = kMaxWaitingOfOne,
             .on_done = [this](auto waited, auto took) { metrics.view_job(in_seconds(waited), in_seconds(took)); }}),
      calls({.workers = threads + 1,
             .max_waiting = kMaxWaiting,
             .max_waiting_of_one = kMaxWaitingOfOne,
             .max_running_of_one = threads,
             .low_priority = true}),
      chunks({.workers = kChunkWorkers, .max_waiting = options.max_uploads, .low_priority = true}),
      preprocessing({.workers = kPreprocessingWorkers,
                     .max_waiting = kMaxWaiting,
                     .low_priority = has_other_clients(options),
                     .long_job = kLongPreprocessing}),
      store(std::move(shared)),
      cache(std::move(session_cache)),
      marks(cache != nullptr && has_other_clients(options) ? std::make_unique<MakingMarks>(cache->folder(), options.crash_pause)
                                                           : nullptr),
      tokens(std::move(known)),
      asks_for_certificates(!options.tls_client_ca.empty()),
      proxies(std::move(trusted)),
      callers([this](const Caller& caller) { return check(*this, caller); }),
      max_view_rate(options.max_view_rate),
      streams(std::make_shared<Admission>("streams of views", options.max_streams, options.max_streams_of_client)),
      uploads(std::make_shared<Admission>("uploads", options.max_uploads, options.max_uploads_of_client)),
      connections(std::make_unique<ConnectionTable>(options.max_connections)),
      mesh_folder(options.mesh_folder),
      isolates(options.isolate),
      meshes({options.max_mesh_bytes, options.max_upload_bytes, isolates}, scratch_folder(options), std::move(kept_meshes)),
      sessions(preprocessing,
               [this](const MeshFile& file, const PreprocessOptions& wanted, const ExecutionContext& context,
                      const OnPreview& on_preview) {
                 const auto start = std::chrono::steady_clock::now();
                 auto made = preprocess(file, wanted, context, on_preview);
                 metrics.preprocessing(made.status().raw_code(), in_seconds(std::chrono::steady_clock::now() - start));
                 return made;
               },
               {options.max_sessions, std::min(options.max_session_bytes, memory_share_ / kSessionShare),
                options.max_sessions_in_making_of_client},
               threads, log,
               {.cache = cache.get(),
                .marks = marks.get(),
                .memory =
                    [this](const std::atomic<bool>* cancel) {
                      return std::make_unique<MemoryBudget::Job>(memory, cancel, MemoryTerms{.keeps = true});
                    },
                .on_replaced =
                    [this](const Session& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real) {
                      for (const auto& stream : all_streams()) stream->replace(preview, real);
                    },
                .may_make =
                    [this](const MeshFiles& files, const PreprocessOptions& wanted) {
                      MemoryBudget::Outlook outlook(memory);
                      const ExecutionContext counted{.memory = &outlook};
                      MemoryClaim claim(counted);
                      return claim_curve(files.mesh->name, wanted, counted, claim);
                    },
                .isolate = isolates}),
      refiner(
          options.max_curve_vertices,
          [this](const Session& session, bool is_finer) {
            metrics.refinement(is_finer);
            if (is_finer) sessions.save(session);
            notify_streams(session);
          },
          [this] { return memory_share_ - std::min(memory_share_, held_bytes() + memory.reserved()); }, log),
      rank_jobs(
          threads,
          [this](const Session& session) {
            notify_streams(session);
            if (cache != nullptr) cache->save_candidates(session);
          },
          log),
      max_stall_(options.max_stall),
      max_stream_age_(options.max_stream_age),
      housekeeper_([this](const std::stop_token& stop) { run_housekeeping(stop); }) {
  if (store != nullptr) {
    store->observe([this](std::string_view operation, std::string_view result, double seconds) {
      metrics.store_call(operation, result, seconds);
    });
  }
  // Workers started before what they use was there. They take the lock of their queue once more before they use it.
  for (const JobQueue* const queue : {&calls, &chunks, &preprocessing}) static_cast<void>(queue->waiting());
  static_cast<void>(views.waiting());
}

void Engine::run_housekeeping(const std::stop_token& stop) {
  Mutex mutex;
  std::condition_variable_any never;
  MutexLock lock(mutex);
  SpareMemory spare;
  auto next = std::chrono::steady_clock::now() + kHousekeepingInterval;
  while (!never.wait_for(lock, stop, kRetryInterval, [] { return false; }) && !stop.stop_requested()) {
    for (const auto& stream : all_streams()) stream->retry();
    const auto now = std::chrono::steady_clock::now();
    if (now < next) continue;
    next = now + kHousekeepingInterval;
    sessions.run_housekeeping(now);
    if (marks != nullptr) marks->touch();
    meshes.run_housekeeping();
    if (cache != nullptr) cache->refresh_used_bytes(now);
    frame_cache.forget_before(now - kHousekeepingInterval);
    callers.end_refused();
    if (queued.is_half_full()) metrics.stalled(sends.end_begun_before(now - max_stall_));
    receipts.end_begun_before(now - max_stall_);
    retire_old_streams(now);
    warn_of_overdue();
    spare.give_back(now);
  }
}

void Engine::warn_of_overdue() {
  const auto warn = [this](const std::string& caller, JobQueue::Nanoseconds time) {
    log->warn("a job of {} takes far longer than expected, {:.0f} s by now", caller.empty() ? "somebody" : printable(caller),
              in_seconds(time));
  };
  views.tell_overdue(warn);
  calls.tell_overdue(warn);
  chunks.tell_overdue(warn);
  preprocessing.tell_overdue(warn);
}

absl::StatusOr<std::shared_ptr<ClientStream>> Engine::make_stream(ClientStream::Transport* transport, const Caller& client) {
  const std::string &caller = client.name, &connection = client.address;
  auto stream = std::make_shared<ClientStream>(
      transport,
      ClientStream::Hooks{
          .find = [this, owner = client.owner](const std::string& id) { return sessions.find_for_views(id, owner); },
          .answer =
              [this, source = new_source()](const std::shared_ptr<const Session>& session, const FrameRequest& request) {
                const FrameCache::Key key{.curve = session->curve(),
                                          .request = request.point_set.fingerprint,
                                          .points = request.point_set.options.points,
                                          .reference = request.reference != nullptr ? request.reference->digest() : 0,
                                          .first_bytes = request.first_bytes};
                const auto make = [&]() -> absl::StatusOr<Answer> {
                  // A worker that waited would hold up others' views.
                  MemoryBudget::Job counted(memory, request.context.cancel, {.waits = false});
                  FrameRequest bounded = request;
                  bounded.context.memory = &counted;
                  auto made = make_frame(*session, bounded, view_cache, improvement_requests(session, request.point_set, source));
                  if (absl::Status checked = sessions.check(*session); !checked.ok()) return checked;
                  return made;
                };
                // The last improvement says that no better one follows, which is true for its client only.
                return request.may_refine ? frame_cache.get(key, make) : make();
              },
          .restore = [this](const Session& session, const ResumeClaim& claim,
                            const ExecutionContext& context) { return restore_reference(session, claim, view_cache, context); },
          .has_room = [this, caller] { return queued.check(caller); },
          .submit =
              [this, caller, connection](std::function<void()> job, std::chrono::nanoseconds expected) {
                return views.submit(std::move(job), {.caller = caller, .connection = connection, .expected = expected});
              },
          .count_queued = [this, caller](std::int64_t bytes) { queued.add(caller, bytes); },
      });
  const MutexLock lock(mutex_);
  if (stopped_) return absl::UnavailableError("the server is shutting down");
  if (streams_.size() >= sweep_at_) {
    std::erase_if(streams_, [](const Stream& entry) { return entry.stream.expired(); });
    sweep_at_ = std::max<std::size_t>(64, 2 * streams_.size());
  }
  streams_.push_back({stream, end_of_age()});
  return stream;
}

Clock::time_point Engine::end_of_age() const {
  if (max_stream_age_.count() == 0) return Clock::time_point::max();
  // Not all at once: those who came together would go together.
  const double jitter = 0.9 + 0.2 * random_unit(std::random_device()(), 0);
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(jitter * max_stream_age_);
}

ImprovementRequests Engine::improvement_requests(const std::shared_ptr<const Session>& session, const PointSetRequest& request,
                                                 std::uint64_t source) {
  return {
      .finer_curve =
          [this, session, source, density = request.options.density](const SurfaceCurve& curve, std::uint64_t points) {
            return refiner.request(session, curve, source, {points, density});
          },
      .more_ranks = [this, session, source](RankDemand demand) { return rank_jobs.request(session, source, std::move(demand)); }};
}

std::uint64_t Engine::held_bytes() { return held_bytes(sessions.memory_bytes()); }

std::uint64_t Engine::held_bytes(std::uint64_t session_bytes) const {
  return session_bytes + queued.bytes() + view_cache.byte_size() + tilesets.byte_size();
}

Gauges Engine::gauges() {
  Gauges out;
  out.memory_bytes = memory.most();
  out.sessions = sessions.list({}, std::numeric_limits<std::size_t>::max(), kOperator).size();
  out.session_bytes = sessions.memory_bytes();
  out.held_bytes = held_bytes(out.session_bytes);
  out.reserved_bytes = memory.reserved();
  out.connections = connections->count();
  out.ended_connections = connections->ended();
  out.refused_connections = connections->refused();
  out.threads = threads;
  out.waiting_views = views.waiting();
  out.shared_frames = frame_cache.shared();
  out.waiting_calls = calls.waiting();
  out.waiting_chunks = chunks.waiting();
  out.waiting_preprocessing = preprocessing.waiting();
  out.overdue_views = views.overdue();
  out.overdue_calls = calls.overdue();
  out.overdue_chunks = chunks.overdue();
  out.overdue_preprocessing = preprocessing.overdue();
  out.queued_bytes = queued.bytes();
  out.refused = {{"queued_bytes", queued.refused()}, {"waiting_views", views.refused()},
                 {"waiting_calls", calls.refused()}, {"waiting_preprocessing", preprocessing.refused()},
                 {"memory", memory.refused()},       {"streams", streams->refused()},
                 {"uploads", uploads->refused()}};
  out.evicted = {{"sessions", sessions.evicted()}, {"meshes", meshes.usage().evicted}};
  const MeshStore::Usage held = meshes.usage();
  out.meshes = held.meshes;
  out.mesh_bytes = held.bytes;
  if (cache != nullptr) {
    out.cache_bytes = cache->used_bytes();
    out.unsaved_sessions = cache->unsaved();
    out.unstored = cache->unstored();
    out.cache_operations = cache->operations();
  }
  return out;
}

absl::Status Engine::close_session(const std::string& id, const std::string& who) {
  const absl::StatusOr<SessionInfo> info = sessions.info(id, who);
  absl::Status closed = sessions.close(id, who);
  if (closed.ok()) tilesets.forget(id);
  if (closed.ok() && info.ok() && info->session != nullptr) refiner.forget(*info->session);
  return closed;
}

std::vector<std::shared_ptr<ClientStream>> Engine::all_streams() {
  std::vector<std::shared_ptr<ClientStream>> out;
  const MutexLock lock(mutex_);
  for (const Stream& entry : streams_) {
    if (auto stream = entry.stream.lock()) out.push_back(std::move(stream));
  }
  return out;
}

void Engine::retire_old_streams(Clock::time_point now) {
  std::vector<std::shared_ptr<ClientStream>> old;
  {
    const MutexLock lock(mutex_);
    for (Stream& entry : streams_) {
      if (now < entry.until) continue;
      entry.until = Clock::time_point::max();
      if (auto stream = entry.stream.lock()) old.push_back(std::move(stream));
    }
  }
  for (const auto& stream : old) stream->retire(absl::UnavailableError("the stream has reached its age; connect again"));
}

void Engine::notify_streams(const Session& session) {
  for (const auto& stream : all_streams()) stream->refined(session);
}

void Engine::refuse_streams() {
  const MutexLock lock(mutex_);
  stopped_ = true;
}

void Engine::retire_streams(const absl::Status& reason, std::chrono::milliseconds patience) {
  refuse_streams();
  for (const auto& stream : all_streams()) stream->retire(reason);
  const Clock::time_point end = Clock::now() + patience;
  while (streams->count() > 0 && Clock::now() < end) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

void Engine::stop_streams(const absl::Status& reason) {
  refuse_streams();
  for (const auto& stream : all_streams()) stream->stop(reason);
}

}  // namespace curvecast::server
