#include "client/lib/draco/draco_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "client/lib/drc_file.h"
#include "client/lib/point_blocks.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

TEST(DecodeDraco, RefusesEveryTruncation) {
  const v1::PointBlock block = draco_block(sphere_points(60));
  for (std::size_t size = 0; size < block.draco().data().size(); ++size) {
    v1::PointBlock cut = block;
    cut.mutable_draco()->mutable_data()->resize(size);
    ASSERT_FALSE(decode_block(cut).ok()) << size;
  }
}

TEST(DecodeDraco, SurvivesDamage) {
  Points whole = sphere_points(300);
  add_colours(&whole);
  const v1::PointBlock block = draco_block(whole);
  std::mt19937 random(1);
  for (int trial = 0; trial < 3000; ++trial) {
    v1::PointBlock damaged = block;
    std::string& bytes = *damaged.mutable_draco()->mutable_data();
    for (int i = 0; i < 1 + trial % 4; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto points = decode_block(damaged);
    if (!points.ok()) continue;
    ASSERT_EQ(points->size(), 300U);
    ASSERT_TRUE(points->colours.empty() || points->colours.size() == 300U);
    for (const auto& p : points->positions) ASSERT_TRUE(std::isfinite(p[0] + p[1] + p[2]));
  }
}

// Few bits make points that hardly differ and next to no bytes; the bound must let them pass.
TEST(DecodeDraco, AcceptsTheSmallestEncodings) {
  for (const std::size_t count : {1UL, 2UL, 100'000UL, 1'000'000UL}) {
    Points points = sphere_points(count);
    std::sort(points.positions.begin(), points.positions.end());
    std::sort(points.normals.begin(), points.normals.end());
    std::fill(points.radii.begin(), points.radii.end(), 0.5F);
    const auto bytes = make_drc(points, {.position_bits = 1, .normal_bits = 2});
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const auto decoded = parse_drc(*bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.status() << " in " << bytes->size() << " bytes";
    EXPECT_EQ(decoded->size(), count);
  }
}

}  // namespace
}  // namespace curvecast::client
