#include "core/curve/curve_blocks.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 512;  // blocks

// A bound is as large as the largest of what it holds, and this much for rounding.
constexpr float kSlack = 1.0001f;

/// Calls visit(block, begin, end) for all blocks of n vertices.
template <typename Visit>
void for_each_block(std::size_t n, const Visit& visit) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, block_count(n), kGrain), [&](const auto& range) {
    for (std::size_t b = range.begin(); b < range.end(); ++b) visit(b, b * kBlockSize, std::min((b + 1) * kBlockSize, n));
  });
}

}  // namespace

MassOfBlock sum_block(const float* mass, std::size_t n) {
  MassOfBlock out{0, 0, {}};
  float below[kBlockSize];
  std::size_t last = 0;  // with mass
  for (std::size_t i = 0; i < n; ++i) {
    out.sum += mass[i];
    out.largest = out.largest > mass[i] ? out.largest : mass[i];
    below[i] = out.sum;
    last = mass[i] > 0 ? i : last;
  }
  if (!std::isfinite(out.sum)) last = 0;  // there is no such place
  const float scale = MassCodes::kWhole / out.sum;
  for (std::size_t i = 0; i < kBlockSize; ++i) {
    out.codes.through[i] = i < last ? static_cast<std::int16_t>(below[i] * scale) : MassCodes::kWhole;
  }
  return out;
}

BlockMass block_mass(std::span<const float> density, std::span<const float> area) {
  BlockMass out;
  const std::size_t blocks = block_count(area.size());
  out.sum.resize(blocks);
  out.largest.resize(blocks);
  out.codes.resize(blocks);
  for_each_block(area.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
    float mass[kBlockSize];
    for (std::size_t l = begin; l < end; ++l) mass[l - begin] = density.empty() ? area[l] : density[l] * area[l];
    const MassOfBlock block = sum_block(mass, end - begin);
    out.sum[b] = block.sum;
    out.largest[b] = block.largest;
    out.codes[b] = block.codes;
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
  for_each_block(curve.size(), [&](std::size_t b, std::size_t begin, std::size_t end) {
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
      spread = std::max(spread, (curve.normal(l) - normal).norm());
    }
    out.x[b] = middle.x(), out.y[b] = middle.y(), out.z[b] = middle.z();
    out.nx[b] = normal.x(), out.ny[b] = normal.y(), out.nz[b] = normal.z();
    out.radius[b] = kSlack * radius;
    out.spread[b] = kSlack * spread;
  });
  out.area = block_mass({}, curve.area);
  return out;
}

std::size_t CurveBlocks::byte_size() const { return 8 * size() * sizeof(float) + area.byte_size(); }

}  // namespace curvecast
