#include "server/web/resources/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "curvecast/v1/curvecast.pb.h"
#include "server/base/grpc_status.h"
#include "server/base/status_payload.h"

namespace curvecast::server {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Pair;
using Json = nlohmann::json;

TEST(WebJson, FollowsProtobufsMapping) {
  v1::Session session;
  session.set_session_id("x");
  session.set_state(v1::SESSION_STATE_READY);
  const Json json = Json::parse(to_json(session));
  EXPECT_EQ(json["sessionId"], "x");
  EXPECT_EQ(json["state"], "SESSION_STATE_READY");
  EXPECT_EQ(json["curveRevision"], "0");
  EXPECT_EQ(json["pinned"], false);
  v1::CreateSessionRequest request;
  ASSERT_TRUE(parse_json(R"({"mesh_id":"m","options":{"maxPoints":"7","omega":2.5},"companions":{"a.mtl":"b"}})", request).ok());
  EXPECT_EQ(request.mesh_id(), "m");
  EXPECT_EQ(request.options().max_points(), 7u);
  EXPECT_EQ(request.companions().at("a.mtl"), "b");
}

TEST(WebJson, RefusesWhatAMessageDoesNotHave) {
  v1::CreateSessionRequest request;
  for (const char* text :
       {"", "[]", "1", "{\"x\":1}", "{\"options\":{\"maxPoints\":-1}}", "{\"options\":{\"maxPoints\":\"many\"}}"}) {
    const absl::Status status = parse_json(text, request);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
    EXPECT_THAT(status.message(), HasSubstr("no CreateSessionRequest in JSON")) << text;
  }
  EXPECT_FALSE(parse_json(std::string(1 << 20, '['), request).ok());
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "{\"options\":";
  EXPECT_FALSE(parse_json(deep, request).ok());
}

TEST(WebJson, ErrorsAreStatuses) {
  absl::Status status = absl::InvalidArgumentError("sample.points is 0");
  status.SetPayload(kFieldPayload, absl::Cord("sample.points"));
  const WebAnswer bad = error_answer(to_grpc(status));
  EXPECT_EQ(bad.status, 400);
  EXPECT_EQ(Json::parse(bad.body)["details"][0]["fieldViolations"][0]["field"], "sample.points");
  const WebAnswer busy = error_answer(to_grpc(absl::ResourceExhaustedError("full")));
  EXPECT_EQ(busy.status, 429);
  EXPECT_THAT(busy.header, Contains(Pair("Retry-After", "1")));
  EXPECT_EQ(Json::parse(busy.body)["details"][0]["@type"], "type.googleapis.com/google.rpc.RetryInfo");
  const WebAnswer large = error_answer(to_grpc(absl::ResourceExhaustedError("too large")), 413);
  EXPECT_EQ(large.status, 413);
  EXPECT_THAT(error_answer(to_grpc(absl::UnauthenticatedError("who?"))).header, Contains(Pair("WWW-Authenticate", "Bearer")));
  EXPECT_THAT(error_answer(to_grpc(absl::UnavailableError("going"))).header, Contains(Pair("Retry-After", "1")));
  EXPECT_EQ(error_answer(to_grpc(absl::CancelledError("gone"))).status, 499);
  EXPECT_EQ(error_answer(to_grpc(absl::FailedPreconditionError("not yet"))).status, 409);
  EXPECT_NO_THROW(error_answer(grpc::Status(grpc::INTERNAL, "\xff")));
}

}  // namespace
}  // namespace curvecast::server
