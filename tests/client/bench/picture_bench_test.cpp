// The benchmark of pictures, on a server in a process of its own.
#include "client/bench/picture_bench.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/shapes.h"
#include "tests/support/temporary_folder.h"

namespace curvecast::cli::bench {
namespace {

TEST(PictureBench, ComparesEachStop) {
  const std::string off = testing::to_off(testing::jittered(testing::icosphere(5), 0.01));
  const testing::TemporaryFolder folder;
  const PictureBenchOptions options{.points = {500, 6000},
                                    .distances = {1.25, 0.3},
                                    .steps = 2,
                                    .size = 96,
                                    .pictures = folder.path(),
                                    .command = CURVECAST_COMMAND};
  const absl::StatusOr<BenchReport> report = bench_picture({"ball.off", off}, options, {});
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_EQ(report->tables.size(), 2u);
  ASSERT_EQ(report->results.size(), 4u);
  const std::size_t kBytes = 3, kFlip = 4;
  for (const BenchTable& table : report->tables) {
    ASSERT_GE(table.rows.size(), 6u);
    for (std::size_t stop = 0; stop < 2; ++stop) {
      const double bytes = table.rows[3 * stop][kBytes].get<double>();
      EXPECT_GT(bytes, stop == 0 ? 0 : table.rows[0][kBytes].get<double>()) << "all bytes so far";
      EXPECT_LE(table.rows[3 * stop + 1][kBytes].get<double>(), bytes);
      EXPECT_NEAR(table.rows[3 * stop + 2][kBytes].get<double>(), bytes, 0.1 * bytes);
      for (std::size_t way = 0; way < 3; ++way) {
        EXPECT_GT(table.rows[3 * stop + way][kFlip].get<double>(), 0);
        EXPECT_LT(table.rows[3 * stop + way][kFlip].get<double>(), 0.5);
      }
    }
  }
  // 500 points always take fewer bytes than the mesh; at the second stop 6,000 and those of before take more.
  EXPECT_EQ(report->tables[0].rows.size(), 6u);
  ASSERT_EQ(report->tables[1].rows.size(), 7u);
  const auto& sent = report->tables[1].rows.back();
  EXPECT_EQ(sent[2].get<int>(), 20 * 1024) << "triangles";
  EXPECT_GT(sent[kBytes].get<double>(), report->tables[1].rows[0][kBytes].get<double>());
  EXPECT_LT(sent[kFlip].get<double>(), 0.4 * report->tables[1].rows[3][kFlip].get<double>())
      << "it is the mesh itself, but for rounding";
  // More points, a better picture.
  EXPECT_LT(report->tables[1].rows[0][kFlip].get<double>(), report->tables[0].rows[0][kFlip].get<double>());
  const std::vector<std::string> files = folder.names();
  EXPECT_EQ(files.size(), 4u + 2);
  EXPECT_TRUE(std::ranges::find(files, "chart_2.svg") != files.end());
}

TEST(PictureBench, RefusesWhatMakesNoSense) {
  const std::string off = testing::to_off(testing::tetrahedron());
  const auto code_of = [&](const PictureBenchOptions& options) {
    return bench_picture({"t.off", off}, options, {}).status().code();
  };
  EXPECT_EQ(code_of({.points = {}}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of({.distances = {}}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of({.distances = {0.1, 1}}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of({.steps = 0}), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(code_of({.density = {"sharpness"}, .command = CURVECAST_COMMAND}), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(bench_picture({"bad.off", {}}, {.command = CURVECAST_COMMAND}, {}).ok());
}

}  // namespace
}  // namespace curvecast::cli::bench
