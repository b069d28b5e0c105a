// How evenly points lie on a surface, whatever its triangles: their discrepancy over Euclidean balls (compare section 4.2 of the
// paper, which grows rings of triangles).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/measure/discrepancy.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct BallOptions {
  int centres = 1024;      // count, >= 1
  int radii = 4;           // about each centre, >= 1
  std::uint64_t seed = 0;  // of centres and radii
};

/// Balls and the exact share that each has of the surface; made once for any number of point sets. Centres are random points of
/// the surface, uniform in area. Radii are uniform between 0 and the distance from the centre to the farthest point of the mesh,
/// as the paper's rings are equally likely up to the whole of it; with R radii about a centre, one is in each Rth of that range.
/// A ball takes in all that lies within its radius, on any side or component of the surface. The same for any number of threads.
/// Immutable once made: any number of threads may ask.
class BallDiscrepancy {
 public:
  /// `face_density`: what points of each face (F values, >= 0) are to be to those of others; empty = uniform.
  /// Preconditions: the mesh has an area, and the density is not zero everywhere. Without meaning once cancelled.
  explicit BallDiscrepancy(const TriangleMesh& mesh, const BallOptions& options = {}, std::span<const double> face_density = {},
                           const ExecutionContext& context = {});

  /// Absolute coordinates in the mesh's units, all finite. Precondition: there is a point.
  Discrepancy of(std::span<const Vec3d> points) const;

  /// Returns the share of the surface's area, weighted with the density, in each ball: all radii of the first centre, ascending,
  /// then of the next.
  std::span<const double> shares() const { return shares_; }

 private:
  std::size_t radii_;
  std::vector<Vec3d> centres_;
  std::vector<double> radius_, shares_;  // of each ball
};

}  // namespace curvecast
