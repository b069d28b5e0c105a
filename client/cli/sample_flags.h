// The flags that say what a point set is, shared by sample, stream and render.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <string>
#include <vector>

#include "client/cli/camera_option.h"
#include "curvecast/v1/curvecast.pb.h"

namespace CLI {  // its header has globals that every source would compile anew
class App;
class Option;
}  // namespace CLI

namespace curvecast::cli {

struct SampleFlags {
  std::uint64_t points = 65'536;
  double pixel_error = 0;       // above 0: instead of points
  std::uint64_t max_bytes = 0;  // above 0: instead of points
  std::vector<std::string> density;
  std::string usual_sampler = "equalised";  // of the command, where the user names neither a sampler nor a sequence
  bool may_scatter = false;                 // the command knows the sampler "scattered", too
  std::string sampler, sequence;            // empty: not given
  std::uint32_t relaxation_rounds = 0;
  std::vector<std::string> cameras;
};

/// Returns the sampler: what --sampler says, equalised for a --sequence, else the command's usual one.
std::string sampler_of(const SampleFlags& flags);
/// Whether points are scattered straight on the mesh, without a session.
bool scatters(const SampleFlags& flags);
/// Returns the seed of the session: sessions that no progressive sampler needs are the same for all seeds.
std::uint64_t ranks_seed(const SampleFlags& flags, std::uint64_t seed);
/// Returns the sequence of the equalised sampler.
std::string sequence_of(const SampleFlags& flags);

/// -n, --density, --sampler and --sequence; values are checked while parsing. Precondition: flags->usual_sampler and may_scatter
/// are set. Returns the option -n.
CLI::Option* add_sample_flags(CLI::App* command, SampleFlags* flags);
/// --density alone.
void add_density_flag(CLI::App* command, SampleFlags* flags, const std::string& help);
/// --pixel-error and --max-bytes, which exclude -n and one another.
void add_budget_flags(CLI::App* command, SampleFlags* flags, CLI::Option* count);
/// Has the command refuse to run without one of these three.
void require_budget(CLI::App* command);
/// --camera; with `several` it may be repeated.
void add_camera_flag(CLI::App* command, SampleFlags* flags, bool several);

/// All but camera, viewport and encoding. The flags have been checked. The seed is that of the equalised sampler; of the
/// progressive one see make_session_options().
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
