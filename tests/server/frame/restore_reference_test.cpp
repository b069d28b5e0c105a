// What a client holds of another server is selected again where there are the candidates.
#include <gtest/gtest.h>

#include <memory>

#include "server/convert/convert.h"
#include "server/frame/make_frame.h"
#include "tests/server/frame/ball_view.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kPoints = 20'000;

v1::SampleRequest close_view() {
  v1::SampleRequest sample;
  sample.set_points(kPoints);
  sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
  look_at_ball(0.1, sample);
  return sample;
}

class RestoreReference : public ::testing::Test {
 protected:
  /// A view of a server that has made all candidates for it.
  Answer settled(const Session& session) {
    RankDemand demand;
    const ImprovementRequests improvements{.finer_curve = [](const auto&, std::uint64_t) { return false; },
                                           .more_ranks =
                                               [&](RankDemand next) {
                                                 demand = std::move(next);
                                                 return true;
                                               }};
    for (;;) {
      demand = nullptr;
      absl::StatusOr<Answer> answer = make_frame(session, {.point_set = request_, .may_refine = true}, cache_, improvements);
      EXPECT_TRUE(answer.ok()) << answer.status();
      if (!demand) return *std::move(answer);
      EXPECT_TRUE(session.candidates->grow(demand(session.ranks({})->tree).chunks, {}).ok());
    }
  }

  ViewCache cache_;
  const PointSetRequest request_ = *to_point_set_request(close_view());
};

TEST_F(RestoreReference, NeedsAllCandidatesThatItTakes) {
  const Answer held = settled(*fresh_ball());
  ASSERT_NE(held.reference, nullptr);
  ASSERT_EQ(held.frame.held_points(), kPoints);
  const ResumeClaim claim{.point_set = request_, .points = kPoints, .digest = held.reference->digest()};
  const std::shared_ptr<const Session> another = fresh_ball();
  absl::StatusOr<std::shared_ptr<const ReferenceFrame>> restored = restore_reference(*another, claim, cache_, {});
  ASSERT_TRUE(restored.ok()) << restored.status();
  EXPECT_EQ(*restored, nullptr) << "making them would keep a worker of views";

  settled(*another);
  restored = restore_reference(*another, claim, cache_, {});
  ASSERT_TRUE(restored.ok()) << restored.status();
  ASSERT_NE(*restored, nullptr);
  EXPECT_EQ((*restored)->digest(), claim.digest);
}

}  // namespace
}  // namespace curvecast::server
