// Every view comes to its last frame, and no frame repeats the one before: real frames of a real session, while transport,
// workers and background jobs are in the test's hands.
#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "tests/server/frame/ball_view.h"
#include "tests/server/frame/conversation.h"
#include "tests/server/frame/frame_points.h"

namespace curvecast::server {
namespace {

constexpr std::uint64_t kPoints = 20'000;
constexpr int kMostFrames = 24;  // eight improvements, and parts that grow fourfold

/// What becomes of it when a view asks for more ranked candidates or a finer curve.
enum class Background {
  kImproves,  // it is made
  kRefuses,   // there is no room for it
  kFails,     // it is promised, but not made
};

struct Zoom {
  v1::Sampler sampler = v1::SAMPLER_PROGRESSIVE;
  double distance = 1;  // of the eye from the surface, in radii
  std::uint64_t first_bytes = 0;
  bool accept_deltas = true;
  Background background = Background::kImproves;

  std::string name() const {
    return absl::StrCat("sampler ", static_cast<int>(sampler), ", distance ", distance, ", first_bytes ", first_bytes,
                        ", deltas ", accept_deltas, ", background ", static_cast<int>(background));
  }
};

/// A client of a ball that few curve vertices are made for.
class ZoomedView : public Conversation {
 public:
  explicit ZoomedView(const Zoom& zoom) : zoom_(zoom) {
    session_ = fresh_ball();
    stream_ = std::make_shared<ClientStream>(
        this, ClientStream::Hooks{
                  .find = [this](const std::string&) -> absl::StatusOr<std::shared_ptr<const Session>> { return session_; },
                  .answer = [this](const std::shared_ptr<const Session>& session,
                                   const FrameRequest& request) { return make_frame(*session, request, cache_, improvements()); },
                  .restore = [](const Session&, const auto&, const auto&) { return nullptr; },
                  .has_room = [] { return absl::OkStatus(); },
                  .submit =
                      [this](std::function<void()> job, std::chrono::nanoseconds) {
                        jobs_.push_back(std::move(job));
                        return absl::OkStatus();
                      },
                  .count_queued = [](std::int64_t) {},
              });
  }

  /// Shows the view and takes in its frames until nothing is left to do.
  void look() {
    v1::StreamViewsRequest request = open_request("ball");
    request.mutable_open()->set_accept_deltas(zoom_.accept_deltas);
    receive(request);
    request = view_request(1, kPoints);
    v1::ViewUpdate& view = *request.mutable_view();
    view.set_first_bytes(zoom_.first_bytes);
    v1::SampleRequest& sample = *view.mutable_sample();
    sample.set_sampler(zoom_.sampler);
    look_at_ball(zoom_.distance, sample);
    receive(request);
    while (frames_.size() <= kMostFrames) {
      if (!jobs_.empty()) {
        run_job();
        if (!frames_.empty()) receive(ack_request(1));
      } else if (is_promised_) {
        improve();
      } else {
        return;
      }
    }
  }

  /// What two frames differ in if their points do.
  static std::string points_of(const v1::PointFrame& frame) {
    return absl::StrCat(frame.curve_revision(), " ", frame.held_points(), " ",
                        frame.digest() != 0 ? absl::StrCat(frame.digest()) : point_bytes(frame));
  }

 private:
  ImprovementRequests improvements() {
    return {.finer_curve = [this](const SurfaceCurve&, std::uint64_t) { return promise(); },
            .more_ranks =
                [this](RankDemand demand) {
                  demand_ = std::move(demand);
                  return promise();
                }};
  }
  bool promise() {
    is_promised_ = zoom_.background != Background::kRefuses;
    return is_promised_;
  }
  void improve() {
    is_promised_ = false;
    if (zoom_.background == Background::kImproves) {
      if (zoom_.sampler == v1::SAMPLER_PROGRESSIVE) {
        EXPECT_TRUE(session_->candidates->grow(demand_(session_->ranks({})->tree).chunks, {}).ok());
      } else {
        const auto finer = std::make_shared<SurfaceCurve>(*session_->curve());
        ++finer->revision;
        session_->revisions->publish(finer);
      }
    }
    stream_->refined(*session_);
    deliver();
  }

