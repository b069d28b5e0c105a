#include "client/cli/sample/batch_settings.h"

#include <absl/strings/str_cat.h>
#include <CLI/CLI.hpp>

#include <array>
#include <filesystem>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "client/cli/choice.h"

namespace curvecast::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kNone[] = "none";
constexpr std::array<std::string_view, 10> kFormats = {"ply", "xyz", "pcd", "drc", "npy", "npz", "glb", "spz", "las", kNone};

bool says_how_many(const SampleFlags& flags) { return flags.points > 0 || flags.pixel_error > 0 || flags.max_bytes > 0; }

/// The name of the option in "--name=value".
std::string option_of(const std::string& argument) { return argument.substr(0, argument.find('=')); }

absl::Status at_line(const ManifestEntry& entry, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("line ", entry.line, ": ", entry.mesh, ": ", why));
}

/// One name for each file, as far as that can be told without looking.
std::string normal(const fs::path& path) { return fs::absolute(path).lexically_normal().string(); }

PlannedMesh plan_mesh(ManifestEntry entry, const std::string& folder, const BatchSettings& settings) {
  PlannedMesh planned{.path = (fs::path(folder) / entry.mesh).string()};
  planned.output = settings.output_of(entry.name);
  planned.record = settings.has_points() ? absl::StrCat(planned.output, ".json") : absl::StrCat(entry.name, ".session.json");
  planned.mesh = std::move(entry.mesh);
  planned.name = std::move(entry.name);
  planned.arguments = std::move(entry.arguments);
  return planned;
}

}  // namespace

bool BatchSettings::has_points() const { return format != kNone; }

std::string BatchSettings::output_of(const std::string& name) const {
  return has_points() ? absl::StrCat(name, ".", format) : "";
}

void add_batch_settings(CLI::App* command, BatchSettings* settings) {
  add_sampling_flags(command, &settings->sampling);
  command
      ->add_option("--max-points", settings->sampling.max_points,
                   "N for which a session is made, as of preprocess; default: as many as are wanted, 65,536 at least")
      ->check(point_count_range())
      ->type_name("N");
  command
      ->add_option(
          "--format", settings->format,
          "of the points' files: ply, xyz, pcd (lossless), drc (Draco), npy, npz (NumPy), glb (glTF), spz (splats) or las, as "
          "of sample; none: only sessions, for --cache or --server")
      ->check(validator([](const std::string& text) { return check_choice("format", text, kFormats); }, ""))
      ->type_name("NAME")
      ->capture_default_str();
}

EntryOptions::EntryOptions(BatchSettings usual)
    : usual_(std::move(usual)), settings_(usual_), app_(std::make_unique<CLI::App>()) {
  app_->set_help_flag();  // "help" is no option of a mesh
  add_batch_settings(app_.get(), &settings_);
  app_->add_option("--seed", settings_.seed);
}

EntryOptions::~EntryOptions() = default;

absl::StatusOr<BatchSettings> EntryOptions::of(const std::vector<std::string>& arguments) {
  settings_ = usual_;
  for (const std::string& argument : arguments) {
    const std::string option = option_of(argument);
    if (app_->get_option_no_throw(option) == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat("there is no option '", option.substr(2), "' of a mesh"));
    }
    // Of the three that say how many points, the mesh's own counts.
    SampleFlags& sample = settings_.sampling.sample;
    if (option == "--points" || option == "--pixel-error" || option == "--max-bytes") {
      sample.points = sample.max_bytes = 0;
      sample.pixel_error = 0;
    }
  }
  if (!arguments.empty()) {
    try {
      app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // it wants them from the last one on
    } catch (const CLI::ParseError& error) {
      return absl::InvalidArgumentError(error.what());
    }
  }
  if (settings_.has_points() && !says_how_many(settings_.sampling.sample)) {
    return absl::InvalidArgumentError("how many points? say --points, --pixel-error or --max-bytes, for all or for this mesh");
  }
  if (scatters(settings_.sampling.sample) && !settings_.has_points()) {
    return absl::InvalidArgumentError("--format none makes sessions only; scattered points have none");
  }
  if (absl::Status status = make_sampling_requests(settings_.sampling, settings_.seed, settings_.output_of("x")).status();
      !status.ok())
    return status;
  return settings_;
}

absl::StatusOr<std::vector<PlannedMesh>> plan_batch(std::vector<ManifestEntry> entries, const std::string& folder,
                                                    const std::string& out, EntryOptions& options) {
  std::vector<PlannedMesh> plan;
  plan.reserve(entries.size());
  std::unordered_map<std::string, std::size_t> line_of_record, line_of_mesh;
  for (const ManifestEntry& entry : entries) line_of_mesh.try_emplace(normal(fs::path(folder) / entry.mesh), entry.line);
  for (ManifestEntry& entry : entries) {
    const absl::StatusOr<BatchSettings> settings = options.of(entry.arguments);
    if (!settings.ok()) return at_line(entry, settings.status().message());
    const std::size_t line = entry.line;
    const PlannedMesh& planned = plan.emplace_back(plan_mesh(std::move(entry), folder, *settings));
    const auto [other, is_new] = line_of_record.try_emplace(planned.record, line);
    if (!is_new) {
      return absl::InvalidArgumentError(absl::StrCat(
          "line ", line, ": ", planned.mesh, ": its output ", planned.output.empty() ? planned.record : planned.output,
          " is that of line ", other->second, " too; give one of them another \"name\""));
    }
    const auto replaced = line_of_mesh.find(normal(fs::path(out) / planned.output));
    if (replaced != line_of_mesh.end()) {
      return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", planned.mesh, ": its output ", planned.output,
                                                     " would replace the mesh of line ", replaced->second,
                                                     "; give another folder to --out"));
    }
  }
  return plan;
}

}  // namespace curvecast::cli
