#include "client/cli/sample_flags.h"

#include <absl/strings/str_cat.h>
#include <CLI/CLI.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/common.h"
#include "client/cli/density_term.h"
#include "proto/terms/sample_names.h"

namespace curvecast::cli {
namespace {

constexpr int kMostCameras = 16;
constexpr char kProgressive[] = "progressive", kScattered[] = "scattered";
constexpr std::array<std::string_view, 3> kSamplersAndScattered = {terms::kSamplers[0], terms::kSamplers[1], kScattered};

/// What the flags say; where that is nothing, one camera of which nothing is said.
absl::StatusOr<std::vector<CameraOption>> parse_cameras(const SampleFlags& flags) {
  std::vector<CameraOption> options;
  for (const std::string& text : flags.cameras) {
    absl::StatusOr<CameraOption> parsed = parse_camera(text);
    if (!parsed.ok()) return parsed.status();
    options.push_back(*parsed);
  }
  if (options.empty()) options.emplace_back();
  return options;
}

}  // namespace

std::string sampler_of(const SampleFlags& flags) {
  if (!flags.sampler.empty()) return flags.sampler;
  return flags.sequence.empty() ? flags.usual_sampler : "equalised";
}

bool scatters(const SampleFlags& flags) { return sampler_of(flags) == kScattered; }

std::uint64_t ranks_seed(const SampleFlags& flags, std::uint64_t seed) { return sampler_of(flags) == kProgressive ? seed : 0; }

std::string sequence_of(const SampleFlags& flags) { return flags.sequence.empty() ? "jittered" : flags.sequence; }

void add_density_flag(CLI::App* command, SampleFlags* flags, const std::string& help) {
  command->add_option("--density", flags->density, help)
      ->check(validator([](const std::string& text) { return parse_density_term(text).status(); }, ""))
      ->type_name("TERM")
      ->allow_extra_args(false);
}

CLI::Option* add_sample_flags(CLI::App* command, SampleFlags* flags) {
  CLI::Option* count = command->add_option("-n,--points", flags->points, "number of points N, 1 to 4,000,000")
                           ->check(point_count_range())
                           ->type_name("N");
  add_density_flag(command, flags, kDensityHelp);
  command
      ->add_option(
          "--sampler", flags->sampler,
          absl::StrCat(
              "equalised (the paper's: any sequence) or progressive (points with fixed ranks, evenly spread and apart: more "
              "points add to fewer, whatever the density)",
              flags->may_scatter
                  ? ", or scattered (straight on the faces of a mesh that is not prepared: as even as equalised, one "
                    "set of points in a tenth of the time)"
                  : "",
              "; default: ", flags->usual_sampler, flags->usual_sampler == kProgressive ? ", with --sequence equalised" : ""))
      ->check(validator(
          [may_scatter = flags->may_scatter](const std::string& text) {
            return may_scatter ? check_choice("sampler", text, kSamplersAndScattered) : terms::parse_sampler(text).status();
          },
          ""))
      ->type_name("NAME");
  command
      ->add_option(
          "--sequence", flags->sequence,
          "of the equalised sampler, placement along the curve: jittered (the default: low discrepancy without a pattern), "
          "regular, or endless sequences, of which more points add to fewer: vandercorput (or niederreiter, which in one "
          "dimension and base 2 is "
          "the same) or golden")
      ->check(validator([](const std::string& text) { return terms::parse_sequence(text).status(); }, ""))
      ->type_name("NAME");
  return count;
}

void add_budget_flags(CLI::App* command, SampleFlags* flags, CLI::Option* count) {
  CLI::Option* error =
      command
          ->add_option("--pixel-error", flags->pixel_error,
                       "instead of -n: as few points as leave none standing for more than a square of so many pixels' side "
                       "of a picture that is 1,024 pixels high")
          ->check(CLI::Range(1e-3, 1e4))
          ->type_name("PIXELS");
  CLI::Option* bytes =
      command
          ->add_option("--max-bytes", flags->max_bytes,
                       "instead of -n: as many points as take so many bytes on their way, with Draco; 1,024 at least")
          ->check(CLI::Range(std::uint64_t{1024}, std::numeric_limits<std::uint64_t>::max()))
          ->type_name("BYTES");
  count->excludes(error)->excludes(bytes);
  error->excludes(bytes);
}

void require_budget(CLI::App* command) {
  command->parse_complete_callback([command] {
    for (const char* name : {"--points", "--pixel-error", "--max-bytes"}) {
      if (command->count(name) > 0) return;
    }
    throw CLI::RequiredError("-n, --pixel-error or --max-bytes");
  });
}

void add_camera_flag(CLI::App* command, SampleFlags* flags, bool several) {
  CLI::Option* option =
      command
          ->add_option("--camera", flags->cameras,
                       absl::StrCat(kCameraHelp, several ? "; repeat for points that serve several cameras, at most 16" : ""))
          ->check(validator([](const std::string& text) { return parse_camera(text).status(); }, ""))
          ->type_name("CAMERA")
          ->allow_extra_args(false);
  option->expected(1, several ? kMostCameras : 1);
}

absl::StatusOr<v1::SampleRequest> make_request(const SampleFlags& flags, std::uint64_t seed) {
  v1::SampleRequest request;
  if (flags.pixel_error > 0) {
    request.set_pixel_error(flags.pixel_error);
  } else if (flags.max_bytes > 0) {
    request.set_max_bytes(flags.max_bytes);
  } else {
    request.set_points(flags.points);
  }
  request.set_seed(seed);
  request.set_relaxation_rounds(flags.relaxation_rounds);
  if (!scatters(flags)) {
    const absl::StatusOr<v1::Sampler> sampler = terms::parse_sampler(sampler_of(flags));
    if (!sampler.ok()) return sampler.status();
    request.set_sampler(*sampler);
    const absl::StatusOr<v1::Sequence> sequence = terms::parse_sequence(sequence_of(flags));
    if (!sequence.ok()) return sequence.status();
    request.set_sequence(*sequence);
  }
  if (absl::Status status = add_density_terms(flags.density, request.mutable_density()); !status.ok()) return status;
  return request;
}

v1::Viewport Cameras::viewport() const {
  constexpr std::uint32_t kHeight = 1024;  // for which --pixel-error is meant
  v1::Viewport viewport;
  viewport.set_width(static_cast<std::uint32_t>(std::lround(aspect * kHeight)));
  viewport.set_height(kHeight);
  return viewport;
}

absl::StatusOr<Cameras> cameras_of(const SampleFlags& flags, const Box3d& box) {
  const absl::StatusOr<std::vector<CameraOption>> options = parse_cameras(flags);
  if (!options.ok()) return options.status();
  Cameras cameras;
  cameras.aspect = options->front().aspect.value_or(1);
  for (const CameraOption& option : *options) {
    if (option.aspect.value_or(1) != cameras.aspect) {
      return absl::InvalidArgumentError("camera: the pictures of all cameras have the same aspect");
    }
    absl::StatusOr<v1::Camera> camera = resolve_camera(option, box, cameras.aspect);
    if (!camera.ok()) return camera.status();
    cameras.all.push_back(*std::move(camera));
  }
  return cameras;
}

absl::StatusOr<v1::Camera> picture_camera_of(const SampleFlags& flags, const Box3d& box, double aspect) {
  const absl::StatusOr<std::vector<CameraOption>> options = parse_cameras(flags);
  if (!options.ok()) return options.status();
  if (options->front().aspect) {
    return absl::InvalidArgumentError("camera: a picture's aspect is that of --size; leave aspect= out");
  }
  return resolve_camera(options->front(), box, aspect);
}

}  // namespace curvecast::cli
