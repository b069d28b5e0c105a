#include "client/bench/paper/paper_report.h"

#include <absl/strings/str_cat.h>

#include <cmath>

namespace curvecast::cli::bench {

std::vector<Claim> claims_of(const PaperFindings& findings) {
  constexpr double kRandomTolerance = 0.02;
  std::vector<Claim> claims;
  for (const MeshFindings& mesh : findings.meshes) {
    for (const RingLine& line : mesh.rings) {
      if (findings.quick || line.name != kRandomSampling.name) continue;
      claims.push_back({absl::StrCat(mesh.file, ": random points have the gradient -0.5, within 0.02: the measure is right"),
                        line.test.rms_gradient, kPaperRandomGradient,
                        std::abs(line.test.rms_gradient - kPaperRandomGradient) <= kRandomTolerance});
    }
    if (mesh.paper == nullptr) continue;
    for (const Way way : kWays) {
      const std::string name = absl::StrCat(mesh.file, ", ", kWayNames[way], ": ");
      for (const TableStage& stage : kTableStages) {
        const double ours = mesh.seconds[way].*stage.seconds, papers = mesh.paper->seconds.*stage.seconds;
        claims.push_back({absl::StrCat(name, stage.name, " takes fewer seconds than the paper's"), ours, papers, ours < papers});
      }
      if (findings.quick) continue;
      const double gradient = mesh.rings[way].test.rms_gradient;
      claims.push_back({absl::StrCat(name, "the discrepancy falls as steeply as the paper's, in the two digits that it prints"),
                        gradient, mesh.paper->gradient, std::round(100 * gradient) <= std::round(100 * mesh.paper->gradient)});
    }
  }
  return claims;
}

}  // namespace curvecast::cli::bench
