#include "server/session/session_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/server/session/session_store_fixture.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::HasSubstr;

class SessionStoreTest : public SessionStoreFixture {};

TEST_F(SessionStoreTest, ClientsShareOneJobAndItsProgress) {
  Waiter first, second;
  const auto id = store_->join(mesh("m"), {}, &first);
  first.wait_for_stage("cut");
  ASSERT_TRUE(id.ok());
  EXPECT_EQ(store_->join(mesh("m"), {}, &second).value_or(""), *id);
  EXPECT_EQ(second.progress().front().first, "cut");  // told at once where the job is
  EXPECT_EQ(store_->info(*id)->state, SessionState::kPreprocessing);
  set_open(true);
  const auto a = first.wait(), b = second.wait();
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(*a, *b);
  EXPECT_EQ((*a)->id, *id);
  EXPECT_EQ(runs(), 1);
  Waiter third;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &third).ok());
  EXPECT_TRUE(third.done());
  EXPECT_EQ(store_->find(*id).value(), *a);
  EXPECT_EQ(store_->list().size(), 1u);
}

TEST_F(SessionStoreTest, OtherOptionsAreAnotherSession) {
  set_open(true);
  Waiter first, second, third;
  const auto a = store_->join(mesh("m"), {.points = 100, .omega = 10}, &first);
  const auto b = store_->join(mesh("m"), {.points = 100, .omega = 11}, &second);
  const auto c = store_->join(mesh("n"), {.points = 100, .omega = 10}, &third);
  EXPECT_NE(*a, *b);
  EXPECT_NE(*a, *c);
  EXPECT_NE(*b, *c);
  EXPECT_TRUE(first.wait().ok() && second.wait().ok() && third.wait().ok());
  EXPECT_EQ(runs(), 3);
}

TEST_F(SessionStoreTest, EveryOptionMakesAnotherSession) {
  const std::set<std::string> ids = {session_id(mesh("m"), {}),
                                     session_id(mesh("m"), {.points = 7}),
                                     session_id(mesh("m"), {.omega = 7}),
                                     session_id(mesh("m"), {.parameteriser = Parameteriser::kCgal}),
                                     session_id(mesh("m"), {.mapper = Mapper::kIdBuffer}),
                                     session_id(mesh("m"), {.area_element = AreaElement::kVoronoi}),
                                     session_id(mesh("m"), {.density = {UniformTerm{}}}),
                                     session_id(mesh("m"), {.density = {CurvatureTerm{}}}),
                                     session_id(mesh("m"), {.density = {CurvatureTerm{.floor = 0.5}}}),
                                     session_id(mesh("m"), {.crease_degrees = 20})};
  EXPECT_EQ(ids.size(), 10u);
}

TEST_F(SessionStoreTest, IdsBeginAsThoseOfTheirMeshes) {
  const std::string mesh_id = "0123456789abcdef0123456789abcdef", other = "0123456789abcdeffedcba9876543210";
  const std::string id = session_id(mesh(mesh_id), {});
  EXPECT_EQ(id.size(), 32u);
  EXPECT_EQ(id.substr(0, 16), mesh_id.substr(0, 16));
  EXPECT_NE(id, session_id(mesh(other), {})) << "all digits of the mesh count";
}

TEST_F(SessionStoreTest, OtherCompanionsAreAnotherSession) {
  const std::set<std::string> ids = {session_id(mesh("m"), {}), session_id(mesh_with("t.png", "a"), {}),
                                     session_id(mesh_with("t.png", "b"), {}), session_id(mesh_with("u.png", "a"), {}),
                                     session_id(mesh_with("t.png\na", ""), {})};
  EXPECT_EQ(ids.size(), 5u);
  set_open(true);
  Waiter first, second;
  const auto a = store_->join(mesh_with("t.png", "a"), {}, &first);
  EXPECT_EQ(store_->join(mesh_with("t.png", "a"), {}, &second).value_or(""), *a);
  EXPECT_TRUE(first.wait().ok() && second.wait().ok());
  EXPECT_EQ(runs(), 1);
}

TEST_F(SessionStoreTest, TellsStartAndEndOfEveryStage) {
  const auto start = std::chrono::steady_clock::now();
  SessionStore store(queue_,
                     [](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
                       for (const char* stage : {"read", "cut", "map"}) {
                         // "cut" never says that it is over.
                         for (int i = 0; i <= 1000; ++i)
                           context.progress(stage, i / (stage == std::string("cut") ? 1001.0 : 1000.0));
                       }
                       return absl::StatusOr<Preprocessed>(tiny());
                     },
                     {.sessions = 3}, 1, make_logger(false, false), {});
  Waiter waiter;
  ASSERT_TRUE(store.join(mesh("m"), {}, &waiter).ok());
  ASSERT_TRUE(waiter.wait().ok());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto progress = waiter.progress();
  EXPECT_LE(progress.size(), 8 + seconds * 20 + 1);
  std::vector<std::string> starts, ends;
  for (const auto& [stage, fraction] : progress) {
    if (fraction == 0) starts.push_back(stage);
    if (fraction == 1) ends.push_back(stage);
  }
  const std::vector<std::string> stages = {"queued", "read", "cut", "map"};
  EXPECT_EQ(starts, stages);
  EXPECT_EQ(ends, stages);
}

