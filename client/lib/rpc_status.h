// SPDX-License-Identifier: Apache-2.0
// gRPC's statuses as Abseil's.
#pragma once

#include <absl/status/status.h>
#include <grpcpp/support/status.h>

namespace curvecast::client {

/// Of the details, when to try again: see retry_after() in retry.h.
absl::Status to_absl(const grpc::Status& status);

}  // namespace curvecast::client
