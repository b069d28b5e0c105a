// Draws parameter meshes: how much the surface is stretched or squeezed at every place of the square.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <span>

#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

/// One disc in the square.
struct UvDisc {
  std::span<const Vec2d> uv;            // in [0, 1]^2
  std::span<const Triangle> triangles;  // T, over uv
  std::span<const double> area_ratios;  // T: surface area over uv area, >= 0
};

struct UvRenderOptions {
  int width = 1280, height = 960;  // pixels, 64 .. 8192
  int supersample = 3;             // samples per pixel along each axis, 1 .. 4
  int max_tiles = 100;             // count: of the discs with the largest surface; >= 1
  Rgb8 background = {250, 251, 252};
};

struct UvPicture {
  Image image;
  double scale = 1;  // the colours' ends stand for ratios of `scale` and 1 / scale
  int tiles = 0;     // discs drawn
};

/// A square for each disc, in a grid, the one with the largest surface first. The colour is a triangle's area ratio over the mean
/// of its disc, on a logarithmic scale: red where more surface lies in less of the square, blue where less, white for the mean.
/// The scale's ends fit all but a two-hundredth of the squares and stand below, with numbers. Edges show where triangles are
/// large enough on the picture. InvalidArgument for no disc, arrays of other lengths, indices or options out of range.
absl::StatusOr<UvPicture> render_uv(std::span<const UvDisc> discs, const UvRenderOptions& options = {});

}  // namespace curvecast
