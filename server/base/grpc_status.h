// Turns statuses into those of gRPC.
#pragma once

#include <absl/status/status.h>
#include <grpcpp/support/status.h>

namespace curvecast::server {

/// Converts a status to the same code and message; messages too long for a trailer are cut.
grpc::Status to_grpc(const absl::Status& status);

}  // namespace curvecast::server
