#include "core/density/expression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

SurfaceCurve some_curve(std::size_t n) {
  SurfaceCurve curve;
  curve.resize(n);
  curve.origin = Vec3d(10, 20, 30);
  curve.scalars.resize(4);
  const std::vector<std::string> names = {"heat", "not an identifier", "x", "sin"};
  for (std::size_t s = 0; s < names.size(); ++s) {
    curve.scalars[s].name = names[s];
    curve.scalars[s].values.resize(n);
  }
  for (std::size_t l = 0; l < n; ++l) {
    const auto some = [l](std::uint64_t stream) { return static_cast<float>(random_unit(stream, l)); };
    curve.x[l] = some(1), curve.y[l] = some(2), curve.z[l] = some(3);
    curve.nx[l] = some(4), curve.ny[l] = some(5), curve.nz[l] = some(6);
    curve.curvature_min[l] = -some(7), curve.curvature_max[l] = some(8);
    for (ScalarColumn& scalar : curve.scalars) scalar.values[l] = some(9);
  }
  return curve;
}

std::vector<float> values_of(const SurfaceCurve& curve, const std::string& text) {
  std::vector<float> values(curve.size(), -7.0f);
  const absl::Status status = evaluate_expression(curve, text, values);
  EXPECT_TRUE(status.ok()) << status;
  return values;
}

TEST(Expression, KnowsWhatACurveKnows) {
  const SurfaceCurve curve = some_curve(100);
  const auto expect = [&](const std::string& text, const auto& at) {
    const std::vector<float> values = values_of(curve, text);
    for (std::size_t l = 0; l < curve.size(); ++l) ASSERT_NEAR(values[l], at(l), 1e-5 * (1 + std::abs(at(l)))) << text;
  };
  expect("1", [](std::size_t) { return 1.0; });
  expect("x", [&](std::size_t l) { return 10 + static_cast<double>(curve.x[l]); });
  expect("y + 2 * z", [&](std::size_t l) { return 20.0 + curve.y[l] + 2 * (30.0 + curve.z[l]); });
  expect("nx + ny * nz", [&](std::size_t l) { return double{curve.nx[l]} + double{curve.ny[l]} * double{curve.nz[l]}; });
  expect("gauss", [&](std::size_t l) { return double{curve.curvature_min[l]} * double{curve.curvature_max[l]}; });
  expect("mean", [&](std::size_t l) { return (double{curve.curvature_min[l]} + double{curve.curvature_max[l]}) / 2; });
  expect("k2 - k1", [&](std::size_t l) { return double{curve.curvature_max[l]} - double{curve.curvature_min[l]}; });
  expect("heat ^ 2 + max(heat, 0.5)", [&](std::size_t l) {
    const double h = curve.scalars[0].values[l];
    return h * h + std::max(h, 0.5);
  });
  expect("(heat > 0.5) ? sin(heat) : -1", [&](std::size_t l) {
    const double h = curve.scalars[0].values[l];
    return h > 0.5 ? std::sin(h) : -1.0;
  });
  expect("(x <= 10.5) + (x >= 10.5) + (x == 0) + (x != 0)", [&](std::size_t) { return 2.0; });
}

TEST(Expression, IsTheSameForAnyNumberOfThreads) {
  const SurfaceCurve curve = some_curve(100'000);
  const std::string text = "heat * sqrt(x) + exp(-gauss)";
  std::vector<float> one(curve.size());
  tbb::task_arena(1).execute([&] { ASSERT_TRUE(evaluate_expression(curve, text, one).ok()); });
  EXPECT_EQ(one, values_of(curve, text));
}

TEST(Expression, RefusesWhatIsNoFormula) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", "empty"},
      {std::string(kMaxExpression + 1, '1'), "1001 bytes"},
      {"1 +", "1 +"},
      {"(1", "(1"},
      {"f(x)", "f(x)"},
      {"x = 3", "assigned"},
      {"heat = 3", "assigned"},
      {"x, y", "several values"},
      {"1 \n+ 1", "printable"},
      {std::string("1\0", 2), "printable"},
      {"\xc3\xa9", "printable"},
      {"\"text\"", "text"},
      {"x y", "x y"},
  };
  for (const auto& [text, expected] : cases) {
    const absl::Status status = check_expression(text);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(expected));
  }
  EXPECT_TRUE(check_expression("any_name * 2").ok()) << "attributes are not known yet";
  std::string nested(303, '(');
  nested += '1';
  nested.append(303, ')');
  EXPECT_TRUE(check_expression(nested).ok());
}

/// "x^x^x^...", as long as a formula may be: each power is slow.
std::string tower() {
  std::string text = "x";
  while (text.size() + 2 <= kMaxExpression) text += "^x";
  return text;
}

TEST(Expression, ACostlyOneIsRefusedBeforeItRuns) {
  const SurfaceCurve curve = some_curve(200'000);
  std::vector<float> values(curve.size(), -7.0f);
  const absl::Status status = evaluate_expression(curve, tower(), values);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr(tower().substr(0, 60)));
  EXPECT_THAT(std::string(status.message()), HasSubstr("operations at each of 200000 places; at most 1000000000"));
  EXPECT_EQ(values.back(), -7.0f);
  EXPECT_TRUE(evaluate_expression(curve, "x ^ 2 + sin(y)", values).ok());
}

TEST(Expression, StopsWhenItsTimeIsOver) {
  const SurfaceCurve curve = some_curve(100'000);
  std::vector<float> values(curve.size(), -7.0f);
  WorkLimit none(WorkLimit::Nanoseconds(1));
  const absl::Status status = evaluate_expression(curve, tower(), values, {.limit = &none});
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_THAT(std::string(status.message()), HasSubstr(tower().substr(0, 60)));
  EXPECT_LT(std::ranges::count_if(values, [](float value) { return value != -7.0f; }), 10'000) << "a step of each task at most";
  WorkLimit ample(std::chrono::hours(1));
  EXPECT_TRUE(evaluate_expression(curve, "x + 1", values, {.limit = &ample}).ok());
  EXPECT_EQ(values, values_of(curve, "x + 1"));
}

TEST(Expression, StopsWhenItIsCancelled) {
  const SurfaceCurve curve = some_curve(100'000);
  std::vector<float> values(curve.size());
  std::atomic<bool> cancel = true;
  const absl::Status status = evaluate_expression(curve, tower(), values, {.cancel = &cancel});
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
}

TEST(Expression, NamesWhatItDoesNotKnow) {
  const SurfaceCurve curve = some_curve(10);
  std::vector<float> values(curve.size());
  const absl::Status status = evaluate_expression(curve, "wet + 1", values);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("no 'wet'; there are: x, y, z, nx"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("heat"));
}

}  // namespace
}  // namespace curvecast
