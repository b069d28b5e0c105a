#include "core/render/curve_renderer.h"

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "core/render/stroke_text.h"
#include "core/render/tile_grid.h"

namespace curvecast {
namespace {

constexpr std::array<Rgb8, 8> kColours = {
    {{13, 8, 135}, {70, 3, 159}, {114, 1, 168}, {156, 23, 158}, {189, 55, 134}, {216, 87, 107}, {237, 121, 83}, {251, 159, 58}}};
constexpr double kLinesAcrossTile = 320;  // a disc's square over the width of its line
constexpr double kLineShare = 0.55;       // of the distance between neighbouring lines, at most
constexpr double kMeshOpacity = 0.16;

absl::Status check(std::span<const CurvePath> paths, const CurveRenderOptions& options) {
  if (paths.empty()) return absl::InvalidArgumentError("there is no curve to draw");
  const auto is_side = [](int side) { return side >= 64 && side <= 8192; };
  if (!is_side(options.width) || !is_side(options.height) || !(options.line_width >= 0 && options.line_width <= 64)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cannot draw %d x %d pixels with lines of %g: sides must be 64 .. 8192, lines 0 .. 64", options.width,
                        options.height, options.line_width));
  }
  const auto is_inside = [](const Vec2d& p) { return p.minCoeff() >= 0 && p.maxCoeff() <= 1; };  // no NaN either
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const CurvePath& path = paths[i];
    const bool fits = std::all_of(path.triangles.begin(), path.triangles.end(), [&](const Triangle& t) {
      return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return v < path.uv.size(); });
    });
    const bool inside =
        std::all_of(path.points.begin(), path.points.end(), is_inside) && std::all_of(path.uv.begin(), path.uv.end(), is_inside);
    if (!fits || !inside || path.points.size() != path.sides.size()) {
      return absl::InvalidArgumentError(
          absl::StrCat("the curve of disc ", i, " leaves the square or has arrays that do not match"));
    }
  }
  return absl::OkStatus();
}

/// Every edge once.
void draw_mesh(const CurvePath& path, const TileGrid& grid, int tile, Image& image) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  edges.reserve(3 * path.triangles.size());
  for (const Triangle& t : path.triangles) {
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(std::minmax({t[k], t[(k + 1) % 3]}));
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  for (const auto& [a, b] : edges) {
    draw_line(image, grid.place(tile, path.uv[a]), grid.place(tile, path.uv[b]), 0.8, kTileInk, kMeshOpacity);
  }
}

void draw_path(const CurvePath& path, double line_width, const TileGrid& grid, int tile, Image& image) {
  const double last = std::max<double>(1, static_cast<double>(path.points.size()) - 1);
  for (std::size_t l = 0; l + 1 < path.points.size(); ++l) {
    const double spacing = std::min(path.sides[l], path.sides[l + 1]) * grid.side;
    draw_line(image, grid.place(tile, path.points[l]), grid.place(tile, path.points[l + 1]),
              std::min(line_width, kLineShare * spacing), curve_colour((static_cast<double>(l) + 0.5) / last));
  }
}

}  // namespace

Rgb8 curve_colour(double t) {
  const double place = std::clamp(t, 0.0, 1.0) * (kColours.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(place), kColours.size() - 2);
  const double s = place - static_cast<double>(i);
  Rgb8 colour;
  for (std::size_t c = 0; c < 3; ++c) {
    colour[c] = static_cast<std::uint8_t>(std::lround((1 - s) * kColours[i][c] + s * kColours[i + 1][c]));
  }
  return colour;
}

absl::StatusOr<Image> render_curves(std::span<const CurvePath> paths, const CurveRenderOptions& options) {
  if (absl::Status status = check(paths, options); !status.ok()) return status;
  const auto count = static_cast<int>(std::min<std::size_t>(paths.size(), 1 << 20));
  const TileGrid grid = lay_out_tiles(options.width, options.height, count, 0);
  if (grid.side < 1) {
    return absl::InvalidArgumentError(
        absl::StrFormat("%d x %d pixels are too few for %d squares", options.width, options.height, count));
  }
  const double line_width = options.line_width > 0 ? options.line_width : std::max(1.0, grid.side / kLinesAcrossTile);
  Image image = blank_image(options.width, options.height, options.background);
  for (int i = 0; i < count; ++i) {
    const CurvePath& path = paths[static_cast<std::size_t>(i)];
    draw_mesh(path, grid, i, image);
    draw_path(path, line_width, grid, i, image);
    draw_tile_frame(image, grid, i);
  }
  return image;
}

}  // namespace curvecast
