// A request for a resource, answered by calls of the API within this process for the client who asks.
#pragma once

#include <absl/status/status.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/mutex.h"
#include "server/base/admission.h"
#include "server/engine/engine.h"
#include "server/web/resources/api_calls.h"
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
  /// Has `lost` called once, too, when the client goes, or at once where it has gone. Replaces what was given before.
  void on_gone(std::function<void()> lost) ABSL_LOCKS_EXCLUDED(mutex_);

  Engine& engine() const { return engine_; }
  const WebRequest& request() const { return exchange_->request(); }
  const Query& query() const { return query_; }
  const Caller& caller() const { return caller_; }
  v1::CurvecastService::Stub& stub() const { return calls_.stub(); }
  /// Its calls, which keep it.
  std::shared_ptr<ApiCalls> calls() { return {shared_from_this(), &calls_}; }
  /// Whether the client has gone.
  const std::atomic<bool>& gone() const { return calls_.ended(); }

  /// Reads on in the body, as WebExchange::read_body().
  void read_body(WebExchange::Take take) { exchange_->read_body(std::move(take)); }
  void answer(WebAnswer answer);
  void fail(const absl::Status& status);
  /// `http_status`: 0 for the one that goes with the status.
  void fail(const grpc::Status& status, int http_status = 0);
  /// The context of the next call.
  grpc::ClientContext* introduced() { return calls_.introduced(); }
  /// Cancels the call that there is.
  void cancel() { calls_.cancel(); }

  /// Makes a call of one request and one response, and hands that to `then`; what fails is the answer.
  template <class Request, class Response, class Then>
  void call(void (v1::CurvecastService::StubInterface::async_interface::*method)(grpc::ClientContext*, const Request*, Response*,
                                                                                 std::function<void(grpc::Status)>),
            Request request, Then then) {
    calls_.call<Request, Response>(
        method, std::move(request),
        [self = shared_from_this(), then = std::move(then)](const grpc::Status& status, Response response) mutable {
          if (!status.ok()) return self->fail(status);
          then(std::move(response));
        });
  }

 private:
  void tell_gone() ABSL_LOCKS_EXCLUDED(mutex_);

  Engine& engine_;
  ApiCalls calls_;
  const std::shared_ptr<WebExchange> exchange_;
  const Caller caller_;
  const Query query_;
  const Fields fields_;
  const Admission::Ticket ticket_;
  Mutex mutex_;
  std::function<void()> lost_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace curvecast::server
