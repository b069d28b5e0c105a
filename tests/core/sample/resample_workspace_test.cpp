#include "core/sample/resample_workspace.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/sample/resample.h"
#include "tests/support/flat_curve.h"
#include "tests/support/views.h"

namespace curvecast {
namespace {

using testing::seen_from;

std::shared_ptr<SurfaceCurve> bent_curve(int level, bool coloured) {
  auto curve = testing::flat_curve(level);
  for (std::size_t l = 0; l < curve->size(); ++l) {
    curve->curvature_min[l] = 1;
    curve->curvature_max[l] = static_cast<float>(l % 5);
  }
  curve->reference_curvature = {3, 3, 3};
  if (coloured) {
    curve->colour.resize(curve->size());
    for (std::size_t l = 0; l < curve->size(); ++l) curve->colour[l] = {static_cast<std::uint8_t>(l), 1, 2};
  }
  curve->blocks = build_blocks(*curve);
  return curve;
}

TEST(ResampleWorkspace, GivesWhatFreshMemoryGives) {
  const std::vector<std::shared_ptr<SurfaceCurve>> curves = {bent_curve(6, true), bent_curve(3, false), bent_curve(5, false)};
  const std::vector<Density> densities = {
      {}, seen_from(Vec3d(0.4, 0.2, 1)), {CurvatureTerm{}}, seen_from(Vec3d(2, 0.2, 1), {CurvatureTerm{}, ViewTerm{}})};
  ResampleWorkspace workspace;
  std::uint64_t seed = 0;
  for (const std::uint64_t points : {1u, 3000u, 10u, 500u, 100'000u, 7u, 3000u}) {
    for (const Density& density : densities) {
      for (const auto& curve : curves) {
        const Sequence sequence = ++seed % 2 == 0 ? Sequence::kJittered : Sequence::kGoldenRatio;
        const ResampleOptions options{.points = points, .density = density, .sequence = sequence, .seed = seed};
        const auto fixed = make_fixed_density(*curve, density.terms);
        ASSERT_TRUE(fixed.ok()) << fixed.status();
        ResampleReport again, fresh;
        ASSERT_TRUE(resample(*curve, fixed->get(), options, workspace, &again).ok());
        const auto expected = resample(*curve, options, &fresh);
        ASSERT_TRUE(expected.ok()) << expected.status();
        EXPECT_EQ(workspace.points.positions, expected->positions);
        EXPECT_EQ(workspace.points.normals, expected->normals);
        EXPECT_EQ(workspace.points.radii, expected->radii);
        EXPECT_EQ(workspace.points.vertices, expected->vertices);
        EXPECT_EQ(workspace.points.colours, expected->colours);
        EXPECT_EQ(again.most_on_vertex, fresh.most_on_vertex);
      }
    }
  }
}

TEST(ResampleWorkspace, AllocatesNothingForAFrameLikeTheLast) {
  const auto curve = bent_curve(6, true);
  ResampleOptions options{.points = 2000, .density = seen_from(Vec3d(0.4, 0.2, 1))};
  ResampleWorkspace workspace;
  EXPECT_EQ(workspace.byte_size(), 0u);
  ASSERT_TRUE(resample(*curve, nullptr, options, workspace).ok());
  const std::size_t bytes = workspace.byte_size();
  EXPECT_GT(bytes, 2000 * sizeof(Vec3f));
  const Vec3f* const positions = workspace.points.positions.data();
  for (const std::uint64_t points : {100u, 2000u, 1u, 1999u}) {
    options.points = points;
    ASSERT_TRUE(resample(*curve, nullptr, options, workspace).ok());
    EXPECT_EQ(workspace.points.size(), points);
    EXPECT_EQ(workspace.points.positions.data(), positions);
    EXPECT_LE(workspace.byte_size(), bytes + 100 * sizeof(MassCodes));
  }
}

TEST(ResampleWorkspace, OutlivesErrors) {
  const auto curve = bent_curve(4, false);
  ResampleWorkspace workspace;
  const auto status_of = [&](const ResampleOptions& options) { return resample(*curve, nullptr, options, workspace); };
  ASSERT_TRUE(status_of({.points = 50}).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(status_of({.points = 0})));
  EXPECT_TRUE(absl::IsOutOfRange(status_of({.points = kMaxPoints + 1})));
  EXPECT_TRUE(absl::IsFailedPrecondition(status_of({.points = 9, .density = seen_from(Vec3d(0, 0, -1))})));
  ASSERT_TRUE(status_of({.points = 50}).ok());
  EXPECT_EQ(workspace.points.positions, resample(*curve, {.points = 50})->positions);
}

}  // namespace
}  // namespace curvecast
