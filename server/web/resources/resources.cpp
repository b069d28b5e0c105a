#include "server/web/resources/resources.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>
#include <spdlog/logger.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "server/base/grpc_status.h"
#include "server/base/log.h"
#include "server/base/status_from_exceptions.h"
#include "server/web/resources/json.h"
#include "server/web/resources/meshes.h"
#include "server/web/resources/openapi.h"
#include "server/web/resources/picture.h"
#include "server/web/resources/points.h"
#include "server/web/resources/query.h"
#include "server/web/resources/resource.h"
#include "server/web/resources/sessions.h"
#include "server/web/resources/tilesets.h"

namespace curvecast::server {
namespace {

using Resource = const std::shared_ptr<WebResource>&;

constexpr char kPrefix[] = "/v1/";
constexpr char kMayBeRead[] =
    "ETag, Location, Retry-After, Content-Disposition, Curvecast-Radius-Range, Curvecast-Refining";  // by pages of other origins

/// What can be done with a resource, by method.
struct Actions {
  std::vector<std::pair<std::string, std::function<void(Resource)>>> by_method;

  std::string methods() const {
    return absl::StrJoin(by_method, ", ", [](std::string* out, const auto& action) { out->append(action.first); });
  }
};

using Tilesets = const std::shared_ptr<TilesetJobs>&;

using GetPoints = void (*)(Resource, const std::string& id, const PointFileKind& kind);

/// Points of what has this id, as a file of this ending.
Actions points_file(const std::string& id, const std::string& ending, GetPoints get) {
  const PointFileKind* const kind = find_point_file_kind(ending);
  return {{{"GET", [id, kind, ending, get](Resource resource) {
              if (kind != nullptr) return get(resource, id, *kind);
              resource->fail(absl::NotFoundError(
                  absl::StrCat("there are no points.", printable(ending), "; there are: ", point_file_endings())));
            }}}};
}

/// The stem and the ending of a file.
std::pair<std::string, std::string> parts_of(const std::string& file) { return absl::StrSplit(file, absl::MaxSplits('.', 1)); }

Actions mesh_file(const std::string& id, const std::string& file) {
  const auto [stem, ending] = parts_of(file);
  return stem == "points" ? points_file(id, ending, get_scattered_points) : Actions();
}

Actions session_file(const std::string& id, const std::string& file, Tilesets tilesets) {
  if (file == formats::kTilesetName) {
    return {{{"GET", [id, tilesets](Resource resource) { get_tileset(resource, tilesets, id); }}}};
  }
  const auto [stem, ending] = parts_of(file);
  if (stem == "points") return points_file(id, ending, get_points);
  if (stem == "picture" && (ending == "png" || ending == "jpg")) {
    const v1::PictureFormat format = ending == "png" ? v1::PICTURE_FORMAT_PNG : v1::PICTURE_FORMAT_JPEG;
    return {{{"GET", [id, format](Resource resource) { get_picture(resource, id, format); }}}};
  }
  return {};
}

void get_document(Resource resource) {
  resource->answer({.body = std::string(kOpenApi), .type = kJsonType, .header = {{"Cache-Control", "no-cache"}}});
}

/// What is there at a path, whose parts are decoded; nothing where there is no such resource.
Actions find(const std::vector<std::string>& path, Tilesets tilesets) {
  const std::string& first = path.front();
  if (path.size() == 1 && first == "openapi.json") return {{{"GET", get_document}}};
  if (path.size() == 1 && first == "meshes") return {{{"GET", list_meshes}}};
  if (path.size() == 2 && first == "meshes" && !path[1].empty()) {
    return {{{"GET", [id = path[1]](Resource resource) { get_mesh(resource, id); }},
             {"PUT", [name = path[1]](Resource resource) { put_mesh(resource, name); }}}};
  }
  if (path.size() == 3 && first == "meshes") return mesh_file(path[1], path[2]);
  if (first != "sessions") return {};
  if (path.size() == 1) return {{{"GET", list_sessions}, {"POST", create_session}}};
  if (path.size() == 2 && !path[1].empty()) {
    return {{{"GET", [id = path[1]](Resource resource) { get_session(resource, id); }},
             {"DELETE", [id = path[1]](Resource resource) { close_session(resource, id); }}}};
  }
  if (path.size() == 5 && path[2] == "tiles") {
    return {{{"GET", [path, tilesets](Resource resource) { get_tile(resource, tilesets, path[1], path[3], path[4]); }}}};
  }
  return path.size() == 3 ? session_file(path[1], path[2], tilesets) : Actions();
}

absl::StatusOr<std::vector<std::string>> split_path(std::string_view path) {
  std::vector<std::string> parts;
  path.remove_prefix(sizeof kPrefix - 1);
  for (const absl::string_view part : absl::StrSplit(absl::string_view(path.data(), path.size()), '/')) {
    absl::StatusOr<std::string> decoded = percent_decoded({part.data(), part.size()}, false);
    if (!decoded.ok()) return decoded.status();
    parts.push_back(*std::move(decoded));
  }
  return parts;
}

class Resources {
 public:
  Resources(Engine& engine, std::shared_ptr<grpc::Channel> channel, WebOrigins origins, const WebResourceLimits& limits)
      : engine_(engine),
        channel_(std::move(channel)),
        origins_(std::move(origins)),
        tilesets_(std::make_shared<TilesetJobs>(engine_, channel_)),
        admission_(std::make_shared<Admission>("requests for resources", limits.most, limits.most_of_client)) {}

