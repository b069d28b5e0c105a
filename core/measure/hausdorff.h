// How far two surfaces lie apart, and how their normals differ. Sources: Cignoni, Rocchini, Scopigno, "Metro: measuring error on
// simplified surfaces" (1998), for what is measured; Guthe, Borodin, Klein, "Fast and accurate Hausdorff distance calculation
// between meshes" (2005), for bounds by triangles whose nearest points lie on the same face.
#pragma once

#include <algorithm>
#include <cstdint>

#include <vector>

#include "core/base/execution_context.h"
#include "core/density/camera.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// The largest distance is found to this part of itself, or of the diagonal of the surfaces' box where it is next to nothing.
inline constexpr double kHausdorffTolerance = 0.005;
inline constexpr double kHausdorffFloor = 1e-8;

/// Of one surface from another: over all of its points, of each to the nearest point of the other.
struct SurfaceDistance {
  double max = 0;                  // in the meshes' units, as all distances; the distance of `farthest`
  Vec3d farthest = Vec3d::Zero();  // a place of the surface
  double mean = 0, rms = 0;        // by area
  double normal_mean = 0;          // angle between the normals of the faces there, in degrees, by area
  double normal_rms = 0;
  // What lies in the cameras' pictures, in their pixels: distances weighed by depth. Over the samples of the means.
  double picture_max = 0;
  double picture_mean = 0, picture_rms = 0;  // by area of the surface
  double picture_share = 0;                  // of the area
};

struct HausdorffDistance {
  SurfaceDistance forward;   // of the first surface from the second
  SurfaceDistance backward;  // the other way round

  /// Returns the larger one of both directions.
  double larger(double SurfaceDistance::*measure) const { return std::max(forward.*measure, backward.*measure); }
  /// Returns what is called the Hausdorff distance.
  double max() const { return larger(&SurfaceDistance::max); }
};

struct HausdorffOptions {
  std::uint64_t samples = 1'000'000;  // of each surface, about, for means; one for each face at least
  std::vector<Camera> cameras = {};   // for distances in pixels; check_camera() finds nothing
};

/// The maxima are not sampled: distances change no faster than one moves, and no faster over a triangle than at its corners where
/// the nearest points of these share a face. Triangles that cannot hold the largest distance are dropped, the others halved,
/// until none is left: none is more than kHausdorffTolerance too small. Means are sums over equal parts of faces. The same for
/// any number of threads; wrong once cancelled. Precondition: both meshes have an area.
HausdorffDistance hausdorff_distance(const TriangleMesh& first, const TriangleMesh& second, const HausdorffOptions& options = {},
                                     const ExecutionContext& context = {});

}  // namespace curvecast
