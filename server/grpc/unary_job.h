// A unary call that a worker answers.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <functional>
#include <string>
#include <utility>

#include "core/base/execution_context.h"
#include "server/base/grpc_status.h"
#include "server/base/status_from_exceptions.h"
#include "server/engine/caller.h"
#include "server/engine/engine.h"
#include "server/engine/request_log.h"

namespace curvecast::server {

/// Deletes itself when gRPC is done with it. Only the job finishes the call, so the reactor outlives the job.
class UnaryJob final : public grpc::ServerUnaryReactor {
 public:
  /// Fills the response, on one thread. `context` says when the client has gone.
  using Work = std::function<absl::Status(const ExecutionContext& context)>;

  /// `method` is a literal. `prepare` is called within the constructor: it returns the work, or what is wrong with the request.
  UnaryJob(Engine& engine, const char* method, grpc::CallbackServerContext& context, const Caller& caller,
           const std::function<absl::StatusOr<Work>()>& prepare)
      : engine_(engine), log_(engine, method, context, caller) {
    const absl::Status begun = status_from_exceptions([&] {
      absl::StatusOr<Work> work = prepare();
      if (!work.ok()) return work.status();
      return engine.calls
          .submit([this, work = *std::move(work)] { run(work); }, {.caller = caller.name, .connection = caller.address})
          .status();
    });
    if (!begun.ok()) finish(begun);
  }

 private:
  void OnCancel() override { cancel_ = true; }
  void OnDone() override { delete this; }

  void run(const Work& work) {
    finish(status_from_exceptions([&] {
      MemoryBudget::Job memory(engine_.memory, &cancel_);
      return work({.cancel = &cancel_, .threads = 1, .memory = &memory});
    }));
  }

  void finish(const absl::Status& status) {
    log_.finish(to_grpc(status));
    Finish(to_grpc(status));
  }

  Engine& engine_;
  RequestLog log_;
  std::atomic<bool> cancel_ = false;
};

}  // namespace curvecast::server
