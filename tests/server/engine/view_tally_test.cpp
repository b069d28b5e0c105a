#include "server/engine/view_tally.h"

#include <gtest/gtest.h>

#include "tests/server/has_line.h"

namespace curvecast::server {
namespace {

TEST(ViewTally, EveryViewIsAnsweredOrOvertaken) {
  Metrics metrics;
  {
    ViewTally tally(metrics);
    EXPECT_TRUE(has_line(metrics.text({}), "curvecast_open_streams 1"));
    for (std::uint64_t sequence : {1, 2, 3, 7, 9}) tally.received(sequence);
    tally.received(8);  // not upwards: the stream refuses it
    tally.answered(1);
    tally.answered(7);
    tally.answered(7);  // better points for the same view
    const std::string text = metrics.text({});
    EXPECT_TRUE(has_line(text, "curvecast_views_received_total 5"));
    EXPECT_TRUE(has_line(text, "curvecast_views_answered_total 2"));
    EXPECT_TRUE(has_line(text, "curvecast_views_overtaken_total 2"));
  }
  const std::string text = metrics.text({});
  EXPECT_TRUE(has_line(text, "curvecast_open_streams 0"));
  EXPECT_TRUE(has_line(text, "curvecast_views_overtaken_total 3"));
}

TEST(ViewTally, TakesAnyNumberOfUnansweredViews) {
  Metrics metrics;
  ViewTally tally(metrics);
  for (std::uint64_t sequence = 1; sequence <= 100'000; ++sequence) tally.received(sequence);
  tally.answered(100'000);
  const std::string text = metrics.text({});
  EXPECT_TRUE(has_line(text, "curvecast_views_received_total 100000"));
  EXPECT_TRUE(has_line(text, "curvecast_views_answered_total 1"));
  EXPECT_TRUE(has_line(text, "curvecast_views_overtaken_total 99999"));
}

}  // namespace
}  // namespace curvecast::server
