// Files as resources: the list of them, and bodies that come in chunks.
#include "server/web/resources/meshes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/eventually.h"
#include "tests/server/two_callers.h"
#include "tests/server/web/resources/resources_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

constexpr char kBegin[] = "PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n";
constexpr char kEnd[] = "0\r\n\r\n";

std::string chunk_of(const std::string& bytes, const std::string& extension = "") {
  std::string size(16, '\0');
  size.resize(static_cast<std::size_t>(std::snprintf(size.data(), size.size(), "%zx", bytes.size())));
  return size + extension + "\r\n" + bytes + "\r\n";
}

class MeshResources : public ResourcesFixture {
 protected:
  /// What is answered to those bytes after the header of an upload.
  Response put_chunks(const std::string& chunks, const std::string& fields = "") const {
    HttpClient client(server_->http_port());
    client.send(kBegin + fields + "\r\n" + chunks);
    return client.receive();
  }
};

TEST_F(MeshResources, AreListed) {
  EXPECT_EQ(json_of(get("/v1/meshes")), nlohmann::json::parse(R"({"meshes":[],"nextPageToken":""})"));
  std::vector<std::string> sent;
  for (int levels = 1; levels < 4; ++levels) sent.push_back(put_sphere(levels));
  std::ranges::sort(sent);
  const auto first = json_of(get("/v1/meshes?page_size=2"));
  ASSERT_EQ(first["meshes"].size(), 2u) << first;
  EXPECT_EQ(first["meshes"][0]["meshId"], sent[0]);
  EXPECT_EQ(first["meshes"][1]["name"], "sphere.off");
  EXPECT_EQ(first["meshes"][1], json_of(get("/v1/meshes/" + sent[1]))) << "as one that is asked for";
  EXPECT_EQ(first["nextPageToken"], sent[1]);
  const auto last = json_of(get("/v1/meshes?page_size=2&page_token=" + sent[1]));
  ASSERT_EQ(last["meshes"].size(), 1u) << last;
  EXPECT_EQ(last["meshes"][0]["meshId"], sent[2]);
  EXPECT_EQ(last["nextPageToken"], "");
  for (const char* query : {"?page_size=many", "?page_size=-1", "?page_token=no", "?after=1", "?page_size"}) {
    EXPECT_EQ(get(std::string("/v1/meshes") + query).status, 400) << query;
  }
  EXPECT_EQ(ask("HEAD", "/v1/meshes").status, 200);
  const Response put = ask("PUT", "/v1/meshes", "OFF");
  EXPECT_EQ(put.status, 405);
  EXPECT_EQ(field_of(put, "Allow"), "GET");
  EXPECT_EQ(get("/v1/meshes/").status, 404);
}

TEST_F(MeshResources, OfOthersAreNotListed) {
  const testing::TemporaryFolder folder;
  testing::write_file(folder / "tokens", kTokens);
  for (const bool isolate : {false, true}) {
    start({.tokens = folder / "tokens", .isolate = isolate, .http = "127.0.0.1:0"});
    const HeaderFields anna = {{"Authorization", "Bearer anna's"}}, bert = {{"Authorization", "Bearer bert's"}};
    const std::string id = put_sphere(1, anna);
    const auto ids = [&](const HeaderFields& who) {
      std::vector<std::string> out;
      const auto list = json_of(get("/v1/meshes", who));
      for (const auto& mesh : list["meshes"]) out.push_back(mesh["meshId"]);
      return out;
    };
    EXPECT_THAT(ids(anna), ::testing::ElementsAre(id));
    EXPECT_THAT(ids(bert), ::testing::IsEmpty()) << "isolate: " << isolate;
    EXPECT_EQ(get("/v1/meshes").status, 401);
    EXPECT_EQ(put_sphere(1, bert), id);
    EXPECT_THAT(ids(bert), ::testing::ElementsAre(id));
  }
}

