#include "server/web/resources/api_calls.h"

#include "server/engine/request_log.h"

namespace curvecast::server {

ApiCalls::ApiCalls(const std::shared_ptr<grpc::Channel>& channel, Peer peer, std::string request_id)
    : stub_(v1::CurvecastService::NewStub(channel)), peer_(std::move(peer)), request_id_(std::move(request_id)) {}

grpc::ClientContext* ApiCalls::introduced() {
  const MutexLock lock(mutex_);
  context_ = std::make_unique<grpc::ClientContext>();
  introduce(peer_, *context_);
  if (is_request_id(request_id_)) context_->AddMetadata("x-request-id", request_id_);
  if (ended_) context_->TryCancel();
  return context_.get();
}

void ApiCalls::cancel() {
  const MutexLock lock(mutex_);
  if (context_ != nullptr) context_->TryCancel();
}

void ApiCalls::end() {
  ended_ = true;
  cancel();
}

}  // namespace curvecast::server
