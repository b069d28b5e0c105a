#include "server/web/resources/meshes.h"

#include <absl/strings/str_cat.h>

#include <nlohmann/json.hpp>

#include "server/base/log.h"
#include "server/web/resources/json.h"

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
    header.set_size(*resource_->request().body_bytes);
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
    if (!ok) return RemoveHold();  // the call is over, and OnDone() says why
    resource_->read_body([this](absl::StatusOr<std::string> piece) { send(std::move(piece)); });
  }

  void send(absl::StatusOr<std::string> piece) {
    if (!piece.ok()) {
      broken_ = piece.status();
      resource_->cancel();
      return RemoveHold();
    }
    if (piece->empty()) {
      StartWritesDone();
      return RemoveHold();
    }
    request_.set_chunk(*std::move(piece));
    StartWrite(&request_);
  }

  void OnDone(const grpc::Status& status) override {
    const std::unique_ptr<Upload> self(this);
    if (!broken_.ok()) return resource_->fail(broken_);
    if (!status.ok()) {
      const bool is_too_large = status.error_code() == grpc::RESOURCE_EXHAUSTED &&
                                *resource_->request().body_bytes > resource_->engine().meshes.max_file_bytes();
      return resource_->fail(status, is_too_large ? 413 : 0);
    }
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
  absl::Status broken_;  // what was wrong with the body
};

}  // namespace

void put_mesh(const std::shared_ptr<WebResource>& resource, const std::string& name) {
  absl::StatusOr<UploadTerms> terms = read_terms(*resource, name);
  if (!terms.ok()) return resource->fail(terms.status());
  if (!resource->request().body_bytes && resource->request().has_body) {
    return resource->fail(
        grpc::Status(grpc::INVALID_ARGUMENT, "say how long the file is, with Content-Length: a chunked body does not tell"), 411);
  }
  if (!resource->request().has_body) {
    return resource->fail(absl::InvalidArgumentError("the body is empty; it is the file"));
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
