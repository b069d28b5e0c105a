// How good a parameterisation is: flipped triangles and area distortion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/flatten/chart_view.h"

namespace curvecast {

/// Triangles whose uv area is not positive, by an exact test.
std::uint64_t count_flipped(const DiscMesh& disc, const std::vector<Vec2d>& uv);

/// Signed area of triangle t in the parameter square.
double uv_area(const ChartView& chart, std::size_t t);

/// Surface area over uv area of triangle t; positive and finite if it is neither flipped nor empty.
double area_ratio(const ChartView& chart, std::size_t t);

/// The L2 stretch of the map from uv to the surface (Sander and others, 2001): of the whole, and of the triangles around each
/// vertex, both relative to the stretch of an isometric map. The uv fill an area of 1. Finite, if large, for triangles flipped by
/// rounding.
struct Stretch {
  double total = 0;
  std::vector<double> vertex;
};

Stretch measure_stretch(const DiscMesh& disc, const std::vector<Vec2d>& uv);

/// One triangle's part in a surface's distortion.
struct AreaShare {
  double area;   // on the surface
  double ratio;  // surface area over uv area, over the mean of its disc
};

struct Distortion {
  double p50 = 1, p99 = 1, p999 = 1, max = 1;  // quantiles of max(ratio, 1 / ratio) by surface area
  double density_p999 = 1;  // the same of the ratio itself: 99.9 % of the surface is squeezed together less than this
  /// What it costs: quadtree levels (each a division by four) beyond those of a map without distortion, log4 of the ratio where
  /// that is above 1: the mean over the surface and the largest.
  double extra_levels_mean = 0, extra_levels_max = 0;
};

/// Adds up what triangles have of it, in memory that does not depend on how many there are. Quantiles are within 0.1 %, exact
/// where ratios are few; the rest is exact.
class DistortionSummary {
 public:
  void add(const AreaShare& share);
  void add(const DistortionSummary& other);
  /// Precondition: something has been added.
  Distortion distortion() const;

 private:
  struct Bin {
    double area = 0, farthest = 1;  // of its ratios, from 1
  };
  double quantile(double part) const;
  double folded_quantile(double part) const;

  std::vector<Bin> bins_;  // by ratio, evenly in its logarithm; empty at first
  double area_ = 0, extra_levels_ = 0, most_extra_levels_ = 0, largest_ = 1;
};

/// The distortion of a surface that is mapped in these charts.
Distortion measure_distortion(std::span<const Chart> charts, const ExecutionContext& context = {});

}  // namespace curvecast
