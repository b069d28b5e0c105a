#include "core/curve/surface_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/curve/deepest_triangle.h"
#include "core/curve/tangent_frame.h"
#include "core/lanes.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // leaves

Vec3d clamped(const Vec3d& weights) {
  if (weights.minCoeff() >= 0) return weights;
  const Vec3d positive = weights.cwiseMax(0.0);
  return positive / positive.sum();
}

/// Weights of a point on face f.
Vec3d weights_on_face(const TriangleMesh& mesh, std::uint32_t f, const Vec3d& p) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  const double u = (b - p).cross(c - p).dot(normal) / square;
  const double v = (c - p).cross(a - p).dot(normal) / square;
  return clamped({u, v, 1 - u - v});
}

/// For each triangle of a disc whether it is its whole face, corner by corner, and not a part of it.
std::vector<std::uint8_t> whole_faces(const TriangleMesh& mesh, const DiscMesh& disc) {
  std::vector<std::uint8_t> is_whole(disc.triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, is_whole.size(), kGrain), [&](const auto& range) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      const Triangle& v = disc.triangles[t];
      const Triangle& corners = mesh.triangles[disc.face_of[t]];
      is_whole[t] = disc.positions[v[0]] == mesh.positions[corners[0]] && disc.positions[v[1]] == mesh.positions[corners[1]] &&
                    disc.positions[v[2]] == mesh.positions[corners[2]];
    }
  });
  return is_whole;
}

constexpr std::size_t kBatch = 64;  // leaves whose mixtures are packed in one go

/// Mixed records of a batch, lane by lane: [which number][leaf].
struct Mixtures {
  alignas(64) float normal[3][kBatch];
  alignas(64) float curvature_min[kBatch], curvature_max[kBatch];
  alignas(64) float axis[6][kBatch];

  void set(std::size_t i, const VertexRecord& a, const VertexRecord& b, const VertexRecord& c, const Vec3f& w) {
    const float w0 = w[0], w1 = w[1], w2 = w[2];
    for (int k = 0; k < 3; ++k) normal[k][i] = w0 * a.normal[k] + w1 * b.normal[k] + w2 * c.normal[k];
    curvature_min[i] = w0 * a.curvature_min + w1 * b.curvature_min + w2 * c.curvature_min;
    curvature_max[i] = w0 * a.curvature_max + w1 * b.curvature_max + w2 * c.curvature_max;
    for (int k = 0; k < 6; ++k) axis[k][i] = w0 * a.axis[k] + w1 * b.axis[k] + w2 * c.axis[k];
    // Normals that cancel out: any one will do.
    const float square = normal[0][i] * normal[0][i] + normal[1][i] * normal[1][i] + normal[2][i] * normal[2][i];
    if (!(square > 0)) {
      for (int k = 0; k < 3; ++k) normal[k][i] = a.normal[k];
    }
  }
};

/// The triangle of a disc that the last leaf lay in, and often the next one does: all that is mixed there.
struct Corners {
  std::uint32_t triangle = kNone, face = kNone;
  bool is_whole_face = false;
  double x[3] = {}, y[3] = {}, z[3] = {};
  const VertexRecord* record[3] = {};  // of the face's corners

  void enter(const SurfaceData& data, const DiscMesh& disc, const std::vector<std::uint8_t>& is_whole, std::uint32_t t) {
    triangle = t;
    face = disc.face_of[t];
    is_whole_face = is_whole[t] != 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3d& corner = disc.positions[disc.triangles[t][i]];
      x[i] = corner.x();
      y[i] = corner.y();
      z[i] = corner.z();
      record[i] = &data.records[data.mesh.triangles[face][i]];
    }
  }
  Vec3d place(const Vec3d& w) const {
    return {w[0] * x[0] + w[1] * x[1] + w[2] * x[2], w[0] * y[0] + w[1] * y[1] + w[2] * y[2],
            w[0] * z[0] + w[1] * z[1] + w[2] * z[2]};
  }
};

/// Where a batch goes.
struct PackedTarget {
  Snorm16 *nx, *ny, *nz;
  Bfloat16 *curvature_min, *curvature_max;
  std::uint16_t* direction;
};

