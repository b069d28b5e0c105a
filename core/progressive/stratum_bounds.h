// Bounds of a stratum that hold for all points that may ever lie in it, however deep their level: a view looks at these first.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/density/picture_detail.h"
#include "core/progressive/curve_strata.h"

namespace curvecast {

struct StratumBound {
  Vec3f centre = Vec3f::Zero();  // of a sphere around the points, relative to the curve's origin
  float radius = 0;
  Vec3f normal = Vec3f::UnitZ();  // unit length
  float spread = 0;               // the points' normals, as points on the unit sphere, lie within this distance of `normal`
  float detail = 1;               // the largest PictureDetail in their leaves
  std::uint32_t first_vertex = 0, last_vertex = 0;  // the points lie in the leaves of [first_vertex, last_vertex]
};

/// Finds bounds of strata. Keeps the address of `strata`. Immutable: any number of threads may ask.
class StratumBounds {
 public:
  /// Runs on all threads of the arena. Precondition: the curve has its blocks.
  explicit StratumBounds(const CurveStrata& strata);

  /// Returns the bounds of a stratum.
  StratumBound of(int level, std::uint64_t stratum) const;

 private:
  StratumBound within_leaves(int level, std::uint64_t stratum) const;

  float most_detail(std::size_t first_vertex, std::size_t last_vertex) const;

  const CurveStrata* strata_;
  PictureDetail picture_detail_;
  // Of each block of curve vertices.
  std::vector<float> extent_;  // the largest distance from a vertex to a corner of its leaf
  std::vector<float> detail_;  // the largest PictureDetail
};

}  // namespace curvecast
