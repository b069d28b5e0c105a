#include "server/web/resources/tilesets.h"

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include <utility>

#include "server/base/log.h"
#include "server/web/resources/answers.h"
#include "server/web/resources/json.h"
#include "server/web/resources/point_file.h"
#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;
using Resource = std::shared_ptr<WebResource>;

constexpr char kSeconds[] = "31536000";  // of a year, the most that caches are asked to keep anything

void with_session(const Resource& resource, const std::string& id, std::function<void(const v1::Session&)> then) {
  v1::GetSessionRequest request;
  request.set_session_id(id);
  resource->call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [then = std::move(then)](const v1::GetSessionResponse& found) { then(found.session()); });
}

void send(const Resource& resource, WebAnswer answer) {
  answer.held = hold_queued(resource->engine(), resource->caller(), answer.body.size());
  resource->answer(std::move(answer));
}

/// Refuses who does not read what was sent to him.
bool may_send(const Resource& resource) {
  const absl::Status status = resource->engine().queued.check(resource->caller().name);
  if (!status.ok()) resource->fail(status);
  return status.ok();
}

void answer_tileset(const Resource& resource, v1::Session session, const Tileset& set) {
  session.set_curve_revision(set.revision);
  WebAnswer answer =
      file_answer(set.files.at(formats::kTilesetName), kJsonType, set.is_final ? etag_of(session, resource->request()) : "");
  if (set.is_refining) answer.header.emplace_back("Curvecast-Refining", "true");
  send(resource, std::move(answer));
}

/// What a tile's address and name say, once they make sense.
struct TileTerms {
  TilesetAddress address;
  std::string name;
  TilesetTerms tileset;

  std::string tag() const { return absl::StrCat("\"", address.digest, "-", name, "\""); }
};

absl::StatusOr<TileTerms> read_tile_terms(const std::string& part, const std::string& name) {
  absl::StatusOr<TilesetAddress> address = read_tileset_address(part);
  if (!address.ok()) return address.status();
  const absl::StatusOr<WebResource::Query> query = parse_query(address->text);
  if (!query.ok()) return no_such_tileset();
  absl::StatusOr<TilesetTerms> terms = read_tileset_query(*query);
  if (!terms.ok() || !terms->sample.has_points()) return no_such_tileset();
  if (tileset_text(*query, terms->sample.points()).value_or("") != address->text) return no_such_tileset();
  if (!formats::is_tile_name(name)) return absl::NotFoundError(absl::StrCat("'", printable(name), "' is no name of a tile"));
  return TileTerms{*std::move(address), name, *std::move(terms)};
}

/// Whoever has the address may keep the bytes, which never change; where callers are known, caches that several of them share may
/// not.
std::string cache_control(const Engine& engine) {
  return absl::StrCat(engine.knows_callers() ? "private" : "public", ", max-age=", kSeconds, ", immutable");
}

void answer_tile(const Resource& resource, const TileTerms& terms, const Tileset& set) {
  if (set.digest != terms.address.digest) {
    return resource->fail(absl::NotFoundError(
        "these tiles are not there any more: the session's points have become better, or the server is another version; load "
        "tileset.json again"));
  }
  const auto file = set.files.find(terms.name);
  if (file == set.files.end()) {
    return resource->fail(absl::NotFoundError(absl::StrCat("there is no tile ", terms.name, " in this set")));
  }
  send(resource, {.body = file->second,
                  .type = absl::EndsWith(terms.name, ".json") ? kJsonType : std::string(find_point_file_kind("glb")->type),
                  .header = {{"ETag", terms.tag()}, {"Cache-Control", cache_control(resource->engine())}}});
}

}  // namespace

void get_tileset(const Resource& resource, const std::shared_ptr<TilesetJobs>& jobs, const std::string& session_id) {
  absl::StatusOr<TilesetTerms> terms = read_tileset_query(resource->query());
  if (!terms.ok()) return resource->fail(terms.status());
  with_session(resource, session_id, [resource, jobs, terms = *std::move(terms)](const v1::Session& session) mutable {
    const std::string tag = etag_of(session, resource->request());
    if (matches(resource->request(), tag)) return resource->answer(not_modified(tag));
    if (!terms.sample.has_points()) terms.sample.set_points(session.options().max_points());
    const absl::StatusOr<std::string> text = tileset_text(resource->query(), terms.sample.points());
    if (!text.ok()) return resource->fail(text.status());
    if (!may_send(resource)) return;
    const auto is_newest = [&](const Tileset& set) { return set.is_final && set.revision == session.curve_revision(); };
    if (const auto set = resource->engine().tilesets.find(session.session_id(), *text, is_newest)) {
      return answer_tileset(resource, session, *set);
    }
    jobs->make(resource, session.session_id(), terms, *text,
               [resource, session](const grpc::Status& status, const std::shared_ptr<const Tileset>& set) {
                 set == nullptr ? resource->fail(status) : answer_tileset(resource, session, *set);
               });
  });
}

void get_tile(const Resource& resource, const std::shared_ptr<TilesetJobs>& jobs, const std::string& session_id,
              const std::string& part, const std::string& name) {
  absl::StatusOr<TileTerms> read = read_tile_terms(part, name);
  if (!read.ok()) return resource->fail(read.status());
  with_session(resource, session_id, [resource, jobs, terms = *std::move(read)](const v1::Session& session) {
    if (matches(resource->request(), terms.tag())) {
      return resource->answer(not_modified(terms.tag(), cache_control(resource->engine())));
    }
    if (!may_send(resource)) return;
    TilesetCache& cache = resource->engine().tilesets;
    const std::string& text = terms.address.text;
    auto set = cache.find(session.session_id(), text, [&](const Tileset& kept) { return kept.digest == terms.address.digest; });
    if (set == nullptr) {
      set = cache.find(session.session_id(), text,
                       [&](const Tileset& kept) { return kept.is_final && kept.revision == session.curve_revision(); });
    }
    if (set != nullptr) return answer_tile(resource, terms, *set);
    jobs->make(resource, session.session_id(), terms.tileset, text,
               [resource, terms](const grpc::Status& status, const std::shared_ptr<const Tileset>& made) {
                 made == nullptr ? resource->fail(status) : answer_tile(resource, terms, *made);
               });
  });
}

}  // namespace curvecast::server
