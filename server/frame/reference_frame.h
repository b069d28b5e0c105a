// What the client of a stream holds after a frame, so that the next frame can be the difference to it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/curve/surface_curve.h"
#include "core/progressive/rank_selection.h"
#include "server/convert/point_set_request.h"
#include "server/frame/view_lattice.h"

namespace curvecast::server {

/// The selection of ranked points that a frame left with its client. Immutable. A stream keeps one from frame to frame, so it
/// takes little memory: some 50 KiB for 50,000 points.
class ReferenceFrame {
 public:
  /// Holds no points.
  ReferenceFrame() = default;
  /// Copies a selection from a curve with ranks, that was sent as `request` asks for, on a lattice.
  ReferenceFrame(std::shared_ptr<const SurfaceCurve> curve, const RankSelection& selection, const PointSetRequest& request,
                 const ViewLattice& lattice);

  /// Returns the selection without its discs, its tree, and the chunks of which nothing is shown.
  const RankSelection& selection() const { return selection_; }
  /// Writes the discs: selection().rungs.
  void discs(std::vector<std::uint8_t>& rungs) const;
  /// Returns the hash of the points, their discs and how they were sent; never 0.
  std::uint64_t digest() const { return digest_; }
  const ViewLattice& lattice() const { return lattice_; }
  /// Whether a delta from here to points of this curve, sent as `request` asks for, makes sense, if they may be sent on this
  /// lattice.
  bool goes_with(const SurfaceCurve& curve, const PointSetRequest& request) const;

  /// Returns the bytes allocated; the curve and the tree are shared and not counted.
  std::size_t byte_size() const;

 private:
  /// Equal discs, one after the other.
  struct Run {
    std::uint8_t rung, count;
  };

  void keep_runs(std::span<const std::uint8_t> rungs);

  std::shared_ptr<const SurfaceCurve> curve_;
  RankSelection selection_;
  std::vector<Run> discs_;
  ViewLattice lattice_;
  int normal_bits_ = 0;  // 0: raw floats
  PointAttributes attributes_;
  std::uint64_t digest_ = 0;
};

}  // namespace curvecast::server
