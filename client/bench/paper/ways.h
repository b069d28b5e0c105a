// The two ways in which ours is measured: as it comes, and as the paper has it.
#pragma once

#include <array>
#include <cstdint>

#include "client/cli/session_flags.h"
#include "core/pipeline/pipeline.h"

namespace curvecast::cli::bench {

/// Literally: `--parameteriser cgal --mapper id-buffer --area voronoi --sequence jittered`.
enum Way { kDefaults, kLiteral };
inline constexpr std::array<Way, 2> kWays = {kDefaults, kLiteral};
inline constexpr std::array<const char*, 2> kWayNames = {"defaults", "literal"};

/// How core prepares a mesh, for so many points.
PreprocessOptions preprocess_options(Way way, std::uint64_t points);
/// The same for a session.
SessionFlags session_flags(Way way);

}  // namespace curvecast::cli::bench
