#include "server/web/resources/points.h"

#include <cstdint>
#include <utility>

#include "server/base/status_from_exceptions.h"
#include "server/web/resources/answers.h"
#include "server/web/resources/points_terms.h"

namespace curvecast::server {
namespace {

using Async = v1::CurvecastService::StubInterface::async_interface;

constexpr std::uint64_t kBytesOfPoint = 3;  // copies of a point's columns: as they come, gathered, and in the file

/// One request, from a call that sends points to their file. Kept by its calls.
class PointsRequest : public std::enable_shared_from_this<PointsRequest> {
 public:
  virtual ~PointsRequest() = default;

 protected:
  PointsRequest(std::shared_ptr<WebResource> resource, const PointFileKind& kind, PointsTerms terms)
      : terms_(std::move(terms)),
        resource_(std::move(resource)),
        kind_(kind),
        memory_(resource_->engine().memory, &resource_->gone(), {.waits = false}) {}

  WebResource& resource() const { return *resource_; }

  /// Whether the client has what `tag` names, or has so much to take already that it has been answered.
  bool is_answered(std::string tag) {
    tag_ = std::move(tag);
    if (matches(resource_->request(), tag_)) return resource_->answer(not_modified(tag_)), true;
    const absl::Status status = resource_->engine().queued.check(resource_->caller().name);
    if (!status.ok()) resource_->fail(status);
    return !status.ok();
  }

  /// Makes a call that sends points, each message of which `take` is given.
  template <class Request, class Response, class Take>
  void call(void (Async::*method)(grpc::ClientContext*, const Request*, grpc::ClientReadReactor<Response>*),
            const Request& request, const Take& take) {
    auto* const call = new ApiReadCall<Response>(
        resource_->calls(), [self = shared_from_this(), take](const Response& response) { return take(response); },
        [self = shared_from_this()](const absl::Status& refused, const grpc::Status& status) {
          if (!refused.ok()) return self->resource_->fail(refused);
          status.ok() ? self->make() : self->resource_->fail(status);
        });
    (resource_->stub().async()->*method)(resource_->introduced(), &request, call);
    call->start();
  }

  absl::Status take(const v1::ResampleResponse& response) {
    if (absl::Status status = memory_.take(kBytesOfPoint * response.ByteSizeLong(), "the points of a file"); !status.ok()) {
      return status;
    }
    if (response.has_statistics()) statistics_ = response.statistics();
    return points_.append(response.points());
  }

  PointsTerms terms_;
  v1::MeshInfo mesh_;  // that the points lie on

 private:
  /// A worker makes the file: neither gRPC's threads nor the gateway's should be busy for so long.
  void make() {
    const Caller& caller = resource_->caller();
    const absl::Status submitted =
        resource_->engine()
            .calls.submit([self = shared_from_this()] { self->finish(); }, {.caller = caller.name, .connection = caller.address})
            .status();
    if (!submitted.ok()) resource_->fail(submitted);
  }

  void finish() {
    if (resource_->gone()) return;
    PointFile file;
    const absl::Status made = status_from_exceptions([&] {
      absl::StatusOr<PointFile> written = make_point_file(points_.columns(), kind_, terms_.file);
      if (written.ok()) file = *std::move(written);
      return written.status();
    });
    if (!made.ok()) return resource_->fail(made);
    points_ = {};
    // What is being made, or could not be, may be there when the same is asked for again.
    const bool is_final = !statistics_.refining() &&
                          (statistics_.limit() == v1::POINT_LIMIT_UNSPECIFIED || statistics_.limit() == v1::POINT_LIMIT_DENSITY);
    WebAnswer answer = file_answer(std::move(file.bytes), std::string(kind_.type), is_final ? tag_ : "");
    answer.header.insert(answer.header.end(), file.header.begin(), file.header.end());
    answer.header.emplace_back("Content-Disposition", file_name_field(mesh_, std::string(kind_.ending)));
    if (statistics_.refining()) answer.header.emplace_back("Curvecast-Refining", "true");
    answer.held = hold_queued(resource_->engine(), resource_->caller(), answer.body.size());
    resource_->answer(std::move(answer));
  }

