#include "core/flatten/parameterise_cgal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/flatten/distortion.h"
#include "core/flatten/parameterise.h"
#include "tests/core/curve/charts.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

constexpr CgalPreconditioner kPreconditioners[] = {CgalPreconditioner::kIncompleteLu, CgalPreconditioner::kDiagonal};

DiscMesh disc_of(const PolygonSoup& soup) { return testing::charts_of(testing::make_mesh(soup)).at(0).disc; }

double covered(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  double area = 0;
  for (std::size_t t = 0; t < disc.triangles.size(); ++t) area += uv_area({disc, uv}, t);
  return area;
}

TEST(ParameteriseCgal, CoversTheSquareOnceWithoutAFlip) {
  using namespace testing;
  for (const PolygonSoup& soup :
       {disc(8, 24), jittered(sphere(20, 30), 0.02), torus(24, 12), perforated_slab(5, 5), open_cylinder(12, 16), icosphere(3)}) {
    const DiscMesh disc = disc_of(soup);
    for (const CgalPreconditioner preconditioner : kPreconditioners) {
      double seconds = -1;
      const auto uv = parameterise_cgal(disc, preconditioner, &seconds);
      ASSERT_TRUE(uv.ok()) << uv.status();
      EXPECT_EQ(count_flipped(disc, *uv), 0u);
      EXPECT_NEAR(covered(disc, *uv), 1, 1e-9);
      EXPECT_GE(seconds, 0);
    }
  }
}

TEST(ParameteriseCgal, AgreesWithOursOnTheSameBorder) {
  // 24 equal border edges without a cut: both put the corners on every sixth.
  FlattenTimes times;
  const auto charts = flatten(testing::make_mesh(testing::disc(8, 24)), {.extremities = {.most = 0}}, {}, times);
  ASSERT_TRUE(charts.ok());
  const DiscMesh& disc = charts->at(0).disc;
  ASSERT_EQ(disc.border.size(), 24u);
  const auto ours = parameterise(disc, {.reweightings = 0});
  ASSERT_TRUE(ours.ok());
  for (const CgalPreconditioner preconditioner : kPreconditioners) {
    const auto theirs = parameterise_cgal(disc, preconditioner);
    ASSERT_TRUE(theirs.ok()) << theirs.status();
    for (std::size_t v = 0; v < ours->size(); ++v) EXPECT_LT(((*ours)[v] - (*theirs)[v]).norm(), 1e-8) << v;
  }
}

TEST(ParameteriseCgal, EndsWhenItIsCancelled) {
  const DiscMesh disc = disc_of(testing::icosphere(6));
  for (const CgalPreconditioner preconditioner : kPreconditioners) {
    std::atomic<bool> cancel = true;
    const ExecutionContext context{.cancel = &cancel};
    EXPECT_EQ(parameterise_cgal(disc, preconditioner, nullptr, context).status().code(), absl::StatusCode::kCancelled);
    cancel = false;
    std::jthread canceller([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(30));  // into its work, as a rule
      cancel = true;
    });
    const absl::Status status = parameterise_cgal(disc, preconditioner, nullptr, context).status();
    EXPECT_TRUE(status.ok() || absl::IsCancelled(status)) << status;
  }
}

TEST(ParameteriseCgal, RefusesWhatIsNoDisc) {
  const DiscMesh disc = disc_of(testing::disc(4, 12));
  DiscMesh doubled = disc;
  doubled.triangles.push_back(doubled.triangles[0]);
  EXPECT_EQ(parameterise_cgal(doubled).status().code(), absl::StatusCode::kInvalidArgument);
  DiscMesh inner = disc;
  std::rotate(inner.border.begin(), inner.border.begin() + 2, inner.border.end());
  std::swap(inner.border[0], inner.border[1]);
  EXPECT_EQ(parameterise_cgal(inner).status().code(), absl::StatusCode::kInvalidArgument);
  DiscMesh shorter = disc;
  shorter.border.resize(3);
  EXPECT_EQ(parameterise_cgal(shorter).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast
