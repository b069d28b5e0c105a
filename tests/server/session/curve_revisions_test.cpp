// Readers sample a curve while others publish finer revisions of it.
#include "server/session/curve_revisions.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>
#include <vector>

#include "core/sample/resample.h"
#include "tests/server/eventually.h"
#include "tests/support/views.h"

namespace curvecast::server {
namespace {

/// A strip of the plane: `n` vertices side by side at the height of the revision.
std::shared_ptr<const SurfaceCurve> strip(std::size_t n, std::uint64_t revision) {
  auto curve = std::make_shared<SurfaceCurve>();
  curve->resize(n);
  for (std::size_t l = 0; l < n; ++l) {
    curve->x[l] = (static_cast<float>(l) + 0.5f) / static_cast<float>(n);
    curve->y[l] = 0;
    curve->z[l] = static_cast<float>(revision);
    curve->nx[l] = curve->ny[l] = 0.0f;
    curve->nz[l] = 1.0f;
    curve->curvature_min[l] = curve->curvature_max[l] = 0.0f;
    curve->area[l] = 1 / static_cast<float>(n);
  }
  curve->total_area = 1;
  curve->box = {Vec3d(0, 0, 0), Vec3d(1, 0, 1000)};
  curve->revision = revision;
  curve->blocks = build_blocks(*curve);
  return curve;
}

TEST(CurveRevisions, NumbersGrowWhateverTheirCurvesAre) {
  std::uint64_t revision = 1;
  for (std::uint64_t count = 2; count < 100; ++count) {
    const std::uint64_t low = next_revision_number(revision, 0), high = next_revision_number(revision, ~std::uint64_t{0});
    EXPECT_GT(low, revision);
    EXPECT_GT(high, low);
    EXPECT_EQ(low >> 16, count);
    EXPECT_EQ(high >> 16, count);
    revision = count % 2 == 0 ? high : low;
  }
}

TEST(CurveRevisions, ReadersKeepTheRevisionThatTheyTook) {
  constexpr std::uint64_t kRevisions = 200;
  constexpr int kReaders = 4;
  CurveRevisions live;
  EXPECT_EQ(live.newest(), nullptr);
  live.publish(strip(1000, 1));
  std::atomic<bool> done = false;
  std::atomic<std::uint64_t> reads = 0;
  const auto read = [&] {
    std::uint64_t last = 0;
    do {
      const std::shared_ptr<const SurfaceCurve> curve = live.newest();
      EXPECT_GE(curve->revision, last);  // never goes back
      last = curve->revision;
      const absl::StatusOr<PointSet> points =
          resample(*curve, {.points = 100, .density = curvecast::testing::seen_from(Vec3d(0.5, 0, 2000)), .seed = last});
      ASSERT_TRUE(points.ok()) << points.status();
      for (const Vec3f& p : points->positions) ASSERT_EQ(p.z(), static_cast<float>(curve->revision));
      ++reads;
    } while (!done);
  };
  {
    std::vector<std::jthread> readers;
    for (int i = 0; i < kReaders; ++i) readers.emplace_back(read);
    for (std::uint64_t revision = 2; revision <= kRevisions; ++revision) {
      live.set_refining(true);
      live.publish(strip(1000 + 10 * revision, revision));
      live.set_refining(false);
      std::this_thread::yield();
    }
    EXPECT_TRUE(eventually([&] { return reads >= 2 * kReaders || ::testing::Test::HasFailure(); }));
    done = true;
  }
  EXPECT_EQ(live.newest()->revision, kRevisions);
  EXPECT_FALSE(live.refining());
}

TEST(CurveRevisions, AnOldRevisionGoesWithItsLastReader) {
  CurveRevisions live;
  live.publish(strip(5, 1));
  live.publish(strip(10, 2));
  std::weak_ptr<const SurfaceCurve> old = live.newest();
  std::shared_ptr<const SurfaceCurve> held = live.newest();
  live.publish(strip(20, 3));
  EXPECT_FALSE(old.expired());
  EXPECT_EQ(held->size(), 10u);
  held.reset();
  EXPECT_TRUE(old.expired());
  EXPECT_EQ(live.first()->size(), 5u) << "the first one stays: ranked points lie on it";
}

}  // namespace
}  // namespace curvecast::server
