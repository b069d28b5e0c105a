#include "server/session/session_store.h"

#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <utility>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

// How often a store is asked whether another server has closed a session that is in use, or in memory.
constexpr std::chrono::seconds kWatchUsed{5}, kWatchHeld{60};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

absl::Status not_found(const std::string& id) {
  return absl::NotFoundError(absl::StrCat("session \"", printable(id), "\" is not held here; create it again"));
}

absl::Status not_yours(const std::string& id) {
  return absl::PermissionDeniedError(absl::StrCat("session \"", printable(id), "\" is another client's"));
}

}  // namespace

SessionStore::SessionStore(JobQueue& queue, Preprocess preprocess, const SessionLimits& limits, int threads,
                           std::shared_ptr<spdlog::logger> log, Options options)
    : log_(std::move(log)),
      cache_(options.cache),
      on_replaced_(std::move(options.on_replaced)),
      may_make_(std::move(options.may_make)),
      isolates_(options.isolate),
      table_(limits, [this](const std::string& id) { return cache_ != nullptr && cache_->is_unsaved(id); }),
      jobs_(
          queue, std::move(preprocess), threads, options.cache, options.marks, std::move(options.memory),
          [this](const std::shared_ptr<SessionJob>& job, std::shared_ptr<const Session> preview) {
            take_in_preview(job, std::move(preview));
          },
          [this](const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> made) {
            take_in(job, std::move(made));
          }) {}

SessionStore::~SessionStore() {
  const MutexLock lock(mutex_);
  for (const auto& job : table_.jobs()) jobs_.cancel(*job);
}

absl::StatusOr<std::string> SessionStore::join(MeshFiles files, const PreprocessOptions& options, SessionWaiter* waiter,
                                               const Maker& maker) {
  const std::string id = session_id(files, options);
  drop_closed(id);
  drop_damaged(id);
  // Before it waits for its turn, and of others. Of what may be in the store later: see may_make_after_all().
  if (may_make_ && !is_there(id)) {
    if (absl::Status status = may_make_(files, options); !status.ok()) return status;
  }
  SessionTable::Sessions evicted;  // outlives the lock
  std::shared_ptr<SessionJob> job;
  std::shared_ptr<const Session> ready;
  {
    const MutexLock lock(mutex_);
    if (const SessionTable::Entry* entry = table_.use(id)) {
      if (!may_see(entry->owner, maker.owner)) return not_found(id);
      job = entry->job;
      ready = entry->info.session;
      if (job != nullptr) job->waiters.add(waiter);
    } else {
      auto started = start_job(id, std::move(files), options, waiter, maker, evicted);
      if (!started.ok()) return started.status();
      job = *std::move(started);
    }
  }
  if (job == nullptr) {
    waiter->on_done(std::move(ready));
  } else {
    job->waiters.deliver();
  }
  return id;
}

absl::StatusOr<std::shared_ptr<SessionJob>> SessionStore::start_job(const std::string& id, MeshFiles files,
                                                                    const PreprocessOptions& options, SessionWaiter* waiter,
                                                                    const Maker& maker, SessionTable::Sessions& evicted) {
  const bool is_made = !may_load(id);
  if (absl::Status status = is_made ? table_.may_make(maker.caller) : absl::OkStatus(); !status.ok()) return status;
  const absl::Status has_room = table_.make_room(evicted);
  note_evicted(evicted);
  if (!has_room.ok()) return has_room;
  auto job = std::make_shared<SessionJob>();
  job->id = id;
  job->owner = maker.owner;
  job->caller = maker.caller;
  job->options = options;
  job->files = std::move(files);
  job->waiters.add(waiter);
  job->is_made = is_made;
  if (cache_ != nullptr) cache_->reopen(id);
  if (!is_made && !cache_->holds(id)) job->may_make = [this, &unmade = *job] { return may_make_after_all(unmade); };
  if (absl::Status status = jobs_.start(job); !status.ok()) return status;
  const Mesh& mesh = *job->files.mesh;
  table_.insert({.info = {.id = id, .mesh_id = mesh.id, .options = options}, .job = job, .owner = maker.owner});
  log_->info("session {} created: mesh {} \"{}\", {} points, omega {}", id, mesh.id, printable(mesh.name), options.points,
             options.omega);
  return job;
}

void SessionStore::take_in_preview(const std::shared_ptr<SessionJob>& job, std::shared_ptr<const Session> preview) {
  {
    const MutexLock lock(mutex_);
    if (!is_current(*job)) return;
    log_->info("session {} has a preview after {:.3f} s: {} faces", job->id, seconds_since(job->created),
               preview->preprocessed.report.mesh.faces);
    table_.find(job->id)->preview = preview;
    job->waiters.preview(std::move(preview));
  }
  job->waiters.deliver();
}

