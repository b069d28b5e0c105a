// Coarse stand-ins of sessions that are being made.
#include <gtest/gtest.h>

#include <vector>

#include "tests/server/session/session_store_fixture.h"

namespace curvecast::server {
namespace {

class SessionStorePreview : public SessionStoreFixture {
 protected:
  struct Replaced {
    std::shared_ptr<CurveRevisions> preview;
    absl::StatusOr<std::shared_ptr<const Session>> real;
  };

  /// Joins a session, and waits for its preview.
  std::shared_ptr<const Session> join(Waiter& waiter) {
    const auto id = store_->join(mesh("m"), {}, &waiter);
    EXPECT_TRUE(id.ok());
    id_ = id.value_or("");
    waiter.wait_for_stage("cut");
    return waiter.preview();
  }

  std::vector<Replaced> replaced_;  // by a job's thread, or in a call
  std::string id_;

  void SetUp() override {
    store_.reset();
    store_.emplace(
        queue_,
        [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview& on_preview) {
          on_preview([] { return tiny(); });
          return preprocess(context);
        },
        SessionLimits{.sessions = 3}, 1, make_logger(false, false),
        SessionStore::Options{
            .on_replaced = [this](const Session& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real) {
              const std::lock_guard lock(mutex_);
              replaced_.push_back({preview.revisions, real});
            }});
  }
};

TEST_F(SessionStorePreview, IsForViewsAloneUntilTheSessionIsReady) {
  Waiter waiter;
  const std::shared_ptr<const Session> preview = join(waiter);
  ASSERT_NE(preview, nullptr);
  EXPECT_TRUE(preview->is_preview);
  EXPECT_EQ(preview->id, id_);
  EXPECT_EQ(*store_->find_for_views(id_), preview);
  EXPECT_EQ(store_->find(id_).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(store_->info(id_)->state, SessionState::kPreprocessing);
  Waiter late;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &late).ok());
  EXPECT_EQ(late.preview(), preview);

  set_open(true);
  const auto real = waiter.wait();
  ASSERT_TRUE(real.ok());
  EXPECT_FALSE((*real)->is_preview);
  EXPECT_EQ(*store_->find_for_views(id_), *real);
  ASSERT_TRUE(late.wait().ok());
  const std::lock_guard lock(mutex_);
  ASSERT_EQ(replaced_.size(), 1u);
  EXPECT_EQ(replaced_[0].preview, preview->revisions);
  EXPECT_EQ(*replaced_[0].real, *real);
}

TEST_F(SessionStorePreview, IsNotMadeForThoseWhoDoNotWantIt) {
  Waiter waiter(false);
  EXPECT_EQ(join(waiter), nullptr);
  EXPECT_EQ(store_->find_for_views(id_).status().code(), absl::StatusCode::kFailedPrecondition);
  set_open(true);
  EXPECT_TRUE(waiter.wait().ok());
  EXPECT_EQ(waiter.preview(), nullptr);
}

TEST_F(SessionStorePreview, GoesWithTheJobThatFails) {
  failure_ = absl::InvalidArgumentError("bad");
  Waiter waiter;
  ASSERT_NE(join(waiter), nullptr);
  set_open(true);
  EXPECT_FALSE(waiter.wait().ok());
  EXPECT_EQ(store_->find_for_views(id_).status().code(), absl::StatusCode::kNotFound);
  const std::lock_guard lock(mutex_);
  ASSERT_EQ(replaced_.size(), 1u);
  EXPECT_EQ(replaced_[0].real.status(), failure_);
}

TEST_F(SessionStorePreview, GoesWithTheLastWhoWaits) {
  Waiter waiter;
  ASSERT_NE(join(waiter), nullptr);
  EXPECT_TRUE(store_->leave(id_, &waiter));
  ASSERT_EQ(replaced_.size(), 1u);
  EXPECT_EQ(replaced_[0].real.status().code(), absl::StatusCode::kCancelled);
}

TEST_F(SessionStorePreview, GoesWithASessionThatIsClosed) {
  Waiter waiter;
  ASSERT_NE(join(waiter), nullptr);
  EXPECT_TRUE(store_->close(id_).ok());
  EXPECT_EQ(waiter.wait().status().code(), absl::StatusCode::kAborted);  // it may not go before
  ASSERT_EQ(replaced_.size(), 1u);
  EXPECT_EQ(replaced_[0].real.status().code(), absl::StatusCode::kAborted);
}

}  // namespace
}  // namespace curvecast::server
