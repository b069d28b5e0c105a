// Cameras as written on the command line.
#pragma once

#include <absl/status/statusor.h>

#include <optional>
#include <string_view>

#include "core/base/vec.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli {

inline constexpr char kCameraHelp[] =
    "eye=x,y,z,target=x,y,z,up=x,y,z,fov=degrees,ortho=height,aspect=width/height, each of them optional (ortho: a parallel "
    "projection, whose picture is so high, in the mesh's units; aspect: of the picture, by default 1, a square); default: a "
    "three-quarter view of the whole mesh";
inline constexpr double kMaxAspect = 100;         // and its inverse the least
inline constexpr double kDefaultFovDegrees = 30;  // vertical

/// What the user said; the rest follows from the box of what is looked at.
struct CameraOption {
  std::optional<Vec3d> eye, target, up;
  std::optional<double> fov_degrees;  // vertical
  std::optional<double> height;       // of an orthographic picture, in the mesh's units
  std::optional<double> aspect;       // of the picture, width / height
};

/// Comma-separated, as in kCameraHelp. InvalidArgument names the part at fault.
absl::StatusOr<CameraOption> parse_camera(std::string_view text);

/// Target: the box's centre. Eye: three quarters to the front, far enough for the whole box in a picture of `aspect` (width /
/// height). Up: (0, 1, 0), or another axis when that is along the view. InvalidArgument as for check_camera().
absl::StatusOr<v1::Camera> resolve_camera(const CameraOption& option, const Box3d& box, double aspect);

/// InvalidArgument unless all is finite, eye and target differ, up is not along the view, 0 < fov < 180, and no
/// orthographic height is negative.
absl::Status check_camera(const v1::Camera& camera);

Vec3d to_vec(const v1::Vec3& v);
v1::Camera make_camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_degrees);

}  // namespace curvecast::cli
