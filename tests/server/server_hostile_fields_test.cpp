// Every field of every request with hostile values, over TCP: the right code, and the server goes on serving.
#include <gtest/gtest.h>

#include <set>

#include "tests/server/frame/frame_points.h"
#include "tests/server/hostile_fields.h"
#include "tests/server/server_fixture.h"

namespace curvecast::server {
namespace {

class ServerHostileFields : public ServerFixture {
 protected:
  void SetUp() override {
    start({});
    stub_ = client();
    mesh_ = upload(*stub_, sphere_off(2));
    const Created created = create(*stub_, mesh_, 500);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    session_ = created.session.session_id();
  }

  void TearDown() override {
    const auto other = client();
    EXPECT_TRUE(create(*other, mesh_, 500).status.ok());
    EXPECT_EQ(resample(*other, session_, view_of(123)).points(), 123u);
  }

  /// A request that a server cannot serve is the client's fault, and it says so.
  static void expect_calm(const grpc::Status& status, const std::string& path) {
    static const std::set<grpc::StatusCode> kCalm = {
        grpc::OK,      grpc::INVALID_ARGUMENT,   grpc::NOT_FOUND,        grpc::OUT_OF_RANGE, grpc::FAILED_PRECONDITION,
        grpc::ABORTED, grpc::RESOURCE_EXHAUSTED, grpc::PERMISSION_DENIED};
    EXPECT_TRUE(kCalm.contains(status.error_code())) << path << ": " << status.error_code() << " " << status.error_message();
    EXPECT_TRUE(status.ok() || !status.error_message().empty()) << path;
    ++codes_seen_[status.error_code()];
  }

  /// Calls with each change of the request.
  template <class Request, class Call>
  void for_all_changes(Request request, const Call& call) {
    HostileFields([&](const std::string& path) {
      grpc::ClientContext context;
      set_patience(context);
      expect_calm(call(context, request), Request::descriptor()->name() + path);
    }).run(request);
  }

  /// The first message of a stream of responses, if there is one; then the call ends.
  template <class Response>
  static grpc::Status first_of(grpc::ClientContext& context, std::unique_ptr<grpc::ClientReaderInterface<Response>> reader) {
    Response response;
    if (!reader->Read(&response)) return reader->Finish();
    context.TryCancel();
    reader->Finish();
    return grpc::Status::OK;
  }

