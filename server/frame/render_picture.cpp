#include "server/frame/render_picture.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/render/png_file.h"
#include "core/render/splat_renderer.h"
#include "server/base/protocol.h"
#include "server/convert/convert.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {
namespace {

constexpr std::uint32_t kWidth = 1280, kHeight = 960, kMaxSide = 4096;
// What one picture's buffers may take: 40 bytes a sample.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22, kMaxSamples = std::uint64_t{1} << 23;
constexpr float kDotsAcross = 400;  // the picture's width over that of a dot

absl::StatusOr<RenderOptions> to_options(const v1::RenderRequest& request) {
  FieldValidator check;
  RenderOptions options;
  options.width = static_cast<int>(check.in_range("width", request.width() == 0 ? kWidth : request.width(), 1u, kMaxSide));
  options.height = static_cast<int>(check.in_range("height", request.height() == 0 ? kHeight : request.height(), 1u, kMaxSide));
  const std::uint64_t pixels = static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
  if (pixels > kMaxPixels) check.fail("width times height", absl::StrCat("is ", pixels, "; at most ", kMaxPixels, " are drawn"));
  options.supersample = 4 * pixels <= kMaxSamples ? 2 : 1;
  switch (request.style()) {
    case v1::PICTURE_STYLE_UNSPECIFIED:
    case v1::PICTURE_STYLE_SURFACE:
      break;
    case v1::PICTURE_STYLE_DOTS:
      options.mode = RenderMode::kDots;
      options.dot_diameter = std::clamp(static_cast<double>(static_cast<float>(options.width) / kDotsAcross), 1.0, 64.0);
      break;
    default:
      check.fail("style", absl::StrCat("has the unknown value ", static_cast<int>(request.style())));
  }
  if (absl::Status status = check.status(); !status.ok()) return status;
  return options;
}

/// The request's sample with what it leaves out.
v1::SampleRequest complete(const v1::RenderRequest& request, const RenderOptions& options, const Session& session) {
  v1::SampleRequest sample = request.sample();
  if (sample.budget_case() == v1::SampleRequest::BUDGET_NOT_SET) sample.set_points(session.options.points);
  sample.clear_attributes();
  sample.clear_encoding();
  sample.mutable_viewport()->set_width(static_cast<std::uint32_t>(options.width));
  sample.mutable_viewport()->set_height(static_cast<std::uint32_t>(options.height));
  if (sample.cameras().empty()) {
    FitOptions fit;
    fit.aspect = static_cast<double>(options.width) / options.height;
    const RenderCamera camera = fit_camera(session.curve()->box, fit);
    v1::Camera& to = *sample.add_cameras();
    *to.mutable_eye() = to_proto(camera.eye);
    *to.mutable_target() = to_proto(camera.target);
    *to.mutable_up() = to_proto(camera.up);
    to.set_vertical_fov_degrees(camera.vertical_fov_degrees);
  }
  return sample;
}

absl::StatusOr<RenderCamera> to_render_camera(const PointSetRequest& point_set, const Vec3d& origin) {
  const std::vector<Camera>& cameras = point_set.options.density.cameras;
  if (cameras.size() != 1 || cameras.front().is_orthographic()) {
    return absl::InvalidArgumentError("a picture has one camera, a perspective one: sample.cameras has others");
  }
  const Camera& camera = cameras.front();
  return RenderCamera{camera.eye - origin, camera.target - origin, camera.up, camera.fov * 180 / std::numbers::pi};
}

std::vector<Rgb8> to_rgb(const std::vector<Rgba8>& colours) {
  std::vector<Rgb8> rgb;
  rgb.reserve(colours.size());
  for (const Rgba8& c : colours) rgb.push_back({c.r, c.g, c.b});
  return rgb;
}

absl::StatusOr<Image> draw(const PointSet& points, const PointSet* dots, const RenderCamera& camera,
                           const RenderOptions& options) {
  const std::vector<Rgb8> colours = to_rgb(points.colours);
  const SplatCloud cloud{points.positions, points.normals, points.radii, colours};
  if (dots == nullptr) return render_splats(cloud, camera, options);
  return render_splats(cloud, camera, options, dots->positions, to_rgb(dots->colours));
}

}  // namespace

absl::StatusOr<v1::RenderResponse> render_picture(const Session& session, const v1::RenderRequest& request, ViewCache& cache,
                                                  const ExecutionContext& context) {
  const absl::StatusOr<RenderOptions> options = to_options(request);
  if (!options.ok()) return options.status();
  const v1::SampleRequest completed = complete(request, *options, session);
  const absl::StatusOr<PointSetRequest> point_set = to_point_set_request(completed);
  if (!point_set.ok()) return point_set.status();
  if (point_set->automatic || point_set->max_bytes > 0) {
    return absl::InvalidArgumentError("sample: a picture is made of a number of points, or of an error in pixels");
  }
  const absl::StatusOr<RenderCamera> camera = to_render_camera(*point_set, session.curve()->origin);
  if (!camera.ok()) return camera.status();
  absl::StatusOr<Sampled> wanted = sample_points(session, *point_set, cache, context);
  if (!wanted.ok()) return wanted.status();
  absl::StatusOr<Image> image;
  if (options->mode == RenderMode::kSurface) {
    image = draw(wanted->points(), nullptr, *camera, *options);
  } else {
    // Few dots make no surface to lie on: evenly spread points do.
    PointSetRequest even;
    even.options.points = session.options.points;
    const absl::StatusOr<Sampled> surface = sample_points(session, even, cache, context);
    if (!surface.ok()) return surface.status();
    image = draw(surface->points(), &wanted->points(), *camera, *options);
  }
  if (!image.ok()) return image.status();
  absl::StatusOr<std::string> png = encode_png(*image);
  if (!png.ok()) return png.status();
  if (png->size() > kMaxFrameBytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the picture would have ", png->size(), " bytes; at most ", kMaxFrameBytes,
                                                     " are sent: ask for a smaller one"));
  }
  v1::RenderResponse response;
  response.set_png(*std::move(png));
  response.set_points(wanted->points().size());
  *response.mutable_camera() = completed.cameras(0);
  return response;
}

}  // namespace curvecast::server
