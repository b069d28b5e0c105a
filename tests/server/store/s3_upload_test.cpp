#include "server/store/s3_upload.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/server/store/fake_s3.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::HasSubstr;
using Reply = FakeS3::Reply;
using Request = FakeS3::Request;

bool is_begin(const Request& request) { return request.query == "uploads="; }
bool is_part(const Request& request, int part) { return absl::StartsWith(request.query, absl::StrCat("partNumber=", part, "&")); }
bool is_complete(const Request& request) { return request.method == "POST" && absl::StartsWith(request.query, "uploadId="); }

class S3UploadTest : public ::testing::Test {
 protected:
  ~S3UploadTest() override {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  S3File file_of(const std::string& bytes, std::uint64_t part_size = 1000) {
    write_file(folder_ / "file", bytes);
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = ::open((folder_ / "file").c_str(), O_RDONLY);
    return *read_s3_file(descriptor_, bytes.size(), part_size, minute_);
  }
  absl::Status put(const std::string& bytes) { return upload_.put("key", file_of(bytes), minute_); }
  std::string stored() {
    const auto objects = fake_.objects();
    return objects.contains("key") ? objects.at("key").bytes : "(none)";
  }

  const TemporaryFolder folder_;
  int descriptor_ = -1;
  FakeS3 fake_;
  const Deadline minute_{std::chrono::minutes(1), nullptr};
  S3Client client_{"bucket", fake_.endpoint(), *S3KeySource::open(fake_.environment()), FakeS3::options()};
  S3Upload upload_{client_};
};

TEST_F(S3UploadTest, PutsSmallFilesInOneRequestAndLargeOnesInParts) {
  for (const std::size_t size : {0, 1, 999, 1000, 1001, 2000, 5500}) {
    const std::string bytes = some_bytes(size);
    const std::size_t before = fake_.requests().size();
    ASSERT_EQ(put(bytes), absl::OkStatus()) << size;
    EXPECT_TRUE(stored() == bytes) << size;
    EXPECT_EQ(fake_.objects().at("key").sha256, file_of(bytes).sha256);
    const std::size_t parts = (size + 999) / 1000;
    EXPECT_EQ(fake_.requests().size() - before, parts <= 1 ? 1 : parts + 2);
  }
  EXPECT_EQ(fake_.uploads(), 0u);
}

TEST_F(S3UploadTest, HashesTheWholeAndEachPart) {
  const S3File file = file_of("abcd", 3);
  EXPECT_EQ(file.sha256, "88d4266fd4e6338d13b845fcf289579d209c897823b9217da3e161936f031589");  // printf abcd | sha256sum
  EXPECT_THAT(file.parts, ::testing::ElementsAre("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
                                                 "18ac3e7343f016890c510e93f935261169d9e3f565436429830faf0934f4f8e4"));
}

TEST_F(S3UploadTest, HasNoMorePartsThanS3Takes) {
  const S3File file = file_of(some_bytes(25'000), 1);
  EXPECT_EQ(file.part_size, 3u);
  EXPECT_EQ(file.parts.size(), 8334u);
  EXPECT_EQ(file_of(some_bytes(10'000), 1).parts.size(), 10'000u);
}

TEST_F(S3UploadTest, IsUnavailableWhereTheFileIsShorterThanItWas) {
  file_of("abcd");
  EXPECT_TRUE(absl::IsUnavailable(read_s3_file(descriptor_, 5, 1000, minute_).status()));
  EXPECT_TRUE(absl::IsUnavailable(read_s3_file(-1, 5, 1000, minute_).status()));
  const std::atomic<bool> cancel = true;
  EXPECT_TRUE(absl::IsCancelled(read_s3_file(descriptor_, 4, 1000, Deadline(std::chrono::hours(1), &cancel)).status()));
}

TEST_F(S3UploadTest, RefusesBytesThatHaveChangedSinceTheyWereHashed) {
  const S3File file = file_of(some_bytes(3000, 1));
  write_file(folder_ / "file", some_bytes(3000, 2));  // the same file, rewritten in place
  const absl::Status status = upload_.put("key", file, minute_);
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_EQ(stored(), "(none)");
  EXPECT_EQ(fake_.uploads(), 0u);
}

TEST_F(S3UploadTest, TriesAPartAgain) {
  int failures = 0;
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    if (!is_part(request, 2) || ++failures > 2) return std::nullopt;
    return failures == 1 ? FakeS3::error(503, "SlowDown") : Reply{.end = HttpServer::End::kReset};
  });
  const std::string bytes = some_bytes(3500);
  EXPECT_EQ(put(bytes), absl::OkStatus());
  EXPECT_TRUE(stored() == bytes);
}

TEST_F(S3UploadTest, LeavesWhatThereWasAndNoPartsWhereItFails) {
  ASSERT_EQ(put("old"), absl::OkStatus());
  const std::vector<std::function<bool(const Request&)>> steps = {is_begin, [](const Request& r) { return is_part(r, 1); },
                                                                  [](const Request& r) { return is_part(r, 3); }, is_complete};
  for (const auto& step : steps) {
    for (const Reply& reply : {FakeS3::error(503, "SlowDown"), FakeS3::error(403, "AccessDenied")}) {
      fake_.set_fault([&](const Request& request) { return step(request) ? std::optional(reply) : std::nullopt; });
      const absl::Status status = put(some_bytes(3500));
      EXPECT_EQ(status.code(), reply.status == 503 ? absl::StatusCode::kUnavailable : absl::StatusCode::kPermissionDenied)
          << status;
      EXPECT_THAT(status.message(), HasSubstr("s3://bucket/key"));
      EXPECT_EQ(stored(), "old");
      EXPECT_EQ(fake_.uploads(), 0u);
    }
  }
}

TEST_F(S3UploadTest, LeavesNoPartsWhenItIsCancelled) {
  std::atomic<bool> cancel = false;
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    if (is_part(request, 2)) cancel = true;
    return std::nullopt;
  });
  const Deadline deadline(std::chrono::hours(1), &cancel);
  EXPECT_TRUE(absl::IsCancelled(upload_.put("key", file_of(some_bytes(3500)), deadline)));
  EXPECT_EQ(stored(), "(none)");
  EXPECT_EQ(fake_.uploads(), 0u);
}

TEST_F(S3UploadTest, TakesPartsBackOnceTheStoreIsThereAgain) {
  fake_.set_fault([](const Request& request) { return is_begin(request) ? std::nullopt : std::optional(Reply{.status = 503}); });
  EXPECT_TRUE(absl::IsUnavailable(put(some_bytes(3500))));
  EXPECT_EQ(fake_.uploads(), 1u);
  fake_.set_fault({});
  EXPECT_EQ(put("small"), absl::OkStatus());
  EXPECT_EQ(fake_.uploads(), 0u);
}

TEST_F(S3UploadTest, IsDoneWhereOnlyTheLastAnswerIsLost) {
  // What S3 does with the request, and what its answer is, come from two connections here.
  bool is_lost = false;
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    if (!is_complete(request) || is_lost) return std::nullopt;
    is_lost = true;
    return Reply{.end = HttpServer::End::kReset};
  });
  const std::string bytes = some_bytes(3500);
  EXPECT_EQ(put(bytes), absl::OkStatus()) << "the second try";
  EXPECT_TRUE(stored() == bytes);

  const S3File file = file_of(some_bytes(3500, 2));
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    return is_complete(request) ? std::optional(FakeS3::error(404, "NoSuchUpload")) : std::nullopt;
  });
  EXPECT_TRUE(absl::IsUnavailable(upload_.put("key", file, minute_))) << "another object is there";
  fake_.set_object("key", {.bytes = some_bytes(3500, 2), .sha256 = file.sha256});
  EXPECT_EQ(upload_.put("key", file, minute_), absl::OkStatus()) << "the very object is there";
}

