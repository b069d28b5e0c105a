#include "server/session/refiner.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/sample/resample.h"
#include "server/base/log.h"
#include "tests/server/ball_session.h"

namespace curvecast::server {
namespace {

std::uint64_t enough_room() { return std::uint64_t{1} << 40; }

bool ask(Refiner& refiner, const std::shared_ptr<const Session>& session, std::uint64_t points, std::uint64_t source = 1) {
  return refiner.request(session, *session->curve(), source, {.points = points});
}

TEST(Refiner, PublishesAFinerRevision) {
  Ends ends;
  const auto session = make_session(300);
  const std::shared_ptr<const SurfaceCurve> first = session->curve();
  Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
  ASSERT_TRUE(ask(refiner, session, 10'000));
  ASSERT_TRUE(ends.wait_for(1));
  const std::shared_ptr<const SurfaceCurve> second = session->curve();
  EXPECT_EQ(second->revision >> 16, 2u);
  EXPECT_GE(second->size(), 100'000u);
  EXPECT_EQ(second->max_points, 10'000u);
  EXPECT_FALSE(session->revisions->refining());
  EXPECT_EQ(first->revision, 1u);  // whoever took it has it still
  // One who found the old revision too coarse learns that there is another.
  EXPECT_TRUE(refiner.request(session, *first, 2, {.points = 10'000}));
  EXPECT_FALSE(session->revisions->refining());
}

TEST(Refiner, NumbersTellCurvesApart) {
  const auto revision_after = [](std::uint64_t points) {
    Ends ends;
    const auto session = make_session(300);
    Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
    EXPECT_TRUE(ask(refiner, session, points));
    EXPECT_TRUE(ends.wait_for(1));
    return session->curve()->revision;
  };
  const std::uint64_t revision = revision_after(10'000);
  EXPECT_EQ(revision_after(10'000), revision) << "the same curve, on another server";
  EXPECT_NE(revision_after(40'000), revision) << "refined as often, for something else";
}

TEST(Refiner, StopsAtTheLimit) {
  Ends ends;
  const auto session = make_session(300);
  Refiner refiner(20'000, ends.counter(), enough_room, make_logger(false, false));
  ASSERT_TRUE(ask(refiner, session, 1'000'000));
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_LE(session->curve()->size(), 20'000u);
  EXPECT_FALSE(ask(refiner, session, 1'000'000));
}

TEST(Refiner, TakesTheSurfaceFromTheHookWhereItIsNotAtHand) {
  Ends ends;
  const auto session = make_session(300);
  Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
  int loads = 0;
  session->surface =
      std::make_shared<SessionSurface>([&loads, flattened = session->preprocessed.flattened](const ExecutionContext& context) {
        ++loads;
        return curve_base(flattened, context);
      });
  ASSERT_TRUE(ask(refiner, session, 5'000));
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_EQ(session->curve()->revision >> 16, 2u);
  ASSERT_TRUE(ask(refiner, session, 30'000));
  ASSERT_TRUE(ends.wait_for(2));
  EXPECT_EQ(session->curve()->revision >> 16, 3u);
  EXPECT_EQ(loads, 1);
}

TEST(Refiner, GivesUpWithoutASurface) {
  Ends ends;
  const auto session = make_session(300);
  session->surface = std::make_shared<SessionSurface>();
  Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
  ASSERT_TRUE(ask(refiner, session, 5'000));
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_EQ(session->curve()->revision, 1u);
  EXPECT_FALSE(session->revisions->refining());
  EXPECT_FALSE(ask(refiner, session, 5'000));
}

TEST(Refiner, ForgetsClosedSessions) {
  Ends ends;
  const auto session = make_session(300);
  Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
  refiner.forget(*session);
  EXPECT_FALSE(ask(refiner, session, 5'000));
  // In the midst of it too, and what waits for it hears of the end.
  const auto other = make_session(300);
  ASSERT_TRUE(ask(refiner, other, 500'000));
  refiner.forget(*other);
  ASSERT_TRUE(ends.wait_for(1));
  EXPECT_FALSE(other->revisions->refining());
}

TEST(Refiner, StopsAtOnce) {
  Ends ends;
  const auto session = make_session(300), other = make_session(300);
  Refiner refiner(20'000'000, ends.counter(), enough_room, make_logger(false, false));
  ASSERT_TRUE(ask(refiner, session, 1'000'000));
  ASSERT_TRUE(ask(refiner, other, 1'000'000));
  refiner.stop();
  EXPECT_FALSE(session->revisions->refining());
  EXPECT_FALSE(other->revisions->refining());
  EXPECT_FALSE(ask(refiner, make_session(300), 5'000));
}

TEST(Refiner, ReadersAndRevisionsDoNotMeet) {
  Ends ends;
  const auto session = make_session(300);
  Refiner refiner(300'000, ends.counter(), enough_room, make_logger(false, false));
  std::vector<std::thread> readers;
  for (std::uint64_t r = 0; r < 4; ++r) {
    readers.emplace_back([&, r] {
      const auto deadline = std::chrono::steady_clock::now() + kPatience;
      std::uint64_t last = 0, n = 500;
      int rest = 20;  // rounds after the first swap
      while (rest > 0 && std::chrono::steady_clock::now() < deadline) {
        const std::shared_ptr<const SurfaceCurve> curve = session->curve();
        EXPECT_GE(curve->revision, last);
        last = curve->revision;
        rest -= last > 1 ? 1 : 0;
        n += n / 4;
        const std::uint64_t points = std::min<std::uint64_t>(n, 20'000);
        const absl::StatusOr<PointSet> set = resample(*curve, {.points = points});
        EXPECT_TRUE(set.ok() && set->vertices.back() < curve->size());
        refiner.request(session, *curve, r, {.points = points});
      }
    });
  }
  for (std::thread& reader : readers) reader.join();
  refiner.stop();
  EXPECT_GT(session->curve()->revision, 1u);
  EXPECT_LE(session->curve()->size(), 300'000u);
}

}  // namespace
}  // namespace curvecast::server
