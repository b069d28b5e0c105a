// How fast a discrepancy falls with the number of points (paper, section 4.2).
#pragma once

#include <span>

namespace curvecast {

/// Fits p in y ~ x^p by least squares. Preconditions: as many x as y, all positive, two different x.
double log_log_gradient(std::span<const double> x, std::span<const double> y);

}  // namespace curvecast
