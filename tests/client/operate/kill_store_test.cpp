// Kills a real server before the store that it shares has its session.
#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "tests/client/process.h"
#include "tests/server/eventually.h"
#include "tests/server/server_fixture.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::server {
namespace {

namespace fs = std::filesystem;

class KillStoreTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1), 0);
    fs::create_directory(root_);
  }
  std::unique_ptr<cli::Process> serve() const {
    return std::make_unique<cli::Process>(std::vector<std::string>{"serve", "--listen", "127.0.0.1:0", "--http", "none",
                                                                   "--cache", folder_ / "cache", "--store", "file://" + root_});
  }
  static std::unique_ptr<Stub> connect(cli::Process& server) {
    return v1::CurvecastService::NewStub(
        grpc::CreateChannel(server.rest_of_line("listening on "), grpc::InsecureChannelCredentials()));
  }
  /// How many sessions a folder has.
  std::size_t count(const std::string& folder) const {
    std::size_t count = 0;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      count += it->path().extension() == ".curve";
    }
    return count;
  }

  const testing::TemporaryFolder folder_;
  const std::string root_ = folder_ / "store";
};

TEST_F(KillStoreTest, TheNextStartPutsWhatTheLastOneCouldNot) {
  {
    const auto server = serve();
    const auto stub = connect(*server);
    const std::string mesh = upload(*stub, sphere_off(3));
    fs::rename(root_, folder_ / "away");
    const Created created = create(*stub, mesh, 500);
    ASSERT_TRUE(created.status.ok()) << created.status.error_message();
    EXPECT_TRUE(eventually([&] { return count(folder_ / "cache") == 1; }));
    server->signal(SIGKILL);
    EXPECT_EQ(server->finish().status, 128 + SIGKILL);
  }
  fs::rename(folder_ / "away", root_);
  EXPECT_EQ(count(root_ + "/sessions"), 0u);
  const auto server = serve();
  EXPECT_TRUE(eventually([&] { return count(root_ + "/sessions") == 1; }));
  server->signal(SIGTERM);
  EXPECT_EQ(server->finish().status, 0);
}

}  // namespace
}  // namespace curvecast::server
