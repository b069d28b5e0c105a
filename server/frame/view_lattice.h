// The lattice that a request's points are sent on: as fine as its cameras' pixels ask for.
#pragma once

#include <optional>

#include "core/curve/surface_curve.h"
#include "core/progressive/rank_selection.h"
#include "core/sample/point_set.h"
#include "server/convert/point_set_request.h"

namespace curvecast::server {

/// Divides the largest side of the session's box into 2^bits - 1 steps. Of points that have come with several frames: the
/// coarsest of theirs.
struct ViewLattice {
  int bits = 0;  // 0: none, for raw floats
  /// From where positions count, absolute coordinates. Not set: from the curve's origin, and the lattice begins in the box's
  /// corner.
  std::optional<Vec3d> centre;

  bool operator==(const ViewLattice&) const = default;
};

/// What a request's points need of a lattice.
struct LatticeNeed {
  ViewLattice best;  // of the bits that the request asks for or, where it leaves them open, of those that its pixels need
  bool is_open = false;
  double pixels = 0;              // that a length of 1 covers at most, where there is a camera
  Vec3d nearest = Vec3d::Zero();  // the point where it does

  /// Whether the points can be sent as a difference to others that the client holds: these have too few bits by kMostMissingBits
  /// at most.
  bool is_met_by(const ViewLattice& held) const;
  /// Returns the lattice of the points that such a difference adds. Precondition: is_met_by(held).
  ViewLattice beside(const ViewLattice& held) const;
};

/// Finds the need of points, or of those that a selection shows, by the one that is nearest to a camera. Without a camera that is
/// kPlainPositionBits. `box`: of the surface.
LatticeNeed lattice_need(const PointSetRequest& request, const Box3d& box, const PointSet& points);
LatticeNeed lattice_need(const PointSetRequest& request, const SurfaceCurve& curve, const RankSelection& selection);

/// Has the positions of points that were just sampled count from where the lattice's do.
void move_origin(const ViewLattice& lattice, PointSet& points);

/// Returns the options with which a request's points are encoded on a lattice; none for raw floats.
std::optional<DracoOptions> draco_options(const PointSetRequest& request, const ViewLattice& lattice);

}  // namespace curvecast::server
