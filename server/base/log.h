// The server's own log: an object, not spdlog's global one, so that an embedding program keeps its own settings.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace spdlog {
class logger;
}

namespace curvecast::server {

enum class LogFormat {
  kText,
  kJson,  // an object with time, level and message in each line, and with the fields of a request where it is one
};

/// Makes a thread-safe logger to standard error, for state changes and errors and, with `verbose`, every request. Silent when not
/// `enabled`.
std::shared_ptr<spdlog::logger> make_logger(bool enabled, bool verbose, LogFormat format = LogFormat::kText);

/// A request that is over.
struct RequestRecord {
  std::string_view method;
  std::string_view caller;  // empty: not known
  std::string_view peer;
  std::string_view id;
  std::string_view code;  // name of a gRPC status code
  double milliseconds = 0;
  std::string_view error;  // message of the status
};

/// Whether log_request() would write anything.
bool logs_requests(const spdlog::logger& log);
/// Writes one line for a request.
void log_request(spdlog::logger& log, const RequestRecord& request);

/// Escapes what a client sent, so that it is safe in one line of a log or message; takes at most 64 bytes of it.
std::string printable(std::string_view text);

}  // namespace curvecast::server
