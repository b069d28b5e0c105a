#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "client/cli/choice.h"
#include "client/cli/commands.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "client/lib/file_bytes.h"
#include "client/lib/mesh_file.h"

namespace curvecast::cli {
namespace {

// As many triangles where the surface bends as keep it there as near as elsewhere.
constexpr char kUsualDensity[] = "curvature:kind=max,exponent=0.5";

constexpr std::string_view kMethods[] = {"surface", "parameter"};

struct Flags {
  std::string mesh, output;
  SampleFlags sample;
  SessionFlags session;
  std::uint32_t relaxations = 5;
  bool fit = false;
  double feature_degrees = 0;
  std::string method = "surface";
};

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

absl::Status report(const Flags& flags, const CommonOptions& options, const OpenedMesh& opened, const client::Mesh& mesh,
                    double remesh_seconds, double total) {
  const v1::RemeshInfo& info = mesh.info;
  const v1::LeastAngles& angles = info.angles();
  if (!options.json) {
    std::string text = absl::StrFormat("%d vertices, %d triangles: %d component%s, genus %d, %d border%s\n", info.vertices(),
                                       info.triangles(), info.components(), info.components() == 1 ? "" : "s", info.genus(),
                                       info.boundary_loops(), info.boundary_loops() == 1 ? "" : "s");
    absl::StrAppendFormat(&text, "least angles   median %.1f, 1st percentile %.1f, least %.1f degrees; %.2f %% below 20\n",
                          angles.median(), angles.percentile_1(), angles.least(), 100 * angles.below_20());
    absl::StrAppendFormat(&text, "seconds        preprocess %.3f, remesh %.3f, total %.3f\n", opened.seconds, remesh_seconds,
                          total);
    if (!flags.output.empty()) absl::StrAppendFormat(&text, "written        %s\n", flags.output);
    return print_text(text);
  }
  Json json = {{"vertices", info.vertices()},
               {"triangles", info.triangles()},
               {"components", info.components()},
               {"genus", info.genus()},
               {"boundary_loops", info.boundary_loops()},
               {"least_angles",
                {{"median", angles.median()},
                 {"percentile_1", angles.percentile_1()},
                 {"least", angles.least()},
                 {"below_20_share", angles.below_20()}}},
               {"seconds", {{"preprocess", opened.seconds}, {"remesh", remesh_seconds}, {"total", total}}},
               {"sampler", sampler_of(flags.sample)},
               {"relaxations", flags.relaxations},
               {"fit", flags.fit},
               {"feature_degrees", flags.feature_degrees},
               {"method", flags.method},
               {"seed", options.seed},
               {"session_id", opened.session.session_id()}};
  if (!flags.output.empty()) json["output"] = flags.output;
  return print_json(json);
}

absl::Status run(Flags flags, const CommonOptions& options, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  if (!flags.output.empty()) {
    if (absl::Status status = client::check_writable(flags.output); !status.ok()) return status;
  }
  if (flags.sample.density.empty()) flags.sample.density = {kUsualDensity};
  absl::StatusOr<v1::SampleRequest> wanted = make_request(flags.sample, options.seed);
  if (!wanted.ok()) return wanted.status();
  const absl::StatusOr<v1::SessionOptions> session_options =
      make_session_options(flags.session, session_points(flags.sample.points), ranks_seed(flags.sample, options.seed));
  if (!session_options.ok()) return session_options.status();
  absl::StatusOr<std::unique_ptr<Host>> host = Host::open(options, SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  client::Client& client = (*host)->client();
  absl::StatusOr<OpenedMesh> opened = open_mesh(client, flags.mesh, *session_options, options.quiet, stop);
  if (!opened.ok()) return opened.status();
  const absl::StatusOr<Cameras> cameras = cameras_of(flags.sample, box_of(opened->session.report().mesh()));
  if (!cameras.ok()) return cameras.status();
  v1::RemeshRequest request;
  request.set_session_id(opened->session.session_id());
  *request.mutable_sample() = *std::move(wanted);
  *request.mutable_sample()->mutable_cameras() = {cameras->all.begin(), cameras->all.end()};
  *request.mutable_sample()->mutable_viewport() = cameras->viewport();
  request.set_relaxations(flags.relaxations);
  request.set_fit(flags.fit);
  request.set_feature_degrees(flags.feature_degrees);
  request.set_method(flags.method == kMethods[1] ? v1::REMESH_METHOD_PARAMETER : v1::REMESH_METHOD_SURFACE);
  const Clock::time_point remesh_start = Clock::now();
  ProgressBar bar(progress_style(options.quiet), std::filesystem::path(flags.mesh).filename().string());
  const absl::StatusOr<client::Mesh> mesh = client.remesh(
      request, [&](std::string_view stage, double fraction) { bar.update(stage, fraction); }, stop);
  if (!mesh.ok()) return mesh.status();
  bar.finish();
  const double remesh_seconds = seconds_since(remesh_start);
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (!flags.output.empty()) {
    if (absl::Status status = client::write_mesh_file(flags.output, *mesh); !status.ok()) return status;
  }
  return report(flags, options, *opened, *mesh, remesh_seconds, seconds_since(start));
}

}  // namespace

Command add_remesh(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "remesh",
      "Makes a new triangle mesh of a surface, of exactly N well-shaped vertices, dense where the density is: manifold, with the "
      "components, tunnels and borders that the surface has. By default denser where it bends more.",
      {"curvecast remesh bunny.obj -n 10000 -o bunny10k.ply", "curvecast remesh igea.ply -n 50000 --density uniform -o igea.glb",
       "curvecast remesh igea.ply -n 20000 --fit -o igea.obj", "curvecast remesh part.stl -n 20000 --features 40 -o part.obj",
       "curvecast remesh igea.ply -n 20000 --density brush:0,0,1,0.2,4 -o painted.off"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  flags->sample.points = 10'000;
  flags->sample.usual_sampler = "progressive";
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  add_sample_flags(app, &flags->sample)->capture_default_str();
  add_camera_flag(app, &flags->sample, true);
  add_session_flags(app, &flags->session);
  app->add_option("--relax", flags->relaxations, "rounds in which vertices move along the surface, to more regular triangles")
      ->check(CLI::Range(0u, 100u))
      ->type_name("ROUNDS")
      ->capture_default_str();
  app->add_flag("--fit", flags->fit,
                "move vertices off the surface, to where triangles come nearest to it: half the distance or less");
  app->add_option("--features", flags->feature_degrees, "edges sharper than this stay edges; 0 = none")
      ->check(CLI::Range(0.0, 180.0))
      ->type_name("DEGREES")
      ->capture_default_str();
  app->add_option(
         "--method", flags->method,
         "how points are triangulated before they move: surface, on the mesh itself, or parameter, in the square that it is "
         "mapped to, as the paper has it, for comparison")
      ->check(validator([](const std::string& text) { return check_choice("method", text, kMethods); }, ""))
      ->type_name("METHOD")
      ->capture_default_str();
  app->add_option("-o,--output", flags->output,
                  "the mesh's file: .ply, .obj, .off, .stl, .glb or .drc; without it, only statistics")
      ->check(validator(client::check_mesh_ending, ""))
      ->type_name("FILE");
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