  static inline std::map<grpc::StatusCode, int> codes_seen_;
  std::unique_ptr<Stub> stub_;
  std::string mesh_, session_;
};

v1::SampleRequest rich_sample() {
  v1::SampleRequest sample = view_of(100);
  for (int i = 0; i < 8; ++i) sample.add_density();
  sample.mutable_density(1)->mutable_uniform();
  sample.mutable_density(2)->mutable_curvature()->set_exponent(1);
  sample.mutable_density(3)->mutable_brush()->add_strokes()->set_radius(1);
  sample.mutable_density(3)->mutable_brush()->mutable_strokes(0)->set_factor(1);
  sample.mutable_density(4)->mutable_distance()->set_far(10);
  sample.mutable_density(5)->mutable_frustum();
  sample.mutable_density(6)->mutable_screen();
  sample.mutable_density(7)->mutable_expression()->set_text("x * x + 1");
  sample.mutable_density(8)->mutable_uniform();
  sample.mutable_viewport()->set_width(100);
  sample.mutable_viewport()->set_height(100);
  return sample;
}

TEST_F(ServerHostileFields, Unary) {
  codes_seen_.clear();
  for_all_changes(v1::GetMeshRequest(), [&](auto& context, const auto& request) {
    v1::GetMeshResponse response;
    return stub_->GetMesh(&context, request, &response);
  });
  for_all_changes(v1::GetUploadRequest(), [&](auto& context, const auto& request) {
    v1::GetUploadResponse response;
    return stub_->GetUpload(&context, request, &response);
  });
  for_all_changes(v1::ImportMeshRequest(), [&](auto& context, const auto& request) {
    v1::ImportMeshResponse response;
    return stub_->ImportMesh(&context, request, &response);
  });
  for_all_changes(v1::GetSessionRequest(), [&](auto& context, const auto& request) {
    v1::GetSessionResponse response;
    return stub_->GetSession(&context, request, &response);
  });
  for_all_changes(v1::CloseSessionRequest(), [&](auto& context, const auto& request) {
    v1::CloseSessionResponse response;
    return stub_->CloseSession(&context, request, &response);
  });
  for_all_changes(v1::ListMeshesRequest(), [&](auto& context, const auto& request) {
    v1::ListMeshesResponse response;
    return stub_->ListMeshes(&context, request, &response);
  });
  for_all_changes(v1::ListSessionsRequest(), [&](auto& context, const auto& request) {
    v1::ListSessionsResponse response;
    return stub_->ListSessions(&context, request, &response);
  });
  v1::UpdateSessionRequest update;
  update.set_session_id(session_);
  for_all_changes(update, [&](auto& context, const auto& request) {
    v1::UpdateSessionResponse response;
    return stub_->UpdateSession(&context, request, &response);
  });
  v1::InspectMeshRequest inspect;
  inspect.set_mesh_id(mesh_);
  for_all_changes(inspect, [&](auto& context, const auto& request) {
    v1::InspectMeshResponse response;
    return stub_->InspectMesh(&context, request, &response);
  });
  v1::ListMeshReferencesRequest references;
  references.set_mesh_id(mesh_);
  for_all_changes(references, [&](auto& context, const auto& request) {
    v1::ListMeshReferencesResponse response;
    return stub_->ListMeshReferences(&context, request, &response);
  });
  EXPECT_GT(codes_seen_[grpc::NOT_FOUND], 10);
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 3);
}

TEST_F(ServerHostileFields, Upload) {
  v1::UploadMeshRequest request;
  request.mutable_header()->set_size(10);
  for_all_changes(request, [&](auto& context, const auto& changed) {
    v1::UploadMeshResponse response;
    const auto writer = stub_->UploadMesh(&context, &response);
    writer->Write(changed);
    v1::UploadMeshRequest chunk;
    chunk.set_chunk("0123456789");
    writer->Write(chunk);
    writer->WritesDone();
    return writer->Finish();
  });
}

TEST_F(ServerHostileFields, Sessions) {
  v1::CreateSessionRequest create;
  create.set_mesh_id(mesh_);
  create.mutable_options()->set_max_points(100);
  *create.mutable_options()->add_density() = rich_sample().density(7);
  codes_seen_.clear();
  for_all_changes(create, [&](auto& context, const auto& request) {
    return first_of<v1::CreateSessionResponse>(context, stub_->CreateSession(&context, request));
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 20);
  v1::GetCurveRequest curve;
  curve.set_session_id(session_);
  for_all_changes(curve, [&](auto& context, const auto& request) {
    return first_of<v1::GetCurveResponse>(context, stub_->GetCurve(&context, request));
  });
  v1::GetSurfaceRequest surface;
  surface.set_session_id(session_);
  surface.set_position_bits(12);
  for_all_changes(surface, [&](auto& context, const auto& request) {
    return first_of<v1::GetSurfaceResponse>(context, stub_->GetSurface(&context, request));
  });
  v1::GetParameterMeshRequest parameters;
  parameters.set_mesh_id(mesh_);
  for_all_changes(parameters, [&](auto& context, const auto& request) {
    return first_of<v1::GetParameterMeshResponse>(context, stub_->GetParameterMesh(&context, request));
  });
  v1::MeasureRequest measure;
  measure.set_mesh_id(mesh_);
  measure.set_ring_seeds(10);
  measure.set_ball_centres(10);
  measure.add_sets()->set_points_id(upload(*stub_, std::string(1200, '\0')));
  *measure.add_density() = rich_sample().density(7);
  measure.set_other_mesh_id(mesh_);
  measure.set_distance_samples(1'000);
  for_all_changes(measure, [&](auto& context, const auto& request) {
    return first_of<v1::MeasureResponse>(context, stub_->Measure(&context, request));
  });
}

TEST_F(ServerHostileFields, Samples) {
  v1::ResampleRequest request;
  request.set_session_id(session_);
  *request.mutable_sample() = rich_sample();
  codes_seen_.clear();
  for_all_changes(request, [&](auto& context, const auto& changed) {
    return first_of<v1::ResampleResponse>(context, stub_->Resample(&context, changed));
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 100);
  EXPECT_GT(codes_seen_[grpc::OK], 20);
}

TEST_F(ServerHostileFields, Meshes) {
  v1::RemeshRequest request;
  request.set_session_id(session_);
  *request.mutable_sample() = rich_sample();
  codes_seen_.clear();
  for_all_changes(request, [&](auto& context, const auto& changed) {
    return first_of<v1::RemeshResponse>(context, stub_->Remesh(&context, changed));
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 100);
}

TEST_F(ServerHostileFields, Neighbours) {
  v1::FindNeighboursRequest request;
  request.set_session_id(session_);
  *request.mutable_sample() = rich_sample();
  request.set_count(3);
  codes_seen_.clear();
  for_all_changes(request, [&](auto& context, const auto& changed) {
    return first_of<v1::FindNeighboursResponse>(context, stub_->FindNeighbours(&context, changed));
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 100);
}

TEST_F(ServerHostileFields, ScatteredPoints) {
  v1::ScatterRequest request;
  request.set_mesh_id(mesh_);
  *request.mutable_sample() = rich_sample();
  request.mutable_sample()->clear_sampler();
  request.mutable_sample()->clear_sequence();
  request.set_crease_degrees(30);
  codes_seen_.clear();
  for_all_changes(request, [&](auto& context, const auto& changed) {
    return first_of<v1::ScatterResponse>(context, stub_->Scatter(&context, changed));
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 100);
}

TEST_F(ServerHostileFields, Pictures) {
  v1::RenderRequest request;
  request.set_session_id(session_);
  request.set_width(16);
  request.set_height(16);
  *request.mutable_sample() = rich_sample();
  codes_seen_.clear();
  for_all_changes(request, [&](auto& context, const auto& changed) {
    v1::RenderResponse response;
    return stub_->Render(&context, changed, &response);
  });
  EXPECT_GT(codes_seen_[grpc::INVALID_ARGUMENT], 100);
}

TEST_F(ServerHostileFields, Views) {
  v1::StreamViewsRequest request;
  request.mutable_view()->set_sequence(1);
  *request.mutable_view()->mutable_sample() = rich_sample();
  int frames = 0, errors = 0;
  const auto converse = [&](grpc::ClientContext& context, const v1::StreamViewsRequest& opening,
                            const v1::StreamViewsRequest& view) -> grpc::Status {
    const auto stream = stub_->StreamViews(&context);
    stream->Write(opening);
    stream->Write(view);
    stream->WritesDone();
    v1::StreamViewsResponse response;
    while (stream->Read(&response)) {
      ++frames;
      if (response.frame().has_error()) {
        ++errors;
        expect_calm(
            grpc::Status(static_cast<grpc::StatusCode>(response.frame().error().code()), response.frame().error().message()),
            "frame");
      }
    }
    return stream->Finish();
  };
  v1::StreamViewsRequest opening;
  opening.mutable_open()->set_session_id(session_);
  for_all_changes(request, [&](auto& context, const auto& changed) { return converse(context, opening, changed); });
  EXPECT_GT(errors, 100);
  EXPECT_GT(frames, errors);
  opening.mutable_open()->set_accept_deltas(true);
  v1::HeldPoints& held = *opening.mutable_open()->mutable_held();
  *held.mutable_sample() = view_of(50);
  held.mutable_sample()->set_sampler(v1::SAMPLER_PROGRESSIVE);
  held.set_points(50);
  held.set_digest(7);
  for_all_changes(opening, [&](auto& context, const auto& changed) { return converse(context, changed, request); });
}

}  // namespace
}  // namespace curvecast::server
