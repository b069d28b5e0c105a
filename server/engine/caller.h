// The client of a call: its address, and its name for limits and ownership.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/server_context.h>

#include <string>
#include <string_view>

#include "server/engine/engine.h"

namespace curvecast::server {

/// Metadata in which the browsers' gateway names the client for whom it calls. Believed only of calls from within this process.
inline constexpr char kPeerKey[] = "curvecast-peer";

/// The address of the other end, as gRPC writes it ("ipv4:127.0.0.1:4711").
std::string peer_of(const grpc::CallbackServerContext& context);

/// Names the client of a call: with tokens the holder of the token that it sent, else its address without the port.
/// Unauthenticated as of Tokens::authenticate().
absl::StatusOr<std::string> caller_of(const Engine& engine, const grpc::CallbackServerContext& context);
/// Names the client at the address `peer`, which sent this `authorization` header.
absl::StatusOr<std::string> caller_of(const Engine& engine, const std::string& peer, std::string_view authorization);

/// Names the client that owns what a call makes: caller_of() with tokens; empty without, or where the token is not known.
std::string owner_of(const Engine& engine, const grpc::CallbackServerContext& context);

}  // namespace curvecast::server
