// A connection without a server.
#pragma once

#include <gmock/gmock.h>

#include "client/lib/connection.h"

namespace curvecast::client {

class FakeConnection : public Connection {
 public:
  MOCK_METHOD(absl::StatusOr<v1::UploadMeshResponse>, upload_mesh,
              (const v1::UploadHeader&, const ReadAt&, const OnBytes&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::GetMeshResponse>, get_mesh, (const v1::GetMeshRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::ListMeshReferencesResponse>, list_mesh_references,
              (const v1::ListMeshReferencesRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::InspectMeshResponse>, inspect_mesh, (const v1::InspectMeshRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<v1::RenderResponse>, render, (const v1::RenderRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::GetParameterMeshResponse>>, get_parameter_mesh,
              (const v1::GetParameterMeshRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::Session>, create_session, (const v1::CreateSessionRequest&, const OnProgress&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<v1::GetSessionResponse>, get_session, (const v1::GetSessionRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::ListMeshesResponse>, list_meshes, (const v1::ListMeshesRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<v1::ListSessionsResponse>, list_sessions, (const v1::ListSessionsRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<v1::UpdateSessionResponse>, update_session, (const v1::UpdateSessionRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::Status, close_session, (const v1::CloseSessionRequest&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::ResampleResponse>>, resample, (const v1::ResampleRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::ScatterResponse>>, scatter,
              (const v1::ScatterRequest&, const OnProgress&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::FindNeighboursResponse>>, find_neighbours,
              (const v1::FindNeighboursRequest&, const OnProgress&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::GetCurveResponse>>, get_curve, (const v1::GetCurveRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::RemeshResponse>>, remesh,
              (const v1::RemeshRequest&, const OnProgress&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<std::vector<v1::GetSurfaceResponse>>, get_surface, (const v1::GetSurfaceRequest&, std::stop_token),
              (override));
  MOCK_METHOD(absl::StatusOr<v1::Measures>, measure, (const v1::MeasureRequest&, const OnProgress&, std::stop_token), (override));
  MOCK_METHOD(absl::StatusOr<Health>, check_health, (std::chrono::milliseconds, std::stop_token), (override));
  MOCK_METHOD(std::unique_ptr<ViewCall>, stream_views, (const v1::OpenView&, std::stop_token), (override));
};

}  // namespace curvecast::client
