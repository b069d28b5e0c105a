// How a leaf of the curve lies on the surface, so that there are places within it.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/vec.h"
#include "core/curve/hilbert.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// What one goes in space by going along the whole of a leaf's sides in the parameter square; zero where that is not known.
struct LeafFrame {
  Vec3f along_x = Vec3f::Zero(), along_y = Vec3f::Zero();
  HilbertState state = 0;  // how the curve runs in it

  bool is_known() const { return along_x != Vec3f::Zero(); }
  /// From the leaf's vertex to the place at which the curve has passed a part of the leaf's area, in [0, 1].
  Vec3f offset(double part) const;
};

/// Frames of the leaves of a curve, by least squares from the two vertices before and after each on the curve. Fastest for leaves
/// near each other. Keeps the curve's address. Not for several threads at once.
class LeafFrames {
 public:
  explicit LeafFrames(const SurfaceCurve& curve);

  /// Returns the frame of leaf l of the curve.
  LeafFrame of(std::size_t l);

 private:
  struct Quad {
    double x, y, size;  // middle, in the parameter square
    HilbertState state;
  };

  const Quad& quad(std::size_t l);

  const SurfaceCurve* curve_;
  std::array<Quad, 8> quads_;  // of the leaves asked about last
  std::array<std::size_t, 8> known_;
};

}  // namespace curvecast
