#include "client/cli/report.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace curvecast::cli {
namespace {

v1::FrameStatistics statistics_of(std::uint64_t wanted, v1::PointLimit limit) {
  v1::FrameStatistics statistics;
  statistics.set_wanted_points(wanted);
  statistics.set_limit(limit);
  return statistics;
}

TEST(PointLimitText, SaysNothingWhereThereAreAsManyAsWanted) {
  EXPECT_EQ(point_limit_text(50'000, statistics_of(50'000, v1::POINT_LIMIT_UNSPECIFIED)), "");
  EXPECT_EQ(point_limit_text(123, statistics_of(0, v1::POINT_LIMIT_BYTES)), "");
  EXPECT_EQ(point_limit_text(123, {}), "") << "of a server that says nothing";
}

TEST(PointLimitText, SaysOfHowManyAndWhy) {
  EXPECT_EQ(point_limit_text(4384, statistics_of(1'050'000, v1::POINT_LIMIT_DENSITY)),
            "4,384 of 1,050,000 points: the view has no more places for points");
  EXPECT_EQ(point_limit_text(0, statistics_of(100, v1::POINT_LIMIT_SERVER)).rfind("0 of 100 points: ", 0), 0u);
  std::set<std::string> texts, names;
  for (int limit = 0; limit < v1::PointLimit_ARRAYSIZE; ++limit) {
    texts.insert(point_limit_text(1, statistics_of(2, static_cast<v1::PointLimit>(limit))));
    names.insert(point_limit_name(static_cast<v1::PointLimit>(limit)));
  }
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(v1::PointLimit_ARRAYSIZE));
  EXPECT_EQ(names.size(), static_cast<std::size_t>(v1::PointLimit_ARRAYSIZE));
  EXPECT_NE(point_limit_text(1, statistics_of(2, static_cast<v1::PointLimit>(99))), "") << "of a newer server";
}

TEST(MeshText, SaysWhichEdgesTheFileMeansToBeSharp) {
  v1::MeshInfo mesh;
  EXPECT_EQ(mesh_text(mesh).find("creases"), std::string::npos);
  const auto of = [&](double degrees) {
    mesh.set_crease_degrees(degrees);
    return mesh_text(mesh);
  };
  EXPECT_NE(of(32.5).find("creases        edges of more than 32.5 degrees, as the file's"), std::string::npos) << of(32.5);
  EXPECT_NE(of(0).find("creases        every edge, as the file's"), std::string::npos) << of(0);
  EXPECT_NE(of(180).find("creases        no edge, as the file's"), std::string::npos) << of(180);
}

}  // namespace
}  // namespace curvecast::cli
