// SPDX-License-Identifier: Apache-2.0
// Ranked points as a set of 3D Tiles, which viewers load by what they look at. Source: OGC 22-025r4, 3D Tiles specification 1.1.
#pragma once

#include <absl/status/status.h>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/formats/glb_points.h"
#include "proto/formats/point_columns.h"

namespace curvecast::formats {

/// The file that names all others of a set.
inline constexpr char kTilesetName[] = "tileset.json";

struct TilesetOptions {
  std::uint32_t root_points = 4096;  // of the coarsest level; each level has four times as many as the one before
  GlbOptions content = {.quantise = true, .compress = true};  // of each tile
  bool z_up = false;                                          // the mesh's third axis points upwards, not its second
  int json_levels = 3;                                        // that one file describes; what lies deeper has files of its own
  std::string folder;                                         // of all files but tileset.json, beside that: "tiles/", or none
};

/// One file of the set. Names have no folder before them: "tileset.json", "3-17.glb" (the tile 17 of level 3), "5-17.json" (what
/// lies below it).
struct TileFile {
  std::string name;
  std::string bytes;
};

/// Makes all files, "tileset.json" last, and hands each to `emit`, whose error ends the work. The root has the points of the
/// lowest ranks; a tile of level l has, of the points whose ranks lie below root_points 4^l and not below a quarter of that,
/// those in its part of the curve, which is one of 4^l with equally many points: so no point is in two tiles, and all levels down
/// to one are a coarser set of the points. The last level has all that are left: there is none whose parts would have fewer
/// points than a 16th of root_points. Boxes are those of the points of a tile and all below it, to the float. The geometric error
/// of a tile is the greatest distance from a point below it to the nearest one of its level or of coarser ones: what is lacking
/// where viewers stop there. `columns` in curve order; positions, normals and colours come along. InvalidArgument: as
/// check_columns(); no points, no ranks or the same rank twice; an option out of range.
absl::Status make_tileset(const PointColumns& columns, const TilesetOptions& options,
                          const std::function<absl::Status(TileFile file)>& emit);

/// Whether a file of a set may have this name, tileset.json aside.
bool is_tile_name(std::string_view name);

}  // namespace curvecast::formats