CURVECAST_WIDE void pack(const Mixtures& mixed, std::size_t count, const PackedTarget& out) {
  alignas(64) float x[kBatch], y[kBatch], z[kBatch];
  for (std::size_t i = 0; i < count; ++i) {
    const float nx = mixed.normal[0][i], ny = mixed.normal[1][i], nz = mixed.normal[2][i];
    const float scale = 1 / std::sqrt(nx * nx + ny * ny + nz * nz);
    x[i] = nx * scale;
    y[i] = ny * scale;
    z[i] = nz * scale;
  }
  for (std::size_t i = 0; i < count; ++i) out.nx[i] = x[i];
  for (std::size_t i = 0; i < count; ++i) out.ny[i] = y[i];
  for (std::size_t i = 0; i < count; ++i) out.nz[i] = z[i];
  // The direction's frame is that of the normal as it is read again.
  for (std::size_t i = 0; i < count; ++i) x[i] = out.nx[i];
  for (std::size_t i = 0; i < count; ++i) y[i] = out.ny[i];
  for (std::size_t i = 0; i < count; ++i) z[i] = out.nz[i];
  for (std::size_t i = 0; i < count; ++i) {
    out.direction[i] =
        pack_axes({mixed.axis[0][i], mixed.axis[1][i], mixed.axis[2][i], mixed.axis[3][i], mixed.axis[4][i], mixed.axis[5][i]},
                  x[i], y[i], z[i]);
  }
  for (std::size_t i = 0; i < count; ++i) out.curvature_min[i] = mixed.curvature_min[i];
  for (std::size_t i = 0; i < count; ++i) out.curvature_max[i] = mixed.curvature_max[i];
}

}  // namespace

void locate_centres(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<std::uint32_t> under) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), [&](const auto& range) {
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const std::span candidates = leaves.triangles_of(l);
      under[l] = candidates[0];
      if (candidates.size() == 1) continue;
      const double half = 0.5 * side_of_level(leaves.level[l]);
      const double u = leaves.x[l] * kCellSide + half, v = leaves.y[l] * kCellSide + half;
      under[l] = deepest_triangle(triangles, candidates, u, v);
    }
  });
}

void map_to_surface(const SurfaceData& data, const Chart& chart, std::span<const ParameterTriangle> triangles,
                    const QuadtreeLeaves& leaves, std::span<const std::uint32_t> under, std::size_t offset, SurfaceCurve& curve) {
  const TriangleMesh& mesh = data.mesh;
  const DiscMesh& disc = chart.disc;
  const std::vector<std::uint8_t> is_whole = whole_faces(mesh, disc);
  const auto map_leaf = [&](std::size_t l, std::size_t slot, Corners& corners, Mixtures& mixed) {
    if (under[l] != corners.triangle) corners.enter(data, disc, is_whole, under[l]);
    const double side = side_of_level(leaves.level[l]);
    const ParameterTriangle& triangle = triangles[under[l]];
    const Vec3d weights = clamped(triangle.weights(leaves.x[l] * kCellSide + 0.5 * side, leaves.y[l] * kCellSide + 0.5 * side));
    const Vec3d place = corners.place(weights);
    const Vec3f w = (corners.is_whole_face ? weights : weights_on_face(mesh, corners.face, place)).cast<float>();
    mixed.set(slot, *corners.record[0], *corners.record[1], *corners.record[2], w);
    const std::size_t i = offset + l;
    curve.x[i] = static_cast<float>(place.x() - curve.origin.x());
    curve.y[i] = static_cast<float>(place.y() - curve.origin.y());
    curve.z[i] = static_cast<float>(place.z() - curve.origin.z());
    curve.triangle[i] = corners.face;
    curve.weight_1[i] = w[1];
    curve.weight_2[i] = w[2];
    curve.key[i] = leaves.key[l];
    curve.level[i] = leaves.level[l];
    if (data.colour != nullptr) curve.colour[i] = data.colour->at(corners.face, w, side * side * triangle.area_ratio);
    const Triangle& v = mesh.triangles[corners.face];
    for (std::size_t s = 0; s < curve.scalars.size(); ++s) {
      const std::vector<float>& values = data.attributes.scalars[s].values;
      curve.scalars[s].values[i] = w[0] * values[v[0]] + w[1] * values[v[1]] + w[2] * values[v[2]];
    }
  };
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), [&](const auto& range) {
    Mixtures mixed;
    Corners corners;
    for (std::size_t begin = range.begin(); begin < range.end(); begin += kBatch) {
      const std::size_t count = std::min(kBatch, range.end() - begin), at = offset + begin;
      for (std::size_t slot = 0; slot < count; ++slot) map_leaf(begin + slot, slot, corners, mixed);
      pack(mixed, count,
           {&curve.nx[at], &curve.ny[at], &curve.nz[at], &curve.curvature_min[at], &curve.curvature_max[at],
            &curve.direction[at]});
    }
  });
}

}  // namespace curvecast
