#include "server/store/s3_client.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "tests/server/store/fake_s3.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::HasSubstr;
using ::testing::Not;
using End = HttpServer::End;

class S3ClientTest : public ::testing::Test {
 protected:
  S3ClientTest() { fake_.set_object("a/b", {.bytes = "what there is", .sha256 = ""}); }

  std::unique_ptr<S3Client> client_of(const Environment& environment, const S3Options& options = FakeS3::options()) {
    return std::make_unique<S3Client>("bucket", fake_.endpoint(), *S3KeySource::open(environment), options);
  }
  /// The next requests end in these ways, one each.
  void fail_with(std::vector<FakeS3::Reply> replies) {
    auto rest = std::make_shared<std::vector<FakeS3::Reply>>(replies.rbegin(), replies.rend());
    fake_.set_fault([rest](const FakeS3::Request&) -> std::optional<FakeS3::Reply> {
      if (rest->empty()) return std::nullopt;
      FakeS3::Reply reply = rest->back();
      rest->pop_back();
      return reply;
    });
  }
  absl::Status get() { return client_->send(get_, minute_).status(); }

  FakeS3 fake_;
  const S3Request get_{.method = "GET", .key = "a/b"};
  const Deadline minute_{std::chrono::minutes(1), nullptr};
  std::unique_ptr<S3Client> client_ = client_of(fake_.environment());
};

TEST_F(S3ClientTest, SignsARequest) {
  const auto response = client_->send(get_, minute_);
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(response->body, "what there is");
  const FakeS3::Request request = fake_.requests().front();
  EXPECT_THAT(request.header("authorization"),
              HasSubstr("/us-east-1/s3/aws4_request, SignedHeaders=host;x-amz-content-sha256;x-amz-date,"));
  EXPECT_EQ(request.header("x-amz-security-token"), "");
}

TEST_F(S3ClientTest, EncodesKeys) {
  fake_.set_object("a b/c+d/\xc3\xa9%", {.bytes = "x", .sha256 = ""});
  EXPECT_EQ(client_->send({.method = "GET", .key = "a b/c+d/\xc3\xa9%"}, minute_).status(), absl::OkStatus());
  EXPECT_EQ(fake_.requests().front().path, "/bucket/a%20b/c%2Bd/%C3%A9%25");
}

TEST_F(S3ClientTest, TriesAgainWhatMayPass) {
  fail_with({FakeS3::error(503, "SlowDown"), {.status = 500}, {.end = End::kReset}});
  EXPECT_EQ(get(), absl::OkStatus());
  EXPECT_EQ(fake_.requests().size(), 4u);
}

TEST_F(S3ClientTest, GivesUpAfterItsTries) {
  fail_with(std::vector<FakeS3::Reply>(100, FakeS3::error(503, "SlowDown")));
  const absl::Status status = get();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("s3://bucket/a/b: GET: HTTP 503 SlowDown"));
  EXPECT_EQ(fake_.requests().size(), 4u);
}

TEST_F(S3ClientTest, DoesNotTryAgainWhatDoesNotPass) {
  fail_with({FakeS3::error(403, "AccessDenied"), FakeS3::error(404, "NoSuchKey")});
  EXPECT_TRUE(absl::IsPermissionDenied(get()));
  EXPECT_TRUE(absl::IsNotFound(get()));
  EXPECT_EQ(fake_.requests().size(), 2u);
}

TEST_F(S3ClientTest, HasNoMoreTimeThanItsDeadline) {
  fail_with(std::vector<FakeS3::Reply>(100, FakeS3::Reply{.end = End::kHang}));
  S3Options options = FakeS3::options();
  options.http.stall_timeout = std::chrono::seconds(1000);
  const auto client = client_of(fake_.environment(), options);
  const auto begin = std::chrono::steady_clock::now();
  const absl::Status status = client->send(get_, Deadline(std::chrono::seconds(1), nullptr)).status();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("longer than 1 s"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST_F(S3ClientTest, IsCancelledWhateverItWaitsFor) {
  for (const FakeS3::Reply& reply : {FakeS3::Reply{.end = End::kHang}, FakeS3::error(503, "SlowDown")}) {
    fail_with(std::vector<FakeS3::Reply>(100, reply));
    S3Options options = FakeS3::options();
    options.http.stall_timeout = std::chrono::seconds(1000);
    options.first_wait = options.longest_wait = std::chrono::hours(1);
    const auto client = client_of(fake_.environment(), options);
    std::atomic<bool> cancel = false;
    std::thread canceller([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      cancel = true;
    });
    EXPECT_TRUE(absl::IsCancelled(client->send(get_, Deadline(std::chrono::hours(1), &cancel)).status()));
    canceller.join();
  }
}

TEST_F(S3ClientTest, TakesNewKeysWhenTheOldOnesAreRefused) {
  const TemporaryFolder folder;
  const auto put = [&](const std::string& key) {
    write_file(folder / "credentials", absl::StrCat("[default]\naws_access_key_id=", key,
                                                    "\naws_secret_access_key=hush-hush\naws_session_token=T", key, "\n"));
  };
  put("OLD");
  fake_.set_access_key("OLD");
  const auto client = client_of([&](const std::string& name) -> std::string {
    return name == "AWS_SHARED_CREDENTIALS_FILE" ? folder / "credentials" : "";
  });
  EXPECT_EQ(client->send(get_, minute_).status(), absl::OkStatus());
  EXPECT_EQ(fake_.requests().back().header("x-amz-security-token"), "TOLD");
  EXPECT_THAT(fake_.requests().back().header("authorization"), HasSubstr(";x-amz-security-token,"));
  fake_.set_access_key("NEW");
  const absl::Status refused = client->send(get_, minute_).status();
  EXPECT_TRUE(absl::IsPermissionDenied(refused)) << refused;
  for (const char* secret : {"hush-hush", "OLD"}) EXPECT_THAT(refused.message(), Not(HasSubstr(secret)));
  const auto time = std::filesystem::last_write_time(folder / "credentials");
  put("NEW");
  std::filesystem::last_write_time(folder / "credentials", time);  // as if the clock were too coarse
  EXPECT_EQ(client->send(get_, minute_).status(), absl::OkStatus());
}

TEST_F(S3ClientTest, NeverSendsTheSecret) {
  EXPECT_EQ(get(), absl::OkStatus());
  const FakeS3::Request request = fake_.requests().front();
  for (const auto& [name, value] : request.headers) EXPECT_THAT(value, Not(HasSubstr("hush-hush"))) << name;
}

TEST(S3Retry, WaitsLongerEachTimeUntilReset) {
  using Clock = std::chrono::steady_clock;
  const S3Options options{
      .tries = 6, .first_wait = std::chrono::milliseconds(40), .longest_wait = std::chrono::milliseconds(160)};
  const Deadline deadline(std::chrono::minutes(1), nullptr);
  S3Retry retry(options, deadline);
  const absl::Status failure = absl::UnavailableError("away");
  for (const int most : {40, 80, 160, 160, 160}) {
    const auto begin = Clock::now();
    EXPECT_EQ(retry.after(failure), absl::OkStatus());
    EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(most / 2));
  }
  EXPECT_EQ(retry.after(failure), failure);
  retry.reset();
  EXPECT_EQ(retry.after(failure), absl::OkStatus());
  EXPECT_EQ(retry.after(absl::NotFoundError("none")), absl::NotFoundError("none"));
}

}  // namespace
}  // namespace curvecast::server
