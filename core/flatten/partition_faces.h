// Divides a large piece of surface into parts of about equal size, so that each can be cut and mapped by itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// A part of a piece, on the way from part to part.
struct FacePart {
  std::vector<std::uint32_t> faces;  // ascending; connected
  std::optional<Vec3d> entry, exit;  // where the way comes in from the part before, and goes out to the next
};

/// Divides connected `faces` (ascending) of a mesh into about `count` parts, each connected, of about equal numbers of faces:
/// planes across the longest axis of inertia halve the piece again and again, each where the cut is short (recursive inertial
/// bisection; Simon, "Partitioning of unstructured problems for parallel processing", 1991), and what a plane cuts off goes to a
/// neighbour. The parts come in an order in which each, as a rule, is the neighbour of the one before. Every face lies in exactly
/// one part. Any number of threads gives the same parts. None where the context is cancelled.
std::vector<FacePart> partition_faces(const TriangleMesh& mesh, std::span<const std::uint32_t> faces, std::size_t count,
                                      const ExecutionContext& context = {});

}  // namespace curvecast
