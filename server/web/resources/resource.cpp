#include "server/web/resources/resource.h"

#include <grpcpp/channel.h>

#include "server/base/grpc_status.h"
#include "server/web/resources/json.h"

namespace curvecast::server {

WebResource::WebResource(Engine& engine, const std::shared_ptr<grpc::Channel>& channel, std::shared_ptr<WebExchange> exchange,
                         Caller caller, Query query, Fields fields, Admission::Ticket ticket)
    : engine_(engine),
      calls_(channel, exchange->request().peer, exchange->request().request_id),
      exchange_(std::move(exchange)),
      caller_(std::move(caller)),
      query_(std::move(query)),
      fields_(std::move(fields)),
      ticket_(std::move(ticket)) {}

void WebResource::watch() {
  exchange_->on_gone([weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->calls_.end();
      self->tell_gone();
    }
  });
}

void WebResource::on_gone(std::function<void()> lost) {
  {
    const MutexLock lock(mutex_);
    lost_ = std::move(lost);
  }
  if (gone()) tell_gone();  // before anybody knew whom to tell
}

void WebResource::tell_gone() {
  std::function<void()> lost;
  {
    const MutexLock lock(mutex_);
    lost.swap(lost_);
  }
  if (lost) lost();
}

void WebResource::answer(WebAnswer answer) {
  answer.header.insert(answer.header.end(), fields_.begin(), fields_.end());
  exchange_->answer(std::move(answer));
}

void WebResource::fail(const absl::Status& status) { fail(to_grpc(status)); }

void WebResource::fail(const grpc::Status& status, int http_status) { answer(error_answer(status, http_status)); }

}  // namespace curvecast::server
