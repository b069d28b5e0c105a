// The middle one of a few measurements.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace curvecast::cli::bench {

/// Of an even number the upper one of the two in the middle. Precondition: there is one.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace curvecast::cli::bench
