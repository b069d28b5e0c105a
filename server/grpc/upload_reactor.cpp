// UploadMesh: the chunks of a file, straight into the store's file, by workers: gRPC's own threads, which carry everybody's
// views, neither hash megabytes nor wait for a disk. One step is under way at a time: a read, what came, or the end.
#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <optional>
#include <string>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/base/log.h"
#include "server/base/protocol.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/caller.h"
#include "server/engine/request_log.h"
#include "server/grpc/reactors.h"
#include "server/grpc/watched_messages.h"

namespace curvecast::server {
namespace {

class UploadReactor final : public grpc::ServerReadReactor<v1::UploadMeshRequest> {
 public:
  UploadReactor(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller, v1::UploadMeshResponse* response)
      : engine_(engine),
        caller_(caller),
        log_(engine, "UploadMesh", context, caller),
        receipts_(engine.receipts, context),
        upload_(engine.meshes, caller.maker()),
        response_(response) {
    absl::StatusOr<Admission::Ticket> ticket = engine.uploads->admit(caller.name);
    if (ticket.ok()) {
      ticket_.emplace(*std::move(ticket));
      read();
    } else {
      finish(to_grpc(ticket.status()));
    }
  }

 private:
  /// Who sends nothing holds his place in the store for so long; then what has come is kept for a later upload.
  void read() {
    receipts_.begin();
    const MutexLock lock(mutex_);
    StartRead(&request_);
  }

  void OnReadDone(bool ok) override {
    receipts_.done();
    { const MutexLock lock(mutex_); }  // the next worker sees all that the last one did, whatever locks gRPC takes in between
    if (const grpc::Status ended = receipts_.end_of(grpc::Status::OK); !ended.ok()) return finish(ended);
    const JobQueue::Claim claim{.caller = caller_.name, .connection = caller_.address};
    const auto submitted = ok ? engine_.chunks.submit([this] { take(); }, claim) : engine_.calls.submit([this] { end(); }, claim);
    if (!submitted.ok()) finish(to_grpc(submitted.status()));
  }

  void take() {
    const absl::Status status = status_from_exceptions([&] { return receive(); });
    if (status.ok()) return read();
    finish(to_grpc(status));
  }

  void end() {
    finish(to_grpc(status_from_exceptions([&] { return complete(); })));
  }

  void finish(const grpc::Status& status) {
    ticket_.reset();  // who hears of the end may begin again at once
    log_.finish(status);
    Finish(status);
  }

  void OnDone() override { delete this; }

  absl::Status receive() {
    if (absl::Status refused = check(engine_, caller_); !refused.ok()) return refused;  // by now
    switch (request_.part_case()) {
      case v1::UploadMeshRequest::kHeader:
        if (begun_) return absl::InvalidArgumentError("the header was sent twice; send it first and once");
        begun_ = true;
        return begin(request_.header());
      case v1::UploadMeshRequest::kChunk:
        if (!begun_) return absl::InvalidArgumentError("a chunk came before the header; send the header first");
        if (request_.chunk().size() > kMaxChunkBytes) {
          return absl::InvalidArgumentError(
              absl::StrCat("the chunk has ", request_.chunk().size(), " bytes; at most ", kMaxChunkBytes, " are taken"));
        }
        return upload_.append(request_.chunk());
      case v1::UploadMeshRequest::PART_NOT_SET:
        break;
    }
    return absl::InvalidArgumentError("the message holds neither header nor chunk");
  }

  absl::Status begin(const v1::UploadHeader& header) {
    if (!header.size_is_unknown()) return upload_.begin(header.name(), header.size(), header.mesh_id(), header.offset());
    if (header.size() > 0 || header.offset() > 0) {
      return absl::InvalidArgumentError(absl::StrCat("header.size_is_unknown is set, but header.size is ", header.size(),
                                                     " and header.offset ", header.offset(), "; leave these out"));
    }
    return upload_.begin_unsized(header.name(), header.mesh_id());
  }

  absl::Status complete() {
    if (!begun_) return absl::InvalidArgumentError("the upload has no header");
    const auto mesh = upload_.finish();
    if (!mesh.ok()) return mesh.status();
    engine_.log->info("mesh {} \"{}\" received, {} bytes", (*mesh)->id, printable((*mesh)->name), (*mesh)->size());
    response_->set_mesh_id((*mesh)->id);
    response_->set_size((*mesh)->size());
    return absl::OkStatus();
  }

  Engine& engine_;
  const Caller caller_;
  RequestLog log_;
  WatchedMessages receipts_;
  MeshUpload upload_;
  v1::UploadMeshRequest request_;
  v1::UploadMeshResponse* const response_;
  bool begun_ = false;
  std::optional<Admission::Ticket> ticket_;
  Mutex mutex_;  // guards nothing: puts the steps in order, see OnReadDone()
};

}  // namespace

grpc::ServerReadReactor<v1::UploadMeshRequest>* upload_mesh(Engine& engine, grpc::CallbackServerContext& context,
                                                            const Caller& caller, v1::UploadMeshResponse* response) {
  return new UploadReactor(engine, context, caller, response);
}

}  // namespace curvecast::server
