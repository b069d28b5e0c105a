#include "client/bench/paper/paper_values.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>

#include <algorithm>
#include <array>
#include <string>

namespace curvecast::cli::bench {

const PaperMesh* paper_mesh(std::string_view file_name) {
  static const std::array<PaperMesh, 4> kMeshes = {{
      {"J Caesar", "caesar", 49'000, 24'000, {5.3, 7, 1, 0.001, 13.3}, -0.70, {{75, 0.009}, {50, 0.014}, {25, 0.02}}},
      {"Squirrel", "squirrel", 20'000, 10'000, {1.3, 4, 0.8, 0.001, 6.1}, -0.74, {{75, 0.008}, {50, 0.01}, {25, 0.018}}},
      {"Igea",
       "igea",
       268'000,
       134'000,
       {70, 10, 1.1, 0.0015, 81.1},
       -0.73,
       {{105, 0.004}, {75, 0.0032}, {50, 0.013}, {25, 0.017}}},
      {"Lion", "lion", 40'000, 20'000, {152, 5, 1, 0.001, 158.1}, -0.73, {{75, 0.009}, {50, 0.016}, {25, 0.022}}},
  }};
  const std::string lower = absl::AsciiStrToLower(std::string(file_name));
  const auto found = std::find_if(kMeshes.begin(), kMeshes.end(),
                                  [&](const PaperMesh& mesh) { return absl::StrContains(lower, mesh.file_part); });
  return found != kMeshes.end() ? &*found : nullptr;
}

}  // namespace curvecast::cli::bench
