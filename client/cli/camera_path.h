// The cameras of an animation.
#pragma once

#include <absl/status/statusor.h>

#include <string>
#include <vector>

#include "core/base/vec.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli {

inline constexpr char kPathHelp[] =
    "orbit (once around), zoom (from afar to the surface), or a file: a line per view with the eye, target and up (x y z each) "
    "and the "
    "vertical field of view in degrees, 10 numbers in all; # begins a comment; the file is repeated when it has fewer lines than "
    "F";

/// `frames` cameras, >= 1, around a mesh in `box`. Errors of a file name the line: NotFound, InvalidArgument.
absl::StatusOr<std::vector<v1::Camera>> make_camera_path(const std::string& path, std::size_t frames, const Box3d& box);

/// The cameras of a path file's text; `name` starts the messages.
absl::StatusOr<std::vector<v1::Camera>> parse_camera_path(const std::string& name, const std::string& text);

}  // namespace curvecast::cli
