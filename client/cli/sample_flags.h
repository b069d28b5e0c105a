// The flags that say what a point set is, shared by sample, stream and render.
#pragma once

#include <absl/status/statusor.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/camera_option.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli {

struct SampleFlags {
  std::uint64_t points = 65'536;
  std::vector<std::string> density;
  std::string sequence = "jittered";
  std::string camera;
};

/// -n, --density and --sequence; values are checked while parsing. Returns the option -n.
CLI::Option* add_sample_flags(CLI::App* command, SampleFlags* flags);
/// --density alone.
void add_density_flag(CLI::App* command, SampleFlags* flags, const std::string& help);
/// --camera.
void add_camera_flag(CLI::App* command, SampleFlags* flags);

/// All but camera, viewport and encoding. The flags have been checked.
absl::StatusOr<v1::SampleRequest> make_request(const SampleFlags& flags, std::uint64_t seed);

/// The camera of the flags, for a box.
absl::StatusOr<v1::Camera> camera_of(const SampleFlags& flags, const Box3d& box, double aspect);

}  // namespace curvecast::cli