  bool are_open() const { return admission_->count() > 0; }

  void begin(std::shared_ptr<WebExchange> exchange) const {
    const WebRequest& request = exchange->request();
    const WebPage page{.origin = request.origin, .host = request.host, .fetch_site = request.fetch_site};
    if (absl::Status status = check_page(origins_, page); !status.ok()) return refuse(*exchange, status, 0, {});
    const WebResource::Fields fields = fields_for(request);
    absl::StatusOr<std::vector<std::string>> path = split_path(request.path);
    if (!path.ok()) return refuse(*exchange, path.status(), 0, fields);
    const Actions actions = find(*path, tilesets_);
    if (actions.by_method.empty()) return refuse(*exchange, absl::NotFoundError("there is nothing of this name"), 0, fields);
    if (request.method == "OPTIONS") return tell_options(*exchange, actions, fields);
    const std::string method = request.method == "HEAD" ? "GET" : request.method;
    const auto action = std::find_if(actions.by_method.begin(), actions.by_method.end(),
                                     [&](const auto& known) { return known.first == method; });
    if (action == actions.by_method.end()) {
      WebResource::Fields allowed = fields;
      allowed.emplace_back("Allow", actions.methods());
      return refuse(*exchange, absl::InvalidArgumentError(absl::StrCat("there are: ", actions.methods())), 405, allowed);
    }
    start(std::move(exchange), fields, action->second);
  }

 private:
  void start(std::shared_ptr<WebExchange> exchange, const WebResource::Fields& fields,
             const std::function<void(Resource)>& act) const {
    const WebRequest& request = exchange->request();
    const absl::StatusOr<Caller> caller = identify(engine_, request.peer);
    if (!caller.ok()) {
      engine_.metrics.unauthenticated();
      engine_.log->info("http: refused {}: {}", request.peer.address, std::string(caller.status().message()));
      return refuse(*exchange, caller.status(), 0, fields);
    }
    absl::StatusOr<WebResource::Query> query = parse_query(request.query);
    if (!query.ok()) return refuse(*exchange, query.status(), 0, fields);
    absl::StatusOr<Admission::Ticket> ticket = admission_->admit(caller->name);
    if (!ticket.ok()) return refuse(*exchange, ticket.status(), 0, fields);
    const auto resource = std::make_shared<WebResource>(engine_, channel_, std::move(exchange), *caller, *std::move(query),
                                                        fields, *std::move(ticket));
    resource->watch();
    const absl::Status begun = status_from_exceptions([&] {
      act(resource);
      return absl::OkStatus();
    });
    if (!begun.ok()) resource->fail(begun);
  }

  /// What the header of every answer to a request has.
  WebResource::Fields fields_for(const WebRequest& request) const {
    WebResource::Fields fields = {{"Vary", "Origin, Authorization"}, {"Cross-Origin-Resource-Policy", "same-origin"}};
    if (request.origin.empty()) return fields;
    fields.emplace_back("Access-Control-Allow-Origin", request.origin);
    fields.emplace_back("Access-Control-Expose-Headers", kMayBeRead);
    return fields;
  }

  static void tell_options(WebExchange& exchange, const Actions& actions, const WebResource::Fields& fields) {
    WebAnswer answer{.status = 204, .header = fields};
    answer.header.emplace_back("Allow", absl::StrCat(actions.methods(), ", OPTIONS"));
    if (!exchange.request().preflight_method.empty()) {
      answer.header.emplace_back("Access-Control-Allow-Methods", actions.methods());
      answer.header.emplace_back("Access-Control-Allow-Headers", "Authorization, Content-Type, If-None-Match, X-Request-Id");
      answer.header.emplace_back("Access-Control-Max-Age", "600");
    }
    exchange.answer(std::move(answer));
  }

  static void refuse(WebExchange& exchange, const absl::Status& status, int http_status, const WebResource::Fields& fields) {
    WebAnswer answer = error_answer(to_grpc(status), http_status);
    answer.header.insert(answer.header.end(), fields.begin(), fields.end());
    exchange.answer(std::move(answer));
  }

  Engine& engine_;
  const std::shared_ptr<grpc::Channel> channel_;
  const WebOrigins origins_;
  const std::shared_ptr<TilesetJobs> tilesets_;
  const std::shared_ptr<Admission> admission_;
};

}  // namespace

WebResources web_resources(Engine& engine, std::shared_ptr<grpc::Channel> channel, WebOrigins origins,
                           const WebResourceLimits& limits) {
  const auto resources = std::make_shared<const Resources>(engine, std::move(channel), std::move(origins), limits);
  return {.prefix = kPrefix,
          .begin = [resources](std::shared_ptr<WebExchange> exchange) { resources->begin(std::move(exchange)); },
          .are_open = [resources] { return resources->are_open(); }};
}

}  // namespace curvecast::server
