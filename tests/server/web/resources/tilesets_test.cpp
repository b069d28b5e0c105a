// 3D Tiles of a session, as viewers load them from a server.
#include "server/web/resources/tilesets.h"

#include <absl/strings/match.h>
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <thread>

#include "tests/proto/formats/parsed_glb.h"
#include "tests/server/eventually.h"
#include "tests/server/web/resources/resources_fixture.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;
using Place = std::array<double, 3>;

constexpr std::uint32_t kRootPoints = 4096;
constexpr char kForEver[] = "public, max-age=31536000, immutable";

/// Ranked points as the API gives them, by rank.
std::map<std::uint32_t, Place> ranked_points(Stub& stub, const std::string& session, std::uint64_t points) {
  v1::SampleRequest sample;
  sample.set_points(points);
  sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
  sample.mutable_encoding()->mutable_raw();
  sample.add_attributes(v1::POINT_ATTRIBUTE_RANK);
  const Resampled answer = resample(stub, session, sample);
  EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
  std::map<std::uint32_t, Place> all;
  for (const v1::ResampleResponse& response : answer.blocks) {
    const v1::PointBlock& block = response.points();
    const std::string& bytes = block.raw().positions();
    for (std::uint32_t i = 0; i < block.count(); ++i) {
      std::array<float, 3> p{};
      std::memcpy(p.data(), bytes.data() + i * sizeof p, sizeof p);
      std::uint32_t rank = 0;
      std::memcpy(&rank, block.attributes().ranks().data() + i * sizeof rank, sizeof rank);
      EXPECT_TRUE(all.emplace(rank, Place{block.origin().x() + double{p[0]}, block.origin().y() + double{p[1]},
                                          block.origin().z() + double{p[2]}})
                      .second);
    }
  }
  return all;
}

class Tilesets : public ResourcesFixture {
 protected:
  /// What a viewer finds that loads all of a set.
  struct Loaded {
    std::map<int, std::vector<Place>> of_level;
    std::map<std::string, std::string> files;  // by path
    std::vector<std::string> addresses;        // of tiles with points
    std::size_t points() const {
      std::size_t sum = 0;
      for (const auto& [level, own] : of_level) sum += own.size();
      return sum;
    }
  };

  Loaded load(const std::string& path, const HeaderFields& fields = {}) {
    Loaded loaded;
    HttpClient client(server_->http_port());
    client.send(request_text("GET", path, {}, fields));
    const Response top = client.receive();
    EXPECT_EQ(top.status, 200) << top.body;
    walk(client, path, Json::parse(top.body)["root"], 0, fields, loaded);
    return loaded;
  }

  std::string session_path(int levels = 3, const std::string& points = "6000") {
    const Response made = post_session(put_sphere(levels), points);
    EXPECT_EQ(made.status, 200) << made.body;
    return field_of(made, "Location");
  }

  /// Calls of the API that took points.
  double samples() const { return metric("curvecast_requests_total{code=\"OK\",method=\"Resample\"}"); }

 private:
  static void walk(HttpClient& client, const std::string& base, const Json& tile, int level, const HeaderFields& fields,
                   Loaded& loaded) {
    const bool has_content = tile.contains("content");
    if (has_content) {
      // As addresses are resolved: beside the file that names it.
      const std::string path =
          base.substr(0, base.substr(0, base.find('?')).rfind('/') + 1) + tile["content"]["uri"].get<std::string>();
      client.send(request_text("GET", path, {}, fields));
      const Response file = client.receive();
      ASSERT_EQ(file.status, 200) << path << ": " << file.body;
      loaded.files[path] = file.body;
      if (absl::EndsWith(path, ".json")) {
        EXPECT_EQ(field_of(file, "Content-Type"), "application/json");
        return walk(client, path, Json::parse(file.body)["root"], level, fields, loaded);
      }
      EXPECT_EQ(field_of(file, "Content-Type"), "model/gltf-binary");
      loaded.addresses.push_back(path);
      const formats::ParsedGlb glb(file.body);
      for (const std::vector<double>& position : glb.numbers("POSITION"))
        loaded.of_level[level].push_back(glb.in_scene(position));
    }
    if (!tile.contains("children")) return;
    for (const Json& child : tile["children"]) walk(client, base, child, has_content ? level + 1 : level, fields, loaded);
  }
};

