#include "core/codec/octahedral.h"

#include <algorithm>
#include <array>
#include <limits>

#include "core/base/simd.h"

namespace curvecast {
namespace {

// So many at a time that all stays in the nearest cache.
constexpr std::size_t kBlock = 256, kLanes = 8, kDoubles = 4;

using Int8 = std::int32_t __attribute__((vector_size(32)));

struct alignas(32) Block {
  std::int32_t a[kBlock], b[kBlock];                    // x and y on the octahedron, where all three add up to the centre
  std::int32_t is_below[kBlock];                        // z < 0: -1, else 0
  std::int32_t s[kLanes + kBlock], t[kLanes + kBlock];  // on the square, from the middle; [kLanes - 1]: the point before
  std::uint32_t symbols[2 * kBlock];
};

/// Where the mask is set.
[[gnu::always_inline]] inline void negate(Int8& x, const Int8& mask) { x = (x ^ mask) - mask; }

[[gnu::always_inline]] inline void take_magnitude(const Int8& x, Int8& magnitude) {
  magnitude = x;
  negate(magnitude, x < 0);
}
[[gnu::always_inline]] inline void take_magnitude(const Double4& x, Double4& magnitude) {
  magnitude = reinterpret_cast<Double4>(reinterpret_cast<Mask4>(x) & std::numeric_limits<std::int64_t>::max());
}

[[gnu::always_inline]] inline void take_half(const Mask4& mask, Int4& half) {
  const auto parts = reinterpret_cast<Int8>(mask);
  half = __builtin_shufflevector(parts, parts, 0, 2, 4, 6);
}

/// The largest integers that are not above x; |x| < 2^31. Not every machine has an instruction for it.
[[gnu::always_inline]] inline void take_floor(const Double4& x, Int4& floor) {
  constexpr double kRounds = 3.0 * (std::int64_t{1} << 51);  // numbers of this size are integers
  const Double4 rounded = (x + kRounds) - kRounds, one = Double4{} + 1.0;
  const auto excess = reinterpret_cast<Double4>((rounded > x) & reinterpret_cast<Mask4>(one));
  floor = __builtin_convertvector(rounded - excess, Int4);
}

CURVECAST_WIDE void project(const float* normals, Block& block, std::int32_t center) {
  constexpr double kLeast = 1e-6, kMost = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < kBlock; i += kDoubles) {
    // x, y, z of four normals that lie one after the other.
    Float4 first, second, third;
    load_lanes(first, normals + 3 * i);
    load_lanes(second, normals + 3 * i + 4);
    load_lanes(third, normals + 3 * i + 8);
    const Float4 x012 = __builtin_shufflevector(first, second, 0, 3, 6, -1);
    const Float4 y012 = __builtin_shufflevector(first, second, 1, 4, 7, -1);
    const Float4 z01 = __builtin_shufflevector(first, second, 2, 5, -1, -1);
    const Double4 x = __builtin_convertvector(__builtin_shufflevector(x012, third, 0, 1, 2, 5), Double4);
    const Double4 y = __builtin_convertvector(__builtin_shufflevector(y012, third, 0, 1, 2, 6), Double4);
    const Float4 short_z = __builtin_shufflevector(z01, third, 0, 1, 4, 7);
    const Double4 z = __builtin_convertvector(short_z, Double4);

    Double4 wide_x, wide_y, wide_z;
    take_magnitude(x, wide_x);
    take_magnitude(y, wide_y);
    take_magnitude(z, wide_z);
    const Double4 sum = wide_x + wide_y + wide_z, scale = 1.0 / sum;
    Int4 a, b, is_direction;
    take_floor(x * scale * center + 0.5, a);
    take_floor(y * scale * center + 0.5, b);
    take_half((sum > kLeast) & (sum <= kMost), is_direction);
    store_lanes((a & is_direction) | (center & ~is_direction), &block.a[i]);
    store_lanes(b & is_direction, &block.b[i]);
    store_lanes((short_z < 0) & is_direction, &block.is_below[i]);
  }
}

/// From the octahedron to the square, whose border folds: of two of its points that are one, that in the lower left or upper
/// right.
CURVECAST_WIDE void unfold(Block& block, std::int32_t center_in) {
  const Int8 center = Int8{} + center_in;
  for (std::size_t i = 0; i < kBlock; i += kLanes) {
    Int8 x, y, is_below, wide_x, wide_y;
    load_lanes(x, &block.a[i]);
    load_lanes(y, &block.b[i]);
    load_lanes(is_below, &block.is_below[i]);
    // Rounding may make x and y together longer than all three may be.
    take_magnitude(x, wide_x);
    const Int8 rest = center - wide_x;
    y = y > rest ? rest : y;
    y = y < -rest ? -rest : y;
    take_magnitude(y, wide_y);
    const Int8 wide_z = rest - wide_y;
    Int8 z = wide_z, s_behind = center - wide_z, t_behind = center - wide_y;
    negate(z, is_below);
    negate(s_behind, y < 0);
    negate(t_behind, z < 0);
    Int8 s = x < 0 ? s_behind : y, t = x < 0 ? t_behind : z;
    const Int8 on_left = s == -center, on_right = s == center, at_bottom = t == -center, at_top = t == center;
    const Int8 at_corner = (on_left | on_right) & (at_bottom | at_top);
    const Int8 turns_s = (at_top & (s < 0)) | (at_bottom & (s > 0));
    const Int8 turns_t = (on_left & (t > 0)) | (on_right & (t < 0));
    negate(s, turns_s);
    negate(t, turns_t);
    store_lanes(at_corner ? center : s, &block.s[kLanes + i]);
    store_lanes(at_corner ? center : t, &block.t[kLanes + i]);
  }
}

/// The inner diamond and the triangles around it change places; where u is 0, v says in which quarter that is.
[[gnu::always_inline]] inline void invert(const Int8& center, Int8& u, Int8& v) {
  Int8 wide_u, wide_v;
  take_magnitude(u, wide_u);
  take_magnitude(v, wide_v);
  const Int8 u_is_low = (u < 0) | ((u == 0) & (v < 0)), v_is_low = (v < 0) | ((v == 0) & (u < 0));
  u = center - wide_v;
  v = center - wide_u;
  negate(u, u_is_low);
  negate(v, v_is_low);
}

CURVECAST_WIDE void correct(Block& block, std::int32_t center_in, std::int32_t modulus) {
  const Int8 center = Int8{} + center_in;
  for (std::size_t i = 0; i < kBlock; i += kLanes) {
    Int8 s, t, p, q, wide_p, wide_q;
    load_lanes(s, &block.s[kLanes + i]);
    load_lanes(t, &block.t[kLanes + i]);
    load_lanes(p, &block.s[kLanes + i - 1]);
    load_lanes(q, &block.t[kLanes + i - 1]);
    take_magnitude(p, wide_p);
    take_magnitude(q, wide_q);
    const Int8 inverts = wide_p + wide_q > center;
    Int8 si = s, ti = t, pi = p, qi = q;
    invert(center, si, ti);
    invert(center, pi, qi);
    const Int8 ds = inverts ? si - pi : s - p, dt = inverts ? ti - qi : t - q;
    p = inverts ? pi : p;
    q = inverts ? qi : q;
    // Quarter turns that bring the point before to the lower left.
    const Int8 by_one = (q < 0) & (p >= 0), by_two = (p > 0) & (q >= 0), by_three = (q > 0) & (p <= 0);
    const Int8 swaps = by_one | by_three;
    Int8 u = swaps ? dt : ds, v = swaps ? ds : dt;
    negate(u, by_two | by_three);
    negate(v, by_one | by_two);
    u += (u < 0) & modulus;
    v += (v < 0) & modulus;
    store_lanes(__builtin_shufflevector(u, v, 0, 8, 1, 9, 2, 10, 3, 11), &block.symbols[2 * i]);
    store_lanes(__builtin_shufflevector(u, v, 4, 12, 5, 13, 6, 14, 7, 15), &block.symbols[2 * i + kLanes]);
  }
}

}  // namespace

void octahedral_symbols(const OctahedralLattice& lattice, std::span<const Vec3f> normals, std::span<std::uint32_t> symbols) {
  Block block;
  block.s[kLanes - 1] = block.t[kLanes - 1] = -lattice.center;
  std::array<float, 3 * kBlock> last;  // a block that is not full is filled up
  for (std::size_t begin = 0; begin < normals.size(); begin += kBlock) {
    const std::size_t n = std::min(kBlock, normals.size() - begin);
    const float* from = normals[begin].data();
    if (n < kBlock) {
      std::fill(std::copy_n(from, 3 * n, last.begin()), last.end(), 0.0f);
      from = last.data();
    }
    project(from, block, lattice.center);
    unfold(block, lattice.center);
    correct(block, lattice.center, lattice.modulus);
    std::copy_n(block.symbols, 2 * n, &symbols[2 * begin]);
    block.s[kLanes - 1] = block.s[kLanes + n - 1];
    block.t[kLanes - 1] = block.t[kLanes + n - 1];
  }
}

}  // namespace curvecast
