#include "server/web/resources/answers.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <cstdint>
#include <string_view>
#include <utility>

#include "server/base/build_info.h"
#include "server/base/hash.h"
#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

std::string etag_of(const std::string& id, std::uint64_t revision, const WebRequest& request) {
  Hasher hasher;
  hasher.update(absl::StrCat(build_info().version, "\n", id, "\n", revision, "\n", request.path, "?", request.query));
  return absl::StrCat("\"", hasher.hex(), "\"");
}

}  // namespace

std::string etag_of(const v1::Session& session, const WebRequest& request) {
  return etag_of(session.session_id(), session.curve_revision(), request);
}

std::string etag_of(const std::string& mesh_id, const WebRequest& request) { return etag_of(mesh_id, 0, request); }

bool matches(const WebRequest& request, const std::string& tag) {
  for (absl::string_view known : absl::StrSplit(request.if_none_match, ',')) {
    known = absl::StripAsciiWhitespace(known);
    absl::ConsumePrefix(&known, "W/");
    if (known == tag) return true;
  }
  return false;
}

WebAnswer not_modified(const std::string& tag, const std::string& cache_control) {
  return {.status = 304, .header = {{"ETag", tag}, {"Cache-Control", cache_control}}};
}

WebAnswer file_answer(std::string bytes, std::string type, const std::string& tag) {
  WebAnswer answer = {.body = std::move(bytes), .type = std::move(type)};
  if (!tag.empty()) answer.header = {{"ETag", tag}, {"Cache-Control", kAskAgain}};
  return answer;
}

std::string file_name_field(const v1::MeshInfo& mesh, const std::string& ending) {
  std::string_view name = mesh.name();
  name = name.substr(0, name.rfind('.'));
  return absl::StrCat("attachment; filename=\"", header_name_of(name), ".", ending, "\"");
}

std::shared_ptr<void> hold_queued(Engine& engine, const Caller& caller, std::size_t bytes) {
  const auto count = static_cast<std::int64_t>(bytes);
  engine.queued.add(caller.name, count);
  return std::shared_ptr<void>(nullptr, [&engine, name = caller.name, count](void*) { engine.queued.add(name, -count); });
}

}  // namespace curvecast::server