TEST_F(Tilesets, HaveEachRankedPointOnceAndLevelsThatAreCoarserSets) {
  const std::string at = session_path(4, "70000");
  const Loaded loaded = load(at + "/tileset.json?n=70000&glb=floats");
  const auto stub = client();
  const std::map<std::uint32_t, Place> wanted = ranked_points(*stub, at.substr(at.rfind('/') + 1), 70'000);
  ASSERT_EQ(wanted.size(), 70'000u);
  EXPECT_EQ(loaded.points(), 70'000u);
  ASSERT_EQ(loaded.of_level.size(), 4u);
  std::set<Place> shown;
  std::uint32_t prefix = kRootPoints;
  for (const auto& [level, own] : loaded.of_level) {
    shown.insert(own.begin(), own.end());
    std::set<Place> coarser;
    for (auto point = wanted.begin(); point != wanted.lower_bound(prefix); ++point) coarser.insert(point->second);
    EXPECT_EQ(shown, coarser) << "level " << level;
    prefix *= 4;
  }
  const bool has_files_of_its_own =
      std::any_of(loaded.files.begin(), loaded.files.end(), [](const auto& file) { return absl::EndsWith(file.first, ".json"); });
  EXPECT_TRUE(has_files_of_its_own);
}

TEST_F(Tilesets, AreMadeOnceAndMayBeKeptForEver) {
  const std::string at = session_path();
  const std::string path = at + "/tileset.json?n=6000&density=curvature:floor=0.5";
  const Response top = get(path);
  ASSERT_EQ(top.status, 200) << top.body;
  EXPECT_EQ(field_of(top, "Content-Type"), "application/json");
  EXPECT_EQ(field_of(top, "Cache-Control"), "private, no-cache");
  const std::string tag = field_of(top, "ETag");
  ASSERT_THAT(tag, ::testing::MatchesRegex("\"[0-9a-f]{32}\""));
  EXPECT_EQ(ask("GET", path, {}, {{"If-None-Match", tag}}).status, 304);
  EXPECT_EQ(Json::parse(top.body)["asset"]["version"], "1.1");
  const std::string uri = Json::parse(top.body)["root"]["content"]["uri"];
  EXPECT_THAT(uri, ::testing::MatchesRegex("tiles/[0-9a-f]{32}[.][A-Za-z0-9_-]+/0-0[.]glb"));

  const std::string tile = at + "/" + uri;
  const Response first = get(tile);
  ASSERT_EQ(first.status, 200) << first.body;
  EXPECT_THAT(first.body, StartsWith("glTF"));
  EXPECT_EQ(field_of(first, "Cache-Control"), kForEver);
  const std::string name = field_of(first, "ETag");
  EXPECT_THAT(name, ::testing::MatchesRegex("\"[0-9a-f]{32}-0-0[.]glb\""));
  HttpClient client(server_->http_port());
  client.send(request_text("GET", tile, {}, {{"If-None-Match", name}}));
  const Response again = client.receive(false);
  EXPECT_EQ(again.status, 304);
  EXPECT_EQ(field_of(again, "ETag"), name);
  EXPECT_EQ(field_of(again, "Cache-Control"), kForEver);
  const Response head = ask("HEAD", tile);
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(field_of(head, "Content-Length"), std::to_string(first.body.size()));
  EXPECT_EQ(ask("HEAD", path).status, 200);
  EXPECT_EQ(get(tile + "?n=6000&density=curvature:floor=0.5").body, first.body) << "Cesium repeats the query of the tileset";
  EXPECT_EQ(ask("PUT", tile, "x").status, 405);
  EXPECT_EQ(ask("DELETE", path).status, 405);
  EXPECT_EQ(get(at + "/tileset.json?density=curvature:floor=0.5&n=6000&up=y").body, top.body) << "another spelling of the same";
  EXPECT_EQ(samples(), 1);
}

TEST_F(Tilesets, OfOtherTermsHaveOtherAddresses) {
  const std::string at = session_path();
  std::set<std::string> addresses;
  for (const char* query : {"", "?n=5999", "?n=5000", "?density=curvature", "?up=z", "?glb=floats", "?glb=quantised"}) {
    const Response top = get(at + "/tileset.json" + query);
    ASSERT_EQ(top.status, 200) << query << top.body;
    addresses.insert(Json::parse(top.body)["root"]["content"]["uri"].get<std::string>());
  }
  EXPECT_EQ(addresses.size(), 7u);
  EXPECT_TRUE(Json::parse(get(at + "/tileset.json?up=z").body)["root"].contains("transform"));
  const Json extras = Json::parse(get(at + "/tileset.json").body)["extras"];
  EXPECT_EQ(extras["points"], 6000) << "as many as the session is made for";
}

TEST_F(Tilesets, ThatWereDroppedAreMadeAgainWithTheSameBytes) {
  const std::string at = session_path();
  const std::string path = at + "/tileset.json?n=6000";
  const Loaded before = load(path);
  ASSERT_GT(before.addresses.size(), 4u);
  EXPECT_EQ(samples(), 1);
  for (int n = 10; n < 80; ++n) ASSERT_EQ(get(at + "/tileset.json?n=" + std::to_string(n)).status, 200);
  EXPECT_EQ(samples(), 71);
  // Its tiles alone, by addresses that a viewer has kept.
  for (const auto& [address, bytes] : before.files) EXPECT_EQ(get(address).body, bytes) << address;
  EXPECT_EQ(samples(), 72) << "once for all tiles";
  EXPECT_EQ(load(path).files, before.files);
}

TEST_F(Tilesets, AreTheSameAfterARestart) {
  const std::string at = session_path();
  const Loaded before = load(at + "/tileset.json?n=5000");
  start({.http = "127.0.0.1:0"});
  EXPECT_EQ(get(before.addresses.front()).status, 404) << "there is no session";
  EXPECT_EQ(session_path(), at);
  for (const auto& [address, bytes] : before.files) EXPECT_EQ(get(address).body, bytes) << address;
}

TEST_F(Tilesets, AreMadeOnceForAllWhoAskAtTheSameTime) {
  const std::string at = session_path(4, "20000");
  std::vector<std::thread> threads;
  std::vector<std::string> bodies(8);
  for (std::size_t t = 0; t < bodies.size(); ++t) {
    threads.emplace_back([&, t] { bodies[t] = get(at + "/tileset.json?n=20000").body; });
  }
  for (std::thread& thread : threads) thread.join();
  for (const std::string& body : bodies) EXPECT_EQ(body, bodies.front());
  EXPECT_THAT(bodies.front(), HasSubstr("\"points\": 20000"));
  EXPECT_EQ(samples(), 1);
}

TEST_F(Tilesets, GoOnForThoseWhoStay) {
  const std::string at = session_path(4, "40000");
  const auto sessions_looked_at = [&] { return metric("curvecast_requests_total{code=\"OK\",method=\"GetSession\"}"); };
  const std::string path = at + "/tileset.json?n=40000";
  auto first = std::make_unique<HttpClient>(server_->http_port());
  HttpClient second(server_->http_port());
  first->send(request_text("GET", path));
  ASSERT_TRUE(eventually([&] { return sessions_looked_at() >= 2; }));
  second.send(request_text("GET", path));
  ASSERT_TRUE(eventually([&] { return sessions_looked_at() >= 3; }));
  first.reset();
  const Response answer = second.receive();
  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_THAT(answer.body, HasSubstr("\"points\": 40000"));
  EXPECT_EQ(samples(), 1);
}

TEST_F(Tilesets, NobodyWaitsForAreCancelled) {
  const std::string at = session_path(5, "20000");
  {
    HttpClient client(server_->http_port());
    client.send(request_text("GET", at + "/tileset.json?n=4000000"));
    ASSERT_TRUE(eventually([&] { return metric("curvecast_requests_total{code=\"OK\",method=\"GetSession\"}") >= 2; }));
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_requests_total{code=\"CANCELLED\",method=\"Resample\"}") == 1; }));
  EXPECT_TRUE(eventually([&] { return metric("curvecast_memory_reserved_bytes") == 0; }));
  EXPECT_EQ(get(at + "/tileset.json?n=5000").status, 200);
}

TEST_F(Tilesets, DoNotHoldUpAServerThatEnds) {
  const std::string at = session_path(4, "500");
  HttpClient client(server_->http_port());
  client.send(request_text("GET", at + "/tileset.json?n=4000000"));
  ASSERT_TRUE(eventually([&] { return metric("curvecast_requests_total{code=\"OK\",method=\"GetSession\"}") >= 2; }));
  server_->shutdown(std::chrono::milliseconds(0));
  EXPECT_NE(client.receive().status, 200);
  server_.reset();
}

TEST_F(Tilesets, ErrorsSayWhatIsWrong) {
  const std::string at = session_path();
  const auto error = [&](const std::string& path, int status) {
    const Response response = get(path);
    EXPECT_EQ(response.status, status) << path << ": " << response.body;
    return json_of(response)["message"].get<std::string>();
  };
  const std::string path = at + "/tileset.json";
  EXPECT_THAT(error(path + "?n=x", 400), HasSubstr("'n=x': must be a number of points"));
  EXPECT_THAT(error(path + "?n=0", 400), HasSubstr("sample.points"));
  EXPECT_THAT(error(path + "?n=4000001", 400), HasSubstr("4000000"));
  EXPECT_THAT(error(path + "?n=99999999999999999999", 400), HasSubstr("n="));
  EXPECT_THAT(error(path + "?density=frustum", 400), HasSubstr("'density=frustum': this density depends on a camera"));
  EXPECT_THAT(error(path + "?camera=fov=40", 400), HasSubstr("there are: n, density"));
  EXPECT_THAT(error(path + "?density=%zz", 400), HasSubstr("hexadecimal"));
  error(path + "?density=expression:0", 409);
  error("/v1/sessions/nonsense/tileset.json", 404);

  const std::string uri = Json::parse(get(path).body)["root"]["content"]["uri"];
  const std::string folder = at + "/" + uri.substr(0, uri.rfind('/') + 1);
  EXPECT_THAT(error(folder + "9-9.glb", 404), HasSubstr("there is no tile 9-9.glb"));
  EXPECT_THAT(error(folder + "passwd", 404), HasSubstr("'passwd' is no name of a tile"));
  EXPECT_THAT(error(folder + "tileset.json", 404), HasSubstr("no name of a tile"));
  EXPECT_THAT(error(at + "/tiles/x/0-0.glb", 404), HasSubstr("tileset.json says where the tiles are"));
  EXPECT_THAT(error(at + "/tiles/" + TilesetAddress{std::string(32, '0'), "n=0006000"}.part() + "/0-0.glb", 404),
              HasSubstr("tileset.json says"));
  EXPECT_THAT(error(at + "/tiles/" + TilesetAddress{std::string(32, '0'), "n=6000"}.part() + "/0-0.glb", 404),
              HasSubstr("load tileset.json again"));
  EXPECT_THAT(error(at + "/tiles/" + TilesetAddress{std::string(32, '0'), "n=6000&seed=1"}.part() + "/0-0.glb", 404),
              HasSubstr("tileset.json says"));
  EXPECT_EQ(get(at + "/tiles").status, 404);
  EXPECT_EQ(get(at + "/tiles/x").status, 404);

  EXPECT_EQ(ask("DELETE", at).status, 204);
  EXPECT_EQ(get(folder + "0-0.glb").status, 404) << "the session has gone";
}

TEST_F(Tilesets, ACurveThatGetsFinerIsWaitedFor) {
  const std::string at = session_path(4, "500");
  const std::string path = at + "/tileset.json?n=60000&density=curvature:floor=0.3";
  const Loaded first = load(path);
  EXPECT_EQ(first.points(), 60'000u);
  const Response top = get(path);
  EXPECT_NE(field_of(top, "ETag"), "") << "it will not get better";
  EXPECT_EQ(field_of(top, "Curvecast-Refining"), "");
  EXPECT_EQ(load(path).files, first.files);
}

TEST_F(Tilesets, AreForWhoMayHaveTheSession) {
  const std::string tokens = ::testing::TempDir() + "tilesets_tokens";
  std::ofstream(tokens) << "alice 2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b\n"  // "secret"
                        << "bob 81b637d8fcd2c6da6359e6963113a1170de795e4b725b84d1e0b4cfd9ec58ce9\n";   // "bob"
  start({.tokens = tokens, .isolate = true, .http = "127.0.0.1:0"});
  const HeaderFields alice = {{"Authorization", "Bearer secret"}}, bob = {{"Authorization", "Bearer bob"}};
  const Response made = post_session(put_sphere(3, alice), "2000", alice);
  ASSERT_EQ(made.status, 200) << made.body;
  const std::string path = field_of(made, "Location") + "/tileset.json";
  EXPECT_EQ(get(path).status, 401);
  EXPECT_EQ(get(path, bob).status, 404);
  const Loaded loaded = load(path, alice);
  ASSERT_EQ(loaded.addresses.size(), 1u);
  const std::string tile = loaded.addresses.front();
  EXPECT_EQ(get(tile).status, 401);
  EXPECT_EQ(get(tile, bob).status, 404);
  const Response mine = get(tile, alice);
  EXPECT_EQ(field_of(mine, "Cache-Control"), "private, max-age=31536000, immutable");
  EXPECT_THAT(field_of(mine, "Vary"), HasSubstr("Authorization"));
  HeaderFields known = bob;
  known.emplace_back("If-None-Match", field_of(mine, "ETag"));
  EXPECT_EQ(get(tile, known).status, 404);
}

TEST_F(Tilesets, AreForPagesOfAllowedOrigins) {
  start({.http = "127.0.0.1:0", .web_origins = {"https://viewer.example.org"}});
  const std::string at = session_path();
  const HeaderFields page = {{"Origin", "https://viewer.example.org"}};
  const Response top = get(at + "/tileset.json", page);
  EXPECT_EQ(field_of(top, "Access-Control-Allow-Origin"), "https://viewer.example.org");
  const std::string tile = at + "/" + Json::parse(top.body)["root"]["content"]["uri"].get<std::string>();
  EXPECT_EQ(field_of(get(tile, page), "Access-Control-Allow-Origin"), "https://viewer.example.org");
  EXPECT_EQ(get(tile, {{"Origin", "https://evil.example.org"}}).status, 403);
  HeaderFields asked = page;
  asked.emplace_back("Access-Control-Request-Method", "GET");
  const Response may = ask("OPTIONS", tile, {}, asked);
  EXPECT_EQ(may.status, 204);
  EXPECT_EQ(field_of(may, "Access-Control-Allow-Methods"), "GET");
}

}  // namespace
}  // namespace curvecast::server
