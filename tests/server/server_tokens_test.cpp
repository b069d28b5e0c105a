// Calls with and without tokens, over TCP.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/server/eventually.h"
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

/// Where a session may be when somebody wants to change it.
enum class Place { kMemory, kCacheOnly, kAfterRestart, kSecondServer, kMadeAgain };

class ServerOwners : public ServerTokens, public ::testing::WithParamInterface<Place> {
 protected:
  void SetUp() override {
    testing::write_file(folder_ / "tokens", kTokens);
    restart();
    session_ = create("anna", upload("anna", 2));
  }
  void restart() {
    start({.max_sessions = 1, .tokens = folder_ / "tokens", .max_curve_vertices = 0, .cache = folder_ / "cache"});
    stub_ = client();
  }

  static void as(grpc::ClientContext& context, const std::string& who) {
    set_patience(context);
    context.AddMetadata("authorization", "Bearer " + who + "'s");
  }
  std::string upload(const std::string& who, int levels) {
    grpc::ClientContext context;
    as(context, who);
    v1::UploadMeshResponse response;
    const auto writer = stub_->UploadMesh(&context, &response);
    const std::string bytes = sphere_off(levels);
    v1::UploadMeshRequest request;
    request.mutable_header()->set_size(bytes.size());
    writer->Write(request);
    request.set_chunk(bytes);
    writer->Write(request);
    writer->WritesDone();
    EXPECT_TRUE(writer->Finish().ok());
    return response.mesh_id();
  }
  /// Makes a session, and waits until it is cached.
  std::string create(const std::string& who, const std::string& mesh) {
    v1::CreateSessionResponse response;
    {
      grpc::ClientContext context;
      as(context, who);
      v1::CreateSessionRequest request;
      request.set_mesh_id(mesh);
      const auto reader = stub_->CreateSession(&context, request);
      while (reader->Read(&response)) {
      }
      EXPECT_TRUE(reader->Finish().ok());
    }
    const std::string id = response.session().session_id();
    EXPECT_TRUE(eventually([&] {
      grpc::ClientContext context;
      as(context, who);
      v1::GetSessionRequest request;
      request.set_session_id(id);
      v1::GetSessionResponse got;
      return stub_->GetSession(&context, request, &got).ok() && got.session().cached();
    }));
    return id;
  }
  grpc::StatusCode close(const std::string& who) {
    grpc::ClientContext context;
    as(context, who);
    v1::CloseSessionRequest request;
    request.set_session_id(session_);
    v1::CloseSessionResponse response;
    return stub_->CloseSession(&context, request, &response).error_code();
  }
  grpc::StatusCode update(const std::string& who) {
    grpc::ClientContext context;
    as(context, who);
    v1::UpdateSessionRequest request;
    request.set_session_id(session_);
    request.set_time_to_live(1000);
    v1::UpdateSessionResponse response;
    return stub_->UpdateSession(&context, request, &response).error_code();
  }
  void bring_to(Place place) {
    switch (place) {
      case Place::kMemory:
        return;
      case Place::kCacheOnly:
        create("bert", upload("bert", 3));  // there is room for one
        return;
      case Place::kAfterRestart:
        restart();
        return;
      case Place::kSecondServer:
        second_ = std::move(server_);
        restart();
        return;
      case Place::kMadeAgain:
        restart();
        EXPECT_EQ(create("bert", upload("bert", 2)), session_);
        return;
    }
  }

  std::unique_ptr<Server> second_;
  std::unique_ptr<Stub> stub_;
  std::string session_;
};

TEST_P(ServerOwners, ASessionIsItsMakersToClose) {
  bring_to(GetParam());
  EXPECT_EQ(close("bert"), grpc::PERMISSION_DENIED);
  EXPECT_EQ(update("bert"), grpc::PERMISSION_DENIED);
  EXPECT_EQ(update("anna"), grpc::OK);
  EXPECT_EQ(close("bert"), grpc::PERMISSION_DENIED);
  EXPECT_EQ(close("anna"), grpc::OK);
  EXPECT_EQ(close("anna"), grpc::NOT_FOUND);
}

INSTANTIATE_TEST_SUITE_P(Everywhere, ServerOwners,
                         ::testing::Values(Place::kMemory, Place::kCacheOnly, Place::kAfterRestart, Place::kSecondServer,
                                           Place::kMadeAgain));

TEST_F(ServerTokens, ThisProcessNeedsNone) {
  const auto stub = v1::CurvecastService::NewStub(server_->in_process_channel());
  grpc::ClientContext context;
  v1::ListSessionsResponse response;
  EXPECT_TRUE(stub->ListSessions(&context, {}, &response).ok());
}

TEST_F(ServerTokens, NobodyElseIsThisProcess) {
  for (const char* key : {"curvecast-own", "curvecast-peer"}) {
    for (const char* value : {"", "this process"}) {
      grpc::ClientContext context;
      set_patience(context);
      v1::ListSessionsResponse response;
      const auto stub = client_sending(key, value);
      EXPECT_EQ(stub->ListSessions(&context, {}, &response).error_code(), grpc::UNAUTHENTICATED) << key << " " << value;
    }
  }
}

TEST(TokensFile, ThatCannotBeReadStopsTheServer) {
  EXPECT_FALSE(Server::start({.tokens = "/nonexistent/tokens", .log = false}).ok());
}

}  // namespace
}  // namespace curvecast::server
