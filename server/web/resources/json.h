// Messages and errors as JSON.
#pragma once

#include <absl/status/statusor.h>
#include <google/protobuf/message.h>
#include <grpcpp/support/status.h>

#include <string>
#include <string_view>

#include "server/web/web_exchange.h"

namespace curvecast::server {

inline constexpr char kJsonType[] = "application/json";

/// Returns a message in protobuf's JSON mapping, with all fields that have a default.
std::string to_json(const google::protobuf::Message& message);
/// Reads a message. InvalidArgument: it is no JSON, has a field that the message has not, or a value that its field cannot have.
absl::Status parse_json(std::string_view text, google::protobuf::Message& message);

WebAnswer json_answer(const google::protobuf::Message& message);
/// The status that an error has in HTTP.
int http_status_of(grpc::StatusCode code);
/// Returns an error: google.rpc.Status in its JSON form, with BadRequest and RetryInfo, and the fields that HTTP has for these.
/// `http_status`: 0 for http_status_of().
WebAnswer error_answer(const grpc::Status& status, int http_status = 0);

}  // namespace curvecast::server
