#include "server/store/http_transfer.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "tests/server/store/http_server.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::HasSubstr;
using ::testing::Not;
using End = HttpServer::End;
using Reply = HttpServer::Reply;

// The keys of Amazon's examples.
const HttpSignature kSignature{
    .access_key = "AKIAIOSFODNN7EXAMPLE", .secret = "wJalrXUtnFEMI/K7MDENG/bPxRfiCYEXAMPLEKEY", .region = "us-east-1"};
constexpr char kEmptySha256[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

class HttpTransferTest : public ::testing::Test {
 protected:
  Reply answer(const HttpServer::Request& request) {
    const std::lock_guard lock(mutex_);
    requests_.push_back(request);
    return reply_;
  }
  void change_reply(const std::function<void(Reply& reply)>& change) {
    const std::lock_guard lock(mutex_);
    change(reply_);
  }
  HttpServer::Request last_request() {
    const std::lock_guard lock(mutex_);
    return requests_.back();
  }
  absl::Status status_of(const HttpRequest& request, const HttpHooks& hooks = {}) {
    return transfer_.run(request, hooks).status();
  }
  /// Of a request to the host of Amazon's examples at the time of these.
  std::string signature_of(HttpRequest request, const std::string& sha256 = kEmptySha256) {
    request.signature = &kSignature;
    request.url = server_.url() + request.url;
    request.headers.insert(request.headers.end(), {"host: examplebucket.s3.amazonaws.com", "x-amz-date: 20130524T000000Z",
                                                   "x-amz-content-sha256: " + sha256});
    EXPECT_EQ(status_of(request), absl::OkStatus());
    const std::string header = last_request().header("authorization");
    return header.substr(header.find("Signature=") + 10);
  }

  std::mutex mutex_;
  Reply reply_{.headers = {{"ETag", "\"x\""}}, .body = "what there is"};
  std::vector<HttpServer::Request> requests_;
  HttpServer server_{[this](const HttpServer::Request& request) { return answer(request); }};
  HttpTransfer transfer_{{.ca_bundle = "", .connect_timeout = std::chrono::seconds(5), .stall_timeout = std::chrono::seconds(1)}};
};

TEST_F(HttpTransferTest, ReturnsStatusHeadersAndBody) {
  const auto response = transfer_.run({.url = server_.url() + "/a/b?c=1&d="});
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(response->status, 200);
  EXPECT_EQ(response->header("etag"), "\"x\"");
  EXPECT_EQ(response->header("missing"), "");
  EXPECT_EQ(response->body, "what there is");
  EXPECT_EQ(last_request().method, "GET");
  EXPECT_EQ(last_request().path, "/a/b");
  EXPECT_EQ(last_request().query, "c=1&d=");
  EXPECT_EQ(last_request().header("authorization"), "");
}

TEST_F(HttpTransferTest, LeavesPathsAsTheyAre) {
  EXPECT_EQ(status_of({.url = server_.url() + "/a/../b/./%2F~%20"}), absl::OkStatus());
  EXPECT_EQ(last_request().path, "/a/../b/./%2F~%20");
}

TEST_F(HttpTransferTest, KeepsConnections) {
  for (const char* method : {"GET", "HEAD", "POST", "DELETE", "PUT", "GET"}) {
    EXPECT_EQ(status_of({.method = method, .url = server_.url() + "/"}), absl::OkStatus());
    EXPECT_EQ(last_request().method, method);
  }
  EXPECT_EQ(server_.connections(), 1);
}

TEST_F(HttpTransferTest, ConnectsAgainWhereAKeptConnectionIsClosed) {
  const TemporaryFolder folder;
  write_file(folder / "file", "bytes of a file");
  const int file = ::open((folder / "file").c_str(), O_RDONLY);
  change_reply([](Reply& reply) {
    reply.end = End::kCut;
    reply.body = "";  // so that the answer is whole
  });
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(status_of({.method = "PUT", .url = server_.url() + "/", .file = file, .size = 15}), absl::OkStatus());
    EXPECT_EQ(last_request().body, "bytes of a file");
  }
  ::close(file);
  EXPECT_EQ(server_.connections(), 3);
}

