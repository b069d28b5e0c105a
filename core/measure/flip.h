// How different two pictures look to somebody who flips between them.
// Source: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild, "FLIP: a difference evaluator for alternating
// images", Proceedings of the ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
#pragma once

#include <vector>

#include "core/base/image.h"

namespace curvecast {

/// Of somebody 0.7 m from a screen that is 0.7 m and 3,840 pixels wide, as the paper has it.
inline constexpr double kFlipPixelsPerDegree = 67.0206;

struct FlipError {
  double mean = 0;           // 0: the same, 1: as different as can be
  std::vector<float> error;  // of each pixel, 0 to 1, rows from top to bottom
};

/// Compares two pictures; alpha does not count. `pixels_per_degree`: of the viewer's field of view. Precondition: as wide and as
/// high, with at least one pixel; pixels_per_degree > 0.
FlipError flip_error(const Image& reference, const Image& test, double pixels_per_degree = kFlipPixelsPerDegree);

}  // namespace curvecast