TEST_F(S3UploadTest, BelievesNoSuccessThatSaysItFailed) {
  Reply late = FakeS3::error(200, "InternalError");
  int failures = 0;
  fake_.set_fault([&](const Request& request) -> std::optional<Reply> {
    return is_complete(request) && ++failures <= 2 ? std::optional(late) : std::nullopt;
  });
  EXPECT_EQ(put(some_bytes(3500)), absl::OkStatus());
  EXPECT_EQ(failures, 3);
  failures = -1000;
  const absl::Status status = put(some_bytes(3500, 2));
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_TRUE(stored() == some_bytes(3500));
}

TEST_F(S3UploadTest, BelievesNobodyElsesSuccess) {
  const Reply page{.status = 200, .headers = {{"Content-Type", "text/html"}}, .body = "<html>Please log in</html>"};
  fake_.set_fault([&](const Request&) { return page; });
  EXPECT_TRUE(absl::IsUnavailable(put("small")));
  EXPECT_TRUE(absl::IsUnavailable(put(some_bytes(3500))));
  fake_.set_fault([&](const Request& request) { return is_begin(request) ? std::nullopt : std::optional(page); });
  EXPECT_TRUE(absl::IsUnavailable(put(some_bytes(3500))));
  fake_.set_fault([&](const Request& request) { return is_complete(request) ? std::optional(page) : std::nullopt; });
  EXPECT_TRUE(absl::IsUnavailable(put(some_bytes(3500))));
}

}  // namespace
}  // namespace curvecast::server
