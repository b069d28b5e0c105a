// Whether the description of the resources is true: every operation in it is called.
#include "server/web/resources/openapi.h"

#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>
#include <gmock/gmock.h>

#include <set>

#include "tests/server/web/resources/resources_fixture.h"

namespace curvecast::server {
namespace {

using Json = nlohmann::json;

class OpenApi : public ResourcesFixture {
 protected:
  const Json document_ = Json::parse(kOpenApi);

  const Json& resolve(const Json& node) const {
    return node.contains("$ref") ? document_.at(Json::json_pointer(node["$ref"].get<std::string>().substr(1))) : node;
  }

  /// Checks what an object has against its schema: what must be there is, and what is there has its type.
  void check(const Json& value, const Json& schema_or_ref, const std::string& where) const {
    const Json& schema = resolve(schema_or_ref);
    if (!schema.contains("type")) return;
    const std::set<std::string> types = schema["type"].is_array() ? schema["type"].get<std::set<std::string>>()
                                                                  : std::set<std::string>{schema["type"].get<std::string>()};
    const auto has = [&](const char* type) { return types.count(type) > 0; };
    const bool fits = (has("object") && value.is_object()) || (has("array") && value.is_array()) ||
                      (has("string") && value.is_string()) || (has("number") && value.is_number()) ||
                      (has("integer") && value.is_number_integer()) || (has("boolean") && value.is_boolean()) ||
                      (has("null") && value.is_null());
    EXPECT_TRUE(fits) << where << " is " << value.dump().substr(0, 100);
    if (schema.contains("enum")) {
      EXPECT_TRUE(std::find(schema["enum"].begin(), schema["enum"].end(), value) != schema["enum"].end()) << where << value;
    }
    for (const auto& name : schema.value("required", Json::array())) {
      EXPECT_TRUE(value.contains(name.get<std::string>())) << where << " lacks " << name;
    }
    const Json properties = schema.value("properties", Json::object());
    for (const auto& [name, property] : properties.items()) {
      if (value.contains(name)) check(value[name], property, where + "." + name);
    }
    if (schema.contains("items") && value.is_array() && !value.empty()) check(value[0], schema["items"], where + "[0]");
  }

  /// The answer is one that the operation says it may be.
  void check_answer(const Response& response, const Json& operation, const std::string& where) const {
    const std::string status = std::to_string(response.status);
    ASSERT_TRUE(operation["responses"].contains(status)) << where << ": " << status << " " << response.body;
    const Json& described = resolve(operation["responses"][status]);
    if (!described.contains("content")) {
      EXPECT_EQ(response.body, "") << where;
      return;
    }
    const std::string type = field_of(response, "Content-Type");
    ASSERT_TRUE(described["content"].contains(type)) << where << ": " << type;
    const Json headers = described.value("headers", Json::object());
    for (const auto& [name, header] : headers.items()) {
      // One of the two: points that get better have no name.
      const bool may_lack =
          name == "Curvecast-Refining" || (name == "ETag" && field_of(response, "Curvecast-Refining") == "true");
      EXPECT_TRUE(may_lack || !field_of(response, name).empty()) << where << " lacks " << name;
    }
    if (type == "application/json") check(Json::parse(response.body), described["content"][type]["schema"], where);
  }

  /// The query with an example, or the first of an enumeration, or the default for each parameter.
  std::string query_of(const Json& operation) const {
    std::string query;
    for (const Json& each : operation.value("parameters", Json::array())) {
      const Json& parameter = resolve(each);
      if (parameter["in"] != "query" || parameter["name"] == "pixel_error" || parameter["name"] == "page_token" ||
          parameter["name"] == "mesh_id" || parameter["name"] == "companion") {
        continue;
      }
      const Json& schema = parameter["schema"];
      Json value = parameter.contains("example") ? parameter["example"]
                   : schema.contains("enum")     ? schema["enum"][0]
                                                 : schema.value("default", Json());
      if (!value.is_array()) value = Json::array({value});
      for (const Json& one : value) {
        const std::string text = one.is_string() ? one.get<std::string>() : one.dump();
        absl::StrAppend(&query, query.empty() ? "?" : "&", parameter["name"].get<std::string>(), "=", text);
      }
    }
    return query;
  }
};

TEST_F(OpenApi, IsWhatTheServerSays) {
  const Response response = get("/v1/openapi.json");
  EXPECT_EQ(response.status, 200);
  EXPECT_EQ(response.body, kOpenApi);
}

TEST_F(OpenApi, EveryOperationIsThere) {
  const std::string session = make_session();
  const Json tileset = json_of(get("/v1/sessions/" + session + "/tileset.json"));
  const std::vector<std::string> tile = absl::StrSplit(tileset["root"]["content"]["uri"].get<std::string>(), '/');
  std::set<std::string> seen;
  for (const auto& [path, item] : document_["paths"].items()) {
    for (const auto& [method, operation] : item.items()) {
      if (method == "parameters" || method == "delete") continue;
      const std::string where = method + " " + path;
      seen.insert(operation["operationId"]);
      const std::string at = absl::StrReplaceAll(path, {{"{session}", session},
                                                        {"{mesh}", method == "put" ? "a.off" : put_sphere(1)},
                                                        {"{set}", tile.at(1)},
                                                        {"{file}", tile.at(2)}});
      Response response;
      if (method == "get") {
        response = get(at + query_of(operation));
      } else if (method == "put") {
        response = ask("PUT", at + query_of(operation), sphere_off(1));
      } else {
        response = post_session(put_sphere(1));
      }
      EXPECT_TRUE(response.status == 501 || response.status / 100 == 2) << where << query_of(operation) << ": " << response.body;
      check_answer(response, operation, where);
      check_answer(get(at + "?nonsense=1", {{"Origin", "https://evil.example"}}), operation, where + " of a foreign page");
    }
  }
  const Json& closing = document_["paths"]["/v1/sessions/{session}"]["delete"];
  check_answer(ask("DELETE", "/v1/sessions/" + session), closing, "delete");
  check_answer(ask("DELETE", "/v1/sessions/" + session), closing, "delete again");
  EXPECT_EQ(seen.size(), 27u);
}

TEST_F(OpenApi, NothingElseIsAnswered) {
  // Every path of the document, but with another method: the methods that are allowed are those of the document.
  for (const auto& [path, item] : document_["paths"].items()) {
    const Response response = ask("PATCH", absl::StrReplaceAll(path, {{"{session}", "x"}, {"{mesh}", "x"}}));
    EXPECT_EQ(response.status, 405) << path;
    std::set<std::string> described;
    for (const auto& [method, operation] : item.items()) {
      if (method != "parameters") described.insert(absl::AsciiStrToUpper(method));
    }
    const std::vector<std::string> allowed = absl::StrSplit(field_of(response, "Allow"), ", ");
    EXPECT_EQ(std::set<std::string>(allowed.begin(), allowed.end()), described) << path;
  }
}

}  // namespace
}  // namespace curvecast::server
