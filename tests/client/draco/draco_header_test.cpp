#include "client/lib/draco/draco_header.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "client/lib/drc_file.h"
#include "client/lib/protocol.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kCountOffset = 11;  // of the point count, in a Draco cloud without metadata

/// Draco data of `count` points without radii, and so without metadata.
std::string plain_draco(std::size_t count) {
  Points points = sphere_points(count);
  points.radii.clear();
  return *make_drc(points, {});
}

std::string with_count(std::string bytes, std::int32_t count) {
  std::memcpy(&bytes[kCountOffset], &count, sizeof count);
  return bytes;
}

/// A header and nothing else: `attributes` times `components` of `type`.
std::string bare_header(std::int32_t points, std::uint8_t attributes, std::uint8_t type, std::uint8_t components) {
  std::string bytes("DRACO\x02\x03\x00\x00\x00\x00", kCountOffset);
  bytes.append(reinterpret_cast<const char*>(&points), sizeof points);
  bytes += '\x01';
  bytes += static_cast<char>(attributes);
  for (int i = 0; i < attributes; ++i) {
    bytes += {'\x00', static_cast<char>(type), static_cast<char>(components), '\x00', static_cast<char>(i)};
  }
  return bytes;
}

TEST(CheckDracoHeader, ReadsTheCountOfARealCloud) {
  const auto header = check_draco_header(plain_draco(1234), kMaxPoints);
  ASSERT_TRUE(header.ok()) << header.status();
  EXPECT_EQ(header->points, 1234U);
  EXPECT_EQ(header->bytes_per_point, 24U);
  EXPECT_FALSE(header->radii.valid());
}

TEST(CheckDracoHeader, RefusesAbsurdCounts) {
  const std::string bytes = plain_draco(100);
  for (const std::int32_t count :
       {0, -1, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(), 2'000'000, 1'000'000'000}) {
    EXPECT_TRUE(absl::IsInvalidArgument(check_draco_header(with_count(bytes, count), kMaxPoints).status())) << count;
    EXPECT_TRUE(absl::IsInvalidArgument(parse_drc(with_count(bytes, count)).status())) << count;
  }
}

TEST(CheckDracoHeader, RefusesMorePointsThanAreWanted) {
  const std::string bytes = plain_draco(100);
  EXPECT_TRUE(check_draco_header(bytes, 100).ok());
  EXPECT_TRUE(absl::IsInvalidArgument(check_draco_header(bytes, 99).status()));
}

TEST(CheckDracoHeader, RefusesAttributesThatNeedTooMuchMemory) {
  constexpr std::uint8_t kFloat = 9, kDouble = 10;
  EXPECT_TRUE(check_draco_header(bare_header(100, 2, kFloat, 3), kMaxPoints).ok());
  EXPECT_FALSE(check_draco_header(bare_header(100, 1, kDouble, 255), kMaxPoints).ok());
  EXPECT_FALSE(check_draco_header(bare_header(100, 200, kFloat, 3), kMaxPoints).ok());
  EXPECT_FALSE(check_draco_header(bare_header(100, 1, 0, 3), kMaxPoints).ok());
  EXPECT_FALSE(check_draco_header(bare_header(100, 1, 99, 3), kMaxPoints).ok());
  EXPECT_FALSE(check_draco_header(bare_header(100, 1, kFloat, 0), kMaxPoints).ok());
}

TEST(CheckDracoHeader, RefusesOtherFormats) {
  const std::string bytes = plain_draco(100);
  const auto changed = [&](std::size_t offset, char value) {
    std::string other = bytes;
    other[offset] = value;
    return check_draco_header(other, kMaxPoints).status();
  };
  EXPECT_THAT(std::string(changed(0, 'd').message()), HasSubstr("DRACO"));
  EXPECT_THAT(std::string(changed(5, 1).message()), HasSubstr("version is 1.3"));
  EXPECT_THAT(std::string(changed(7, 1).message()), HasSubstr("no point cloud"));
  EXPECT_THAT(std::string(changed(8, 7).message()), HasSubstr("method"));
  EXPECT_FALSE(check_draco_header("", kMaxPoints).ok());
}

}  // namespace
}  // namespace curvecast::client
