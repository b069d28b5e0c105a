#include "server/engine/request_log.h"

#include <absl/status/status.h>
#include <absl/strings/ascii.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <random>
#include <utility>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

constexpr char kIdKey[] = "x-request-id";
constexpr std::size_t kMaxId = 64;

std::string random_id() {
  thread_local std::mt19937_64 random((std::uint64_t{std::random_device()()} << 32) | std::random_device()());
  return absl::StrFormat("%016x", random());
}

std::string find_id(const grpc::CallbackServerContext& context) {
  const auto found = context.client_metadata().find(kIdKey);
  if (found != context.client_metadata().end()) {
    const std::string_view id(found->second.data(), found->second.size());
    if (is_request_id(id)) return std::string(id);
  }
  return random_id();
}

}  // namespace

bool is_request_id(std::string_view id) {
  return !id.empty() && id.size() <= kMaxId &&
         std::all_of(id.begin(), id.end(), [](char c) { return absl::ascii_isgraph(static_cast<unsigned char>(c)); });
}

RequestLog::RequestLog(Engine& engine, const char* method, std::string id, const Caller& caller)
    : engine_(engine), method_(method), id_(std::move(id)) {
  if (!logs_requests(*engine_.log)) return;
  caller_ = caller.owner;
  peer_ = caller.address;
}

RequestLog::RequestLog(Engine& engine, const char* method, grpc::CallbackServerContext& context, const Caller& caller)
    : RequestLog(engine, method, find_id(context), caller) {
  context.AddInitialMetadata(kIdKey, id_);
}

RequestLog::RequestLog(Engine& engine, const char* method, const Caller& caller)
    : RequestLog(engine, method, random_id(), caller) {}

void RequestLog::finish(const grpc::Status& status) {
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start_;
  const int code = status.error_code();
  engine_.metrics.request(method_, code, elapsed.count());
  if (!logs_requests(*engine_.log)) return;
  const std::string name = absl::StatusCodeToString(static_cast<absl::StatusCode>(code));
  const std::string error = status.error_message();
  log_request(*engine_.log, {.method = method_,
                             .caller = caller_,
                             .peer = peer_,
                             .id = id_,
                             .code = name,
                             .milliseconds = 1e3 * elapsed.count(),
                             .error = error});
}

}  // namespace curvecast::server
