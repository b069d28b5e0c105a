#include "core/sample/voronoi_cell.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/base/simd.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = PointBlocks::kBlock, kDirections = VoronoiCell::kDirections;
constexpr float kLeastDistance = 1e-6F;  // of the radius: what is nearer is at the same place
constexpr float kLeastCosine = -0.25F;   // of normals: more faces away
constexpr float kCos1 = 0.9238795F, kCos2 = 0.70710678F, kCos3 = 0.38268343F;
constexpr std::array<float, kDirections> kX = {1,  kCos1,  kCos2,  kCos3,  0, -kCos3, -kCos2, -kCos1,
                                               -1, -kCos1, -kCos2, -kCos3, 0, kCos3,  kCos2,  kCos1};
constexpr std::array<float, kDirections> kY = {0, kCos3,  kCos2,  kCos1,  1,  kCos1,  kCos2,  kCos3,
                                               0, -kCos3, -kCos2, -kCos1, -1, -kCos1, -kCos2, -kCos3};

/// The lines halfway to the points of a block: what is beyond one has a product with it of more than the cell's radius.
struct Lines {
  float x[kBlock], y[kBlock];
};

/// Returns which of the points matter: bit by bit.
[[gnu::always_inline]] inline std::uint32_t find_lines(const PointBlocks::Columns& others, const PointBlocks::Point& p,
                                                       const Vec3f& x_axis, const Vec3f& y_axis, float radius, Lines& lines) {
  const float least = kLeastDistance * radius, most = kCellReach / kCellRadius * radius;
  const float ux = x_axis[0], uy = x_axis[1], uz = x_axis[2], vx = y_axis[0], vy = y_axis[1], vz = y_axis[2];
  std::int32_t matters[kBlock];
  for (std::size_t k = 0; k < kBlock; ++k) {
    const float dx = others.x[k] - p.x, dy = others.y[k] - p.y, dz = others.z[k] - p.z;
    const float cosine = p.nx * others.nx[k] + p.ny * others.ny[k] + p.nz * others.nz[k];
    const float distance = std::sqrt(dx * dx + dy * dy + dz * dz);
    const float x = dx * ux + dy * uy + dz * uz, y = dx * vx + dy * vy + dz * vz;
    const float flat = std::sqrt(x * x + y * y);
    matters[k] = (distance < most) & (flat > least) & (cosine > kLeastCosine);
    // As if it were in the plane, as far as it is; of the way there the point's part is as its spacing is of both.
    const float scale = radius / distance * ((p.spacing + others.spacing[k]) / p.spacing) / flat;
    lines.x[k] = scale * x;
    lines.y[k] = scale * y;
  }
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < kBlock; ++k) bits |= static_cast<std::uint32_t>(matters[k]) << k;
  return bits;
}

/// Raises the inverses to what the points ask for that scratch has found near.
CURVECAST_WIDE void limit_by(const PointBlocks& points, const PointBlocks::Point& p, const PointBlocks::Scratch& scratch,
                             const Vec3f& x_axis, const Vec3f& y_axis, float radius, std::array<float, kDirections>& inverse) {
  float most[kDirections];
  for (std::size_t d = 0; d < kDirections; ++d) most[d] = inverse[d];
  Lines lines;
  for (std::size_t n = 0; n < scratch.near.size(); ++n) {
    if (scratch.is_near[n] == 0) continue;
    std::uint32_t left = find_lines(points.columns(scratch.near[n]), p, x_axis, y_axis, radius, lines);
    for (; left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      const float x = lines.x[k], y = lines.y[k];
      for (std::size_t d = 0; d < kDirections; ++d) most[d] = fast_max(most[d], x * kX[d] + y * kY[d]);
    }
  }
  for (std::size_t d = 0; d < kDirections; ++d) inverse[d] = most[d];
}

}  // namespace

VoronoiCell::VoronoiCell(const Vec3f& normal, float radius) : radius_(radius) {
  inverse_.fill(1);
  if (!(normal.squaredNorm() > 0)) return;
  constexpr float kSteep = 0.7F;
  x_axis_ = (std::abs(normal.x()) < kSteep ? Vec3f::UnitX() : Vec3f::UnitY()).cross(normal).normalized();
  y_axis_ = normal.cross(x_axis_);
}

Vec3f VoronoiCell::direction(std::size_t k) const { return kX[k] * x_axis_ + kY[k] * y_axis_; }

void VoronoiCell::cut(const Vec3f& to, float part) {
  const float x = to.dot(x_axis_), y = to.dot(y_axis_);
  const float distance = to.norm(), flat = std::sqrt(x * x + y * y);
  if (!(flat > kLeastDistance * radius_)) return;
  const float scale = radius_ / distance / part / flat;
  for (std::size_t d = 0; d < kDirections; ++d) inverse_[d] = fast_max(inverse_[d], scale * (x * kX[d] + y * kY[d]));
}

float VoronoiCell::area() const {
  float sum = 0;
  for (std::size_t d = 0, before = kDirections - 1; d < kDirections; before = d++) sum += 1 / (inverse_[before] * inverse_[d]);
  return kCos3 / 2 * radius_ * radius_ * sum;  // the sine of the angle between two directions
}

Vec3f VoronoiCell::centre() const {
  float all = 0, x = 0, y = 0;
  for (std::size_t d = 0, before = kDirections - 1; d < kDirections; before = d++) {
    const float from = 1 / inverse_[before], to = 1 / inverse_[d], area = from * to;
    all += area;
    x += area * (from * kX[before] + to * kX[d]);
    y += area * (from * kY[before] + to * kY[d]);
  }
  return radius_ / (3 * all) * (x * x_axis_ + y * y_axis_);
}

VoronoiCell voronoi_cell(const PointBlocks& points, std::size_t i, PointBlocks::Scratch& scratch) {
  const PointBlocks::Point p = points.point(i);
  VoronoiCell cell(Vec3f(p.nx, p.ny, p.nz), kCellRadius * p.spacing);
  PointBlocks::mark_near(p, kCellReach, scratch, kCellLeast);
  limit_by(points, p, scratch, cell.x_axis_, cell.y_axis_, cell.radius_, cell.inverse_);
  return cell;
}

}  // namespace curvecast
