// What becomes of sessions and meshes when the disk below the cache is full, loses bytes, or its server is started anew; over
// TCP.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "server_fixture.h"
#include "tests/server/eventually.h"
#include "tests/server/has_line.h"
#include "tests/server/opened_stream.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using testing::bytes_of;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::TemporaryFolder;
using testing::write_file;

class ServerDisk : public ServerFixture {
 protected:
  void SetUp() override { restart(); }
  void restart() {
    start({.max_mesh_bytes = max_mesh_bytes_,
           .max_sessions = max_sessions_,
           .max_curve_vertices = 0,
           .cache = folder_.path(),
           .admin = "127.0.0.1:0"});
  }

  static std::pair<grpc::Status, v1::GetMeshResponse> get_mesh(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetMeshRequest request;
    request.set_mesh_id(id);
    v1::GetMeshResponse response;
    const grpc::Status status = stub.GetMesh(&context, request, &response);
    return {status, response};
  }
  static bool is_cached(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(id);
    v1::GetSessionResponse response;
    return stub.GetSession(&context, request, &response).ok() && response.session().cached();
  }
  static v1::Session make(Stub& stub, int levels, std::uint64_t points = 1000) {
    const Created created = create(stub, upload(stub, sphere_off(levels)), points);
    EXPECT_TRUE(created.status.ok()) << created.status.error_message();
    return created.session;
  }
  std::string mesh_path(const std::string& id) const { return folder_ / ("meshes/" + id + ".mesh"); }
  /// Of the session's file with this ending.
  std::string path_of(const std::string& id, const std::string& ending) const {
    for (const std::string& name : folder_.names()) {
      if (name.starts_with(id) && name.ends_with(ending)) return folder_ / name;
    }
    return "";
  }

  TemporaryFolder folder_;
  std::uint64_t max_mesh_bytes_ = ServerOptions().max_mesh_bytes;
  std::uint64_t max_sessions_ = ServerOptions().max_sessions;
};

TEST_F(ServerDisk, UploadsSurviveARestart) {
  const std::string off = sphere_off(3);
  const std::string id = upload(*client(), off);
  restart();
  const auto [status, mesh] = get_mesh(*client(), id);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(mesh.name(), "test.off");
  EXPECT_EQ(mesh.size(), off.size());
  restart();
  const Created created = create(*client(), id, 500);
  EXPECT_TRUE(created.status.ok()) << created.status.error_message();
  EXPECT_EQ(created.session.mesh_id(), id);
}

TEST_F(ServerDisk, AnotherServerFindsUploads) {
  const auto other_server = Server::start({.cache = folder_.path(), .log = false});
  ASSERT_TRUE(other_server.ok()) << other_server.status();
  const auto other = v1::CurvecastService::NewStub((*other_server)->in_process_channel());
  const std::string id = upload(*client(), sphere_off(3));
  EXPECT_TRUE(get_mesh(*other, id).first.ok());
  EXPECT_TRUE(create(*other, id, 500).status.ok());
}

TEST_F(ServerDisk, ADamagedUploadIsNotFoundAndUploadedAgain) {
  const std::string off = sphere_off(3);
  const std::string id = upload(*client(), off);
  const std::string good = bytes_of(mesh_path(id));
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  for (const std::string& bytes : {flipped, good.substr(0, good.size() / 2), std::string()}) {
    server_.reset();
    write_file(mesh_path(id), bytes);
    restart();
    EXPECT_EQ(get_mesh(*client(), id).first.error_code(), grpc::NOT_FOUND);
    EXPECT_FALSE(std::filesystem::exists(mesh_path(id)));
    EXPECT_EQ(upload(*client(), off), id);
    server_.reset();
    write_file(mesh_path(id), bytes);
    restart();
    EXPECT_EQ(create(*client(), id, 500).status.error_code(), grpc::NOT_FOUND) << "nobody has asked before";
    EXPECT_EQ(upload(*client(), off), id);
    EXPECT_TRUE(create(*client(), id, 500).status.ok());
  }
}

