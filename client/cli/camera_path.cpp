#include "client/cli/camera_path.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "client/cli/camera_option.h"
#include "client/lib/file_bytes.h"
#include "core/render/render_camera.h"

namespace curvecast::cli {
namespace {

constexpr std::uint64_t kMaxFileBytes = 64 << 20;
constexpr double kZoomFar = 4;     // distances from the centre: in those of the default view,
constexpr double kZoomNear = 1.1;  // and in radii of the box

std::vector<v1::Camera> orbit(std::size_t frames, const RenderCamera& start) {
  std::vector<v1::Camera> cameras;
  for (std::size_t i = 0; i < frames; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(frames);
    const Vec3d offset = Eigen::AngleAxisd(angle, start.up.normalized()) * (start.eye - start.target);
    cameras.push_back(make_camera(start.target + offset, start.target, start.up, start.vertical_fov_degrees));
  }
  return cameras;
}

std::vector<v1::Camera> zoom(std::size_t frames, const RenderCamera& start, double radius) {
  const Vec3d offset = start.eye - start.target;
  const double far = kZoomFar * offset.norm();
  const double near = std::min(kZoomNear * radius, far);
  std::vector<v1::Camera> cameras;
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = frames > 1 ? static_cast<double>(i) / static_cast<double>(frames - 1) : 0;
    const double distance = far * std::pow(near / far, t);
    cameras.push_back(
        make_camera(start.target + offset.normalized() * distance, start.target, start.up, start.vertical_fov_degrees));
  }
  return cameras;
}

}  // namespace

absl::StatusOr<std::vector<v1::Camera>> parse_camera_path(const std::string& name, const std::string& text) {
  std::vector<v1::Camera> cameras;
  std::size_t line_number = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    ++line_number;
    const absl::string_view content = line.substr(0, line.find('#'));
    const std::vector<absl::string_view> words = absl::StrSplit(content, absl::ByAnyChar(" \t\r,"), absl::SkipEmpty());
    if (words.empty()) continue;
    const auto error = [&](absl::string_view what) {
      return absl::InvalidArgumentError(absl::StrCat(name, ": line ", line_number, ": ", what));
    };
    std::array<double, 10> v{};
    if (words.size() != v.size()) return error(absl::StrCat("10 numbers belong here, not ", words.size()));
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (!absl::SimpleAtod(words[i], &v[i])) return error(absl::StrCat("'", words[i], "' is not a number"));
    }
    v1::Camera camera = make_camera({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}, v[9]);
    if (absl::Status status = check_camera(camera); !status.ok()) return error(status.message());
    cameras.push_back(std::move(camera));
  }
  if (cameras.empty()) return absl::InvalidArgumentError(absl::StrCat(name, ": holds no cameras"));
  return cameras;
}

absl::StatusOr<std::vector<v1::Camera>> make_camera_path(const std::string& path, std::size_t frames, const Box3d& box) {
  if (path == "orbit" || path == "zoom") {
    const RenderCamera start = fit_camera(box);
    return path == "orbit" ? orbit(frames, start) : zoom(frames, start, 0.5 * box.diagonal());
  }
  absl::StatusOr<std::string> text = client::read_bytes(path, kMaxFileBytes);
  if (!text.ok()) return text.status();
  absl::StatusOr<std::vector<v1::Camera>> cameras = parse_camera_path(path, *text);
  if (!cameras.ok()) return cameras.status();
  const std::size_t lines = cameras->size();
  cameras->resize(std::min(lines, frames));
  for (std::size_t i = lines; i < frames; ++i) cameras->push_back(v1::Camera((*cameras)[i - lines]));
  return cameras;
}

}  // namespace curvecast::cli
