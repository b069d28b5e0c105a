#include "core/refine/refine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/with_threads.h"
#include "core/refine/split_leaves.h"
#include "core/refine/subdivide_all.h"

namespace curvecast {
namespace {

// Where this share of all leaves wants a level, all get it: measuring the area of nearly all would take longer than it is worth.
constexpr double kNearlyAll = 0.9;
constexpr double kMostVertices = 4e9;  // numbers of curve vertices have 32 bits

/// The levels that nearly all leaves want, if all may have them.
int common_levels(const SurfaceCurve& curve, std::span<const std::uint8_t> levels, double limit) {
  std::array<std::size_t, kMaxLevel + 2> wanting{};  // leaves that want at least so many
  for (const std::uint8_t k : levels) ++wanting[k];
  for (int k = kMaxLevel; k > 0; --k) wanting[k - 1] += wanting[k];
  const double all = static_cast<double>(curve.size());
  int common = 0;
  while (common < kMaxLevel && static_cast<double>(wanting[common + 1]) >= kNearlyAll * all) ++common;
  const auto vertices = [&] {
    double sum = 0;
    for (const std::uint8_t k : levels) sum += std::ldexp(1.0, 2 * std::max<int>(k, common));
    return sum;
  };
  while (common > 0 && vertices() > limit) --common;
  return common;
}

/// What the children still want after all leaves were raised.
std::vector<std::uint8_t> levels_left(const SurfaceCurve& before, const SurfaceCurve& raised,
                                      std::span<const std::uint8_t> levels) {
  std::vector<std::uint8_t> left(raised.size());
  std::size_t i = 0;
  // A file of the curve that is cut meanwhile has zeros: nobody takes what comes of them, but it has to stay within bounds.
  for (std::size_t l = 0; l < before.size() && i < left.size(); ++l) {
    const int gained = raised.level[i] - before.level[l];
    const std::size_t children = std::min(std::size_t{1} << 2 * gained, left.size() - i);
    std::fill_n(left.begin() + static_cast<std::ptrdiff_t>(i), children,
                static_cast<std::uint8_t>(std::max(0, levels[l] - gained)));
    i += children;
  }
  return left;
}

bool any(std::span<const std::uint8_t> levels) {
  return std::any_of(levels.begin(), levels.end(), [](std::uint8_t k) { return k > 0; });
}

absl::StatusOr<RefinedCurve> refine_here(const CurveBase& base, const SurfaceCurve& curve, std::span<const CurveDemand> demands,
                                         const RefineOptions& options, const ExecutionContext& context) {
  std::vector<float> load(curve.size(), 0);
  for (const CurveDemand& demand : demands) {
    if (absl::Status status = raise_vertex_loads(curve, demand, options.omega, load, context); !status.ok()) return status;
    if (absl::Status status = context.check(); !status.ok()) return status;
  }
  const double limit = std::min(static_cast<double>(options.max_vertices), kMostVertices);
  MissingLevels missing = missing_levels(curve, load, static_cast<std::uint64_t>(limit));
  RefinedCurve out{nullptr, missing.divisor};
  if (!any(missing.levels)) return out;
  const auto finish = [&](SurfaceCurve finer) {
    finer.revision = curve.revision + 1;
    finer.finish();
    if (missing.divisor == 1) finer.max_points = std::max(finer.max_points, options.max_points);
    out.curve = std::make_shared<SurfaceCurve>(std::move(finer));
    return out;
  };
  const int common = common_levels(curve, missing.levels, limit);
  if (common == 0) {
    absl::StatusOr<SurfaceCurve> split = split_leaves(base, curve, missing.levels, context);
    if (!split.ok()) return split.status();
    return finish(*std::move(split));
  }
  if (!base.is_all_sound()) return base.status();
  SurfaceCurve raised = subdivide_all(base, curve, common);
  if (absl::Status status = context.check(); !status.ok()) return status;
  const std::vector<std::uint8_t> left = levels_left(curve, raised, missing.levels);
  if (any(left)) {
    absl::StatusOr<SurfaceCurve> split = split_leaves(base, raised, left, context);
    if (!split.ok()) return split.status();
    raised = *std::move(split);
  }
  return finish(std::move(raised));
}

}  // namespace

absl::StatusOr<RefinedCurve> refine(const CurveBase& base, const SurfaceCurve& curve, std::span<const CurveDemand> demands,
                                    const RefineOptions& options, const ExecutionContext& context) {
  return with_threads(context, [&] { return refine_here(base, curve, demands, options, context); });
}

}  // namespace curvecast
