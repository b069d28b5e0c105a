// The client of a call: what it shows of itself, and who it is.
#pragma once

#include <absl/status/statusor.h>
#include <grpcpp/server_context.h>

#include <string>

#include "server/base/tokens.h"
#include "server/session/maker.h"

namespace curvecast::server {

class Engine;

/// What a client shows of itself.
struct Peer {
  std::string address = {};        // as gRPC writes it: "ipv4:127.0.0.1:4711"; of the client, where it comes by a trusted proxy
  bool comes_by_proxy = false;     // whose the certificate is, then
  std::string authorization = {};  // header "Bearer TOKEN"; empty: none was sent
  std::string certificate = {};    // the name in it, as of tls::certificate_name(); empty: none was asked for
};

/// Who a client is, once that has been checked.
struct Caller {
  std::string name = {};      // for limits and shares: whose the token is, or the certificate, else the address without the port
  std::string owner = {};     // of what it makes; empty: nobody in particular
  std::string address = {};   // of the Peer: tells the connections of a caller apart
  Tokens::Holder token = {};  // that it is known by; without a name: it is not by one

  /// As whom it has meshes kept and sessions made.
  Maker maker() const { return {owner, name}; }
};

/// The metadata in which calls from this process send Engine::own_key: gRPC does not tell reliably where a call comes from.
inline constexpr char kOwnKey[] = "curvecast-own";

/// What the client of a call shows. Calls that come from this process are its own, unless the gateway of browsers says for whom
/// it calls.
Peer peer_of(const Engine& engine, const grpc::CallbackServerContext& context);
/// Has a call over a channel that sends the key say for whom it is.
void introduce(const Peer& peer, grpc::ClientContext& call);

/// Who that is. Unauthenticated as of Tokens::authenticate(), where there are tokens; where owners are isolated, also without a
/// name.
absl::StatusOr<Caller> identify(const Engine& engine, const Peer& peer);
/// Whether a caller may go on. Unauthenticated: its token is not known any more, or has expired.
absl::Status check(const Engine& engine, const Caller& caller);

}  // namespace curvecast::server
