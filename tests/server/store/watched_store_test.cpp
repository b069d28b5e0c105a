#include "server/store/watched_store.h"

#include <gmock/gmock.h>

#include <future>
#include <map>
#include <mutex>
#include <utility>

#include "server/base/log.h"
#include "tests/server/eventually.h"
#include "tests/server/store/fake_store.h"

namespace curvecast::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using Code = absl::StatusCode;

class WatchedStoreTest : public ::testing::Test {
 protected:
  const std::shared_ptr<FakeFiles> files_ = std::make_shared<FakeFiles>();
  WatchedStore store_{"fake://", std::make_unique<FakeStore>(files_), make_logger(false, false), milliseconds(20),
                      milliseconds(40)};
  const testing::TemporaryFolder folder_;
};

TEST_F(WatchedStoreTest, CountsCalls) {
  std::mutex mutex;
  std::map<std::pair<std::string, std::string>, int> counts;
  store_.observe([&](std::string_view operation, std::string_view result, double seconds) {
    const std::lock_guard lock(mutex);
    EXPECT_GE(seconds, 0);
    ++counts[{std::string(operation), std::string(result)}];
  });
  testing::write_file(folder_ / "a", "abc");
  EXPECT_TRUE(store_.put("a", folder_ / "a", nullptr).ok());
  EXPECT_EQ(store_.size("a", nullptr).value_or(0), 3u);
  EXPECT_EQ(store_.size("b", nullptr).status().code(), Code::kNotFound);
  EXPECT_TRUE(store_.get("a", folder_ / "b", nullptr).ok());
  EXPECT_TRUE(store_.remove("a", nullptr).ok());
  files_->fail(absl::PermissionDeniedError("no"));
  EXPECT_EQ(store_.get("a", folder_ / "b", nullptr).code(), Code::kPermissionDenied);
  store_.observe({});
  store_.size("b", nullptr).IgnoreError();
  const std::map<std::pair<std::string, std::string>, int> expected = {{{"put", "ok"}, 1},         {{"size", "ok"}, 1},
                                                                       {{"size", "not_found"}, 1}, {{"get", "ok"}, 1},
                                                                       {{"remove", "ok"}, 1},      {{"get", "error"}, 1}};
  EXPECT_EQ(counts, expected);
}

TEST_F(WatchedStoreTest, IsLeftInPeaceWhileItIsAway) {
  files_->fail(absl::UnavailableError("no route"));
  EXPECT_TRUE(store_.state().ok()) << "nobody knows yet";
  EXPECT_EQ(store_.size("a", nullptr).status().code(), Code::kUnavailable);
  const absl::Status state = store_.state();
  EXPECT_EQ(state.code(), Code::kUnavailable);
  EXPECT_THAT(state.message(), HasSubstr("no route"));
  files_->hang(true);  // callers are answered, though nobody answers
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(store_.size("a", nullptr).status().code(), Code::kUnavailable);
  EXPECT_LE(files_->calls(), 3);
  files_->hang(false);
  files_->fail(absl::OkStatus());
  EXPECT_TRUE(eventually([&] { return store_.state().ok(); })) << "without being called";
  EXPECT_EQ(store_.size("a", nullptr).status().code(), Code::kNotFound);
}

TEST_F(WatchedStoreTest, AFullStoreIsNotAway) {
  files_->fail(absl::ResourceExhaustedError("full"));
  EXPECT_EQ(store_.remove("a", nullptr).code(), Code::kResourceExhausted);
  EXPECT_TRUE(store_.state().ok());
}

TEST_F(WatchedStoreTest, EndsCallsThatNeedNotGoOn) {
  files_->hang(true);
  auto call = std::async(std::launch::async, [&] { return store_.size("a", store_.ending()).status(); });
  EXPECT_TRUE(eventually([&] { return files_->calls() > 0; }));
  store_.end();
  EXPECT_EQ(call.get().code(), Code::kCancelled);
  EXPECT_TRUE(store_.state().ok()) << "that tells nothing of the store";
}

}  // namespace
}  // namespace curvecast::server
