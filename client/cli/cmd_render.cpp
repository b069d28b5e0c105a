#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>
#include <CLI/CLI.hpp>

#include <array>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/commands.h"
#include "client/cli/parameter_picture.h"
#include "client/cli/points_io.h"
#include "client/cli/progress_bar.h"
#include "client/cli/render_scene.h"
#include "client/cli/report.h"
#include "client/lib/file_bytes.h"
#include "core/render/jpeg_file.h"
#include "core/render/png_file.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 8> kSubjects = {"surface", "shaded", "samples", "mesh",
                                                       "cut",     "uv",     "curve",   "surface-curve"};
constexpr std::array<std::string_view, 2> kStyles = {"surface", "dots"};
constexpr int kMaxSide = 8192;                  // pixels
constexpr std::uint64_t kLegiblePoints = 1500;  // of dots, and of lines of a curve that can be told apart

/// What is drawn point by point, or line by line.
bool is_sparse(const std::string& what) { return what == "samples" || what == "curve" || what == "surface-curve"; }

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

bool is_jpeg(const std::string& path) { return check_ending(path, {".jpg", ".jpeg"}).ok(); }

absl::Status save(const Image& image, const std::string& path) {
  absl::StatusOr<std::string> file = is_jpeg(path) ? encode_jpeg(image) : encode_png(image);
  if (!file.ok()) return file.status();
  return client::write_bytes(path, *file);
}

