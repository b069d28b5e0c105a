#include "server/session/session_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>

#include <chrono>
#include <condition_variable>
#include <future>
#include <new>
#include <optional>
#include <utility>

#include "server/base/log.h"

namespace curvecast::server {
namespace {

using Code = absl::StatusCode;
using ::testing::HasSubstr;

constexpr auto kPatience = std::chrono::seconds(60);  // only a broken store waits that long

class Waiter final : public SessionWaiter {
 public:
  void on_progress(std::string_view stage, double fraction) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(done_) << "progress after the end";
    progress_.emplace_back(stage, fraction);
    changed_.notify_all();
  }
  void on_done(absl::StatusOr<std::shared_ptr<const Session>> session) override {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(done_) << "ended twice";
    done_ = std::move(session);
    changed_.notify_all();
  }

  absl::StatusOr<std::shared_ptr<const Session>> wait() {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, kPatience, [&] { return done_.has_value(); })) return absl::DeadlineExceededError("test");
    return *done_;
  }
  void wait_for_stage(const std::string& stage) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, kPatience, [&] { return !progress_.empty() && progress_.back().first == stage; }));
  }
  std::vector<std::pair<std::string, double>> progress() {
    const std::lock_guard lock(mutex_);
    return progress_;
  }
  bool done() {
    const std::lock_guard lock(mutex_);
    return done_.has_value();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::pair<std::string, double>> progress_;
  std::optional<absl::StatusOr<std::shared_ptr<const Session>>> done_;
};

Preprocessed tiny() {
  auto curve = std::make_shared<SurfaceCurve>();
  curve->x = {1};
  return {std::move(curve), {}};
}

// Preprocessing that stays in its stage "cut" until it is let go or cancelled.
class SessionStoreTest : public ::testing::Test {
 protected:
  absl::StatusOr<Preprocessed> preprocess(const ExecutionContext& context) {
    std::unique_lock lock(mutex_);
    ++runs_;
    lock.unlock();
    context.progress("read", 0);
    context.progress("read", 1);
    context.progress("cut", 0);
    lock.lock();
    while (!open_ && !context.cancelled()) changed_.wait_for(lock, std::chrono::milliseconds(1));
    if (context.cancelled()) {
      ++cancelled_;
      return context.check();
    }
    if (throws_) throw std::bad_alloc();
    if (!failure_.ok()) return failure_;
    context.progress("cut", 1);
    return tiny();
  }

  void set_open(bool open) {
    const std::lock_guard lock(mutex_);
    open_ = open;
    changed_.notify_all();
  }
  int runs() {
    const std::lock_guard lock(mutex_);
    return runs_;
  }
  int cancelled() {
    const std::lock_guard lock(mutex_);
    return cancelled_;
  }

  static MeshFiles mesh(const std::string& id) {
    auto out = std::make_shared<Mesh>();
    out->id = id;
    return {out, {}};
  }
  /// Mesh "m" with one companion.
  static MeshFiles mesh_with(const std::string& name, const std::string& companion) {
    MeshFiles files = mesh("m");
    files.companions[name] = mesh(companion).mesh;
    return files;
  }
  std::string make_ready(const std::string& mesh_id) {
    Waiter waiter;
    const auto id = store_->join(mesh(mesh_id), {}, &waiter);
    EXPECT_TRUE(id.ok()) << id.status();
    EXPECT_TRUE(waiter.wait().ok());
    return id.value_or("");
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false, throws_ = false;
  absl::Status failure_;
  int runs_ = 0, cancelled_ = 0;
  JobQueue queue_{{.max_waiting = 16}};
  std::optional<SessionStore> store_{
      std::in_place,
      queue_,
      [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context) { return preprocess(context); },
      SessionLimits{.sessions = 3},
      1,
      make_logger(false, false)};
};

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
                                     session_id(mesh("m"), {.density = {CurvatureTerm{.floor = 0.5}}})};
  EXPECT_EQ(ids.size(), 9u);
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
  SessionStore store(
      queue_,
      [](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context) {
        for (const char* stage : {"read", "cut", "map"}) {
          // "cut" never says that it is over.
          for (int i = 0; i <= 1000; ++i) context.progress(stage, i / (stage == std::string("cut") ? 1001.0 : 1000.0));
        }
        return absl::StatusOr<Preprocessed>(tiny());
      },
      {.sessions = 3}, 1, make_logger(false, false));
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

TEST_F(SessionStoreTest, EvictsTheLeastRecentlyUsedThatIsIdle) {
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
  EXPECT_EQ(store_->join(mesh("e"), {}, &waiter).status().code(), Code::kResourceExhausted);
  held = absl::CancelledError();
  EXPECT_TRUE(store_->join(mesh("e"), {}, &waiter).ok());
  EXPECT_TRUE(waiter.wait().ok());
  EXPECT_EQ(store_->info(a).status().code(), Code::kNotFound);
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

TEST_F(SessionStoreTest, PinnedSessionsStay) {
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

TEST_F(SessionStoreTest, PinsLeaveRoomForOthers) {
  set_open(true);
  const std::string a = make_ready("a"), b = make_ready("b");
  ASSERT_TRUE(store_->update(a, true, std::nullopt).ok());
  EXPECT_TRUE(store_->update(a, true, std::nullopt).ok()) << "it is pinned already";
  EXPECT_EQ(store_->update(b, true, std::nullopt).status().code(), Code::kResourceExhausted);
  EXPECT_FALSE(store_->info(b)->pinned);
  ASSERT_TRUE(store_->update(a, false, std::nullopt).ok());
  EXPECT_TRUE(store_->update(b, true, std::nullopt).ok());
}

TEST_F(SessionStoreTest, TimeToLiveCountsFromTheLastUse) {
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

TEST_F(SessionStoreTest, EvictsWhatIsTooMuchTogether) {
  set_open(true);
  SessionStore store(
      queue_, [this](const MeshFile&, const PreprocessOptions&, const ExecutionContext& context) { return preprocess(context); },
      {.sessions = 10, .bytes = 100'000}, 1, make_logger(false, false));
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
