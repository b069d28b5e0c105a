#include "server/base/grpc_status.h"

#include <absl/strings/cord.h>
#include <absl/strings/strip.h>
#include <google/protobuf/util/time_util.h>

#include <string>

#include "curvecast/v1/status.pb.h"
#include "server/base/status_payload.h"

namespace curvecast::server {
namespace {

template <class Detail>
void add_detail(const Detail& detail, v1::Status& status) {
  google::protobuf::Any& any = *status.add_details();
  any.set_type_url("type.googleapis.com/google.rpc." + Detail::descriptor()->name());
  any.set_value(detail.SerializeAsString());
}

}  // namespace

grpc::Status to_grpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  // Trailers are percent-encoded, which may triple them, and clients refuse more than 8 KiB of metadata.
  constexpr std::size_t kMaxMessage = 1000;
  const std::string message(status.message().substr(0, kMaxMessage));
  v1::Status rich;
  if (absl::IsResourceExhausted(status)) {
    v1::RetryInfo retry;
    *retry.mutable_retry_delay() =
        google::protobuf::util::TimeUtil::MillisecondsToDuration(static_cast<std::int64_t>(1e3 * kRetryAfter));
    add_detail(retry, rich);
  }
  if (const auto field = status.GetPayload(kFieldPayload)) {
    v1::BadRequest bad;
    v1::BadRequest::FieldViolation& violation = *bad.add_field_violations();
    violation.set_field(std::string(*field).substr(0, kMaxMessage));
    violation.set_description(std::string(absl::StripPrefix(message, violation.field() + " ")));
    add_detail(bad, rich);
  }
  const auto code = static_cast<grpc::StatusCode>(status.code());
  if (rich.details().empty()) return grpc::Status(code, message);
  rich.set_code(code);
  rich.set_message(message);
  return grpc::Status(code, message, rich.SerializeAsString());
}

}  // namespace curvecast::server
