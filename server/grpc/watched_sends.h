// The messages of one call, watched while they are being sent.
#pragma once

#include <grpcpp/server_context.h>

#include <utility>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/engine/engine.h"
#include "server/grpc/end_call.h"

namespace curvecast::server {

/// Thread-safe.
class WatchedSends {
 public:
  WatchedSends(Engine& engine, grpc::CallbackServerContext& context) : watch_(engine.sends), context_(context) {}

  /// A message is being sent from now on: where its client does not read it, the call ends. Precondition: no other one is.
  void begin() {
    watch_.begin(this, [this](const absl::Status& status) {
      {
        const MutexLock lock(mutex_);
        stalled_ = status;
      }
      end_call(context_, status);
    });
  }
  /// The message has left, or never will.
  void done() { watch_.done(this); }
  /// How the call ends that would end with `status`: so, unless its client did not read.
  grpc::Status end_of(grpc::Status status) const ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    return stalled_.ok() ? std::move(status) : to_grpc(stalled_);
  }

 private:
  StallWatch& watch_;
  grpc::CallbackServerContext& context_;
  mutable Mutex mutex_;
  absl::Status stalled_ ABSL_GUARDED_BY(mutex_);  // an error: the call was ended because its client does not read
};

}  // namespace curvecast::server
