#include "core/measure/gradient.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace curvecast {
namespace {

TEST(LogLogGradient, FindsThePower) {
  const std::vector<double> x = {1, 2, 5, 100}, y = {3, 3 * std::pow(2, -0.75), 3 * std::pow(5, -0.75), 3 * std::pow(100, -0.75)};
  EXPECT_NEAR(log_log_gradient(x, y), -0.75, 1e-12);
}

TEST(LogLogGradient, IsTheLeastSquaresFitOfWhatIsNoPower) {
  // At log x = -1, 0, 1 the values' logarithms are 0, 1, 0.5.
  const double e = std::exp(1.0);
  EXPECT_NEAR(log_log_gradient(std::vector<double>{1 / e, 1, e}, std::vector<double>{1, e, std::exp(0.5)}), 0.25, 1e-12);
}

}  // namespace
}  // namespace curvecast
