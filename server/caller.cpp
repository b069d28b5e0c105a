#include "server/caller.h"

#include "server/admission.h"

namespace curvecast::server {
absl::StatusOr<std::string> caller_of(const Engine& engine, const grpc::CallbackServerContext& context) {
  if (engine.tokens == nullptr) return client_of_peer(context.peer());
  const auto found = context.client_metadata().find("authorization");
  const bool is_there = found != context.client_metadata().end();
  return engine.tokens->authenticate(is_there ? std::string_view(found->second.data(), found->second.size()) : "");
}

std::string owner_of(const Engine& engine, const grpc::CallbackServerContext& context) {
  return engine.tokens == nullptr ? "" : caller_of(engine, context).value_or("");
}

}  // namespace curvecast::server