TEST_F(ServerDisk, StoredMeshesKeepWithinTheLimit) {
  const std::string off = sphere_off(3);
  max_mesh_bytes_ = 3 * (off.size() + 10'000);
  restart();
  const std::string first = upload(*client(), off);
  for (int i = 0; i < 5; ++i) {
    restart();
    upload(*client(), off + std::string(static_cast<std::size_t>(i) + 1, '\n'));
  }
  EXPECT_EQ(get_mesh(*client(), first).first.error_code(), grpc::NOT_FOUND);
  std::uint64_t bytes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "meshes")) bytes += entry.file_size();
  EXPECT_LE(bytes, max_mesh_bytes_);
  EXPECT_GE(bytes, 2 * off.size());
}

/// No file of this process can grow beyond so many bytes meanwhile, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : old_handler_(::signal(SIGXFSZ, SIG_IGN)) {
    EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before_), 0);
    const rlimit limit = {bytes, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;
  ~FullDisk() {
    EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before_), 0);
    ::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit before_ = {};
  void (*old_handler_)(int);
};

TEST_F(ServerDisk, WhatTheFullDiskDidNotTakeIsSavedOnceThereIsRoom) {
  max_sessions_ = 20;
  restart();
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(3));
  std::vector<std::string> ids;
  {
    const FullDisk full(5000);
    for (std::uint64_t points = 100; points < 118; ++points) {
      const Created created = create(*stub, mesh, points);
      ASSERT_TRUE(created.status.ok()) << created.status.error_message();
      ids.push_back(created.session.session_id());
    }
    EXPECT_TRUE(eventually([&] { return has_line(metrics(), "curvecast_unsaved_sessions 18"); }));
    EXPECT_TRUE(
        eventually([&] { return metric("curvecast_cache_operations_total{operation=\"save\",result=\"error\"}") >= 18; }));
    for (const std::string& id : ids) EXPECT_FALSE(is_cached(*stub, id));
    v1::UploadHeader header;
    const std::string off = sphere_off(4);
    header.set_name("large.off");
    header.set_size(off.size());
    const Uploaded refused = upload(*stub, header, off);
    EXPECT_FALSE(refused.status.ok()) << "what is acknowledged survives";
  }
  for (const std::string& id : ids) EXPECT_TRUE(eventually([&] { return is_cached(*stub, id); })) << id;
  EXPECT_TRUE(eventually([&] { return has_line(metrics(), "curvecast_unsaved_sessions 0"); }));
  EXPECT_TRUE(has_line(metrics(), "curvecast_cache_operations_total{operation=\"save\",result=\"ok\"} 18"));
  const std::string bytes = resample(*stub, ids[0], view_of(100)).bytes();
  restart();
  EXPECT_EQ(resample(*client(), ids[0], view_of(100)).bytes(), bytes);
  for (const std::string& name : folder_.names()) EXPECT_THAT(name, ::testing::Not(EndsWith("-tmp")));
}

TEST_F(ServerDisk, WhatIsNotSavedStaysInMemory) {
  max_sessions_ = 3;
  restart();
  const auto stub = client();
  const std::string mesh = upload(*stub, sphere_off(3));
  const std::string saved = create(*stub, mesh, 100).session.session_id();
  EXPECT_TRUE(eventually([&] { return is_cached(*stub, saved) && has_line(metrics(), "curvecast_unsaved_sessions 0"); }));
  const FullDisk full(5000);
  const std::string unsaved = create(*stub, mesh, 101).session.session_id();
  EXPECT_TRUE(resample(*stub, saved, view_of(50)).status.ok()) << "now the other one is the least recently used";
  for (const std::uint64_t points : {102, 103}) EXPECT_TRUE(create(*stub, mesh, points).status.ok());
  grpc::ClientContext context;
  v1::ListSessionsResponse list;
  ASSERT_TRUE(stub->ListSessions(&context, {}, &list).ok());
  ASSERT_EQ(list.sessions_size(), 3);
  for (const v1::Session& session : list.sessions()) EXPECT_NE(session.session_id(), saved);
  EXPECT_TRUE(resample(*stub, unsaved, view_of(50)).status.ok());
  EXPECT_TRUE(resample(*stub, saved, view_of(50)).status.ok()) << "loaded, for an unsaved one: there is no other way";
}

