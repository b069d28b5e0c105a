// Servers with a cache each and a store in a folder that they share, over TCP.
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server_fixture.h"
#include "tests/server/eventually.h"
#include "tests/server/has_line.h"
#include "tests/server/opened_stream.h"
#include "tests/server/two_callers.h"
#include "tests/server/web/http_client.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;
using testing::bytes_of;
using ::testing::Contains;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::TemporaryFolder;
using testing::write_file;

/// One of the servers, with a cache of its own.
struct Replica {
  void start(ServerOptions options) {
    stub.reset();
    server.reset();
    options.listen = options.admin = "127.0.0.1:0";
    options.cache = cache.path();
    options.log = false;
    auto started = Server::start(options);
    ASSERT_TRUE(started.ok()) << started.status();
    server = *std::move(started);
    stub = v1::CurvecastService::NewStub(connect_to(*server));
  }
  std::string metrics() const { return metrics_of(*server); }
  double preprocessed() const { return value_of(metrics(), "curvecast_preprocess_seconds_count{code=\"OK\"}"); }
  double unstored() const { return value_of(metrics(), "curvecast_unstored"); }

  std::pair<grpc::Status, v1::Session> get(const std::string& id) const {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(id);
    v1::GetSessionResponse response;
    const grpc::Status status = stub->GetSession(&context, request, &response);
    return {status, response.session()};
  }
  grpc::Status get_mesh(const std::string& id) const {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetMeshRequest request;
    request.set_mesh_id(id);
    v1::GetMeshResponse response;
    return stub->GetMesh(&context, request, &response);
  }
  static grpc::Status close(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::CloseSessionRequest request;
    request.set_session_id(id);
    v1::CloseSessionResponse response;
    return stub.CloseSession(&context, request, &response);
  }
  /// Makes a session and waits until the store has it.
  v1::Session make(const std::string& off, std::uint64_t points = 1000) const {
    const Created created = create(*stub, upload(*stub, off), points);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    EXPECT_TRUE(eventually([&] { return get(created.session.session_id()).second.cached(); }));
    return created.session;
  }

  TemporaryFolder cache;
  std::unique_ptr<Server> server;
  std::unique_ptr<Stub> stub;
};

class ServerStore : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(root_);
    a_.start(options());
    b_.start(options());
  }
  ServerOptions options() const { return {.max_curve_vertices = 0, .store = "file://" + root_}; }
  std::vector<std::string> stored(const std::string& folder = "sessions") const {
    std::vector<std::string> names;
    std::error_code error;
    for (fs::directory_iterator it(root_ + "/" + folder, error), end; !error && it != end; it.increment(error)) {
      names.push_back(it->path().filename().string());
    }
    return names;
  }
  std::string path_of(const std::string& id, const std::string& ending) const {
    for (const std::string& name : stored()) {
      if (name.starts_with(id) && name.ends_with(ending)) return root_ + "/sessions/" + name;
    }
    ADD_FAILURE() << "the store has no " << ending << " of " << id;
    return "";
  }
  void take_away() const { fs::rename(root_, folder_ / "elsewhere"); }
  void bring_back() const { fs::rename(folder_ / "elsewhere", root_); }
  static std::string points(const Replica& replica, const std::string& id) {
    v1::SampleRequest sample = view_of(500);
    sample.mutable_encoding()->mutable_raw();
    const Resampled resampled = resample(*replica.stub, id, sample);
    EXPECT_TRUE(resampled.status.ok()) << resampled.status.error_message();
    return resampled.bytes();
  }

  const TemporaryFolder folder_;
  const std::string root_ = folder_ / "store";
  Replica a_, b_;
};

TEST_F(ServerStore, OneServersUploadIsAnothersMesh) {
  const std::string id = upload(*a_.stub, sphere_off(3));
  EXPECT_THAT(stored("meshes"), ::testing::ElementsAre(id)) << "it was acknowledged";
  EXPECT_TRUE(b_.get_mesh(id).ok());
  const Created created = create(*b_.stub, id, 500);
  EXPECT_TRUE(created.status.ok()) << created.status.error_message();
}

