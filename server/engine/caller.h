// Who calls.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/server_context.h>

#include <string>
#include <string_view>

#include "server/engine/engine.h"

namespace curvecast::server {

/// Metadata in which the browsers' gateway says for whom it calls. Believed only of calls from within this process.
inline constexpr char kPeerKey[] = "curvecast-peer";

/// Who is at the other end, as gRPC writes it ("ipv4:127.0.0.1:4711").
std::string peer_of(const grpc::CallbackServerContext& context);

/// A name for the client of a call: with tokens who has the one that it sent, else its address without the port.
/// Unauthenticated as of Tokens.
absl::StatusOr<std::string> caller_of(const Engine& engine, const grpc::CallbackServerContext& context);
/// The same, of a client that is known by its peer's name and what it sent as `authorization` header.
absl::StatusOr<std::string> caller_of(const Engine& engine, const std::string& peer, std::string_view authorization);

/// The same where that has been found good: an empty name where it has not.
std::string owner_of(const Engine& engine, const grpc::CallbackServerContext& context);

}  // namespace curvecast::server
