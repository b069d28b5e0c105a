#include "client/cli/camera_option.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <vector>

#include "core/render/render_camera.h"

namespace curvecast::cli {
namespace {

constexpr double kMinSine = 1e-6;  // of the angle between up and the view direction

bool is_along(const Vec3d& up, const Vec3d& view) { return up.cross(view).norm() <= kMinSine * up.norm() * view.norm(); }

/// A stand-in for what is not known yet.
Vec3d some_direction_off(const std::optional<Vec3d>& other) {
  return other && is_along(*other, Vec3d::UnitX()) ? Vec3d(Vec3d::UnitY()) : Vec3d(Vec3d::UnitX());
}

/// The numbers that follow each key.
struct Part {
  std::string key;
  std::vector<double> values;
};

absl::StatusOr<std::vector<Part>> split_parts(const std::string& text) {
  std::vector<Part> parts;
  for (std::string token : std::vector<std::string>(absl::StrSplit(text, ','))) {
    if (const std::size_t equals = token.find('='); equals != std::string::npos) {
      parts.push_back({token.substr(0, equals), {}});
      token.erase(0, equals + 1);
    }
    double value = 0;
    if (!absl::SimpleAtod(token, &value) || !std::isfinite(value)) {
      return absl::InvalidArgumentError(absl::StrCat("camera: '", token, "' is not a number"));
    }
    if (parts.empty()) {
      return absl::InvalidArgumentError(
          absl::StrCat("camera: '", text, "' does not begin with eye=, target=, up=, fov=, ortho= or aspect="));
    }
    parts.back().values.push_back(value);
  }
  return parts;
}

template <typename T>
absl::Status set_once(const Part& part, std::size_t count, std::optional<T>* field, const T& value) {
  if (part.values.size() != count) {
    return absl::InvalidArgumentError(
        absl::StrCat("camera: ", part.key, " takes ", count, count == 1 ? " number" : " numbers", ", not ", part.values.size()));
  }
  if (field->has_value()) return absl::InvalidArgumentError(absl::StrCat("camera: ", part.key, " is given twice"));
  *field = value;
  return absl::OkStatus();
}

absl::Status set_part(const Part& part, CameraOption* option) {
  const Vec3d vector = part.values.size() == 3 ? Vec3d(part.values[0], part.values[1], part.values[2]) : Vec3d(Vec3d::Zero());
  if (part.key == "eye") return set_once(part, 3, &option->eye, vector);
  if (part.key == "target") return set_once(part, 3, &option->target, vector);
  if (part.key == "up") return set_once(part, 3, &option->up, vector);
  if (part.key == "fov") return set_once(part, 1, &option->fov_degrees, part.values[0]);
  if (part.key == "ortho") {
    if (part.values.size() == 1 && !(part.values[0] > 0)) {
      return absl::InvalidArgumentError(absl::StrCat("camera: ortho is ", part.values[0], "; it must be above 0"));
    }
    return set_once(part, 1, &option->height, part.values[0]);
  }
  if (part.key == "aspect") {
    if (part.values.size() == 1 && !(part.values[0] >= 1 / kMaxAspect && part.values[0] <= kMaxAspect)) {
      return absl::InvalidArgumentError(
          absl::StrCat("camera: aspect is ", part.values[0], "; it must lie between ", 1 / kMaxAspect, " and ", kMaxAspect));
    }
    return set_once(part, 1, &option->aspect, part.values[0]);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("camera: there is no '", part.key, "'; there are: eye, target, up, fov, ortho, aspect"));
}

v1::Vec3 to_proto(const Vec3d& v) {
  v1::Vec3 proto;
  proto.set_x(v.x());
  proto.set_y(v.y());
  proto.set_z(v.z());
  return proto;
}

}  // namespace

Vec3d to_vec(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

v1::Camera make_camera(const Vec3d& eye, const Vec3d& target, const Vec3d& up, double fov_degrees) {
  v1::Camera camera;
  *camera.mutable_eye() = to_proto(eye);
  *camera.mutable_target() = to_proto(target);
  *camera.mutable_up() = to_proto(up);
  camera.set_vertical_fov_degrees(fov_degrees);
  return camera;
}

absl::Status check_camera(const v1::Camera& camera) {
  const Vec3d eye = to_vec(camera.eye()), target = to_vec(camera.target()), up = to_vec(camera.up());
  const double fov = camera.vertical_fov_degrees();
  if (!eye.allFinite() || !target.allFinite() || !up.allFinite()) {
    return absl::InvalidArgumentError("camera: eye, target and up must be finite");
  }
  if (eye == target) return absl::InvalidArgumentError("camera: eye and target are the same point");
  if (is_along(up, target - eye)) return absl::InvalidArgumentError("camera: up must not be zero or along the view");
  if (!(fov > 0 && fov < 180)) {
    return absl::InvalidArgumentError(absl::StrCat("camera: fov is ", fov, " degrees; it must lie between 0 and 180"));
  }
  if (const double height = camera.orthographic_height(); !(height >= 0 && std::isfinite(height))) {
    return absl::InvalidArgumentError(absl::StrCat("camera: ortho is ", height, "; it must be above 0"));
  }
  return absl::OkStatus();
}

absl::StatusOr<CameraOption> parse_camera(std::string_view text) {
  absl::StatusOr<std::vector<Part>> parts = split_parts(std::string(text));
  if (!parts.ok()) return parts.status();
  CameraOption option;
  for (const Part& part : *parts) {
    if (absl::Status status = set_part(part, &option); !status.ok()) return status;
  }
  // What can be checked without the box, so that it counts as wrong usage and costs no preprocessing.
  const Vec3d target = option.target.value_or(Vec3d::Zero());
  const bool whole = option.eye && option.target;
  const Vec3d eye = whole ? *option.eye : target + some_direction_off(option.up);
  const Vec3d up = option.up.value_or(some_direction_off(target - eye));
  const v1::Camera camera = make_camera(eye, target, up, option.fov_degrees.value_or(kDefaultFovDegrees));
  if (absl::Status status = check_camera(camera); !status.ok()) return status;
  return option;
}

absl::StatusOr<v1::Camera> resolve_camera(const CameraOption& option, const Box3d& box, double aspect) {
  const double fov = option.fov_degrees.value_or(kDefaultFovDegrees);
  FitOptions fit;
  fit.aspect = aspect;
  if (fov > 0 && fov < 180) fit.vertical_fov_degrees = fov;
  const RenderCamera whole = fit_camera(box, fit);
  const Vec3d target = option.target.value_or(option.eye ? box.center() : whole.target);
  const Vec3d eye = option.eye.value_or(target + (whole.eye - whole.target));
  Vec3d up = option.up.value_or(Vec3d(0, 1, 0));
  if (!option.up && is_along(up, target - eye)) up = Vec3d(0, 0, 1);
  v1::Camera camera = make_camera(eye, target, up, fov);
  camera.set_orthographic_height(option.height.value_or(0));
  if (absl::Status status = check_camera(camera); !status.ok()) return status;
  return camera;
}

}  // namespace curvecast::cli
