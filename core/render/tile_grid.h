// Squares of one size in a grid: where the discs of a picture of the parameter square lie.
#pragma once

#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

struct TileGrid {
  int columns = 1, rows = 1;
  int side = 0;           // pixels; 0 when the picture is too small
  int gap = 0;            // pixels, between tiles and around them
  int left = 0, top = 0;  // of the first tile

  /// Upper left corner of tile i, in pixels.
  int x(int i) const { return left + i % columns * (side + gap); }
  int y(int i) const { return top + i / columns * (side + gap); }
  /// Lower edge of the last row.
  int bottom() const { return top + rows * (side + gap) - gap; }
  /// Returns the place of (u, v) in [0, 1]^2 of tile i: v points up.
  Vec2d place(int i, const Vec2d& uv) const { return {x(i) + uv.x() * side, y(i) + (1 - uv.y()) * side}; }
};

/// Lays out the largest squares of which `count` fit, with `footer` pixels free below them.
TileGrid lay_out_tiles(int width, int height, int count, int footer);

inline constexpr Rgb8 kTileInk = {38, 42, 52};

/// The four sides of tile i.
void draw_tile_frame(Image& image, const TileGrid& grid, int i);

/// Makes a picture of one colour.
Image blank_image(int width, int height, const Rgb8& color);

}  // namespace curvecast
