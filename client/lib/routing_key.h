// SPDX-License-Identifier: Apache-2.0
// What a proxy in front of several servers may choose one by.
#pragma once

#include <cstddef>
#include <string_view>

namespace curvecast::client {

/// The metadata of a call that carries it. Nobody has to look at it: every server can answer every call.
inline constexpr char kRoutingKey[] = "curvecast-key";
inline constexpr std::size_t kRoutingKeySize = 16;  // digits

/// Returns the first digits of the session or mesh that a request is about, empty where it is about none. Those of a session are
/// those of its mesh, so that all calls about a mesh have the same.
template <typename Request>
std::string_view routing_key(const Request& request) {
  std::string_view id;
  if constexpr (requires { request.session_id(); }) id = request.session_id();
  if constexpr (requires { request.mesh_id(); }) {
    if (id.empty()) id = request.mesh_id();
  }
  return id.substr(0, kRoutingKeySize);
}

}  // namespace curvecast::client
