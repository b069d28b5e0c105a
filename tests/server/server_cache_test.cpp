// Sessions that outlive their server, over TCP.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <thread>

#include "core/storage/curve_file.h"
#include "server_fixture.h"
#include "tests/server/eventually.h"
#include "tests/server/frame/frame_points.h"
#include "tests/server/opened_stream.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using testing::bytes_of;
using ::testing::Each;
using ::testing::EndsWith;
using testing::TemporaryFolder;
using testing::write_file;

class ServerCache : public ServerFixture {
 protected:
  void SetUp() override { restart(); }
  void restart() { start({.max_sessions = max_sessions_, .max_curve_vertices = max_curve_vertices_, .cache = folder_.path()}); }

  static std::pair<grpc::Status, v1::Session> get(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(id);
    v1::GetSessionResponse response;
    const grpc::Status status = stub.GetSession(&context, request, &response);
    return {status, response.session()};
  }
  static grpc::Status close(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::CloseSessionRequest request;
    request.set_session_id(id);
    v1::CloseSessionResponse response;
    return stub.CloseSession(&context, request, &response);
  }
  /// A session that has been written.
  v1::Session make_cached(Stub& stub, int levels) {
    const Created created = create(stub, upload(stub, sphere_off(levels)), 1000);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    wait_until_cached(stub, created.session.session_id());
    return created.session;
  }
  static void wait_until_cached(Stub& stub, const std::string& id) {
    EXPECT_TRUE(eventually([&] { return get(stub, id).second.cached(); }));
  }
  /// Of sessions.
  std::vector<std::string> files() const {
    std::vector<std::string> names = folder_.names();
    std::erase(names, "meshes");
    return names;
  }
  /// Of the only session there is.
  std::string curve_path() const {
    for (const std::string& name : folder_.names()) {
      if (std::filesystem::path(name).extension() == ".curve") return folder_ / name;
    }
    ADD_FAILURE() << "no curve in the cache";
    return "";
  }
  static std::vector<std::string> stages(const Created& created) {
    std::vector<std::string> stages;
    for (const v1::Progress& progress : created.progress) {
      if (stages.empty() || stages.back() != progress.stage()) stages.push_back(progress.stage());
    }
    return stages;
  }

  TemporaryFolder folder_;
  std::uint64_t max_sessions_ = 64;
  std::uint64_t max_curve_vertices_ = 0;  // no curve is refined: points stay what they are
};

TEST_F(ServerCache, SessionsSurviveARestart) {
  const v1::Session made = make_cached(*client(), 3);
  const std::string& id = made.session_id();
  const std::string bytes = resample(*client(), id, view_of(900)).bytes();
  restart();
  const Resampled again = resample(*client(), id, view_of(900));
  ASSERT_TRUE(again.status.ok()) << again.status.error_message();
  EXPECT_EQ(again.bytes(), bytes);
  restart();
  const auto [status, session] = get(*client(), id);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_TRUE(session.cached());
  EXPECT_EQ(session.mesh_id(), made.mesh_id());
  EXPECT_EQ(session.options().SerializeAsString(), made.options().SerializeAsString());
  EXPECT_EQ(session.report().mesh().SerializeAsString(), made.report().mesh().SerializeAsString());
  EXPECT_EQ(session.report().seconds().total(), made.report().seconds().total());
}

// What views need takes seconds to make: who comes back after a crash has most of it at once.
TEST_F(ServerCache, CandidatesThatViewsNeededSurviveTheServer) {
  const std::string id = make_cached(*client(), 4).session_id();
  constexpr std::uint64_t kPoints = 20'000, kMost = 16'000;
  v1::SampleRequest view = view_of(kPoints);
  view.set_sampler(v1::SAMPLER_PROGRESSIVE);
  {
    OpenedStream opened(*client(), id);
    opened.ask(1, view);
    v1::PointFrame frame = opened.read();
    EXPECT_LT(frame.held_points(), kMost) << "the others are made for it";
    while (frame.sequence() == 1 && frame.statistics().refining()) {
      opened.acknowledge(1);
      frame = opened.read();
    }
    EXPECT_EQ(frame.held_points(), kPoints);
  }
  EXPECT_TRUE(eventually([&] {
    const TemporaryFolder copy;  // as a server that was killed leaves it
    std::filesystem::copy(folder_.path(), copy.path(), std::filesystem::copy_options::recursive);
    start({.cache = copy.path()});
    OpenedStream opened(*client(), id);
    opened.ask(1, view);
    return opened.read().held_points() > kMost;
  }));
}