TEST_F(HttpTransferTest, SendsPartsOfFilesAndBodies) {
  const TemporaryFolder folder;
  std::string bytes(3'000'000, 'a');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 7);
  write_file(folder / "file", bytes);
  const int file = ::open((folder / "file").c_str(), O_RDONLY);
  const HttpRequest put{.method = "PUT", .url = server_.url() + "/", .file = file, .offset = 1000, .size = 2'500'000};
  EXPECT_EQ(status_of(put), absl::OkStatus());
  EXPECT_TRUE(last_request().body == bytes.substr(1000, 2'500'000));
  const HttpRequest too_long{.method = "PUT", .url = server_.url() + "/", .file = file, .offset = 1000, .size = bytes.size()};
  EXPECT_TRUE(absl::IsUnavailable(status_of(too_long))) << "the file is shorter than was said";
  ::close(file);
  const HttpRequest post{.method = "POST", .url = server_.url() + "/", .headers = {"content-type: text/x"}, .body = {"a\0b", 3}};
  EXPECT_EQ(status_of(post), absl::OkStatus());
  EXPECT_EQ(last_request().body, std::string("a\0b", 3));
  EXPECT_EQ(last_request().header("content-type"), "text/x");
}

// The examples of "Authenticating Requests: Using the Authorization Header (AWS Signature Version 4)" in Amazon's reference.
TEST_F(HttpTransferTest, SignsAsAmazonsExamplesAre) {
  EXPECT_EQ(signature_of({.url = "/test.txt", .headers = {"range: bytes=0-9"}}),
            "f0e8bdb87c964420e857bd35b5d6ed310bd44f0170aba48dd91039c6036bdb41");
  EXPECT_EQ(signature_of({.url = "/?lifecycle="}), "fea454ca298b7da1c68078a5d1bdbfbbe0d65c699e0f91ac7a200a0136783543");
  EXPECT_EQ(signature_of({.url = "/?max-keys=2&prefix=J"}), "34b48302e7b5fa45bde8084f4b7868a86f0a534bc59db6670ed5711ef69dc6f7");
  const TemporaryFolder folder;
  write_file(folder / "file", "Welcome to Amazon S3.");
  const int file = ::open((folder / "file").c_str(), O_RDONLY);
  const HttpRequest put{.method = "PUT",
                        .url = "/" + percent_encoded("test$file.text"),
                        .headers = {"date: Fri, 24 May 2013 00:00:00 GMT", "x-amz-storage-class: REDUCED_REDUNDANCY"},
                        .file = file,
                        .size = 21};
  EXPECT_EQ(signature_of(put, "44ce7dd67c959e0d3524ffac1771dfbba87d2b6b4b4e99e42034a8b803f8b072"),
            "98ad721746da40c64f1a55b78f14c238d841ea1380cd77a1b5971af0ece108bd");
  ::close(file);
}

TEST_F(HttpTransferTest, GivesBodiesOfSuccessToWhoTakesThemAndKeepsOthers) {
  std::string taken;
  const HttpHooks hooks{.take = [&](const HttpResponse& head, std::string_view bytes) {
    EXPECT_EQ(head.header("etag"), "\"x\"");
    taken += bytes;
    return absl::OkStatus();
  }};
  change_reply([](Reply& reply) { reply.body = std::string(1'000'000, 'y'); });
  const auto response = transfer_.run({.url = server_.url() + "/"}, hooks);
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(taken.size(), 1'000'000u);
  EXPECT_EQ(response->body, "");
  change_reply([](Reply& reply) { reply.status = 404; });
  const auto missing = transfer_.run({.url = server_.url() + "/"}, hooks);
  ASSERT_TRUE(missing.ok()) << missing.status();
  EXPECT_EQ(missing->status, 404);
  EXPECT_EQ(missing->body.size(), 65536u) << "no more is kept";
  EXPECT_EQ(taken.size(), 1'000'000u);
}

