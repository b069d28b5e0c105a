// What a mesh has for its vertices, at any place on its surface. A place is a face with the weights of its second and third
// corner.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/curve/surface_map.h"

namespace curvecast {

/// Returns the surface's normal: the weighted mean of those at the face's corners, on its side of creases. Unit length; zero
/// where they cancel out.
Vec3f normal_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights);

/// Returns both principal curvatures, the smaller one first: the weighted means of those at the face's corners, 1/unit.
std::array<float, 2> curvatures_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights);

/// Returns the direction of the least principal curvature: a unit vector in the tangent plane of `normal`, across the weighted
/// mean of the axes along which the surface bends most at the face's corners. Of its two senses the same place gets the same one;
/// any tangent where the axes cancel out. Precondition: `normal` is of length 1, at least as a packed one is.
Vec3f direction_min_at(const SurfaceData& data, std::uint32_t face, const std::array<float, 2>& weights, const Vec3f& normal);

/// Returns the weighted mean of data.scalars[s] at the face's corners; not finite where one of them is not.
float scalar_at(const SurfaceData& data, std::size_t s, std::uint32_t face, const std::array<float, 2>& weights);

}  // namespace curvecast
