#include "core/mesh/face_order.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>

#include "core/base/for_all.h"
#include "core/base/simd.h"
#include "core/mesh/centroid.h"

namespace curvecast {
namespace {

constexpr int kBits = 16;  // of each coordinate
constexpr std::size_t kBatch = 64;
constexpr std::size_t kGrain = 64 * kBatch;

/// Cells of a cube: their coordinates, which become those of a place on the curve, bit after bit.
struct Cells {
  std::array<std::array<std::uint32_t, kBatch>, 3> x = {};
};

/// Turns coordinates into the transposed index on the curve: bit i of the index's digits is in x[0], x[1] and x[2].
CURVECAST_WIDE void transpose(Cells& cells) {
  auto& x = cells.x;
  for (int bit = kBits - 1; bit > 0; --bit) {
    const std::uint32_t below = (1U << bit) - 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < kBatch; ++k) {
        // Where the bit is set the lower bits of x[0] are inverted, elsewhere exchanged with the axis's.
        const std::uint32_t is_set = 0U - (x[axis][k] >> bit & 1U);
        const std::uint32_t exchanged = (x[0][k] ^ x[axis][k]) & below & ~is_set;
        x[0][k] ^= exchanged ^ (below & is_set);
        x[axis][k] ^= exchanged;
      }
    }
  }
  for (std::size_t k = 0; k < kBatch; ++k) {
    x[1][k] ^= x[0][k];
    x[2][k] ^= x[1][k];
    std::uint32_t flips = 0;
    for (int bit = kBits - 1; bit > 0; --bit) flips ^= (0U - (x[2][k] >> bit & 1U)) & ((1U << bit) - 1);
    for (std::size_t axis = 0; axis < 3; ++axis) x[axis][k] ^= flips;
  }
}

/// Puts two zeros before each of 16 bits.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 16) & 0x0000'ff00'00ff;
  bits = (bits | bits << 8) & 0x00f0'0f00'f00f;
  bits = (bits | bits << 4) & 0x0c30'c30c'30c3;
  return (bits | bits << 2) & 0x2492'4924'9249;
}

struct KeyedFace {
  std::uint64_t key;
  std::uint32_t face;

  auto operator<=>(const KeyedFace&) const = default;
};

}  // namespace

std::vector<std::uint32_t> face_order(const TriangleMesh& mesh, const ExecutionContext& context) {
  const Box3d box = bounding_box(mesh);
  const double side = (box.max - box.min).maxCoeff(), scale = side > 0 ? ((1 << kBits) - 1) / side : 0;
  std::vector<KeyedFace> keyed(mesh.triangles.size());
  for_blocks(context, keyed.size(), kGrain, [&](std::size_t block_begin, std::size_t block_end) {
    Cells cells;
    for (std::size_t begin = block_begin; begin < block_end; begin += kBatch) {
      const std::size_t count = std::min(kBatch, block_end - begin);
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3d cell = scale * (centroid(mesh, begin + k) - box.min);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          cells.x[axis][k] = static_cast<std::uint32_t>(std::max(cell[static_cast<Eigen::Index>(axis)], 0.0));
        }
      }
      transpose(cells);
      for (std::size_t k = 0; k < count; ++k) {
        const std::uint64_t key = spread(cells.x[0][k]) << 2 | spread(cells.x[1][k]) << 1 | spread(cells.x[2][k]);
        keyed[begin + k] = {key, static_cast<std::uint32_t>(begin + k)};
      }
    }
  });
  tbb::parallel_sort(keyed.begin(), keyed.end());
  std::vector<std::uint32_t> order(keyed.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = keyed[i].face;
  return order;
}

}  // namespace curvecast
