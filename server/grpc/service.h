// The gRPC service: thin. Calls that answer at once are here, all others in reactors.h.
#pragma once

#include "curvecast/v1/curvecast.grpc.pb.h"
#include "server/engine/engine.h"

namespace curvecast::server {

/// Thread-safe. `engine` must outlive it.
class Service final : public v1::CurvecastService::CallbackService {
 public:
  explicit Service(Engine& engine) : engine_(engine) {}

  grpc::ServerReadReactor<v1::UploadMeshRequest>* UploadMesh(grpc::CallbackServerContext* context,
                                                             v1::UploadMeshResponse* response) override;
  grpc::ServerUnaryReactor* GetMesh(grpc::CallbackServerContext* context, const v1::GetMeshRequest* request,
                                    v1::GetMeshResponse* response) override;
  grpc::ServerUnaryReactor* ListMeshes(grpc::CallbackServerContext* context, const v1::ListMeshesRequest* request,
                                       v1::ListMeshesResponse* response) override;
  grpc::ServerUnaryReactor* GetUpload(grpc::CallbackServerContext* context, const v1::GetUploadRequest* request,
                                      v1::GetUploadResponse* response) override;
  grpc::ServerUnaryReactor* ImportMesh(grpc::CallbackServerContext* context, const v1::ImportMeshRequest* request,
                                       v1::ImportMeshResponse* response) override;
  grpc::ServerUnaryReactor* InspectMesh(grpc::CallbackServerContext* context, const v1::InspectMeshRequest* request,
                                        v1::InspectMeshResponse* response) override;
  grpc::ServerUnaryReactor* ListMeshReferences(grpc::CallbackServerContext* context, const v1::ListMeshReferencesRequest* request,
                                               v1::ListMeshReferencesResponse* response) override;
  grpc::ServerWriteReactor<v1::GetParameterMeshResponse>* GetParameterMesh(grpc::CallbackServerContext* context,
                                                                           const v1::GetParameterMeshRequest* request) override;
  grpc::ServerWriteReactor<v1::ScatterResponse>* Scatter(grpc::CallbackServerContext* context,
                                                         const v1::ScatterRequest* request) override;
  grpc::ServerWriteReactor<v1::CreateSessionResponse>* CreateSession(grpc::CallbackServerContext* context,
                                                                     const v1::CreateSessionRequest* request) override;
  grpc::ServerUnaryReactor* GetSession(grpc::CallbackServerContext* context, const v1::GetSessionRequest* request,
                                       v1::GetSessionResponse* response) override;
  grpc::ServerUnaryReactor* ListSessions(grpc::CallbackServerContext* context, const v1::ListSessionsRequest* request,
                                         v1::ListSessionsResponse* response) override;
  grpc::ServerUnaryReactor* UpdateSession(grpc::CallbackServerContext* context, const v1::UpdateSessionRequest* request,
                                          v1::UpdateSessionResponse* response) override;
  grpc::ServerUnaryReactor* CloseSession(grpc::CallbackServerContext* context, const v1::CloseSessionRequest* request,
                                         v1::CloseSessionResponse* response) override;
  grpc::ServerUnaryReactor* Render(grpc::CallbackServerContext* context, const v1::RenderRequest* request,
                                   v1::RenderResponse* response) override;
  grpc::ServerWriteReactor<v1::MeasureResponse>* Measure(grpc::CallbackServerContext* context,
                                                         const v1::MeasureRequest* request) override;
  grpc::ServerWriteReactor<v1::RemeshResponse>* Remesh(grpc::CallbackServerContext* context,
                                                       const v1::RemeshRequest* request) override;
  grpc::ServerWriteReactor<v1::GetSurfaceResponse>* GetSurface(grpc::CallbackServerContext* context,
                                                               const v1::GetSurfaceRequest* request) override;
  grpc::ServerWriteReactor<v1::GetCurveResponse>* GetCurve(grpc::CallbackServerContext* context,
                                                           const v1::GetCurveRequest* request) override;
  grpc::ServerWriteReactor<v1::ResampleResponse>* Resample(grpc::CallbackServerContext* context,
                                                           const v1::ResampleRequest* request) override;
  grpc::ServerWriteReactor<v1::FindNeighboursResponse>* FindNeighbours(grpc::CallbackServerContext* context,
                                                                       const v1::FindNeighboursRequest* request) override;
  grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* StreamViews(
      grpc::CallbackServerContext* context) override;

 private:
  /// Says whether it is in the cache.
  v1::Session with_cached(v1::Session session) const;

  Engine& engine_;
};

}  // namespace curvecast::server
