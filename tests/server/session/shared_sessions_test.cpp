// Servers with a folder each and one store, as far as sessions go.
#include "server/session/shared_sessions.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "core/refine/refine.h"
#include "core/storage/curve_file.h"
#include "core/storage/surface_file.h"
#include "server/base/log.h"
#include "server/session/session_cache.h"
#include "tests/server/ball_session.h"
#include "tests/server/eventually.h"
#include "tests/server/store/fake_store.h"

namespace curvecast::server {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::EndsWith;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;
using Code = absl::StatusCode;

const std::string kId(32, 'a');

Session ball(const std::string& owner = "anna", const std::string& id = kId) {
  static const std::shared_ptr<Session> made = make_session(200);
  Session session = *made;
  session.id = id;
  session.owner = owner;
  session.surface = std::make_shared<SessionSurface>(made->preprocessed.flattened);
  return session;
}

/// A server's cache on a store that all share.
struct Replica {
  explicit Replica(const std::shared_ptr<FakeFiles>& files, const std::string& name = "fake://") : files_(files), name_(name) {
    restart();
  }
  void restart(std::uint64_t max_bytes = std::uint64_t{1} << 30) {
    cache.reset();
    store = std::make_unique<WatchedStore>(name_, std::make_unique<FakeStore>(files_), log, std::chrono::milliseconds(5),
                                           std::chrono::milliseconds(20));
    cache = SessionCache::open(folder.path(), max_bytes, log, store.get()).value();
  }
  /// Saves and waits until the store has it.
  void save(const Session& session) {
    cache->save(session);
    EXPECT_TRUE(eventually([&] { return cache->is_safe(session.id); }));
  }

  const std::shared_ptr<FakeFiles> files_;
  const std::string name_;
  TemporaryFolder folder;
  const std::shared_ptr<spdlog::logger> log = make_logger(false, false);
  std::unique_ptr<WatchedStore> store;
  std::unique_ptr<SessionCache> cache;
};

class SharedSessionsTest : public ::testing::Test {
 protected:
  static std::string name(const std::string& ending, const std::string& id = kId) {
    const std::uint32_t version = ending == "surface" ? kSurfaceFileVersion : kCurveFileVersion;
    return absl::StrCat("sessions/", id, ".v", version, ".", ending);
  }

  const std::shared_ptr<FakeFiles> files_ = std::make_shared<FakeFiles>();
  Replica a_{files_}, b_{files_};
};

TEST_F(SharedSessionsTest, OneServersSessionIsAnothers) {
  a_.save(ball());
  EXPECT_FALSE(b_.cache->holds(kId));
  EXPECT_TRUE(b_.cache->may_fetch(kId));
  const auto loaded = b_.cache->load(kId);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ((*loaded)->curve()->x, ball().curve()->x);
  EXPECT_EQ((*loaded)->owner, "anna");
  EXPECT_TRUE(b_.cache->holds(kId));
  EXPECT_TRUE(b_.cache->is_safe(kId)) << "it came from there";
  EXPECT_THAT(b_.folder.names(), Each(Not(EndsWith("curvecast-tmp"))));
  const int calls = files_->calls();
  EXPECT_TRUE(b_.cache->load(kId).ok());
  EXPECT_EQ(files_->calls(), calls) << "what is here is not asked for";
}

TEST_F(SharedSessionsTest, ManyWhoWantTheSameWaitForOne) {
  a_.save(ball());
  std::vector<std::thread> threads;
  const int before = files_->calls();
  for (int i = 0; i < 8; ++i) threads.emplace_back([&] { EXPECT_TRUE(b_.cache->fetch(kId).ok()); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_LE(files_->calls() - before, 10) << "as many as one needs";
}

TEST_F(SharedSessionsTest, WhatIsNotThereIsNotAskedForAgainAtOnce) {
  EXPECT_EQ(b_.cache->load(kId).status().code(), Code::kNotFound);
  EXPECT_FALSE(b_.cache->may_fetch(kId));
  const int calls = files_->calls();
  EXPECT_EQ(b_.cache->fetch(kId).code(), Code::kNotFound);
  EXPECT_EQ(files_->calls(), calls);
  EXPECT_TRUE(eventually([&] { return b_.cache->may_fetch(kId); }));
  for (const std::string& id : {std::string("../x"), std::string(), std::string(32, 'g')}) {
    EXPECT_EQ(b_.cache->fetch(id).code(), Code::kNotFound);
    EXPECT_FALSE(b_.cache->may_fetch(id));
  }
}

TEST_F(SharedSessionsTest, WhatCannotBePutIsPutWhenTheStoreIsBack) {
  files_->fail(absl::UnavailableError("no route"));
  a_.cache->save(ball());
  EXPECT_TRUE(eventually([&] { return a_.cache->holds(kId) && a_.cache->unstored() == 1; }));
  EXPECT_FALSE(a_.cache->is_safe(kId));
  EXPECT_EQ(b_.cache->load(kId).status().code(), Code::kUnavailable) << "nobody can tell whether it is there";
  EXPECT_TRUE(a_.cache->load(kId).ok()) << "what is here goes on";
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return a_.cache->is_safe(kId); }));
  EXPECT_EQ(a_.cache->unstored(), 0u);
  EXPECT_TRUE(eventually([&] { return b_.cache->load(kId).ok(); }));
}

