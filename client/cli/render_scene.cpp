#include "client/cli/render_scene.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "client/cli/points_io.h"
#include "client/cli/report.h"
#include "client/cli/surface_lines.h"

namespace curvecast::cli {
namespace {

// The picture's longer side over the width of a line, or of a dot.
constexpr double kCutsAcross = 300, kCurvesAcross = 400, kEdgesAcross = 1100, kSamplesAcross = 220;
constexpr double kLineShare = 0.36;                        // of the distance between neighbouring lines of a curve, at most
constexpr double kCurveOmega = 1;                          // more vertices than points would blacken the picture
constexpr std::int64_t kMaxSupersampledPixels = 16 << 20;  // above, one sample per pixel: the renderer's limit

std::vector<Vec3f> to_vectors(const std::vector<std::array<float, 3>>& values) {
  std::vector<Vec3f> vectors;
  vectors.reserve(values.size());
  for (const auto& [x, y, z] : values) vectors.emplace_back(x, y, z);
  return vectors;
}

float diameter(const Size& size, double across) {
  return static_cast<float>(std::clamp(std::max(size.width, size.height) / across, 1.0, 64.0));
}

/// One call's worth of what the makers of scenes need.
struct Maker {
  const RenderFlags& flags;
  const CommonOptions& options;
  const Size& size;
  client::Client& client;
  std::stop_token stop;

  absl::StatusOr<client::Points> resample(const OpenedMesh& opened, v1::SampleRequest sample) const {
    v1::ResampleRequest request;
    request.set_session_id(opened.session.session_id());
    *request.mutable_sample() = std::move(sample);
    request.mutable_sample()->mutable_encoding()->mutable_raw();
    absl::StatusOr<client::DecodedSample> wanted = client.resample(request, stop);
    if (!wanted.ok()) return wanted.status();
    return std::move(wanted->points);
  }

  /// Evenly spread points make a surface to draw on.
  absl::StatusOr<client::Points> even_cloud(const OpenedMesh& opened) const {
    v1::SampleRequest sample;
    sample.set_points(opened.session.options().max_points());
    sample.set_seed(options.seed);
    return resample(opened, std::move(sample));
  }

  LineView line_view(const Scene& scene, const Box3d& box, bool is_closed = false) const {
    return {to_render_camera(scene.camera, Vec3d::Zero()), size.height, box.diagonal(), Vec3d(scene.cloud.origin.data()),
            is_closed};
  }

  absl::Status add_samples(const OpenedMesh& opened, Scene& scene) const {
    absl::StatusOr<v1::SampleRequest> sample = make_request(flags.sample, options.seed);
    if (!sample.ok()) return sample.status();
    *sample->add_cameras() = scene.camera;
    sample->mutable_viewport()->set_width(static_cast<std::uint32_t>(size.width));
    sample->mutable_viewport()->set_height(static_cast<std::uint32_t>(size.height));
    absl::StatusOr<client::Points> wanted = resample(opened, *std::move(sample));
    if (!wanted.ok()) return wanted.status();
    scene.count = wanted->size();
    if (flags.what == "cut" || (flags.what == "surface" && flags.style == "surface")) {
      scene.cloud = *std::move(wanted);
      return absl::OkStatus();
    }
    // Few dots make no surface to lie on.
    scene.dots = to_vectors(wanted->positions);
    if (!flags.no_colour) scene.dot_colours = std::move(wanted->colours);
    scene.options.mode = RenderMode::kDots;
    if (flags.what == "samples") scene.options.dot_diameter = diameter(size, kSamplesAcross);
    absl::StatusOr<client::Points> cloud = even_cloud(opened);
    if (!cloud.ok()) return cloud.status();
    scene.cloud = *std::move(cloud);
    return absl::OkStatus();
  }

  void add_lines(LineDots lines, double width, bool is_matte, Scene& scene) const {
    scene.dots = std::move(lines.positions);
    scene.dot_colours = std::move(lines.colors);
    scene.options.mode = RenderMode::kDots;
    scene.options.matte_under_dots = is_matte;
    scene.options.dot_diameter = width;
  }

  absl::Status add_mesh_lines(const OpenedMesh& opened, const Box3d& box, Scene& scene) const {
    const absl::StatusOr<client::ParameterMesh> mesh = client.get_parameter_mesh(opened.mesh, opened.session.options(), stop);
    if (!mesh.ok()) return mesh.status();
    if (flags.what == "cut") {
      add_lines(trace_cuts(*mesh, line_view(scene, box)), std::max(2.0f, diameter(size, kCutsAcross)), false, scene);
      return absl::OkStatus();
    }
    add_lines(trace_edges(*mesh, line_view(scene, box)), diameter(size, kEdgesAcross), true, scene);
    scene.counted = "faces";
    scene.count = mesh->info.mesh().faces();
    return absl::OkStatus();
  }

