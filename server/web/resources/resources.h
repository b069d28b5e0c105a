// The API as resources of HTTP, for programs that speak no gRPC: openapi.json describes them.
#pragma once

#include <grpcpp/channel.h>

#include <cstddef>
#include <memory>

#include "server/engine/engine.h"
#include "server/web/web_gateway.h"
#include "server/web/web_origin.h"

namespace curvecast::server {

/// How many requests for resources there may be at once.
struct WebResourceLimits {
  std::size_t most = 64;            // fewer than connections, so that there are some left for probes
  std::size_t most_of_client = 16;  // of one caller, or one address where nobody knows who that is
};

/// Returns what answers all requests below /v1/, each by calls of the API for the client who asks, through `channel`, which leads
/// to this process and sends Engine::own_key: so whatever holds for these calls holds here. Pages of `origins` may ask, and
/// others not. `engine` must outlive it.
WebResources web_resources(Engine& engine, std::shared_ptr<grpc::Channel> channel, WebOrigins origins,
                           const WebResourceLimits& limits);

}  // namespace curvecast::server
