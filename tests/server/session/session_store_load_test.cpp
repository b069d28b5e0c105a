// Sessions that are in the cache only.
#include <gtest/gtest.h>

#include <future>

#include "tests/server/eventually.h"
#include "tests/server/server_fixture.h"
#include "tests/server/session/session_store_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

class SessionStoreLoad : public ::testing::Test {
 protected:
  void SetUp() override {
    open();
    Waiter waiter;
    const auto id = store_->join(files_, options_, &waiter);
    ASSERT_TRUE(id.ok()) << id.status();
    ASSERT_TRUE(waiter.wait().ok());
    id_ = *id;
    close();
    ASSERT_EQ(runs_, 1);
    open();
  }
  ~SessionStoreLoad() override { close(); }

  void open() {
    auto cache = SessionCache::open(folder_.path(), std::uint64_t{1} << 30, make_logger(false, false));
    ASSERT_TRUE(cache.ok()) << cache.status();
    cache_ = *std::move(cache);
    store_.emplace(
        queue_,
        [this](const MeshFile&, const PreprocessOptions& options, const ExecutionContext& context, const OnPreview&) {
          ++runs_;
          return curvecast::preprocess({"sphere.off", sphere_off(3)}, options, context);
        },
        SessionLimits{.sessions = 3}, 1, make_logger(false, false), SessionStore::Options{.cache = cache_.get()});
  }
  void close() {
    if (cache_ != nullptr) cache_->stop();
    store_.reset();
    cache_.reset();
  }

  const PreprocessOptions options_{.points = 200};
  const MeshFiles files_{std::make_shared<const Mesh>(MeshLabel{std::string(64, 'a')}, MeshBytes()), {}};
  testing::TemporaryFolder folder_;
  std::atomic<int> runs_ = 0;
  JobQueue queue_{{.max_waiting = 16}};
  std::unique_ptr<SessionCache> cache_;
  std::optional<SessionStore> store_;
  std::string id_;
};

// Who opens a stream of a cached session while somebody else, who has joined it, waits for it to be loaded.
TEST_F(SessionStoreLoad, WhatSomebodyIsLoadingIsThereForAll) {
  std::promise<void> gate;
  ASSERT_TRUE(cache_->loading(id_).submit([is_open = gate.get_future().share()] { is_open.wait(); }).ok());
  Waiter waiter;
  EXPECT_TRUE(store_->join(files_, options_, &waiter).ok());
  EXPECT_FALSE(waiter.done());
  EXPECT_TRUE(store_->must_load(id_));
  const auto found = store_->find(id_);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_TRUE(waiter.done()) << "who has joined it does not wait any longer either";
  EXPECT_FALSE(store_->must_load(id_));
  gate.set_value();
  const auto joined = waiter.wait(), again = store_->find(id_);
  ASSERT_TRUE(joined.ok() && again.ok()) << joined.status() << again.status();
  EXPECT_EQ(*joined, *found);
  EXPECT_EQ(*again, *found);
  EXPECT_EQ(runs_, 1);
}

// A job that was to load it and has to make it, because it is damaged.
TEST_F(SessionStoreLoad, WhatHasToBeMadeAfterAllIsBeingMade) {
  for (const std::string& name : folder_.names()) {
    if (name.ends_with(".curve")) testing::write_file(folder_ / name, "damaged");
  }
  std::promise<void> gate;
  ASSERT_TRUE(queue_.submit([is_open = gate.get_future().share()] { is_open.wait(); }).ok());
  Waiter waiter;
  EXPECT_TRUE(store_->join(files_, options_, &waiter).ok());
  EXPECT_TRUE(eventually([this] { return !store_->must_load(id_); }));
  EXPECT_EQ(store_->find(id_).status().code(), absl::StatusCode::kFailedPrecondition);
  gate.set_value();
  EXPECT_TRUE(waiter.wait().ok());
  EXPECT_EQ(runs_, 2);
}

}  // namespace
}  // namespace curvecast::server
