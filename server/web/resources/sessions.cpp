#include "server/web/resources/sessions.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include "server/base/log.h"
#include "server/base/protocol.h"
#include "server/web/resources/json.h"
#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;

/// Pages of others can send JSON only where this server lets them (CORS).
bool is_json(absl::string_view type) {
  return absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(type.substr(0, type.find(';'))), kJsonType);
}

/// Reads all of a body, of at most kMaxChunkBytes, and hands it to `then`.
void read_all(const std::shared_ptr<WebResource>& resource, std::string so_far, std::function<void(std::string)> then) {
  resource->read_body([resource, so_far = std::move(so_far), then = std::move(then)](absl::StatusOr<std::string> piece) mutable {
    if (!piece.ok()) return resource->fail(piece.status());
    if (piece->empty()) return then(std::move(so_far));
    if (so_far.size() + piece->size() > kMaxChunkBytes) {
      return resource->fail(
          grpc::Status(grpc::INVALID_ARGUMENT, absl::StrCat("the body has more than ", kMaxChunkBytes, " bytes")), 413);
    }
    so_far += *piece;
    read_all(resource, std::move(so_far), std::move(then));
  });
}

void create(const std::shared_ptr<WebResource>& resource, const std::string& body) {
  const auto request = std::make_shared<v1::CreateSessionRequest>();
  if (absl::Status status = parse_json(body, *request); !status.ok()) return resource->fail(status);
  request->set_without_preview(true);
  const auto session = std::make_shared<v1::Session>();
  auto* const call = new ApiReadCall<v1::CreateSessionResponse>(
      resource->calls(),
      [session](v1::CreateSessionResponse response) {
        if (response.has_session()) session->Swap(response.mutable_session());
        return absl::OkStatus();
      },
      [resource, session, request](const absl::Status& /*refused*/, const grpc::Status& status) {
        if (!status.ok()) return resource->fail(status);
        WebAnswer answer = json_answer(*session);
        answer.header.emplace_back("Location", absl::StrCat("/v1/sessions/", session->session_id()));
        resource->answer(std::move(answer));
      });
  resource->stub().async()->CreateSession(resource->introduced(), request.get(), call);
  call->start();
}

}  // namespace

void create_session(const std::shared_ptr<WebResource>& resource) {
  const std::string& type = resource->request().content_type;
  if (!is_json(absl::string_view(type))) {
    return resource->fail(grpc::Status(grpc::INVALID_ARGUMENT, absl::StrCat("the body's Content-Type is '", printable(type),
                                                                            "'; it must be application/json")),
                          415);
  }
  read_all(resource, "", [resource](const std::string& body) { create(resource, body); });
}

void list_sessions(const std::shared_ptr<WebResource>& resource) {
  absl::StatusOr<PageTerms> page = read_page_terms(resource->query());
  if (!page.ok()) return resource->fail(page.status());
  v1::ListSessionsRequest request;
  request.set_page_size(page->size);
  request.set_page_token(std::move(page->token));
  resource->call<v1::ListSessionsRequest, v1::ListSessionsResponse>(
      &Async::ListSessions, std::move(request),
      [resource](const v1::ListSessionsResponse& list) { resource->answer(json_answer(list)); });
}

void get_session(const std::shared_ptr<WebResource>& resource, const std::string& id) {
  v1::GetSessionRequest request;
  request.set_session_id(id);
  resource->call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [resource](const v1::GetSessionResponse& found) { resource->answer(json_answer(found.session())); });
}

void close_session(const std::shared_ptr<WebResource>& resource, const std::string& id) {
  v1::CloseSessionRequest request;
  request.set_session_id(id);
  resource->call<v1::CloseSessionRequest, v1::CloseSessionResponse>(
      &Async::CloseSession, std::move(request),
      [resource](const v1::CloseSessionResponse& /*empty*/) { resource->answer({.status = 204}); });
}

}  // namespace curvecast::server
