// Calls with and without tokens, over TCP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/server_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

// For each: printf %s "anna's" | sha256sum
constexpr char kTokens[] =
    "anna 8f68ce373d4607a65f1b1ce5c42eef43dcc492fdf17a5bb36bdca6d656ca21da\n"
    "bert a1eeb16073426839c5dfabc8fc71999ccbcee5ee0ce82ca9588a528582c4bb17\n"
    "late 356840b857cacb2e68a30eb6c40414d77ef37445c465723a4480cb95de2a0e26 1000000000\n";

class ServerTokens : public ServerFixture {
 protected:
  void SetUp() override {
    testing::write_file(folder_ / "tokens", kTokens);
    start({.tokens = folder_ / "tokens"});
  }

  /// What each kind of call ends with.
  std::vector<grpc::Status> statuses(const std::string& authorization) {
    const auto stub = client();
    const auto prepare = [&](grpc::ClientContext& context) {
      set_patience(context);
      if (!authorization.empty()) context.AddMetadata("authorization", authorization);
    };
    std::vector<grpc::Status> out;
    {
      grpc::ClientContext context;
      prepare(context);
      v1::ListSessionsResponse response;
      out.push_back(stub->ListSessions(&context, {}, &response));
    }
    {
      grpc::ClientContext context;
      prepare(context);
      v1::UploadMeshResponse response;
      const auto writer = stub->UploadMesh(&context, &response);
      v1::UploadMeshRequest request;
      request.mutable_header()->set_size(1);
      writer->Write(request);
      request.set_chunk("x");
      writer->Write(request);
      writer->WritesDone();
      out.push_back(writer->Finish());
    }
    {
      grpc::ClientContext context;
      prepare(context);
      const auto reader = stub->CreateSession(&context, {});
      v1::CreateSessionResponse response;
      while (reader->Read(&response)) {
      }
      out.push_back(reader->Finish());
    }
    {
      grpc::ClientContext context;
      prepare(context);
      const auto stream = stub->StreamViews(&context);
      v1::StreamViewsRequest request;
      request.mutable_open()->set_session_id("none");
      stream->Write(request);
      v1::StreamViewsResponse response;
      while (stream->Read(&response)) {
      }
      out.push_back(stream->Finish());
    }
    return out;
  }

  testing::TemporaryFolder folder_;
};

TEST_F(ServerTokens, NobodyCallsWithoutOne) {
  for (const std::string header : {"", "Bearer wrong", "Basic anna's", "Bearer late's"}) {
    for (const grpc::Status& status : statuses(header)) {
      EXPECT_EQ(status.error_code(), grpc::UNAUTHENTICATED) << header << ": " << status.error_message();
    }
  }
  EXPECT_THAT(statuses("")[0].error_message(), HasSubstr("authorization"));
}

TEST_F(ServerTokens, WhoHasOneGetsWhatHeAsksFor) {
  const std::vector<grpc::Status> all = statuses("Bearer anna's");
  EXPECT_TRUE(all[0].ok()) << all[0].error_message();
  EXPECT_TRUE(all[1].ok()) << all[1].error_message();
  EXPECT_EQ(all[2].error_code(), grpc::NOT_FOUND) << "of the mesh";
  EXPECT_EQ(all[3].error_code(), grpc::NOT_FOUND) << "of the session";
}

TEST_F(ServerTokens, ASessionIsItsMakersToClose) {
  const auto stub = client();
  const auto as = [](grpc::ClientContext& context, const std::string& who) {
    set_patience(context);
    context.AddMetadata("authorization", "Bearer " + who + "'s");
  };
  std::string mesh, session;
  {
    grpc::ClientContext context;
    as(context, "anna");
    v1::UploadMeshResponse response;
    const auto writer = stub->UploadMesh(&context, &response);
    const std::string bytes = sphere_off(2);
    v1::UploadMeshRequest request;
    request.mutable_header()->set_size(bytes.size());
    writer->Write(request);
    request.set_chunk(bytes);
    writer->Write(request);
    writer->WritesDone();
    ASSERT_TRUE(writer->Finish().ok());
    mesh = response.mesh_id();
  }
  {
    grpc::ClientContext context;
    as(context, "anna");
    v1::CreateSessionRequest request;
    request.set_mesh_id(mesh);
    const auto reader = stub->CreateSession(&context, request);
    v1::CreateSessionResponse response;
    while (reader->Read(&response)) session = response.session().session_id();
    ASSERT_TRUE(reader->Finish().ok());
  }
  const auto close = [&](const std::string& who) {
    grpc::ClientContext context;
    as(context, who);
    v1::CloseSessionRequest request;
    request.set_session_id(session);
    v1::CloseSessionResponse response;
    return stub->CloseSession(&context, request, &response).error_code();
  };
  const auto pin = [&](const std::string& who) {
    grpc::ClientContext context;
    as(context, who);
    v1::UpdateSessionRequest request;
    request.set_session_id(session);
    request.set_pinned(true);
    v1::UpdateSessionResponse response;
    return stub->UpdateSession(&context, request, &response).error_code();
  };
  EXPECT_EQ(pin("bert"), grpc::PERMISSION_DENIED);
  EXPECT_EQ(close("bert"), grpc::PERMISSION_DENIED);
  EXPECT_EQ(pin("anna"), grpc::OK);
  EXPECT_EQ(close("anna"), grpc::OK);
  EXPECT_EQ(close("anna"), grpc::NOT_FOUND);
}

TEST_F(ServerTokens, ThisProcessNeedsNone) {
  const auto stub = v1::CurvecastService::NewStub(server_->in_process_channel());
  grpc::ClientContext context;
  v1::ListSessionsResponse response;
  EXPECT_TRUE(stub->ListSessions(&context, {}, &response).ok());
}

TEST(TokensFile, ThatCannotBeReadStopsTheServer) {
  EXPECT_FALSE(Server::start({.tokens = "/nonexistent/tokens", .log = false}).ok());
}

}  // namespace
}  // namespace curvecast::server