/// Counts what is asked for, and says when it goes.
class Memory final : public MemorySource {
 public:
  explicit Memory(std::function<void(std::uint64_t taken)> on_gone) : on_gone_(std::move(on_gone)) {}
  ~Memory() override { on_gone_(taken_); }
  absl::Status take(std::uint64_t bytes, const std::string&) override {
    taken_ += bytes;
    return absl::OkStatus();
  }
  void give_back(std::uint64_t) override {}
  std::uint64_t most() const override { return 1000; }

 private:
  const std::function<void(std::uint64_t taken)> on_gone_;
  std::atomic<std::uint64_t> taken_ = 0;
};

TEST_F(SessionStoreTest, AJobAnswersForItsMemoryUntilTheSessionIsHeld) {
  std::vector<std::uint64_t> gone;
  std::vector<bool> was_held;
  std::optional<SessionStore> store;
  store.emplace(
      queue_,
      [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
        MemoryClaim claim(context);
        EXPECT_TRUE(claim.set(700, "").ok());
        return preprocess(context);
      },
      SessionLimits{.sessions = 3}, 1, make_logger(false, false),
      SessionStore::Options{.memory = [&](const std::atomic<bool>* cancel) {
        EXPECT_FALSE(*cancel);
        return std::make_unique<Memory>([&](std::uint64_t taken) {
          const auto all = store->list();
          const auto held = std::ranges::count_if(all, [](const SessionInfo& info) { return info.session != nullptr; });
          was_held.push_back(static_cast<std::size_t>(held) == gone.size() + 1);
          gone.push_back(taken);
        });
      }});
  set_open(true);
  for (const std::string id : {"a", "b"}) {
    Waiter waiter;
    ASSERT_TRUE(store->join(mesh(id), {}, &waiter).ok());
    ASSERT_TRUE(waiter.wait().ok());
  }
  queue_.stop();  // the jobs are over
  EXPECT_EQ(gone, (std::vector<std::uint64_t>{700, 700}));
  EXPECT_EQ(was_held, (std::vector<bool>{true, true}));
}

TEST_F(SessionStoreTest, WhatMayNotBeMadeIsRefusedUnlessItIsThere) {
  set_open(true);
  bool may = true;
  SessionStore store(queue_,
                     [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context, const OnPreview&) {
                       return preprocess(context);
                     },
                     {.sessions = 3}, 1, make_logger(false, false), {.may_make = [&](const MeshFiles&, const PreprocessOptions&) {
                       return may ? absl::OkStatus() : absl::ResourceExhaustedError("never");
                     }});
  Waiter waiter, again, other;
  const auto id = store.join(mesh("m"), {}, &waiter);
  ASSERT_TRUE(waiter.wait().ok());
  may = false;
  EXPECT_EQ(store.join(mesh("m"), {}, &again).value_or(""), *id);
  EXPECT_TRUE(again.wait().ok());
  EXPECT_EQ(store.join(mesh("other"), {}, &other).status().message(), "never");
  EXPECT_EQ(store.list().size(), 1u);
}

TEST_F(SessionStoreTest, TheLastWaiterToLeaveCancels) {
  Waiter first, second;
  const auto id = store_->join(mesh("m"), {}, &first);
  ASSERT_TRUE(store_->join(mesh("m"), {}, &second).ok());
  first.wait_for_stage("cut");
  EXPECT_TRUE(store_->leave(*id, &first));
  EXPECT_FALSE(store_->leave(*id, &first));
  EXPECT_TRUE(store_->info(*id).ok());
  EXPECT_TRUE(store_->leave(*id, &second));
  EXPECT_EQ(store_->info(*id).status().code(), Code::kNotFound);
  // A client that comes back meanwhile gets a job of its own.
  Waiter third;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &third).ok());
  third.wait_for_stage("cut");
  EXPECT_EQ(cancelled(), 1);
  EXPECT_EQ(runs(), 2);
  set_open(true);
  EXPECT_TRUE(third.wait().ok());
  EXPECT_FALSE(first.done() || second.done());
}

TEST_F(SessionStoreTest, OneOfTwoMayLeave) {
  Waiter first, second;
  const auto id = store_->join(mesh("m"), {}, &first);
  ASSERT_TRUE(store_->join(mesh("m"), {}, &second).ok());
  EXPECT_TRUE(store_->leave(*id, &first));
  set_open(true);
  EXPECT_TRUE(second.wait().ok());
  EXPECT_EQ(cancelled(), 0);
  EXPECT_FALSE(store_->leave(*id, &second));  // it has its answer
}

