// The server's own log: an object, not spdlog's global one, so that an embedding program keeps its own settings.
#pragma once

#include <memory>
#include <string>
#include <string_view>

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe logger to standard error: state changes and errors, with `verbose` every request too. Silent when not `enabled`.
std::shared_ptr<spdlog::logger> make_logger(bool enabled, bool verbose);

/// What a client sent, made safe for one line of log or message: escaped, at most 64 bytes of it.
std::string printable(std::string_view text);

}  // namespace curvecast::server
