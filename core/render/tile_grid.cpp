#include "core/render/tile_grid.h"

#include <algorithm>
#include <array>

#include "core/render/stroke_text.h"

namespace curvecast {

TileGrid lay_out_tiles(int width, int height, int count, int footer) {
  TileGrid grid;
  grid.gap = std::max(4, std::min(width, height) / 40);
  for (int n = 1; n <= count; ++n) {
    const int rows = (count + n - 1) / n;
    const int fits = std::min((width - grid.gap) / n, (height - 2 * grid.gap - footer) / rows) - grid.gap;
    if (fits > grid.side) {
      grid.side = fits;
      grid.columns = n;
    }
  }
  grid.rows = (count + grid.columns - 1) / grid.columns;
  grid.left = (width - grid.columns * (grid.side + grid.gap) + grid.gap) / 2;
  grid.top = (height - grid.rows * (grid.side + grid.gap) - grid.gap - footer) / 2 + grid.gap;
  return grid;
}

void draw_tile_frame(Image& image, const TileGrid& grid, int i) {
  const std::array<Vec2d, 4> corner = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    draw_line(image, grid.place(i, corner[k]), grid.place(i, corner[(k + 1) % 4]), 1.2, kTileInk, 0.8);
  }
}

Image blank_image(int width, int height, const Rgb8& color) {
  Image image{width, height, std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * height, 255)};
  for (std::size_t i = 0; i < image.rgba.size(); ++i) {
    if (i % 4 < 3) image.rgba[i] = color[i % 4];
  }
  return image;
}

}  // namespace curvecast
