// A reactor that sends messages made by other threads, in order, without ever blocking them.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/caller.h"
#include "server/engine/engine.h"
#include "server/engine/request_log.h"
#include "server/grpc/watched_messages.h"

namespace curvecast::server {

/// Thread-safe. The maker of the messages calls push() and, exactly once, finish(), after which it must not touch the reactor:
/// gRPC may have deleted it.
template <class Response>
class WriteQueue : public grpc::ServerWriteReactor<Response> {
 public:
  /// The engine counts the messages that wait, and ends the call where its client does not read them.
  WriteQueue(const char* method, Engine& engine, grpc::CallbackServerContext& context, const Caller& caller)
      : log_(engine, method, context, caller), queued_(engine.queued), sends_(engine.sends, context), caller_(caller) {}
  ~WriteQueue() override {
    const MutexLock lock(mutex_);
    queued_.add(caller_.name, -waiting_);
  }

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 protected:
  /// Begins the call: where `work` returns an error, or throws, that is its end.
  template <typename Work>
  void begin_with(const Work& work) {
    if (const absl::Status begun = status_from_exceptions(work); !begun.ok()) finish(to_grpc(begun));
  }

  /// As begin_with(), for work that looks meshes up: where that may wait for a store, by a thread that may. The call does not end
  /// before the work has returned.
  template <typename Work>
  void begin_with_meshes(Engine& engine, const Work& work) ABSL_LOCKS_EXCLUDED(mutex_) {
    if (!engine.meshes.is_shared()) return begin_with(work);
    {
      const MutexLock lock(mutex_);
      beginning_ = true;
    }
    const auto submitted = engine.cache->fetching().submit(
        [this, work] {
          begin_with(work);
          end_beginning();
        },
        caller_.name);
    if (submitted.ok()) return;
    finish(to_grpc(submitted.status()));
    end_beginning();
  }

  /// Queues a message; dropped once the client has gone.
  void push(Response message) ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    if (cancelled()) return;
    if (!queue_.empty() && replaces(message, queue_.back())) {
      count(-bytes_of(queue_.back()));
      queue_.pop_back();
    }
    count(bytes_of(message));
    queue_.push_back(std::move(message));
    write_next();
  }

  /// Queues how far a stage is, for responses that tell of progress.
  void push_progress(std::string_view stage, double fraction) ABSL_LOCKS_EXCLUDED(mutex_) {
    Response response;
    response.mutable_progress()->set_stage(std::string(stage));
    response.mutable_progress()->set_fraction(fraction);
    push(std::move(response));
  }

  /// Queues what `make` makes, as long as the client has not gone and not too much waits for clients to read it. `make` gets the
  /// function that takes each message, which returns false when no more are wanted, and returns how it ended.
  template <typename Make>
  absl::Status push_all(Make&& make) {
    absl::Status refused;
    const absl::Status made = make([&](Response message) {
      refused = cancelled() ? absl::CancelledError("the client has gone") : queued_.check(caller_.name);
      if (refused.ok()) push(std::move(message));
      return refused.ok();
    });
    return refused.ok() ? made : refused;
  }

  /// The end, after all messages queued; at once when the client has gone.
  void finish(grpc::Status status) ABSL_LOCKS_EXCLUDED(mutex_) {
    std::optional<grpc::Status> ended;
    {
      const MutexLock lock(mutex_);
      status_ = std::move(status);
      ended = take_end();
    }
    // Else the thread that ends the call may have deleted the reactor by now.
    if (ended) finish_now(*ended);
  }

  void OnCancel() override { cancelled_ = true; }

  /// Set once the client has gone.
  const std::atomic<bool>& cancel_flag() const { return cancelled_; }
  const Caller& caller() const { return caller_; }
  /// On the workers.
  JobQueue::Claim claim(JobQueue::Nanoseconds expected = {}) const {
    return {.caller = caller_.name, .connection = caller_.address, .expected = expected};
  }

 private:
  /// Whether the older message, which still waits, is not worth sending any more. Called with the queue locked.
  virtual bool replaces(const Response& /*newer*/, const Response& /*older*/) const { return false; }

  void OnWriteDone(bool ok) final {
    std::optional<grpc::Status> ended;
    {
      const MutexLock lock(mutex_);
      writing_ = false;
      sends_.done();
      count(-bytes_of(current_));
      if (!ok) cancelled_ = true;
      if (cancelled()) {
        queue_.clear();
        count(-waiting_);
      }
      write_next();
      ended = take_end();
    }
    if (ended) finish_now(*ended);
  }

  void OnDone() final { delete this; }

  void end_beginning() ABSL_LOCKS_EXCLUDED(mutex_) {
    std::optional<grpc::Status> ended;
    {
      const MutexLock lock(mutex_);
      beginning_ = false;
      ended = take_end();
    }
    if (ended) finish_now(*ended);
  }

  static std::int64_t bytes_of(const Response& message) { return static_cast<std::int64_t>(message.ByteSizeLong()); }
  void count(std::int64_t bytes) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    waiting_ += bytes;
    queued_.add(caller_.name, bytes);
  }

  void write_next() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || queue_.empty()) return;
    writing_ = true;
    current_ = std::move(queue_.front());
    queue_.pop_front();
    sends_.begin();
    this->StartWrite(&current_);
  }

  /// The status to end with, once: where it is known, all messages have been written, and the beginning is over.
  std::optional<grpc::Status> take_end() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (writing_ || beginning_) return std::nullopt;
    return std::exchange(status_, std::nullopt);
  }

  /// Without the lock, for the reactor may be gone before Finish() returns.
  void finish_now(const grpc::Status& status) ABSL_LOCKS_EXCLUDED(mutex_) {
    const grpc::Status ended = sends_.end_of(status);
    log_.finish(ended);
    this->Finish(ended);
  }

  RequestLog log_;
  QueuedBytes& queued_;
  WatchedMessages sends_;
  const Caller caller_;
  std::atomic<bool> cancelled_ = false;
  Mutex mutex_;
  std::int64_t waiting_ ABSL_GUARDED_BY(mutex_) = 0;  // bytes of the queue and of the message being written
  std::deque<Response> queue_ ABSL_GUARDED_BY(mutex_);
  Response current_ ABSL_GUARDED_BY(mutex_);  // being written
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool beginning_ ABSL_GUARDED_BY(mutex_) = false;              // on another thread
  std::optional<grpc::Status> status_ ABSL_GUARDED_BY(mutex_);  // set between finish() and Finish()
};

}  // namespace curvecast::server
