// A way of a camera from where a whole mesh is seen down to its surface.
#pragma once

#include <cstdint>

#include "core/base/vec.h"
#include "core/mesh/triangle_mesh.h"
#include "curvecast/v1/curvecast.pb.h"

namespace curvecast::cli::bench {

struct SurfacePlace {
  Vec3d position;
  Vec3d normal;  // unit, of the surface around it
};

/// Returns the place of the surface that lies farthest to the front and a little to the right and above: the middle of a face.
/// Precondition: the mesh has a face.
SurfacePlace front_of(const TriangleMesh& mesh);

/// Returns a random place of the surface, by area. `seed`: which one.
SurfacePlace random_place(const TriangleMesh& mesh, std::uint64_t seed);

/// Looks at a place from a distance against its normal, turned about it a little by `degrees` around the normal. Distances in the
/// units of the mesh.
v1::Camera camera_above(const SurfacePlace& place, double distance, double degrees);

}  // namespace curvecast::cli::bench
