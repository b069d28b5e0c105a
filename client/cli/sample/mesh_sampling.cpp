#include "client/cli/sample/mesh_sampling.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/common.h"
#include "client/cli/density_term.h"
#include "client/cli/points_io.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "proto/terms/sample_names.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 3> kGlbNumbers = {"floats", "quantised", "meshopt"};
constexpr std::array<formats::GlbOptions, kGlbNumbers.size()> kGlbValues = {
    {{.quantise = false}, {.quantise = true}, {.quantise = true, .compress = true}}};

/// Which of `names`, one of which it is.
template <std::size_t N>
std::size_t choice_of(const std::string& name, const std::array<std::string_view, N>& names) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

absl::Status check_scattering(const SamplingFlags& flags) {
  if (flags.sample.pixel_error > 0 || flags.sample.max_bytes > 0) {
    return absl::InvalidArgumentError("--sampler scattered makes so many points as -n says; it knows no other budget");
  }
  if (!flags.sample.sequence.empty()) {
    return absl::InvalidArgumentError("--sequence is for the equalised sampler; points are scattered at equal steps");
  }
  return check_without_session(flags.session);
}

absl::Status add_cameras(const SampleFlags& flags, const v1::MeshInfo& mesh, v1::SampleRequest* request) {
  const absl::StatusOr<Cameras> cameras = cameras_of(flags, box_of(mesh));
  if (!cameras.ok()) return cameras.status();
  *request->mutable_cameras() = {cameras->all.begin(), cameras->all.end()};
  *request->mutable_viewport() = cameras->viewport();
  return absl::OkStatus();
}

}  // namespace

