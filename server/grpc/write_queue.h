// A reactor that sends messages made by other threads, in order, without ever blocking them.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

#include "server/base/queued_bytes.h"
#include "server/engine/request_log.h"

namespace curvecast::server {

/// Thread-safe. push() and finish() are called by whoever makes the messages; after its call of finish(), which is made exactly
/// once, it must not touch the reactor: gRPC may have deleted it.
template <class Response>
class WriteQueue : public grpc::ServerWriteReactor<Response> {
 public:
  /// `queued` counts the messages that wait.
  WriteQueue(RequestLog log, QueuedBytes& queued) : log_(std::move(log)), queued_(queued) {}
  ~WriteQueue() override { queued_.add(-waiting_); }

  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 protected:
  /// Queues a message; dropped once the client has gone.
  void push(Response message) {
    const std::lock_guard lock(mutex_);
    if (cancelled()) return;
    if (!queue_.empty() && replaces(message, queue_.back())) {
      count(-bytes_of(queue_.back()));
      queue_.pop_back();
    }
    count(bytes_of(message));
    queue_.push_back(std::move(message));
    write_next();
  }

  /// Queues what `make` makes, as long as the client has not gone and not too much waits for clients to read it. `make` is given
  /// the function that takes each message, false: no more of them, and returns how it ended.
  template <typename Make>
  absl::Status push_all(Make&& make) {
    absl::Status refused;
    const absl::Status made = make([&](Response message) {
      refused = cancelled() ? absl::CancelledError("the client has gone") : queued_.check();
      if (refused.ok()) push(std::move(message));
      return refused.ok();
    });
    return refused.ok() ? made : refused;
  }

  /// The end, after all messages queued; at once when the client has gone.
  void finish(grpc::Status status) {
    std::unique_lock lock(mutex_);
    status_ = std::move(status);
    finish_when_idle(std::move(lock));
  }

  void OnCancel() override { cancelled_ = true; }

  /// Set once the client has gone.
  const std::atomic<bool>& cancel_flag() const { return cancelled_; }

 private:
  /// Whether the older message, which still waits, is not worth sending any more. Called with the queue locked.
  virtual bool replaces(const Response& /*newer*/, const Response& /*older*/) const { return false; }

  void OnWriteDone(bool ok) final {
    std::unique_lock lock(mutex_);
    writing_ = false;
    count(-bytes_of(current_));
    if (!ok) cancelled_ = true;
    if (cancelled()) {
      queue_.clear();
      count(-waiting_);
    }
    write_next();
    finish_when_idle(std::move(lock));
  }

  void OnDone() final { delete this; }

  static std::int64_t bytes_of(const Response& message) { return static_cast<std::int64_t>(message.ByteSizeLong()); }
  void count(std::int64_t bytes) {
    waiting_ += bytes;
    queued_.add(bytes);
  }

  void write_next() {
    if (writing_ || queue_.empty()) return;
    writing_ = true;
    current_ = std::move(queue_.front());
    queue_.pop_front();
    this->StartWrite(&current_);
  }

  void finish_when_idle(std::unique_lock<std::mutex> lock) {
    if (writing_ || !status_) return;
    const grpc::Status status = *std::exchange(status_, std::nullopt);
    log_.finish(status);
    lock.unlock();  // before Finish, for the reactor may be gone before it returns
    this->Finish(status);
  }

  RequestLog log_;
  QueuedBytes& queued_;
  std::int64_t waiting_ = 0;  // bytes of the queue and of the message being written
  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::deque<Response> queue_;
  Response current_;  // being written
  bool writing_ = false;
  std::optional<grpc::Status> status_;  // set between finish() and Finish()
};

}  // namespace curvecast::server
