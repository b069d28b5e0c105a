// A parameter mesh with a cut, for the tests of pictures.
#pragma once

#include "client/lib/parameter_mesh.h"

namespace curvecast::cli {

/// A square of two triangles whose lower side is glued to its upper one, at z = 0 and far from the origin.
inline client::ParameterMesh strip() {
  client::ParameterMesh mesh;
  client::ParameterDisc& disc = mesh.discs.emplace_back();
  disc.positions = {{100, 0, 0}, {101, 0, 0}, {101, 1, 0}, {100, 1, 0}};
  disc.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  disc.triangles = {{0, 1, 2}, {0, 2, 3}};
  disc.faces = {0, 1};
  disc.area_ratios = {1, 1};
  disc.border = {0, 1, 2, 3};
  disc.border_cuts = {1, 0, 1, 0};
  return mesh;
}

}  // namespace curvecast::cli