TEST_F(ServerCache, CurvesOfBeforeARestartAreSent) {
  const std::string id = make_cached(*client(), 3).session_id();
  restart();
  const auto stub = client();
  grpc::ClientContext context;
  set_patience(context);
  v1::GetCurveRequest request;
  request.set_session_id(id);
  const auto reader = stub->GetCurve(&context, request);
  std::uint64_t vertices = 0, sent = 0;
  for (v1::GetCurveResponse response; reader->Read(&response);) {
    if (response.has_info()) vertices = response.info().curve_vertices();
    sent += response.chunk().count();
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_GT(sent, 0u);
  EXPECT_EQ(sent, vertices);
}

TEST_F(ServerCache, StreamsOpenSessionsOfBeforeARestart) {
  const std::string id = make_cached(*client(), 3).session_id();
  restart();
  const auto stub = client();
  grpc::ClientContext context;
  set_patience(context);
  const auto stream = stub->StreamViews(&context);
  v1::StreamViewsRequest open, view;
  open.mutable_open()->set_session_id(id);
  view.mutable_view()->set_sequence(7);
  *view.mutable_view()->mutable_sample() = view_of(500);
  ASSERT_TRUE(stream->Write(open) && stream->Write(view));
  v1::StreamViewsResponse response;
  ASSERT_TRUE(stream->Read(&response));
  EXPECT_EQ(response.frame().sequence(), 7u);
  EXPECT_EQ(count_points(response.frame()), 500u);
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&response));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(ServerCache, AStreamMayGoAwayWhileItsSessionIsLoaded) {
  const std::string id = make_cached(*client(), 5).session_id();
  for (int i = 0; i < 10; ++i) {
    restart();
    const auto stub = client();
    grpc::ClientContext context;
    set_patience(context);
    const auto stream = stub->StreamViews(&context);
    v1::StreamViewsRequest open;
    open.mutable_open()->set_session_id(id);
    stream->Write(open);
    std::this_thread::sleep_for(std::chrono::milliseconds(i));
    context.TryCancel();
    EXPECT_EQ(stream->Finish().error_code(), grpc::CANCELLED);
    EXPECT_TRUE(get(*stub, id).first.ok());
  }
}

TEST_F(ServerCache, CreateSessionLoadsInsteadOfPreprocessing) {
  const v1::Session made = make_cached(*client(), 3);
  restart();
  const auto stub = client();
  const Created again = create(*stub, upload(*stub, sphere_off(3)), 1000);
  ASSERT_TRUE(again.status.ok()) << again.status.error_message();
  EXPECT_EQ(stages(again), (std::vector<std::string>{"queued", "load"}));
  EXPECT_TRUE(again.session.cached());
  EXPECT_EQ(again.session.session_id(), made.session_id());
  EXPECT_EQ(again.session.report().seconds().total(), made.report().seconds().total());
}

