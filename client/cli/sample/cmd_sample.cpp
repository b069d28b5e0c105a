#include <absl/strings/str_format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <memory>

#include "client/cli/commands.h"
#include "client/cli/points_io.h"
#include "client/cli/report.h"
#include "client/cli/sample/mesh_sampling.h"
#include "client/lib/file_bytes.h"

namespace curvecast::cli {
namespace {

struct Flags {
  std::string mesh, output;
  SamplingFlags sampling;
};

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

absl::Status report(const Flags& flags, const CommonOptions& options, const OpenedMesh& opened,
                    const client::DecodedSample& sample, double total) {
  const v1::FrameStatistics& statistics = sample.statistics;
  const bool scattered = scatters(flags.sampling.sample);
  if (const std::string text = point_limit_text(sample.points.size(), statistics); !text.empty()) print_note(text);
  if (!options.json) {
    std::string text = absl::StrFormat("%d points ", sample.points.size());
    if (scattered) {
      absl::StrAppendFormat(&text, "on %d triangles\nseconds        read %.3f, scatter %.4f, encode %.4f, total %.3f\n",
                            opened.session.report().mesh().faces(), opened.seconds, statistics.equalise_seconds(),
                            statistics.encode_seconds(), total);
    } else {
      absl::StrAppendFormat(
          &text, "from %d curve vertices\nseconds        preprocess %.3f, density %.4f, equalise %.4f, encode %.4f, total %.3f\n",
          statistics.curve_vertices(), opened.seconds, statistics.density_seconds(), statistics.equalise_seconds(),
          statistics.encode_seconds(), total);
    }
    if (!flags.output.empty()) absl::StrAppendFormat(&text, "written        %s\n", flags.output);
    return print_text(text);
  }
  Json json = {{"points", sample.points.size()},
               {"wanted_points", statistics.wanted_points()},
               {"limit", point_limit_name(statistics.limit())},
               {"sampler", sampler_of(flags.sampling.sample)},
               {"seed", options.seed}};
  if (scattered) {
    json["faces"] = opened.session.report().mesh().faces();
    json["seconds"] = {{"read", opened.seconds},
                       {"scatter", statistics.equalise_seconds()},
                       {"encode", statistics.encode_seconds()},
                       {"total", total}};
  } else {
    json["sequence"] = sequence_of(flags.sampling.sample);
    json["curve_vertices"] = statistics.curve_vertices();
    json["session_id"] = opened.session.session_id();
    json["seconds"] = {{"preprocess", opened.seconds},
                       {"density", statistics.density_seconds()},
                       {"equalise", statistics.equalise_seconds()},
                       {"encode", statistics.encode_seconds()},
                       {"total", total}};
  }
  if (!flags.output.empty()) json["output"] = flags.output;
  return print_json(json);
}

absl::Status run(const Flags& flags, const CommonOptions& options, std::stop_token stop) {
  const Clock::time_point start = Clock::now();
  if (!flags.output.empty()) {
    if (absl::Status status = client::check_writable(flags.output); !status.ok()) return status;
  }
  const absl::StatusOr<SamplingRequests> requests = make_sampling_requests(flags.sampling, options.seed, flags.output);
  if (!requests.ok()) return requests.status();
  absl::StatusOr<std::unique_ptr<Host>> host =
      Host::open(options, requests->scatters ? SessionCaching::kNone : SessionCaching::kKeep);
  if (!host.ok()) return host.status();
  absl::StatusOr<SampledMesh> sampled =
      open_and_sample((*host)->client(), flags.mesh, *requests, flags.sampling, options.quiet, stop);
  if (!sampled.ok()) return sampled.status();
  client::DecodedSample& sample = sampled->sample;
  if (!flags.output.empty()) {
    const Clock::time_point encode_start = Clock::now();
    if (absl::Status status = save_sample(flags.output, sample.points, flags.sampling); !status.ok()) return status;
    sample.statistics.set_encode_seconds(sample.statistics.encode_seconds() + seconds_since(encode_start));
  }
  return report(flags, options, sampled->opened, sample, seconds_since(start));
}

}  // namespace

Command add_sample(CLI::App& root, CommonOptions& options) {
  CLI::App* app = add_command(
      root, options, "sample",
      "Places points on a mesh, exactly N or as many as a budget allows, evenly with respect to a density, and writes them with "
      "normals and splat radii.\n\n"
      "Points stand along the curve in .ply, .xyz, .pcd and .drc. In all other files, and as --splats, they stand in the order "
      "of "
      "their ranks where --sampler progressive or scattered gives them ranks, so that the first points of a file are an even, "
      "coarser set; with the equalised sampler there are no ranks, and they stand along the curve.",
      {"curvecast sample bunny.obj -n 50000 -o bunny.ply", "curvecast sample igea.ply -n 100000 --density curvature -o igea.drc",
       "curvecast sample igea.ply -n 20000 --density view:s0=0.1 --camera eye=0,0,3 -o view.pcd",
       "curvecast sample igea.ply --pixel-error 3 --density screen --density frustum --camera fov=20 -o screen.ply",
       "curvecast sample igea.ply -n 16384 --relax 10 --attributes surface -o blue_noise.npz",
       "curvecast sample scan.ply -n 1000000 --sampler scattered -o scan.las            # the quickest way from a mesh to points",
       "curvecast sample igea.ply -n 200000 --sampler progressive -o igea.glb",
       "curvecast sample igea.ply -n 200000 --sampler progressive --splats -o splats.ply",
       "curvecast sample igea.ply -n 20000 --density 'expression:1 + 9 * (z > 0)' --density brush:0,0,1,0.2,4 -o painted.ply"});
  add_cache_flags(app, options);
  const auto flags = std::make_shared<Flags>();
  app->add_option("MESH", flags->mesh, kMeshHelp)->required();
  app->add_option("-o,--output", flags->output,
                  "the points' file: .ply, .xyz, .pcd (lossless), .drc (Draco), .npy, .npz (NumPy), .glb (glTF), .spz (splats) "
                  "or .las; without it, only statistics")
      ->check(validator(check_output_ending, ""))
      ->type_name("FILE");
  add_sampling_flags(app, &flags->sampling);
  require_budget(app);
  return {app, [flags](const CommonOptions& common, std::stop_token stop) { return run(*flags, common, stop); }};
}

}  // namespace curvecast::cli
