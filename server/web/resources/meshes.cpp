#include "server/web/resources/meshes.h"

#include <absl/strings/str_cat.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include "server/base/grpc_status.h"
#include "server/base/log.h"
#include "server/web/resources/json.h"
#include "server/web/resources/query.h"

namespace curvecast::server {
namespace {

using Json = nlohmann::ordered_json;
using Async = v1::CurvecastService::StubInterface::async_interface;

struct UploadTerms {
  std::string name, mesh_id;
  bool inspects = true;
};

absl::StatusOr<UploadTerms> read_terms(const WebResource& resource, const std::string& name) {
  UploadTerms terms{.name = name};
  for (const auto& [key, value] : resource.query()) {
    if (key == "mesh_id") {
      terms.mesh_id = value;
    } else if (key == "inspect" && (value == "true" || value == "false")) {
      terms.inspects = value == "true";
    } else {
      return absl::InvalidArgumentError(absl::StrCat("query: '", printable(key + "=" + value),
                                                     "' is nothing that an upload has; there are: mesh_id, inspect=true|false"));
    }
  }
  return terms;
}

/// What became of an upload; a file that cannot be inspected, such as a texture, is there all the same.
void tell(const std::shared_ptr<WebResource>& resource, const std::string& name, const v1::UploadMeshResponse& uploaded,
          const grpc::Status& inspected, const v1::InspectMeshResponse& found) {
  Json body = {{"meshId", uploaded.mesh_id()}, {"name", name}, {"size", absl::StrCat(uploaded.size())}};
  if (found.has_mesh()) body["mesh"] = Json::parse(to_json(found.mesh()));
  if (!inspected.ok()) body["problem"] = Json::parse(error_answer(inspected).body);
  resource->answer({.status = 201,
                    .body = body.dump() + "\n",
                    .type = kJsonType,
                    .header = {{"Location", absl::StrCat("/v1/meshes/", uploaded.mesh_id())}}});
}

/// One UploadMesh, to which the body goes piece by piece, each when the one before has been taken. Deletes itself when it is
/// over.
class Upload final : public grpc::ClientWriteReactor<v1::UploadMeshRequest> {
 public:
  Upload(std::shared_ptr<WebResource> resource, UploadTerms terms) : resource_(std::move(resource)), terms_(std::move(terms)) {
    v1::UploadHeader& header = *request_.mutable_header();
    header.set_name(terms_.name);
    const std::optional<std::uint64_t>& size = resource_->request().body_bytes;
    size ? header.set_size(*size) : header.set_size_is_unknown(true);
    header.set_mesh_id(terms_.mesh_id);
  }

  void start() {
    resource_->stub().async()->UploadMesh(resource_->introduced(), &response_, this);
    AddHold();  // of who reads the body: a write may begin between two of gRPC's calls of this
    StartWrite(&request_);
    StartCall();
  }

 private:
  void OnWriteDone(bool ok) override {
    if (!ok || has_ended_) return RemoveHold();  // not ok: the call is over, and OnDone() says why
    resource_->read_body([this](absl::StatusOr<std::string> piece) { send(std::move(piece)); });
  }

  void send(absl::StatusOr<std::string> piece) {
    if (!piece.ok()) {
      broken_ = piece.status();
      resource_->cancel();
      return RemoveHold();
    }
    if (piece->empty()) {
      has_ended_ = true;
      request_.set_chunk("");  // which says, where nobody knew the size, that the file is whole
      return StartWriteLast(&request_, grpc::WriteOptions());
    }
    received_ += piece->size();
    const std::uint64_t most = resource_->engine().meshes.max_file_bytes();
    if (received_ > most) {  // the call would say so only once the client sends more
      broken_ = absl::ResourceExhaustedError(absl::StrCat("the file has more bytes than this server takes, ", most));
      resource_->cancel();
      return RemoveHold();
    }
    request_.set_chunk(*std::move(piece));
    StartWrite(&request_);
  }

  void OnDone(const grpc::Status& status) override {
    const std::unique_ptr<Upload> self(this);
    if (!broken_.ok()) return resource_->fail(to_grpc(broken_), absl::IsResourceExhausted(broken_) ? 413 : 0);
    if (!status.ok()) return resource_->fail(status);
    if (!terms_.inspects) return tell(resource_, terms_.name, response_, grpc::Status::OK, {});
    inspect();
  }

  void inspect() {
    struct Messages {
      v1::InspectMeshRequest request;
      v1::InspectMeshResponse response;
    };
    const auto messages = std::make_shared<Messages>();
    messages->request.set_mesh_id(response_.mesh_id());
    resource_->stub().async()->InspectMesh(
        resource_->introduced(), &messages->request, &messages->response,
        [resource = resource_, name = terms_.name, uploaded = response_, messages](const grpc::Status& status) {
          tell(resource, name, uploaded, status, messages->response);
        });
  }

  const std::shared_ptr<WebResource> resource_;
  const UploadTerms terms_;
  v1::UploadMeshRequest request_;
  v1::UploadMeshResponse response_;
  bool has_ended_ = false;
  std::uint64_t received_ = 0;  // bytes of the body
  absl::Status broken_;         // what was wrong with the body
};

}  // namespace

void list_meshes(const std::shared_ptr<WebResource>& resource) {
  absl::StatusOr<PageTerms> page = read_page_terms(resource->query());
  if (!page.ok()) return resource->fail(page.status());
  v1::ListMeshesRequest request;
  request.set_page_size(page->size);
  request.set_page_token(std::move(page->token));
  resource->call<v1::ListMeshesRequest, v1::ListMeshesResponse>(
      &Async::ListMeshes, std::move(request),
      [resource](const v1::ListMeshesResponse& list) { resource->answer(json_answer(list)); });
}

void put_mesh(const std::shared_ptr<WebResource>& resource, const std::string& name) {
  absl::StatusOr<UploadTerms> terms = read_terms(*resource, name);
  if (!terms.ok()) return resource->fail(terms.status());
  if (!resource->request().has_body) {
    return resource->fail(absl::InvalidArgumentError("the body is empty; it is the file"));
  }
  const std::uint64_t size = resource->request().body_bytes.value_or(0), most = resource->engine().meshes.max_file_bytes();
  if (size > most) {  // rather now than when the first of it has come
    const std::string why = absl::StrCat("the file has ", size, " bytes; this server takes at most ", most);
    return resource->fail(grpc::Status(grpc::RESOURCE_EXHAUSTED, why), 413);
  }
  (new Upload(resource, *std::move(terms)))->start();
}

void get_mesh(const std::shared_ptr<WebResource>& resource, const std::string& id) {
  v1::GetMeshRequest request;
  request.set_mesh_id(id);
  resource->call<v1::GetMeshRequest, v1::GetMeshResponse>(
      &Async::GetMesh, std::move(request), [resource](const v1::GetMeshResponse& mesh) { resource->answer(json_answer(mesh)); });
}

}  // namespace curvecast::server
