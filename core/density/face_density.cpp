#include "core/density/face_density.h"

#include <algorithm>
#include <cmath>

namespace curvecast {

absl::StatusOr<std::vector<float>> density_on_faces(const TriangleMesh& mesh, const DifferentialGeometry& geometry,
                                                    std::span<const ScalarAttribute> scalars, const Density& density) {
  // A curve with one vertex for each face: the terms need not know the difference.
  SurfaceCurve faces;
  faces.resize(mesh.face_count());
  faces.box = bounding_box(mesh);
  faces.origin = faces.box.center();
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    const Vec3f centroid =
        ((mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3 - faces.origin).cast<float>();
    const Vec3f normal = (geometry.normals[t[0]] + geometry.normals[t[1]] + geometry.normals[t[2]]).normalized();
    const auto mean = [&](const std::vector<float>& values) { return (values[t[0]] + values[t[1]] + values[t[2]]) / 3; };
    faces.x[f] = centroid.x();
    faces.y[f] = centroid.y();
    faces.z[f] = centroid.z();
    faces.nx[f] = normal.x();
    faces.ny[f] = normal.y();
    faces.nz[f] = normal.z();
    faces.curvature_min[f] = mean(geometry.curvature_min);
    faces.curvature_max[f] = mean(geometry.curvature_max);
    const double area = triangle_area(mesh, f);
    faces.area[f] = static_cast<float>(area);
    faces.total_area += area;
  }
  faces.reference_curvature = reference_curvatures(faces);
  for (const ScalarAttribute& scalar : scalars) {
    ScalarColumn& column = faces.scalars.emplace_back();
    column.name = scalar.name;
    column.values.resize(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      column.values[f] = (scalar.values[t[0]] + scalar.values[t[1]] + scalar.values[t[2]]) / 3;
    }
  }
  std::vector<float> values(faces.size());
  if (absl::Status status = evaluate_density(faces, density, values); !status.ok()) return status;
  return values;
}

absl::StatusOr<std::vector<double>> face_demand(const TriangleMesh& mesh, const DifferentialGeometry& geometry,
                                                std::span<const ScalarAttribute> scalars, const Density& density,
                                                double vertices) {
  std::vector<double> demand(mesh.face_count(), 1.0);
  if (!density.terms.empty()) {
    const absl::StatusOr<std::vector<float>> values = density_on_faces(mesh, geometry, scalars, density);
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
