#include "server/web/web_call.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpcpp/support/slice.h>

#include <vector>

#include "curvecast/v1/web_socket.pb.h"

namespace curvecast::server {
namespace {

using google::protobuf::internal::WireFormatLite;
using google::protobuf::io::CodedOutputStream;

constexpr std::size_t kMaxHeader = 32;  // two tags, a number and a size

/// Room for the message after what comes before it.
std::string begin_response(std::uint32_t call, std::size_t size) {
  std::string bytes(kMaxHeader, '\0');
  auto* const begin = reinterpret_cast<std::uint8_t*>(bytes.data());
  std::uint8_t* at = WireFormatLite::WriteUInt32ToArray(v1::CallResponse::kCallFieldNumber, call, begin);
  at = WireFormatLite::WriteTagToArray(v1::CallResponse::kMessageFieldNumber, WireFormatLite::WIRETYPE_LENGTH_DELIMITED, at);
  at = CodedOutputStream::WriteVarint64ToArray(size, at);
  bytes.resize(static_cast<std::size_t>(at - begin));
  bytes.reserve(bytes.size() + size);
  return bytes;
}

}  // namespace

std::string message_response(std::uint32_t call, const v1::StreamViewsResponse& message) {
  std::string bytes = begin_response(call, message.ByteSizeLong());
  message.AppendPartialToString(&bytes);
  return bytes;
}

std::string message_response(std::uint32_t call, const grpc::ByteBuffer& message) {
  std::string bytes = begin_response(call, message.Length());
  std::vector<grpc::Slice> slices;
  if (message.Dump(&slices).ok()) {
    for (const grpc::Slice& slice : slices) bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

std::string status_response(std::uint32_t call, const grpc::Status& status) {
  v1::CallResponse response;
  response.set_call(call);
  v1::Status& rich = *response.mutable_status();
  if (!rich.ParseFromString(status.error_details())) rich.Clear();
  rich.set_code(status.error_code());
  rich.set_message(status.error_message());
  return response.SerializeAsString();
}

}  // namespace curvecast::server
