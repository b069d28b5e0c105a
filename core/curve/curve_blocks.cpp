#include "core/curve/curve_blocks.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/simd.h"
#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 512;  // blocks

// A bound is as large as the largest of what it holds, and this much for rounding.
constexpr float kSlack = 1.0001f;

}  // namespace

CURVECAST_WIDE void sum_blocks(const float (&mass)[kBlockSize][kBlockLanes], MassOfBlocks& out) {
  using Numbers = float __attribute__((vector_size(kBlockLanes * sizeof(float))));
  using Codes = std::int32_t __attribute__((vector_size(kBlockLanes * sizeof(std::int32_t))));
  Numbers sum = {}, largest = {}, through[kBlockSize];
  Codes last = {};  // with mass
  for (std::size_t i = 0; i < kBlockSize; ++i) {
    Numbers m;
    load_lanes(m, mass[i]);
    sum += m;
    largest = largest > m ? largest : m;
    last = m > 0 ? Codes{} + static_cast<std::int32_t>(i) : last;
    through[i] = sum;
  }
  constexpr auto kWhole = static_cast<float>(MassCodes::kWhole);
  const Numbers scale = sum > 0 ? kWhole / sum : Numbers{};
  std::int32_t code[kBlockSize][kBlockLanes];
  for (std::size_t i = 0; i < kBlockSize; ++i) {
    const Numbers part = through[i] * scale;  // NaN where the sum is infinite
    const Numbers below = part < kWhole ? part : Numbers{} + kWhole;
    const Codes whole = Codes{} + MassCodes::kWhole;
    store_lanes(static_cast<std::int32_t>(i) < last ? __builtin_convertvector(below, Codes) : whole, code[i]);
  }
  store_lanes(sum, out.sum);
  store_lanes(largest, out.largest);
  for (std::size_t k = 0; k < kBlockLanes; ++k) {
    for (std::size_t i = 0; i < kBlockSize; ++i) out.codes[k].through[i] = static_cast<std::int16_t>(code[i][k]);
  }
}

BlockMass block_mass(std::span<const float> density, std::span<const float> area) {
  BlockMass out;
  const std::size_t blocks = block_count(area.size());
  out.sum.resize(blocks);
  out.largest.resize(blocks);
  out.codes.resize(blocks);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (blocks + kBlockLanes - 1) / kBlockLanes, kGrain), [&](const auto& range) {
    float mass[kBlockSize][kBlockLanes];
    MassOfBlocks of;
    for (std::size_t group = range.begin(); group < range.end(); ++group) {
      const std::size_t first = group * kBlockLanes, count = std::min(kBlockLanes, blocks - first);
      for (std::size_t k = 0; k < kBlockLanes; ++k) {
        for (std::size_t i = 0; i < kBlockSize; ++i) {
          const std::size_t l = (first + k) * kBlockSize + i;
          mass[i][k] = l >= area.size() ? 0 : density.empty() ? area[l] : density[l] * area[l];
        }
      }
      sum_blocks(mass, of);
      std::copy_n(of.sum, count, &out.sum[first]);
      std::copy_n(of.largest, count, &out.largest[first]);
      std::copy_n(of.codes, count, &out.codes[first]);
    }
  });
  for (const float sum : out.sum) out.total += static_cast<double>(sum);
  for (const float largest : out.largest) out.most = std::max(out.most, largest);
  return out;
}

CurveBlocks build_blocks(const SurfaceCurve& curve) {
  CurveBlocks out;
  const std::size_t blocks = block_count(curve.size());
  for (Column<float>* column : {&out.x, &out.y, &out.z, &out.radius, &out.nx, &out.ny, &out.nz, &out.spread}) {
    column->resize(blocks);
  }
  const auto measure = [&](std::size_t b, std::size_t begin, std::size_t end) {
    Vec3f min = curve.position(begin), max = min, sum = Vec3f::Zero();
    for (std::size_t l = begin; l < end; ++l) {
      min = min.cwiseMin(curve.position(l));
      max = max.cwiseMax(curve.position(l));
      sum += curve.normal(l);
    }
    const Vec3f middle = 0.5f * min + 0.5f * max;
    const float length = sum.norm();
    const Vec3f normal = length > 0 ? Vec3f(sum / length) : curve.normal(begin);
    float radius = 0, spread = 0;
    for (std::size_t l = begin; l < end; ++l) {
      radius = std::max(radius, (curve.position(l) - middle).norm());
      spread = std::max(spread, curve.normals_from(l, normal));
    }
    out.x[b] = middle.x(), out.y[b] = middle.y(), out.z[b] = middle.z();
    out.nx[b] = normal.x(), out.ny[b] = normal.y(), out.nz[b] = normal.z();
    out.radius[b] = kSlack * radius;
    out.spread[b] = kSlack * spread;
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, kGrain), [&](const auto& range) {
    for (std::size_t b = range.begin(); b < range.end(); ++b) {
      measure(b, b * kBlockSize, std::min((b + 1) * kBlockSize, curve.size()));
    }
  });
  out.area = block_mass({}, curve.area);
  return out;
}

std::size_t CurveBlocks::byte_size() const { return 8 * size() * sizeof(float) + area.byte_size(); }

}  // namespace curvecast
