#include "core/refine/curve_resolution.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/curve/hilbert.h"

namespace curvecast {
namespace {

/// The smallest k with 4^k >= load, but for rounding: area elements are floats.
int levels_for(float load) {
  load *= 0.9999f;
  if (!(load > 1)) return 0;
  // Of a float above 1, up to 2^e for the first e that is enough.
  const auto bits = std::bit_cast<std::uint32_t>(load);
  const int exponent = static_cast<int>(bits >> 23) - 127 + ((bits & 0x7fffff) != 0 ? 1 : 0);
  return (exponent + 1) / 2;
}

// More than any leaf can be divided for; infinity would defy every divisor.
constexpr float kHighestLoad = 0x1p62f;

int levels_of(const SurfaceCurve& curve, std::span<const float> load, std::size_t l, float divisor) {
  return std::min(levels_for(std::min(load[l], kHighestLoad) / divisor), kMaxLevel - curve.level[l]);
}

/// Curve vertices after the division; exact as long as it matters.
double count(const SurfaceCurve& curve, std::span<const float> load, double divisor) {
  double sum = 0;
  const auto by = static_cast<float>(divisor);
  for (std::size_t l = 0; l < load.size(); ++l) sum += std::ldexp(1.0, 2 * levels_of(curve, load, l, by));
  return sum;
}

}  // namespace

absl::Status raise_vertex_loads(const SurfaceCurve& curve, const CurveDemand& demand, double omega, std::span<float> load,
                                const ExecutionContext& context) {
  std::vector<float> density(curve.size());
  if (absl::Status status = evaluate_density(curve, demand.density, density, context); !status.ok()) return status;
  double mass = 0;
  for (std::size_t l = 0; l < density.size(); ++l) mass += static_cast<double>(density[l] * curve.area[l]);
  if (!(mass > 0) || !std::isfinite(mass)) return absl::OkStatus();
  const double scale = omega * static_cast<double>(demand.points) / mass;
  for (std::size_t l = 0; l < density.size(); ++l) {
    load[l] = std::max(load[l], static_cast<float>(scale * static_cast<double>(density[l] * curve.area[l])));
  }
  return absl::OkStatus();
}

MissingLevels missing_levels(const SurfaceCurve& curve, std::span<const float> load, std::uint64_t max_vertices) {
  MissingLevels out;
  const auto limit = static_cast<double>(max_vertices);
  if (count(curve, load, 1) > limit) {
    // Nothing is divided once every load is under 1: that many there are already.
    double high = std::clamp(*std::max_element(load.begin(), load.end()), 1.0f, kHighestLoad);
    double low = 1;
    while (high > 1.02 * low) {
      const double middle = std::sqrt(low * high);
      (count(curve, load, middle) > limit ? low : high) = middle;
    }
    out.divisor = high;
  }
  out.levels.resize(load.size());
  const auto by = static_cast<float>(out.divisor);
  for (std::size_t l = 0; l < load.size(); ++l) out.levels[l] = static_cast<std::uint8_t>(levels_of(curve, load, l, by));
  return out;
}

}  // namespace curvecast
