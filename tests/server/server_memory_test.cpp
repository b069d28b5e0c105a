// Memory is asked for before it is taken: what does not fit is refused, and others go on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/eventually.h"
#include "tests/server/opened_stream.h"
#include "tests/server/server_fixture.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class ServerMemory : public ServerFixture {
 protected:
  void SetUp() override {}
  void start(ServerOptions options) {
    options.http = "127.0.0.1:0";
    ServerFixture::start(options);
    client_ = client();
  }
  /// The most that the API takes: 17 GB, from 230 bytes.
  Created create_too_much() {
    v1::CreateSessionRequest request;
    request.set_mesh_id(upload(*client_, testing::to_off(testing::tetrahedron())));
    request.mutable_options()->set_max_points(4'000'000);
    request.mutable_options()->set_omega(25);
    grpc::ClientContext context;
    set_patience(context);
    const auto reader = client_->CreateSession(&context, request);
    Created created;
    v1::CreateSessionResponse response;
    while (reader->Read(&response)) continue;
    created.status = reader->Finish();
    return created;
  }

  std::unique_ptr<Stub> client_;
};

constexpr std::uint64_t kLittle = 64 << 20;

TEST_F(ServerMemory, WhatDoesNotFitIsRefusedAndOthersGoOn) {
  start({.memory_bytes = kLittle});
  const std::string session = create(*client_, upload(*client_, sphere_off(3)), 2000).session.session_id();
  OpenedStream stream(*client_, session);
  for (std::uint64_t i = 1; i <= 5; ++i) {
    const grpc::Status status = create_too_much().status;
    EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
    EXPECT_THAT(status.error_message(), HasSubstr("a curve for 4000000 points with omega 25 takes 2"));
    EXPECT_THAT(status.error_message(), HasSubstr("points would fit"));
    stream.ask(i, 100);
    EXPECT_EQ(stream.read().error().message(), "");
    stream.acknowledge(i);
  }
  EXPECT_EQ(metric("curvecast_refused_total{limit=\"memory\"}"), 5);
  EXPECT_EQ(metric("curvecast_preprocess_seconds_count{code=\"OK\"}"), 1);
  EXPECT_THAT(metrics(), Not(HasSubstr("curvecast_preprocess_seconds_count{code=\"RESOURCE_EXHAUSTED\"}")))
      << "they have not waited for a worker";
  EXPECT_EQ(metric("curvecast_memory_reserved_bytes"), 0) << "all has been given back";
  EXPECT_GE(metric("curvecast_memory_budget_bytes"), static_cast<double>(kLittle));
  EXPECT_GT(metric("curvecast_memory_held_bytes"), 0);
}

TEST_F(ServerMemory, AViewThatDoesNotFitIsRefusedAtOnce) {
  start({.max_curve_vertices = 0, .memory_bytes = kLittle});
  const std::string session = create(*client_, upload(*client_, sphere_off(3)), 2000).session.session_id();
  OpenedStream stream(*client_, session);
  const auto too_many = static_cast<std::uint64_t>(metric("curvecast_memory_budget_bytes") / 160) + 1;
  v1::SampleRequest sample = view_of(too_many);
  sample.set_sampler(v1::SAMPLER_EQUALISED);
  stream.ask(1, sample);
  const v1::PointFrame refused = stream.read();
  EXPECT_EQ(refused.error().code(), static_cast<std::uint32_t>(grpc::RESOURCE_EXHAUSTED));
  EXPECT_THAT(refused.error().message(), HasSubstr("points takes"));
  stream.acknowledge(1);
  stream.ask(2, 100);
  EXPECT_EQ(stream.read().error().message(), "");
  EXPECT_EQ(metric("curvecast_memory_reserved_bytes"), 0);
}

TEST_F(ServerMemory, AMeshThatDoesNotFitIsNotRead) {
  start({.memory_bytes = 1 << 20});
  v1::InspectMeshRequest request;
  request.set_mesh_id(upload(*client_, testing::to_off(testing::icosphere(8))));
  v1::InspectMeshResponse response;
  grpc::ClientContext context;
  set_patience(context);
  const grpc::Status status = client_->InspectMesh(&context, request, &response);
  EXPECT_EQ(status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("to read"));
  EXPECT_THAT(status.error_message(), HasSubstr("for all of its work"));
}

TEST_F(ServerMemory, IdleSessionsMakeRoom) {
  start({.memory_bytes = 2 * kLittle});
  // Less than half of the memory, which is all that sessions may have, but more than is left by the last.
  std::vector<std::string> ids;
  for (int levels = 2; levels <= 4; ++levels) {
    const Created created = create(*client_, upload(*client_, sphere_off(levels)), 10'000);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    ids.push_back(created.session.session_id());
  }
  const double held = metric("curvecast_memory_held_bytes");
  const double most = metric("curvecast_memory_budget_bytes") * 31 / 32;  // the rest is left to views
  // About as much as there is when nothing else is held.
  const double per_point = 90 * 2.3 * 10;
  const auto points = static_cast<std::uint64_t>((most - held / 2 - 40e6) / per_point);
  const Created created = create(*client_, upload(*client_, testing::to_off(testing::tetrahedron())), points);
  EXPECT_TRUE(created.status.ok()) << created.status.error_message();
  v1::GetSessionRequest request;
  request.set_session_id(ids.front());
  v1::GetSessionResponse response;
  grpc::ClientContext context;
  set_patience(context);
  EXPECT_EQ(client_->GetSession(&context, request, &response).error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerMemory, ASessionWhoseMakingEndedTheServerWaits) {
  const testing::TemporaryFolder cache;
  start({.cache = cache.path(), .crash_pause = std::chrono::seconds(3600)});
  const std::string mesh = upload(*client_, sphere_off(3));
  const std::string id = create(*client_, mesh, 2000).session.session_id();
  v1::CloseSessionRequest request;
  request.set_session_id(id);
  v1::CloseSessionResponse response;
  grpc::ClientContext context;
  set_patience(context);
  ASSERT_TRUE(client_->CloseSession(&context, request, &response).ok());
  EXPECT_THAT(cache.names(), ::testing::Not(::testing::Contains(id + ".making")));
  // As a server leaves it that is killed.
  testing::write_file(cache / (id + ".making"), "0\n");
  const Created refused = create(*client_, mesh, 2000);
  EXPECT_EQ(refused.status.error_code(), grpc::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.status.error_message(), HasSubstr("the server ended while it was made"));
  EXPECT_TRUE(create(*client_, mesh, 2001).status.ok()) << "another one";
}

}  // namespace
}  // namespace curvecast::server