TEST_F(MeshResources, MayComeInChunks) {
  const std::string mesh = sphere_off(4), id = put_sphere(4);
  ASSERT_GT(mesh.size(), 50'000u);
  for (const std::size_t size : {std::size_t{7}, std::size_t{1000}, std::size_t{0x10000}, mesh.size()}) {
    std::string chunks;
    for (std::size_t at = 0; at < mesh.size(); at += size) chunks += chunk_of(mesh.substr(at, size));
    HttpClient client(server_->http_port());
    client.send(absl::StrCat(kBegin, "\r\n", chunks, kEnd));
    const Response response = client.receive();
    ASSERT_EQ(response.status, 201) << size << response.body;
    EXPECT_EQ(json_of(response)["meshId"], id) << size;
    EXPECT_EQ(json_of(response)["size"], std::to_string(mesh.size()));
    EXPECT_EQ(json_of(response)["mesh"]["format"], "off");
    EXPECT_EQ(client.get("/v1/meshes/" + id).status, 200) << "the connection goes on";
  }
}

TEST_F(MeshResources, ComeInChunksOnceTheServerSaysSo) {
  HttpClient client(server_->http_port());
  client.send(absl::StrCat(kBegin, "Expect: 100-continue\r\n\r\n"));
  EXPECT_EQ(client.receive().status, 100);
  client.send(chunk_of(sphere_off(1)) + kEnd);
  EXPECT_EQ(client.receive().status, 201);
}

TEST_F(MeshResources, MayHaveChunkExtensions) {
  const std::string mesh = sphere_off(1);
  const Response good = put_chunks(chunk_of(mesh, ";a=1;b=\"two; \\\"words\\\"\";c") + "0;last\r\n\r\n");
  EXPECT_EQ(good.status, 201) << good.body;
  EXPECT_EQ(put_chunks(chunk_of(mesh, ";") + kEnd).status, 400) << "without a name";
  EXPECT_EQ(put_chunks(chunk_of(mesh, ";=1") + kEnd).status, 400);
  const Response endless = put_chunks("3;a=" + std::string(100'000, 'x'));
  EXPECT_EQ(endless.status, 400) << "it has no end in sight";
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == static_cast<double>(mesh.size() + 4096); }))
      << "of the others something is left";
}

TEST_F(MeshResources, WithoutSoundChunksAreRefused) {
  const char* const broken[] = {"zz\r\nOFF\r\n0\r\n\r\n", "-3\r\nOFF\r\n0\r\n\r\n",       "3\r\nOFFxx\r\n0\r\n\r\n",
                                "\r\nOFF\r\n0\r\n\r\n",   "11111111111111111\r\nOFF\r\n", "0x3\r\nOFF\r\n0\r\n\r\n",
                                "3 OFF\r\n0\r\n\r\n\r\n"};
  for (const char* chunks : broken) {
    HttpClient client(server_->http_port());
    client.send(absl::StrCat(kBegin, "\r\n", chunks));
    const Response response = client.receive();
    EXPECT_EQ(response.status, 400) << chunks << response.body;
    EXPECT_THAT(response.body, HasSubstr("the body is no HTTP: ")) << chunks;
    EXPECT_TRUE(client.is_closed()) << "nobody can tell where another request would begin";
  }
  const Response empty = put_chunks(kEnd);
  EXPECT_EQ(empty.status, 400);
  EXPECT_THAT(empty.body, HasSubstr("empty"));
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  EXPECT_EQ(json_of(get("/v1/meshes"))["meshes"].size(), 0u);
}

