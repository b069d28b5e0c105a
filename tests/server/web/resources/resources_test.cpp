// The API as resources of plain HTTP, of a whole server.
#include "server/web/resources/resources.h"

#include <absl/strings/match.h>
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

#include "tests/server/web/resources/resources_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

class Resources : public ResourcesFixture {};

std::uint32_t little_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST_F(Resources, AMeshBecomesASessionAndPoints) {
  const Response put = ask("PUT", "/v1/meshes/my%20sphere.off", sphere_off(3));
  ASSERT_EQ(put.status, 201) << put.body;
  const auto mesh = json_of(put);
  EXPECT_EQ(mesh["name"], "my sphere.off");
  EXPECT_EQ(mesh["size"], std::to_string(sphere_off(3).size()));
  EXPECT_EQ(mesh["mesh"]["format"], "off");
  EXPECT_EQ(mesh["mesh"]["faces"], "512");
  EXPECT_FALSE(mesh.contains("problem"));
  const std::string location = field_of(put, "Location");
  EXPECT_EQ(location, "/v1/meshes/" + mesh["meshId"].get<std::string>());
  EXPECT_EQ(json_of(get(location))["size"], mesh["size"]);

  const Response post = post_session(mesh["meshId"]);
  ASSERT_EQ(post.status, 200) << post.body;
  const auto session = json_of(post);
  EXPECT_EQ(session["state"], "SESSION_STATE_READY");
  EXPECT_EQ(session["options"]["maxPoints"], "2000");
  const std::string at = field_of(post, "Location");
  EXPECT_EQ(at, "/v1/sessions/" + session["sessionId"].get<std::string>());
  EXPECT_EQ(json_of(get(at))["sessionId"], session["sessionId"]);
  EXPECT_EQ(json_of(get("/v1/sessions"))["sessions"].size(), 1u);

  const Response points = get(at + "/points.ply?n=1000&density=curvature:floor=0.2&density=frustum");
  ASSERT_EQ(points.status, 200) << points.body;
  EXPECT_THAT(points.body, StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 1000\n"));
  EXPECT_EQ(field_of(points, "Content-Disposition"), "attachment; filename=\"my_sphere.ply\"");

  EXPECT_EQ(ask("DELETE", at).status, 204);
  const Response gone = get(at);
  EXPECT_EQ(gone.status, 404);
  EXPECT_EQ(json_of(gone)["code"], 5);
}

TEST_F(Resources, PointsAreThoseOfTheApi) {
  const std::string session = make_session();
  v1::SampleRequest sample;
  sample.set_points(500);
  sample.set_seed(7);
  sample.set_relaxation_rounds(4);
  sample.mutable_encoding()->mutable_raw();
  const auto stub = client();
  const Resampled wanted = resample(*stub, session, sample);
  ASSERT_EQ(wanted.blocks.size(), 1u);
  const std::string address = "/v1/sessions/" + session + "/points.json?n=500&seed=7";
  EXPECT_EQ(get(address + "&relax=101").status, 400);
  EXPECT_NE(json_of(get(address))["positions"], json_of(get(address + "&relax=4"))["positions"]);
  const auto points = json_of(get(address + "&relax=4"));
  EXPECT_EQ(points["count"], 500);
  const std::string& positions = wanted.blocks[0].points().raw().positions();
  ASSERT_EQ(points["positions"].size() * sizeof(float), positions.size());
  for (std::size_t i = 0; i < points["positions"].size(); ++i) {
    float value = 0;
    std::memcpy(&value, positions.data() + i * sizeof value, sizeof value);
    ASSERT_EQ(points["positions"][i].get<float>(), value) << i;
  }
}

TEST_F(Resources, PointsComeInManyKindsOfFiles) {
  const std::string points = "/v1/sessions/" + make_session() + "/points.";
  const auto body_of = [&](const std::string& file) {
    const Response response = get(points + file);
    EXPECT_EQ(response.status, 200) << file << ": " << response.body.substr(0, 300);
    return response.body;
  };
  EXPECT_THAT(body_of("npz?n=300"), StartsWith("PK"));
  EXPECT_THAT(body_of("npy?n=300"), HasSubstr("'shape': (300, 3)"));
  const std::string glb = body_of("glb?n=300&sampler=progressive&glb=floats");
  EXPECT_THAT(glb, StartsWith("glTF"));
  EXPECT_EQ(little_endian(glb, 8), glb.size());
  EXPECT_THAT(body_of("glb?n=300&splats=true"), HasSubstr("KHR_gaussian_splatting"));
  EXPECT_THAT(body_of("ply?n=300&splats=true"), HasSubstr("f_dc_0"));
  EXPECT_THAT(body_of("spz?n=300"), StartsWith("\x1f\x8b"));
  EXPECT_THAT(body_of("las?n=300"), StartsWith("LASF"));
  EXPECT_THAT(body_of("ply?n=300&attributes=curvatures,directions"), HasSubstr("direction_min_z"));
  const Response drc = get(points + "drc?n=30000&position_bits=14");  // more than a block of a frame
  EXPECT_THAT(drc.body, StartsWith("DRACO"));
  EXPECT_THAT(field_of(drc, "Curvecast-Radius-Range"), ::testing::MatchesRegex("[0-9.e-]+ [0-9.e-]+"));
  EXPECT_THAT(json_of(get(points + "doc"))["message"].get<std::string>(), HasSubstr("there are: ply, npz"));
}

TEST_F(Resources, PicturesAreDrawn) {
  const std::string picture = "/v1/sessions/" + make_session() + "/picture.";
  const Response png = get(picture + "png?width=64&height=48&camera=eye=0,0,5&what=dots&n=200");
  if (png.status == 501) GTEST_SKIP() << "nothing can be drawn here";
  ASSERT_EQ(png.status, 200) << png.body;
  EXPECT_EQ(field_of(png, "Content-Type"), "image/png");
  EXPECT_THAT(png.body, StartsWith("\x89PNG"));
  EXPECT_EQ(png.body.substr(16, 8), std::string("\0\0\0\x40\0\0\0\x30", 8));  // its size
  const Response jpeg = get(picture + "jpg?width=64&height=48&what=shaded&background=dark&plain=true");
  ASSERT_EQ(jpeg.status, 200) << jpeg.body;
  EXPECT_THAT(jpeg.body, StartsWith("\xff\xd8\xff"));
  EXPECT_EQ(get(picture + "jpg?width=64&height=48&what=shaded", {{"If-None-Match", field_of(jpeg, "ETag")}}).status, 200);
  for (const char* query :
       {"width=0x1", "width=5000", "what=uv", "camera=aspect=2", "camera=fov=20&camera=fov=30", "colour=red"}) {
    EXPECT_EQ(get(picture + "png?" + query).status, 400) << query;
  }
}

TEST_F(Resources, WhatAClientHasIsNotSentAgain) {
  const std::string points = "/v1/sessions/" + make_session() + "/points.ply?n=400";
  const Response first = get(points);
  const std::string tag = field_of(first, "ETag");
  ASSERT_THAT(tag, ::testing::MatchesRegex("\"[0-9a-f]{32}\""));
  EXPECT_EQ(field_of(first, "Cache-Control"), "private, no-cache");
  HttpClient client(server_->http_port());
  for (const std::string& known : {tag, "W/" + tag, "\"x\", " + tag}) {
    client.send(request_text("GET", points, {}, {{"If-None-Match", known}}));
    const Response again = client.receive(false);
    EXPECT_EQ(again.status, 304) << known;
    EXPECT_EQ(field_of(again, "ETag"), tag);
  }
  EXPECT_EQ(get(points + "&seed=1", {{"If-None-Match", tag}}).status, 200);
  EXPECT_EQ(get(points).body, first.body) << "the same bytes have the same name";
  const Response head = ask("HEAD", points);
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(field_of(head, "Content-Length"), std::to_string(first.body.size()));
  EXPECT_EQ(field_of(head, "ETag"), tag);
}

TEST_F(Resources, PointsThatGetBetterHaveNoName) {
  const std::string points = "/v1/sessions/" + make_session() + "/points.ply?n=200000";  // 100 times what it was made for
  const Response coarse = get(points);
  ASSERT_EQ(coarse.status, 200) << coarse.body;
  ASSERT_EQ(field_of(coarse, "Curvecast-Refining"), "true");
  EXPECT_EQ(field_of(coarse, "ETag"), "");
  EXPECT_EQ(field_of(coarse, "Cache-Control"), "no-store");
}

TEST_F(Resources, ErrorsSayWhatIsWrong) {
  const std::string session = make_session();
  const auto error = [&](const std::string& path, int status, int code) {
    const Response response = get(path);
    EXPECT_EQ(response.status, status) << path << ": " << response.body;
    const auto body = json_of(response);
    EXPECT_EQ(body["code"], code) << path;
    return body;
  };
  const std::string points = "/v1/sessions/" + session + "/points.ply";
  const auto zero = error(points + "?n=0", 400, 3);
  EXPECT_EQ(zero["details"][0]["@type"], "type.googleapis.com/google.rpc.BadRequest");
  EXPECT_EQ(zero["details"][0]["fieldViolations"][0]["field"], "sample.points");
  EXPECT_THAT(error(points + "?density=curvatur", 400, 3)["message"].get<std::string>(),
              HasSubstr("there are: uniform, curvature"));
  EXPECT_THAT(error(points + "?camera=zoom=3", 400, 3)["message"].get<std::string>(), HasSubstr("there are: eye, target"));
  EXPECT_THAT(error(points + "?n=10&pixel_error=2", 400, 3)["message"].get<std::string>(), HasSubstr("more than once"));
  EXPECT_THAT(error(points + "?points=10", 400, 3)["message"].get<std::string>(), HasSubstr("there are: n, pixel_error"));
  EXPECT_THAT(error(points + "?density=brush:@/etc/passwd", 400, 3)["message"].get<std::string>(),
              HasSubstr("command line only"));
  error(points + "?n=4000001", 400, 11);
  error(points + "?density=%zz", 400, 3);
  error(points + "?density=%ff", 400, 3);
  error("/v1/sessions/nonsense", 404, 5);
  error("/v1/sessions/nonsense/points.ply", 404, 5);
  error("/v1/meshes/00000000000000000000000000000000", 404, 5);
  error("/v1/nothing", 404, 5);
  error("/v1/sessions/a/b/c", 404, 5);
  error("/v1/sessions?page_size=x", 400, 3);
  error("/v1/sessions?page_token=x", 400, 3);
  error("/v1/sessions/" + session + "/points.ply?density=expression:0", 409, 9);
}

TEST_F(Resources, MethodsAndBodiesAreChecked) {
  const Response patched = ask("PATCH", "/v1/sessions");
  EXPECT_EQ(patched.status, 405);
  EXPECT_EQ(field_of(patched, "Allow"), "GET, POST");
  EXPECT_EQ(ask("POST", "/v1/sessions", "{}", {{"Content-Type", "text/plain"}}).status, 415);
  const HeaderFields json = {{"Content-Type", "application/json; charset=utf-8"}};
  EXPECT_EQ(ask("POST", "/v1/sessions", "{", json).status, 400);
  EXPECT_EQ(ask("POST", "/v1/sessions", "{\"mesh\":1}", json).status, 400);
  EXPECT_EQ(ask("POST", "/v1/sessions", "{\"meshId\":\"00000000000000000000000000000000\"}", json).status, 404);
  EXPECT_EQ(ask("POST", "/v1/sessions", std::string(1 << 19, '['), json).status, 400);
  EXPECT_EQ(ask("POST", "/v1/sessions", std::string((1 << 20) + 1, ' '), json).status, 413);
  EXPECT_EQ(ask("PUT", "/v1/meshes/a.off").status, 400);  // without a body
  EXPECT_EQ(ask("PUT", "/v1/meshes/a.off?hash=1", "OFF").status, 400);
  EXPECT_EQ(ask("PUT", "/v1/meshes/a.off?mesh_id=00000000000000000000000000000000", sphere_off(1)).status, 400);
  const auto texture = json_of(ask("PUT", "/v1/meshes/skin.png", "no picture"));
  EXPECT_EQ(texture["problem"]["code"], 3) << "it is there, but no mesh";
  EXPECT_FALSE(json_of(ask("PUT", "/v1/meshes/skin.png?inspect=false", "no picture")).contains("problem"));
}

TEST_F(Resources, JsonMayComeInChunks) {
  const std::string mesh = put_sphere();
  HttpClient client(server_->http_port());
  const std::string body = "{\"meshId\":\"" + mesh + "\",\"options\":{\"maxPoints\":\"500\"}}";
  std::string sent =
      "POST /v1/sessions HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n";
  for (const char c : body) sent += std::string("1\r\n") + c + "\r\n";
  client.send(sent + "0\r\n\r\n");
  EXPECT_EQ(client.receive().status, 200);
  EXPECT_EQ(client.get("/v1/sessions").status, 200) << "the connection goes on";
}

TEST_F(Resources, ALargeBodyIsAskedFor) {
  HttpClient client(server_->http_port());
  const std::string mesh = sphere_off(6);  // several pieces
  ASSERT_GT(mesh.size(), 2 * WebExchange::kMaxBodyPiece);
  client.send(absl::StrCat(
      "PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\nExpect: 100-continue\r\nContent-Length: ", mesh.size(), "\r\n\r\n"));
  EXPECT_EQ(client.receive(false).status, 100);
  client.send(mesh);
  const Response put = client.receive();
  EXPECT_EQ(put.status, 201) << put.body;
  EXPECT_EQ(client.get("/v1/sessions").status, 200) << "the connection goes on";
}

TEST_F(Resources, AFileIsNoLargerThanItMayBe) {
  start({.max_upload_bytes = 10'000, .http = "127.0.0.1:0"});
  const Response refused = ask("PUT", "/v1/meshes/a.off", sphere_off(4));
  EXPECT_EQ(refused.status, 413) << refused.body;
  EXPECT_THAT(json_of(refused)["message"].get<std::string>(), HasSubstr("takes at most 10000"));
  start({.max_mesh_bytes = 20'000, .http = "127.0.0.1:0"});
  const Response full = ask("PUT", "/v1/meshes/a.off", sphere_off(4));
  EXPECT_EQ(full.status, 429) << full.body;
  EXPECT_EQ(field_of(full, "Retry-After"), "1");
  EXPECT_EQ(json_of(full)["details"][0]["retryDelay"], "1s");
}

TEST_F(Resources, CallersAreKnownByTheirTokens) {
  const std::string path = ::testing::TempDir() + "resources_tokens";
  std::ofstream(path) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n"  // "secret"
                      << "bob 81b637d8fcd2c6da6359e6963113a1170de795e4b725b84d1e0b4cfd9ec58ce9\n";   // "bob"
  start({.tokens = path, .isolate = true, .http = "127.0.0.1:0"});
  const HeaderFields alice = {{"Authorization", "Bearer secret"}}, bob = {{"Authorization", "Bearer bob"}};
  const Response unknown = get("/v1/sessions");
  EXPECT_EQ(unknown.status, 401);
  EXPECT_EQ(field_of(unknown, "WWW-Authenticate"), "Bearer");
  EXPECT_EQ(json_of(unknown)["code"], 16);
  EXPECT_EQ(get("/v1/sessions", {{"Authorization", "Bearer \xc3\xa4"}}).status, 401);
  EXPECT_EQ(get("/v1/sessions", {{"Authorization", "Basic c2VjcmV0"}}).status, 401);
  EXPECT_EQ(ask("PUT", "/v1/meshes/a.off", sphere_off(2)).status, 401);
  const std::string mesh = put_sphere(3, alice);
  const Response made = post_session(mesh, "2000", alice);
  ASSERT_EQ(made.status, 200) << made.body;
  const std::string at = field_of(made, "Location");
  EXPECT_EQ(get(at + "/points.ply?n=10", alice).status, 200);
  EXPECT_EQ(get(at + "/points.ply?n=10", bob).status, 404);
  EXPECT_EQ(get("/v1/meshes/" + mesh, bob).status, 404);
  EXPECT_EQ(ask("DELETE", at, {}, bob).status, 404);
  EXPECT_EQ(json_of(get("/v1/sessions", bob))["sessions"].size(), 0u);
  EXPECT_EQ(ask("DELETE", at, {}, alice).status, 204);
}

TEST_F(Resources, WhatOneMadeAnotherMayNotClose) {
  const std::string path = ::testing::TempDir() + "resources_owners";
  std::ofstream(path) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n"
                      << "bob 81b637d8fcd2c6da6359e6963113a1170de795e4b725b84d1e0b4cfd9ec58ce9\n";
  start({.tokens = path, .http = "127.0.0.1:0"});
  const Response made =
      post_session(put_sphere(3, {{"Authorization", "Bearer secret"}}), "2000", {{"Authorization", "Bearer secret"}});
  const Response refused = ask("DELETE", field_of(made, "Location"), {}, {{"Authorization", "Bearer bob"}});
  EXPECT_EQ(refused.status, 403) << refused.body;
  EXPECT_EQ(json_of(refused)["code"], 7);
}

TEST_F(Resources, PagesOfAllowedOriginsMayAsk) {
  start({.http = "127.0.0.1:0", .web_origins = {"https://viewer.example.org"}});
  const HeaderFields allowed = {{"Origin", "https://viewer.example.org"}};
  const Response list = get("/v1/sessions", allowed);
  EXPECT_EQ(list.status, 200);
  EXPECT_EQ(field_of(list, "Access-Control-Allow-Origin"), "https://viewer.example.org");
  EXPECT_THAT(field_of(list, "Vary"), HasSubstr("Origin"));
  EXPECT_EQ(field_of(get("/v1/sessions/x", allowed), "Access-Control-Allow-Origin"), "https://viewer.example.org")
      << "errors are to be read, too";
  HeaderFields preflight = allowed;
  preflight.emplace_back("Access-Control-Request-Method", "DELETE");
  const Response options = ask("OPTIONS", "/v1/sessions/x", {}, preflight);
  EXPECT_EQ(options.status, 204);
  EXPECT_EQ(field_of(options, "Access-Control-Allow-Methods"), "GET, DELETE");
  EXPECT_THAT(field_of(options, "Access-Control-Allow-Headers"), HasSubstr("Authorization"));
  for (const HeaderFields& page : std::vector<HeaderFields>{{{"Origin", "https://evil.example"}},
                                                            {{"Origin", "null"}},
                                                            {{"Sec-Fetch-Site", "cross-site"}},
                                                            {{"Sec-Fetch-Site", "same-site"}}}) {
    const Response refused = get("/v1/sessions", page);
    EXPECT_EQ(refused.status, 403) << page[0].second;
    EXPECT_EQ(field_of(refused, "Access-Control-Allow-Origin"), "");
    HeaderFields asked = page;
    asked.emplace_back("Access-Control-Request-Method", "PUT");
    EXPECT_EQ(ask("OPTIONS", "/v1/meshes/a", {}, asked).status, 403);
  }
  EXPECT_EQ(get("/v1/sessions", {{"Sec-Fetch-Site", "same-origin"}}).status, 200);
  EXPECT_EQ(get("/v1/sessions", {{"Sec-Fetch-Site", "none"}}).status, 200);
}

TEST_F(Resources, NamesThatOthersCanLetPointHereAreRefused) {
  const auto status_of = [&](const std::string& host) {
    HttpClient client(server_->http_port());
    client.send("GET /v1/sessions HTTP/1.1\r\nHost: " + host + "\r\n\r\n");
    return client.receive().status;
  };
  EXPECT_EQ(status_of("evil.example:8080"), 403);
  EXPECT_EQ(status_of("127.0.0.1:8080"), 200);
  EXPECT_EQ(status_of("curvecast"), 200);
  EXPECT_EQ(status_of("[::1]:8080"), 200);
}

TEST_F(Resources, RequestsKeepTheirIds) {
  // The log has it; here it is enough that any is taken.
  EXPECT_EQ(get("/v1/sessions", {{"X-Request-Id", "abc-1"}}).status, 200);
  EXPECT_EQ(get("/v1/sessions", {{"X-Request-Id", "\xff a"}}).status, 200);
}

}  // namespace
}  // namespace curvecast::server
