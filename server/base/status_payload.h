// What a status says for programs, besides its message for people.
#pragma once

namespace curvecast::server {

/// The payload of a status that names the field at fault, as a path in the request.
inline constexpr char kFieldPayload[] = "curvecast.v1/field";

/// Seconds after which to try again what was refused for want of room.
inline constexpr double kRetryAfter = 1;

}  // namespace curvecast::server
