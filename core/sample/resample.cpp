#include "core/sample/resample.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>

#include "core/sample/equalise.h"
#include "core/stopwatch.h"

namespace curvecast {
namespace {

// Splat radius over the square root of the area that a point stands for. Discs of this size around jittered points leave next
// to no holes (the coverage radius of such sets is 1.45 at its worst, under 1 nearly everywhere).
constexpr double kSplatRadius = 1.25;

PointSet gather(const SurfaceCurve& curve, std::span<const float> density, double mass_per_point,
                std::vector<std::uint32_t> vertices) {
  PointSet points;
  points.origin = curve.origin;
  points.positions.reserve(vertices.size());
  points.normals.reserve(vertices.size());
  points.radii.reserve(vertices.size());
  const double largest = curve.box.diagonal();
  for (const std::uint32_t l : vertices) {
    points.positions.emplace_back(curve.x[l], curve.y[l], curve.z[l]);
    points.normals.emplace_back(curve.nx[l], curve.ny[l], curve.nz[l]);
    points.radii.push_back(static_cast<float>(std::min(kSplatRadius * std::sqrt(mass_per_point / density[l]), largest)));
  }
  if (!curve.colour.empty()) {
    points.colours.reserve(vertices.size());
    for (const std::uint32_t l : vertices) points.colours.push_back(curve.colour[l]);
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
  Stopwatch watch;
  std::vector<float> density(curve.size());
  if (absl::Status status = evaluate_density(curve, options.density, density); !status.ok()) return status;
  if (report != nullptr) report->density_seconds = watch.lap();
  std::vector<double> q(options.points);
  fill_sequence(options.sequence, options.seed, q);
  std::vector<std::uint32_t> vertices(options.points);
  const Mass mass = equalise(density, curve.area, q, vertices);
  if (!(mass.total > 0) || !std::isfinite(mass.total)) {
    return absl::FailedPreconditionError(
        "the density is zero on the whole surface (does anything face the camera?), so there is nowhere to put points");
  }
  const double mass_per_point = mass.total / static_cast<double>(options.points);
  PointSet points = gather(curve, density, mass_per_point, std::move(vertices));
  if (report != nullptr) {
    report->equalise_seconds = watch.lap();
    report->most_on_vertex = static_cast<double>(mass.largest) / mass_per_point;
  }
  return points;
}

}  // namespace curvecast
