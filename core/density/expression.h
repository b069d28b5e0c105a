// Formulas over what a curve knows of each place, such as "(x > 0) * (1 + abs(mean))". Syntax and functions are those of
// muParser.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <span>
#include <string>

#include "core/curve/surface_curve.h"

namespace curvecast {

/// Longest formula, in bytes.
inline constexpr std::size_t kMaxExpression = 1000;

/// InvalidArgument says what is wrong with a formula on any surface: its syntax, a function that there is not, an assignment,
/// several values, its length. Names may be anything: attributes are known only with the surface.
absl::Status check_expression(const std::string& text);

/// Writes the formula's value at every curve vertex (L entries), NaN and infinities as they come. Variables: x, y, z (absolute
/// coordinates, in the file's units), nx, ny, nz (unit normal), k1 <= k2 (principal curvatures, 1/unit), gauss = k1 k2,
/// mean = (k1 + k2) / 2, and the curve's scalars whose names are identifiers and not taken. Runs on all threads of the arena.
/// InvalidArgument as of check_expression(), and for a name that there is not.
absl::Status evaluate_expression(const SurfaceCurve& curve, const std::string& text, std::span<float> values);

}  // namespace curvecast
