#include "server/engine/caller.h"

#include "server/base/admission.h"

namespace curvecast::server {
namespace {

std::string_view metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  return found == context.client_metadata().end() ? "" : std::string_view(found->second.data(), found->second.size());
}

}  // namespace

std::string peer_of(const grpc::CallbackServerContext& context) {
  std::string peer = context.peer();
  if (!peer.starts_with("inproc")) return peer;
  const std::string_view named = metadata(context, kPeerKey);
  return named.empty() ? peer : std::string(named);
}

absl::StatusOr<std::string> caller_of(const Engine& engine, const grpc::CallbackServerContext& context) {
  absl::StatusOr<std::string> caller = caller_of(engine, peer_of(context), metadata(context, "authorization"));
  if (caller.ok()) engine.connections->note_call(context.peer());
  return caller;
}

absl::StatusOr<std::string> caller_of(const Engine& engine, const std::string& peer, std::string_view authorization) {
  if (engine.tokens == nullptr) return client_of_peer(peer);
  return engine.tokens->authenticate(authorization);
}

std::string owner_of(const Engine& engine, const grpc::CallbackServerContext& context) {
  return engine.tokens == nullptr ? "" : caller_of(engine, context).value_or("");
}

}  // namespace curvecast::server
