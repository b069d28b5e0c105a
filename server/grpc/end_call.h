// Ends a call in the midst of a message that its client does not read.
#pragma once

#include <absl/status/status.h>
#include <grpc/grpc.h>
#include <grpcpp/server_context.h>

#include <string>

namespace curvecast::server {

/// Has the operations under way fail, soon and on another thread. The client gets the status without the messages before it.
/// Thread-safe, as long as the call is not done.
inline void end_call(grpc::CallbackServerContext& context, const absl::Status& status) {
  const std::string message(status.message());
  grpc_call_cancel_with_status(context.c_call(), static_cast<grpc_status_code>(status.code()), message.c_str(), nullptr);
}

}  // namespace curvecast::server
