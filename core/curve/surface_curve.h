// The Hilbert curve on the surface: what preprocessing makes and every view samples (paper, sections 3.2 to 3.4).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/colour.h"
#include "core/curve/curvature_measure.h"
#include "core/vec.h"

namespace curvecast {

/// Structure of arrays in curve order, L entries each; the curves of all discs one after the other. Immutable once built, so
/// any number of threads may read it.
struct SurfaceCurve {
  Vec3d origin = Vec3d::Zero();   // x, y, z are relative to it; zero unless the mesh lies so far out that floats would not do
  std::vector<float> x, y, z;     // position on the surface, in the file's units
  std::vector<float> nx, ny, nz;  // unit normal
  std::vector<float> curvature_min, curvature_max;  // principal curvatures, 1/unit
  std::vector<float> area;                          // area element A_l, squared units; sums to total_area
  std::vector<Rgba8> colour;                        // of the surface; empty when the mesh has none
  std::vector<std::uint32_t> triangle;              // face of the repaired mesh on which the vertex lies
  std::vector<std::uint64_t> key;                   // Hilbert index of the leaf's first cell at kMaxLevel, within its disc
  std::vector<std::uint8_t> level;                  // quadtree level of the leaf
  std::vector<std::uint32_t> disc_begin;            // D + 1 offsets: disc d owns [disc_begin[d], disc_begin[d + 1])

  std::array<float, kCurvatureKinds> reference_curvature{};  // see reference_curvatures
  double total_area = 0;                                     // of the repaired mesh, squared units
  Box3d box;                                                 // of the repaired mesh, absolute coordinates
  std::uint64_t max_points = 0;                              // N for which the curve is fine enough
  std::uint64_t revision = 1;

  std::size_t size() const { return x.size(); }
  /// Gives every per-vertex array n entries; `colour` too if asked for.
  void resize(std::size_t n, bool has_colour = false);
  /// Bytes held by the arrays.
  std::size_t byte_size() const;
};

}  // namespace curvecast
