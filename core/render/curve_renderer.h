// Draws space-filling curves in the parameter square.
#pragma once

#include <absl/status/statusor.h>

#include <span>

#include "core/base/image.h"
#include "core/base/vec.h"
#include "core/render/splat_renderer.h"

namespace curvecast {

/// Returns the colours of a curve from its beginning, t = 0, to its end, t = 1: dark blue over purple and red to orange, in steps
/// that look alike, all of them dark enough for a white background. The lower seven ninths of "plasma" (N. Smith, S. van der
/// Walt, 2015).
Rgb8 curve_colour(double t);

/// The curve of one disc, with the disc's parameter mesh behind it.
struct CurvePath {
  std::span<const Vec2d> points;        // L, in [0, 1]^2
  std::span<const double> sides;        // L: of the square that each point is the centre of
  std::span<const Vec2d> uv;            // of the mesh; may be empty
  std::span<const Triangle> triangles;  // over uv; may be empty
};

struct CurveRenderOptions {
  int width = 1280, height = 960;  // pixels, 64 .. 8192
  double line_width = 0;           // pixels, thinner where the curve is denser than that; 0 = a 320th of a disc's square
  Rgb8 background = {255, 255, 255};
};

/// A square for each disc, in a grid, in the given order. InvalidArgument for no disc, arrays of other lengths, places outside of
/// the square, indices or options out of range.
absl::StatusOr<Image> render_curves(std::span<const CurvePath> paths, const CurveRenderOptions& options = {});

}  // namespace curvecast
