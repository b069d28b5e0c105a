// What a mesh file holds, before any repair: positions, polygons over them, and what they carry.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/mesh/mesh_attributes.h"

namespace curvecast {

struct PolygonSoup {
  std::vector<Vec3d> positions;              // V, in the file's units, all finite
  std::vector<std::uint32_t> polygon_begin;  // P + 1 offsets into `indices`, ascending, first 0
  std::vector<std::uint32_t> indices;        // vertex of each polygon corner, all < V
  bool shares_vertices = true;               // false: every polygon has vertices of its own (STL), to be welded
  MeshAttributes attributes;
  std::optional<double> crease_degrees;  // which the file means, see own_crease_angle(); nothing where it does not tell
  std::vector<std::string> warnings;     // what was left out and why, such as a texture that is not there; whole sentences

  std::size_t polygon_count() const { return polygon_begin.empty() ? 0 : polygon_begin.size() - 1; }
};

}  // namespace curvecast
