#include "core/curve/surface_map.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/for_all.h"
#include "core/base/simd.h"
#include "core/curve/deepest_triangle.h"
#include "core/curve/tangent_frame.h"
#include "core/curve/vertex_record.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // leaves

Vec3d clamped(const Vec3d& weights) {
  if (weights.minCoeff() >= 0) return weights;
  const Vec3d positive = weights.cwiseMax(0.0);
  return positive / positive.sum();
}

/// Weights of a point on face f.
Vec3d weights_on_face(const MeshView& mesh, std::uint32_t f, const Vec3d& p) {
  const Triangle& t = mesh.triangles[f];
  const Vec3d &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  const Vec3d normal = (b - a).cross(c - a);
  const double square = normal.squaredNorm();
  const double u = (b - p).cross(c - p).dot(normal) / square;
  const double v = (c - p).cross(a - p).dot(normal) / square;
  return clamped({u, v, 1 - u - v});
}

// What a triangle of a disc is:
constexpr std::uint8_t kIsWhole = 1;    // its whole face, corner by corner, and not a part of it
constexpr std::uint8_t kHasCrease = 2;  // its face is a CreaseFace

constexpr std::size_t kRoom = LeafBatch::kSize + LeafBatch::kSlack;

/// A batch on the surface, number by number.
struct MappedBatch {
  alignas(64) double place[3][kRoom];
  alignas(64) float weights[3][kRoom];  // in the face
  alignas(64) float mixed[VertexRecord::kSize][kRoom];
  std::uint32_t face[LeafBatch::kSize];
};

/// A triangle of a disc: all that is mixed there, or the first `numbers` of each record.
template <int numbers>
struct Corners {
  std::uint32_t face;
  const Vec3d* place[3];
  VertexRecord record[3];  // of the face's corners

  Corners(const SurfaceData& data, const ChartView& disc, std::uint32_t t, bool has_crease) : face(disc.face_of[t]) {
    const CreaseFace* const crease = has_crease ? data.crease_of(face) : nullptr;
    for (std::size_t i = 0; i < 3; ++i) {
      place[i] = &disc.positions[disc.triangles[t][i]];
      record[i].set<numbers>(data.geometry[data.mesh.triangles[face][i]], data.corner_normal(face, i, crease));
    }
  }
};

// Leaves of one triangle are done several at a time. What is written beyond the last of them, the next triangle's overwrite.

/// Places and weights of the leaves [begin, end) of a triangle.
[[gnu::always_inline]] inline void place_leaves(const UvTriangle& t, const Vec3d* const (&place)[3], const LeafBatch& batch,
                                                std::size_t begin, std::size_t end, MappedBatch& out) {
  const Vec3d &a = *place[0], &b = *place[1], &c = *place[2];
  const Double4 zero{};
  for (std::size_t i = begin; i < end; i += 4) {
    Double4 u, v;
    load_lanes(u, batch.u + i);
    load_lanes(v, batch.v + i);
    Double4 w[3];
    t.weights(u, v, w);
    // A centre on an edge may lie beyond it by rounding.
    for (Double4& weight : w) weight = weight > zero ? weight : zero;
    const Double4 scale = 1 / (w[0] + w[1] + w[2]);
    for (int k = 0; k < 3; ++k) {
      w[k] *= scale;
      store_lanes(__builtin_convertvector(w[k], Float4), out.weights[k] + i);
    }
    for (int k = 0; k < 3; ++k) store_lanes(w[0] * a[k] + w[1] * b[k] + w[2] * c[k], out.place[k] + i);
  }
}

/// What the weights make of the first numbers of the corners' records.
template <int numbers>
[[gnu::always_inline]] inline void mix_records(const VertexRecord (&record)[3], std::size_t begin, std::size_t end,
                                               MappedBatch& out) {
  const float *a = record[0].values, *b = record[1].values, *c = record[2].values;
  for (std::size_t i = begin; i < end; i += 4) {
    Float4 w0, w1, w2;
    load_lanes(w0, out.weights[0] + i);
    load_lanes(w1, out.weights[1] + i);
    load_lanes(w2, out.weights[2] + i);
    for (int k = 0; k < numbers; ++k) store_lanes(w0 * a[k] + w1 * b[k] + w2 * c[k], out.mixed[k] + i);
  }
}

/// Weights of the leaves [begin, end) in a face of which their triangle is a part.
void weigh_in_face(const MeshView& mesh, std::uint32_t face, std::size_t begin, std::size_t end, MappedBatch& out) {
  for (std::size_t i = begin; i < end; ++i) {
    const Vec3d w = weights_on_face(mesh, face, {out.place[0][i], out.place[1][i], out.place[2][i]});
    for (int k = 0; k < 3; ++k) out.weights[k][i] = static_cast<float>(w[k]);
  }
}

