// A density on a mesh's faces, from which the curve is made, before there is one (paper, section 3.2).
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

/// Returns the curvatures that count as strong on a mesh, one of each kind; see CurvatureTerm. They hold for all curves of the
/// mesh, however fine. `area`, `diagonal`: of the mesh and its box. To be dropped once the context is cancelled.
std::array<float, kCurvatureKinds> reference_curvatures(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                        double area, double diagonal, const ExecutionContext& context = {});

// The most places of the surface where the density is evaluated, unless there are more faces: the first for curves, the second to
// measure point sets. Each takes 30 bytes meanwhile.
inline constexpr std::size_t kFewPlaces = 1'000'000, kManyPlaces = 8'000'000;

/// Returns the mean of the density on every face (F entries, relative values). `scalars`: the mesh's named numbers, for the terms
/// that use them. Errors as of evaluate_density().
absl::StatusOr<std::vector<float>> density_on_faces(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                    std::span<const ScalarAttribute> scalars, const Density& density,
                                                    std::size_t most_places = kManyPlaces, const ExecutionContext& context = {});

/// Returns the density at places, which all stand for about as much of the surface (relative values): on faces, by the weights of
/// their second and third corners. Errors as of evaluate_density().
absl::StatusOr<std::vector<float>> density_at(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                              std::span<const ScalarAttribute> scalars, const Density& density,
                                              std::span<const std::uint32_t> faces, std::span<const std::array<float, 2>> weights,
                                              const ExecutionContext& context = {});

/// Returns how many curve vertices each face wants per squared unit (F entries): `vertices` in all, spread as the density asks.
/// Errors as of density_on_faces(); FailedPrecondition: the density is zero everywhere.
absl::StatusOr<std::vector<double>> face_demand(const TriangleMesh& mesh, std::span<const VertexGeometry> geometry,
                                                std::span<const ScalarAttribute> scalars, const Density& density, double vertices,
                                                std::size_t most_places = kFewPlaces, const ExecutionContext& context = {});

}  // namespace curvecast
