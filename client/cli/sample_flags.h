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
  double pixel_error = 0;       // above 0: instead of points
  std::uint64_t max_bytes = 0;  // above 0: instead of points
  std::vector<std::string> density;
  std::string sampler = "equalised";
  std::string sequence = "jittered";
  std::vector<std::string> cameras;
};

/// -n, --density, --sampler and --sequence; values are checked while parsing. Returns the option -n.
CLI::Option* add_sample_flags(CLI::App* command, SampleFlags* flags);
/// --density alone.
void add_density_flag(CLI::App* command, SampleFlags* flags, const std::string& help);
/// --pixel-error and --max-bytes, which exclude -n and one another; one of the three is needed.
void add_budget_flags(CLI::App* command, SampleFlags* flags, CLI::Option* count);
/// --camera; with `several` it may be repeated.
void add_camera_flag(CLI::App* command, SampleFlags* flags, bool several);

/// All but camera, viewport and encoding. The flags have been checked.
absl::StatusOr<v1::SampleRequest> make_request(const SampleFlags& flags, std::uint64_t seed);

/// Cameras of one request, which all have pictures of the same shape.
struct Cameras {
  std::vector<v1::Camera> all;  // one at least
  double aspect = 1;            // width / height

  /// Returns a picture of this shape, 1,024 pixels high.
  v1::Viewport viewport() const;
};

/// Returns the cameras of the flags, for a box. InvalidArgument: their aspects differ.
absl::StatusOr<Cameras> cameras_of(const SampleFlags& flags, const Box3d& box);
/// Returns the camera of a picture of this aspect. InvalidArgument: the flags say another.
absl::StatusOr<v1::Camera> picture_camera_of(const SampleFlags& flags, const Box3d& box, double aspect);

}  // namespace curvecast::cli
