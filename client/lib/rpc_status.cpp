// SPDX-License-Identifier: Apache-2.0
#include "client/lib/rpc_status.h"

#include <absl/strings/cord.h>

#include "client/lib/retry.h"
#include "curvecast/v1/status.pb.h"

namespace curvecast::client {

absl::Status to_absl(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  // The codes of both have the same numbers.
  absl::Status out(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
  v1::Status rich;
  if (!rich.ParseFromString(status.error_details())) return out;
  for (const google::protobuf::Any& detail : rich.details()) {
    if (detail.type_url() == kRetryInfo) out.SetPayload(kRetryInfo, absl::Cord(detail.value()));
  }
  return out;
}

}  // namespace curvecast::client
