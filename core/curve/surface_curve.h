// The Hilbert curve on the surface: what preprocessing makes and every view samples (paper, sections 3.2 to 3.4).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/colour.h"
#include "core/base/column.h"
#include "core/base/quantised.h"
#include "core/base/vec.h"
#include "core/curve/curvature_measure.h"
#include "core/curve/curve_blocks.h"
#include "core/mesh/face_sources.h"

namespace curvecast {

/// A mesh's named number for each vertex, on the curve.
struct ScalarColumn {
  std::string name;
  Column<float> values;  // L; NaN and infinities as in the file
};

/// Structure of arrays in curve order, L entries each; the curves of all discs one after the other. Immutable once built, so
/// any number of threads may read it. Positions are exact to a float; what only steers or shades is packed.
struct SurfaceCurve {
  Vec3d origin = Vec3d::Zero();  // x, y, z are relative to it; zero unless the mesh lies so far out that floats would not do
  Column<float> x, y, z;         // position on the surface, in the file's units
  Column<Snorm16> nx, ny, nz;    // unit normal, smooth
  Column<Bfloat16> curvature_min, curvature_max;  // principal curvatures, 1/unit
  Column<std::uint16_t> direction;                // of curvature_max: unpack_direction() in tangent_frame.h reads it
  Column<float> area;                             // area element A_l, squared units; sums to total_area
  Column<Direction8> beside;                      // near a crease: the normal on its other side; see crease_band.h
  Column<Rgba8> colour;                           // of the surface; empty when the mesh has none
  Column<std::uint32_t> triangle;                 // face of the repaired mesh on which the vertex lies
  Column<Unorm16> weight_1, weight_2;             // barycentric: of that face's second and third corner
  Column<std::uint64_t> key;                      // Hilbert index of the leaf's first cell at kMaxLevel, within its disc
  Column<std::uint8_t> level;                     // quadtree level of the leaf
  std::vector<ScalarColumn> scalars;              // of the mesh's scalar attributes
  FaceSources face_sources;                       // the file's polygons that the faces of the repaired mesh are
  std::vector<std::uint32_t> disc_begin;          // D + 1 offsets: disc d owns [disc_begin[d], disc_begin[d + 1])

  CurveBlocks blocks;                                        // of all of it
  std::array<float, kCurvatureKinds> reference_curvature{};  // see reference_curvatures
  double total_area = 0;                                     // of the repaired mesh, squared units
  Box3d box;                                                 // of the repaired mesh, absolute coordinates
  std::uint64_t max_points = 0;                              // N for which the curve is fine enough, at its base density
  std::uint64_t revision = 1;                                // grows with every refinement

  std::size_t size() const { return x.size(); }
  Vec3f position(std::size_t l) const { return {x[l], y[l], z[l]}; }  // relative to the origin
  Vec3f normal(std::size_t l) const { return {nx[l], ny[l], nz[l]}; }
  /// By how much the vertex's normals, its own and the one beside, differ from another at most, as points on the unit sphere.
  float normals_from(std::size_t l, const Vec3f& other) const {
    const float own = (normal(l) - other).norm();
    return beside.empty() || beside[l].is_none() ? own : std::max(own, (beside[l].unpacked<Vec3f>() - other).norm());
  }
  /// Gives every per-vertex column n entries, uninitialised; `colour` and `beside` too if asked for. `scalars` as they are.
  void resize(std::size_t n, bool has_colour = false, bool has_beside = false);
  /// Makes the blocks of all the rest. Runs on all threads of the arena.
  void finish();
  /// Returns the bytes that the columns take.
  std::size_t byte_size() const;
};

}  // namespace curvecast
