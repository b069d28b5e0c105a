#include "core/density/face_density.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace curvecast {
namespace {

using Weights = std::array<float, 3>;

/// The places of a triangle at which the mean of a square is its mean on the triangle.
void append_places(const Weights& a, const Weights& b, const Weights& c, std::vector<Weights>& places) {
  for (const Weights& corner : {a, b, c}) {
    Weights& place = places.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) place[k] = corner[k] / 2 + (a[k] + b[k] + c[k]) / 6;
  }
}

constexpr Weights kCentroid = {1 / 3.0f, 1 / 3.0f, 1 / 3.0f};

/// Where the density is looked at on each of so many faces: three places in each of k^2 triangles, or the centroid alone.
std::vector<Weights> places_on_faces(std::size_t faces, std::size_t most_places) {
  constexpr std::size_t kPlaces = 3, kFinest = 16;
  std::size_t k = 0;
  while (k < kFinest && kPlaces * (k + 1) * (k + 1) * faces <= most_places) ++k;
  if (k == 0) return {kCentroid};
  const auto corner = [k](std::size_t i, std::size_t j) {
    const float u = static_cast<float>(i) / static_cast<float>(k), v = static_cast<float>(j) / static_cast<float>(k);
    return Weights{1 - u - v, u, v};
  };
  std::vector<Weights> places;
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; i + j < k; ++j) {
      append_places(corner(i, j), corner(i + 1, j), corner(i, j + 1), places);
      if (i + j + 1 < k) append_places(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1), places);
    }
  }
  return places;
}

/// The mean of what a triangle's corners have.
template <typename Value>
Value mean_of(Value VertexGeometry::*value, const Weights& w, std::span<const VertexGeometry> geometry, const Triangle& t) {
  return w[0] * geometry[t[0]].*value + w[1] * geometry[t[1]].*value + w[2] * geometry[t[2]].*value;
}

/// A curve with a vertex at each of some places on each face: density terms need not know the difference.
SurfaceCurve curve_on_faces(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                            std::span<const ScalarAttribute> scalars, std::span<const Weights> places) {
  SurfaceCurve curve;
  for (const ScalarAttribute& scalar : scalars) curve.scalars.push_back({scalar.name, {}});
  curve.resize(mesh.face_count() * places.size());
  curve.box = bounding_box(mesh);
  curve.origin = curve.box.center();
  std::size_t l = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const auto area = static_cast<float>(triangle_area(mesh, f) / static_cast<double>(places.size()));
    for (const Weights& w : places) {
      const auto mean = [&](const auto& values) { return w[0] * values[t[0]] + w[1] * values[t[1]] + w[2] * values[t[2]]; };
      const Vec3f place =
          ((w[0] * mesh.positions[t[0]] + w[1] * mesh.positions[t[1]] + w[2] * mesh.positions[t[2]]) - curve.origin)
              .cast<float>();
      const Vec3f normal = mean_of(&VertexGeometry::normal, w, geometry, t).normalized();
      curve.x[l] = place.x(), curve.y[l] = place.y(), curve.z[l] = place.z();
      curve.nx[l] = normal.x(), curve.ny[l] = normal.y(), curve.nz[l] = normal.z();
      curve.curvature_min[l] = mean_of(&VertexGeometry::curvature_min, w, geometry, t);
      curve.curvature_max[l] = mean_of(&VertexGeometry::curvature_max, w, geometry, t);
      curve.area[l] = area;
      for (std::size_t s = 0; s < scalars.size(); ++s) curve.scalars[s].values[l] = mean(scalars[s].values);
      ++l;
    }
  }
  return curve;
}

}  // namespace

std::array<float, kCurvatureKinds> reference_curvatures(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                        double area, double diagonal, const ExecutionContext& context) {
  // Numbers are rounded as a curve's are.
  const auto mean = [&](const Triangle& t, float VertexGeometry::*value) {
    return Bfloat16(mean_of(value, kCentroid, geometry, t));
  };
  const CurvatureHistogram histogram =
      curvature_histogram(mesh.face_count(), context, [&](std::size_t f, CurvatureHistogram& into) {
        const Triangle& t = mesh.triangles[f];
        into.add(mean(t, &VertexGeometry::curvature_min), mean(t, &VertexGeometry::curvature_max),
                 static_cast<float>(triangle_area(mesh, f)));
      });
  return histogram.strong(diagonal, area);
}

absl::StatusOr<std::vector<float>> density_on_faces(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                    std::span<const ScalarAttribute> scalars, const Density& density,
                                                    std::size_t most_places, const ExecutionContext& context) {
  const std::vector<Weights> places = places_on_faces(mesh.face_count(), most_places);
  SurfaceCurve curve = curve_on_faces(mesh, geometry, scalars, places);
  curve.reference_curvature = reference_curvatures(mesh, geometry, surface_area(mesh), bounding_box(mesh).diagonal());
  std::vector<float> values(curve.size());
  if (absl::Status status = evaluate_density(curve, density, values, context); !status.ok()) return status;
  std::vector<float> means(mesh.face_count());
  for (std::size_t f = 0; f < means.size(); ++f) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(f * places.size());
    means[f] =
        std::accumulate(first, first + static_cast<std::ptrdiff_t>(places.size()), 0.0f) / static_cast<float>(places.size());
  }
  return means;
}

absl::StatusOr<std::vector<double>> face_demand(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                std::span<const ScalarAttribute> scalars, const Density& density, double vertices,
                                                std::size_t most_places, const ExecutionContext& context) {
  std::vector<double> demand(mesh.face_count(), 1.0);
  if (!density.terms.empty()) {
    const absl::StatusOr<std::vector<float>> values = density_on_faces(mesh, geometry, scalars, density, most_places, context);
    if (!values.ok()) return values.status();
    std::copy(values->begin(), values->end(), demand.begin());
  }
  double mass = 0;
  for (std::size_t f = 0; f < demand.size(); ++f) mass += demand[f] * triangle_area(mesh, f);
  if (!(mass > 0 && std::isfinite(mass))) {
    return absl::FailedPreconditionError("the density is zero on the whole surface");
  }
  for (double& d : demand) d *= vertices / mass;
  return demand;
}

}  // namespace curvecast
