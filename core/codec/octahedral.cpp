#include "core/codec/octahedral.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/lanes.h"

namespace curvecast {
namespace {

// So many at a time, by coordinates, that compilers see plain loops over arrays and all stays in the nearest cache.
constexpr std::size_t kBlock = 256;

struct Block {
  float x[kBlock], y[kBlock], z[kBlock];
  std::int32_t a[kBlock], b[kBlock];          // y and z on the octahedron, all coordinates of which add up to the centre
  std::int32_t s[kBlock + 1], t[kBlock + 1];  // on the square, from the middle; [0]: of the point before the block
};

[[gnu::always_inline]] inline std::int32_t magnitude(std::int32_t x) { return x < 0 ? -x : x; }

/// The largest integer that is not above x; |x| < 2^31. floor() needs instructions that not every machine has.
[[gnu::always_inline]] inline std::int32_t floor_of(double x) {
  const auto truncated = static_cast<std::int32_t>(x);
  return truncated - (static_cast<double>(truncated) > x ? 1 : 0);
}

CURVECAST_WIDE void project(Block& block, std::size_t n, std::int32_t center) {
  constexpr double kLeast = 1e-6, kMost = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < n; ++i) {
    const double x = block.x[i], y = block.y[i], z = block.z[i];
    const double sum = std::abs(x) + std::abs(y) + std::abs(z);
    const bool is_direction = (sum > kLeast) & (sum <= kMost);
    const double scale = 1.0 / (is_direction ? sum : 1.0);
    block.a[i] = floor_of((is_direction ? x : 1.0) * scale * center + 0.5);
    block.b[i] = floor_of((is_direction ? y : 0.0) * scale * center + 0.5);
    block.z[i] = is_direction ? block.z[i] : 0.0f;
  }
}

/// From the octahedron to the square, whose border folds: of two of its points that are one, that in the lower left or upper
/// right.
CURVECAST_WIDE void unfold(Block& block, std::size_t n, std::int32_t center) {
  for (std::size_t i = 0; i < n; ++i) {
    const std::int32_t x = block.a[i], rest = center - magnitude(x);
    // Rounding may make x and y together longer than all three may be.
    const std::int32_t y = block.b[i] > 0 ? std::min(block.b[i], rest) : std::max(block.b[i], -rest);
    const std::int32_t long_z = rest - magnitude(y);
    const std::int32_t z = block.z[i] < 0 ? -long_z : long_z;
    const std::int32_t s_behind = y < 0 ? magnitude(z) - center : center - magnitude(z);
    const std::int32_t t_behind = z < 0 ? magnitude(y) - center : center - magnitude(y);
    const std::int32_t s = x >= 0 ? y : s_behind, t = x >= 0 ? z : t_behind;
    const bool on_left = s == -center, on_right = s == center, at_bottom = t == -center, at_top = t == center;
    const bool at_corner = (on_left | on_right) & (at_bottom | at_top);
    const bool turns_t = (on_left & (t > 0)) | (on_right & (t < 0));
    const bool turns_s = (at_top & (s < 0)) | (at_bottom & (s > 0));
    block.s[i + 1] = at_corner ? center : turns_s ? -s : s;
    block.t[i + 1] = at_corner ? center : turns_t ? -t : t;
  }
}

CURVECAST_WIDE void correct(const Block& block, std::size_t n, const OctahedralLattice& lattice,
                            std::uint32_t* __restrict symbols) {
  const std::int32_t center = lattice.center, modulus = lattice.modulus;
  // The inner diamond and the triangles around it change places; where u is 0, v says in which quarter that is.
  const auto inverted = [&](std::int32_t u, std::int32_t v) {
    const std::int32_t length = center - magnitude(v);
    return (u < 0) | ((u == 0) & (v < 0)) ? -length : length;
  };
  for (std::size_t i = 0; i < n; ++i) {
    std::int32_t s = block.s[i + 1], t = block.t[i + 1], s0 = block.s[i], t0 = block.t[i];
    const bool inverts = magnitude(s0) + magnitude(t0) > center;
    const std::int32_t si = inverted(s, t), ti = inverted(t, s), s0i = inverted(s0, t0), t0i = inverted(t0, s0);
    s = inverts ? si : s;
    t = inverts ? ti : t;
    s0 = inverts ? s0i : s0;
    t0 = inverts ? t0i : t0;
    // Quarter turns that bring the point before to the lower left.
    const bool by_one = (t0 < 0) & (s0 >= 0), by_two = (s0 > 0) & (t0 >= 0), by_three = (t0 > 0) & (s0 <= 0);
    const std::int32_t ds = s - s0, dt = t - t0;
    const std::int32_t u = by_one ? dt : by_two ? -ds : by_three ? -dt : ds;
    const std::int32_t v = by_one ? -ds : by_two ? -dt : by_three ? ds : dt;
    symbols[2 * i] = static_cast<std::uint32_t>(u < 0 ? u + modulus : u);
    symbols[2 * i + 1] = static_cast<std::uint32_t>(v < 0 ? v + modulus : v);
  }
}

}  // namespace

void octahedral_symbols(const OctahedralLattice& lattice, std::span<const Vec3f> normals, std::span<std::uint32_t> symbols) {
  Block block;
  block.s[0] = block.t[0] = -lattice.center;
  for (std::size_t begin = 0; begin < normals.size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, normals.size() - begin);
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3f& normal = normals[begin + i];
      block.x[i] = normal.x();
      block.y[i] = normal.y();
      block.z[i] = normal.z();
    }
    project(block, n, lattice.center);
    unfold(block, n, lattice.center);
    correct(block, n, lattice, &symbols[2 * begin]);
    block.s[0] = block.s[n];
    block.t[0] = block.t[n];
  }
}

}  // namespace curvecast
