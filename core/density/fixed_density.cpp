#include "core/density/fixed_density.h"

#include <algorithm>

namespace curvecast {
namespace {

Column<float> largest_of_blocks(std::span<const float> density) {
  Column<float> most;
  most.resize(block_count(density.size()));
  for (std::size_t b = 0; b < most.size(); ++b) {
    const std::span<const float> block = density.subspan(b * kBlockSize, std::min(kBlockSize, density.size() - b * kBlockSize));
    most[b] = *std::max_element(block.begin(), block.end());
  }
  return most;
}

}  // namespace

absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms) {
  if (!has_fixed_terms(terms)) return nullptr;
  auto fixed = std::make_shared<FixedDensity>();
  fixed->density.resize(curve.size());
  if (absl::Status status = evaluate_fixed_terms(curve, terms, std::span<float>(fixed->density)); !status.ok()) return status;
  fixed->mass = block_mass(fixed->density, curve.area);
  fixed->most = largest_of_blocks(fixed->density);
  return fixed;
}

}  // namespace curvecast
