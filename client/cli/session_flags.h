// The flags that say how a mesh is prepared, shared by all commands that make sessions.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "curvecast/v1/curvecast.pb.h"

namespace CLI {  // its header has globals that every source would compile anew
class App;
class Option;
}  // namespace CLI

namespace curvecast::cli {

struct SessionFlags {
  std::string parameteriser = "own", mapper = "exact", area = "exact";
  std::vector<std::string> base_density;
  double omega = 0;               // 0: the API's default
  std::uint64_t chart_faces = 0;  // as omega
  std::optional<double> crease;   // degrees; none: the API's default
};

/// Adds --base-density, --omega, --crease, --chart-faces, --parameteriser, --mapper and --area; values are checked while parsing.
/// Returns --omega.
CLI::Option* add_session_flags(CLI::App* command, SessionFlags* flags);

/// InvalidArgument where flags were given that only say how a curve is made, for points that need none.
absl::Status check_without_session(const SessionFlags& flags);

/// `points`: N for which the curve is made. `seed`: of the progressive sampler. The flags have been checked.
absl::StatusOr<v1::SessionOptions> make_session_options(const SessionFlags& flags, std::uint64_t points, std::uint64_t seed = 0);

std::string mapper_name(v1::Mapper mapper);
std::string area_name(v1::AreaElement area);

}  // namespace curvecast::cli
