// SPDX-License-Identifier: Apache-2.0
// Cameras as people write them.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <optional>
#include <string_view>

#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::terms {

inline constexpr double kMaxAspect = 100;         // and its inverse the least
inline constexpr double kDefaultFovDegrees = 30;  // vertical

/// What somebody said; the rest follows from the box of what is looked at.
struct CameraTerm {
  std::optional<std::array<double, 3>> eye, target, up;
  std::optional<double> fov_degrees;  // vertical
  std::optional<double> height;       // of an orthographic picture, in the mesh's units
  std::optional<double> aspect;       // of the picture, width / height

  /// Returns the angle that counts.
  double fov() const { return fov_degrees.value_or(kDefaultFovDegrees); }
};

/// Parses "eye=x,y,z,target=x,y,z,up=x,y,z,fov=degrees,ortho=height,aspect=width/height", of which each part may be missing.
/// InvalidArgument names the part at fault.
absl::StatusOr<CameraTerm> parse_camera_term(std::string_view text);

/// Returns the camera of a term for a box. `centre`: of the box. `whole`: a camera with the term's fov() that has all of the box
/// in its picture. Target: the box's centre, where only the eye is known. Up: (0, 1, 0), or another axis when that is along the
/// view. InvalidArgument as for check_camera().
absl::StatusOr<v1::Camera> complete_camera(const CameraTerm& term, const v1::Vec3& centre, const v1::Camera& whole);

/// InvalidArgument unless all is finite, eye and target differ, up is not along the view, 0 < fov < 180, and no orthographic
/// height is negative.
absl::Status check_camera(const v1::Camera& camera);

}  // namespace curvecast::terms