  const std::shared_ptr<WebResource> resource_;
  const PointFileKind& kind_;
  std::string tag_;
  MemoryBudget::Job memory_;
  GatheredPoints points_;
  v1::FrameStatistics statistics_;
};

class SessionPoints final : public PointsRequest {
 public:
  SessionPoints(std::shared_ptr<WebResource> resource, const PointFileKind& kind, PointsTerms terms)
      : PointsRequest(std::move(resource), kind, std::move(terms)) {}

  void begin(v1::Session session) {
    if (is_answered(etag_of(session, resource().request()))) return;
    mesh_ = std::move(*session.mutable_report()->mutable_mesh());
    if (absl::Status status = complete_sample(mesh_, terms_); !status.ok()) return resource().fail(status);
    v1::SampleRequest& sample = terms_.sample;
    if (sample.budget_case() == v1::SampleRequest::BUDGET_NOT_SET) sample.set_points(session.options().max_points());
    request_.set_session_id(session.session_id());
    *request_.mutable_sample() = std::move(sample);
    call(&Async::Resample, request_, [this](const v1::ResampleResponse& response) { return take(response); });
  }

 private:
  v1::ResampleRequest request_;
};

class ScatteredPointsRequest final : public PointsRequest {
 public:
  ScatteredPointsRequest(std::shared_ptr<WebResource> resource, const PointFileKind& kind, const std::string& mesh_id,
                         ScatterTerms terms)
      : PointsRequest(std::move(resource), kind, std::move(terms.points)) {
    request_.set_mesh_id(mesh_id);
    request_.mutable_companions()->insert(terms.companions.begin(), terms.companions.end());
    if (terms.crease_degrees) request_.set_crease_degrees(*terms.crease_degrees);
  }

  /// Once the mesh is known to be there.
  void begin() {
    if (is_answered(etag_of(request_.mesh_id(), resource().request()))) return;
    if (!has_cameras(terms_)) return scatter();
    v1::InspectMeshRequest request;
    request.set_mesh_id(request_.mesh_id());
    *request.mutable_companions() = request_.companions();
    resource().call<v1::InspectMeshRequest, v1::InspectMeshResponse>(
        &Async::InspectMesh, std::move(request), [this, self = shared_from_this()](const v1::InspectMeshResponse& inspected) {
          const absl::Status status = complete_sample(inspected.mesh(), terms_);
          status.ok() ? scatter() : resource().fail(status);
        });
  }

 private:
  void scatter() {
    *request_.mutable_sample() = std::move(terms_.sample);
    call(&Async::Scatter, request_, [this](const v1::ScatterResponse& response) {
      if (response.has_mesh()) mesh_ = response.mesh();
      return response.has_points() ? take(response.points()) : absl::OkStatus();
    });
  }

  v1::ScatterRequest request_;
};

}  // namespace

void get_points(const std::shared_ptr<WebResource>& resource, const std::string& session_id, const PointFileKind& kind) {
  absl::StatusOr<PointsTerms> terms = read_points_query(resource->query(), kind);
  if (!terms.ok()) return resource->fail(terms.status());
  v1::GetSessionRequest request;
  request.set_session_id(session_id);
  resource->call<v1::GetSessionRequest, v1::GetSessionResponse>(
      &Async::GetSession, std::move(request),
      [points = std::make_shared<SessionPoints>(resource, kind, *std::move(terms))](v1::GetSessionResponse found) {
        points->begin(std::move(*found.mutable_session()));
      });
}

void get_scattered_points(const std::shared_ptr<WebResource>& resource, const std::string& mesh_id, const PointFileKind& kind) {
  absl::StatusOr<ScatterTerms> terms = read_scatter_query(resource->query(), kind);
  if (!terms.ok()) return resource->fail(terms.status());
  v1::GetMeshRequest request;
  request.set_mesh_id(mesh_id);
  resource->call<v1::GetMeshRequest, v1::GetMeshResponse>(
      &Async::GetMesh, std::move(request),
      [points = std::make_shared<ScatteredPointsRequest>(resource, kind, mesh_id, *std::move(terms))](
          const v1::GetMeshResponse& /*mesh*/) { points->begin(); });
}

}  // namespace curvecast::server