template <int numbers>
[[gnu::always_inline]] inline void map_records(const SurfaceData& data, const ChartView& disc, const ChartTriangles& triangles,
                                               const std::uint8_t* kinds, const LeafBatch& batch, MappedBatch& out) {
  for (std::size_t begin = 0, end; begin < batch.count; begin = end) {
    const std::uint32_t t = batch.under[begin];
    const Corners<numbers> corners(data, disc, t, (kinds[t] & kHasCrease) != 0);
    for (end = begin; end < batch.count && batch.under[end] == t; ++end) out.face[end] = corners.face;
    place_leaves(triangles[t], corners.place, batch, begin, end, out);
    if ((kinds[t] & kIsWhole) == 0) weigh_in_face(data.mesh, corners.face, begin, end, out);
    mix_records<numbers>(corners.record, begin, end, out);
  }
}

CURVECAST_WIDE void map_batch(const SurfaceData& data, const ChartView& disc, const ChartTriangles& triangles,
                              const std::uint8_t* kinds, const LeafBatch& batch, MappedBatch& out) {
  map_records<VertexRecord::kSize>(data, disc, triangles, kinds, batch, out);
}

/// Normals only.
CURVECAST_WIDE void map_normals(const SurfaceData& data, const ChartView& disc, const ChartTriangles& triangles,
                                const std::uint8_t* kinds, const LeafBatch& batch, MappedBatch& out) {
  map_records<3>(data, disc, triangles, kinds, batch, out);
}

/// Where a batch goes.
struct PackedTarget {
  float* place[3];
  Snorm16 *nx, *ny, *nz;
  Bfloat16 *curvature_min, *curvature_max;
  std::uint16_t* direction;
  std::uint32_t* face;
  Unorm16 *weight_1, *weight_2;
};

/// A batch's unit normals.
struct UnitNormals {
  alignas(64) float x[LeafBatch::kSize], y[LeafBatch::kSize], z[LeafBatch::kSize];
};

[[gnu::always_inline]] inline void find_normals(const MappedBatch& batch, std::size_t count, UnitNormals& out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float nx = batch.mixed[0][i], ny = batch.mixed[1][i], nz = batch.mixed[2][i];
    const float square = nx * nx + ny * ny + nz * nz;
    const bool any = square > 0;  // where normals cancel out, any one will do
    const float scale = 1 / std::sqrt(any ? square : 1.0f);
    out.x[i] = nx * scale;
    out.y[i] = ny * scale;
    out.z[i] = any ? nz * scale : 1.0f;
  }
}

CURVECAST_WIDE void pack(const MappedBatch& batch, std::size_t count, const Vec3d& origin, const PackedTarget& out) {
  for (int k = 0; k < 3; ++k) {
    const double from = origin[k];
    for (std::size_t i = 0; i < count; ++i) out.place[k][i] = static_cast<float>(batch.place[k][i] - from);
  }
  UnitNormals normals;
  find_normals(batch, count, normals);
  float *const x = normals.x, *const y = normals.y, *const z = normals.z;
  for (std::size_t i = 0; i < count; ++i) out.nx[i] = x[i];
  for (std::size_t i = 0; i < count; ++i) out.ny[i] = y[i];
  for (std::size_t i = 0; i < count; ++i) out.nz[i] = z[i];
  // The direction's frame is that of the normal as it is read again.
  for (std::size_t i = 0; i < count; ++i) x[i] = out.nx[i];
  for (std::size_t i = 0; i < count; ++i) y[i] = out.ny[i];
  for (std::size_t i = 0; i < count; ++i) z[i] = out.nz[i];
  const auto* axis = batch.mixed + VertexRecord::kAxis;
  for (std::size_t i = 0; i < count; ++i) {
    out.direction[i] = pack_axes({axis[0][i], axis[1][i], axis[2][i], axis[3][i], axis[4][i], axis[5][i]}, x[i], y[i], z[i]);
  }
  for (std::size_t i = 0; i < count; ++i) out.curvature_min[i] = batch.mixed[VertexRecord::kCurvatureMin][i];
  for (std::size_t i = 0; i < count; ++i) out.curvature_max[i] = batch.mixed[VertexRecord::kCurvatureMax][i];
  for (std::size_t i = 0; i < count; ++i) out.weight_1[i] = batch.weights[1][i];
  for (std::size_t i = 0; i < count; ++i) out.weight_2[i] = batch.weights[2][i];
  std::copy_n(batch.face, count, out.face);
}

}  // namespace

void locate_centres(std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves, std::span<std::uint32_t> under,
                    const ExecutionContext& context) {
  for_blocks(context, leaves.size(), kGrain, [&](std::size_t first, std::size_t last) {
    for (std::size_t l = first; l < last; ++l) {
      const std::span candidates = leaves.triangles_of(l);
      under[l] = candidates[0];
      if (candidates.size() == 1) continue;
      const double half = 0.5 * side_of_level(leaves.level[l]);
      const double u = leaves.x[l] * kCellSide + half, v = leaves.y[l] * kCellSide + half;
      under[l] = deepest_triangle(triangles, candidates, u, v);
    }
  });
}

