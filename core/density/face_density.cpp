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

/// Makes a curve with so many vertices that density terms need not know what it is.
class CurveOfPlaces {
 public:
  CurveOfPlaces(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry, std::span<const ScalarAttribute> scalars,
                std::size_t places)
      : mesh_(mesh), geometry_(geometry), scalars_(scalars) {
    for (const ScalarAttribute& scalar : scalars) curve_.scalars.push_back({scalar.name, {}});
    curve_.resize(places);
    curve_.box = bounding_box(mesh);
    curve_.origin = curve_.box.center();
    curve_.reference_curvature = reference_curvatures(mesh, geometry, surface_area(mesh), curve_.box.diagonal());
  }

  /// Sets vertex l: where it is, and the area that it stands for.
  void set(std::size_t l, std::size_t face, const Weights& w, float area) {
    const Triangle& t = mesh_.triangles[face];
    const auto mean = [&](const auto& values) { return w[0] * values[t[0]] + w[1] * values[t[1]] + w[2] * values[t[2]]; };
    const Vec3f place =
        ((w[0] * mesh_.positions[t[0]] + w[1] * mesh_.positions[t[1]] + w[2] * mesh_.positions[t[2]]) - curve_.origin)
            .cast<float>();
    const Vec3f normal = mean_of(&VertexGeometry::normal, w, geometry_, t).normalized();
    curve_.x[l] = place.x(), curve_.y[l] = place.y(), curve_.z[l] = place.z();
    curve_.nx[l] = normal.x(), curve_.ny[l] = normal.y(), curve_.nz[l] = normal.z();
    curve_.curvature_min[l] = mean_of(&VertexGeometry::curvature_min, w, geometry_, t);
    curve_.curvature_max[l] = mean_of(&VertexGeometry::curvature_max, w, geometry_, t);
    curve_.area[l] = area;
    for (std::size_t s = 0; s < scalars_.size(); ++s) curve_.scalars[s].values[l] = mean(scalars_[s].values);
  }

  /// Returns the density at all of them.
  absl::StatusOr<std::vector<float>> evaluate(const Density& density, const ExecutionContext& context) const {
    std::vector<float> values(curve_.size());
    if (absl::Status status = evaluate_density(curve_, density, values, context); !status.ok()) return status;
    return values;
  }

 private:
  const TriangleMesh& mesh_;
  const std::span<const VertexGeometry> geometry_;
  const std::span<const ScalarAttribute> scalars_;
  SurfaceCurve curve_;
};

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
  CurveOfPlaces curve(mesh, geometry, scalars, mesh.face_count() * places.size());
  std::size_t l = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto area = static_cast<float>(triangle_area(mesh, f) / static_cast<double>(places.size()));
    for (const Weights& w : places) curve.set(l++, f, w, area);
  }
  const absl::StatusOr<std::vector<float>> evaluated = curve.evaluate(density, context);
  if (!evaluated.ok()) return evaluated.status();
  const std::vector<float>& values = *evaluated;
  std::vector<float> means(mesh.face_count());
  for (std::size_t f = 0; f < means.size(); ++f) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(f * places.size());
    means[f] =
        std::accumulate(first, first + static_cast<std::ptrdiff_t>(places.size()), 0.0f) / static_cast<float>(places.size());
  }
  return means;
}

absl::StatusOr<std::vector<float>> density_at(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                              std::span<const ScalarAttribute> scalars, const Density& density,
                                              std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>> weights,
                                              const ExecutionContext& context) {
  CurveOfPlaces curve(mesh, geometry, scalars, faces.size());
  const auto area = static_cast<float>(surface_area(mesh) / static_cast<double>(faces.size()));
  for (std::size_t l = 0; l < faces.size(); ++l) {
    const auto [second, third] = weights[l];
    curve.set(l, faces[l], {1 - second - third, second, third}, area);
  }
  return curve.evaluate(density, context);
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
