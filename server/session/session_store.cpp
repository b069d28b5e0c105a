#include "server/session/session_store.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <limits>
#include <utility>

#include "server/base/guarded.h"
#include "server/base/log.h"

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kReportInterval = std::chrono::milliseconds(50);

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

absl::Status not_found(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("session \"", printable(id), "\" is not held here; create it again"));
}

absl::Status not_yours(const std::string& id) {
  return absl::PermissionDeniedError(absl::StrCat("session \"", printable(id), "\" is another client's"));
}

}  // namespace

struct SessionStore::Job {
  std::string id;
  std::string mesh_id;
  std::string owner;
  PreprocessOptions options;
  MeshFiles files;
  Clock::time_point created = Clock::now();
  std::atomic<bool> cancel = false;
  bool loads = false;  // from the cache; where that fails, it is made after all. Changes only between runs
  // What follows is guarded by the store's lock.
  std::uint64_t ticket = 0;
  std::vector<SessionWaiter*> waiters;
  std::string stage = "queued";  // last one told to the waiters, as is `fraction`
  double fraction = 0;
  Clock::time_point last_report;
};

SessionStore::SessionStore(JobQueue& queue, Preprocess preprocess, const SessionLimits& limits, int threads,
                           std::shared_ptr<spdlog::logger> log, SessionCache* cache)
    : queue_(queue),
      preprocess_(std::move(preprocess)),
      limits_(limits),
      threads_(threads),
      log_(std::move(log)),
      cache_(cache) {}

SessionStore::~SessionStore() {
  std::unique_lock lock(mutex_);
  for (auto& [id, entry] : entries_) {
    if (entry.job != nullptr) abandon(*entry.job);
  }
  idle_.wait(lock, [this] { return jobs_ == 0; });
}

absl::StatusOr<std::string> SessionStore::join(MeshFiles files, const PreprocessOptions& options, SessionWaiter* waiter,
                                               const std::string& owner) {
  const std::string id = session_id(files, options);
  Evicted evicted;  // outlives the lock
  const std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(id); found != entries_.end()) {
    Entry& entry = found->second;
    touch(entry);
    if (entry.job == nullptr) {
      waiter->on_done(entry.info.session);
    } else {
      entry.job->waiters.push_back(waiter);
      waiter->on_progress(entry.job->stage, entry.job->fraction);
    }
    return id;
  }
  if (absl::Status status = make_room(evicted); !status.ok()) return status;
  auto job = std::make_shared<Job>();
  job->id = id;
  job->mesh_id = files.mesh->id;
  job->owner = owner;
  job->options = options;
  job->files = std::move(files);
  job->loads = cache_ != nullptr && cache_->holds(id);
  if (absl::Status status = submit(job); !status.ok()) return status;
  ++jobs_;
  job->waiters.push_back(waiter);
  entries_[id] = {
      .info = {id, job->mesh_id, options, SessionState::kQueued, nullptr}, .job = job, .owner = owner, .last_used = ++clock_};
  log_->info("session {} created: mesh {} \"{}\", {} points, omega {}", id, job->mesh_id, printable(job->files.mesh->name),
             options.points, options.omega);
  waiter->on_progress(job->stage, job->fraction);
  return id;
}

bool SessionStore::leave(const std::string& id, SessionWaiter* waiter) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end() || found->second.job == nullptr) return false;
  const std::shared_ptr<Job> job = found->second.job;
  if (std::erase(job->waiters, waiter) == 0) return false;
  if (job->waiters.empty()) {
    log_->info("session {} cancelled: nobody waits for it any more", id);
    abandon(*job);
    entries_.erase(found);
  }
  return true;
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::find(const std::string& id) {
  return must_load(id) ? load(id) : find_here(id);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::find_here(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return not_found(id);
  touch(found->second);
  if (found->second.info.session == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("session ", id, " is still being preprocessed; join it with CreateSession and wait until it is ready"));
  }
  return found->second.info.session;
}