bool SessionStore::is_current(const SessionJob& job) {
  const SessionTable::Entry* entry = table_.find(job.id);
  return !job.cancel && entry != nullptr && entry->job.get() == &job;
}

void SessionStore::replace(const std::shared_ptr<const Session>& preview,
                           const absl::StatusOr<std::shared_ptr<const Session>>& real) const {
  if (preview != nullptr && on_replaced_) on_replaced_(*preview, real);
}

void SessionStore::take_in(const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> made) {
  std::shared_ptr<const Session> preview;
  absl::StatusOr<std::shared_ptr<const Session>> real = absl::CancelledError();
  {
    const MutexLock lock(mutex_);
    if (!is_current(*job)) return;
    job->waiters.finish(made);
    if (made.ok()) {
      std::shared_ptr<const Session> session = *std::exchange(made, absl::CancelledError());
      if (cache_ != nullptr && !job->is_loaded) cache_->save(*session);
      const std::shared_ptr<const SurfaceCurve> curve = session->curve();
      log_->info("session {} {} after {:.3f} s: {} curve vertices, {} MiB", job->id,
                 job->is_loaded ? "loaded from the cache" : "ready", seconds_since(job->created), curve->size(),
                 curve->byte_size() >> 20);
      SessionTable::Entry& entry = *table_.use(job->id);
      entry.owner = session->owner;
      entry.info.session = std::move(session);
      entry.job = nullptr;
      preview = std::exchange(entry.preview, nullptr);
      if (preview != nullptr) real = entry.info.session;
    } else {
      log_->error("session {} failed after {:.3f} s: {}", job->id, seconds_since(job->created), made.status().ToString());
      preview = table_.take(job->id).preview;
      real = made.status();
    }
  }
  replace(preview, real);
  real = absl::CancelledError();  // a session that somebody refers to is not idle
  job->waiters.deliver();
}

bool SessionStore::leave(const std::string& id, SessionWaiter* waiter) {
  std::shared_ptr<SessionJob> job;
  {
    const MutexLock lock(mutex_);
    const SessionTable::Entry* entry = table_.find(id);
    if (entry == nullptr || entry->job == nullptr) return false;
    job = entry->job;
  }
  if (!job->waiters.remove(waiter)) return false;
  std::shared_ptr<const Session> preview;
  {
    const MutexLock lock(mutex_);
    const SessionTable::Entry* entry = table_.find(id);
    // Meanwhile the job may have ended, or somebody else may have joined it.
    if (entry != nullptr && entry->job == job && job->waiters.empty()) {
      log_->info("session {} cancelled: nobody waits for it any more", id);
      jobs_.cancel(*job);
      preview = table_.take(id).preview;
    }
  }
  replace(preview, absl::CancelledError(absl::StrCat("session ", id, " was given up: nobody waits for it any more")));
  return true;
}

