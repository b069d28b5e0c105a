// The store in S3 against a real one: directly, and through a proxy that makes the network bad. deploy/check_store starts both;
// without it there is nothing to test.
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "server/base/hash.h"
#include "server/store/s3_error.h"
#include "server/store/s3_store.h"
#include "tests/server/store/fake_s3.h"
#include "tests/server/store/store_contract.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::curvecast::testing::bytes_of;
using ::curvecast::testing::TemporaryFolder;
using ::curvecast::testing::write_file;
using ::testing::HasSubstr;
using ::testing::Not;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMiB = std::size_t{1} << 20;
constexpr char kBucket[] = "curvecast-test";
constexpr char kEmptySha256[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";

/// With some variables changed.
Environment environment_with(std::map<std::string, std::string> changed) {
  return [changed = std::move(changed)](const std::string& name) {
    const auto it = changed.find(name);
    return it == changed.end() ? process_environment()(name) : it->second;
  };
}

class S3LiveTest : public ::testing::Test {
 protected:
  void SetUp() override {
    // Not AWS_ENDPOINT_URL alone: whoever runs all tests may have one that is no place for them.
    if (process_environment()("CURVECAST_S3_TEST").empty()) GTEST_SKIP() << "there is no S3 to test with: run deploy/check_store";
    const absl::StatusOr<HttpResponse> made = ask("PUT", absl::StrCat("/", kBucket));
    ASSERT_TRUE(made.ok()) << made.status();
    ASSERT_TRUE(made->status == 200 || made->status == 409) << made->body;
  }

  /// A request without retries, signed.
  absl::StatusOr<HttpResponse> ask(const std::string& method, const std::string& target) {
    const auto environment = process_environment();
    const HttpSignature signature{
        .access_key = environment("AWS_ACCESS_KEY_ID"), .secret = environment("AWS_SECRET_ACCESS_KEY"), .region = "us-east-1"};
    return HttpTransfer({.ca_bundle = environment("AWS_CA_BUNDLE")})
        .run({.method = method,
              .url = endpoint_ + target,
              .headers = {absl::StrCat("x-amz-content-sha256: ", kEmptySha256)},
              .signature = &signature});
  }
  /// Whether parts of an upload of this object lie there. An upload without any may be there for good where the answer to its
  /// beginning was lost.
  bool has_parts(const std::string& key) {
    const std::string bucket = absl::StrCat("/", kBucket);
    const auto uploads = ask("GET", absl::StrCat(bucket, "?prefix=", percent_encoded(key), "&uploads="));
    EXPECT_TRUE(uploads.ok() && uploads->status == 200) << uploads.status();
    std::string rest = uploads.ok() ? uploads->body : "";
    for (std::string id; !(id = xml_text(rest, "UploadId")).empty(); rest = rest.substr(rest.find("</UploadId>") + 1)) {
      const auto parts = ask("GET", absl::StrCat(bucket, "/", key, "?uploadId=", percent_encoded(id)));
      if (parts.ok() && absl::StrContains(parts->body, "<PartNumber>")) return true;
    }
    return false;
  }
  std::unique_ptr<Store> store_of(const std::string& prefix, const Environment& environment = process_environment(),
                                  const S3Options& options = {}) {
    return *make_s3_store(kBucket, prefix, environment, options);
  }

  const std::string endpoint_ = process_environment()("AWS_ENDPOINT_URL");
  const TemporaryFolder folder_;
};

TEST_F(S3LiveTest, KeepsWhatStoresPromise) { expect_store_contract(*store_of("contract"), {0, 1, 5 * kMiB, 40 * kMiB}); }

TEST_F(S3LiveTest, TakesAwkwardPrefixes) {
  expect_store_contract(*store_of(""), {0, 1000});
  expect_store_contract(*store_of("a b/\xc3\xa9+&=%/~(1)!*'"), {0, 1000});
}

TEST_F(S3LiveTest, LetsNobodyInWithAWrongSecret) {
  write_file(folder_ / "file", "x");
  for (const char* variable : {"AWS_SECRET_ACCESS_KEY", "AWS_ACCESS_KEY_ID"}) {
    const auto store = store_of("keys", environment_with({{variable, "not-what-it-is"}}));
    for (const absl::Status& status : {store->put("a", folder_ / "file", nullptr), store->get("a", folder_ / "to", nullptr),
                                       store->size("a", nullptr).status(), store->remove("a", nullptr)}) {
      EXPECT_TRUE(absl::IsPermissionDenied(status)) << status;
      EXPECT_THAT(status.message(), HasSubstr(absl::StrCat("s3://", kBucket, "/keys/a")));
      EXPECT_THAT(status.message(), HasSubstr("HTTP 403"));
      EXPECT_THAT(status.message(), Not(HasSubstr("not-what-it-is")));
      EXPECT_THAT(status.message(), Not(HasSubstr(process_environment()("AWS_SECRET_ACCESS_KEY"))));
    }
  }
}

TEST_F(S3LiveTest, TakesKeysFromAFileThatChanges) {
  write_file(folder_ / "file", "x");
  const auto put = [&](const std::string& secret) {
    write_file(folder_ / "credentials",
               absl::StrCat("[default]\naws_access_key_id = ", process_environment()("AWS_ACCESS_KEY_ID"),
                            "\naws_secret_access_key = ", secret, "\n"));
  };
  put("not-yet-the-right-one");
  const auto store = store_of("keys", environment_with({{"AWS_ACCESS_KEY_ID", ""},
                                                        {"AWS_SECRET_ACCESS_KEY", ""},
                                                        {"AWS_SHARED_CREDENTIALS_FILE", folder_ / "credentials"}}));
  EXPECT_TRUE(absl::IsPermissionDenied(store->put("a", folder_ / "file", nullptr)));
  put(process_environment()("AWS_SECRET_ACCESS_KEY"));
  EXPECT_EQ(store->put("a", folder_ / "file", nullptr), absl::OkStatus());
}

TEST_F(S3LiveTest, TellsAMissingBucketFromAMissingFile) {
  const auto store = *make_s3_store("curvecast-no-such-bucket", "p");
  write_file(folder_ / "file", "x");
  for (const absl::Status& status : {store->put("a", folder_ / "file", nullptr), store->get("a", folder_ / "to", nullptr),
                                     store->size("a", nullptr).status(), store->remove("a", nullptr)}) {
    EXPECT_TRUE(absl::IsPermissionDenied(status)) << status;
    EXPECT_THAT(status.message(), HasSubstr("NoSuchBucket"));
  }
}

TEST_F(S3LiveTest, TakesWhatOtherProgramsPut) {
  const auto store = store_of("exchanged");
  write_file(folder_ / "file", "what was put");
  ASSERT_EQ(store->put("a", folder_ / "file", nullptr), absl::OkStatus());
  // Without our metadata: it is for who reads the file to notice what it is.
  ASSERT_EQ(ask("PUT", absl::StrCat("/", kBucket, "/exchanged/a"))->status, 200);
  EXPECT_EQ(store->get("a", folder_ / "to", nullptr), absl::OkStatus());
  EXPECT_EQ(bytes_of(folder_ / "to"), "");
}

TEST_F(S3LiveTest, LeavesNoPartsWhenItIsCancelled) {
  const auto store = store_of("cancelled");
  write_file(folder_ / "file", some_bytes(200 * kMiB));
  std::atomic<bool> cancel = false;
  std::thread canceller([&] {
    while (!has_parts("cancelled/a")) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    cancel = true;
  });
  EXPECT_TRUE(absl::IsCancelled(store->put("a", folder_ / "file", &cancel)));
  canceller.join();
  EXPECT_FALSE(has_parts("cancelled/a"));
  EXPECT_TRUE(absl::IsNotFound(store->size("a", nullptr).status()));
}

/// Through a proxy that does to connections what it is told.
class S3BadNetworkTest : public S3LiveTest {
 protected:
  void SetUp() override {
    if (proxy_.empty()) GTEST_SKIP() << "there is no proxy in CURVECAST_TOXIPROXY: run deploy/check_store";
    S3LiveTest::SetUp();
    tell("POST", "", "{\"enabled\":true}");
  }
  void TearDown() override {
    for (const std::string& toxic : toxics_) tell("DELETE", absl::StrCat("/toxics/", toxic));
    if (!proxy_.empty()) tell("POST", "", "{\"enabled\":true}");
  }

  void tell(const std::string& method, const std::string& path, const std::string& body = "") {
    const auto response = HttpTransfer(HttpOptions()).run({.method = method, .url = proxy_ + path, .body = body});
    ASSERT_TRUE(response.ok()) << response.status();
    ASSERT_EQ(response->status / 100, 2) << response->body;
  }
  /// `stream`: what comes ("downstream") or what is sent ("upstream"). `attributes` are JSON.
  void add(const std::string& type, const std::string& stream, const std::string& attributes) {
    const std::string name = absl::StrCat(type, "-", stream);
    toxics_.push_back(name);
    tell("POST", "/toxics",
         absl::StrCat("{\"name\":\"", name, "\",\"type\":\"", type, "\",\"stream\":\"", stream, "\",\"attributes\":", attributes,
                      "}"));
  }
  void remove_all() {
    for (const std::string& toxic : toxics_) tell("DELETE", absl::StrCat("/toxics/", toxic));
    toxics_.clear();
  }
  std::unique_ptr<Store> proxied() {
    S3Options options;
    options.http.stall_timeout = std::chrono::seconds(2);
    return store_of("bad", environment_with({{"AWS_ENDPOINT_URL", process_environment()("CURVECAST_S3_PROXIED")}}), options);
  }
  /// Whether a file comes back as it was put.
  void expect_round_trip(Store& store, const std::string& name, std::size_t size) {
    const std::string bytes = some_bytes(size);
    write_file(folder_ / "from", bytes);
    EXPECT_EQ(store.put(name, folder_ / "from", nullptr), absl::OkStatus());
    EXPECT_EQ(store.get(name, folder_ / "to", nullptr), absl::OkStatus());
    EXPECT_TRUE(bytes_of(folder_ / "to") == bytes);
  }
  /// All calls are Unavailable, none takes long, nothing is left behind, and what there was is still there when all is well
  /// again.
  void expect_away(const std::function<void()>& begin, const std::function<void()>& end) {
    const auto store = proxied();
    expect_round_trip(*store, "a", 20 * kMiB);
    write_file(folder_ / "other", some_bytes(20 * kMiB, 2));
    const std::string before = bytes_of(folder_ / "to");
    begin();
    const std::vector<std::function<absl::Status()>> calls = {[&] { return store->put("a", folder_ / "other", nullptr); },
                                                              [&] { return store->get("a", folder_ / "to", nullptr); },
                                                              [&] { return store->size("a", nullptr).status(); }};
    for (const auto& call : calls) {
      const Clock::time_point at = Clock::now();
      const absl::Status status = call();
      EXPECT_TRUE(absl::IsUnavailable(status)) << status;
      EXPECT_THAT(status.message(), HasSubstr(absl::StrCat("s3://", kBucket, "/bad/a")));
      EXPECT_LT(Clock::now() - at, std::chrono::seconds(90));
    }
    EXPECT_TRUE(bytes_of(folder_ / "to") == before);
    end();
    EXPECT_EQ(store->get("a", folder_ / "to", nullptr), absl::OkStatus());
    EXPECT_TRUE(bytes_of(folder_ / "to") == before);
    EXPECT_EQ(store->put("a", folder_ / "other", nullptr), absl::OkStatus());
    EXPECT_FALSE(has_parts("bad/a"));
  }

  const std::string proxy_ = process_environment()("CURVECAST_TOXIPROXY");
  std::vector<std::string> toxics_;
};

TEST_F(S3BadNetworkTest, WorksWhereItIsSlow) {
  add("latency", "downstream", "{\"latency\":300,\"jitter\":200}");
  add("bandwidth", "downstream", "{\"rate\":4000}");  // kilobytes a second
  add("bandwidth", "upstream", "{\"rate\":4000}");
  expect_round_trip(*proxied(), "slow", 20 * kMiB);
}

TEST_F(S3BadNetworkTest, GoesOnWhereConnectionsBreak) {
  const auto store = proxied();
  expect_round_trip(*store, "cut", 40 * kMiB);
  add("limit_data", "downstream",
      absl::StrCat("{\"bytes\":", 3 * kMiB, "}"));  // of each connection: more cuts than there are tries
  EXPECT_EQ(store->get("cut", folder_ / "again", nullptr), absl::OkStatus());
  EXPECT_TRUE(bytes_of(folder_ / "again") == bytes_of(folder_ / "from"));
}

TEST_F(S3BadNetworkTest, IsAwayWhereNothingCanBeSent) {
  expect_away([&] { add("limit_data", "upstream", "{\"bytes\":100}"); }, [&] { remove_all(); });
}

TEST_F(S3BadNetworkTest, IsAwayWhereConnectionsAreReset) {
  expect_away([&] { add("reset_peer", "downstream", "{\"timeout\":50}"); }, [&] { remove_all(); });
}

TEST_F(S3BadNetworkTest, IsAwayWhereNothingComes) {
  expect_away([&] { add("timeout", "downstream", "{\"timeout\":0}"); }, [&] { remove_all(); });
}

TEST_F(S3BadNetworkTest, IsAwayWhereNobodyListens) {
  expect_away([&] { tell("POST", "", "{\"enabled\":false}"); }, [&] { tell("POST", "", "{\"enabled\":true}"); });
}

TEST_F(S3BadNetworkTest, WaitsForAStoreThatIsBackSoon) {
  const auto store = proxied();
  write_file(folder_ / "from", some_bytes(20 * kMiB));
  tell("POST", "", "{\"enabled\":false}");
  std::thread back([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    tell("POST", "", "{\"enabled\":true}");
  });
  EXPECT_EQ(store->put("soon", folder_ / "from", nullptr), absl::OkStatus());
  back.join();
}

}  // namespace
}  // namespace curvecast::server