bool SessionStore::must_load(const std::string& id) {
  const std::lock_guard lock(mutex_);
  return !entries_.contains(id) && cache_ != nullptr && cache_->holds(id);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::load(const std::string& id) {
  const std::lock_guard one_at_a_time(load_mutex_);
  if (!must_load(id)) return find_here(id);  // somebody else was faster
  const Clock::time_point start = Clock::now();
  absl::StatusOr<std::shared_ptr<const Session>> loaded = cache_->load(id);
  if (!loaded.ok()) return not_found(id);
  Evicted evicted;  // outlives the lock
  const std::lock_guard lock(mutex_);
  // A job for it that has begun meanwhile goes on: it will give the same.
  if (entries_.contains(id)) return *loaded;
  if (absl::Status status = make_room(evicted); !status.ok()) return status;
  const Session& session = **loaded;
  entries_[id] = {
      .info = {id, session.mesh_id, session.options, SessionState::kReady, *loaded}, .job = nullptr, .last_used = ++clock_};
  log_->info("session {} loaded from the cache in {:.3f} s", id, seconds_since(start));
  return *loaded;
}

absl::StatusOr<SessionInfo> SessionStore::info(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return not_found(id);
  return found->second.info;
}

std::vector<SessionInfo> SessionStore::list(const std::string& after, std::size_t most) {
  const std::lock_guard lock(mutex_);
  std::vector<SessionInfo> out;
  for (auto it = entries_.upper_bound(after); it != entries_.end() && out.size() < most; ++it) out.push_back(it->second.info);
  return out;
}

absl::StatusOr<SessionInfo> SessionStore::update(const std::string& id, std::optional<bool> pinned,
                                                 std::optional<double> time_to_live, const std::string& who) {
  const absl::StatusOr<std::shared_ptr<const Session>> ready = find(id);
  if (!ready.ok()) return ready.status();
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return not_found(id);
  if (!found->second.may_change(who)) return not_yours(id);
  SessionInfo& info = found->second.info;
  if (pinned.value_or(false) && !info.pinned) {
    if (absl::Status status = may_pin(**ready); !status.ok()) return status;
  }
  info.pinned = pinned.value_or(info.pinned);
  info.time_to_live = time_to_live.value_or(info.time_to_live);
  log_->info("session {}: {}pinned, time to live {} s", id, info.pinned ? "" : "not ", info.time_to_live);
  return info;
}

absl::Status SessionStore::may_pin(const Session& session) const {
  std::uint64_t sessions = 1, bytes = session.memory_bytes();
  for (const auto& [id, entry] : entries_) {
    if (!entry.info.pinned || entry.info.session == nullptr) continue;
    ++sessions;
    bytes += entry.info.session->memory_bytes();
  }
  const std::uint64_t most = std::max<std::uint64_t>(1, limits_.sessions / 2);
  if (sessions <= most && bytes <= limits_.bytes / 2) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("no more than half of what the server holds may be pinned, ", most,
                                                   " sessions and ", limits_.bytes / 2, " bytes; unpin another one"));
}

std::vector<std::string> SessionStore::tend(Clock::time_point now) {
  std::vector<std::pair<std::string, std::string>> unused;  // and their owners
  std::vector<std::string> expired;
  Evicted evicted;  // outlives the lock
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, entry] : entries_) {
      if (!entry.is_idle()) entry.used_at = now;
      const std::chrono::duration<double> idle = now - entry.used_at;
      if (entry.info.time_to_live > 0 && idle.count() > entry.info.time_to_live) unused.emplace_back(id, entry.owner);
    }
    evict(limits_, evicted);
  }
  // Who has begun to use one of them meanwhile keeps it until he is done with it.
  for (const auto& [id, owner] : unused) {
    if (close(id, owner).ok()) expired.push_back(id);
  }
  return expired;
}

std::uint64_t SessionStore::memory_bytes() {
  const std::lock_guard lock(mutex_);
  std::uint64_t bytes = 0;
  for (const auto& [id, entry] : entries_) bytes += entry.info.session != nullptr ? entry.info.session->memory_bytes() : 0;
  return bytes;
}

void SessionStore::save(const Session& session) {
  const std::lock_guard lock(mutex_);  // close() comes wholly before or after
  const auto found = entries_.find(session.id);
  if (found == entries_.end() || found->second.info.session == nullptr || found->second.info.session->live != session.live)
    return;
  if (cache_ != nullptr) cache_->save(session);
}

absl::Status SessionStore::close(const std::string& id, const std::string& who) {
  Entry closed;  // outlives the lock, as in join()
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found != entries_.end() && !found->second.may_change(who)) return not_yours(id);
  const bool was_cached = cache_ != nullptr && cache_->remove(id);
  if (found == entries_.end() && !was_cached) return not_found(id);
  if (found != entries_.end()) {
    closed = std::move(found->second);
    entries_.erase(found);
  }
  log_->info("session {} closed", id);
  if (closed.job != nullptr) {
    const absl::Status reason = absl::AbortedError(absl::StrCat("session ", id, " was closed before it was ready"));
    for (SessionWaiter* waiter : std::exchange(closed.job->waiters, {})) waiter->on_done(reason);
    abandon(*closed.job);
  }
  return absl::OkStatus();
}

void SessionStore::touch(Entry& entry) {
  entry.last_used = ++clock_;
  entry.used_at = Clock::now();
}

bool SessionStore::evict(const SessionLimits& limits, Evicted& evicted) {
  std::vector<Resident> residents;
  for (const auto& [id, entry] : entries_) {
    // References are only handed out under the lock, so a count of one cannot grow meanwhile.
    residents.push_back({id, entry.last_used, entry.info.session != nullptr ? entry.info.session->memory_bytes() : 0,
                         entry.is_idle() && !entry.info.pinned});
  }
  const Eviction eviction = choose_evicted(std::move(residents), limits);
  for (const std::string& id : eviction.ids) {
    log_->info("session {} evicted: not used for longest", id);
    const auto found = entries_.find(id);
    evicted.push_back(std::move(found->second.info.session));
    entries_.erase(found);
  }
  return eviction.is_enough;
}

