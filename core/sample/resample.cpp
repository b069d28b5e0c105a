#include "core/sample/resample.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/base/stopwatch.h"
#include "core/density/view_factor.h"
#include "core/sample/equalise.h"
#include "core/sample/splat_radius.h"
#include "core/sample/view_mass.h"

namespace curvecast {
namespace {

/// The points lie far apart in memory, and the processor looks ahead only so far.
constexpr std::size_t kAhead = 16;
void prefetch(const SurfaceCurve& curve, std::uint32_t l) {
  for (const Column<float>* column : {&curve.x, &curve.y, &curve.z}) __builtin_prefetch(column->data() + l);
  for (const Column<Snorm16>* column : {&curve.nx, &curve.ny, &curve.nz}) __builtin_prefetch(column->data() + l);
}

constexpr std::size_t kBatch = 128;  // points whose data stay in the nearest cache

/// Positions and normals of points [begin, end).
void gather_places(const SurfaceCurve& curve, std::size_t begin, std::size_t end, PointSet& points) {
  const std::uint32_t* const vertices = points.vertices.data();
  const std::size_t n = points.vertices.size();
  for (std::size_t i = begin; i < end; ++i) {
    prefetch(curve, vertices[std::min(i + kAhead, n - 1)]);
    const std::uint32_t l = vertices[i];
    points.positions[i] = curve.position(l);
    points.normals[i] = curve.normal(l);
  }
}

/// The density on the vertices of n <= kBatch points, but for a constant. The view's factor is that of the vertex itself, not of
/// its block. `fixed`: the fixed part; empty for 1.
void gather_density(const SurfaceCurve& curve, std::span<const float> fixed, const ViewFactor& view,
                    const std::uint32_t* vertices, std::size_t n, float* density) {
  for (std::size_t i = 0; i < n; ++i) density[i] = fixed.empty() ? 1 : fixed[vertices[i]];
  if (view.is_one()) return;
  float x[kBatch], y[kBatch], z[kBatch];
  Snorm16 nx[kBatch], ny[kBatch], nz[kBatch];
  Direction8 beside[kBatch];
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t l = vertices[i];
    x[i] = curve.x[l], y[i] = curve.y[l], z[i] = curve.z[l];
    nx[i] = curve.nx[l], ny[i] = curve.ny[l], nz[i] = curve.nz[l];
    if (!view.beside().empty()) beside[i] = view.beside()[l];
  }
  view.multiply({x, y, z, nx, ny, nz, view.beside().empty() ? nullptr : beside}, n, density);
}

/// The data of points.vertices.
void gather(const SurfaceCurve& curve, std::span<const float> fixed, const ViewFactor& view, double mass_per_point,
            PointSet& points) {
  const std::vector<std::uint32_t>& vertices = points.vertices;
  const std::size_t n = vertices.size();
  points.ranks.clear();
  points.places.clear();
  points.has_moved = false;
  points.origin = curve.origin;
  points.positions.resize(n);
  points.normals.resize(n);
  points.radii.resize(n);
  const SplatRadius radius(curve, mass_per_point);
  float density[kBatch];
  for (std::size_t begin = 0; begin < n; begin += kBatch) {
    const std::size_t count = std::min(kBatch, n - begin);
    gather_places(curve, begin, begin + count, points);
    gather_density(curve, fixed, view, &vertices[begin], count, density);
    for (std::size_t i = 0; i < count; ++i) points.radii[begin + i] = radius(density[i]);
  }
  points.colours.resize(curve.colour.empty() ? 0 : n);
  for (std::size_t i = 0; i < points.colours.size(); ++i) points.colours[i] = curve.colour[vertices[i]];
}

}  // namespace

absl::Status check_sample(std::uint64_t points, const Density& density) {
  if (points == 0) return absl::InvalidArgumentError("the number of points is 0; ask for at least 1");
  if (points > kMaxPoints) {
    return absl::OutOfRangeError(absl::StrFormat("%d points asked for; at most %d are made", points, kMaxPoints));
  }
  return check_density(density);
}

absl::Status nowhere_to_put_points() {
  return absl::FailedPreconditionError(
      "the density is zero on the whole surface (does anything face the camera?), so there is nowhere to put points");
}

absl::StatusOr<PointSet> resample(const SurfaceCurve& curve, const ResampleOptions& options, ResampleReport* report) {
  if (absl::Status status = check_sample(options.points, options.density); !status.ok()) return status;
  Stopwatch watch;
  const absl::StatusOr<std::shared_ptr<const FixedDensity>> fixed = make_fixed_density(curve, options.density.terms);
  if (!fixed.ok()) return fixed.status();
  const double fixed_seconds = watch.lap();
  ResampleWorkspace workspace;
  if (absl::Status status = resample(curve, fixed->get(), options, workspace, report); !status.ok()) return status;
  if (report != nullptr) report->density_seconds += fixed_seconds;
  return std::move(workspace.points);
}

absl::Status resample(const SurfaceCurve& curve, const FixedDensity* fixed, const ResampleOptions& options,
                      ResampleWorkspace& workspace, ResampleReport* report) {
  if (absl::Status status = check_sample(options.points, options.density); !status.ok()) return status;
  Stopwatch watch;
  const std::span<const float> density = fixed == nullptr ? std::span<const float>() : fixed->density;
  const BlockMass& fixed_mass = fixed == nullptr ? curve.blocks.area : fixed->mass;
  const ViewFactor view(curve, options.density);
  ViewMass& mass = workspace.mass;
  view_mass(curve, density, fixed_mass, view, options.points, mass);
  if (report != nullptr) report->density_seconds = watch.lap();
  if (!(mass.total > 0) || !std::isfinite(mass.total)) return nowhere_to_put_points();
  workspace.sequence.resize(options.points);
  fill_sequence(options.sequence, options.seed, workspace.sequence);
  workspace.points.vertices.resize(options.points);
  equalise(mass, fixed_mass, workspace.sequence, workspace.points.vertices, workspace.equalise);
  const double mass_per_point = mass.total / static_cast<double>(options.points);
  const double invert_seconds = watch.lap();
  gather(curve, density, view, mass_per_point, workspace.points);
  if (report != nullptr) {
    report->gather_seconds = watch.lap();
    report->equalise_seconds = invert_seconds + report->gather_seconds;
    report->most_on_vertex = static_cast<double>(mass.largest) / mass_per_point;
  }
  return absl::OkStatus();
}

}  // namespace curvecast
