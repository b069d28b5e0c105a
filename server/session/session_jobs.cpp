#include "server/session/session_jobs.h"

#include <utility>

#include "server/base/status_from_exceptions.h"
#include "server/session/expected_time.h"

namespace curvecast::server {
namespace {

void report(SessionJob& job, std::string_view stage, double fraction) {
  if (job.cancel) return;
  job.waiters.progress(stage, fraction);
  job.waiters.deliver();
}

std::shared_ptr<Session> make_session(const SessionJob& job, Preprocessed preprocessed) {
  auto session = std::make_shared<Session>();
  session->id = job.id;
  session->mesh_id = job.files.mesh->id;
  session->mesh_name = job.files.mesh->name;
  session->owner = job.owner;
  for (const auto& [name, file] : job.files.companions) session->companions[name] = file->id;
  session->options = job.options;
  session->surface = std::make_shared<SessionSurface>(std::exchange(preprocessed.flattened, nullptr));
  session->preprocessed = std::move(preprocessed);
  session->revisions->publish(std::move(session->preprocessed.curve));
  session->peak_bytes = peak_memory_bytes();
  return session;
}

}  // namespace

SessionJobs::SessionJobs(JobQueue& queue, Preprocess preprocess, int threads, SessionCache* cache, MakingMarks* marks,
                         GetMemory get_memory, OnStandIn on_stand_in, OnOver on_over)
    : queue_(queue),
      preprocess_(std::move(preprocess)),
      threads_(threads),
      cache_(cache),
      marks_(marks),
      get_memory_(std::move(get_memory)),
      on_stand_in_(std::move(on_stand_in)),
      on_over_(std::move(on_over)) {}

SessionJobs::~SessionJobs() {
  const MutexLock lock(mutex_);
  while (!places_.empty()) idle_.wait(mutex_);
}

absl::Status SessionJobs::start(const std::shared_ptr<SessionJob>& job) {
  const MutexLock lock(mutex_);  // the job, which may run at once, is not over before its place is known
  return job->is_made ? submit_preprocessing(job) : submit_load(job);
}

absl::Status SessionJobs::submit_load(const std::shared_ptr<SessionJob>& job) {
  JobQueue& queue = cache_->loading(job->id);
  const absl::StatusOr<std::uint64_t> ticket = queue.submit([this, job] { load(job); }, job->caller);
  if (ticket.ok()) places_[job.get()] = {&queue, *ticket};
  return ticket.status();
}

absl::Status SessionJobs::submit_preprocessing(const std::shared_ptr<SessionJob>& job) {
  const absl::StatusOr<std::uint64_t> ticket =
      queue_.submit([this, job] { preprocess(job); },
                    {.caller = job->caller, .expected = expected_time(job->files.mesh->size(), job->options)});
  if (ticket.ok()) places_[job.get()] = {&queue_, *ticket};
  return ticket.status();
}

void SessionJobs::cancel(SessionJob& job) {
  const MutexLock lock(mutex_);
  job.cancel = true;
  const auto place = places_.find(&job);
  if (place == places_.end() || !place->second.queue->withdraw(place->second.ticket)) return;
  places_.erase(place);
  idle_.notify_all();
}

void SessionJobs::load(const std::shared_ptr<SessionJob>& job) {
  report(*job, "load", 0);
  absl::StatusOr<std::shared_ptr<const Session>> loaded = absl::CancelledError("cancelled");
  if (!job->cancel) loaded = cache_->load(job->id);
  if (!loaded.ok()) {
    report(*job, "load", 1);
    report(*job, "queued", 0);
    const absl::Status submitted = fall_back(job);
    if (submitted.ok()) return;
    loaded = submitted;
  }
  job->is_loaded = loaded.ok();
  finish(job, std::move(loaded));
}

absl::Status SessionJobs::fall_back(const std::shared_ptr<SessionJob>& job) {
  if (absl::Status may = job->may_make ? job->may_make() : absl::OkStatus(); !may.ok()) return may;
  job->is_made = true;
  const MutexLock lock(mutex_);
  return job->cancel ? absl::CancelledError("cancelled") : submit_preprocessing(job);
}

void SessionJobs::preprocess(const std::shared_ptr<SessionJob>& job) {
  absl::StatusOr<std::shared_ptr<const Session>> result = absl::CancelledError("cancelled");
  // Outlives finish(): until the session counts as held, the job answers for what it takes.
  const std::unique_ptr<MemorySource> memory = get_memory_ ? get_memory_(&job->cancel) : nullptr;
  if (!job->cancel) {
    job->has_begun = true;
    report(*job, "queued", 1);
    const absl::Status may_begin = marks_ != nullptr ? marks_->begin(job->id) : absl::OkStatus();
    result = may_begin.ok() ? make(job, memory.get()) : may_begin;
    if (marks_ != nullptr) marks_->end(job->id);
  }
  finish(job, std::move(result));
}

absl::StatusOr<std::shared_ptr<const Session>> SessionJobs::make(const std::shared_ptr<SessionJob>& job, MemorySource* memory) {
  ExecutionContext context;
  context.on_progress = [&](std::string_view stage, double fraction) {
    if (stage == "read" && fraction >= 1) job->files.release_pages();
    report(*job, stage, fraction);
  };
  context.cancel = &job->cancel;
  context.threads = threads_;
  context.memory = memory;
  const OnPreview on_preview = [&](const MakePreview& make_preview) {
    if (!job->waiters.want_preview()) return;
    absl::StatusOr<Preprocessed> coarse = make_preview();
    if (!coarse.ok()) return;
    const std::shared_ptr<Session> preview = make_session(*job, *std::move(coarse));
    preview->is_preview = true;
    // Now, as below: views would share the cores with all that follows.
    (void)status_from_exceptions(
        [&] { return preview->ranks({.on_progress = {}, .cancel = &job->cancel, .threads = threads_}); });
    on_stand_in_(job, preview);
  };
  absl::StatusOr<Preprocessed> made = status_from_exceptions([&]() -> absl::StatusOr<Preprocessed> {
    const absl::StatusOr<MeshFile> file = job->files.file(context);
    if (!file.ok()) return file.status();
    absl::StatusOr<Preprocessed> preprocessed = preprocess_(*file, job->options, context, on_preview);
    if (absl::Status status = job->files.status(); !status.ok()) return status;
    return preprocessed;
  });
  if (!made.ok()) return made.status();
  const std::shared_ptr<const Session> session = make_session(*job, *std::move(made));
  // Now, with all threads, not when the first view waits for them. Where that fails the view will be told why.
  (void)status_from_exceptions([&] { return session->ranks(context); });
  return session;
}

void SessionJobs::finish(const std::shared_ptr<SessionJob>& job, absl::StatusOr<std::shared_ptr<const Session>> session) {
  if (!job->cancel) on_over_(job, std::move(session));
  const MutexLock lock(mutex_);
  places_.erase(job.get());
  idle_.notify_all();
}

}  // namespace curvecast::server