absl::Status SessionStore::make_room(Evicted& evicted) {
  if (evict({limits_.sessions - 1, limits_.bytes}, evicted)) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("the server holds ", limits_.sessions, " sessions or ", limits_.bytes,
                   " bytes of them at most, and all of them are in use; close one or try again later"));
}

void SessionStore::abandon(Job& job) {
  job.cancel = true;
  if ((job.loads ? cache_->loading() : queue_).withdraw(job.ticket)) --jobs_;
}

absl::Status SessionStore::submit(const std::shared_ptr<Job>& job) {
  const absl::StatusOr<std::uint64_t> ticket = job->loads ? cache_->loading().submit([this, job] { run_load(job); })
                                                          : queue_.submit([this, job] { run(job); }, job->owner);
  if (ticket.ok()) job->ticket = *ticket;
  return ticket.status();
}

void SessionStore::run_load(const std::shared_ptr<Job>& job) {
  report(*job, "load", 0);
  absl::StatusOr<std::shared_ptr<const Session>> loaded = absl::CancelledError("cancelled");
  if (!job->cancel) loaded = cache_->load(job->id);
  const std::lock_guard lock(mutex_);
  if (!job->cancel && !loaded.ok()) {
    broadcast(*job, "load", 1);
    broadcast(*job, "queued", 0);
    job->loads = false;
    const absl::Status submitted = submit(job);
    if (submitted.ok()) return;
    loaded = submitted;
  }
  if (!job->cancel) settle(*job, std::move(loaded));
  --jobs_;
  idle_.notify_all();
}

std::shared_ptr<const Session> SessionStore::make_session(const Job& job, Preprocessed preprocessed) {
  auto session = std::make_shared<Session>();
  session->id = job.id;
  session->mesh_id = job.mesh_id;
  session->mesh_name = job.files.mesh->name;
  for (const auto& [name, file] : job.files.companions) session->companions[name] = file->id;
  session->options = job.options;
  session->preprocessed = std::move(preprocessed);
  session->live->publish(std::move(session->preprocessed.curve));
  session->peak_bytes = peak_memory_bytes();
  return session;
}

void SessionStore::run(const std::shared_ptr<Job>& job) {
  absl::StatusOr<std::shared_ptr<const Session>> result = absl::CancelledError("cancelled");
  bool wanted = false;
  {
    const std::lock_guard lock(mutex_);
    wanted = !job->cancel;
    if (wanted) {
      entries_.at(job->id).info.state = SessionState::kPreprocessing;
      broadcast(*job, "queued", 1);
    }
  }
  if (wanted) {
    ExecutionContext context;
    context.on_progress = [&](std::string_view stage, double fraction) { report(*job, stage, fraction); };
    context.cancel = &job->cancel;
    context.threads = threads_;
    absl::StatusOr<Preprocessed> made = guarded([&] { return preprocess_(job->files.file(), job->options, context); });
    if (made.ok()) {
      result = make_session(*job, *std::move(made));
    } else {
      result = made.status();
    }
  }
  const std::lock_guard lock(mutex_);
  if (!job->cancel) {
    if (result.ok() && cache_ != nullptr) cache_->save(**result);
    settle(*job, std::move(result));
  }
  --jobs_;
  idle_.notify_all();
}

void SessionStore::settle(Job& job, absl::StatusOr<std::shared_ptr<const Session>> result) {
  if (result.ok() && job.fraction < 1) broadcast(job, std::string(job.stage), 1);
  const auto waiters = std::exchange(job.waiters, {});
  if (!result.ok()) {
    log_->error("session {} failed after {:.3f} s: {}", job.id, seconds_since(job.created), result.status().ToString());
    entries_.erase(job.id);
    for (SessionWaiter* waiter : waiters) waiter->on_done(result.status());
    return;
  }
  const std::shared_ptr<const Session> session = *std::move(result);
  Entry& entry = entries_.at(job.id);
  entry.info.state = SessionState::kReady;
  entry.info.session = session;
  entry.job = nullptr;
  touch(entry);
  const std::shared_ptr<const SurfaceCurve> curve = session->curve();
  log_->info("session {} {} after {:.3f} s: {} curve vertices, {} MiB", job.id, job.loads ? "loaded from the cache" : "ready",
             seconds_since(job.created), curve->size(), curve->byte_size() >> 20);
  for (SessionWaiter* waiter : waiters) waiter->on_done(session);
}

void SessionStore::report(Job& job, std::string_view stage, double fraction) {
  const std::lock_guard lock(mutex_);
  if (job.cancel) return;
  if (stage != job.stage) {
    if (job.fraction < 1) broadcast(job, std::string(job.stage), 1);
    broadcast(job, stage, fraction);
  } else if ((fraction >= 1 && job.fraction < 1) || Clock::now() - job.last_report >= kReportInterval) {
    broadcast(job, stage, fraction);
  }
}

void SessionStore::broadcast(Job& job, std::string_view stage, double fraction) {
  job.stage = stage;
  job.fraction = std::clamp(fraction, 0.0, 1.0);
  job.last_report = Clock::now();
  for (SessionWaiter* waiter : job.waiters) waiter->on_progress(job.stage, job.fraction);
}

}  // namespace curvecast::server