TEST_F(ServerStore, ASessionMadeByOneIsServedByTheOther) {
  const std::string id = a_.make(sphere_off(4)).session_id();
  const std::string expected = points(a_, id);
  EXPECT_EQ(points(b_, id), expected);
  EXPECT_EQ(b_.preprocessed(), 0);
  EXPECT_TRUE(b_.get(id).second.cached());
  OpenedStream stream(*b_.stub, id);
  EXPECT_TRUE(stream.answer().ok());
  EXPECT_EQ(b_.preprocessed(), 0);
}

TEST_F(ServerStore, WhoAsksAnotherServerForTheSameHasItLoaded) {
  const v1::Session made = a_.make(sphere_off(3));
  const Created again = create(*b_.stub, made.mesh_id(), 1000);
  ASSERT_TRUE(again.status.ok()) << again.status.error_message();
  EXPECT_EQ(again.session.session_id(), made.session_id());
  EXPECT_EQ(b_.preprocessed(), 0);
  EXPECT_EQ(points(b_, made.session_id()), points(a_, made.session_id()));
}

TEST_F(ServerStore, AStreamOpensWhatOnlyTheStoreHas) {
  const std::string id = a_.make(sphere_off(3)).session_id();
  OpenedStream stream(*b_.stub, id);
  EXPECT_TRUE(stream.answer().ok());
  OpenedStream unknown(*b_.stub, std::string(32, '0'));
  EXPECT_EQ(unknown.answer().error_code(), grpc::NOT_FOUND);
}

TEST_F(ServerStore, ClosedByOneItIsGoneForAll) {
  const std::string id = a_.make(sphere_off(3)).session_id();
  EXPECT_TRUE(b_.get(id).first.ok());
  EXPECT_TRUE(Replica::close(*a_.stub, id).ok());
  EXPECT_EQ(a_.get(id).first.error_code(), grpc::NOT_FOUND);
  EXPECT_TRUE(eventually([&] { return b_.get(id).first.error_code() == grpc::NOT_FOUND; }));
  EXPECT_THAT(stored(), ::testing::ElementsAre(id + ".closed"));
  b_.start(options());
  EXPECT_EQ(b_.get(id).first.error_code(), grpc::NOT_FOUND) << "nor does it come back";
  EXPECT_THAT(stored(), ::testing::ElementsAre(id + ".closed"));
  EXPECT_EQ(Replica::close(*b_.stub, id).error_code(), grpc::NOT_FOUND);
  EXPECT_EQ(b_.make(sphere_off(3)).session_id(), id) << "who makes it anew has it";
  EXPECT_THAT(stored(), Not(Contains(EndsWith(".closed"))));
  // A server that has just asked the store in vain does not ask again at once.
  EXPECT_TRUE(eventually([&] { return a_.get(id).first.ok(); }));
}

