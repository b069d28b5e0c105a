#include "server/frame/point_blocks.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/frame/make_frame.h"
#include "tests/server/frame/frame_points.h"
#include "tests/support/shapes.h"
#include "tests/support/views.h"

namespace curvecast::server {
namespace {

using curvecast::testing::seen_from;

/// A finely made ball.
const Session& ball() {
  static const Session session = [] {
    const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(4));
    absl::StatusOr<Preprocessed> done = preprocess({"ball.off", off}, {.points = 50'000});
    EXPECT_TRUE(done.ok()) << done.status();
    Session made;
    made.options.points = 50'000;
    made.preprocessed = *std::move(done);
    made.surface = std::make_shared<SessionSurface>(made.preprocessed.flattened);
    made.revisions->publish(std::move(made.preprocessed.curve));
    return made;
  }();
  return session;
}

ViewCache& cache() {
  static ViewCache cache;
  return cache;
}

struct Blocks {
  std::vector<v1::PointBlock> blocks;
  std::uint64_t points = 0;
  std::size_t bytes = 0;
  v1::FrameStatistics statistics;
};

std::size_t bytes_of(const v1::PointBlock& block) {
  return block.draco().data().size() + block.raw().positions().size() + block.raw().normals().size() + block.raw().radii().size();
}

std::size_t bytes_of(const v1::PointFrame& frame) {
  std::size_t bytes = 0;
  for (const v1::PointBlock& block : frame.points()) bytes += bytes_of(block);
  return bytes;
}

Blocks blocks_of(const PointSetRequest& request) {
  Blocks out;
  int with_statistics = 0;
  const absl::Status status = make_point_blocks(ball(), request, cache(), {}, {}, [&](const v1::ResampleResponse& response) {
    with_statistics += response.has_statistics() ? 1 : 0;
    out.statistics = response.statistics();
    out.points += response.points().count();
    out.bytes += bytes_of(response.points());
    out.blocks.push_back(response.points());
    return true;
  });
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(with_statistics, 1);
  return out;
}

PointSetRequest request_of(std::uint64_t max_bytes, bool is_draco = true) {
  PointSetRequest request;
  request.max_bytes = max_bytes;
  if (is_draco) request.draco = DracoOptions();
  return request;
}

TEST(PointBlocks, KeepWithinTheirBytes) {
  for (const std::size_t limit : {1024u, 5000u, 30'000u, 100'000u, 400'000u}) {
    for (const bool is_draco : {true, false}) {
      for (const Density& density : {Density(), seen_from(Vec3d(0, 0, 3)), Density({ExpressionTerm{"exp(8 * x)"}})}) {
        PointSetRequest request = request_of(limit, is_draco);
        request.options.density = density;
        const Blocks made = blocks_of(request);
        EXPECT_LE(made.bytes, limit);
        EXPECT_GE(static_cast<double>(made.bytes), 0.9 * static_cast<double>(limit)) << limit << ", " << density.terms.size();
        EXPECT_EQ(made.statistics.limit(), v1::POINT_LIMIT_BYTES);
        EXPECT_EQ(made.statistics.wanted_points(), 0u);
        const auto frame = make_frame(ball(), {.point_set = request}, cache(), {});
        ASSERT_TRUE(frame.ok()) << frame.status();
        EXPECT_EQ(frame->frame.statistics().limit(), v1::POINT_LIMIT_BYTES);
        EXPECT_LE(bytes_of(frame->frame), limit);
        EXPECT_GE(static_cast<double>(bytes_of(frame->frame)), 0.9 * static_cast<double>(limit));
      }
    }
  }
}

TEST(PointBlocks, OfABudgetAreThoseOfTheirNumber) {
  PointSetRequest request = request_of(400'000);
  request.draco->position_bits = 14;
  const Blocks made = blocks_of(request);
  EXPECT_GT(made.blocks.size(), 1u);
  request.max_bytes = 0;
  request.options.points = made.points;
  const Blocks same = blocks_of(request);
  EXPECT_EQ(same.statistics.limit(), v1::POINT_LIMIT_UNSPECIFIED);
  EXPECT_EQ(same.statistics.wanted_points(), made.points);
  ASSERT_EQ(same.blocks.size(), made.blocks.size());
  for (std::size_t i = 0; i < same.blocks.size(); ++i) {
    EXPECT_EQ(same.blocks[i].SerializeAsString(), made.blocks[i].SerializeAsString());
  }
}

TEST(PointBlocks, TakeAnErrorInPixels) {
  PointSetRequest request;
  request.draco = DracoOptions();
  request.options.density = seen_from(Vec3d(0, 0, 3), {ScreenTerm{}});
  request.pixel_error = 16;
  const Blocks coarse = blocks_of(request);
  request.pixel_error = 8;
  const Blocks fine = blocks_of(request);
  EXPECT_NEAR(static_cast<double>(fine.points), 4.0 * static_cast<double>(coarse.points), 8);
  const auto frame = make_frame(ball(), {.point_set = request}, cache(), {});
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_EQ(count_points(frame->frame), fine.points);
  EXPECT_EQ(frame->frame.statistics().wanted_points(), fine.points);
}

TEST(PointBlocks, AskForAFinerCurveWithTheirOwnNumber) {
  PointSetRequest request;
  request.options.density = seen_from(Vec3d(0, 0, 3), {ScreenTerm{}});
  request.pixel_error = 1;
  std::uint64_t asked = 0;
  const auto improvements = [&](const SurfaceCurve&, std::uint64_t points) {
    asked = points;
    return true;
  };
  std::uint64_t points = 0;
  bool refining = false;
  ASSERT_TRUE(
      make_point_blocks(ball(), request, cache(), {.finer_curve = improvements}, {}, [&](const v1::ResampleResponse& response) {
        points += response.points().count();
        refining = response.statistics().refining();
        return true;
      }).ok());
  EXPECT_EQ(asked, points);
  EXPECT_TRUE(refining);
}

TEST(PointBlocks, RefuseWhatIsTooMuch) {
  PointSetRequest request;
  request.options.points = 4'000'000;
  EXPECT_EQ(make_frame(ball(), {.point_set = request}, cache(), {}).status().code(), absl::StatusCode::kResourceExhausted);
  request.options.points = 4'000'001;
  EXPECT_EQ(make_frame(ball(), {.point_set = request}, cache(), {}).status().code(), absl::StatusCode::kOutOfRange);
  request = request_of(100);  // Draco's header alone takes more
  request.options.density = {BrushTerm{{Dab{.radius = 1e9}}}};
  EXPECT_EQ(make_frame(ball(), {.point_set = request}, cache(), {}).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(
      make_point_blocks(ball(), request_of(5000), cache(), {}, {}, [](const v1::ResampleResponse&) { return false; }).code(),
      absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast::server