TEST_F(HttpTransferTest, EndsWithTheErrorOfWhoTakes) {
  const HttpHooks hooks{.take = [](const HttpResponse&, std::string_view) { return absl::ResourceExhaustedError("full"); }};
  EXPECT_EQ(status_of({.url = server_.url() + "/"}, hooks), absl::ResourceExhaustedError("full"));
  EXPECT_EQ(status_of({.url = server_.url() + "/"}), absl::OkStatus()) << "and goes on";
}

TEST_F(HttpTransferTest, IsUnavailableWhereNobodyAnswers) {
  const std::string url = [] { return HttpServer([](const HttpServer::Request&) { return Reply(); }).url(); }();
  const absl::Status status = status_of({.url = url + "/", .signature = &kSignature});
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
  EXPECT_THAT(status.message(), HasSubstr("127.0.0.1"));
}

TEST_F(HttpTransferTest, IsUnavailableWhereAnAnswerBreaksOff) {
  for (const End end : {End::kCut, End::kReset, End::kStall, End::kHang}) {
    change_reply([end](Reply& reply) { reply.end = end; });
    const auto begin = std::chrono::steady_clock::now();
    const HttpRequest request{
        .url = server_.url() + "/", .headers = {absl::StrCat("x-amz-content-sha256: ", kEmptySha256)}, .signature = &kSignature};
    const absl::Status status = status_of(request);
    EXPECT_TRUE(absl::IsUnavailable(status)) << status;
    EXPECT_THAT(status.message(), Not(HasSubstr(kSignature.secret)));
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30)) << "it takes a stall of a second";
  }
}

TEST_F(HttpTransferTest, EndsWhenItsCheckSaysSo) {
  change_reply([](Reply& reply) { reply.end = End::kHang; });
  HttpTransfer patient({.stall_timeout = std::chrono::seconds(1000)});
  std::atomic<bool> is_cancelled = false;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    is_cancelled = true;
  });
  const HttpHooks hooks{.check = [&] { return is_cancelled ? absl::CancelledError("enough") : absl::OkStatus(); }};
  EXPECT_EQ(patient.run({.url = server_.url() + "/"}, hooks).status(), absl::CancelledError("enough"));
  canceller.join();
}

TEST_F(HttpTransferTest, FollowsNoRedirection) {
  change_reply([&](Reply& reply) { reply = {.status = 307, .headers = {{"Location", server_.url() + "/elsewhere"}}}; });
  const auto response = transfer_.run({.url = server_.url() + "/"});
  ASSERT_TRUE(response.ok()) << response.status();
  EXPECT_EQ(response->status, 307);
  EXPECT_EQ(last_request().path, "/");
}

TEST_F(HttpTransferTest, TakesNothingButHttp) {
  const TemporaryFolder folder;
  write_file(folder / "file", "a secret");
  EXPECT_TRUE(absl::IsUnavailable(status_of({.url = "file://" + (folder / "file")})));
}

TEST_F(HttpTransferTest, ServesManyThreads) {
  std::vector<std::thread> threads;
  std::atomic<int> answers = 0;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < 20; ++k) answers += status_of({.url = server_.url() + "/"}).ok() ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(answers, 160);
  EXPECT_LE(server_.connections(), 8);
}

TEST(PercentEncoded, EncodesAllButUnreservedCharacters) {
  EXPECT_EQ(percent_encoded("aZ09-._~"), "aZ09-._~");
  EXPECT_EQ(percent_encoded("a b/+&=%\xc3\xa9"), "a%20b%2F%2B%26%3D%25%C3%A9");
  EXPECT_EQ(percent_encoded(""), "");
}

}  // namespace
}  // namespace curvecast::server