  absl::Status add_curve(const Box3d& box, Scene& scene) const {
    const absl::StatusOr<v1::SessionOptions> session_options = curve_session_options(flags);
    if (!session_options.ok()) return session_options.status();
    const absl::StatusOr<OpenedMesh> opened = open_mesh(client, flags.input, *session_options, options.quiet, stop);
    if (!opened.ok()) return opened.status();
    const absl::StatusOr<client::Curve> curve = client.get_curve(opened->session.session_id(), stop);
    if (!curve.ok()) return curve.status();
    scene.counted = "curve_vertices";
    scene.count = curve->info.curve_vertices();
    // Lines must not merge: where the surface is seen from the front, at its mean distance, they lie so many pixels apart.
    const LineView view = line_view(scene, box, opened->session.report().mesh().boundary_loops() == 0);
    const double distance = (view.camera.eye - box.center()).norm();
    const double pixel = 2 * distance * std::tan(view.camera.vertical_fov_degrees * std::numbers::pi / 360) / size.height;
    const double spacing = std::sqrt(opened->session.report().mesh().area() / static_cast<double>(scene.count)) / pixel;
    const double width = std::clamp(kLineShare * spacing, 1.0, std::max<double>(1, diameter(size, kCurvesAcross)));
    add_lines(trace_curve(*curve, view), width, true, scene);
    return absl::OkStatus();
  }
};

}  // namespace

RenderCamera to_render_camera(const v1::Camera& camera, const Vec3d& origin) {
  return {to_vec(camera.eye()) - origin, to_vec(camera.target()) - origin, to_vec(camera.up()), camera.vertical_fov_degrees()};
}

absl::StatusOr<v1::Camera> camera_of(const SampleFlags& flags, const Box3d& box, const Size& size) {
  absl::StatusOr<v1::Camera> camera = picture_camera_of(flags, box, size.aspect());
  if (camera.ok() && camera->orthographic_height() > 0) {
    return absl::InvalidArgumentError("camera: pictures are made by perspective cameras only; leave ortho= out");
  }
  return camera;
}

absl::StatusOr<Scene> load_scene(const RenderFlags& flags, const Size& size) {
  absl::StatusOr<client::Points> points = load_points(flags.input);
  if (!points.ok()) return points.status();
  if (points->size() == 0) return absl::InvalidArgumentError(absl::StrCat(flags.input, ": holds no points"));
  Scene scene;
  scene.cloud = *std::move(points);
  scene.count = scene.cloud.size();
  if (flags.no_colour) scene.cloud.colours.clear();
  if (flags.style == "dots") scene.options.mode = RenderMode::kDots;
  Box3d box;
  const Vec3d origin(scene.cloud.origin.data());
  for (const auto& [x, y, z] : scene.cloud.positions) box.extend(origin + Vec3d(x, y, z));
  absl::StatusOr<v1::Camera> camera = camera_of(flags.sample, box, size);
  if (!camera.ok()) return camera.status();
  scene.camera = *std::move(camera);
  return scene;
}

absl::StatusOr<Scene> make_scene(const RenderFlags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  const bool has_own_points = flags.what == "surface" || flags.what == "samples" || flags.what == "cut";
  const std::uint64_t points = session_points(has_own_points ? flags.sample.points : 0);
  const absl::StatusOr<v1::SessionOptions> session_options =
      make_session_options(flags.session, points, ranks_seed(flags.sample, options.seed));
  if (!session_options.ok()) return session_options.status();
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  const Maker maker{flags, options, size, (*host)->client(), stop};
  absl::StatusOr<OpenedMesh> opened = open_mesh(maker.client, flags.input, *session_options, options.quiet, stop);
  if (!opened.ok()) return opened.status();
  const Box3d box = box_of(opened->session.report().mesh());
  absl::StatusOr<v1::Camera> camera = camera_of(flags.sample, box, size);
  if (!camera.ok()) return camera.status();
  Scene scene;
  scene.camera = *std::move(camera);
  scene.crease_degrees = crease_degrees(opened->session);
  absl::Status status;
  if (has_own_points) {
    status = maker.add_samples(*opened, scene);
  } else {
    absl::StatusOr<client::Points> cloud = maker.even_cloud(*opened);
    status = cloud.status();
    if (cloud.ok()) scene.cloud = *std::move(cloud);
  }
  if (status.ok() && (flags.what == "cut" || flags.what == "mesh")) status = maker.add_mesh_lines(*opened, box, scene);
  if (status.ok() && flags.what == "surface-curve") status = maker.add_curve(box, scene);
  if (!status.ok()) return status;
  if (flags.no_colour) scene.cloud.colours.clear();
  return scene;
}

absl::StatusOr<Image> draw_scene(const Scene& scene, const Size& size) {
  const std::vector<Vec3f> positions = to_vectors(scene.cloud.positions), normals = to_vectors(scene.cloud.normals);
  const SplatCloud cloud{positions, normals, scene.cloud.radii, scene.cloud.colours, scene.crease_degrees};
  RenderOptions options = scene.options;
  options.width = size.width;
  options.height = size.height;
  if (std::int64_t{size.width} * size.height > kMaxSupersampledPixels) options.supersample = 1;
  return render_splats(cloud, to_render_camera(scene.camera, Vec3d(scene.cloud.origin.data())), options, scene.dots,
                       scene.dot_colours);
}

absl::StatusOr<v1::SessionOptions> curve_session_options(const RenderFlags& flags) {
  SessionFlags session = flags.session;
  if (session.omega == 0) session.omega = kCurveOmega;
  return make_session_options(session, flags.sample.points);
}

}  // namespace curvecast::cli
