#include "core/density/fixed_density.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "core/base/simd.h"
#include "core/density/brush.h"

namespace curvecast {
namespace {

CURVECAST_WIDE void largest_of_blocks(const float* __restrict density, std::size_t blocks, float* __restrict most) {
  for (std::size_t b = 0; b < blocks; ++b) {
    float largest = density[b * kBlockSize];
    for (std::size_t i = 1; i < kBlockSize; ++i) largest = fast_max(density[b * kBlockSize + i], largest);
    most[b] = largest;
  }
}

Column<float> largest_of_blocks(std::span<const float> density) {
  Column<float> most;
  most.resize(block_count(density.size()));
  const std::size_t whole = density.size() / kBlockSize;
  largest_of_blocks(density.data(), whole, most.data());
  if (whole < most.size()) most[whole] = *std::max_element(density.begin() + whole * kBlockSize, density.end());
  return most;
}

CURVECAST_WIDE void scale_paint(const float* __restrict paint, float scale, std::size_t n, float* __restrict density) {
  for (std::size_t l = 0; l < n; ++l) density[l] = scale * paint[l];
}

CURVECAST_WIDE void scale_paint(const float* __restrict paint, float scale, const float* __restrict others, std::size_t n,
                                float* __restrict density) {
  for (std::size_t l = 0; l < n; ++l) density[l] = others[l] * (scale * paint[l]);
}

/// Paints over what there is.
absl::Status fill_painted(const SurfaceCurve& curve, std::span<const DensityTerm> terms, const BrushTerm& brush,
                          const EarlierPaint& earlier, const ExecutionContext& context, FixedDensity& out) {
  out.paint.resize(curve.size());
  if (earlier.fixed != nullptr) {
    out.others = earlier.fixed->others;
    std::copy(earlier.fixed->paint.begin(), earlier.fixed->paint.end(), out.paint.begin());
  } else {
    std::vector<DensityTerm> rest;
    std::copy_if(terms.begin(), terms.end(), std::back_inserter(rest),
                 [](const DensityTerm& term) { return !std::holds_alternative<BrushTerm>(term); });
    auto others = make_fixed_density(curve, rest, {}, context);
    if (!others.ok()) return others.status();
    out.others = *std::move(others);
    std::fill(out.paint.begin(), out.paint.end(), 1.0f);
  }
  const auto dabs = std::span(brush.dabs).subspan(earlier.dabs);
  if (absl::Status status = paint(curve, dabs, std::span<float>(out.paint), context); !status.ok()) return status;
  const float scale = paint_scale(brush.dabs);
  if (out.others == nullptr) {
    scale_paint(out.paint.data(), scale, curve.size(), out.density.data());
  } else {
    scale_paint(out.paint.data(), scale, out.others->density.data(), curve.size(), out.density.data());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const FixedDensity>> make_fixed_density(const SurfaceCurve& curve,
                                                                       std::span<const DensityTerm> terms,
                                                                       const EarlierPaint& earlier,
                                                                       const ExecutionContext& context) {
  if (!has_fixed_terms(terms)) return nullptr;
  auto fixed = std::make_shared<FixedDensity>();
  fixed->density.resize(curve.size());
  const BrushTerm* const brush = only_brush(terms);
  absl::Status status = brush != nullptr ? fill_painted(curve, terms, *brush, earlier, context, *fixed)
                                         : evaluate_fixed_terms(curve, terms, std::span<float>(fixed->density), context);
  if (!status.ok()) return status;
  fixed->mass = block_mass(fixed->density, curve.area);
  fixed->most = largest_of_blocks(fixed->density);
  return fixed;
}

const BrushTerm* only_brush(std::span<const DensityTerm> terms) {
  const BrushTerm* found = nullptr;
  for (const DensityTerm& term : terms) {
    const auto* const brush = std::get_if<BrushTerm>(&term);
    if (brush == nullptr) continue;
    if (found != nullptr) return nullptr;
    found = brush;
  }
  return found;
}

}  // namespace curvecast
