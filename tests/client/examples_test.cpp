// The examples as a newcomer runs them: against a server, from the command line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "client/lib/point_file.h"
#include "tests/client/process.h"
#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::client {
namespace {

using ::testing::HasSubstr;

class ExamplesTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(::setenv("XDG_CACHE_HOME", folder_.path().c_str(), 1), 0);
    testing::write_file(mesh_, testing::to_off(testing::icosphere(3)));
    server_ = std::make_unique<cli::Process>(std::vector<std::string>{"serve", "--listen", "127.0.0.1:0"});
    ASSERT_TRUE(server_->wait_for("listening on ")) << server_->err();
    const std::string out = server_->out();
    const std::size_t begin = out.find("127.0.0.1:");
    address_ = out.substr(begin, out.find('\n') - begin);
  }

  testing::TemporaryFolder folder_;
  const std::string mesh_ = folder_ / "ball.off";
  std::unique_ptr<cli::Process> server_;
  std::string address_;
};

TEST_F(ExamplesTest, ResampleWritesAPointFile) {
  const std::string path = folder_ / "points.ply";
  const cli::Finished finished = cli::run({address_, mesh_, "1000", path}, CURVECAST_EXAMPLE_RESAMPLE);
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("1000 points in "));
  const absl::StatusOr<Points> points = read_point_file(path);
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->size(), 1000u);
  EXPECT_EQ(points->normals.size(), 1000u);
}

TEST_F(ExamplesTest, OrbitGoesRound) {
  const cli::Finished finished = cli::run({address_, mesh_, "500", "20"}, CURVECAST_EXAMPLE_ORBIT);
  EXPECT_EQ(finished.status, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("view 1: 500 points, key of "));
  EXPECT_THAT(finished.out, HasSubstr("view 20: 500 points, "));
  EXPECT_THAT(finished.out, HasSubstr(", delta of "));
}

TEST_F(ExamplesTest, ErrorsAreShown) {
  for (const char* example : {CURVECAST_EXAMPLE_RESAMPLE, CURVECAST_EXAMPLE_ORBIT}) {
    EXPECT_EQ(cli::run({}, example).status, 2);
    const cli::Finished missing = cli::run({address_, "/nonexistent/mesh.off", "5", folder_ / "out.ply"}, example);
    EXPECT_EQ(missing.status, 1);
    EXPECT_THAT(missing.err, HasSubstr("/nonexistent/mesh.off"));
  }
  const cli::Finished none = cli::run({address_, mesh_, "0", "20"}, CURVECAST_EXAMPLE_ORBIT);
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.err, HasSubstr("points"));
}

}  // namespace
}  // namespace curvecast::client
