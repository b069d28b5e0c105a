#include "client/bench/paper/log_plot.h"

#include <gmock/gmock.h>

namespace curvecast::cli::bench {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(LogPlot, PutsPowersOfTenAtEqualDistances) {
  const PlotLine line{"a line", {1, 10, 100}, {1, 0.1, 0.01}, "#123456"};
  const std::string svg = log_plot("title", "x", "y", {line});
  // From corner to corner, and its middle in the middle.
  EXPECT_THAT(svg, HasSubstr("d=\"M62.0 30.0L305.0 202.0L548.0 374.0\""));
  EXPECT_THAT(svg, HasSubstr("stroke=\"#123456\""));
  EXPECT_THAT(svg, HasSubstr(">a line</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("stroke-dasharray")));
}

TEST(LogPlot, DrawsDashedLinesWithoutDots) {
  const PlotLine line{"a line", {1, 100}, {1, 0.01}, "#000", true};
  const std::string svg = log_plot("title", "x", "y", {line});
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg, Not(HasSubstr("<circle")));
}

TEST(LogPlot, EscapesWhatAnyNameMayHold) {
  EXPECT_EQ(escaped("<a href=\"b\">&"), "&lt;a href=&quot;b&quot;&gt;&amp;");
  const std::string svg = log_plot("<b>", "x & y", "y", {{"<script>", {1, 2}, {1, 2}, "#000"}});
  EXPECT_THAT(svg, HasSubstr("&lt;script&gt;"));
  EXPECT_THAT(svg, HasSubstr("x &amp; y"));
  EXPECT_THAT(svg, Not(HasSubstr("<b>")));
}

}  // namespace
}  // namespace curvecast::cli::bench
