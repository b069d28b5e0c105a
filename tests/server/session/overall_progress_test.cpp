#include "server/session/overall_progress.h"

#include <gtest/gtest.h>

#include <cmath>

namespace curvecast::server {
namespace {

TEST(OverallProgress, GrowsFromStageToStageUpToOne) {
  double last = 0;
  for (const char* stage : {"read", "repair", "cut", "parameterise", "curve", "map", "area", "ranks"}) {
    EXPECT_DOUBLE_EQ(overall_progress(stage, 0), last) << stage;
    EXPECT_GT(overall_progress(stage, 0.5), last) << stage;
    EXPECT_GT(overall_progress(stage, 1), overall_progress(stage, 0.5)) << stage;
    last = overall_progress(stage, 1);
  }
  EXPECT_NEAR(last, 1, 1e-12);
}

TEST(OverallProgress, IsNothingForWhatIsNoStage) {
  EXPECT_EQ(overall_progress("queued", 1), 0);
  EXPECT_EQ(overall_progress("load", 0.5), 0);
  EXPECT_EQ(overall_progress("", 1), 0);
  EXPECT_EQ(overall_progress("read", std::nan("")), 0);
}

}  // namespace
}  // namespace curvecast::server
