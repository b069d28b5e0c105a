// Which edges a file means to be sharp: its own normals, or its smoothing groups, say so edge by edge.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// What a file says of how its faces are shaded, C and P as in MeshAttributes. Either may be empty.
struct OwnShading {
  std::span<const Vec3f> normals;                   // of any length; where all zeros, none
  std::span<const std::uint32_t> normal_of_corner;  // C, into `normals`; beyond it: none
  std::span<const std::uint32_t> group_of_polygon;  // P, smoothing groups: edges are smooth within one; 0 is none
  bool is_quantised = false;                        // normals and positions are rounded, to a degree or so
};

/// The angle in degrees, 0 .. 180, that best tells the edges over which the shading goes on from those where it is split, as
/// crease_normals() takes it; nothing where the file does not tell.
///
/// An edge is split where the normals beside it differ by more than half as much as the faces turn there. Many angles are often
/// as good: kCreaseDegrees where it is among them. Of a mesh without any smooth edge it is 0 where its faces are so coarse that
/// they are meant to be seen, and nothing otherwise: some programs write the normals of faces whatever the mesh. Of large meshes
/// about 16,000 corners are looked at. Of what is quantised, a few edges may be mistaken: those of one kind do not count among
/// fifty times as many of the other.
std::optional<double> own_crease_angle(const PolygonSoup& soup, const OwnShading& shading);

}  // namespace curvecast