bool SessionStore::may_see(const std::string& owner, const std::string& who) const {
  return !isolates_ || owner == who || owner == kOperator || who == kOperator;
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::find(const std::string& id, const std::string& who) {
  drop_damaged(id);
  return must_load(id) ? load(id, who) : find_here(id, who);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::find_for_views(const std::string& id, const std::string& who) {
  {
    const MutexLock lock(mutex_);
    const SessionTable::Entry* entry = table_.find(id);
    if (entry != nullptr && entry->preview != nullptr && may_see(entry->owner, who)) return entry->preview;
  }
  return find(id, who);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::find_here(const std::string& id, const std::string& who) {
  const MutexLock lock(mutex_);
  const SessionTable::Entry* entry = table_.find(id);
  if (entry == nullptr) return missing(id);
  if (!may_see(entry->owner, who)) return not_found(id);
  table_.use(id);
  if (entry->info.session == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("session ", id, " is still being preprocessed; join it with CreateSession and wait until it is ready"));
  }
  return entry->info.session;
}

absl::Status SessionStore::missing(const std::string& id) const {
  const absl::Status why = cache_ != nullptr ? cache_->why_missing(id) : absl::NotFoundError("");
  return absl::IsNotFound(why) ? not_found(id) : why;
}

absl::Status SessionStore::may_make_after_all(SessionJob& job) {
  if (absl::Status status = may_make_ ? may_make_(job.files, job.options) : absl::OkStatus(); !status.ok()) return status;
  const MutexLock lock(mutex_);
  absl::Status status = table_.may_make(job.caller);
  if (status.ok()) job.is_made = true;
  return status;
}

bool SessionStore::is_there(const std::string& id) {
  const MutexLock lock(mutex_);
  return table_.find(id) != nullptr || may_load(id);
}

bool SessionStore::is_here(const std::string& id) {
  const MutexLock lock(mutex_);
  return table_.find(id) != nullptr || cache_->holds(id);
}

bool SessionStore::must_load(const std::string& id) {
  const MutexLock lock(mutex_);
  const SessionTable::Entry* entry = table_.find(id);
  // Who does not care how it is made does not wait for a job that is to load it, either: that may be behind others.
  return (entry == nullptr || (entry->job != nullptr && !entry->job->is_made)) && may_load(id);
}

absl::StatusOr<std::shared_ptr<const Session>> SessionStore::load(const std::string& id, const std::string& who) {
  // Nobody pushes out what is in memory by asking for what is not his.
  if (isolates_ && !may_see(cache_->owner(id).value_or(""), who)) return not_found(id);
  // Who waits for the store does not hold up those who wait for the disk.
  if (!cache_->holds(id)) {
    if (absl::Status fetched = cache_->fetch(id); !fetched.ok()) return absl::IsNotFound(fetched) ? find_here(id, who) : fetched;
  }
  std::shared_ptr<SessionJob> job;
  absl::StatusOr<std::shared_ptr<const Session>> loaded = absl::CancelledError();
  {
    SessionTable::Sessions evicted;  // outlives the locks
    const MutexLock one_at_a_time(load_mutex_);
    if (!must_load(id)) return find_here(id, who);  // another thread was faster
    const Clock::time_point start = Clock::now();
    loaded = cache_->load(id);
    if (!loaded.ok()) return absl::IsUnavailable(loaded.status()) ? loaded : find_here(id, who);
    const MutexLock lock(mutex_);
    if (!cache_->holds(id)) return not_found(id);  // it was closed meanwhile
    if (const SessionTable::Entry* entry = table_.find(id)) {
      job = entry->job;
    } else {
      const absl::Status has_room = table_.make_room(evicted);
      note_evicted(evicted);
      if (!has_room.ok()) return has_room;
      const Session& session = **loaded;
      table_.insert({.info = {.id = id, .mesh_id = session.mesh_id, .options = session.options, .session = *loaded},
                     .owner = session.owner});
      log_->info("session {} loaded from the cache in {:.3f} s", id, seconds_since(start));
    }
  }
  if (job != nullptr) {  // it was to load the session, for those who have joined it
    job->is_loaded = true;
    take_in(job, loaded);
    jobs_.cancel(*job);
  }
  const absl::StatusOr<std::shared_ptr<const Session>> held = find_here(id, who);  // a job's own, if that was faster
  return held.ok() ? held : loaded;
}

absl::StatusOr<SessionInfo> SessionStore::info(const std::string& id, const std::string& who) {
  const MutexLock lock(mutex_);
  const SessionTable::Entry* entry = table_.find(id);
  if (entry == nullptr) return missing(id);
  if (!may_see(entry->owner, who)) return not_found(id);
  if (cache_ != nullptr && entry->job == nullptr) cache_->watch({id}, kWatchUsed);
  return SessionTable::info_of(*entry);
}

std::vector<SessionInfo> SessionStore::list(const std::string& after, std::size_t most, const std::string& who) {
  const MutexLock lock(mutex_);
  return table_.list(after, most, [&](const SessionTable::Entry& entry) { return may_see(entry.owner, who); });
}

absl::StatusOr<SessionInfo> SessionStore::update(const std::string& id, std::optional<bool> pinned,
                                                 std::optional<double> time_to_live, const std::string& who) {
  const absl::StatusOr<std::shared_ptr<const Session>> ready = find(id, who);
  if (!ready.ok()) return ready.status();
  if (absl::Status status = check_owner(id, who); !status.ok()) return status;
  const MutexLock lock(mutex_);
  SessionTable::Entry* entry = table_.find(id);
  if (entry == nullptr) return not_found(id);
  SessionInfo& info = entry->info;
  if (pinned.value_or(false) && !info.pinned) {
    if (absl::Status status = table_.may_pin(**ready); !status.ok()) return status;
  }
  info.pinned = pinned.value_or(info.pinned);
  info.time_to_live = time_to_live.value_or(info.time_to_live);
  log_->info("session {}: {}pinned, time to live {} s", id, info.pinned ? "" : "not ", info.time_to_live);
  return SessionTable::info_of(*entry);
}

std::vector<std::string> SessionStore::run_housekeeping(Clock::time_point now) {
  SessionTable::Sessions expired, evicted;  // outlive the lock
  std::vector<std::string> used, held;
  {
    const MutexLock lock(mutex_);
    expired = table_.take_unused(now);
    evicted = table_.evict_excess();
    note_evicted(evicted);
    used = table_.used_since(std::exchange(kept_house_, now));
    for (const SessionInfo& info : table_.list()) held.push_back(info.id);
  }
  if (cache_ != nullptr) {
    for (const std::string& id : used) cache_->touch(id);
    cache_->watch(used, kWatchUsed);
    cache_->watch(held, kWatchHeld);
    for (const std::string& id : held) drop_closed(id);
    for (const std::string& id : held) drop_damaged(id);
  }
  std::vector<std::string> ids;
  for (const auto& session : expired) {
    log_->info("session {} forgotten: not used for its time to live", session->id);
    ids.push_back(session->id);
  }
  return ids;
}

void SessionStore::drop_closed(const std::string& id) {
  if (cache_ == nullptr || !cache_->is_closed(id)) return;
  SessionTable::Entry dropped;  // outlives the lock
  const MutexLock lock(mutex_);
  const SessionTable::Entry* entry = table_.find(id);
  // One that is being made was asked for after the other was closed.
  if (entry == nullptr || entry->job != nullptr) return;
  dropped = table_.take(id);
  log_->info("session {} forgotten: another server has closed it", id);
}

void SessionStore::drop_damaged(const std::string& id) {
  SessionTable::Entry dropped;  // outlives the lock
  const MutexLock lock(mutex_);
  const SessionTable::Entry* entry = table_.find(id);
  if (entry == nullptr || entry->info.session == nullptr) return;
  const absl::Status status = entry->info.session->status();
  if (status.ok()) return;
  dropped = table_.take(id);
  // Under the lock: what is saved later is of one that was made anew.
  if (cache_ != nullptr) cache_->remove_damaged(id);
  log_->error("session {} forgotten, and removed from the cache: {}", id, std::string(status.message()));
}

absl::Status SessionStore::check(const Session& session) {
  const absl::Status status = session.status();
  if (status.ok()) return status;
  drop_damaged(session.id);
  return absl::DataLossError(absl::StrCat("session ", session.id, " is damaged; create it again: ", status.message()));
}

absl::Status SessionStore::check_owner(const std::string& id, const std::string& who) {
  absl::StatusOr<std::string> owner = cache_ != nullptr ? cache_->owner(id) : absl::NotFoundError("there is no cache");
  if (absl::IsNotFound(owner.status())) {
    const MutexLock lock(mutex_);
    const SessionTable::Entry* entry = table_.find(id);
    owner = entry != nullptr ? entry->owner : std::string();
  }
  if (!owner.ok()) return owner.status();
  if (!may_see(*owner, who)) return not_found(id);
  return owner->empty() || *owner == who ? absl::OkStatus() : not_yours(id);
}

std::uint64_t SessionStore::memory_bytes() {
  const MutexLock lock(mutex_);
  return table_.memory_bytes();
}

void SessionStore::make_room(std::uint64_t bytes) {
  SessionTable::Sessions evicted;  // outlives the lock
  const MutexLock lock(mutex_);
  evicted = table_.evict_bytes(bytes);
  note_evicted(evicted);
}

void SessionStore::save(const Session& session) {
  const MutexLock lock(mutex_);  // close() comes wholly before or after
  const SessionTable::Entry* entry = table_.find(session.id);
  if (entry == nullptr || entry->info.session == nullptr || entry->info.session->revisions != session.revisions) return;
  if (cache_ != nullptr) cache_->save(session);
}

absl::Status SessionStore::close(const std::string& id, const std::string& who) {
  const absl::Status was_closed = absl::AbortedError(absl::StrCat("session ", id, " was closed before it was ready"));
  if (absl::Status status = check_owner(id, who); !status.ok()) return status;
  if (cache_ != nullptr && cache_->is_shared()) {
    if (!is_here(id)) return not_found(id);
    if (absl::Status status = cache_->close_for_all(id); !status.ok()) return status;
  }
  SessionTable::Entry closed;  // outlives the lock
  {
    const MutexLock lock(mutex_);
    const SessionTable::Entry* entry = table_.find(id);
    const bool was_cached = cache_ != nullptr && cache_->remove(id);
    if (entry == nullptr && !was_cached) return not_found(id);
    if (entry != nullptr) closed = table_.take(id);
    log_->info("session {} closed", id);
    if (closed.job != nullptr) {
      closed.job->waiters.finish(was_closed);
      jobs_.cancel(*closed.job);
    }
  }
  if (cache_ != nullptr) cache_->wait_until_removed(id);
  if (closed.job != nullptr) closed.job->waiters.deliver();
  replace(closed.preview, was_closed);
  return absl::OkStatus();
}

void SessionStore::note_evicted(const SessionTable::Sessions& evicted) {
  evicted_ += evicted.size();
  for (const auto& session : evicted) {
    log_->info("session {} evicted: not used for longest", session->id);
    if (cache_ != nullptr) cache_->let_go(session->id);
  }
}

}  // namespace curvecast::server