void add_sampling_flags(CLI::App* command, SamplingFlags* flags) {
  flags->sample.may_scatter = true;
  CLI::Option* count = add_sample_flags(command, &flags->sample);
  add_budget_flags(command, &flags->sample, count);
  add_camera_flag(command, &flags->sample, true);
  add_session_flags(command, &flags->session);
  command
      ->add_option("--relax", flags->sample.relaxation_rounds,
                   "rounds, up to 100, in which points that have no ranks move along the surface, away from their "
                   "neighbours, to blue noise: 3 will do, 10 leave fewer holes")
      ->check(CLI::Range(0, 100))
      ->type_name("ROUNDS");
  command
      ->add_option("--attributes", flags->attributes,
                   "more of each point, in .ply, .npz and .las files: curvatures (principal), directions (of the least "
                   "curvature; across it runs the "
                   "largest), scalars (the mesh's named values), rank (unless the sampler is equalised), surface (polygon of the "
                   "mesh's file, and place in it); separated by commas")
      ->delimiter(',')
      ->check(validator([](const std::string& text) { return terms::parse_attribute(text).status(); }, ""))
      ->type_name("NAME");
  command->add_flag("--first-answer", flags->first_answer,
                    "take the first point set, even where the curve is too coarse for the density and a finer one is being made");
  command
      ->add_option(
          "--position-bits", flags->position_bits,
          "of a .drc file and of an answer within --max-bytes, per coordinate; without it 16 in a file, and in an answer as "
          "many as the camera's pixels ask for")
      ->check(CLI::Range(1, 30));
  command->add_option("--normal-bits", flags->drc.normal_bits, "of a .drc file")->check(CLI::Range(2, 30))->capture_default_str();
  command->add_flag("--splats", flags->splats,
                    "a .ply or .glb file holds flat Gaussians that close the surface, for renderers of 3D Gaussian splatting, as "
                    ".spz does in any case");
  command
      ->add_option("--glb", flags->glb,
                   "numbers of a .glb file of points: floats, quantised (16 bits in the box: KHR_mesh_quantization) or meshopt "
                   "(these, compressed: EXT_meshopt_compression)")
      ->check(validator([](const std::string& text) { return check_choice("kind of numbers", text, kGlbNumbers); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
}

absl::StatusOr<SamplingRequests> make_sampling_requests(const SamplingFlags& flags, std::uint64_t seed,
                                                        const std::string& output) {
  if (flags.splats && !holds_splats(output)) {
    return absl::InvalidArgumentError("splats are written to .ply, .glb and .spz");
  }
  if (flags.sample.relaxation_rounds > 0 && sampler_of(flags.sample) == "progressive") {
    return absl::InvalidArgumentError("--relax is for the equalised sampler: ranked points stay where they are");
  }
  if (scatters(flags.sample)) {
    if (absl::Status status = check_scattering(flags); !status.ok()) return status;
  }
  absl::StatusOr<v1::SampleRequest> sample = make_request(flags.sample, seed);
  if (!sample.ok()) return sample.status();
  const std::uint64_t points = flags.max_points > 0 ? flags.max_points : session_points(flags.sample.points);
  absl::StatusOr<v1::SessionOptions> session = make_session_options(flags.session, points, ranks_seed(flags.sample, seed));
  if (!session.ok()) return session.status();
  for (const std::string& attribute : flags.attributes) {
    const absl::StatusOr<v1::PointAttribute> parsed = terms::parse_attribute(attribute);
    if (!parsed.ok()) return parsed.status();
    sample->add_attributes(*parsed);
  }
  const bool asked = std::count(flags.attributes.begin(), flags.attributes.end(), "rank") > 0;
  if (!asked && sampler_of(flags.sample) != "equalised" && is_in_order_of_rank(output, flags.splats)) {
    sample->add_attributes(v1::POINT_ATTRIBUTE_RANK);
  }
  if (flags.sample.max_bytes == 0) {
    // Lossless on the way here, so that a .drc file is quantised once, on one lattice for all blocks.
    sample->mutable_encoding()->mutable_raw();
  } else {
    sample->mutable_encoding()->mutable_draco()->set_position_bits(flags.position_bits.value_or(0));
    sample->mutable_encoding()->mutable_draco()->set_normal_bits(flags.drc.normal_bits);
  }
  return SamplingRequests{*std::move(session), *std::move(sample), scatters(flags.sample)};
}

absl::StatusOr<SampledMesh> scatter_on(client::Client& client, const std::string& mesh, const SamplingRequests& requests,
                                       const SamplingFlags& flags, const client::StageProgress& on_progress,
                                       const std::stop_token& stop) {
  const auto start = std::chrono::steady_clock::now();
  SampledMesh out;
  absl::StatusOr<client::UploadedMesh> uploaded = client.upload_with_companions(mesh, on_progress, stop);
  if (!uploaded.ok()) return uploaded.status();
  out.opened.mesh = *std::move(uploaded);
  v1::ScatterRequest request;
  *request.mutable_sample() = requests.sample;
  if (requests.session.has_crease_degrees()) request.set_crease_degrees(requests.session.crease_degrees());
  const auto& density = requests.sample.density();
  if (!flags.sample.cameras.empty() || std::any_of(density.begin(), density.end(), is_camera_term)) {
    const absl::StatusOr<v1::MeshInfo> info = client.inspect(out.opened.mesh, stop);
    if (!info.ok()) return info.status();
    if (absl::Status status = add_cameras(flags.sample, *info, request.mutable_sample()); !status.ok()) return status;
  }
  absl::StatusOr<client::ScatteredSample> scattered = client.scatter(out.opened.mesh, std::move(request), on_progress, stop);
  if (!scattered.ok()) return scattered.status();
  out.sample = std::move(scattered->sample);
  *out.opened.session.mutable_report()->mutable_mesh() = std::move(scattered->mesh);
  const v1::FrameStatistics& statistics = out.sample.statistics;
  out.opened.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() -
                       statistics.equalise_seconds() - statistics.encode_seconds();
  return out;
}

absl::StatusOr<client::DecodedSample> sample_session(client::Client& client, const v1::Session& session,
                                                     const SamplingFlags& flags, v1::SampleRequest request,
                                                     std::chrono::milliseconds patience, const std::stop_token& stop) {
  if (absl::Status status = add_cameras(flags.sample, session.report().mesh(), &request); !status.ok()) return status;
  v1::ResampleRequest resample;
  resample.set_session_id(session.session_id());
  *resample.mutable_sample() = std::move(request);
  absl::StatusOr<client::DecodedSample> sample =
      flags.first_answer ? client.resample(resample, stop) : client.resample_refined(resample, patience, stop);
  if (sample.ok() && stop.stop_requested()) return absl::CancelledError("cancelled");
  return sample;
}

absl::StatusOr<SampledMesh> open_and_sample(client::Client& client, const std::string& mesh, const SamplingRequests& requests,
                                            const SamplingFlags& flags, bool quiet, const std::stop_token& stop) {
  constexpr std::chrono::minutes kPatience{5};  // with the refinement of the curve
  if (requests.scatters) {
    ProgressBar bar(progress_style(quiet), std::filesystem::path(mesh).filename().string());
    const auto on_progress = [&](std::string_view stage, double fraction) { bar.update(stage, fraction); };
    return scatter_on(client, mesh, requests, flags, on_progress, stop);
  }
  absl::StatusOr<OpenedMesh> opened = open_mesh(client, mesh, requests.session, quiet, stop);
  if (!opened.ok()) return opened.status();
  absl::StatusOr<client::DecodedSample> sample = sample_session(client, opened->session, flags, requests.sample, kPatience, stop);
  if (!sample.ok()) return sample.status();
  return SampledMesh{*std::move(opened), *std::move(sample)};
}

absl::Status save_sample(const std::string& path, const client::Points& points, const SamplingFlags& flags) {
  SaveOptions options{.drc = flags.drc, .splats = flags.splats, .glb = kGlbValues[choice_of(flags.glb, kGlbNumbers)]};
  options.drc.position_bits = flags.position_bits.value_or(options.drc.position_bits);
  return save_points(path, points, options);
}

}  // namespace curvecast::cli
