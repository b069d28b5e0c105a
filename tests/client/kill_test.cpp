// Kills a real server at any moment and looks at what the next one makes of its cache.
// CURVECAST_KILL_ROUNDS in the environment tells how often; the moments follow from the round's number.
#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "core/storage/atomic_file.h"
#include "tests/client/process.h"
#include "tests/server/server_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kDefaultRounds = 12;
constexpr std::uint64_t kSamplePoints = 400;
constexpr std::chrono::milliseconds kUploadPause{20};  // so that others get to the disk

int rounds() {
  const char* const wanted = std::getenv("CURVECAST_KILL_ROUNDS");
  return wanted != nullptr ? std::atoi(wanted) : kDefaultRounds;
}

/// A mesh to be uploaded, small or larger: a different one for each number.
std::string mesh_file(std::uint64_t number) {
  static const std::string small = sphere_off(2), large = sphere_off(4);
  return absl::StrCat(number % 4 == 0 ? large : small, "# ", number, "\n");
}

/// A session that may be asked for, and what it must give.
struct Wanted {
  std::string off;
  std::uint64_t max_points;
  std::string id = {}, bytes = {};
};

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

v1::SampleRequest raw_view() {
  v1::SampleRequest sample = view_of(kSamplePoints);
  sample.mutable_encoding()->mutable_raw();
  return sample;
}

class KillTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1), 0);
    for (int levels = 2; levels <= 4; ++levels) {
      for (const std::uint64_t points : {500, 5000, 15000}) sessions_.push_back({sphere_off(levels), points});
    }
    // What an undisturbed server without a cache makes of them.
    const auto server = Server::start({.max_curve_vertices = 0, .log = false});
    ASSERT_TRUE(server.ok()) << server.status();
    const auto stub = v1::CurvecastService::NewStub((*server)->in_process_channel());
    const Clock::time_point start = Clock::now();
    for (Wanted& wanted : sessions_) {
      const Created created = create(*stub, upload(*stub, wanted.off), wanted.max_points);
      ASSERT_TRUE(created.status.ok()) << created.status.error_message();
      wanted.id = created.session.session_id();
      wanted.bytes = resample(*stub, wanted.id, raw_view()).bytes();
    }
    window_ = 1.5 * std::chrono::duration<double>(Clock::now() - start);  // in which all of them are made and written
  }

  std::unique_ptr<cli::Process> serve() const {
    return std::make_unique<cli::Process>(std::vector<std::string>{"serve", "--listen", "127.0.0.1:0", "--http", "none",
                                                                   "--max-curve-vertices", "0", "--crash-pause", "0", "--cache",
                                                                   cache_.path()});
  }
  std::unique_ptr<Stub> connect(cli::Process& server) const {
    const std::string address = server.rest_of_line("listening on ");
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    arguments.SetMaxReceiveMessageSize(-1);
    return v1::CurvecastService::NewStub(grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments));
  }
  static bool is_cached(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetSessionRequest request;
    request.set_session_id(id);
    v1::GetSessionResponse response;
    return stub.GetSession(&context, request, &response).ok() && response.session().cached();
  }
  std::size_t temporaries() const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(cache_.path())) {
      count += is_temporary(entry.path().filename().string());
    }
    return count;
  }
  static v1::GetMeshResponse get_mesh(Stub& stub, const std::string& id) {
    grpc::ClientContext context;
    set_patience(context);
    v1::GetMeshRequest request;
    request.set_mesh_id(id);
    v1::GetMeshResponse response;
    stub.GetMesh(&context, request, &response);
    return response;
  }

  /// Every upload from `first` on that a server acknowledged is there, with its name and bytes: a server says so only after it
  /// has hashed them.
  void expect_uploads_kept(Stub& stub, std::uint64_t first) {
    for (const auto& [number, id] : acknowledged_) {
      if (number < first) continue;
      const v1::GetMeshResponse mesh = get_mesh(stub, id);
      EXPECT_EQ(mesh.mesh_id(), id) << "upload " << number << " is lost";
      EXPECT_EQ(mesh.name(), absl::StrCat("mesh ", number));
      EXPECT_EQ(mesh.size(), mesh_file(number).size());
    }
  }
  /// Uploads one mesh after the other, until the server dies.
  void upload_meshes(Stub& stub) {
    first_upload_ = next_upload_;
    for (;; ++next_upload_) {
      std::this_thread::sleep_for(kUploadPause);
      const std::string bytes = mesh_file(next_upload_);
      v1::UploadHeader header;
      header.set_name(absl::StrCat("mesh ", next_upload_));
      header.set_size(bytes.size());
      const Uploaded uploaded = upload(stub, header, bytes);
      if (!uploaded.status.ok()) return;
      acknowledged_[next_upload_] = uploaded.response.mesh_id();
    }
  }

  /// All that was cached when a server before said so is served, with the right bytes.
  void expect_kept(Stub& stub) {
    for (const Wanted& wanted : sessions_) {
      if (!cached_.contains(wanted.id)) continue;
      EXPECT_TRUE(is_cached(stub, wanted.id)) << wanted.id << " is lost";
      const Resampled sample = resample(stub, wanted.id, raw_view());
      EXPECT_TRUE(sample.status.ok()) << sample.status.error_message();
      EXPECT_EQ(sample.bytes(), wanted.bytes);
    }
  }

  /// Closes some sessions, so that there is something to write, and makes all in some order, until the server dies.
  void work(Stub& stub, std::mt19937& random) {
    std::vector<const Wanted*> order;
    for (const Wanted& wanted : sessions_) order.push_back(&wanted);
    std::shuffle(order.begin(), order.end(), random);
    for (const Wanted* wanted : order) {
      if (random() % 3 != 0) continue;
      const std::lock_guard lock(mutex_);  // so that watch() notes nothing meanwhile
      cached_.erase(wanted->id);
      grpc::ClientContext context;
      set_patience(context);
      v1::CloseSessionRequest request;
      request.set_session_id(wanted->id);
      v1::CloseSessionResponse response;
      stub.CloseSession(&context, request, &response);
    }
    for (const Wanted* wanted : order) {
      v1::UploadHeader header;
      header.set_name("test.off");
      header.set_size(wanted->off.size());
      const Uploaded uploaded = upload(stub, header, wanted->off);
      if (!uploaded.status.ok()) return;
      const Created created = create(stub, uploaded.response.mesh_id(), wanted->max_points);
      if (!created.status.ok()) return;
      EXPECT_EQ(created.session.session_id(), wanted->id);
      const Resampled sample = resample(stub, wanted->id, raw_view());
      if (!sample.status.ok()) return;
      EXPECT_EQ(sample.bytes(), wanted->bytes);
    }
    for (const Wanted* wanted : order) {
      if (!is_cached(stub, wanted->id)) continue;
      const std::lock_guard lock(mutex_);
      cached_.insert(wanted->id);
    }
  }
  /// Asks all the time what is cached, until the server dies.
  void watch(Stub& stub, const std::atomic<bool>& over) {
    while (!over) {
      for (const Wanted& wanted : sessions_) {
        const std::lock_guard lock(mutex_);  // so that nothing is closed between question and note
        if (!cached_.contains(wanted.id) && is_cached(stub, wanted.id)) cached_.insert(wanted.id);
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }

  testing::TemporaryFolder folder_, cache_;
  std::vector<Wanted> sessions_;
  std::chrono::duration<double> window_{};
  std::mutex mutex_;
  std::set<std::string> cached_;                       // that a server has reported as such, and nobody has closed since
  std::uint64_t next_upload_ = 0, first_upload_ = 0;   // numbers; of the last round
  std::map<std::uint64_t, std::string> acknowledged_;  // uploads, with their ids
};

TEST_F(KillTest, NothingThatWasCachedOrUploadedIsLost) {
  std::map<std::string, int> phases;
  std::size_t kept = 0;
  for (int round = 0; round < rounds() && !HasFailure(); ++round) {
    std::mt19937 random(static_cast<unsigned>(round));
    const double moment = std::uniform_real_distribution<double>(0, 1)(random);
    auto server = serve();
    if (round % 10 == 9) {  // a server that has hardly begun
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(100 * moment));
      server->signal(SIGKILL);
      server->finish();
      ++phases[server->out().empty() ? "starting" : "idle"];
      continue;
    }
    const auto stub = connect(*server);
    EXPECT_EQ(temporaries(), 0u) << "in round " << round;
    kept += cached_.size();
    expect_kept(*stub);
    expect_uploads_kept(*stub, first_upload_);
    std::atomic<bool> over = false;
    std::thread worker([&] { work(*stub, random); });
    std::thread uploader([&] { upload_meshes(*stub); });
    std::thread watcher([&] { watch(*stub, over); });
    std::this_thread::sleep_for(moment * window_);
    server->signal(SIGKILL);
    server->finish();
    over = true;
    worker.join();
    uploader.join();
    watcher.join();
    const std::string log = server->err();
    EXPECT_EQ(count(log, "damaged") + count(log, "[error]") + count(log, "[warning]"), 0u) << log;
    const std::size_t made = count(log, " ready after "), written = count(log, " cached in ");
    const bool making = count(log, " created: ") > made + count(log, " loaded from the cache after ");
    std::string phase = making ? "preprocessing" : "";
    if (temporaries() > 0) {
      phase += phase.empty() ? "writing" : " and writing";
    } else if (made > written) {
      phase += phase.empty() ? "before or after writing" : ", before or after writing";
    }
    ++phases[phase.empty() ? "all done" : phase];
  }
  auto server = serve();
  const auto stub = connect(*server);
  EXPECT_EQ(temporaries(), 0u);
  expect_kept(*stub);
  expect_uploads_kept(*stub, 0);
  for (const Wanted& wanted : sessions_) {
    ASSERT_TRUE(create(*stub, upload(*stub, wanted.off), wanted.max_points).status.ok());
    EXPECT_EQ(resample(*stub, wanted.id, raw_view()).bytes(), wanted.bytes);
  }
  server->signal(SIGTERM);
  EXPECT_EQ(server->finish().status, 0);
  std::cout << rounds() << " kills, " << kept << " times a cached session was served after one, " << acknowledged_.size()
            << " uploads acknowledged\n";
  for (const auto& [phase, times] : phases) std::cout << "  " << times << " while " << phase << "\n";
}

}  // namespace
}  // namespace curvecast::server
