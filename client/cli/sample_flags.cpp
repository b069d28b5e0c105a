#include "client/cli/sample_flags.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "client/cli/choice.h"
#include "client/cli/common.h"
#include "client/cli/density_term.h"

namespace curvecast::cli {
namespace {

constexpr std::array<std::string_view, 4> kSequences = {"jittered", "regular", "vandercorput", "golden"};
constexpr std::array<v1::Sequence, kSequences.size()> kSequenceValues = {v1::SEQUENCE_JITTERED, v1::SEQUENCE_REGULAR,
                                                                         v1::SEQUENCE_VAN_DER_CORPUT, v1::SEQUENCE_GOLDEN_RATIO};

}  // namespace

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
          "--sequence", flags->sequence,
          "placement along the curve: jittered (low discrepancy without a pattern), regular, or endless sequences, of which "
          "more points add to fewer: vandercorput or golden")
      ->check(validator([](const std::string& text) { return check_choice("sequence", text, kSequences); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
  return count;
}

void add_camera_flag(CLI::App* command, SampleFlags* flags) {
  command->add_option("--camera", flags->camera, kCameraHelp)
      ->check(validator([](const std::string& text) { return parse_camera(text).status(); }, ""))
      ->type_name("CAMERA");
}

absl::StatusOr<v1::SampleRequest> make_request(const SampleFlags& flags, std::uint64_t seed) {
  v1::SampleRequest request;
  request.set_points(flags.points);
  request.set_seed(seed);
  const auto choice = std::find(kSequences.begin(), kSequences.end(), flags.sequence) - kSequences.begin();
  request.set_sequence(kSequenceValues[static_cast<std::size_t>(choice)]);
  if (absl::Status status = add_density_terms(flags.density, request.mutable_density()); !status.ok()) return status;
  return request;
}

absl::StatusOr<v1::Camera> camera_of(const SampleFlags& flags, const Box3d& box, double aspect) {
  CameraOption option;
  if (!flags.camera.empty()) {
    absl::StatusOr<CameraOption> parsed = parse_camera(flags.camera);
    if (!parsed.ok()) return parsed.status();
    option = *parsed;
  }
  return resolve_camera(option, box, aspect);
}

}  // namespace curvecast::cli
