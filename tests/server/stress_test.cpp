// Many clients that do everything at once, over TCP: for ThreadSanitizer above all.
//   CURVECAST_STRESS_SECONDS=60 for a long run; 3 without it
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "tests/server/server_fixture.h"

namespace curvecast::server {
namespace {

constexpr int kClients = 32;

std::chrono::seconds duration() {
  const char* const seconds = std::getenv("CURVECAST_STRESS_SECONDS");
  return std::chrono::seconds(seconds != nullptr ? std::atoi(seconds) : 3);
}

/// One client, with a connection of its own.
class Client {
 public:
  Client(const std::shared_ptr<grpc::Channel>& channel, unsigned seed, std::atomic<std::uint64_t>& frames)
      : stub_(v1::CurvecastService::NewStub(channel)), random_(seed), frames_(frames) {}

  void act() {
    switch (pick(10)) {
      case 0:
      case 1:
        return create_session();
      case 2:
        return sample();
      case 3:
        return change_session();
      case 4:
        return list();
      default:
        return converse();
    }
  }

 private:
  std::uint64_t pick(std::uint64_t below) { return std::uniform_int_distribution<std::uint64_t>(0, below - 1)(random_); }

  static void expect_fair(const grpc::Status& status) {
    // What others do to a session may come in between, and the server may be full; nothing else goes wrong.
    const std::array fair = {grpc::OK,        grpc::NOT_FOUND,          grpc::FAILED_PRECONDITION, grpc::ABORTED,
                             grpc::CANCELLED, grpc::RESOURCE_EXHAUSTED, grpc::DEADLINE_EXCEEDED};
    EXPECT_NE(std::ranges::find(fair, status.error_code()), fair.end()) << status.error_code() << " " << status.error_message();
  }

  void create_session() {
    const std::string mesh = upload(*stub_, sphere_off(1 + static_cast<int>(pick(3))));
    grpc::ClientContext context;
    set_patience(context);
    v1::CreateSessionRequest request;
    request.set_mesh_id(mesh);
    request.mutable_options()->set_max_points(100 * (1 + pick(4)));
    const auto reader = stub_->CreateSession(&context, request);
    v1::CreateSessionResponse response;
    const bool gives_up = pick(4) == 0;
    while (reader->Read(&response)) {
      if (response.has_session()) session_ = response.session().session_id();
      if (gives_up) context.TryCancel();
    }
    expect_fair(reader->Finish());
  }

  v1::SampleRequest random_sample() {
    v1::SampleRequest sample = view_of(1 + pick(3000));
    sample.mutable_cameras(0)->mutable_eye()->set_x(static_cast<double>(pick(100)) / 20);
    if (pick(2) == 0) sample.set_sampler(v1::SAMPLER_PROGRESSIVE);
    if (pick(4) == 0) sample.mutable_encoding()->mutable_raw();
    return sample;
  }

  void sample() {
    if (session_.empty()) return;
    expect_fair(resample(*stub_, session_, random_sample()).status);
  }

  void change_session() {
    if (session_.empty()) return;
    grpc::ClientContext context;
    set_patience(context);
    if (pick(2) == 0) {
      v1::CloseSessionRequest request;
      request.set_session_id(session_);
      v1::CloseSessionResponse response;
      expect_fair(stub_->CloseSession(&context, request, &response));
    } else {
      v1::UpdateSessionRequest request;
      request.set_session_id(session_);
      request.set_pinned(pick(2) == 0);
      request.set_time_to_live(static_cast<double>(pick(3)));
      v1::UpdateSessionResponse response;
      expect_fair(stub_->UpdateSession(&context, request, &response));
    }
  }

  void list() {
    grpc::ClientContext context;
    set_patience(context);
    v1::ListSessionsRequest request;
    request.set_page_size(2);
    v1::ListSessionsResponse response;
    expect_fair(stub_->ListSessions(&context, request, &response));
    if (response.sessions_size() > 0) session_ = response.sessions(0).session_id();
  }

  void converse() {
    if (session_.empty()) return;
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub_->StreamViews(&context);
    v1::StreamViewsRequest request;
    request.mutable_open()->set_session_id(session_);
    request.mutable_open()->set_accept_deltas(pick(4) != 0);
    stream->Write(request);
    const std::uint64_t views = 1 + pick(12);
    for (std::uint64_t sequence = 1; sequence <= views; ++sequence) {
      request.mutable_view()->set_sequence(sequence);
      *request.mutable_view()->mutable_sample() = random_sample();
      if (pick(3) == 0) request.mutable_view()->set_first_bytes(2000);
      if (!stream->Write(request)) break;
      v1::StreamViewsResponse response;
      if (pick(3) == 0) continue;  // the next view overtakes it
      if (!stream->Read(&response)) break;
      ++frames_;
      request.mutable_ack()->set_sequence(response.frame().sequence());
      if (!stream->Write(request)) break;
    }
    if (pick(3) == 0) {
      context.TryCancel();
    } else {
      stream->WritesDone();
    }
    v1::StreamViewsResponse rest;
    while (stream->Read(&rest)) ++frames_;
    expect_fair(stream->Finish());
  }

  std::unique_ptr<Stub> stub_;
  std::mt19937 random_;
  std::atomic<std::uint64_t>& frames_;
  std::string session_;
};

class Stress : public ServerFixture {};

TEST_F(Stress, ManyClientsDoEverythingAtOnce) {
  start({.max_mesh_bytes = 4 << 20, .max_sessions = 6, .max_streams = 24, .max_uploads_of_client = 64});
  std::atomic<std::uint64_t> frames = 0;
  const auto end = std::chrono::steady_clock::now() + duration();
  {
    std::vector<std::jthread> threads;
    for (unsigned c = 0; c < kClients; ++c) {
      threads.emplace_back([&, c] {
        Client one(connect(), c, frames);
        // On a busy machine nobody may have come as far as a frame by then.
        while (std::chrono::steady_clock::now() < end || frames == 0) one.act();
      });
    }
  }
  // And it serves as if nothing had been, once those that were pinned make room.
  const auto stub = client();
  grpc::ClientContext context;
  set_patience(context);
  v1::ListSessionsResponse left;
  ASSERT_TRUE(stub->ListSessions(&context, {}, &left).ok());
  for (const v1::Session& session : left.sessions()) {
    grpc::ClientContext closing;
    v1::CloseSessionRequest request;
    request.set_session_id(session.session_id());
    v1::CloseSessionResponse response;
    const grpc::Status status = stub->CloseSession(&closing, request, &response);
    // One that was not wanted any more may have gone meanwhile.
    EXPECT_TRUE(status.ok() || status.error_code() == grpc::NOT_FOUND) << status.error_message();
  }
  const Created created = create(*stub, upload(*stub, sphere_off(2)), 500);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_EQ(resample(*stub, created.session.session_id(), view_of(100)).points(), 100u);
}

}  // namespace
}  // namespace curvecast::server
