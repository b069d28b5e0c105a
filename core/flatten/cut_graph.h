// The edges along which a connected mesh is cut open to a disc.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// Marks the inner edges to cut, on both of their halfedges (3 F flags). InvalidArgument where the mesh is not connected. Cutting
/// along the marked edges leaves one disc with at least two border edges. Paths run from the border or the other cuts to every
/// one of `extremities` (vertices) in turn; a closed surface of genus 0 is opened between the first two, or where there are none
/// between two points far from each other.
absl::StatusOr<std::vector<bool>> cut_graph(const TriangleMesh& mesh, std::span<const std::uint32_t> extremities);

}  // namespace curvecast