absl::Status run_uv(const RenderFlags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  const absl::StatusOr<v1::SessionOptions> session_options = make_session_options(flags.session, flags.sample.points);
  if (!session_options.ok()) return session_options.status();
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  ProgressBar bar(progress_style(options.quiet), flags.input);
  const absl::StatusOr<client::UploadedMesh> uploaded = client.upload_with_companions(
      flags.input, [&](std::string_view stage, double fraction) { bar.update(stage, fraction); }, stop);
  if (!uploaded.ok()) return uploaded.status();
  bar.update("flatten", 0);
  const absl::StatusOr<client::ParameterMesh> mesh = client.get_parameter_mesh(*uploaded, *session_options, stop);
  if (!mesh.ok()) return mesh.status();
  const absl::StatusOr<UvPicture> picture = draw_uv(*mesh, size.width, size.height);
  if (!picture.ok()) return picture.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (absl::Status status = save(picture->image, flags.output); !status.ok()) return status;
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

/// The mesh on a server, which lasts as long as this.
struct HostedMesh {
  std::unique_ptr<Host> host;
  OpenedMesh mesh;
};

absl::StatusOr<HostedMesh> open_hosted(const RenderFlags& flags, const CommonOptions& options,
                                       const v1::SessionOptions& session_options, std::stop_token stop) {
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  absl::StatusOr<OpenedMesh> mesh = open_mesh((*host)->client(), flags.input, session_options, options.quiet, stop);
  if (!mesh.ok()) return mesh.status();
  return HostedMesh{*std::move(host), *std::move(mesh)};
}

absl::Status run_curve(const RenderFlags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  const absl::StatusOr<v1::SessionOptions> session_options = curve_session_options(flags);
  if (!session_options.ok()) return session_options.status();
  const absl::StatusOr<HostedMesh> hosted = open_hosted(flags, options, *session_options, stop);
  if (!hosted.ok()) return hosted.status();
  client::Client& client = hosted->host->client();
  const OpenedMesh& opened = hosted->mesh;
  const absl::StatusOr<client::Curve> curve = client.get_curve(opened.session.session_id(), stop);
  if (!curve.ok()) return curve.status();
  std::optional<client::ParameterMesh> mesh;
  if (flags.with_mesh) {
    absl::StatusOr<client::ParameterMesh> received = client.get_parameter_mesh(opened.mesh, *session_options, stop);
    if (!received.ok()) return received.status();
    mesh = *std::move(received);
  }
  const absl::StatusOr<CurvePicture> picture = draw_curve(*curve, mesh ? &*mesh : nullptr, size.width, size.height);
  if (!picture.ok()) return picture.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (absl::Status status = save(picture->image, flags.output); !status.ok()) return status;
  if (!options.json) {
    return print_text(absl::StrFormat("%d curve vertices, %d of %d discs, %dx%d pixels: %s\n", curve->info.curve_vertices(),
                                      picture->tiles, curve->discs.size(), size.width, size.height, flags.output));
  }
  return print_json({{"curve_vertices", curve->info.curve_vertices()},
                     {"discs", curve->discs.size()},
                     {"drawn", picture->tiles},
                     {"width", size.width},
                     {"height", size.height},
                     {"what", flags.what},
                     {"session_id", opened.session.session_id()},
                     {"output", flags.output}});
}

absl::Status run_shaded(const RenderFlags& flags, const CommonOptions& options, const Size& size, std::stop_token stop) {
  const absl::StatusOr<v1::SessionOptions> session_options = make_session_options(flags.session, session_points(0));
  if (!session_options.ok()) return session_options.status();
  const absl::StatusOr<HostedMesh> hosted = open_hosted(flags, options, *session_options, stop);
  if (!hosted.ok()) return hosted.status();
  client::Client& client = hosted->host->client();
  const OpenedMesh& opened = hosted->mesh;
  const v1::MeshInfo& mesh = opened.session.report().mesh();
  absl::StatusOr<v1::Camera> camera = camera_of(flags.sample, box_of(mesh), size);
  if (!camera.ok()) return camera.status();
  v1::RenderRequest request;
  request.set_session_id(opened.session.session_id());
  *request.mutable_sample()->add_cameras() = *std::move(camera);
  request.set_width(static_cast<std::uint32_t>(size.width));
  request.set_height(static_cast<std::uint32_t>(size.height));
  request.set_style(v1::PICTURE_STYLE_MESH);
  request.set_plain(flags.no_colour);
  request.set_format(is_jpeg(flags.output) ? v1::PICTURE_FORMAT_JPEG : v1::PICTURE_FORMAT_PNG);
  const absl::StatusOr<v1::RenderResponse> picture = client.render(request, stop);
  if (!picture.ok()) return picture.status();
  const std::string& file = is_jpeg(flags.output) ? picture->jpeg() : picture->png();
  if (absl::Status status = client::write_bytes(flags.output, file); !status.ok()) return status;
  if (!options.json) {
    return print_text(absl::StrFormat("%d faces, %dx%d pixels: %s\n", mesh.faces(), size.width, size.height, flags.output));
  }
  return print_json({{"faces", mesh.faces()},
                     {"width", size.width},
                     {"height", size.height},
                     {"what", flags.what},
                     {"session_id", opened.session.session_id()},
                     {"output", flags.output}});
}

absl::Status run(const RenderFlags& flags, const CommonOptions& options, std::stop_token stop) {
  absl::StatusOr<Size> size = parse_size(flags.size);
  if (!size.ok()) return size.status();
  if (absl::Status status = client::check_writable(flags.output); !status.ok()) return status;
  absl::StatusOr<bool> is_points = holds_points(flags.input);
  if (!is_points.ok()) return is_points.status();
  if (*is_points && flags.what != "surface") {
    return absl::InvalidArgumentError(absl::StrCat(flags.input, ": holds points; --what ", flags.what, " needs a mesh"));
  }
  if (flags.what == "uv") return run_uv(flags, options, *size, stop);
  if (flags.what == "curve") return run_curve(flags, options, *size, stop);
  if (flags.what == "shaded") return run_shaded(flags, options, *size, stop);
  absl::StatusOr<Scene> scene = *is_points ? load_scene(flags, *size) : make_scene(flags, options, *size, stop);
  if (!scene.ok()) return scene.status();
  absl::StatusOr<Image> image = draw_scene(*scene, *size);
  if (!image.ok()) return image.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (absl::Status status = save(*image, flags.output); !status.ok()) return status;
  if (!options.json) {
    return print_text(absl::StrFormat("%d %s, %dx%d pixels: %s\n", scene->count,
                                      absl::StrReplaceAll(scene->counted, {{"_", " "}}), size->width, size->height,
                                      flags.output));
  }
  return print_json({{scene->counted, scene->count},
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
      "Draws a mesh's point set, or a file of points, as a PNG or JPEG picture: a closed surface of splats, or dots, in its own "
      "colours where it has any. Or what preprocessing makes of a mesh, with --what. In space: shaded draws the mesh itself, "
      "in the light and the colours of surface, to hold that against; samples draws the points as dots on an even surface; "
      "mesh its triangles; cut the lines along which it is cut (red) and its own borders (blue); surface-curve the Hilbert "
      "curve on it. In the parameter square, disc by disc: uv draws the parameter mesh, red where surface is squeezed "
      "together, blue where it is spread out; curve the Hilbert curve. Curves run from blue to orange. -n, --density, "
      "--sequence and --seed apply to meshes only; of a curve -n, --omega and --base-density say how fine it is and where.",
      {"curvecast render bunny.obj -o bunny.png", "curvecast render points.ply --size 1920x1080 -o points.png",
       "curvecast render bunny.obj --what shaded --size 960x960 -o reference.png",
       "curvecast render igea.ply --what cut -o cut.png", "curvecast render igea.ply --what samples -n 3000 -o samples.png",
       "curvecast render igea.ply --what curve --base-density curvature -o curve.png",
       "curvecast render igea.ply --what surface-curve -n 4000 -o surface-curve.png",
       "curvecast render igea.ply --style dots -n 20000 --density view --camera fov=20 -o dots.png"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<RenderFlags>();
  app->add_option("INPUT", flags->input,
                  "a mesh (.ply, .obj, .off, .stl, .gltf, .glb, .3mf) or points (.drc, .xyz, .pcd, or a .ply without faces)")
      ->required();
  app->add_option("-o,--output", flags->output, "the picture: .png, or .jpg or .jpeg with some loss")
      ->check(validator(
          [](const std::string& path) {
            return check_ending(path, {".png", ".jpg", ".jpeg"});
          },
          ""))
      ->type_name("FILE")
      ->required();
  app->add_option("--size", flags->size, "of the picture, each side 1 to 8,192 pixels; of shaded 1 to 4,096, 4,194,304 in all")
      ->check(validator([](const std::string& text) { return parse_size(text).status(); }, ""))
      ->type_name("WxH")
      ->capture_default_str();
  add_camera_flag(app, &flags->sample, false);
  flags->sample.usual_sampler = "progressive";
  CLI::Option* points = add_sample_flags(app, &flags->sample);
  points->description(
      "number of points N, 1 to 4,000,000; of a curve: N for which it is made; default: 65,536, and 1,500 for samples, curve and "
      "surface-curve");
  CLI::Option* omega = add_session_flags(app, &flags->session);
  omega->description(omega->get_description() + ", and 1 for curve and surface-curve");
  app->add_option("--what", flags->what, "surface, shaded, samples, mesh, cut, surface-curve, uv or curve: see above")
      ->check(validator([](const std::string& text) { return check_choice("subject", text, kSubjects); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  app->add_option("--style", flags->style, "of --what surface: surface or dots")
      ->check(validator([](const std::string& text) { return check_choice("style", text, kStyles); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  app->add_flag("--with-mesh", flags->with_mesh, "behind --what curve, the parameter mesh, faint");
  app->add_flag("--no-colour", flags->no_colour, "as if of clay, whatever the colours of the mesh or the points");
  return {app, [flags, points](const CommonOptions& common, std::stop_token stop) {
            if (points->count() == 0 && is_sparse(flags->what)) flags->sample.points = kLegiblePoints;
            return run(*flags, common, stop);
          }};
}

}  // namespace curvecast::cli
