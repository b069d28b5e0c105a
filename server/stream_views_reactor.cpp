// StreamViews: carries a ClientStream over gRPC.
#include <grpcpp/alarm.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <utility>

#include "server/caller.h"
#include "server/client_stream.h"
#include "server/grpc_status.h"
#include "server/guarded.h"
#include "server/rate_limit.h"
#include "server/reactors.h"
#include "server/request_log.h"
#include "server/view_tally.h"

namespace curvecast::server {
namespace {

class StreamViewsReactor final : public grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>,
                                 public ClientStream::Transport {
 public:
  StreamViewsReactor(Engine& engine, grpc::CallbackServerContext& context)
      : engine_(engine), log_(engine, "StreamViews", context), tally_(engine.metrics), rate_(engine.max_view_rate) {
    const absl::Status begun = begin(context);
    if (begun.ok()) {
      read_next();
    } else {
      end(begun);
    }
  }

 private:
  absl::Status begin(const grpc::CallbackServerContext& context) {
    const absl::StatusOr<std::string> caller = caller_of(engine_, context);
    if (!caller.ok()) return caller.status();
    absl::StatusOr<Admission::Ticket> ticket = engine_.streams->admit(*caller);
    if (!ticket.ok()) return ticket.status();
    ticket_.emplace(*std::move(ticket));
    auto stream = engine_.make_stream(this, context.peer());
    if (stream.ok()) stream_ = *std::move(stream);
    return stream.status();
  }

  void send(v1::StreamViewsResponse response) override {
    response_ = std::move(response);
    tally_.answered(response_.frame().sequence());
    engine_.metrics.frame(response_.frame());
    StartWrite(&response_);
  }

  void end(const absl::Status& status) override {
    {
      const std::lock_guard lock(mutex_);
      ended_ = status;
      if (waiting_) alarm_.Cancel();
      if (loading_ || waiting_) return;  // whoever loads or waits finishes: until then, the reactor stays
    }
    finish(status);
  }

  void finish(const absl::Status& status) {
    log_.finish(to_grpc(status));
    Finish(to_grpc(status));
  }

  void OnReadDone(bool ok) override {
    if (!ok) return stream_->half_close();
    if (request_.has_view()) tally_.received(request_.view().sequence());
    if (request_.has_open() && load_first()) return;
    stream_->receive(request_);
    const RateLimit::Clock::duration wait = rate_.take(RateLimit::Clock::now());
    if (wait <= RateLimit::Clock::duration::zero()) return read_next();
    // Not reading is what slows the client down: its messages wait with itself.
    const std::lock_guard lock(mutex_);
    if (ended_) return;
    waiting_ = true;
    alarm_.Set(std::chrono::system_clock::now() + wait, [this](bool) { go_on(waiting_); });
  }

  /// Has a session that is only in the cache loaded before the stream hears of it, by a thread that may wait for the disk. False
  /// when there is no need for it.
  bool load_first() {
    if (!engine_.sessions.must_load(request_.open().session_id())) return false;
    {
      const std::lock_guard lock(mutex_);
      if (ended_) return false;
      loading_ = true;
    }
    const auto submitted = engine_.cache->loading().submit([this] {
      const auto held = guarded([this] { return engine_.sessions.find(request_.open().session_id()); });
      stream_->receive(request_);  // finds it in memory, or an error
      go_on(loading_);
    });
    if (!submitted.ok()) {
      stream_->stop(submitted.status());
      go_on(loading_);
    }
    return true;
  }

  /// Reads on after a pause, of which `flag` tells; or finishes what has ended meanwhile.
  void go_on(bool& flag) {
    std::optional<absl::Status> ended;
    {
      const std::lock_guard lock(mutex_);
      flag = false;
      ended = ended_;
      if (!ended) StartRead(&request_);
    }
    if (ended) finish(*ended);
  }

  void OnWriteDone(bool ok) override { stream_->sent(ok); }
  void OnCancel() override {
    if (stream_ != nullptr) stream_->stop(absl::CancelledError("the client has gone"));
  }
  void OnDone() override { delete this; }

  // No operation may start once Finish has been called.
  void read_next() {
    const std::lock_guard lock(mutex_);
    if (!ended_) StartRead(&request_);
  }

  Engine& engine_;
  RequestLog log_;
  ViewTally tally_;
  std::shared_ptr<ClientStream> stream_;
  v1::StreamViewsRequest request_;
  v1::StreamViewsResponse response_;
  std::mutex mutex_;
  std::optional<absl::Status> ended_;       // no operation may start any more
  bool loading_ = false, waiting_ = false;  // nothing is read meanwhile
  RateLimit rate_;
  grpc::Alarm alarm_;
  std::optional<Admission::Ticket> ticket_;
};

}  // namespace

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* stream_views(Engine& engine,
                                                                                       grpc::CallbackServerContext& context) {
  return new StreamViewsReactor(engine, context);
}

}  // namespace curvecast::server
