// Points with normals and spacings, for what keeps them apart.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/vec.h"
#include "core/sample/point_blocks.h"

namespace curvecast::testing {

struct Particle {
  Vec3f position, normal;
  float spacing;
};

/// In a cube from -1 to 1, with any normals. Neighbours follow one another only roughly: their blocks overlap.
std::vector<Particle> random_particles(std::size_t n, float least_spacing, float most_spacing);

PointBlocks blocks_of(const std::vector<Particle>& particles);

}  // namespace curvecast::testing
