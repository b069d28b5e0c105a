// Holders of tokens who are kept apart: each finds what is his, and of the others not even that it is there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/server/eventually.h"
#include "tests/server/opened_stream.h"
#include "tests/server/server_fixture.h"
#include "tests/server/two_callers.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

class ServerIsolate : public ServerFixture {
 protected:
  void SetUp() override {
    testing::write_file(folder_ / "tokens", kTokens);
    restart();
  }
  void restart() {
    start(
        {.max_sessions = 1, .tokens = folder_ / "tokens", .isolate = true, .max_curve_vertices = 0, .cache = folder_ / "cache"});
    anna_ = client_with("anna's");
    bert_ = client_with("bert's");
  }

  /// Makes a session, once nobody works any more on the one that it takes the place of, and waits until it is cached.
  static std::string create_cached(Stub& stub, const std::string& mesh) {
    Created created;
    EXPECT_TRUE(eventually([&] {
      created = create(stub, mesh, 100);
      return created.status.error_code() != grpc::RESOURCE_EXHAUSTED;
    }));
    const std::string id = created.session.session_id();
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    EXPECT_TRUE(eventually([&] {
      grpc::ClientContext context;
      set_patience(context);
      v1::GetSessionRequest request;
      request.set_session_id(id);
      v1::GetSessionResponse got;
      return stub.GetSession(&context, request, &got).ok() && got.session().cached();
    }));
    return id;
  }
  static std::vector<std::string> list(Stub& stub) {
    grpc::ClientContext context;
    set_patience(context);
    v1::ListSessionsResponse response;
    EXPECT_TRUE(stub.ListSessions(&context, {}, &response).ok());
    std::vector<std::string> ids;
    for (const v1::Session& session : response.sessions()) ids.push_back(session.session_id());
    return ids;
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<Stub> anna_, bert_;
};

template <typename Request, typename Response>
using Unary = grpc::Status (Stub::*)(grpc::ClientContext*, const Request&, Response*);

template <typename Request, typename Response>
grpc::Status call(Stub& stub, Unary<Request, Response> method, const Request& request) {
  grpc::ClientContext context;
  set_patience(context);
  Response response;
  return (stub.*method)(&context, request, &response);
}

template <typename Request, typename Response>
grpc::Status call(Stub& stub,
                  std::unique_ptr<grpc::ClientReaderInterface<Response>> (Stub::*method)(grpc::ClientContext*, const Request&),
                  const Request& request) {
  grpc::ClientContext context;
  set_patience(context);
  const auto reader = (stub.*method)(&context, request);
  Response response;
  while (reader->Read(&response)) {
  }
  return reader->Finish();
}

template <typename Request>
Request of_mesh(const std::string& id) {
  Request request;
  request.set_mesh_id(id);
  return request;
}

template <typename Request>
Request of_session(const std::string& id) {
  Request request;
  request.set_session_id(id);
  return request;
}

template <typename Request>
Request of_points(const std::string& id) {
  auto request = of_session<Request>(id);
  *request.mutable_sample() = view_of(10);
  return request;
}

/// How every call ends that names a mesh.
std::map<std::string, grpc::Status> calls_of_mesh(Stub& stub, const std::string& id, const std::string& own_mesh) {
  std::map<std::string, grpc::Status> out;
  out["GetMesh"] = call(stub, &Stub::GetMesh, of_mesh<v1::GetMeshRequest>(id));
  out["InspectMesh"] = call(stub, &Stub::InspectMesh, of_mesh<v1::InspectMeshRequest>(id));
  out["ListMeshReferences"] = call(stub, &Stub::ListMeshReferences, of_mesh<v1::ListMeshReferencesRequest>(id));
  out["GetParameterMesh"] = call(stub, &Stub::GetParameterMesh, of_mesh<v1::GetParameterMeshRequest>(id));
  out["CreateSession"] = call(stub, &Stub::CreateSession, of_mesh<v1::CreateSessionRequest>(id));
  auto as_companion = of_mesh<v1::CreateSessionRequest>(own_mesh);
  (*as_companion.mutable_companions())["a.bin"] = id;
  out["CreateSession, companion"] = call(stub, &Stub::CreateSession, as_companion);
  auto scattered = of_mesh<v1::ScatterRequest>(id);
  scattered.mutable_sample()->set_points(10);
  out["Scatter"] = call(stub, &Stub::Scatter, scattered);
  auto measured = of_mesh<v1::MeasureRequest>(id);
  measured.add_sets()->set_points_id(own_mesh);
  out["Measure"] = call(stub, &Stub::Measure, measured);
  measured.set_mesh_id(own_mesh);
  measured.mutable_sets(0)->set_points_id(id);
  out["Measure, points"] = call(stub, &Stub::Measure, measured);
  measured.clear_sets();
  measured.set_other_mesh_id(id);
  out["Measure, other"] = call(stub, &Stub::Measure, measured);
  return out;
}

/// How every call ends that names a session.
std::map<std::string, grpc::Status> calls_of_session(Stub& stub, const std::string& id) {
  std::map<std::string, grpc::Status> out;
  out["GetSession"] = call(stub, &Stub::GetSession, of_session<v1::GetSessionRequest>(id));
  auto update = of_session<v1::UpdateSessionRequest>(id);
  update.set_time_to_live(1000);
  out["UpdateSession"] = call(stub, &Stub::UpdateSession, update);
  out["Render"] = call(stub, &Stub::Render, of_session<v1::RenderRequest>(id));
  out["Remesh"] = call(stub, &Stub::Remesh, of_points<v1::RemeshRequest>(id));
  out["GetSurface"] = call(stub, &Stub::GetSurface, of_session<v1::GetSurfaceRequest>(id));
  out["GetCurve"] = call(stub, &Stub::GetCurve, of_session<v1::GetCurveRequest>(id));
  out["Resample"] = call(stub, &Stub::Resample, of_points<v1::ResampleRequest>(id));
  auto neighbours = of_points<v1::FindNeighboursRequest>(id);
  neighbours.set_count(2);
  out["FindNeighbours"] = call(stub, &Stub::FindNeighbours, neighbours);
  out["StreamViews"] = OpenedStream(stub, id).answer();
  out["CloseSession"] = call(stub, &Stub::CloseSession, of_session<v1::CloseSessionRequest>(id));
  return out;
}

/// What somebody is told of what is there and not his, he is told of what is not there at all.
void expect_not_found(const std::map<std::string, grpc::Status>& answers, const std::string& id,
                      const std::map<std::string, grpc::Status>& of_nothing, const std::string& nothing) {
  for (const auto& [method, status] : answers) {
    EXPECT_EQ(status.error_code(), grpc::NOT_FOUND) << method << ": " << status.error_message();
    std::string message = of_nothing.at(method).error_message();
    const std::size_t at = message.find(nothing);
    ASSERT_NE(at, std::string::npos) << method << ": " << message;
    EXPECT_EQ(status.error_message(), message.replace(at, nothing.size(), id)) << method;
  }
}

/// A place where the others' things may be when somebody asks for them.
enum class Place { kMemory, kCacheOnly, kAfterRestart, kSecondServer };

class ServerIsolateEverywhere : public ServerIsolate, public ::testing::WithParamInterface<Place> {
 protected:
  void bring_to(Place place) {
    if (place == Place::kMemory) return;
    if (place == Place::kCacheOnly) {
      create_cached(*anna_, upload(*anna_, sphere_off(3)));  // there is room for one
      return;
    }
    if (place == Place::kSecondServer) second_ = std::move(server_);
    restart();
  }
  std::unique_ptr<Server> second_;
};

TEST_P(ServerIsolateEverywhere, WhatIsAnothersIsNotThere) {
  const std::string mesh = upload(*anna_, sphere_off(2)), session = create_cached(*anna_, mesh);
  bring_to(GetParam());
  const std::string own_mesh = upload(*bert_, sphere_off(1)), nothing(32, '0');
  expect_not_found(calls_of_mesh(*bert_, mesh, own_mesh), mesh, calls_of_mesh(*bert_, nothing, own_mesh), nothing);
  expect_not_found(calls_of_session(*bert_, session), session, calls_of_session(*bert_, nothing), nothing);
  EXPECT_THAT(list(*bert_), ::testing::Not(::testing::Contains(session)));
  // All this was for him to have, and nothing of it for bert to take away.
  for (const auto& [method, status] : calls_of_mesh(*anna_, mesh, mesh)) {
    EXPECT_NE(status.error_code(), grpc::NOT_FOUND) << method << ": " << status.error_message();
  }
  for (const auto& [method, status] : calls_of_session(*anna_, session)) {
    EXPECT_TRUE(status.ok()) << method << ": " << status.error_message();
  }
}

INSTANTIATE_TEST_SUITE_P(Everywhere, ServerIsolateEverywhere,
                         ::testing::Values(Place::kMemory, Place::kCacheOnly, Place::kAfterRestart, Place::kSecondServer));

TEST_F(ServerIsolate, TheSameMeshGivesEachASessionOfHisOwn) {
  const std::string mesh = upload(*anna_, sphere_off(2));
  EXPECT_EQ(upload(*bert_, sphere_off(2)), mesh) << "ids are those of files";
  const std::string of_anna = create_cached(*anna_, mesh), of_bert = create_cached(*bert_, mesh);
  EXPECT_NE(of_anna, of_bert);
  EXPECT_EQ(of_anna.substr(0, 16), of_bert.substr(0, 16));
  const auto points = [](Stub& stub, const std::string& session) { return resample(stub, session, view_of(50)).bytes(); };
  EXPECT_EQ(points(*anna_, of_anna), points(*bert_, of_bert));
  EXPECT_TRUE(call(*bert_, &Stub::CloseSession, of_session<v1::CloseSessionRequest>(of_bert)).ok());
  EXPECT_TRUE(call(*anna_, &Stub::GetSession, of_session<v1::GetSessionRequest>(of_anna)).ok());
}

TEST_F(ServerIsolate, APreviewIsItsMakersToo) {
  // Both ask for it at the same time; neither joins the other's.
  const std::string mesh = upload(*anna_, sphere_off(4));
  upload(*bert_, sphere_off(4));
  EXPECT_TRUE(create(*anna_, mesh, 1000).status.ok());
  // There is room for one, and anna's gives way once it is saved and nobody works on it.
  EXPECT_TRUE(eventually([&] { return create(*bert_, mesh, 1000).status.ok(); }));
  EXPECT_EQ(list(*anna_).size() + list(*bert_).size(), 1u) << "max_sessions";
}

TEST_F(ServerIsolate, WhatTheServerOpensIsForAll) {
  const auto own = v1::CurvecastService::NewStub(server_->in_process_channel());
  const std::string session = create_cached(*own, upload(*own, sphere_off(2)));
  for (Stub* stub : {anna_.get(), bert_.get()}) {
    EXPECT_THAT(list(*stub), ::testing::Contains(session));
    auto answers = calls_of_session(*stub, session);
    EXPECT_EQ(answers["CloseSession"].error_code(), grpc::PERMISSION_DENIED);
    EXPECT_EQ(answers["UpdateSession"].error_code(), grpc::PERMISSION_DENIED);
    for (const char* read :
         {"GetSession", "Render", "Remesh", "GetSurface", "GetCurve", "Resample", "FindNeighbours", "StreamViews"}) {
      EXPECT_TRUE(answers[read].ok()) << read << ": " << answers[read].error_message();
    }
  }
}

TEST_F(ServerIsolate, SessionsOfATimeBeforeAreTheirMakers) {
  start({.tokens = folder_ / "tokens", .cache = folder_ / "cache"});
  anna_ = client_with("anna's");
  const std::string session = create_cached(*anna_, upload(*anna_, sphere_off(2)));
  restart();
  EXPECT_EQ(call(*bert_, &Stub::GetSession, of_session<v1::GetSessionRequest>(session)).error_code(), grpc::NOT_FOUND);
  EXPECT_TRUE(call(*anna_, &Stub::GetSession, of_session<v1::GetSessionRequest>(session)).ok());
}

TEST_F(ServerIsolate, WantsToKnowItsCallers) {
  const auto server = Server::start({.listen = "127.0.0.1:0", .isolate = true, .log = false});
  EXPECT_EQ(server.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("isolate"));
}

}  // namespace
}  // namespace curvecast::server
