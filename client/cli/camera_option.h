// Cameras as written on the command line.
#pragma once

#include <absl/status/statusor.h>

#include <string_view>

#include "core/base/vec.h"
#include "curvecast/v1/curvecast.pb.h"
#include "proto/terms/camera_term.h"

namespace curvecast::cli {

inline constexpr char kCameraHelp[] =
    "eye=x,y,z,target=x,y,z,up=x,y,z,fov=degrees,ortho=height,aspect=width/height, each of them optional (ortho: a parallel "
    "projection, whose picture is so high, in the mesh's units; aspect: of the picture, by default 1, a square); default: a "
    "three-quarter view of the whole mesh";

using CameraOption = terms::CameraTerm;
using terms::check_camera;

/// Comma-separated, as in kCameraHelp. InvalidArgument names the part at fault.
inline absl::StatusOr<CameraOption> parse_camera(std::string_view text) { return terms::parse_camera_term(text); }

/// Target: the box's centre. Eye: three quarters to the front, far enough for the whole box in a picture of `aspect` (width /
/// height). Up: (0, 1, 0), or another axis when that is along the view. InvalidArgument as for check_camera().
absl::StatusOr<v1::Camera> resolve_camera(const CameraOption& option, const Box3d& box, double aspect);

Vec3d to_vec(const v1::Vec3& v);
v1::Camera make_camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_degrees);

}  // namespace curvecast::cli
