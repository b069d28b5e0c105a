#include "server/web/resources/json.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/time_util.h>

#include <nlohmann/json.hpp>

#include <algorithm>

#include "curvecast/v1/status.pb.h"
#include "server/base/log.h"

namespace curvecast::server {
namespace {

using Json = nlohmann::ordered_json;

/// A detail under the name that it goes by, where it is one that we know.
template <class Detail>
bool add_detail(const google::protobuf::Any& any, Json& details, Detail& detail) {
  if (!absl::EndsWith(any.type_url(), absl::StrCat("/google.rpc.", Detail::descriptor()->name()))) return false;
  if (!detail.ParseFromString(any.value())) return false;
  Json made = {{"@type", any.type_url()}};
  made.update(Json::parse(to_json(detail)));
  details.push_back(std::move(made));
  return true;
}

std::string text(google::protobuf::StringPiece piece) { return {piece.data(), piece.size()}; }

}  // namespace

std::string to_json(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  std::string json;
  // Messages of ours have no Any, which alone could fail.
  (void)google::protobuf::util::MessageToJsonString(message, &json, options);
  return json;
}

absl::Status parse_json(std::string_view json, google::protobuf::Message& message) {
  const auto status = google::protobuf::util::JsonStringToMessage({json.data(), json.size()}, &message);
  if (status.ok()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("the body is no ", message.GetDescriptor()->name(), " in JSON: ", printable(text(status.message()))));
}

WebAnswer json_answer(const google::protobuf::Message& message) { return {.body = to_json(message) + "\n", .type = kJsonType}; }

int http_status_of(grpc::StatusCode code) {
  switch (code) {
    case grpc::OK:
      return 200;
    case grpc::CANCELLED:
      return 499;
    case grpc::INVALID_ARGUMENT:
    case grpc::OUT_OF_RANGE:
      return 400;
    case grpc::UNAUTHENTICATED:
      return 401;
    case grpc::PERMISSION_DENIED:
      return 403;
    case grpc::NOT_FOUND:
      return 404;
    case grpc::ALREADY_EXISTS:
    case grpc::FAILED_PRECONDITION:
    case grpc::ABORTED:
      return 409;
    case grpc::RESOURCE_EXHAUSTED:
      return 429;
    case grpc::UNIMPLEMENTED:
      return 501;
    case grpc::UNAVAILABLE:
      return 503;
    case grpc::DEADLINE_EXCEEDED:
      return 504;
    default:
      return 500;
  }
}

WebAnswer error_answer(const grpc::Status& status, int http_status) {
  Json details = Json::array();
  WebAnswer answer = {.status = http_status != 0 ? http_status : http_status_of(status.error_code()), .type = kJsonType};
  v1::Status rich;
  if (rich.ParseFromString(status.error_details())) {
    for (const google::protobuf::Any& any : rich.details()) {
      v1::BadRequest bad;
      v1::RetryInfo retry;
      if (add_detail(any, details, bad) || !add_detail(any, details, retry)) continue;
      const auto milliseconds = google::protobuf::util::TimeUtil::DurationToMilliseconds(retry.retry_delay());
      answer.header.emplace_back("Retry-After", absl::StrCat(std::max<std::int64_t>(1, (milliseconds + 999) / 1000)));
    }
  }
  if (answer.status == 503) answer.header.emplace_back("Retry-After", "1");
  if (answer.status == 401) answer.header.emplace_back("WWW-Authenticate", "Bearer");
  const Json body = {{"code", static_cast<int>(status.error_code())}, {"message", status.error_message()}, {"details", details}};
  answer.body = body.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  return answer;
}

}  // namespace curvecast::server
