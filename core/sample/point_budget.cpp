#include "core/sample/point_budget.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/density/view_factor.h"
#include "core/sample/point_set.h"
#include "core/sample/view_mass.h"

namespace curvecast {
namespace {

// A view's mass is exact enough when it is as for so many points.
constexpr std::uint64_t kEnoughPoints = 65'536;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A view's factors on all blocks.
struct Bounds {
  Bounds(const ViewFactor& view, const CurveBlocks& blocks) : factor(blocks.size()), change(blocks.size()) {
    view.of_blocks(blocks, 0, blocks.size(), factor.data(), change.data());
  }
  double most(std::size_t b) const { return factor[b] > 0 ? static_cast<double>(factor[b]) * (1.0 + change[b]) : 0; }
  double least(std::size_t b) const {
    return factor[b] > 0 ? static_cast<double>(factor[b]) * std::max(0.0, 1.0 - change[b]) : 0;
  }

  std::vector<float> factor, change;
};

/// The largest ratio of two views on a block's vertices, the lower one multiplied by `fixed`; an empty `fixed` is 1. Where the
/// lower one is zero there is none.
double largest_ratio(const SurfaceCurve& curve, std::span<const float> fixed, const ViewFactor& upper, const ViewFactor& lower,
                     std::size_t block) {
  const std::size_t begin = block * kBlockSize, n = std::min(kBlockSize, curve.size() - begin);
  float above[kBlockSize], below[kBlockSize];
  for (std::size_t i = 0; i < n; ++i) above[i] = 1;
  for (std::size_t i = 0; i < n; ++i) below[i] = fixed.empty() ? 1 : fixed[begin + i];
  const VertexColumns vertices = VertexColumns::of(curve, begin);
  upper.multiply(vertices, n, above);
  lower.multiply(vertices, n, below);
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (below[i] > 0) largest = std::max(largest, static_cast<double>(above[i]) / static_cast<double>(below[i]));
  }
  return largest;
}

/// Looks closely only at blocks that may hold the largest.
double largest_ratio(const SurfaceCurve& curve, std::span<const float> fixed, const ViewFactor& upper, const ViewFactor& lower) {
  const Bounds above(upper, curve.blocks), below(lower, curve.blocks);
  const std::size_t blocks = curve.blocks.size();
  double largest = 0;
  for (std::size_t b = 0; b < blocks && fixed.empty(); ++b) {
    if (const double most = below.most(b); most > 0 && std::isfinite(most)) largest = std::max(largest, above.least(b) / most);
  }
  for (std::size_t b = 0; b < blocks; ++b) {
    const double least = fixed.empty() ? below.least(b) : 0;
    const double most = above.most(b) > 0 && below.most(b) > 0 ? (least > 0 ? above.most(b) / least : kInfinity) : 0;
    if (most > largest) largest = std::max(largest, largest_ratio(curve, fixed, upper, lower, b));
  }
  return largest;
}

}  // namespace

absl::StatusOr<std::uint64_t> points_for_pixel_error(const SurfaceCurve& curve, const FixedDensity* fixed, const Density& density,
                                                     double pixels) {
  if (!(pixels > 0 && std::isfinite(pixels))) {
    return absl::InvalidArgumentError(absl::StrFormat("the error is %g pixels; it must be above 0, and finite", pixels));
  }
  if (absl::Status status = check_density(density); !status.ok()) return status;
  if (density.cameras.empty()) return absl::InvalidArgumentError("an error in pixels needs a camera");
  const std::span<const float> values = fixed == nullptr ? std::span<const float>() : fixed->density;
  const ViewFactor view(curve, density);
  ViewMass mass;
  view_mass(curve, values, fixed == nullptr ? curve.blocks.area : fixed->mass, view, kEnoughPoints, mass);
  if (!(mass.total > 0) || !std::isfinite(mass.total)) {
    return absl::FailedPreconditionError(
        "the density is zero on the whole surface (does anything face the camera?), so there is nowhere to put points");
  }
  const ViewFactor screen(curve, Density({ScreenTerm{}, FrustumTerm{}}, density.cameras));
  const double points = mass.total * largest_ratio(curve, values, screen, view) * (screen.pixels() / pixels / pixels);
  return static_cast<std::uint64_t>(std::ceil(std::clamp(points, 1.0, static_cast<double>(kMaxPoints))));
}

std::uint64_t scaled_points(const Density& density, const Box3d& box, std::uint64_t points) {
  const double scale = point_scale(density, box);
  if (!(scale < 1)) return points;
  return std::max<std::uint64_t>(1, static_cast<std::uint64_t>(std::round(static_cast<double>(points) * scale)));
}

}  // namespace curvecast
