// Calls of the API within this process for one client, one after the other.
#pragma once

#include <absl/status/status.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "core/base/mutex.h"
#include "curvecast/v1/curvecast.grpc.pb.h"
#include "server/engine/caller.h"

namespace curvecast::server {

/// Who makes a call keeps this until the call is over. cancel() and end() are thread-safe.
class ApiCalls {
 public:
  /// `channel` leads to this process, and sends Engine::own_key. `request_id`: of the client's request, for the log; may be
  /// empty.
  ApiCalls(const std::shared_ptr<grpc::Channel>& channel, Peer peer, std::string request_id);

  v1::CurvecastService::Stub& stub() const { return *stub_; }
  /// The context of the next call.
  grpc::ClientContext* introduced() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Cancels the call that there is.
  void cancel() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Cancels that and all to come.
  void end() ABSL_LOCKS_EXCLUDED(mutex_);
  const std::atomic<bool>& ended() const { return ended_; }

  /// Makes a call of one request and one response, and hands both to `then`, which keeps what has to be kept until then.
  template <class Request, class Response>
  void call(void (v1::CurvecastService::StubInterface::async_interface::*method)(grpc::ClientContext*, const Request*, Response*,
                                                                                 std::function<void(grpc::Status)>),
            Request request, std::function<void(const grpc::Status&, Response)> then) {
    const auto messages = std::make_shared<std::pair<Request, Response>>(std::move(request), Response());
    (stub_->async()->*method)(
        introduced(), &messages->first, &messages->second,
        [messages, then = std::move(then)](const grpc::Status& status) { then(status, std::move(messages->second)); });
  }

 private:
  const std::unique_ptr<v1::CurvecastService::Stub> stub_;
  const Peer peer_;
  const std::string request_id_;
  std::atomic<bool> ended_ = false;
  Mutex mutex_;
  std::unique_ptr<grpc::ClientContext> context_ ABSL_GUARDED_BY(mutex_);
};

/// A call with many responses. Deletes itself when it is over.
template <class Response>
class ApiReadCall final : public grpc::ClientReadReactor<Response> {
 public:
  /// `take` is called with each response; once it returns an error the call is cancelled, and ends with that. `done` is called
  /// last. `calls` has to be what the call was introduced by.
  using Take = std::function<absl::Status(Response)>;
  using Done = std::function<void(const absl::Status& refused, const grpc::Status&)>;
  ApiReadCall(std::shared_ptr<ApiCalls> calls, Take take, Done done)
      : calls_(std::move(calls)), take_(std::move(take)), done_(std::move(done)) {}

  void start() {
    this->StartRead(&response_);
    this->StartCall();
  }

 private:
  void OnReadDone(bool ok) override {
    if (!ok) return;
    try {
      if (refused_.ok()) refused_ = take_(std::exchange(response_, {}));
    } catch (const std::exception&) {  // bad_alloc
      refused_ = absl::ResourceExhaustedError("there is no memory for the answer");
    }
    if (!refused_.ok()) calls_->cancel();
    this->StartRead(&response_);
  }

  void OnDone(const grpc::Status& status) override {
    const std::unique_ptr<ApiReadCall> self(this);
    done_(refused_, status);
  }

  const std::shared_ptr<ApiCalls> calls_;
  const Take take_;
  const Done done_;
  Response response_;
  absl::Status refused_;
};

}  // namespace curvecast::server
