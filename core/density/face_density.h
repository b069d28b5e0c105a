// A density on a mesh's faces, before there is a curve: what the curve itself is made for (paper, section 3.2).
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/density/density.h"
#include "core/mesh/curvature.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// reference_curvatures() of a whole mesh: for its curves, however fine they are.
std::array<float, kCurvatureKinds> reference_curvatures(const TriangleMesh& mesh, const DifferentialGeometry& geometry);

// The density is looked at in so many places of the surface at most, 30 bytes each while that lasts, or once on each face: for
// curves, and for those who compare points with it.
inline constexpr std::size_t kFewPlaces = 1'000'000, kManyPlaces = 8'000'000;

/// The mean of the density on every face (F entries, relative values). `scalars`: the mesh's named numbers, for the terms that
/// use them. Errors as of evaluate_density().
absl::StatusOr<std::vector<float>> density_on_faces(const TriangleMesh& mesh, const DifferentialGeometry& geometry,
                                                    std::span<const ScalarAttribute> scalars, const Density& density,
                                                    std::size_t most_places = kManyPlaces);

/// Curve vertices that each face wants per squared unit (F entries): `vertices` in all, spread as the density asks. Errors as
/// of density_on_faces(); FailedPrecondition: the density is zero everywhere.
absl::StatusOr<std::vector<double>> face_demand(const TriangleMesh& mesh, const DifferentialGeometry& geometry,
                                                std::span<const ScalarAttribute> scalars, const Density& density, double vertices,
                                                std::size_t most_places = kFewPlaces);

}  // namespace curvecast
