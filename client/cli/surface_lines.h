// Lines on a surface, for the renderer of points: rows of dots so close that they touch on the picture.
#pragma once

#include <vector>

#include "client/lib/curve.h"
#include "client/lib/parameter_mesh.h"
#include "core/render/render_camera.h"
#include "core/render/splat_renderer.h"

namespace curvecast::cli {

inline constexpr Rgb8 kCutColor = {214, 40, 40};     // where the surface was cut open
inline constexpr Rgb8 kBorderColor = {29, 95, 176};  // where the mesh itself ends
inline constexpr Rgb8 kEdgeColor = {96, 102, 116};   // of triangles

struct LineDots {
  std::vector<Vec3f> positions;  // relative to the view's origin
  std::vector<Rgb8> colors;
};

/// What the lines are drawn for.
struct LineView {
  RenderCamera camera;  // absolute coordinates
  int height = 0;       // of the picture, pixels
  double diagonal = 0;  // of what is drawn
  Vec3d origin = Vec3d::Zero();
  bool is_closed = false;  // the surface has no border: what faces away from the eye is hidden
};

/// The discs' borders, every cut once although two sides of it are borders.
LineDots trace_cuts(const client::ParameterMesh& mesh, const LineView& view);

/// The sides of all triangles, once each: also where two discs, or two sides of a cut, share one.
LineDots trace_edges(const client::ParameterMesh& mesh, const LineView& view);

/// The curve of each disc in the colours of curve_colour(), bent with the surface from one vertex to the next.
LineDots trace_curve(const client::Curve& curve, const LineView& view);

}  // namespace curvecast::cli