/// Reads and acknowledges frames of one view after the other, until the stream ends. Returns how.
grpc::Status look_around(Stub& stub, const std::string& id, const v1::SampleRequest& sample, const std::atomic<bool>& over,
                         std::atomic<int>& frames) {
  OpenedStream stream(stub, id);
  v1::SampleRequest view = sample;
  for (std::uint64_t sequence = 1; !over; ++sequence) {
    view.mutable_cameras(0)->mutable_eye()->set_x(0.01 * static_cast<double>(sequence % 100));
    if (!stream.ask(sequence, view)) break;
    v1::PointFrame frame = stream.read();
    while (frame.sequence() != 0 && frame.sequence() != sequence) frame = stream.read();
    if (frame.sequence() == 0) break;
    EXPECT_FALSE(frame.has_error()) << frame.error().message();
    if (!stream.acknowledge(sequence)) break;
    ++frames;
  }
  stream.stream->WritesDone();
  return stream.stream->Finish();
}

TEST_F(ServerDisk, AFileThatIsCutShortEndsItsSessionOnly) {
  for (const std::string ending : {".curve", ".surface"}) {
    for (const double part : {0.0, 0.6}) {
      const auto stub = client();
      const v1::Session made = make(*stub, 5, 20'000);
      const std::string id = made.session_id(), other = make(*stub, 4, 500).session_id();
      for (const std::string& each : {id, other}) EXPECT_TRUE(eventually([&] { return is_cached(*stub, each); }));
      restart();                                // so that the curve is mapped too
      v1::SampleRequest all = view_of(20'000);  // curve and surface
      all.add_attributes(v1::POINT_ATTRIBUTE_CURVATURES);
      all.add_attributes(v1::POINT_ATTRIBUTE_DIRECTIONS);
      std::atomic<bool> over = false;
      std::atomic<int> frames = 0, other_frames = 0;
      grpc::Status ended, other_ended;
      const auto here = client(), there = client(), third = client();
      std::thread looks([&] { ended = look_around(*here, id, all, over, frames); });
      std::thread looks_elsewhere([&] { other_ended = look_around(*there, other, view_of(300), over, other_frames); });
      EXPECT_TRUE(eventually([&] { return frames > 3 && other_frames > 3; }));
      const std::string path = path_of(id, ending);
      const auto size = static_cast<double>(std::filesystem::file_size(path));
      ASSERT_EQ(::truncate(path.c_str(), static_cast<off_t>(part * size)), 0);
      // Whoever uses what is gone hears of it, and the session is made anew.
      EXPECT_TRUE(eventually([&] {
        for (const auto sampler : {v1::SAMPLER_EQUALISED, v1::SAMPLER_PROGRESSIVE}) {
          v1::SampleRequest sample = all;
          sample.set_sampler(sampler);
          const grpc::Status status = resample(*third, id, sample).status;
          if (status.ok()) continue;
          EXPECT_TRUE(status.error_code() == grpc::DATA_LOSS || status.error_code() == grpc::NOT_FOUND)
              << status.error_code() << " " << status.error_message();
          return true;
        }
        return false;
      })) << ending
          << " " << part;
      const int before = other_frames;
      EXPECT_TRUE(eventually([&] { return other_frames > before + 3; })) << "others go on";
      EXPECT_FALSE(std::filesystem::exists(path));
      const Created again = create(*client(), made.mesh_id(), 20'000);
      over = true;
      looks.join();
      looks_elsewhere.join();
      EXPECT_TRUE(other_ended.ok()) << other_ended.error_message();
      EXPECT_TRUE(ended.ok() || ended.error_code() == grpc::DATA_LOSS) << ended.error_message();
      ASSERT_TRUE(again.status.ok()) << again.status.error_message();
      EXPECT_EQ(again.session.session_id(), id);
      EXPECT_EQ(resample(*client(), id, view_of(900)).points(), 900u);
    }
  }
}

}  // namespace
}  // namespace curvecast::server
