#include "server/session/session_jobs.h"

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <optional>
#include <utility>

#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

constexpr auto kPatience = std::chrono::seconds(60);  // only what is broken waits that long

/// Preprocessing that goes on until it is let go or cancelled.
class SessionJobsTest : public ::testing::Test {
 protected:
  absl::StatusOr<Preprocessed> preprocess(const ExecutionContext& context) {
    if (runs_++ == 0) begun_.set_value();
    EXPECT_TRUE(eventually([&] { return is_open_ || context.cancelled(); }));
    if (context.cancelled()) return context.check();
    auto curve = std::make_shared<SurfaceCurve>();
    curve->x = {1};
    return Preprocessed{std::move(curve), {}};
  }
  static std::shared_ptr<SessionJob> make_job(const std::string& id) {
    auto job = std::make_shared<SessionJob>();
    job->id = id;
    job->files.mesh = std::make_shared<const Mesh>(MeshLabel{"the mesh"}, MeshBytes());
    return job;
  }
  void wait_for_first() { ASSERT_EQ(begun_.get_future().wait_for(kPatience), std::future_status::ready); }

  std::atomic<bool> is_open_ = false;
  std::atomic<int> runs_ = 0, ends_ = 0;
  std::promise<void> begun_;
  std::promise<std::shared_ptr<const Session>> made_;
  JobQueue queue_{{.max_waiting = 1}};
  std::optional<SessionJobs> jobs_{
      std::in_place,
      queue_,
      [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
        return preprocess(context);
      },
      1,
      nullptr,
      nullptr,
      SessionJobs::GetMemory(),
      [](const std::shared_ptr<SessionJob>&, const std::shared_ptr<const Session>&) {},
      [this](const std::shared_ptr<SessionJob>&, absl::StatusOr<std::shared_ptr<const Session>> session) {
        ++ends_;
        if (session.ok()) made_.set_value(*session);
      }};
};

TEST_F(SessionJobsTest, MakesASession) {
  const auto job = make_job("s");
  ASSERT_TRUE(jobs_->start(job).ok());
  wait_for_first();
  EXPECT_TRUE(job->has_begun);
  is_open_ = true;
  auto made = made_.get_future();
  ASSERT_EQ(made.wait_for(kPatience), std::future_status::ready);
  const std::shared_ptr<const Session> session = made.get();
  EXPECT_EQ(session->id, "s");
  EXPECT_EQ(session->mesh_id, "the mesh");
  EXPECT_EQ(session->curve()->size(), 1u);
  EXPECT_FALSE(job->is_loaded);
}

TEST_F(SessionJobsTest, ACancelledJobEndsInSilence) {
  const auto running = make_job("a"), waiting = make_job("b");
  ASSERT_TRUE(jobs_->start(running).ok());
  wait_for_first();
  ASSERT_TRUE(jobs_->start(waiting).ok());
  EXPECT_EQ(jobs_->start(make_job("c")).code(), absl::StatusCode::kResourceExhausted);
  jobs_->cancel(*waiting);
  EXPECT_EQ(queue_.waiting(), 0u);
  jobs_->cancel(*running);
  jobs_.reset();  // waits
  EXPECT_EQ(runs_, 1);
  EXPECT_EQ(ends_, 0);
}

}  // namespace
}  // namespace curvecast::server
