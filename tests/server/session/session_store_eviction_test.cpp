// What goes from the store for want of room or use, and what stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/session/session_store_fixture.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;

class SessionStoreEvictionTest : public SessionStoreFixture {};

TEST_F(SessionStoreEvictionTest, EvictsTheLeastRecentlyUsedThatIsIdle) {
  set_open(true);
  const std::string a = make_ready("a"), b = make_ready("b"), c = make_ready("c");
  auto held = store_->find(a);
  ASSERT_TRUE(store_->find(b).ok());
  const std::string d = make_ready("d");
  EXPECT_TRUE(store_->info(a).ok());  // used before c, but held
  EXPECT_TRUE(store_->info(b).ok());
  EXPECT_EQ(store_->info(c).status().code(), Code::kNotFound);
  auto also_b = store_->find(b), also_d = store_->find(d);
  Waiter waiter;
  const absl::Status refused = store_->join(mesh("e"), {}, &waiter).status();
  EXPECT_EQ(refused.code(), Code::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), ::testing::HasSubstr("holds 3 sessions of"));
  EXPECT_THAT(std::string(refused.message()), ::testing::HasSubstr("in the making are 3 of"));
  also_d = absl::CancelledError();
  ASSERT_TRUE(store_->update(d, true, std::nullopt).ok());
  EXPECT_FALSE(store_->join(mesh("e"), {}, &waiter).ok()) << "it is pinned";
  ASSERT_TRUE(store_->update(d, false, std::nullopt).ok());
  also_d = store_->find(d);
  held = absl::CancelledError();
  EXPECT_TRUE(store_->join(mesh("e"), {}, &waiter).ok());
  EXPECT_TRUE(waiter.wait().ok());
  EXPECT_EQ(store_->info(a).status().code(), Code::kNotFound);
}

TEST_F(SessionStoreEvictionTest, NoneGoesInVain) {
  set_open(true);
  SessionStore store(queue_,
                     [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
                       return preprocess(context);
                     },
                     {.sessions = 10, .bytes = 100'000}, 1, make_logger(false, false), {});
  Waiter waiter, other, another;
  const std::string great = *store.join(mesh("a"), {}, &waiter), small = *store.join(mesh("b"), {}, &other);
  ASSERT_TRUE(waiter.wait().ok() && other.wait().ok());
  const auto held = store.find(great);
  auto curve = std::make_shared<SurfaceCurve>();
  curve->x.resize(50'000);
  (*held)->revisions->publish(std::move(curve));
  EXPECT_EQ(store.join(mesh("c"), {}, &another).status().code(), Code::kResourceExhausted);
  EXPECT_TRUE(store.info(small).ok());
}

TEST_F(SessionStoreEvictionTest, PinnedSessionsStay) {
  set_open(true);
  const std::string a = make_ready("a"), b = make_ready("b"), c = make_ready("c");
  EXPECT_TRUE(store_->update(a, true, std::nullopt)->pinned);
  make_ready("d"), make_ready("e");
  EXPECT_TRUE(store_->info(a)->pinned);
  EXPECT_FALSE(store_->info(b).ok() || store_->info(c).ok());
  ASSERT_TRUE(store_->update(a, false, std::nullopt).ok());
  make_ready("f"), make_ready("g"), make_ready("h");
  EXPECT_FALSE(store_->info(a).ok());
  EXPECT_EQ(store_->update("nonsense", true, {}).status().code(), Code::kNotFound);
}

TEST_F(SessionStoreEvictionTest, PinsLeaveRoomForOthers) {
  set_open(true);
  const std::string a = make_ready("a"), b = make_ready("b");
  ASSERT_TRUE(store_->update(a, true, std::nullopt).ok());
  EXPECT_TRUE(store_->update(a, true, std::nullopt).ok()) << "it is pinned already";
  EXPECT_EQ(store_->update(b, true, std::nullopt).status().code(), Code::kResourceExhausted);
  EXPECT_FALSE(store_->info(b)->pinned);
  ASSERT_TRUE(store_->update(a, false, std::nullopt).ok());
  EXPECT_TRUE(store_->update(b, true, std::nullopt).ok());
}

TEST_F(SessionStoreEvictionTest, TimeToLiveCountsFromTheLastUse) {
  set_open(true);
  const std::string a = make_ready("a"), b = make_ready("b");
  ASSERT_TRUE(store_->update(a, std::nullopt, 100.0).ok());
  ASSERT_TRUE(store_->update(b, std::nullopt, 100.0).ok());
  const auto now = std::chrono::steady_clock::now();
  using std::chrono::seconds;
  EXPECT_TRUE(store_->run_housekeeping(now + seconds(50)).empty());
  {
    const auto held = store_->find(a);
    EXPECT_THAT(store_->run_housekeeping(now + seconds(200)), ::testing::ElementsAre(b));
  }
  EXPECT_TRUE(store_->info(a).ok());
  EXPECT_TRUE(store_->run_housekeeping(now + seconds(299)).empty()) << "it was used until then";
  EXPECT_THAT(store_->run_housekeeping(now + seconds(301)), ::testing::ElementsAre(a));
  EXPECT_TRUE(store_->list().empty());
}

TEST_F(SessionStoreEvictionTest, EvictsWhatIsTooMuchTogether) {
  set_open(true);
  SessionStore store(queue_,
                     [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
                       return preprocess(context);
                     },
                     {.sessions = 10, .bytes = 100'000}, 1, make_logger(false, false), {});
  std::vector<std::string> ids;
  for (const char* name : {"a", "b", "c"}) {
    Waiter waiter;
    ids.push_back(*store.join(mesh(name), {}, &waiter));
    ASSERT_TRUE(waiter.wait().ok());
  }
  const auto grow = [&](const std::string& id) {
    auto curve = std::make_shared<SurfaceCurve>();
    curve->x.resize(15'000);
    (*store.find(id))->revisions->publish(std::move(curve));
  };
  grow(ids[0]);
  store.run_housekeeping(std::chrono::steady_clock::now());
  EXPECT_EQ(store.list().size(), 3u);
  EXPECT_GE(store.memory_bytes(), 60'000u);
  grow(ids[1]);
  store.run_housekeeping(std::chrono::steady_clock::now());
  // The third takes next to nothing, but was used before the two.
  EXPECT_TRUE(store.info(ids[1]).ok());
  EXPECT_FALSE(store.info(ids[0]).ok());
  EXPECT_LE(store.memory_bytes(), 100'000u);
}

}  // namespace
}  // namespace curvecast::server
