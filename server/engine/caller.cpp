#include "server/engine/caller.h"

#include <grpc/grpc_security_constants.h>
#include <grpcpp/client_context.h>

#include <string_view>
#include <vector>

#include "proto/tls/certificate_name.h"
#include "server/base/admission.h"
#include "server/base/hash.h"
#include "server/engine/engine.h"

namespace curvecast::server {
namespace {

// In which calls that have this process's key say for whom they are. Of no meaning in others.
constexpr char kAddressKey[] = "curvecast-peer", kProxyKey[] = "curvecast-by-proxy";
constexpr char kCertificateKey[] = "curvecast-certificate-bin";  // names may have any characters
constexpr char kAuthorizationKey[] = "authorization", kForwardedKey[] = "x-forwarded-for";

std::vector<std::string_view> all_metadata(const grpc::CallbackServerContext& context, const char* key) {
  std::vector<std::string_view> values;
  const auto [begin, end] = context.client_metadata().equal_range(key);
  for (auto at = begin; at != end; ++at) values.emplace_back(at->second.data(), at->second.size());
  return values;
}

/// The first of that key; empty where there is none.
std::string metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  return found == context.client_metadata().end() ? "" : std::string(found->second.data(), found->second.size());
}

/// By digests, so that the time which it takes tells nothing about the key.
bool is_own_call(const Engine& engine, const grpc::CallbackServerContext& context) {
  const std::string key = metadata(context, kOwnKey);
  return !key.empty() && hash_of(key) == hash_of(engine.own_key);
}

std::string certificate_of(const grpc::CallbackServerContext& context) {
  const auto pem = context.auth_context()->FindPropertyValues(GRPC_X509_PEM_CERT_PROPERTY_NAME);
  return pem.empty() ? "" : tls::certificate_name(std::string(pem.front().data(), pem.front().size()));
}

}  // namespace

Peer peer_of(const Engine& engine, const grpc::CallbackServerContext& context) {
  Peer peer{.address = context.peer(), .authorization = metadata(context, kAuthorizationKey)};
  if (is_own_call(engine, context)) {
    peer.address = metadata(context, kAddressKey);
    if (peer.address.empty()) peer.address = kOperator;
    peer.comes_by_proxy = !metadata(context, kProxyKey).empty();
    peer.certificate = metadata(context, kCertificateKey);
    return peer;
  }
  if (engine.asks_for_certificates) peer.certificate = certificate_of(context);
  peer.address = engine.connections->client_of(peer.address);
  if (auto client = engine.proxies.client_of(peer.address, all_metadata(context, kForwardedKey))) {
    peer.address = *std::move(client);
    peer.comes_by_proxy = true;
  }
  return peer;
}

void introduce(const Peer& peer, grpc::ClientContext& call) {
  call.AddMetadata(kAddressKey, peer.address);
  if (peer.comes_by_proxy) call.AddMetadata(kProxyKey, "1");
  if (!peer.certificate.empty()) call.AddMetadata(kCertificateKey, peer.certificate);
  if (!peer.authorization.empty()) call.AddMetadata(kAuthorizationKey, peer.authorization);
}

absl::StatusOr<Caller> identify(const Engine& engine, const Peer& peer) {
  const std::shared_ptr<const Tokens> tokens = engine.tokens.get();
  if (peer.address == kOperator) {
    return Caller{.name = kOperator, .owner = engine.knows_callers() ? kOperator : "", .address = peer.address};
  }
  if (tokens != nullptr) {
    absl::StatusOr<Tokens::Holder> holder = tokens->authenticate(peer.authorization);
    if (!holder.ok()) return holder.status();
    return Caller{.name = holder->name, .owner = holder->name, .address = peer.address, .token = *std::move(holder)};
  }
  if (engine.isolates && peer.certificate.empty()) {
    return absl::UnauthenticatedError("your certificate has no name, and this server keeps what its clients have apart by name");
  }
  if (peer.certificate == kOperator) return absl::UnauthenticatedError("the name in your certificate is the server's own");
  const bool is_named = !peer.certificate.empty() && !peer.comes_by_proxy;
  return Caller{
      .name = is_named ? peer.certificate : client_of_peer(peer.address), .owner = peer.certificate, .address = peer.address};
}

absl::Status check(const Engine& engine, const Caller& caller) {
  if (caller.token.name.empty()) return absl::OkStatus();
  return engine.tokens.get()->check(caller.token);
}

}  // namespace curvecast::server
