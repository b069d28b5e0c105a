#include "server/store/s3_store.h"

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include "tests/server/store/fake_s3.h"
#include "tests/server/store/store_contract.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

class S3StoreTest : public ::testing::Test {
 protected:
  std::unique_ptr<Store> store_of(const std::string& bucket, const std::string& prefix) {
    return *make_s3_store(bucket, prefix, fake_.environment(), FakeS3::options());
  }

  FakeS3 fake_;
  const TemporaryFolder folder_;
};

TEST_F(S3StoreTest, KeepsWhatStoresPromise) {
  const auto store = store_of("bucket", "a prefix/of ours");
  expect_store_contract(*store, {0, 1, 1000, 1001, 40'000});
  EXPECT_THAT(fake_.objects(), IsEmpty());
  EXPECT_EQ(fake_.uploads(), 0u);
}

TEST_F(S3StoreTest, PutsObjectsBelowItsPrefix) {
  write_file(folder_ / "file", "x");
  for (const char* prefix : {"", "/", "p", "p/", "//p/q//"}) {
    EXPECT_EQ(store_of("bucket", prefix)->put("meshes/a", folder_ / "file", nullptr), absl::OkStatus());
  }
  EXPECT_THAT(fake_.objects(), ElementsAre(Key("meshes/a"), Key("p/meshes/a"), Key("p/q/meshes/a")));
}

TEST_F(S3StoreTest, TakesNoMissingBucketForMissingFiles) {
  const auto store = store_of("no-such-bucket", "");
  write_file(folder_ / "file", "x");
  for (const absl::Status& status : {store->put("a", folder_ / "file", nullptr), store->get("a", folder_ / "to", nullptr),
                                     store->size("a", nullptr).status(), store->remove("a", nullptr)}) {
    EXPECT_TRUE(absl::IsPermissionDenied(status)) << status;
    EXPECT_THAT(status.message(), HasSubstr("s3://no-such-bucket/a"));
    EXPECT_THAT(status.message(), HasSubstr("there is no such bucket"));
  }
}

TEST_F(S3StoreTest, AsksForNothingBeforeItsFirstCall) {
  store_of("bucket", "p");
  EXPECT_EQ(fake_.connections(), 0);
}

TEST_F(S3StoreTest, KeepsItsConnections) {
  const auto store = store_of("bucket", "");
  for (int i = 0; i < 10; ++i) EXPECT_TRUE(absl::IsNotFound(store->size("a", nullptr).status()));
  EXPECT_EQ(fake_.connections(), 1);
}

TEST(MakeS3Store, RefusesWhatCannotBe) {
  const auto nothing = [](const std::string&) { return std::string(); };
  EXPECT_TRUE(absl::IsInvalidArgument(make_s3_store("No Bucket", "", nothing, {}).status()));
  for (const char* prefix : {"a//b", "a/../b", ".", "a\nb"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(make_s3_store("bucket", prefix, nothing, {}).status())) << prefix;
  }
  const absl::Status no_keys = make_s3_store("bucket", "p", nothing, {}).status();
  EXPECT_TRUE(absl::IsFailedPrecondition(no_keys)) << no_keys;
  EXPECT_THAT(no_keys.message(), HasSubstr("AWS_ACCESS_KEY_ID"));
}

TEST(OpenStore, KnowsS3) {
  ::setenv("AWS_ACCESS_KEY_ID", "A", 1);
  ::setenv("AWS_SECRET_ACCESS_KEY", "s", 1);
  for (const char* url : {"s3://bucket", "s3://bucket/", "s3://bucket/a/prefix"}) {
    EXPECT_EQ(open_store(url).status(), absl::OkStatus()) << url;
  }
  for (const char* url : {"s3://", "s3:///prefix", "s3:bucket", "s4://bucket"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(open_store(url).status())) << url;
  }
  ::unsetenv("AWS_ACCESS_KEY_ID");
  ::unsetenv("AWS_SECRET_ACCESS_KEY");
}

}  // namespace
}  // namespace curvecast::server
