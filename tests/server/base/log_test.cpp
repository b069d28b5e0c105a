#include "server/base/log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace curvecast::server {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;

const RequestRecord kRequest = {.method = "GetMesh",
                                .peer = "ipv4:127.0.0.1:1",
                                .id = "abc",
                                .code = "NOT_FOUND",
                                .milliseconds = 1.5,
                                .error = "no \"mesh\""};

/// What `write` has a logger of these settings write to standard error.
template <class Write>
std::string logged(bool enabled, bool verbose, LogFormat format, const Write& write) {
  ::testing::internal::CaptureStderr();
  const auto log = make_logger(enabled, verbose, format);
  write(*log);
  log->flush();
  return ::testing::internal::GetCapturedStderr();
}

TEST(Log, RequestsAreForTheVerbose) {
  const auto write = [](spdlog::logger& log) { log_request(log, kRequest); };
  EXPECT_THAT(logged(true, false, LogFormat::kText, write), IsEmpty());
  EXPECT_THAT(logged(false, true, LogFormat::kText, write), IsEmpty());
  EXPECT_THAT(logged(true, true, LogFormat::kText, write),
              HasSubstr("GetMesh from ipv4:127.0.0.1:1: NOT_FOUND after 1.50 ms, request abc: no \"mesh\"\n"));
}

TEST(Log, RequestsNameCallersWhoAreKnown) {
  RequestRecord request = kRequest;
  request.caller = "anna\n";
  const auto write = [&](spdlog::logger& log) { log_request(log, request); };
  EXPECT_THAT(logged(true, true, LogFormat::kText, write), HasSubstr("GetMesh by anna\\n from ipv4:127.0.0.1:1: NOT_FOUND"));
  EXPECT_EQ(json::parse(logged(true, true, LogFormat::kJson, write))["caller"], "anna\n");
}

TEST(Log, JsonHasALinePerMessage) {
  const std::string text = logged(true, true, LogFormat::kJson, [](spdlog::logger& log) {
    log.info("two\nlines, a \"quote\" and \xff");
    log_request(log, kRequest);
    log.error("after");
  });
  std::istringstream lines(text);
  std::vector<json> objects;
  for (std::string line; std::getline(lines, line);) objects.push_back(json::parse(line));
  ASSERT_EQ(objects.size(), 3u) << text;
  EXPECT_EQ(objects[0]["message"], "two\nlines, a \"quote\" and \xef\xbf\xbd");
  EXPECT_EQ(objects[0]["level"], "info");
  EXPECT_THAT(objects[0]["time"].get<std::string>(),
              MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}[.][0-9]{3}Z"));
  EXPECT_FALSE(objects[0].contains("method"));
  EXPECT_EQ(objects[1]["method"], "GetMesh");
  EXPECT_EQ(objects[1]["peer"], "ipv4:127.0.0.1:1");
  EXPECT_EQ(objects[1]["code"], "NOT_FOUND");
  EXPECT_EQ(objects[1]["ms"], 1.5);
  EXPECT_EQ(objects[1]["request_id"], "abc");
  EXPECT_EQ(objects[1]["error"], "no \"mesh\"");
  EXPECT_EQ(objects[2]["level"], "error");
  EXPECT_FALSE(objects[2].contains("method"));
}

}  // namespace
}  // namespace curvecast::server