TEST_F(MeshResources, HaveNoTrailers) {
  const std::string body = chunk_of(sphere_off(1));
  for (const char* trailer :
       {"A: b\r\n", "Content-Length: 3\r\n", "Authorization: Bearer x\r\n", "Transfer-Encoding: chunked\r\n"}) {
    const Response response = put_chunks(absl::StrCat(body, "0\r\n", trailer, "\r\n"));
    EXPECT_EQ(response.status, 400) << trailer << response.body;
  }
  const Response told = put_chunks(body + "0\r\nDigest: x\r\n\r\n", "Trailer: Digest\r\n");
  EXPECT_EQ(told.status, 400);
  EXPECT_THAT(told.body, HasSubstr("trailers"));
  EXPECT_EQ(put_chunks(body + "0\r\nA: " + std::string(100'000, 'x')).status, 400);
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  EXPECT_EQ(json_of(get("/v1/meshes"))["meshes"].size(), 0u);
}

TEST_F(MeshResources, ThatAreTooLargeAreRefusedAtOnce) {
  start({.max_upload_bytes = 1'000'000, .http = "127.0.0.1:0"});
  HttpClient client(server_->http_port());
  client.send(absl::StrCat(kBegin, "\r\n"));
  const std::string chunk = chunk_of(std::string(0x8000, 'x'));
  for (int i = 0; i < 31; ++i) ASSERT_TRUE(client.send(chunk)) << i;  // and a last piece, of which the client says no end
  client.send(chunk_of(std::string(0x40000, 'y')));
  const Response response = client.receive();
  EXPECT_EQ(response.status, 413) << response.body;
  EXPECT_THAT(response.body, HasSubstr("1000000"));
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  HttpClient exact(server_->http_port());
  exact.send(absl::StrCat(kBegin, "\r\n", chunk_of(std::string(1'000'000, 'x')), kEnd));
  EXPECT_EQ(exact.receive().status, 201);
  HttpClient beyond(server_->http_port());
  beyond.send(absl::StrCat(kBegin, "\r\n", chunk_of(std::string(1'000'001, 'x')), kEnd));
  EXPECT_EQ(beyond.receive().status, 413);
}

TEST_F(MeshResources, WithoutEndAreNotTakenIn) {
  start({.max_upload_bytes = 1'000'000, .http = "127.0.0.1:0"});
  HttpClient client(server_->http_port());
  client.send(absl::StrCat(kBegin, "\r\n"));
  const std::string chunk = chunk_of(std::string(0x10000, 'x'));
  int sent = 0;
  while (sent < 1000 && client.send(chunk)) ++sent;
  EXPECT_LT(sent, 1000) << "it was read to its end";
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
  EXPECT_EQ(get("/v1/meshes").status, 200);
}

TEST_F(MeshResources, ThatBreakOffLeaveNothing) {
  for (const std::string& rest : {std::string(), std::string("800"), std::string("800\r\nxyz"), std::string("0\r\n")}) {
    {
      HttpClient client(server_->http_port());
      client.send(absl::StrCat(kBegin, "\r\n", chunk_of(std::string(300'000, 'x')), rest));
      ASSERT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") > 200'000; })) << rest;
    }
    EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; })) << rest;
  }
  EXPECT_EQ(json_of(get("/v1/meshes"))["meshes"].size(), 0u);
}

TEST_F(MeshResources, ThatTrickleEnd) {
  // One brings bytes, one only extensions of chunks, one an extension without an end: all of them for ever.
  struct Trickle {
    std::string drop;
    HttpClient client;
    bool is_over = false;
  };
  const int port = server_->http_port();
  Trickle trickles[] = {{"1\r\nx\r\n", HttpClient(port)}, {"1;a=b\r\nx\r\n", HttpClient(port)}, {"x", HttpClient(port)}};
  for (Trickle& one : trickles) one.client.send(absl::StrCat(kBegin, "\r\n", one.drop == "x" ? "1;a=" : ""));
  const auto began = std::chrono::steady_clock::now();
  while (std::ranges::any_of(trickles, [](const Trickle& one) { return !one.is_over; })) {
    for (Trickle& one : trickles) one.is_over = one.is_over || !one.client.send(one.drop);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ASSERT_LT(std::chrono::steady_clock::now() - began, std::chrono::seconds(100));
  }
  EXPECT_TRUE(eventually([&] { return metric("curvecast_mesh_bytes") == 0; }));
}

TEST_F(MeshResources, OfAnotherCodingAreRefused) {
  // A body whose end others see elsewhere could hide a request.
  const std::string hidden = "GET /v1/meshes HTTP/1.1\r\nHost: localhost\r\n\r\n";
  for (const char* coding : {"gzip", "gzip, chunked", "chunked, gzip", "chunked;q=1", "identity", "xchunked", "\"chunked\""}) {
    HttpClient client(server_->http_port());
    client.send(
        absl::StrCat("PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: ", coding, "\r\n\r\n", hidden));
    EXPECT_EQ(client.receive().status, 501) << coding;
    EXPECT_EQ(client.receive().status, 0) << coding << ": what follows is no request";
  }
  for (const char* fields :
       {"Transfer-Encoding: chunked\r\nContent-Length: 3\r\n", "Content-Length: 3\r\nTransfer-Encoding: chunked\r\n",
        "Transfer-Encoding: chunked\r\nTransfer-Encoding: gzip\r\n"}) {
    HttpClient client(server_->http_port());
    client.send(absl::StrCat("PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\n", fields, "\r\n3\r\nOFF\r\n0\r\n\r\n"));
    EXPECT_EQ(client.receive().status, 400) << fields;
  }
  HttpClient old(server_->http_port());
  old.send("PUT /v1/meshes/a.off HTTP/1.0\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nOFF\r\n0\r\n\r\n");
  EXPECT_EQ(old.receive().status, 400);
  HttpClient loud(server_->http_port());
  loud.send("PUT /v1/meshes/a.off HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: Chunked\r\n\r\n3\r\nOFF\r\n0\r\n\r\n");
  EXPECT_EQ(loud.receive().status, 201);
}

}  // namespace
}  // namespace curvecast::server
