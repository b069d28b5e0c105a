#include "core/density/brush.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/base/random.h"
#include "core/density/fixed_density_cache.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using Values = std::vector<float>;

std::shared_ptr<const SurfaceCurve> torus_curve() {
  const auto made = preprocess({"torus.off", testing::to_off(testing::torus(24, 48))}, {.points = 2000});
  EXPECT_TRUE(made.ok()) << made.status();
  return made->curve;
}

/// Dabs of all sizes on the torus and off it.
std::vector<Dab> some_dabs(const SurfaceCurve& curve, std::size_t n) {
  std::vector<Dab> dabs;
  for (std::size_t i = 0; i < n; ++i) {
    const auto unit = [&](std::uint64_t k) { return random_unit(3, 5 * i + k); };
    const auto l = static_cast<std::size_t>(unit(0) * static_cast<double>(curve.size() - 1));
    dabs.push_back({curve.origin + curve.position(l).cast<double>() + Vec3d::Constant(0.1 * unit(1)), 0.02 + 0.5 * unit(2),
                    i % 3 == 0 ? 0 : 8 * unit(3), i % 4 == 0 ? 0 : unit(4)});
  }
  return dabs;
}

Values painted(const SurfaceCurve& curve, const std::vector<Dab>& dabs) {
  Values values(curve.size(), 1.0f);
  EXPECT_TRUE(paint(curve, dabs, values).ok());
  return values;
}

TEST(Brush, LooksAtAllBlocksThatADabReaches) {
  const auto curve = torus_curve();
  SurfaceCurve without = *curve;
  without.blocks = {};
  std::vector<Dab> dabs = some_dabs(*curve, 100);
  dabs.push_back({Vec3d(0.5, 0, 0), 1e-9, 5, 0.5});
  dabs.push_back({Vec3d(1e300, 0, 0), 1, 5, 0.5});
  dabs.push_back({Vec3d(1e300, 0, 0), 1e308, 0.5, 0});
  dabs.push_back({Vec3d(0, 0, 1e5), 1e5, 3, 0.25});
  for (const Dab& dab : dabs)
    EXPECT_EQ(painted(*curve, {dab}), painted(without, {dab})) << dab.centre.transpose() << " " << dab.radius;
  EXPECT_EQ(painted(*curve, dabs), painted(without, dabs));
}

TEST(Brush, LaysDabsOneOverTheOther) {
  const auto curve = torus_curve();
  const Dab all{Vec3d::Zero(), 100, 4, 0.5}, part{Vec3d(1, 0, 0), 0.5, 2, 0};
  const Values once = painted(*curve, {part}), twice = painted(*curve, {part, part, part});
  EXPECT_EQ(once, twice) << "it does not pile up";
  EXPECT_EQ(std::count(once.begin(), once.end(), 1.0f) + std::count(once.begin(), once.end(), 2.0f),
            static_cast<std::ptrdiff_t>(once.size()));
  EXPECT_GT(std::count(once.begin(), once.end(), 2.0f), 0);
  EXPECT_EQ(painted(*curve, {part, all}), Values(curve->size(), 4.0f));
  EXPECT_NE(painted(*curve, {all, part}), Values(curve->size(), 4.0f));
}

TEST(Brush, TakesPaintAwayWithAFactorOfOne) {
  const auto curve = torus_curve();
  std::vector<Dab> dabs = some_dabs(*curve, 50);
  dabs.push_back({Vec3d::Zero(), 100, 1, 0.5});
  EXPECT_EQ(painted(*curve, dabs), Values(curve->size(), 1.0f));
}

TEST(Brush, IsOneAtMostOnceItIsScaled) {
  const auto curve = torus_curve();
  const std::vector<Dab> dabs = some_dabs(*curve, 50);
  const Values values = painted(*curve, dabs);
  EXPECT_LE(paint_scale(dabs) * *std::max_element(values.begin(), values.end()), 1.000001f);
  EXPECT_EQ(paint_scale({}), 1);
  EXPECT_EQ(paint_scale(std::vector<Dab>{{.factor = 0.25}}), 1) << "where there is no paint it is 1";
}

TEST(Brush, StopsWhenItIsCancelledOrItsTimeIsOver) {
  const auto curve = torus_curve();
  const std::vector<Dab> dabs = some_dabs(*curve, 1);
  Values values(curve->size(), 1.0f);
  std::atomic<bool> cancel = true;
  EXPECT_EQ(paint(*curve, dabs, values, {.cancel = &cancel}).code(), absl::StatusCode::kCancelled);
  WorkLimit none(WorkLimit::Nanoseconds(0));
  EXPECT_EQ(paint(*curve, dabs, values, {.limit = &none}).code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_EQ(values, Values(curve->size(), 1.0f));
}

TEST(Brush, PaintedStepByStepIsTheSameToTheBit) {
  const auto curve = torus_curve();
  const std::vector<Dab> dabs = some_dabs(*curve, 60);
  for (const bool has_other : {false, true}) {
    FixedDensityCache cache;
    const auto terms_with = [&](std::size_t n) {
      std::vector<DensityTerm> terms = {BrushTerm{{dabs.begin(), dabs.begin() + static_cast<std::ptrdiff_t>(n)}}};
      if (has_other) terms.insert(terms.begin(), {ExpressionTerm{"2 + x"}, CurvatureTerm{}});
      return terms;
    };
    for (const std::size_t n : {0, 1, 2, 30, 31, 60, 31, 45, 60, 59}) {
      const auto kept = cache.get(curve, terms_with(n)), fresh = make_fixed_density(*curve, terms_with(n));
      ASSERT_TRUE(kept.ok() && fresh.ok());
      ASSERT_EQ((*kept)->density, (*fresh)->density) << n;
      EXPECT_EQ((*kept)->most, (*fresh)->most);
      EXPECT_EQ((*kept)->mass.sum, (*fresh)->mass.sum);
      EXPECT_EQ((*kept)->others == nullptr, !has_other);
    }
  }
}

}  // namespace
}  // namespace curvecast
