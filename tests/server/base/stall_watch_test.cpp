#include "server/base/stall_watch.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

TEST(StallWatch, EndsWhatDoesNotGetOnOnce) {
  StallWatch watch(absl::ResourceExhaustedError("too slow"));
  int a = 0, b = 0;
  const auto note = [](int& ended) {
    return [&ended](const absl::Status& status) {
      EXPECT_EQ(status, absl::ResourceExhaustedError("too slow"));
      ++ended;
    };
  };
  const auto begin = StallWatch::Clock::now();
  watch.begin(&a, note(a));
  watch.begin(&b, note(b));
  EXPECT_EQ(watch.end_begun_before(begin), 0u);
  watch.done(&b);
  const auto later = StallWatch::Clock::now() + std::chrono::seconds(30);
  EXPECT_EQ(watch.end_begun_before(later), 1u);
  EXPECT_EQ(watch.end_begun_before(later), 0u) << "it has been told";
  watch.done(&a);
  watch.begin(&b, note(b));
  EXPECT_EQ(watch.end_begun_before(later), 1u);
  EXPECT_EQ(a, 1);
  EXPECT_EQ(b, 1);
}

}  // namespace
}  // namespace curvecast::server