  const Zoom zoom_;
  ViewCache cache_;
  bool is_promised_ = false;
  RankDemand demand_;
};

/// Each frame says how many points were wanted, and why it has not as many.
void expect_reasons(const std::vector<v1::PointFrame>& frames) {
  for (const v1::PointFrame& frame : frames) {
    if (frame.has_error()) continue;
    const v1::FrameStatistics& statistics = frame.statistics();
    EXPECT_EQ(statistics.wanted_points(), kPoints);
    EXPECT_EQ(statistics.limit() == v1::POINT_LIMIT_UNSPECIFIED, frame.held_points() == kPoints);
    if (statistics.limit() == v1::POINT_LIMIT_COMING) {
      EXPECT_TRUE(statistics.refining());
    }
    if (statistics.refining() && frame.held_points() < kPoints) {
      EXPECT_NE(statistics.limit(), v1::POINT_LIMIT_SERVER);
    }
  }
}

TEST(ViewSettles, WithAllItsPointsIfTheirRanksAreMade) {
  for (const Background background : {Background::kImproves, Background::kRefuses}) {
    const Zoom zoom{.distance = 0.16, .first_bytes = 2000, .background = background};
    SCOPED_TRACE(zoom.name());
    ZoomedView client(zoom);
    client.look();
    ASSERT_LE(client.frames_.size(), kMostFrames) << "the same view for ever";
    EXPECT_FALSE(client.frames_.back().statistics().refining());
    EXPECT_GT(client.frames_.back().held_points(), 0u);
    EXPECT_EQ(client.frames_.back().held_points() == kPoints, background == Background::kImproves);
    expect_reasons(client.frames_);
    const v1::PointLimit reason = background == Background::kImproves ? v1::POINT_LIMIT_UNSPECIFIED : v1::POINT_LIMIT_SERVER;
    EXPECT_EQ(client.frames_.back().statistics().limit(), reason);
  }
}

TEST(ViewSettles, PartsComeToThePointsOfTheWhole) {
  for (const double distance : {3.0, 0.06}) {
    for (const Background background : {Background::kImproves, Background::kRefuses}) {
      std::optional<v1::PointFrame> whole;
      for (const std::uint64_t first_bytes : {0, 2000, 20'000}) {
        const Zoom zoom{.distance = distance, .first_bytes = first_bytes, .background = background};
        SCOPED_TRACE(zoom.name());
        ZoomedView client(zoom);
        client.look();
        ASSERT_FALSE(client.frames_.empty());
        if (!whole) whole = client.frames_.back();
        EXPECT_EQ(client.frames_.back().held_points(), whole->held_points());
        EXPECT_EQ(client.frames_.back().digest(), whole->digest());
      }
    }
  }
}

TEST(ViewSettles, HoweverNearAndWhateverIsMade) {
  std::vector<Zoom> zooms;
  for (const double distance : {3.0, 0.06, 0.005}) {
    for (const Background background : {Background::kImproves, Background::kRefuses, Background::kFails}) {
      zooms.push_back({v1::SAMPLER_EQUALISED, distance, 0, true, background});
      zooms.push_back({v1::SAMPLER_PROGRESSIVE, distance, 0, false, background});
      for (const std::uint64_t first_bytes : {0, 1024, 50'000}) {
        zooms.push_back({v1::SAMPLER_PROGRESSIVE, distance, first_bytes, true, background});
      }
    }
  }
  for (const Zoom& zoom : zooms) {
    SCOPED_TRACE(zoom.name());
    ZoomedView client(zoom);
    client.look();
    const std::vector<v1::PointFrame>& frames = client.frames_;
    ASSERT_FALSE(frames.empty());
    ASSERT_LE(frames.size(), kMostFrames);
    expect_reasons(frames);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool is_last = i + 1 == frames.size();
      // Nearest to the surface, the last word may be that there is no candidate in sight.
      const auto nothing_in_sight = static_cast<std::uint32_t>(absl::StatusCode::kFailedPrecondition);
      EXPECT_EQ(frames[i].error().code(), is_last && frames[i].has_error() ? nothing_in_sight : 0u)
          << frames[i].error().message();
      EXPECT_EQ(frames[i].statistics().refining(), !is_last) << "frame " << i << " of " << frames.size();
      // A promise that came to nothing is taken back: that frame alone may bring nothing.
      if (i == 0 || is_last) continue;
      EXPECT_NE(ZoomedView::points_of(frames[i]), ZoomedView::points_of(frames[i - 1])) << "frame " << i;
    }
  }
}

}  // namespace
}  // namespace curvecast::server
