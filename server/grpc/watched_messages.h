// The messages of one call, watched while they are being sent, or waited for.
#pragma once

#include <grpcpp/server_context.h>

#include <utility>

#include "core/base/mutex.h"
#include "server/base/grpc_status.h"
#include "server/base/stall_watch.h"
#include "server/grpc/end_call.h"

namespace curvecast::server {

/// Thread-safe.
class WatchedMessages {
 public:
  WatchedMessages(StallWatch& watch, grpc::CallbackServerContext& context) : watch_(watch), context_(context) {}

  /// A message is on its way from now on: where its client does nothing for it, the call ends. Precondition: no other one is.
  void begin() {
    watch_.begin(this, [this](const absl::Status& status) {
      {
        const MutexLock lock(mutex_);
        stalled_ = status;
      }
      end_call(context_, status);
    });
  }
  /// The message has left or come, or never will.
  void done() { watch_.done(this); }
  /// How the call ends that would end with `status`: so, unless its client did nothing.
  grpc::Status end_of(grpc::Status status) const ABSL_LOCKS_EXCLUDED(mutex_) {
    const MutexLock lock(mutex_);
    return stalled_.ok() ? std::move(status) : to_grpc(stalled_);
  }

 private:
  StallWatch& watch_;
  grpc::CallbackServerContext& context_;
  mutable Mutex mutex_;
  absl::Status stalled_ ABSL_GUARDED_BY(mutex_);  // an error: the call was ended because its client does nothing
};

}  // namespace curvecast::server
