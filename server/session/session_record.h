// What a session is besides its curve and its surface, as the cache keeps it.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string>
#include <string_view>

#include "server/session/session.h"

namespace curvecast::server {

/// Writes down what a session is, and whose.
std::string record_of(const Session& session);

/// Reads the record of the session `id`: what record_of() was given, without curve and surface. DataLoss where it makes no sense
/// or is another session's.
absl::StatusOr<std::shared_ptr<Session>> session_of(std::string_view record, const std::string& id);

}  // namespace curvecast::server
