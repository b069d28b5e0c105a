// One reactor for each call that does not answer at once, of a caller who was let in. Each deletes itself when gRPC is done with
// it.
#pragma once

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "curvecast/v1/curvecast.pb.h"
#include "server/engine/caller.h"
#include "server/engine/engine.h"

namespace curvecast::server {

grpc::ServerReadReactor<v1::UploadMeshRequest>* upload_mesh(Engine& engine, grpc::CallbackServerContext& context,
                                                            const Caller& caller, v1::UploadMeshResponse* response);

grpc::ServerUnaryReactor* inspect_mesh(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                       const v1::InspectMeshRequest& request, v1::InspectMeshResponse* response);

grpc::ServerUnaryReactor* list_mesh_references(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                               const v1::ListMeshReferencesRequest& request,
                                               v1::ListMeshReferencesResponse* response);

grpc::ServerWriteReactor<v1::ScatterResponse>* scatter(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                       const v1::ScatterRequest& request);

grpc::ServerWriteReactor<v1::CreateSessionResponse>* create_session(Engine& engine, grpc::CallbackServerContext& context,
                                                                    const Caller& caller,
                                                                    const v1::CreateSessionRequest& request);

grpc::ServerWriteReactor<v1::GetParameterMeshResponse>* get_parameter_mesh(Engine& engine, grpc::CallbackServerContext& context,
                                                                           const Caller& caller,
                                                                           const v1::GetParameterMeshRequest& request);

grpc::ServerWriteReactor<v1::MeasureResponse>* measure(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                       const v1::MeasureRequest& request);

grpc::ServerWriteReactor<v1::GetCurveResponse>* get_curve(Engine& engine, grpc::CallbackServerContext& context,
                                                          const Caller& caller, const v1::GetCurveRequest& request);

grpc::ServerWriteReactor<v1::ResampleResponse>* resample(Engine& engine, grpc::CallbackServerContext& context,
                                                         const Caller& caller, const v1::ResampleRequest& request);

grpc::ServerWriteReactor<v1::FindNeighboursResponse>* find_neighbours(Engine& engine, grpc::CallbackServerContext& context,
                                                                      const Caller& caller,
                                                                      const v1::FindNeighboursRequest& request);

grpc::ServerWriteReactor<v1::RemeshResponse>* remesh(Engine& engine, grpc::CallbackServerContext& context, const Caller& caller,
                                                     const v1::RemeshRequest& request);

grpc::ServerWriteReactor<v1::GetSurfaceResponse>* get_surface(Engine& engine, grpc::CallbackServerContext& context,
                                                              const Caller& caller, const v1::GetSurfaceRequest& request);

grpc::ServerBidiReactor<v1::StreamViewsRequest, v1::StreamViewsResponse>* stream_views(Engine& engine,
                                                                                       grpc::CallbackServerContext& context,
                                                                                       const Caller& caller);

}  // namespace curvecast::server
