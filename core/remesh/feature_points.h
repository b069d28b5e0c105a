// Places points on the features of a surface: edges so sharp that they are meant. What learning from shapes takes besides the
// points between them: Chen et al., "Dora: Sampling and Benchmarking for 3D Shape Variational Auto-Encoders" (2024), section 3.1.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sample/point_set.h"

namespace curvecast {

struct FeaturePoints {
  double length = 0;                          // of all features, in the mesh's units
  std::vector<FacePlace> places;              // N, on either face beside the edge
  std::vector<Vec3d> positions;               // N
  std::vector<std::array<Vec3f, 2>> normals;  // N: of the faces on both sides, unit length
};

/// Places n points along all features, one after the other, evenly by length: a jittered 1D sequence, inverted through the length
/// so far, as points are placed along the curve. None where there is no edge at which the normals differ by more degrees, 0 ..
/// 180. Some are missing once the context is cancelled.
FeaturePoints sample_features(const TriangleMesh& mesh, double degrees, std::size_t n, std::uint64_t seed,
                              const ExecutionContext& context = {});

}  // namespace curvecast
