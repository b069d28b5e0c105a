#include "server/log.h"

#include <absl/strings/escaping.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>

namespace curvecast::server {

std::shared_ptr<spdlog::logger> make_logger(bool enabled, bool verbose) {
  spdlog::sink_ptr sink;
  if (enabled) {
    sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  } else {
    sink = std::make_shared<spdlog::sinks::null_sink_mt>();
  }
  auto logger = std::make_shared<spdlog::logger>("curvecast", std::move(sink));
  logger->set_level(!enabled ? spdlog::level::off : verbose ? spdlog::level::debug : spdlog::level::info);
  logger->flush_on(spdlog::level::info);
  return logger;
}

std::string printable(std::string_view text) {
  constexpr std::size_t kMax = 64;
  std::string out = absl::CHexEscape(std::string(text.substr(0, kMax)));
  if (text.size() > kMax) out += "...";
  return out;
}

}  // namespace curvecast::server
