#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/commands.h"
#include "client/cli/parameter_picture.h"
#include "client/cli/points_io.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/sample_flags.h"
#include "client/lib/file_bytes.h"
#include "core/render/png_file.h"
#include "core/render/splat_renderer.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 3> kSubjects = {"surface", "uv", "cut"};
constexpr std::array<std::string_view, 2> kStyles = {"surface", "dots"};
constexpr int kMaxSide = 8192;                             // pixels
constexpr double kLinesAcrossPicture = 300;                // the picture's longer side over the width of a cut
constexpr std::int64_t kMaxSupersampledPixels = 16 << 20;  // above, one sample per pixel: the renderer's limit

struct Flags {
  std::string input, output, size = "1280x960", what = "surface", style = "surface";
  bool no_colour = false;
  SampleFlags sample;
};

struct Size {
  int width = 0, height = 0;
  double aspect() const { return static_cast<double>(width) / height; }
};

absl::StatusOr<Size> parse_size(const std::string& text) {
  const std::vector<std::string> sides = absl::StrSplit(text, 'x');
  Size size;
  if (sides.size() != 2 || !absl::SimpleAtoi(sides[0], &size.width) || !absl::SimpleAtoi(sides[1], &size.height) ||
      size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", text, "' is not WIDTHxHEIGHT in pixels, such as 1280x960, each from 1 to ", kMaxSide));
  }
  return size;
}

std::vector<Vec3f> to_vectors(const std::vector<std::array<float, 3>>& values) {
  std::vector<Vec3f> vectors;
  vectors.reserve(values.size());
  for (const auto& [x, y, z] : values) vectors.emplace_back(x, y, z);
  return vectors;
}

/// What is drawn: the cloud is the surface, `dots` lie on it and may be empty (then the cloud's own are drawn).
struct Scene {
  client::Points cloud, dots;
  Box3d box;  // absolute coordinates
};

absl::StatusOr<Scene> load_scene(const std::string& path) {
  absl::StatusOr<client::Points> points = load_points(path);
  if (!points.ok()) return points.status();
  if (points->size() == 0) return absl::InvalidArgumentError(absl::StrCat(path, ": holds no points"));
  Scene scene{*std::move(points), {}, {}};
  const Vec3d origin(scene.cloud.origin.data());
  for (const auto& [x, y, z] : scene.cloud.positions) scene.box.extend(origin + Vec3d(x, y, z));
  return scene;
}

/// In coordinates relative to `origin`.
RenderCamera to_render_camera(const v1::Camera& camera, const Vec3d& origin) {
  return {to_vec(camera.eye()) - origin, to_vec(camera.target()) - origin, to_vec(camera.up()), camera.vertical_fov_degrees()};
}

absl::Status add_cuts(client::Client& client, const client::UploadedMesh& uploaded, const v1::Camera& camera, int height,
                      Scene& scene, std::stop_token stop) {
  const absl::StatusOr<client::ParameterMesh> mesh =
      client.get_parameter_mesh(uploaded, v1::PARAMETERISER_UNSPECIFIED, std::move(stop));
  if (!mesh.ok()) return mesh.status();
  LineDots lines = trace_cuts(*mesh, to_render_camera(camera, Vec3d::Zero()), height, Vec3d(scene.cloud.origin.data()));
  scene.dots = {};
  for (const Vec3f& p : lines.positions) scene.dots.positions.push_back({p.x(), p.y(), p.z()});
  scene.dots.colours = std::move(lines.colors);
  return absl::OkStatus();
}

