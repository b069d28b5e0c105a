#include "server/grpc_status.h"

#include <string>

namespace curvecast::server {

grpc::Status to_grpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  // Trailers are percent-encoded, which may triple them, and clients refuse more than 8 KiB of metadata.
  constexpr std::size_t kMaxMessage = 2000;
  return grpc::Status(static_cast<grpc::StatusCode>(status.code()), std::string(status.message().substr(0, kMaxMessage)));
}

}  // namespace curvecast::server
