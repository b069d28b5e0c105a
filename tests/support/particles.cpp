#include "tests/support/particles.h"

#include <algorithm>
#include <random>

namespace curvecast::testing {

std::vector<Particle> random_particles(std::size_t n, float least_spacing, float most_spacing) {
  std::mt19937 generator(7);
  std::uniform_real_distribution<float> place(-1, 1), spacing(least_spacing, most_spacing);
  std::vector<Particle> particles;
  for (std::size_t i = 0; i < n; ++i) {
    const auto vector = [&] { return Vec3f(place(generator), place(generator), place(generator)); };
    const Vec3f position = vector();
    particles.push_back({position, vector().normalized(), spacing(generator)});
  }
  std::sort(particles.begin(), particles.end(),
            [](const Particle& a, const Particle& b) { return a.position.x() < b.position.x(); });
  return particles;
}

PointBlocks blocks_of(const std::vector<Particle>& particles) {
  PointBlocks points(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    points.set(i, particles[i].position, particles[i].normal, particles[i].spacing);
  }
  points.fill_boxes();
  return points;
}

}  // namespace curvecast::testing
