// A request for a resource, answered by calls of the API within this process for the client who asks.
#pragma once

#include <absl/status/status.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "curvecast/v1/curvecast.grpc.pb.h"
#include "server/base/admission.h"
#include "server/engine/engine.h"
#include "server/web/web_exchange.h"

namespace curvecast::server {

/// What all requests for resources have. Its calls, which it makes one after the other, hold it; they are cancelled when the
/// client goes. Thread-safe, but for its calls.
class WebResource : public std::enable_shared_from_this<WebResource> {
 public:
  /// The parts of a query, decoded.
  using Query = std::vector<std::pair<std::string, std::string>>;
  using Fields = std::vector<std::pair<std::string, std::string>>;

  /// `channel` leads to this process, and sends Engine::own_key. `fields`: for the header of every answer. `ticket`: kept as long
  /// as this.
  WebResource(Engine& engine, const std::shared_ptr<grpc::Channel>& channel, std::shared_ptr<WebExchange> exchange, Caller caller,
              Query query, Fields fields, Admission::Ticket ticket);

  /// Has the calls cancelled when the client goes. To be called first.
  void watch();

  Engine& engine() const { return engine_; }
  const WebRequest& request() const { return exchange_->request(); }
  const Query& query() const { return query_; }
  const Caller& caller() const { return caller_; }
  v1::CurvecastService::Stub& stub() const { return *stub_; }
  /// Whether the client has gone.
  const std::atomic<bool>& gone() const { return gone_; }

  /// Reads on in the body, as WebExchange::read_body().
  void read_body(WebExchange::Take take) { exchange_->read_body(std::move(take)); }
  void answer(WebAnswer answer);
  void fail(const absl::Status& status);
  /// `http_status`: 0 for the one that goes with the status.
  void fail(const grpc::Status& status, int http_status = 0);
  /// The context of the next call.
  grpc::ClientContext* introduced();
  /// Cancels the call that there is.
  void cancel();

  /// Makes a call of one request and one response, and hands that to `then`; what fails is the answer.
  template <class Request, class Response, class Then>
  void call(void (v1::CurvecastService::StubInterface::async_interface::*method)(grpc::ClientContext*, const Request*, Response*,
                                                                                 std::function<void(grpc::Status)>),
            Request request, Then then) {
    const auto messages = std::make_shared<std::pair<Request, Response>>(std::move(request), Response());
    (stub_->async()->*method)(introduced(), &messages->first, &messages->second,
                              [self = shared_from_this(), messages, then = std::move(then)](const grpc::Status& status) {
                                if (!status.ok()) return self->fail(status);
                                then(std::move(messages->second));
                              });
  }

 private:
  Engine& engine_;
  const std::unique_ptr<v1::CurvecastService::Stub> stub_;
  const std::shared_ptr<WebExchange> exchange_;
  const Caller caller_;
  const Query query_;
  const Fields fields_;
  const Admission::Ticket ticket_;
  std::atomic<bool> gone_ = false;
  Mutex mutex_;
  std::unique_ptr<grpc::ClientContext> context_ ABSL_GUARDED_BY(mutex_);
};

/// A call with many responses. Deletes itself when it is over.
template <class Response>
class WebReadCall final : public grpc::ClientReadReactor<Response> {
 public:
  /// `take` is called with each response; once it returns an error the call is cancelled, and ends with that. `done` is called
  /// last.
  using Take = std::function<absl::Status(Response)>;
  using Done = std::function<void(const absl::Status& refused, const grpc::Status&)>;
  WebReadCall(std::shared_ptr<WebResource> resource, Take take, Done done)
      : resource_(std::move(resource)), take_(std::move(take)), done_(std::move(done)) {}

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
    if (!refused_.ok()) resource_->cancel();
    this->StartRead(&response_);
  }

  void OnDone(const grpc::Status& status) override {
    const std::unique_ptr<WebReadCall> self(this);
    done_(refused_, status);
  }

  const std::shared_ptr<WebResource> resource_;
  const Take take_;
  const Done done_;
  Response response_;
  absl::Status refused_;
};

}  // namespace curvecast::server