TEST_F(SharedSessionsTest, WhatAKilledServerHadNotPutTheNextOnePuts) {
  files_->fail(absl::UnavailableError("no route"));
  a_.cache->save(ball());
  EXPECT_TRUE(eventually([&] { return a_.cache->unstored() == 1; }));
  a_.cache->stop();
  EXPECT_THAT(files_->names(), IsEmpty());
  files_->fail(absl::OkStatus());
  a_.restart();
  EXPECT_TRUE(eventually([&] { return a_.cache->is_safe(kId); }));
  EXPECT_TRUE(b_.cache->load(kId).ok());
  const int calls = files_->calls();
  a_.restart();
  EXPECT_EQ(a_.cache->unstored(), 0u) << "once";
  EXPECT_EQ(files_->calls(), calls) << "a start asks the store for nothing";
}

TEST_F(SharedSessionsTest, AnotherStoreGetsWhatTheFirstOneHas) {
  a_.save(ball());
  const auto other_files = std::make_shared<FakeFiles>();
  const auto other = std::make_unique<WatchedStore>("other://", std::make_unique<FakeStore>(other_files), a_.log);
  a_.cache.reset();
  const auto cache = SessionCache::open(a_.folder.path(), std::uint64_t{1} << 30, a_.log, other.get()).value();
  EXPECT_TRUE(eventually([&] { return cache->is_safe(kId); }));
  EXPECT_THAT(other_files->names(), Contains(name("curve")));
}

TEST_F(SharedSessionsTest, WhatLeavesTheFolderStaysInTheStore) {
  a_.save(ball());
  a_.restart();
  const std::uint64_t one = a_.cache->used_bytes();
  a_.restart(one + one / 2);
  a_.save(ball("anna", std::string(32, 'b')));
  EXPECT_TRUE(eventually([&] { return !a_.cache->holds(kId); })) << "it makes room";
  EXPECT_THAT(files_->names(), Contains(name("curve")));
  EXPECT_TRUE(a_.cache->load(kId).ok());
}

TEST_F(SharedSessionsTest, WhatIsNotInTheStoreDoesNotLeaveTheFolder) {
  const std::string second(32, 'b'), third(32, 'c');
  a_.save(ball());
  a_.restart();
  const std::uint64_t one = a_.cache->used_bytes();
  a_.restart(one + one / 2);
  files_->fail(absl::UnavailableError("no route"));
  a_.cache->save(ball("anna", second));
  EXPECT_TRUE(eventually([&] { return !a_.cache->holds(kId); })) << "it is in the store";
  a_.cache->save(ball("anna", third));
  EXPECT_TRUE(eventually([&] { return a_.cache->holds(third) && a_.cache->unsaved() == 0; }));
  EXPECT_TRUE(a_.cache->holds(second)) << "there is no other one of it";
}

TEST_F(SharedSessionsTest, ClosedByOneServerIsClosedForAll) {
  a_.save(ball());
  ASSERT_TRUE(b_.cache->load(kId).ok());
  ASSERT_TRUE(a_.cache->close_for_all(kId).ok());
  EXPECT_TRUE(a_.cache->remove(kId));
  EXPECT_THAT(files_->names(), ::testing::ElementsAre(absl::StrCat("sessions/", kId, ".closed")));
  b_.cache->save(ball());  // it has it still, and a finer curve
  EXPECT_TRUE(eventually([&] { return b_.cache->unsaved() == 0 && b_.cache->unstored() == 0; }));
  EXPECT_TRUE(eventually([&] {
    b_.cache->watch({kId}, std::chrono::seconds(0));
    return b_.cache->is_closed(kId);
  }));
  EXPECT_FALSE(b_.cache->holds(kId));
  EXPECT_THAT(files_->names(), ::testing::ElementsAre(absl::StrCat("sessions/", kId, ".closed"))) << "nobody puts it back";
  Replica c(files_);
  EXPECT_EQ(c.cache->load(kId).status().code(), Code::kNotFound);
}

TEST_F(SharedSessionsTest, IsNotClosedWhileTheStoreIsAway) {
  a_.save(ball());
  files_->fail(absl::UnavailableError("no route"));
  EXPECT_EQ(a_.cache->close_for_all(kId).code(), Code::kUnavailable);
  EXPECT_TRUE(a_.cache->holds(kId)) << "nothing has changed";
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return a_.cache->close_for_all(kId).ok(); }));
}

