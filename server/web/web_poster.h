// Posters: pictures of what a page of the viewer is going to show, for it to show until it can draw.
#pragma once

#include <absl/status/statusor.h>

#include <memory>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"
#include "server/web/web_gateway.h"

namespace grpc {
class Channel;
}

namespace curvecast::server {

/// The path of the request. Its query has parts of the form NAME=VALUE:
///   width, height  pixels, as of RenderRequest
///   session        whose picture; without it: that of the first session of the list that is ready
///   key            of the session, for proxies, as of WebSockets
///   camera         ten numbers, as in the address of the viewer's page; without it: the camera that the viewer begins with
///   dark, plain    1: before a dark background; as if of clay
/// The answer is a JPEG file, or has the status 204 where there is nothing to show: no such session, none that is ready, none for
/// this caller, or no time for it. 400: the query means nothing.
inline constexpr char kPosterPath[] = "/v1/poster";

/// What a query asks for: a RenderRequest whose session_id may be empty, and whose sample may lack a camera. InvalidArgument for
/// a query that means nothing.
absl::StatusOr<v1::RenderRequest> read_poster_query(std::string_view query);

/// Returns the function that answers these requests, by calls for the client who asks. `channel` leads to this process, and sends
/// Engine::own_key.
WebLateRoutes::mapped_type posters(std::shared_ptr<grpc::Channel> channel);

}  // namespace curvecast::server