SurfaceData::SurfaceData(const TriangleMesh& of_mesh, std::span<const VertexGeometry> of_geometry, const CreaseView& of_creases,
                         const MeshAttributes& of_attributes, const SurfaceColour* of_colour)
    : mesh(of_mesh), geometry(of_geometry), colour(of_colour), creases(of_creases) {
  for (const ScalarAttribute& scalar : of_attributes.scalars) scalars.emplace_back(scalar.values);
}

const CreaseFace* SurfaceData::crease_of(std::uint32_t face) const {
  const auto is_before = [](const CreaseFace& crease, std::uint32_t f) { return crease.face < f; };
  const auto found = std::lower_bound(creases.faces.begin(), creases.faces.end(), face, is_before);
  return found != creases.faces.end() && found->face == face ? &*found : nullptr;
}

Column<std::uint8_t> triangle_kinds(const SurfaceData& data, const ChartView& chart) {
  Column<std::uint8_t> kinds;
  kinds.resize(chart.triangles.size());
  for_blocks({}, kinds.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const std::uint32_t face = chart.face_of[t];
      const Triangle& v = chart.triangles[t];
      const Triangle& corners = data.mesh.triangles[face];
      const auto is_at = [&](int i) { return chart.positions[v[i]] == data.mesh.positions[corners[i]]; };
      const bool is_whole = is_at(0) && is_at(1) && is_at(2);
      kinds[t] = static_cast<std::uint8_t>((is_whole ? kIsWhole : 0) | (data.crease_of(face) != nullptr ? kHasCrease : 0));
    }
  });
  return kinds;
}

void SurfaceMapper::map(const LeafBatch& batch, std::size_t at, SurfaceCurve& curve) const {
  MappedBatch mapped;
  map_batch(data_, disc_, triangles_, kinds_.data(), batch, mapped);
  pack(mapped, batch.count, curve.origin,
       {{&curve.x[at], &curve.y[at], &curve.z[at]},
        &curve.nx[at],
        &curve.ny[at],
        &curve.nz[at],
        &curve.curvature_min[at],
        &curve.curvature_max[at],
        &curve.direction[at],
        &curve.triangle[at],
        &curve.weight_1[at],
        &curve.weight_2[at]});
  if (data_.colour == nullptr && curve.scalars.empty()) return;
  for (std::size_t i = 0; i < batch.count; ++i) {
    const Vec3f w(mapped.weights[0][i], mapped.weights[1][i], mapped.weights[2][i]);
    if (data_.colour != nullptr) {
      const double side = side_of_level(curve.level[at + i]);
      const double area = side * side * triangles_.area_ratio(batch.under[i]);
      curve.colour[at + i] = data_.colour->at(mapped.face[i], w, area);
    }
    const Triangle& v = data_.mesh.triangles[mapped.face[i]];
    for (std::size_t s = 0; s < curve.scalars.size(); ++s) {
      const std::span<const float> values = data_.scalars[s];
      curve.scalars[s].values[at + i] = w[0] * values[v[0]] + w[1] * values[v[1]] + w[2] * values[v[2]];
    }
  }
}

void SurfaceMapper::place(const LeafBatch& batch, const Vec3d& origin, SurfacePlace* places) const {
  MappedBatch mapped;
  map_normals(data_, disc_, triangles_, kinds_.data(), batch, mapped);
  UnitNormals normals;
  find_normals(mapped, batch.count, normals);
  for (std::size_t i = 0; i < batch.count; ++i) {
    SurfacePlace& out = places[i];
    for (int k = 0; k < 3; ++k) out.position[k] = static_cast<float>(mapped.place[k][i] - origin[k]);
    out.normal[0] = normals.x[i], out.normal[1] = normals.y[i], out.normal[2] = normals.z[i];
    out.face = mapped.face[i];
    out.weight_1 = mapped.weights[1][i], out.weight_2 = mapped.weights[2][i];
  }
}

void map_to_surface(const SurfaceMapper& mapper, const QuadtreeLeaves& leaves, std::span<const std::uint32_t> under,
                    std::size_t offset, SurfaceCurve& curve, const ExecutionContext& context) {
  for_blocks(context, leaves.size(), kGrain, [&](std::size_t first, std::size_t last) {
    LeafBatch batch;
    for (std::size_t begin = first; begin < last; begin += batch.count) {
      batch.count = std::min(LeafBatch::kSize, last - begin);
      for (std::size_t i = 0; i < batch.count; ++i) {
        const std::size_t l = begin + i;
        const double half = 0.5 * side_of_level(leaves.level[l]);
        batch.u[i] = leaves.x[l] * kCellSide + half;
        batch.v[i] = leaves.y[l] * kCellSide + half;
      }
      std::copy_n(under.data() + begin, batch.count, batch.under);
      std::copy_n(leaves.key.data() + begin, batch.count, curve.key.data() + offset + begin);
      std::copy_n(leaves.level.data() + begin, batch.count, curve.level.data() + offset + begin);
      mapper.map(batch, offset + begin, curve);
    }
  });
}

}  // namespace curvecast
