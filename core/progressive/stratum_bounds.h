// What holds all places of a stratum, however deep its points are asked for: what a view needs to know before it looks at them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/progressive/curve_strata.h"

namespace curvecast {

struct StratumBound {
  Vec3f center = Vec3f::Zero();  // of a sphere that holds the places, relative to the curve's origin
  float radius = 0;
  Vec3f normal = Vec3f::UnitZ();  // unit; their normals lie within `spread` of it, as points on the unit sphere
  float spread = 0;
  std::uint32_t first_vertex = 0, last_vertex = 0;  // they lie in the leaves of [first_vertex, last_vertex]
};

/// Keeps the address of `strata`. Immutable: any number of threads may ask.
class StratumBounds {
 public:
  /// Runs on all threads of the arena. Precondition: the curve has its blocks.
  explicit StratumBounds(const CurveStrata& strata);

  StratumBound of(int level, std::uint64_t stratum) const;

 private:
  const CurveStrata* strata_;
  std::vector<float> extent_;  // of each block: how far from a curve vertex a place in its leaf may be
};

}  // namespace curvecast
