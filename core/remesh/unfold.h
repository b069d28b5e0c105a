// Keeps moves of vertices from turning triangles over.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {

struct UnfoldOptions {
  double least_angle = 0;  // degrees, below 90: triangles get no smaller angle than this, unless they had a smaller one
  int halvings = 0;        // how often a move is halved before it is taken back, up to 100
};

/// Takes moves back until every triangle faces about where it did, by less than 75 degrees, none has lost three quarters of its
/// area, and none has too small an angle: of all corners of one that does not, and so on. `before`, `after`: places of all
/// vertices; kNone as a triangle's first corner: it is not there. Returns for each vertex whether its move was taken back whole;
/// its `after` is its `before` then.
std::vector<bool> unfold(std::span<const Triangle> triangles, std::span<const Vec3d> before, std::span<Vec3d> after,
                         const UnfoldOptions& options = {});

}  // namespace curvecast