TEST_F(SessionStoreTest, AQueuedJobThatNobodyWantsNeverRuns) {
  Waiter first, second;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &first).ok());
  first.wait_for_stage("cut");
  const auto id = store_->join(mesh("n"), {}, &second);
  EXPECT_EQ(store_->info(*id)->state, SessionState::kQueued);
  EXPECT_TRUE(store_->leave(*id, &second));
  set_open(true);
  EXPECT_TRUE(first.wait().ok());
  make_ready("o");
  EXPECT_EQ(runs(), 2);
}

TEST_F(SessionStoreTest, FailureReachesEveryWaiterAndLeavesNothing) {
  failure_ = absl::InvalidArgumentError("line 7: no");
  Waiter first, second;
  const auto id = store_->join(mesh("m"), {}, &first);
  ASSERT_TRUE(store_->join(mesh("m"), {}, &second).ok());
  set_open(true);
  EXPECT_EQ(first.wait().status(), failure_);
  EXPECT_EQ(second.wait().status(), failure_);
  EXPECT_EQ(store_->find(*id).status().code(), Code::kNotFound);
  EXPECT_TRUE(store_->list().empty());
}

TEST_F(SessionStoreTest, OutOfMemoryIsAnError) {
  throws_ = true;
  set_open(true);
  Waiter waiter;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &waiter).ok());
  EXPECT_EQ(waiter.wait().status().code(), Code::kResourceExhausted);
}

TEST_F(SessionStoreTest, FindSaysWhy) {
  Waiter waiter;
  const auto id = store_->join(mesh("m"), {}, &waiter);
  EXPECT_EQ(store_->find(*id).status().code(), Code::kFailedPrecondition);
  EXPECT_EQ(store_->find("nonsense").status().code(), Code::kNotFound);
  EXPECT_THAT(store_->find(std::string(1000, '\n')).status().message(), HasSubstr("\\n"));
  EXPECT_EQ(store_->close("nonsense").code(), Code::kNotFound);
  set_open(true);
  EXPECT_TRUE(waiter.wait().ok());
}

TEST_F(SessionStoreTest, CloseLeavesTheSessionToThoseWhoHoldIt) {
  set_open(true);
  const std::string id = make_ready("m");
  const auto held = store_->find(id);
  EXPECT_TRUE(store_->close(id).ok());
  EXPECT_EQ(store_->find(id).status().code(), Code::kNotFound);
  EXPECT_EQ((*held)->curve()->size(), 1u);
}

TEST_F(SessionStoreTest, CloseStopsPreprocessing) {
  Waiter waiter;
  const auto id = store_->join(mesh("m"), {}, &waiter);
  waiter.wait_for_stage("cut");
  EXPECT_TRUE(store_->close(*id).ok());
  EXPECT_EQ(waiter.wait().status().code(), Code::kAborted);
  EXPECT_FALSE(store_->leave(*id, &waiter));
  store_.reset();
  EXPECT_EQ(cancelled(), 1);
}

TEST_F(SessionStoreTest, GoingAwayCancelsAndWaits) {
  Waiter first, second;
  ASSERT_TRUE(store_->join(mesh("m"), {}, &first).ok());
  ASSERT_TRUE(store_->join(mesh("n"), {}, &second).ok());
  first.wait_for_stage("cut");
  store_.reset();
  EXPECT_EQ(cancelled(), 1);
  EXPECT_EQ(runs(), 1);
}

TEST_F(SessionStoreTest, WaitersMayCallTheStore) {
  class Caller final : public SessionWaiter {
   public:
    explicit Caller(SessionStore& store) : store_(store) {}
    void on_progress(std::string_view, double) override { EXPECT_LE(store_.list().size(), 1u); }
    void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override {
      const std::string id = (*session)->id;
      EXPECT_TRUE(store_.find(id).ok());
      EXPECT_TRUE(store_.close(id).ok());
      done_.set_value();
    }
    bool wait() { return done_.get_future().wait_for(kPatience) == std::future_status::ready; }

   private:
    SessionStore& store_;
    std::promise<void> done_;
  };
  set_open(true);
  Caller caller(*store_);
  ASSERT_TRUE(store_->join(mesh("m"), {}, &caller).ok());
  ASSERT_TRUE(caller.wait());
  EXPECT_TRUE(store_->list().empty());
}

TEST_F(SessionStoreTest, ListsPageByPage) {
  set_open(true);
  const std::set<std::string> ids = {make_ready("a"), make_ready("b"), make_ready("c")};
  std::vector<std::string> listed;
  while (true) {
    const std::vector<SessionInfo> page = store_->list(listed.empty() ? "" : listed.back(), 2);
    if (page.empty()) break;
    EXPECT_LE(page.size(), 2u);
    for (const SessionInfo& info : page) listed.push_back(info.id);
  }
  EXPECT_EQ(listed, std::vector<std::string>(ids.begin(), ids.end()));
}

}  // namespace
}  // namespace curvecast::server
