#include "core/curve/curve_hierarchy.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/float4.h"
#include "core/curve/hilbert.h"
#include "core/curve/surface_curve.h"

namespace curvecast {
namespace {

// Covers the rounding of a distance between floats.
constexpr float kRoundedUp = 1 + 1e-6f;
// By how much a packed unit vector's length may exceed 1: half a step in each coordinate, and a little.
constexpr float kPackedLength = 3e-5f;

/// What a node is made from but does not keep.
struct Sums {
  Vec3f min, max;
  Vec3f normal;
  double area;
};

/// Appends the node of [first, last) and those below it, ranges only.
void add_ranges(std::span<const std::uint64_t> key, std::uint32_t first, std::uint32_t last, std::vector<CurveNode>& nodes) {
  const std::size_t index = nodes.size();
  nodes.emplace_back().first = first;
  nodes[index].last = last;
  if (last - first > CurveHierarchy::kMaxLeafVertices) {
    // The smallest quad that holds all: two bits a level are common to the first key and the last.
    const int shift = (std::bit_width(key[first] ^ key[last - 1]) - 1) / 2 * 2;
    for (std::uint32_t begin = first; begin < last;) {
      const std::uint64_t next = ((key[begin] >> shift) + 1) << shift;
      const auto end = std::lower_bound(key.begin() + begin, key.begin() + last, next);
      const auto end_index = static_cast<std::uint32_t>(end - key.begin());
      add_ranges(key, begin, end_index, nodes);
      begin = end_index;
    }
  }
  nodes[index].skip = static_cast<std::uint32_t>(nodes.size());
}

void set_axis(const Vec3f& direction, CurveNode& node) {
  const float square = direction.squaredNorm();
  const Vec3f axis = square > 0 ? Vec3f(direction / std::sqrt(square)) : Vec3f::UnitZ();
  for (int i = 0; i < 3; ++i) node.axis[i] = axis[i];
}

/// Rounds down.
void set_cosine(float cosine, CurveNode& node) {
  constexpr float kSlack = 1e-6f;
  node.cosine.code = static_cast<std::int16_t>(cosine > kSlack ? std::floor((cosine - kSlack) * 32767.0f) : -32767.0f);
}

/// A leaf's vertices as plain floats, four by four; the last one stands again where the last four are not full.
struct LeafVertices {
  static constexpr std::size_t kMost = CurveHierarchy::kMaxLeafVertices;
  alignas(16) float position[3][kMost], normal[3][kMost], curvature_min[kMost], curvature_max[kMost];
  std::size_t size;

