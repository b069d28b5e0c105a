#include "server/base/log.h"

#include <absl/strings/escaping.h>
#include <absl/strings/str_format.h>
#include <absl/time/time.h>
#include <spdlog/formatter.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <nlohmann/json.hpp>

namespace curvecast::server {
namespace {

using Json = nlohmann::ordered_json;

// What is being logged by this thread, if it is a request: a logger carries text only, and its sinks work before it returns.
thread_local const RequestRecord* current_request = nullptr;

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    const auto level = spdlog::level::to_string_view(message.level);
    Json line = {{"time", absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::FromChrono(message.time), absl::UTCTimeZone())},
                 {"level", std::string(level.data(), level.size())},
                 {"message", std::string(message.payload.data(), message.payload.size())}};
    if (const RequestRecord* request = current_request; request != nullptr) {
      line["method"] = request->method;
      if (!request->caller.empty()) line["caller"] = request->caller;
      line["peer"] = request->peer;
      line["code"] = request->code;
      line["ms"] = request->milliseconds;
      line["request_id"] = request->id;
      if (!request->error.empty()) line["error"] = request->error;
    }
    // What clients send need not be UTF-8.
    const std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    out.append(text.data(), text.data() + text.size());
  }

  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

spdlog::sink_ptr make_sink(bool enabled, LogFormat format) {
  if (!enabled) return std::make_shared<spdlog::sinks::null_sink_mt>();
  if (format == LogFormat::kText) return std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  auto sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
  sink->set_formatter(std::make_unique<JsonFormatter>());
  return sink;
}

}  // namespace

std::shared_ptr<spdlog::logger> make_logger(bool enabled, bool verbose, LogFormat format) {
  auto logger = std::make_shared<spdlog::logger>("curvecast", make_sink(enabled, format));
  logger->set_level(!enabled ? spdlog::level::off : verbose ? spdlog::level::debug : spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  return logger;
}

bool logs_requests(const spdlog::logger& log) { return log.should_log(spdlog::level::debug); }

void log_request(spdlog::logger& log, const RequestRecord& request) {
  if (!logs_requests(log)) return;
  current_request = &request;
  log.debug("{} {}{}from {}: {} after {:.2f} ms, request {}{}{}", request.method, request.caller.empty() ? "" : "by ",
            request.caller.empty() ? "" : printable(request.caller) + " ", request.peer, request.code, request.milliseconds,
            request.id, request.error.empty() ? "" : ": ", request.error);
  current_request = nullptr;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMax = 64;
  std::string out = absl::CHexEscape(std::string(text.substr(0, kMax)));
  if (text.size() > kMax) out += "...";
  return out;
}

}  // namespace curvecast::server
