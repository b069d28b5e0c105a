#include "server/store/s3_download.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "server/base/hash.h"
#include "tests/server/store/fake_s3.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::bytes_of;
using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using End = HttpServer::End;
using Reply = FakeS3::Reply;
using Request = FakeS3::Request;

class S3DownloadTest : public ::testing::Test {
 protected:
  void store(const std::string& bytes) {
    Hasher hasher;
    hasher.update(bytes);
    fake_.set_object("key", {.bytes = bytes, .sha256 = hasher.sha256()});
  }
  absl::Status get() {
    Deadline deadline(std::chrono::minutes(1), nullptr);
    return get_s3_object(client_, "key", folder_ / "file", deadline);
  }
  /// The first `count` answers to whole objects break off in the middle.
  void cut(int count, const std::string& bytes, const std::string& etag = "\"first\"") {
    auto left = std::make_shared<int>(count);
    fake_.set_fault([=](const Request&) -> std::optional<Reply> {
      if (--*left < 0) return std::nullopt;
      return Reply{.headers = {{"ETag", etag}}, .body = bytes, .end = End::kCut};
    });
  }

  const TemporaryFolder folder_;
  FakeS3 fake_;
  S3Client client_{"bucket", fake_.endpoint(), *S3KeySource::open(fake_.environment()), FakeS3::options()};
};

TEST_F(S3DownloadTest, GetsWhatIsThere) {
  for (const std::size_t size : {0, 1, 1000, 3'000'000}) {
    const std::string bytes = some_bytes(size);
    store(bytes);
    ASSERT_EQ(get(), absl::OkStatus()) << size;
    EXPECT_TRUE(bytes_of(folder_ / "file") == bytes) << size;
  }
  EXPECT_THAT(folder_.names(), ElementsAre("file"));
}

TEST_F(S3DownloadTest, IsNotFoundWhereThereIsNone) {
  const absl::Status status = get();
  EXPECT_TRUE(absl::IsNotFound(status)) << status;
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(S3DownloadTest, GoesOnWhereAConnectionBroke) {
  const std::string bytes = some_bytes(3'000'000);
  store(bytes);
  // Every answer breaks off in the middle of what is left: more of them than there are tries, and each brings something.
  const std::string etag = "\"first\"";
  int answers = 0;
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    const std::string range = request.header("range");
    const std::size_t from = range.empty() ? 0 : std::stoul(range.substr(6));
    if (++answers > 8) return std::nullopt;
    if (range.empty()) {
      return Reply{.headers = {{"ETag", etag}}, .body = bytes, .end = End::kCut};
    }
    EXPECT_EQ(request.header("if-match"), etag);
    return Reply{.status = 206,
                 .headers = {{"ETag", etag}, {"Content-Range", "bytes " + std::to_string(from) + "-2999999/3000000"}},
                 .body = bytes.substr(from),
                 .end = answers < 8 ? End::kCut : End::kKeep};
  });
  ASSERT_EQ(get(), absl::OkStatus());
  EXPECT_TRUE(bytes_of(folder_ / "file") == bytes);
  EXPECT_EQ(answers, 8);
}

TEST_F(S3DownloadTest, BeginsAgainWhereTheObjectIsAnotherOneMeanwhile) {
  const std::string bytes = some_bytes(3'000'000, 2);
  store(bytes);
  cut(1, some_bytes(2'000'000, 1));
  ASSERT_EQ(get(), absl::OkStatus());
  EXPECT_TRUE(bytes_of(folder_ / "file") == bytes);
}

TEST_F(S3DownloadTest, BeginsAgainWhereAStoreKnowsNoRanges) {
  const std::string bytes = some_bytes(3'000'000);
  store(bytes);
  int answers = 0;
  fake_.set_fault([&](const Request&) {
    return Reply{.headers = {{"ETag", "\"same\""}}, .body = bytes, .end = ++answers == 1 ? End::kCut : End::kKeep};
  });
  ASSERT_EQ(get(), absl::OkStatus());
  EXPECT_TRUE(bytes_of(folder_ / "file") == bytes);
}

TEST_F(S3DownloadTest, NoticesWrongBytesOnTheWay) {
  const std::string bytes = some_bytes(100'000);
  store(bytes);
  const std::string sha256 = fake_.objects().at("key").sha256;
  int answers = 0;
  fake_.set_fault([&](const Request&) -> std::optional<Reply> {
    if (++answers > 1) return std::nullopt;
    std::string wrong = bytes;
    wrong[777] ^= 1;
    return Reply{.headers = {{"ETag", "\"x\""}, {"x-amz-meta-sha256", sha256}}, .body = wrong};
  });
  ASSERT_EQ(get(), absl::OkStatus());
  EXPECT_TRUE(bytes_of(folder_ / "file") == bytes);
}

TEST_F(S3DownloadTest, IsDataLossWhereTheStoreHasOtherBytes) {
  write_file(folder_ / "file", "old");
  store("what was put");
  fake_.set_object("key", {.bytes = "what was puT", .sha256 = fake_.objects().at("key").sha256});
  const absl::Status status = get();
  EXPECT_TRUE(absl::IsDataLoss(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("s3://bucket/key"));
  EXPECT_EQ(bytes_of(folder_ / "file"), "old");
  EXPECT_THAT(folder_.names(), ElementsAre("file"));
}

TEST_F(S3DownloadTest, TakesAnObjectThatSaysNothingOfItself) {
  fake_.set_object("key", {.bytes = "copied by another program", .sha256 = ""});
  ASSERT_EQ(get(), absl::OkStatus());
  EXPECT_EQ(bytes_of(folder_ / "file"), "copied by another program");
}

TEST_F(S3DownloadTest, BelievesNobodyElsesSuccess) {
  fake_.set_fault([](const Request&) { return Reply{.body = "<html>Please log in</html>"}; });
  const absl::Status status = get();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(S3DownloadTest, GivesUpWhereNothingComes) {
  store("what there is");
  for (const End end : {End::kStall, End::kHang, End::kReset}) {
    fake_.set_fault([end](const Request&) { return Reply{.headers = {{"ETag", "\"x\""}}, .body = "what", .end = end}; });
    const auto begin = std::chrono::steady_clock::now();
    const absl::Status status = get();
    EXPECT_TRUE(absl::IsUnavailable(status)) << status;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
  }
  EXPECT_THAT(folder_.names(), IsEmpty());
}

TEST_F(S3DownloadTest, IsUnavailableWhereItCannotWrite) {
  store("what there is");
  Deadline deadline(std::chrono::minutes(1), nullptr);
  const absl::Status status = get_s3_object(client_, "key", folder_ / "missing/file", deadline);
  EXPECT_TRUE(absl::IsUnavailable(status)) << "NotFound would be the store's: " << status;
}

TEST_F(S3DownloadTest, IsCancelled) {
  store("what there is");
  fake_.set_fault([](const Request&) { return Reply{.headers = {{"ETag", "\"x\""}}, .body = "what", .end = End::kHang}; });
  const std::atomic<bool> cancel = true;
  Deadline deadline(std::chrono::hours(1), &cancel);
  EXPECT_TRUE(absl::IsCancelled(get_s3_object(client_, "key", folder_ / "file", deadline)));
}

}  // namespace
}  // namespace curvecast::server