  LeafVertices(const SurfaceCurve& curve, std::size_t first, std::size_t count) : size((count + 3) / 4 * 4) {
    const auto take = [&](const auto& column, float* to) {
      for (std::size_t i = 0; i < count; ++i) to[i] = column[first + i];
      for (std::size_t i = count; i < size; ++i) to[i] = to[count - 1];
    };
    take(curve.x, position[0]), take(curve.y, position[1]), take(curve.z, position[2]);
    take(curve.nx, normal[0]), take(curve.ny, normal[1]), take(curve.nz, normal[2]);
    take(curve.curvature_min, curvature_min), take(curve.curvature_max, curvature_max);
  }
};

/// The smallest and largest of value(i), which stands for entries i .. i + 3.
template <typename Value>
ValueBounds bounds_of(std::size_t size, Value&& value) {
  Float4 low = value(0), high = low;
  for (std::size_t i = 4; i < size; i += 4) {
    const Float4 v = value(i);
    low = min(low, v);
    high = max(high, v);
  }
  alignas(16) float lows[4], highs[4];
  low.store(lows);
  high.store(highs);
  ValueBounds bounds;
  for (int i = 0; i < 4; ++i) bounds.extend({lows[i], highs[i]});
  return bounds;
}

void measure_curvature(const LeafVertices& vertices, CurveNode& node) {
  const Float4 zero = Float4::all(0);
  const auto magnitude = [&](Float4 v) { return max(v, zero - v); };
  const auto k1 = [&](std::size_t i) { return Float4::load(vertices.curvature_min + i); };
  const auto k2 = [&](std::size_t i) { return Float4::load(vertices.curvature_max + i); };
  const auto set = [&](CurvatureKind kind, auto&& value) {
    node.curvature[static_cast<int>(kind)] = bounds_of(vertices.size, value);
  };
  set(CurvatureKind::kGauss, [&](std::size_t i) { return magnitude(k1(i) * k2(i)); });
  set(CurvatureKind::kMean, [&](std::size_t i) { return Float4::all(0.5f) * magnitude(k1(i) + k2(i)); });
  set(CurvatureKind::kMax, [&](std::size_t i) { return max(magnitude(k1(i)), magnitude(k2(i))); });
}

void measure_leaf(const SurfaceCurve& curve, CurveNode& node, Sums& sums) {
  const LeafVertices vertices(curve, node.first, node.size());
  sums.area = 0;
  sums.normal.setZero();
  for (std::uint32_t i = 0; i < node.size(); ++i) {
    sums.area += static_cast<double>(curve.area[node.first + i]);
    sums.normal += Vec3f(vertices.normal[0][i], vertices.normal[1][i], vertices.normal[2][i]);
  }
  node.area = static_cast<float>(sums.area);
  Float4 center[3], axis[3];
  set_axis(sums.normal, node);
  for (int d = 0; d < 3; ++d) {
    const ValueBounds bounds = bounds_of(vertices.size, [&](std::size_t i) { return Float4::load(vertices.position[d] + i); });
    sums.min[d] = bounds.min;
    sums.max[d] = bounds.max;
    node.center[d] = 0.5f * (bounds.min + bounds.max);
    center[d] = Float4::all(node.center[d]);
    axis[d] = Float4::all(node.axis[d]);
  }
  const auto square = [&](std::size_t i) {
    const Float4 x = Float4::load(vertices.position[0] + i) - center[0];
    const Float4 y = Float4::load(vertices.position[1] + i) - center[1];
    const Float4 z = Float4::load(vertices.position[2] + i) - center[2];
    return x * x + y * y + z * z;
  };
  const auto product = [&](std::size_t i) {
    return Float4::load(vertices.normal[0] + i) * axis[0] + Float4::load(vertices.normal[1] + i) * axis[1] +
           Float4::load(vertices.normal[2] + i) * axis[2];
  };
  node.radius = std::sqrt(bounds_of(vertices.size, square).max) * kRoundedUp;
  // Packed normals may be a little longer than 1.
  set_cosine(bounds_of(vertices.size, product).min / ((1 + kPackedLength) * node.cone_axis().norm()), node);
  measure_curvature(vertices, node);
}

/// An inner node from its children, which are done.
void combine(std::span<CurveNode> nodes, std::span<Sums> sums, std::size_t i) {
  CurveNode& node = nodes[i];
  const auto for_children = [&](auto&& visit) {
    for (std::size_t child = i + 1; child < node.skip; child = nodes[child].skip) visit(nodes[child], sums[child]);
  };
  Sums& sum = sums[i];
  sum = sums[i + 1];
  sum.normal.setZero();
  sum.area = 0;
  std::fill(std::begin(node.curvature), std::end(node.curvature), ValueBounds{});
  for_children([&](const CurveNode& child, const Sums& part) {
    sum.min = sum.min.cwiseMin(part.min);
    sum.max = sum.max.cwiseMax(part.max);
    sum.normal += part.normal;
    sum.area += part.area;
    for (int kind = 0; kind < kCurvatureKinds; ++kind) node.curvature[kind].extend(child.curvature[kind]);
  });
  node.area = static_cast<float>(sum.area);
  set_axis(sum.normal, node);
  const Vec3f center = 0.5f * (sum.min + sum.max), axis = node.cone_axis();
  float radius = 0;
  double angle = 0;
  for_children([&](const CurveNode& child, const Sums&) {
    radius = std::max(radius, (child.sphere_center() - center).norm() + child.radius);
    const Vec3f other = child.cone_axis();
    const double cosine = other.dot(axis) / std::sqrt(other.squaredNorm() * axis.squaredNorm());
    const double between = std::acos(std::clamp(cosine - 1e-7, -1.0, 1.0));
    angle = std::max(angle, child.has_cone() ? between + std::acos(static_cast<double>(child.cosine)) : std::numbers::pi);
  });
  for (int d = 0; d < 3; ++d) node.center[d] = center[d];
  node.radius = std::min(radius, 0.5f * (sum.max - sum.min).norm()) * kRoundedUp;
  set_cosine(static_cast<float>(std::cos(std::min(angle, std::numbers::pi))), node);
}

Column<ValueBounds> scalar_bounds(const SurfaceCurve& curve, const CurveHierarchy& hierarchy) {
  const std::size_t kinds = curve.scalars.size();
  Column<ValueBounds> bounds;
  bounds.assign(hierarchy.nodes.size() * kinds, {});
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, hierarchy.nodes.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (!hierarchy.is_leaf(i)) continue;
      for (std::size_t s = 0; s < kinds; ++s) {
        const std::span<const float> values(curve.scalars[s].values);
        for (const float v : values.subspan(hierarchy.nodes[i].first, hierarchy.nodes[i].size())) bounds[i * kinds + s].extend(v);
      }
    }
  });
  for (std::size_t i = hierarchy.nodes.size(); i-- > 0;) {
    for (std::size_t child = i + 1; child < hierarchy.nodes[i].skip; child = hierarchy.nodes[child].skip) {
      for (std::size_t s = 0; s < kinds; ++s) bounds[i * kinds + s].extend(bounds[child * kinds + s]);
    }
  }
  return bounds;
}

}  // namespace

CurveHierarchy build_hierarchy(const SurfaceCurve& curve) {
  CurveHierarchy hierarchy;
  if (curve.size() == 0) return hierarchy;
  std::vector<CurveNode> ranges;
  ranges.reserve(curve.size() / 16 + 2 * curve.disc_begin.size());
  ranges.emplace_back().first = 0;
  ranges[0].last = static_cast<std::uint32_t>(curve.size());
  for (std::size_t d = 1; d < curve.disc_begin.size(); ++d) {
    const std::uint32_t begin = curve.disc_begin[d - 1], end = curve.disc_begin[d];
    if (begin < end) add_ranges(curve.key, begin, end, ranges);
  }
  ranges[0].skip = static_cast<std::uint32_t>(ranges.size());
  hierarchy.nodes = Column<CurveNode>(ranges);
  const std::span<CurveNode> nodes(hierarchy.nodes);
  std::vector<Sums> sums(nodes.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, nodes.size(), 256), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (hierarchy.is_leaf(i)) measure_leaf(curve, nodes[i], sums[i]);
    }
  });
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (!hierarchy.is_leaf(i)) combine(nodes, sums, i);
  }
  hierarchy.scalars = scalar_bounds(curve, hierarchy);
  return hierarchy;
}

}  // namespace curvecast