TEST_F(ServerCache, DamagedFilesAreRebuilt) {
  const std::string id = make_cached(*client(), 3).session_id();
  const std::string bytes = resample(*client(), id, view_of(900)).bytes();
  const std::string good = bytes_of(curve_path());
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  for (const std::string& damaged : {std::string(), good.substr(0, 1000), flipped}) {
    server_.reset();
    write_file(folder_ / absl::StrCat(id, ".v", kCurveFileVersion, ".curve"), damaged);
    restart();
    const auto stub = client();
    const Created again = create(*stub, upload(*stub, sphere_off(3)), 1000);
    ASSERT_TRUE(again.status.ok()) << again.status.error_message();
    EXPECT_THAT(stages(again), ::testing::IsSupersetOf({"load", "read", "map"}));
    EXPECT_EQ(resample(*stub, id, view_of(900)).bytes(), bytes);
    wait_until_cached(*stub, id);
    EXPECT_EQ(resample(*stub, id, view_of(900)).bytes(), bytes);
  }
  server_.reset();
  write_file(folder_ / absl::StrCat(id, ".v", kCurveFileVersion, ".curve"), flipped);
  restart();
  EXPECT_EQ(get(*client(), id).first.error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(resample(*client(), id, view_of(900)).status.error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerCache, EvictionCostsNothing) {
  max_sessions_ = 1;
  max_curve_vertices_ = ServerOptions().max_curve_vertices;
  restart();
  const auto stub = client();
  const std::string a = make_cached(*stub, 2).session_id();
  // A view that has the curve refined: that is no use of the session that would keep it.
  EXPECT_TRUE(resample(*stub, a, view_of(900)).status.ok());
  const std::string b = make_cached(*stub, 3).session_id();
  grpc::ClientContext context;
  v1::ListSessionsResponse list;
  ASSERT_TRUE(stub->ListSessions(&context, {}, &list).ok());
  ASSERT_EQ(list.sessions_size(), 1);
  EXPECT_EQ(list.sessions(0).session_id(), b);
  EXPECT_TRUE(list.sessions(0).cached());
  EXPECT_TRUE(resample(*stub, a, view_of(50)).status.ok());
  EXPECT_TRUE(resample(*stub, b, view_of(50)).status.ok());
}

TEST_F(ServerCache, CloseForgetsTheFilesToo) {
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  EXPECT_TRUE(close(*stub, id).ok());
  EXPECT_THAT(files(), Each(EndsWith(".closed")));
  EXPECT_EQ(get(*stub, id).first.error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(close(*stub, id).error_code(), grpc::NOT_FOUND);
  const std::string other = make_cached(*stub, 3).session_id();
  restart();
  EXPECT_TRUE(close(*client(), other).ok()) << "though it is not in memory";
  EXPECT_THAT(files(), Each(EndsWith(".closed")));
}

TEST_F(ServerCache, WhatIsClosedMayBeMadeAnew) {
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  EXPECT_TRUE(close(*stub, id).ok());
  EXPECT_EQ(make_cached(*stub, 2).session_id(), id);
  restart();
  EXPECT_TRUE(get(*client(), id).first.ok());
}

TEST_F(ServerCache, WhatOneServerClosesIsGoneFromAll) {
  max_curve_vertices_ = ServerOptions().max_curve_vertices;
  restart();
  const auto other_server = Server::start({.cache = folder_.path(), .log = false});
  ASSERT_TRUE(other_server.ok()) << other_server.status();
  const auto other = v1::CurvecastService::NewStub((*other_server)->in_process_channel());
  const auto stub = client();
  const std::string id = make_cached(*stub, 4).session_id();
  // Has the curve refined, which the other server saves.
  EXPECT_TRUE(resample(*other, id, view_of(50'000)).status.ok());
  EXPECT_TRUE(close(*stub, id).ok());
  EXPECT_TRUE(eventually([&] { return get(*other, id).first.error_code() == grpc::NOT_FOUND; }));
  EXPECT_EQ(resample(*other, id, view_of(50)).status.error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(get(*stub, id).first.error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerCache, TimeToLiveLeavesTheFilesToOthers) {
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  {
    grpc::ClientContext context;
    set_patience(context);
    v1::UpdateSessionRequest request;
    request.set_session_id(id);
    request.set_time_to_live(0.01);
    v1::UpdateSessionResponse response;
    ASSERT_TRUE(stub->UpdateSession(&context, request, &response).ok());
  }
  EXPECT_TRUE(eventually([&] {
    grpc::ClientContext context;
    v1::ListSessionsResponse list;
    return stub->ListSessions(&context, {}, &list).ok() && list.sessions_size() == 0;
  }));
  restart();
  EXPECT_TRUE(get(*client(), id).first.ok());
}

TEST_F(ServerCache, SessionsInUseAreTheLastToGo) {
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(3);
  std::filesystem::last_write_time(curve_path(), long_ago);
  EXPECT_TRUE(eventually([&] {
    return resample(*stub, id, view_of(50)).status.ok() &&
           std::filesystem::last_write_time(curve_path()) > long_ago + std::chrono::hours(1);
  }));
}

TEST_F(ServerCache, TwoServersShareOneFolder) {
  const auto other_server = Server::start({.max_curve_vertices = 0, .cache = folder_.path(), .log = false});
  ASSERT_TRUE(other_server.ok()) << other_server.status();
  const auto other = v1::CurvecastService::NewStub((*other_server)->in_process_channel());
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  EXPECT_EQ(resample(*other, id, view_of(900)).bytes(), resample(*stub, id, view_of(900)).bytes());
  // Both make and write the same sessions at once.
  for (int levels = 3; levels < 5; ++levels) {
    std::thread thread([&] { make_cached(*other, levels); });
    const std::string both = make_cached(*stub, levels).session_id();
    thread.join();
    EXPECT_EQ(resample(*other, both, view_of(900)).bytes(), resample(*stub, both, view_of(900)).bytes());
  }
}

TEST_F(ServerCache, GoesOnServingWhenTheFolderIsGone) {
  const auto stub = client();
  const std::string id = make_cached(*stub, 2).session_id();
  const TemporaryFolder elsewhere;  // renamed at once: files may still be written while a folder is emptied
  std::filesystem::rename(folder_.path(), elsewhere / "gone");
  EXPECT_EQ(resample(*stub, id, view_of(900)).points(), 900u);
  EXPECT_FALSE(get(*stub, id).second.cached());
  v1::UploadHeader header;
  header.set_name("test.off");
  const std::string off = sphere_off(3);
  header.set_size(off.size());
  EXPECT_EQ(upload(*stub, header, off).status.error_code(), grpc::UNAVAILABLE) << "it would not survive";
}

TEST_F(ServerCache, RefusesAFolderThatCannotBeUsed) {
  write_file(folder_ / "file", "");
  const auto server = Server::start({.cache = folder_ / "file", .log = false});
  EXPECT_EQ(server.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(server.status().message()), ::testing::HasSubstr("cache folder"));
}

}  // namespace
}  // namespace curvecast::server
