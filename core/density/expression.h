// Formulas over position, normal and curvature of each curve vertex, such as "(x > 0) * (1 + abs(mean))". Syntax and functions
// are those of muParser.
#pragma once

#include <absl/status/status.h>

#include <cstddef>
#include <span>
#include <string>

#include "core/base/execution_context.h"
#include "core/curve/surface_curve.h"

namespace curvecast {

/// The longest formula, in bytes.
inline constexpr std::size_t kMaxExpression = 1000;
/// The most that a formula may take at all places together, in operations as long as an addition: some seconds of one core.
inline constexpr double kMaxExpressionOperations = 1e9;

/// Checks what can be checked of a formula without a surface. InvalidArgument says what is wrong: its syntax, an unknown
/// function, an assignment, several values, its length. Any name of a variable is allowed: attributes are known only with the
/// surface.
absl::Status check_expression(const std::string& text);

/// Writes the formula's value at every curve vertex (L entries), NaN and infinities as they come. Variables: x, y, z (absolute
/// coordinates, in the file's units), nx, ny, nz (unit normal), k1 <= k2 (principal curvatures, 1/unit), gauss = k1 k2,
/// mean = (k1 + k2) / 2, and the curve's scalars whose names are identifiers and not taken. Runs on all threads of the arena.
/// InvalidArgument as of check_expression(), for an unknown name, and before anything is evaluated for more than
/// kMaxExpressionOperations. Cancelled, or DeadlineExceeded beyond the context's limit, within milliseconds.
absl::Status evaluate_expression(const SurfaceCurve& curve, const std::string& text, std::span<float> values,
                                 const ExecutionContext& context = {});

}  // namespace curvecast