TEST_F(ServerStore, AFinerCurveOfAClosedSessionIsNotWrittenBack) {
  ServerOptions refining = options();
  refining.max_curve_vertices = ServerOptions().max_curve_vertices;
  b_.start(refining);
  const std::string id = a_.make(sphere_off(3)).session_id();
  OpenedStream stream(*b_.stub, id);  // has it in memory for as long as it wants
  EXPECT_TRUE(stream.answer(1).ok());
  EXPECT_TRUE(Replica::close(*a_.stub, id).ok());
  stream.ask(2, 50'000);
  v1::PointFrame frame;
  do {
    frame = stream.read();
    stream.acknowledge(2);
  } while (frame.sequence() != 0 && (frame.sequence() != 2 || frame.statistics().refining()));
  EXPECT_GT(frame.curve_revision(), 1u);
  EXPECT_TRUE(eventually([&] { return b_.get(id).first.error_code() == grpc::NOT_FOUND && b_.unstored() == 0; }));
  EXPECT_THAT(stored(), ::testing::ElementsAre(id + ".closed"));
}

TEST_F(ServerStore, FinerCurvesAreShared) {
  ServerOptions refining = options();
  refining.max_curve_vertices = ServerOptions().max_curve_vertices;
  a_.start(refining);
  const std::string id = a_.make(sphere_off(3)).session_id();
  v1::SampleRequest more;
  more.set_points(50'000);
  EXPECT_TRUE(resample(*a_.stub, id, more).status.ok());
  EXPECT_TRUE(eventually([&] {
    const v1::Session now = a_.get(id).second;
    return now.curve_revision() > 1 && !now.refining();
  }));
  const std::uint64_t revision = a_.get(id).second.curve_revision();
  std::unique_ptr<Replica> fresh;
  EXPECT_TRUE(eventually([&] {  // it is put after the session itself
    fresh = std::make_unique<Replica>();
    fresh->start(options());
    return fresh->get(id).second.curve_revision() == revision;
  }));
  EXPECT_EQ(points(*fresh, id), points(a_, id));
}

TEST_F(ServerStore, TimeToLiveAndEvictionAreOneServersOwn) {
  ServerOptions small = options();
  small.max_sessions = 1;
  a_.start(small);
  const std::string first = a_.make(sphere_off(3)).session_id(), second = a_.make(sphere_off(2)).session_id();
  {
    grpc::ClientContext context;
    set_patience(context);
    v1::UpdateSessionRequest request;
    request.set_session_id(second);
    request.set_time_to_live(0.1);
    v1::UpdateSessionResponse response;
    EXPECT_TRUE(a_.stub->UpdateSession(&context, request, &response).ok());
  }
  EXPECT_TRUE(eventually([&] { return value_of(a_.metrics(), "curvecast_sessions") == 0; }));
  for (const std::string& id : {first, second}) EXPECT_TRUE(b_.get(id).first.ok());
  EXPECT_EQ(b_.preprocessed(), 0);
}

TEST_F(ServerStore, WhatIsDamagedThereIsMadeAgain) {
  const v1::Session made = a_.make(sphere_off(3));
  const std::string id = made.session_id(), expected = points(a_, id);
  const std::string other = a_.make(sphere_off(2)).session_id();
  for (const char* const ending : {".curve", ".surface"}) {
    const std::string path = path_of(id, ending), good = bytes_of(path);
    std::string flipped = good;
    flipped[good.size() / 2] ^= 1;
    for (const std::string& bad : {good.substr(0, good.size() / 2), flipped, bytes_of(path_of(other, ending))}) {
      write_file(path, bad);
      Replica fresh;
      fresh.start(options());
      EXPECT_EQ(fresh.get(id).first.error_code(), grpc::NOT_FOUND) << ending;
      EXPECT_FALSE(fs::exists(path)) << "it is removed there";
      EXPECT_EQ(fresh.make(sphere_off(3)).session_id(), id);
      EXPECT_EQ(points(fresh, id), expected);
      EXPECT_EQ(fresh.preprocessed(), 1);
      EXPECT_TRUE(fs::exists(path)) << "and put again";
    }
  }
}

TEST_F(ServerStore, WhileItIsAwayWhatIsHereGoesOn) {
  const v1::Session made = a_.make(sphere_off(3));
  const std::string id = made.session_id(), expected = points(a_, id);
  EXPECT_TRUE(b_.get(id).first.ok());
  b_.start(options());  // it is in the local cache only
  take_away();
  EXPECT_EQ(points(a_, id), expected);
  EXPECT_EQ(points(b_, id), expected);
  const Uploaded refused = upload(*a_.stub, {}, sphere_off(2));
  EXPECT_EQ(refused.status.error_code(), grpc::INVALID_ARGUMENT) << "a header that is wrong is wrong";
  v1::UploadHeader header;
  header.set_size(sphere_off(2).size());
  const Uploaded not_now = upload(*a_.stub, header, sphere_off(2));
  EXPECT_EQ(not_now.status.error_code(), grpc::UNAVAILABLE);
  EXPECT_THAT(not_now.status.error_message(), HasSubstr("is it mounted?"));
  EXPECT_EQ(a_.get_mesh(std::string(32, '0')).error_code(), grpc::UNAVAILABLE) << "it may be there";
  EXPECT_EQ(a_.get(std::string(32, '0')).first.error_code(), grpc::UNAVAILABLE);
  const Created meanwhile = create(*a_.stub, made.mesh_id(), 2000);
  ASSERT_TRUE(meanwhile.status.ok()) << meanwhile.status.error_message();
  const std::string later = meanwhile.session.session_id();
  EXPECT_TRUE(eventually([&] { return a_.unstored() == 1; }));
  EXPECT_FALSE(a_.get(later).second.cached());
  EXPECT_EQ(Replica::close(*a_.stub, id).error_code(), grpc::UNAVAILABLE);
  EXPECT_EQ(HttpClient(a_.server->admin_port()).get("/readyz").status, 200) << "others would be no better";
  bring_back();
  EXPECT_TRUE(eventually([&] { return a_.get(later).second.cached(); }));
  EXPECT_EQ(a_.unstored(), 0);
  EXPECT_TRUE(eventually([&] { return b_.get(later).first.ok(); }));
  EXPECT_TRUE(eventually([&] { return upload(*a_.stub, header, sphere_off(2)).status.ok(); }));
  EXPECT_TRUE(Replica::close(*a_.stub, id).ok());
}

TEST_F(ServerStore, AServerStartsAndEndsWithoutIt) {
  const v1::Session made = a_.make(sphere_off(3));
  take_away();
  a_.start(options());
  EXPECT_TRUE(a_.get(made.session_id()).first.ok());
  const std::string later = create(*a_.stub, made.mesh_id(), 2000).session.session_id();
  EXPECT_TRUE(eventually([&] { return a_.unstored() == 1; }));
  EXPECT_TRUE(a_.server->shutdown_within(std::chrono::milliseconds(100), std::chrono::minutes(1)).ok());
  a_.server.reset();
  bring_back();
  EXPECT_EQ(b_.get(later).first.error_code(), grpc::NOT_FOUND);
  a_.start(options());
  EXPECT_TRUE(eventually([&] { return b_.get(later).first.ok(); })) << "the next one puts what the last one could not";
  EXPECT_EQ(b_.preprocessed(), 0);
}

TEST_F(ServerStore, OwnersAreTheSameEverywhere) {
  write_file(folder_ / "tokens", kTokens);
  ServerOptions closed = options();
  closed.tokens = folder_ / "tokens";
  a_.start(closed);
  b_.start(closed);
  const auto anna = client_sending(*a_.server, "authorization", "Bearer anna's");
  const Created created = create(*anna, upload(*anna, sphere_off(3)), 1000);
  ASSERT_TRUE(created.status.ok()) << created.status.error_message();
  const std::string id = created.session.session_id();
  EXPECT_TRUE(eventually([&] { return a_.unstored() == 0 && stored().size() >= 2; }));
  const auto bert = client_sending(*b_.server, "authorization", "Bearer bert's");
  EXPECT_EQ(Replica::close(*bert, id).error_code(), grpc::PERMISSION_DENIED);
  const auto anna_there = client_sending(*b_.server, "authorization", "Bearer anna's");
  EXPECT_TRUE(Replica::close(*anna_there, id).ok());
  EXPECT_THAT(stored(), ::testing::ElementsAre(id + ".closed"));
}

TEST_F(ServerStore, CallsAreCounted) {
  a_.make(sphere_off(2));
  const std::string text = a_.metrics();
  EXPECT_GE(value_of(text, "curvecast_store_operations_total{operation=\"put\",result=\"ok\"}"), 3);
  EXPECT_GE(value_of(text, "curvecast_store_seconds_count{operation=\"put\"}"), 3);
  EXPECT_EQ(value_of(text, "curvecast_store_operations_total{operation=\"put\",result=\"error\"}"), 0);
}

TEST(ServerStoreOptions, WantsACacheAndAUrl) {
  const TemporaryFolder folder;
  EXPECT_EQ(Server::start({.store = "file://" + folder.path(), .log = false}).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Server::start({.cache = folder.path(), .store = "nowhere", .log = false}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace curvecast::server