absl::StatusOr<Scene> sample_scene(const Flags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  absl::StatusOr<v1::SampleRequest> sample = make_request(flags.sample, options.seed);
  if (!sample.ok()) return sample.status();
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  const std::uint64_t max_points = session_points(flags.sample.points);
  absl::StatusOr<OpenedMesh> opened = open_mesh(client, flags.input, max_points, options.quiet, stop);
  if (!opened.ok()) return opened.status();
  Scene scene{{}, {}, box_of(opened->session.report().mesh())};
  absl::StatusOr<v1::Camera> camera = camera_of(flags.sample, scene.box, size.aspect());
  if (!camera.ok()) return camera.status();
  v1::ResampleRequest request;
  request.set_session_id(opened->session.session_id());
  *request.mutable_sample() = *std::move(sample);
  *request.mutable_sample()->mutable_camera() = *camera;
  request.mutable_sample()->mutable_encoding()->mutable_raw();
  absl::StatusOr<client::DecodedSample> wanted = client.resample(request, stop);
  if (!wanted.ok()) return wanted.status();
  if (flags.what == "cut" || flags.style == "surface") {
    scene.cloud = std::move(wanted->points);
    if (flags.what == "surface") return scene;
    const absl::Status added = add_cuts(client, opened->mesh, *camera, size.height, scene, stop);
    if (!added.ok()) return added;
    return scene;
  }
  // Few dots make no surface to lie on: an even cloud as dense as the session allows does.
  scene.dots = std::move(wanted->points);
  request.mutable_sample()->set_points(max_points);
  request.mutable_sample()->clear_density();
  absl::StatusOr<client::DecodedSample> surface = client.resample(request, stop);
  if (!surface.ok()) return surface.status();
  scene.cloud = std::move(surface->points);
  return scene;
}

absl::StatusOr<Image> draw(const Scene& scene, const v1::Camera& camera, const Size& size, const Flags& flags) {
  const std::vector<Vec3f> positions = to_vectors(scene.cloud.positions), normals = to_vectors(scene.cloud.normals);
  const std::vector<Vec3f> dots = to_vectors(scene.dots.positions);
  const SplatCloud cloud{positions, normals, scene.cloud.radii, scene.cloud.colours};
  RenderOptions options;
  options.width = size.width;
  options.height = size.height;
  if (std::int64_t{size.width} * size.height > kMaxSupersampledPixels) options.supersample = 1;
  options.mode = flags.style == "dots" ? RenderMode::kDots : RenderMode::kSurface;
  if (flags.what == "cut") {
    options.mode = RenderMode::kDots;
    options.matte_under_dots = false;
    options.dot_diameter = std::clamp(std::max(size.width, size.height) / kLinesAcrossPicture, 2.0, 64.0);
  }
  return render_splats(cloud, to_render_camera(camera, Vec3d(scene.cloud.origin.data())), options, dots, scene.dots.colours);
}

absl::Status save_png(const Image& image, const std::string& path) {
  absl::StatusOr<std::string> png = encode_png(image);
  if (!png.ok()) return png.status();
  return client::write_bytes(path, *png);
}

