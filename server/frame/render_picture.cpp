#include "server/frame/render_picture.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/curve/place_attributes.h"
#include "core/render/jpeg_file.h"
#include "core/render/mesh_renderer.h"
#include "core/render/png_file.h"
#include "core/render/splat_renderer.h"
#include "server/base/protocol.h"
#include "server/convert/convert.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {
namespace {

constexpr std::uint32_t kWidth = 1280, kHeight = 960, kMaxSide = 4096;
// What one picture's buffers may take.
constexpr std::uint64_t kMaxPixels = std::uint64_t{1} << 22, kMaxSamples = std::uint64_t{1} << 23, kSampleBytes = 40;
constexpr int kFineQuality = 75;    // of JPEG files; pictures for less have one sample of a pixel, and no occlusion
constexpr int kFinest = 4;          // samples of a pixel along each axis, in pictures that others are held against
constexpr float kDotsAcross = 400;  // the picture's width over that of a dot
constexpr Rgb8 kDarkTop = {43, 48, 56}, kDarkBottom = {18, 20, 24};  // as in the viewer

int quality_of(const v1::RenderRequest& request) {
  return request.jpeg_quality() == 0 ? kUsualJpegQuality : static_cast<int>(request.jpeg_quality());
}

/// Whether a picture of so many pixels may have so many samples of a pixel along each axis.
bool has_room(std::uint64_t pixels, int across) { return pixels * static_cast<std::uint64_t>(across * across) <= kMaxSamples; }

absl::StatusOr<RenderOptions> to_options(const v1::RenderRequest& request) {
  FieldValidator check;
  RenderOptions options;
  options.width = static_cast<int>(check.in_range("width", request.width() == 0 ? kWidth : request.width(), 1u, kMaxSide));
  options.height = static_cast<int>(check.in_range("height", request.height() == 0 ? kHeight : request.height(), 1u, kMaxSide));
  const std::uint64_t pixels = static_cast<std::uint64_t>(options.width) * static_cast<std::uint64_t>(options.height);
  if (pixels > kMaxPixels) check.fail("width times height", absl::StrCat("is ", pixels, "; at most ", kMaxPixels, " are drawn"));
  const bool is_quick = request.format() == v1::PICTURE_FORMAT_JPEG && quality_of(request) < kFineQuality;
  options.supersample = !is_quick && has_room(pixels, 2) ? 2 : 1;
  options.ambient_occlusion = !is_quick;
  switch (request.style()) {
    case v1::PICTURE_STYLE_UNSPECIFIED:
    case v1::PICTURE_STYLE_SURFACE:
      break;
    case v1::PICTURE_STYLE_DOTS:
      options.mode = RenderMode::kDots;
      options.dot_diameter = std::clamp(static_cast<double>(static_cast<float>(options.width) / kDotsAcross), 1.0, 64.0);
      break;
    case v1::PICTURE_STYLE_MESH:
      if (is_quick) break;
      while (options.supersample < kFinest && has_room(pixels, options.supersample + 1)) ++options.supersample;
      break;
    default:
      check.fail("style", absl::StrCat("has the unknown value ", static_cast<int>(request.style())));
  }
  switch (request.background()) {
    case v1::PICTURE_BACKGROUND_UNSPECIFIED:
    case v1::PICTURE_BACKGROUND_LIGHT:
      break;
    case v1::PICTURE_BACKGROUND_DARK:
      options.background_top = kDarkTop;
      options.background_bottom = kDarkBottom;
      break;
    default:
      check.fail("background", absl::StrCat("has the unknown value ", static_cast<int>(request.background())));
  }
  if (!v1::PictureFormat_IsValid(request.format())) {
    check.fail("format", absl::StrCat("has the unknown value ", static_cast<int>(request.format())));
  }
  check.in_range("jpeg_quality", request.jpeg_quality(), 0u, 100u);
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

/// What was drawn, and how many points of it.
struct Drawn {
  Image image;
  std::uint64_t points = 0;
};

absl::Status claim_samples(const RenderOptions& options, MemoryClaim& claim) {
  const std::uint64_t bytes = kSampleBytes * static_cast<std::uint64_t>(options.width) *
                              static_cast<std::uint64_t>(options.height) *
                              static_cast<std::uint64_t>(options.supersample * options.supersample);
  return claim.set(bytes, absl::StrCat("a picture of ", options.width, " x ", options.height, " pixels takes ",
                                       describe_bytes(static_cast<double>(bytes)), " of memory"));
}

absl::StatusOr<Image> draw_points(const Session& session, const PointSet& points, const PointSet* dots, bool is_plain,
                                  const RenderCamera& camera, const RenderOptions& options, const ExecutionContext& context) {
  MemoryClaim claim(context);
  if (absl::Status status = claim_samples(options, claim); !status.ok()) return status;
  const std::vector<Rgb8> colours = is_plain ? std::vector<Rgb8>() : to_rgb(points.colours);
  const double creases = crease_degrees(session.options, session.preprocessed.report.mesh.crease_degrees);
  const SplatCloud cloud{points.positions, points.normals, points.radii, colours, creases};
  if (dots == nullptr) return render_splats(cloud, camera, options);
  return render_splats(cloud, camera, options, dots->positions, is_plain ? std::vector<Rgb8>() : to_rgb(dots->colours));
}

/// Draws the repaired mesh, which is read where it lies.
absl::StatusOr<Drawn> draw_mesh(const Session& session, bool is_plain, const RenderCamera& camera, const RenderOptions& options,
                                const ExecutionContext& context) {
  const absl::StatusOr<std::shared_ptr<const CurveBase>> base = session.surface->base(context);
  if (!base.ok()) return base.status();
  if (!(*base)->is_all_sound()) return (*base)->status();
  MemoryClaim claim(context);
  if (absl::Status status = claim_samples(options, claim); !status.ok()) return status;
  const SurfaceData& data = (*base)->data;
  MeshSurface surface{data.mesh.positions, data.mesh.triangles, {}, data.colour != nullptr && !is_plain};
  surface.look = [&data, has_colours = surface.has_colors](std::uint32_t face, const Vec3f& weights, double area) {
    SurfaceLook look{normal_at(data, face, {weights[1], weights[2]}), {}};
    if (!has_colours) return look;
    const Rgba8 colour = data.colour->at(face, weights, area);
    look.color = {colour.r, colour.g, colour.b};
    return look;
  };
  absl::StatusOr<Image> image = render_mesh(surface, camera, options, context);
  if (!image.ok()) return image.status();
  return Drawn{*std::move(image)};
}

absl::StatusOr<Drawn> draw_sample(const Session& session, const PointSetRequest& request, bool is_plain,
                                  const RenderCamera& camera, const RenderOptions& options, ViewCache& cache,
                                  const ExecutionContext& context) {
  absl::StatusOr<Sampled> wanted = sample_points(session, request, cache, context);
  if (!wanted.ok()) return wanted.status();
  absl::StatusOr<Image> image;
  if (options.mode == RenderMode::kSurface) {
    image = draw_points(session, wanted->points(), nullptr, is_plain, camera, options, context);
  } else {
    // Few dots make no surface to lie on: evenly spread points do.
    PointSetRequest even;
    even.options.points = session.options.points;
    const absl::StatusOr<Sampled> surface = sample_points(session, even, cache, context);
    if (!surface.ok()) return surface.status();
    image = draw_points(session, surface->points(), &wanted->points(), is_plain, camera, options, context);
  }
  if (!image.ok()) return image.status();
  return Drawn{*std::move(image), wanted->points().size()};
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
  const bool is_mesh = request.style() == v1::PICTURE_STYLE_MESH;
  const absl::StatusOr<RenderCamera> camera = to_render_camera(*point_set, is_mesh ? Vec3d::Zero() : session.curve()->origin);
  if (!camera.ok()) return camera.status();
  const absl::StatusOr<Drawn> drawn = is_mesh
                                          ? draw_mesh(session, request.plain(), *camera, *options, context)
                                          : draw_sample(session, *point_set, request.plain(), *camera, *options, cache, context);
  if (!drawn.ok()) return drawn.status();
  const bool is_jpeg = request.format() == v1::PICTURE_FORMAT_JPEG;
  absl::StatusOr<std::string> file = is_jpeg ? encode_jpeg(drawn->image, quality_of(request)) : encode_png(drawn->image);
  if (!file.ok()) return file.status();
  if (file->size() > kMaxFrameBytes) {
    return absl::ResourceExhaustedError(absl::StrCat("the picture would have ", file->size(), " bytes; at most ", kMaxFrameBytes,
                                                     " are sent: ask for a smaller one"));
  }
  v1::RenderResponse response;
  if (is_jpeg) {
    response.set_jpeg(*std::move(file));
  } else {
    response.set_png(*std::move(file));
  }
  response.set_points(drawn->points);
  *response.mutable_camera() = completed.cameras(0);
  return response;
}

}  // namespace curvecast::server
