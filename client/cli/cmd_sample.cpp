#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string_view>

#include "client/cli/choice.h"
#include "client/cli/commands.h"
#include "client/cli/points_io.h"
#include "client/cli/report.h"
#include "client/cli/sample_flags.h"
#include "client/cli/session_flags.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 5> kAttributes = {"curvatures", "rank", "surface", "directions", "scalars"};
constexpr std::array<v1::PointAttribute, kAttributes.size()> kAttributeValues = {
    v1::POINT_ATTRIBUTE_CURVATURES, v1::POINT_ATTRIBUTE_RANK, v1::POINT_ATTRIBUTE_SURFACE, v1::POINT_ATTRIBUTE_DIRECTIONS,
    v1::POINT_ATTRIBUTE_SCALARS};

struct Flags {
  std::string mesh, output;
  std::vector<std::string> attributes;
  SampleFlags sample;
  SessionFlags session;
  std::optional<int> position_bits;
  client::DrcOptions drc;  // all but position_bits
  bool first_answer = false;
};

constexpr std::chrono::minutes kPatience{5};  // with the refinement of the curve

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

absl::Status report(const Flags& flags, const CommonOptions& options, const OpenedMesh& opened,
                    const client::DecodedSample& sample, double total) {
  const v1::FrameStatistics& statistics = sample.statistics;
  if (const std::string text = point_limit_text(sample.points.size(), statistics); !text.empty()) print_note(text);
  if (!options.json) {
    std::string text = absl::StrFormat("%d points from %d curve vertices\n", sample.points.size(), statistics.curve_vertices());
    absl::StrAppendFormat(&text, "seconds        preprocess %.3f, density %.4f, equalise %.4f, encode %.4f, total %.3f\n",
                          opened.seconds, statistics.density_seconds(), statistics.equalise_seconds(),
                          statistics.encode_seconds(), total);
    if (!flags.output.empty()) absl::StrAppendFormat(&text, "written        %s\n", flags.output);
    return print_text(text);
  }
  Json json = {{"points", sample.points.size()},
               {"wanted_points", statistics.wanted_points()},
               {"limit", point_limit_name(statistics.limit())},
               {"curve_vertices", statistics.curve_vertices()},
               {"seconds",
                {{"preprocess", opened.seconds},
                 {"density", statistics.density_seconds()},
                 {"equalise", statistics.equalise_seconds()},
                 {"encode", statistics.encode_seconds()},
                 {"total", total}}},
               {"sampler", sampler_of(flags.sample)},
               {"sequence", sequence_of(flags.sample)},
               {"seed", options.seed},
               {"session_id", opened.session.session_id()}};
  if (!flags.output.empty()) json["output"] = flags.output;
  return print_json(json);
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  if (!flags.output.empty()) {
    if (absl::Status status = client::check_writable(flags.output); !status.ok()) return status;
  }
  v1::ResampleRequest request;
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
  request.set_session_id(opened->session.session_id());
  *request.mutable_sample() = *std::move(wanted);
  *request.mutable_sample()->mutable_cameras() = {cameras->all.begin(), cameras->all.end()};
  *request.mutable_sample()->mutable_viewport() = cameras->viewport();
  for (const std::string& attribute : flags.attributes) {
    const auto choice = std::find(kAttributes.begin(), kAttributes.end(), attribute) - kAttributes.begin();
    request.mutable_sample()->add_attributes(kAttributeValues[static_cast<std::size_t>(choice)]);
  }
  if (flags.sample.max_bytes == 0) {
    // Lossless on the way here, so that a .drc file is quantised once, on one lattice for all blocks.
    request.mutable_sample()->mutable_encoding()->mutable_raw();
  } else {
    request.mutable_sample()->mutable_encoding()->mutable_draco()->set_position_bits(flags.position_bits.value_or(0));
    request.mutable_sample()->mutable_encoding()->mutable_draco()->set_normal_bits(flags.drc.normal_bits);
  }
  absl::StatusOr<client::DecodedSample> sample =
      flags.first_answer ? client.resample(request, stop) : client.resample_refined(request, kPatience, stop);
  if (!sample.ok()) return sample.status();
  if (stop.stop_requested()) return absl::CancelledError("cancelled");
  if (!flags.output.empty()) {
    const Clock::time_point encode_start = Clock::now();
    client::DrcOptions drc = flags.drc;
    drc.position_bits = flags.position_bits.value_or(drc.position_bits);
    if (absl::Status status = save_points(flags.output, sample->points, drc); !status.ok()) return status;
    sample->statistics.set_encode_seconds(sample->statistics.encode_seconds() + seconds_since(encode_start));
  }
  return report(flags, options, *opened, *sample, seconds_since(start));
}

}  // namespace

Command add_sample(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "sample",
      "Places points on a mesh, exactly N or as many as a budget allows, evenly with respect to a density, and writes them with "
      "normals and splat radii.",
      {"curvecast sample bunny.obj -n 50000 -o bunny.ply", "curvecast sample igea.ply -n 100000 --density curvature -o igea.drc",
       "curvecast sample igea.ply -n 20000 --density view:s0=0.1 --camera eye=0,0,3 -o view.pcd",
       "curvecast sample igea.ply --pixel-error 3 --density screen --density frustum --camera fov=20 -o screen.ply",
       "curvecast sample igea.ply -n 20000 --density 'expression:1 + 9 * (z > 0)' --density brush:0,0,1,0.2,4 -o painted.ply"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  CLI::Option* count = add_sample_flags(app, &flags->sample);
  add_budget_flags(app, &flags->sample, count);
  add_camera_flag(app, &flags->sample, true);
  add_session_flags(app, &flags->session);
  app->add_option("-o,--output", flags->output,
                  "the points' file: .ply, .xyz, .pcd (lossless) or .drc (Draco); without it, only statistics")
      ->check(validator(check_points_ending, ""))
      ->type_name("FILE");
  app->add_option(
         "--attributes", flags->attributes,
         "more of each point, in a .ply file: curvatures (principal), directions (of the least curvature; across it runs the "
         "largest), scalars (the mesh's named values), rank (of the progressive sampler), surface (face of the repaired mesh and "
         "place in it); separated by commas")
      ->delimiter(',')
      ->check(validator([](const std::string& text) { return check_choice("attribute", text, kAttributes); }, ""))
      ->type_name("NAME");
  app->add_flag("--first-answer", flags->first_answer,
                "take the first point set, even where the curve is too coarse for the density and a finer one is being made");
  app->add_option(
         "--position-bits", flags->position_bits,
         "of a .drc file and of an answer within --max-bytes, per coordinate; without it 16 in a file, and in an answer as "
         "many as the camera's pixels ask for")
      ->check(CLI::Range(1, 30));
  app->add_option("--normal-bits", flags->drc.normal_bits, "of a .drc file")->check(CLI::Range(2, 30))->capture_default_str();
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