absl::Status run_uv(const Flags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  ProgressBar bar(progress_style(options.quiet), flags.input);
  const absl::StatusOr<client::UploadedMesh> uploaded = client.upload_with_companions(
      flags.input, [&](std::string_view stage, double fraction) { bar.update(stage, fraction); }, stop);
  if (!uploaded.ok()) return uploaded.status();
  bar.update("flatten", 0);
  const absl::StatusOr<client::ParameterMesh> mesh = client.get_parameter_mesh(*uploaded, v1::PARAMETERISER_UNSPECIFIED, stop);
  if (!mesh.ok()) return mesh.status();
  const absl::StatusOr<UvPicture> picture = draw_uv(*mesh, size.width, size.height);
  if (!picture.ok()) return picture.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (absl::Status status = save_png(picture->image, flags.output); !status.ok()) return status;
  bar.finish();
  if (!options.json) {
    return print_text(absl::StrFormat(
        "%d of %d discs, surface over parameter area from 1/%.3g (blue) to %.3g (red) of the mean, "
        "%dx%d pixels: %s\n",
        picture->tiles, mesh->discs.size(), picture->scale, picture->scale, size.width, size.height, flags.output));
  }
  return print_json({{"discs", mesh->discs.size()},
                     {"drawn", picture->tiles},
                     {"scale", picture->scale},
                     {"width", size.width},
                     {"height", size.height},
                     {"what", flags.what},
                     {"output", flags.output}});
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  absl::StatusOr<Size> size = parse_size(flags.size);
  if (!size.ok()) return size.status();
  if (absl::Status status = client::check_writable(flags.output); !status.ok()) return status;
  absl::StatusOr<bool> is_points = holds_points(flags.input);
  if (!is_points.ok()) return is_points.status();
  if (*is_points && flags.what != "surface") {
    return absl::InvalidArgumentError(absl::StrCat(flags.input, ": holds points; --what ", flags.what, " needs a mesh"));
  }
  if (flags.what == "uv") return run_uv(flags, options, *size, stop);
  absl::StatusOr<Scene> scene = *is_points ? load_scene(flags.input) : sample_scene(flags, options, *size, stop);
  if (!scene.ok()) return scene.status();
  if (flags.no_colour) {
    scene->cloud.colours.clear();
    if (flags.what == "surface") scene->dots.colours.clear();
  }
  absl::StatusOr<v1::Camera> camera = camera_of(flags.sample, scene->box, size->aspect());
  if (!camera.ok()) return camera.status();
  absl::StatusOr<Image> image = draw(*scene, *camera, *size, flags);
  if (!image.ok()) return image.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (absl::Status status = save_png(*image, flags.output); !status.ok()) return status;
  const bool own_dots = flags.what == "surface" && scene->dots.size() > 0;
  const std::size_t points = own_dots ? scene->dots.size() : scene->cloud.size();
  if (!options.json)
    return print_text(absl::StrFormat("%d points, %dx%d pixels: %s\n", points, size->width, size->height, flags.output));
  return print_json({{"points", points},
                     {"width", size->width},
                     {"height", size->height},
                     {"what", flags.what},
                     {"style", flags.style},
                     {"seed", options.seed},
                     {"output", flags.output}});
}

}  // namespace

Command add_render(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "render",
      "Draws a mesh's point set, or a file of points, as a PNG picture: a closed surface of splats, or dots, in its own colours "
      "where it has any. Or what preprocessing makes of a mesh: --what uv draws its discs in the parameter square, red where "
      "surface is squeezed together, blue where it is spread out; --what cut draws the surface with the lines along which it is "
      "cut (red) and its own borders (blue). -n, --density, --sequence and --seed apply to meshes only.",
      {"curvecast render bunny.obj -o bunny.png", "curvecast render points.ply --size 1920x1080 -o points.png",
       "curvecast render igea.ply --what cut -o cut.png",
       "curvecast render igea.ply --style dots -n 20000 --density view --camera fov=20 -o dots.png"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  app->add_option("INPUT", flags->input,
                  "a mesh (.ply, .obj, .off, .stl, .gltf, .glb) or points (.drc, .xyz, .pcd, or a .ply without faces)")
      ->required();
  app->add_option("-o,--output", flags->output, "the picture: .png")
      ->check(validator([](const std::string& path) { return check_ending(path, {".png"}); }, ""))
      ->type_name("FILE")
      ->required();
  app->add_option("--size", flags->size, "of the picture, each side 1 to 8,192 pixels")
      ->check(validator([](const std::string& text) { return parse_size(text).status(); }, ""))
      ->type_name("WxH")
      ->capture_default_str();
  add_camera_flag(app, &flags->sample);
  add_sample_flags(app, &flags->sample)->capture_default_str();
  app->add_option("--what", flags->what, "surface, uv (the parameter mesh) or cut (the surface with its cuts)")
      ->check(validator([](const std::string& text) { return check_choice("subject", text, kSubjects); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  app->add_option("--style", flags->style, "of --what surface: surface or dots")
      ->check(validator([](const std::string& text) { return check_choice("style", text, kStyles); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  app->add_flag("--no-colour", flags->no_colour, "as if of clay, whatever the colours of the mesh or the points");
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
