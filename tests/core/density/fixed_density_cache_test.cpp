#include "core/density/fixed_density_cache.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "tests/support/flat_curve.h"

namespace curvecast {
namespace {

using Terms = std::vector<DensityTerm>;

std::shared_ptr<const SurfaceCurve> bent_curve(float curvature = 1) {
  auto curve = testing::flat_curve(3);
  for (std::size_t l = 0; l < curve->size(); ++l) {
    curve->curvature_min[l] = 1;
    curve->curvature_max[l] = curvature * static_cast<float>(l % 5);
  }
  curve->reference_curvature = {3, 3, 3};
  return curve;
}

Terms bends(double exponent) { return {CurvatureTerm{.exponent = exponent}}; }

std::shared_ptr<const FixedDensity> get(FixedDensityCache& cache, const std::shared_ptr<const SurfaceCurve>& curve,
                                        const Terms& terms) {
  const auto fixed = cache.get(curve, terms);
  EXPECT_TRUE(fixed.ok()) << fixed.status();
  return fixed.ok() ? *fixed : nullptr;
}

TEST(FixedDensityCache, MakesTheSameOnce) {
  FixedDensityCache cache;
  const auto curve = bent_curve();
  const auto first = get(cache, curve, bends(1));
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(get(cache, curve, bends(1)), first);
  // What cameras change is not part of it.
  EXPECT_EQ(get(cache, curve, {ViewTerm{}, CurvatureTerm{}}), first);
  EXPECT_EQ(get(cache, curve, {CurvatureTerm{}, UniformTerm{}, ViewTerm{}}), first);
  EXPECT_EQ(cache.byte_size(), first->byte_size());
}

TEST(FixedDensityCache, TellsTermsAndCurvesApart) {
  FixedDensityCache cache;
  const auto curve = bent_curve(), other = bent_curve(2);
  const auto first = get(cache, curve, bends(1)), second = get(cache, curve, bends(2)), third = get(cache, other, bends(1));
  EXPECT_NE(first->density, second->density);
  EXPECT_NE(first->density, third->density);
  EXPECT_EQ(get(cache, curve, bends(1)), first);
  EXPECT_EQ(get(cache, curve, bends(2)), second);
  EXPECT_EQ(get(cache, other, bends(1)), third);
  EXPECT_EQ(get(cache, other, {}), nullptr);
}

TEST(FixedDensityCache, KeepsWhatWasUsedLast) {
  const auto curve = bent_curve();
  const std::size_t bytes = make_fixed_density(*curve, bends(1)).value()->byte_size();
  for (const bool by_bytes : {false, true}) {
    FixedDensityCache cache(by_bytes ? 100 : 2, by_bytes ? 2 * bytes : 1'000'000'000);
    const auto one = get(cache, curve, bends(1)), two = get(cache, curve, bends(2));
    EXPECT_EQ(get(cache, curve, bends(1)), one);
    const auto three = get(cache, curve, bends(3));  // and the second goes
    EXPECT_EQ(get(cache, curve, bends(1)), one);
    EXPECT_EQ(get(cache, curve, bends(3)), three);
    EXPECT_NE(get(cache, curve, bends(2)), two);
    EXPECT_EQ(get(cache, curve, bends(2))->density, two->density);
    EXPECT_LE(cache.byte_size(), 2 * bytes);
  }
  FixedDensityCache none(0, 0);
  EXPECT_NE(get(none, curve, bends(1)), nullptr);
  EXPECT_EQ(none.byte_size(), 0u);
}

TEST(FixedDensityCache, ForgetsCurvesThatHaveGone) {
  FixedDensityCache cache;
  auto curve = bent_curve();
  const std::weak_ptr<const SurfaceCurve> watched = curve;
  get(cache, curve, bends(1));
  get(cache, curve, bends(2));
  curve.reset();
  EXPECT_TRUE(watched.expired()) << "the cache holds on to no curve";
  const auto other = bent_curve(2);
  const auto fixed = get(cache, other, bends(1));
  EXPECT_EQ(cache.byte_size(), fixed->byte_size());
  EXPECT_EQ(fixed->density, make_fixed_density(*other, bends(1)).value()->density);
}

TEST(FixedDensityCache, LetsGoOfAllWhenItIsTold) {
  FixedDensityCache cache;
  const auto curve = bent_curve();
  const auto first = get(cache, curve, bends(1));
  cache.clear();
  EXPECT_EQ(cache.byte_size(), 0u);
  const auto again = get(cache, curve, bends(1));
  EXPECT_NE(again, first);
  EXPECT_EQ(again->density, first->density);
  EXPECT_EQ(cache.byte_size(), again->byte_size());
}

TEST(FixedDensityCache, PassesErrorsOn) {
  FixedDensityCache cache;
  EXPECT_TRUE(absl::IsInvalidArgument(cache.get(bent_curve(), Terms{AttributeTerm{"none"}}).status()));
  EXPECT_EQ(cache.byte_size(), 0u);
}

TEST(FixedDensityCache, ServesManyThreads) {
  FixedDensityCache cache(3);
  const auto curve = bent_curve();
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 200; ++i) {
        const double exponent = 1 + i % 5;
        const auto fixed = get(cache, curve, bends(exponent));
        EXPECT_EQ(fixed->density.size(), curve->size());
      }
    });
  }
}

}  // namespace
}  // namespace curvecast
