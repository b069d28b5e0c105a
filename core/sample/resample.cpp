#include "core/sample/resample.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/density/view_factor.h"
#include "core/sample/equalise.h"
#include "core/sample/splat_radius.h"
#include "core/sample/view_mass.h"
#include "core/stopwatch.h"

namespace curvecast {
namespace {

/// The points lie far apart in memory, and the processor looks ahead only so far.
constexpr std::size_t kAhead = 24;
void prefetch(const SurfaceCurve& curve, std::uint32_t l) {
  for (const Column<float>* column : {&curve.x, &curve.y, &curve.z}) __builtin_prefetch(column->data() + l);
  for (const Column<Snorm16>* column : {&curve.nx, &curve.ny, &curve.nz}) __builtin_prefetch(column->data() + l);
}

/// `density`: the fixed part; empty for 1.
PointSet gather(const SurfaceCurve& curve, std::span<const float> density, const ViewFactor& view, double mass_per_point,
                std::vector<std::uint32_t> vertices) {
  const std::size_t n = vertices.size();
  PointSet points;
  points.origin = curve.origin;
  points.positions.resize(n);
  points.normals.resize(n);
  points.radii.resize(n);
  const SplatRadius radius(curve, mass_per_point);
  // The view's factor is that of the vertex itself, not of its block.
  constexpr std::size_t kChunk = 256;
  float x[kChunk], y[kChunk], z[kChunk], factor[kChunk];
  Snorm16 nx[kChunk], ny[kChunk], nz[kChunk];
  for (std::size_t begin = 0; begin < n; begin += kChunk) {
    const std::size_t count = std::min(kChunk, n - begin);
    for (std::size_t i = 0; i < count; ++i) {
      if (begin + i + kAhead < n) prefetch(curve, vertices[begin + i + kAhead]);
      const std::uint32_t l = vertices[begin + i];
      x[i] = curve.x[l], y[i] = curve.y[l], z[i] = curve.z[l];
      nx[i] = curve.nx[l], ny[i] = curve.ny[l], nz[i] = curve.nz[l];
      factor[i] = density.empty() ? 1 : density[l];
    }
    view.multiply(x, y, z, nx, ny, nz, count, factor);
    for (std::size_t i = 0; i < count; ++i) {
      points.positions[begin + i] = {x[i], y[i], z[i]};
      points.normals[begin + i] = {nx[i], ny[i], nz[i]};
      points.radii[begin + i] = radius(factor[i]);
    }
  }
  if (!curve.colour.empty()) {
    points.colours.resize(n);
    for (std::size_t i = 0; i < n; ++i) points.colours[i] = curve.colour[vertices[i]];
  }
  points.vertices = std::move(vertices);
  return points;
}

}  // namespace

absl::StatusOr<PointSet> resample(const SurfaceCurve& curve, const ResampleOptions& options, ResampleReport* report) {
  if (options.points == 0) return absl::InvalidArgumentError("the number of points is 0; ask for at least 1");
  if (options.points > kMaxPoints) {
    return absl::OutOfRangeError(absl::StrFormat("%d points asked for; at most %d are made", options.points, kMaxPoints));
  }
  if (absl::Status status = check_density(options.density); !status.ok()) return status;
  Stopwatch watch;
  std::vector<float> density;
  BlockMass own;
  if (has_fixed_terms(options.density.terms)) {
    density.resize(curve.size());
    if (absl::Status status = evaluate_fixed_terms(curve, options.density.terms, density); !status.ok()) return status;
    own = block_mass(density, curve.area);
  }
  const BlockMass& fixed = density.empty() ? curve.blocks.area : own;
  const ViewFactor view(curve, options.density);
  ViewMass mass;
  view_mass(curve, density, fixed, view, options.points, mass);
  if (report != nullptr) report->density_seconds = watch.lap();
  if (!(mass.total > 0) || !std::isfinite(mass.total)) {
    return absl::FailedPreconditionError(
        "the density is zero on the whole surface (does anything face the camera?), so there is nowhere to put points");
  }
  std::vector<double> q(options.points);
  fill_sequence(options.sequence, options.seed, q);
  std::vector<std::uint32_t> vertices(options.points);
  equalise(mass, fixed, q, vertices);
  const double mass_per_point = mass.total / static_cast<double>(options.points);
  PointSet points = gather(curve, density, view, mass_per_point, std::move(vertices));
  if (report != nullptr) {
    report->equalise_seconds = watch.lap();
    report->most_on_vertex = static_cast<double>(mass.largest) / mass_per_point;
  }
  return points;
}

}  // namespace curvecast