TEST_F(SharedSessionsTest, AskedForAnewItIsThereAgain) {
  a_.save(ball());
  ASSERT_TRUE(a_.cache->close_for_all(kId).ok());
  a_.cache->remove(kId);
  // At another server, which finds out that it was closed.
  b_.cache->reopen(kId);
  EXPECT_EQ(b_.cache->load(kId).status().code(), Code::kNotFound);
  EXPECT_THAT(files_->names(), IsEmpty());
  b_.save(ball("berta"));
  // And at the one that closed it, with the store away when it was asked for.
  EXPECT_TRUE(eventually([&] { return a_.cache->load(kId).ok(); }));
  EXPECT_EQ(a_.cache->owner(kId).value_or(""), "berta");
  ASSERT_TRUE(a_.cache->close_for_all(kId).ok());
  a_.cache->remove(kId);
  files_->fail(absl::UnavailableError("no route"));
  a_.cache->reopen(kId);
  a_.cache->save(ball("anna"));
  EXPECT_TRUE(eventually([&] { return a_.cache->unstored() == 1; }));
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return a_.cache->is_safe(kId); }));
  EXPECT_THAT(files_->names(), Contains(name("curve")));
  EXPECT_THAT(files_->names(), Not(Contains(EndsWith(".closed"))));
}

TEST_F(SharedSessionsTest, WhoWasFirstOwnsIt) {
  a_.save(ball("anna"));
  b_.save(ball("berta"));  // made it as well, before it could know
  EXPECT_EQ(b_.cache->owner(kId).value_or(""), "anna");
  EXPECT_EQ(a_.cache->owner(kId).value_or(""), "anna");
}

/// A ball whose curve was refined for so many points.
Session refined_ball(std::uint64_t points) {
  Session session = ball();
  session.revisions = std::make_shared<CurveRevisions>();
  session.revisions->publish(ball().curve());
  const std::vector<CurveDemand> demands = {{.points = points}};
  session.revisions->publish(refine(*session.curve_base().value(), *session.curve(), demands, {}, {}).value().curve);
  return session;
}

TEST_F(SharedSessionsTest, ARefinementDoesNotGetTheCurveAgain) {
  a_.save(ball());
  const int before = files_->gets();
  a_.save(refined_ball(1000));
  a_.save(refined_ball(4000));
  EXPECT_THAT(files_->names(), Contains(name("refined")));
  EXPECT_EQ(files_->gets(), before);
  ASSERT_TRUE(b_.cache->load(kId).ok());
  const int got = files_->gets();
  b_.save(refined_ball(16'000));
  EXPECT_EQ(files_->gets(), got) << "it came from there";
}

TEST_F(SharedSessionsTest, TheGreaterCurveStays) {
  const Session small = refined_ball(1000), great = refined_ball(4000);
  ASSERT_LT(small.curve()->size(), great.curve()->size());
  b_.save(great);
  a_.save(small);
  EXPECT_EQ(Replica(files_).cache->load(kId).value()->curve()->size(), great.curve()->size());
}

TEST_F(SharedSessionsTest, WhatIsDamagedInTheStoreIsRemovedThere) {
  a_.save(ball());
  const FakeFiles::Files good = files_->get();
  const std::string other(32, 'b');
  a_.save(ball("anna", other));
  for (const char* const ending : {"curve", "surface"}) {
    const std::string bytes = good.at(name(ending));
    std::string flipped = bytes;
    flipped[bytes.size() / 2] ^= 1;
    for (const std::string& bad :
         {bytes.substr(0, bytes.size() / 2), flipped, std::string(), files_->get().at(name(ending, other))}) {
      for (const auto& [file, content] : good) files_->set(file, content);
      files_->set(name(ending), bad);
      const Replica fresh(files_);
      const absl::Status status = fresh.cache->load(kId).status();
      EXPECT_TRUE(absl::IsNotFound(status) || absl::IsDataLoss(status)) << status;
      EXPECT_FALSE(fresh.cache->holds(kId)) << "it is to be made anew";
      EXPECT_THAT(files_->names(), Each(Not(::testing::StartsWith("sessions/" + kId)))) << ending;
    }
  }
  EXPECT_TRUE(b_.cache->load(other).ok());
}

TEST_F(SharedSessionsTest, WhatIsDamagedHereIsGotFromTheStore) {
  a_.save(ball());
  for (const std::string& file : a_.folder.names()) {
    if (!file.ends_with(".curve") && !file.ends_with(".surface")) continue;
    testing::write_file(a_.folder / file, testing::bytes_of(a_.folder / file).substr(0, 1000));
    const auto loaded = a_.cache->load(kId);
    ASSERT_TRUE(loaded.ok()) << file << loaded.status();
    EXPECT_EQ((*loaded)->curve()->x, ball().curve()->x);
    EXPECT_THAT(files_->names(), Contains(name("curve")));
  }
}

TEST_F(SharedSessionsTest, AStuckStoreHoldsNobodyUpAtTheEnd) {
  a_.save(ball());
  files_->hang(true);
  const int calls = files_->calls();
  std::thread caller([&] { EXPECT_EQ(b_.cache->load(kId).status().code(), Code::kUnavailable); });
  EXPECT_TRUE(eventually([&] { return files_->calls() > calls; }));
  b_.store->end();
  caller.join();
  b_.cache->stop();
  files_->hang(false);
}

}  // namespace
}  // namespace curvecast::server
