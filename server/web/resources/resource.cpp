#include "server/web/resources/resource.h"

#include <grpcpp/channel.h>

#include "server/base/grpc_status.h"
#include "server/engine/request_log.h"
#include "server/web/resources/json.h"

namespace curvecast::server {

WebResource::WebResource(Engine& engine, const std::shared_ptr<grpc::Channel>& channel, std::shared_ptr<WebExchange> exchange,
                         Caller caller, Query query, Fields fields, Admission::Ticket ticket)
    : engine_(engine),
      stub_(v1::CurvecastService::NewStub(channel)),
      exchange_(std::move(exchange)),
      caller_(std::move(caller)),
      query_(std::move(query)),
      fields_(std::move(fields)),
      ticket_(std::move(ticket)) {}

void WebResource::watch() {
  exchange_->on_gone([weak = weak_from_this()] {
    if (const auto self = weak.lock()) {
      self->gone_ = true;
      self->cancel();
    }
  });
}

void WebResource::answer(WebAnswer answer) {
  answer.header.insert(answer.header.end(), fields_.begin(), fields_.end());
  exchange_->answer(std::move(answer));
}

void WebResource::fail(const absl::Status& status) { fail(to_grpc(status)); }

void WebResource::fail(const grpc::Status& status, int http_status) { answer(error_answer(status, http_status)); }

grpc::ClientContext* WebResource::introduced() {
  const MutexLock lock(mutex_);
  context_ = std::make_unique<grpc::ClientContext>();
  introduce(request().peer, *context_);
  if (is_request_id(request().request_id)) context_->AddMetadata("x-request-id", request().request_id);
  if (gone_) context_->TryCancel();
  return context_.get();
}

void WebResource::cancel() {
  const MutexLock lock(mutex_);
  if (context_ != nullptr) context_->TryCancel();
}

}  // namespace curvecast::server
