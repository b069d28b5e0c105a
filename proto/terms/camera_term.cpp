// SPDX-License-Identifier: Apache-2.0
#include "proto/terms/camera_term.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace curvecast::terms {
namespace {

using Vector = std::array<double, 3>;

constexpr double kMinSine = 1e-6;  // of the angle between up and the view direction

Vector to_vector(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }

v1::Vec3 to_proto(const Vector& v) {
  v1::Vec3 proto;
  proto.set_x(v[0]);
  proto.set_y(v[1]);
  proto.set_z(v[2]);
  return proto;
}

Vector add(const Vector& a, const Vector& b, double factor = 1) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

double norm(const Vector& v) { return std::hypot(v[0], v[1], v[2]); }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

bool is_along(const Vector& up, const Vector& view) { return norm(cross(up, view)) <= kMinSine * norm(up) * norm(view); }

bool is_finite(const Vector& v) {
  return std::all_of(v.begin(), v.end(), [](double coordinate) { return std::isfinite(coordinate); });
}

/// A stand-in for what is not known yet.
Vector some_direction_off(const std::optional<Vector>& other) {
  constexpr Vector kX = {1, 0, 0}, kY = {0, 1, 0};
  return other && is_along(*other, kX) ? kY : kX;
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

absl::Status set_part(const Part& part, CameraTerm* term) {
  const Vector vector = part.values.size() == 3 ? Vector{part.values[0], part.values[1], part.values[2]} : Vector{};
  if (part.key == "eye") return set_once(part, 3, &term->eye, vector);
  if (part.key == "target") return set_once(part, 3, &term->target, vector);
  if (part.key == "up") return set_once(part, 3, &term->up, vector);
  if (part.key == "fov") return set_once(part, 1, &term->fov_degrees, part.values[0]);
  if (part.key == "ortho") {
    if (part.values.size() == 1 && !(part.values[0] > 0)) {
      return absl::InvalidArgumentError(absl::StrCat("camera: ortho is ", part.values[0], "; it must be above 0"));
    }
    return set_once(part, 1, &term->height, part.values[0]);
  }
  if (part.key == "aspect") {
    if (part.values.size() == 1 && !(part.values[0] >= 1 / kMaxAspect && part.values[0] <= kMaxAspect)) {
      return absl::InvalidArgumentError(
          absl::StrCat("camera: aspect is ", part.values[0], "; it must lie between ", 1 / kMaxAspect, " and ", kMaxAspect));
    }
    return set_once(part, 1, &term->aspect, part.values[0]);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("camera: there is no '", part.key, "'; there are: eye, target, up, fov, ortho, aspect"));
}

v1::Camera make_camera(const Vector& eye, const Vector& target, const Vector& up, double fov_degrees) {
  v1::Camera camera;
  *camera.mutable_eye() = to_proto(eye);
  *camera.mutable_target() = to_proto(target);
  *camera.mutable_up() = to_proto(up);
  camera.set_vertical_fov_degrees(fov_degrees);
  return camera;
}

}  // namespace

absl::Status check_camera(const v1::Camera& camera) {
  const Vector eye = to_vector(camera.eye()), target = to_vector(camera.target()), up = to_vector(camera.up());
  const double fov = camera.vertical_fov_degrees();
  if (!is_finite(eye) || !is_finite(target) || !is_finite(up)) {
    return absl::InvalidArgumentError("camera: eye, target and up must be finite");
  }
  if (eye == target) return absl::InvalidArgumentError("camera: eye and target are the same point");
  if (is_along(up, add(target, eye, -1))) return absl::InvalidArgumentError("camera: up must not be zero or along the view");
  if (!(fov > 0 && fov < 180)) {
    return absl::InvalidArgumentError(absl::StrCat("camera: fov is ", fov, " degrees; it must lie between 0 and 180"));
  }
  if (const double height = camera.orthographic_height(); !(height >= 0 && std::isfinite(height))) {
    return absl::InvalidArgumentError(absl::StrCat("camera: ortho is ", height, "; it must be above 0"));
  }
  return absl::OkStatus();
}

absl::StatusOr<CameraTerm> parse_camera_term(std::string_view text) {
  absl::StatusOr<std::vector<Part>> parts = split_parts(std::string(text));
  if (!parts.ok()) return parts.status();
  CameraTerm term;
  for (const Part& part : *parts) {
    if (absl::Status status = set_part(part, &term); !status.ok()) return status;
  }
  // What can be checked without the box, so that it counts as wrong usage and costs no preprocessing.
  const Vector target = term.target.value_or(Vector{});
  const bool whole = term.eye && term.target;
  const Vector eye = whole ? *term.eye : add(target, some_direction_off(term.up));
  const Vector up = term.up.value_or(some_direction_off(add(target, eye, -1)));
  if (absl::Status status = check_camera(make_camera(eye, target, up, term.fov())); !status.ok()) return status;
  return term;
}

absl::StatusOr<v1::Camera> complete_camera(const CameraTerm& term, const v1::Vec3& centre, const v1::Camera& whole) {
  const Vector offset = add(to_vector(whole.eye()), to_vector(whole.target()), -1);
  const Vector target = term.target.value_or(to_vector(term.eye ? centre : whole.target()));
  const Vector eye = term.eye.value_or(add(target, offset));
  Vector up = term.up.value_or(Vector{0, 1, 0});
  if (!term.up && is_along(up, add(target, eye, -1))) up = {0, 0, 1};
  v1::Camera camera = make_camera(eye, target, up, term.fov());
  camera.set_orthographic_height(term.height.value_or(0));
  if (absl::Status status = check_camera(camera); !status.ok()) return status;
  return camera;
}

}  // namespace curvecast::terms
