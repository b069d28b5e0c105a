// SPDX-License-Identifier: Apache-2.0
// Points as flat Gaussians, which renderers of 3D Gaussian splatting draw. Source of what is drawn: Kerbl, Kopanas, Leimkuehler,
// Drettakis, "3D Gaussian Splatting for Real-Time Radiance Field Rendering" (2023), and see below for the widths.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <vector>

#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// N Gaussians, in order of rank. Each is as wide along both axes of its disc, and thin across it.
struct Splats {
  std::array<double, 3> origin{};
  std::vector<std::array<float, 3>> positions, normals;  // positions relative to the origin; unit normals
  std::vector<std::array<float, 4>> rotations;           // unit quaternions x y z w, w >= 0: from the z axis to the normal or its opposite
  std::vector<float> widths;                             // standard deviations, units
  std::vector<std::array<std::uint8_t, 3>> colours;      // sRGB, as they are to be shown

  std::size_t size() const { return positions.size(); }
};

/// A Gaussian's standard deviation over the radius of the disc. Discs of points with the density of one in an area A have the radius
/// 1.25 sqrt(A) and leave next to no holes, so the worst place that is to be closed is one around which no point lies within a
/// radius R, and points lie as densely as everywhere beyond it. What shows through Gaussians of the width w and full opacity there
/// is exp(-(2 pi w^2 / A) Li2(exp(-R^2 / (2 w^2)))), Li2 the dilogarithm: the integral of -ln(1 - exp(-r^2 / (2 w^2))) over the
/// plane beyond R. With w = 0.75 radii that is 1.4 % for R = 0.9 sqrt(A), which few places exceed, and 0.01 % in the mean (R = 0).
/// Wider Gaussians close more, blur more and reach farther past outlines.
constexpr float kSplatWidth = 0.75F;
/// Its standard deviation across the disc, over that along it.
constexpr float kSplatThickness = 0.02F;
/// What formats with 8 bits have next to 1, the logarithm of whose odds is infinite.
constexpr float kSplatOpacity = 254.0F / 255.0F;

/// Returns the Gaussians of points with normals and radii. Radii below a millionth of the largest count as that. Points without colours
/// are light grey, shaded by their normals: renderers of splats have no lights. InvalidArgument: as check_columns(); normals or radii are
/// missing, or no radius is above 0.
absl::StatusOr<Splats> make_splats(const PointColumns& columns);

/// Returns the coefficient of a colour channel on the constant spherical harmonic, as splats have their colours.
float harmonic_of(std::uint8_t channel);

}  // namespace curvecast::formats
