// Who calls.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/server_context.h>

#include <string>

#include "server/engine.h"

namespace curvecast::server {

/// A name for the client of a call: with tokens who has the one that it sent, else its address without the port.
/// Unauthenticated as of Tokens.
absl::StatusOr<std::string> caller_of(const Engine& engine, const grpc::CallbackServerContext& context);

/// The same where that has been found good: an empty name where it has not.
std::string owner_of(const Engine& engine, const grpc::CallbackServerContext& context);

}  // namespace curvecast::server
