// A server whose resources are asked for over HTTP.
#pragma once

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/server_fixture.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {

using HeaderFields = std::vector<std::pair<std::string, std::string>>;

/// The bytes of a request; with a Content-Length where there is a body.
inline std::string request_text(const std::string& method, const std::string& path, const std::string& body = {},
                                const HeaderFields& fields = {}) {
  std::string text = absl::StrCat(method, " ", path, " HTTP/1.1\r\nHost: localhost\r\n");
  for (const auto& [name, value] : fields) absl::StrAppend(&text, name, ": ", value, "\r\n");
  if (!body.empty()) absl::StrAppend(&text, "Content-Length: ", body.size(), "\r\n");
  return absl::StrCat(text, "\r\n", body);
}

/// A field of an answer's header; empty where it has none of the name.
inline std::string field_of(const HttpClient::Response& response, const std::string& name) {
  const std::string key = absl::StrCat("\r\n", absl::AsciiStrToLower(name), ": ");
  const std::size_t at = absl::AsciiStrToLower(response.header).find(key);
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size();
  return response.header.substr(begin, response.header.find("\r\n", begin) - begin);
}

class ResourcesFixture : public ServerFixture {
 protected:
  using Response = HttpClient::Response;

  void SetUp() override { start({.http = "127.0.0.1:0"}); }

  /// On a connection of its own.
  Response ask(const std::string& method, const std::string& path, const std::string& body = {},
               const HeaderFields& fields = {}) const {
    HttpClient client(server_->http_port());
    client.send(request_text(method, path, body, fields));
    return client.receive(method != "HEAD");
  }
  Response get(const std::string& path, const HeaderFields& fields = {}) const { return ask("GET", path, {}, fields); }

  static nlohmann::json json_of(const Response& response) {
    EXPECT_EQ(field_of(response, "Content-Type"), "application/json") << response.header;
    const nlohmann::json parsed = nlohmann::json::parse(response.body, nullptr, false);
    EXPECT_FALSE(parsed.is_discarded()) << response.body;
    return parsed;
  }

  /// The id of a mesh that is put there.
  std::string put_sphere(int levels = 3, const HeaderFields& fields = {}) const {
    const Response response = ask("PUT", "/v1/meshes/sphere.off", sphere_off(levels), fields);
    EXPECT_EQ(response.status, 201) << response.body;
    return json_of(response)["meshId"];
  }

  Response post_session(const std::string& mesh, const std::string& points = "2000", const HeaderFields& more = {}) const {
    HeaderFields fields = more;
    fields.emplace_back("Content-Type", "application/json");
    return ask("POST", "/v1/sessions", nlohmann::json{{"meshId", mesh}, {"options", {{"maxPoints", points}}}}.dump(), fields);
  }

  std::string make_session(int levels = 3) const {
    const Response response = post_session(put_sphere(levels));
    EXPECT_EQ(response.status, 200) << response.body;
    return json_of(response)["sessionId"];
  }
};

}  // namespace curvecast::server
