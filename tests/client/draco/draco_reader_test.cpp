#include "client/lib/draco/draco_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "client/lib/draco/draco_library.h"
#include "client/lib/draco/draco_points.h"
#include "client/lib/protocol.h"
#include "tests/client/draco/draco_clouds.h"

namespace curvecast::client {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr RadiusRange kRadii{0.001F, 0.5F};

absl::StatusOr<DecodedPoints> decode(const std::string& bytes, RadiusRange radii) {
  const auto header = check_draco_header(bytes, kMaxPoints);
  return header.ok() ? decode_draco(bytes, *header, radii) : header.status();
}

/// Room for what a header announces.
DecodedPoints room_for(const DracoHeaderInfo& header) {
  DecodedPoints points;
  points.positions.resize(header.points);
  if (header.find(DracoKind::kNormal) != nullptr) points.normals.resize(header.points);
  if (header.find(DracoKind::kGeneric) != nullptr) points.radii.resize(header.points);
  if (header.has_colours()) points.colours.resize(header.points);
  return points;
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_bytes(const DecodedPoints& a, const DecodedPoints& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.normals, b.normals) && same_bytes(a.radii, b.radii) &&
         same_bytes(a.colours, b.colours);
}

enum class Outcome { kEqual, kRefused, kLeftToDraco };

/// Reads both ways, and checks that ours accepts nothing that Draco refuses, and gives the same points to the bit. What only ours
/// refuses must be something that no encoder writes.
Outcome read_both_ways(DracoReader& reader, const std::string& bytes) {
  const auto header = check_draco_header(bytes, kMaxPoints);
  if (!header.ok()) return Outcome::kRefused;
  DecodedPoints ours = room_for(*header), reference = ours;
  const auto was_read = reader.read(bytes, *header, kRadii, ours.columns());
  if (was_read.ok() && !*was_read) return Outcome::kLeftToDraco;
  const absl::Status expected = decode_with_draco(bytes, *header, kRadii, reference.columns());
  if (was_read.ok()) {
    EXPECT_TRUE(expected.ok()) << expected;
    EXPECT_TRUE(same_bytes(ours, reference));
    return Outcome::kEqual;
  }
  EXPECT_TRUE(absl::IsInvalidArgument(was_read.status())) << was_read.status();
  const std::string message(was_read.status().message());
  EXPECT_THAT(message, AnyOf(StartsWith("broken Draco data: "), HasSubstr("is not finite")));
  if (expected.ok()) {
    EXPECT_THAT(message, AnyOf(HasSubstr("end too early"), HasSubstr("ends within its symbols"), HasSubstr("leave the bounds"),
                               HasSubstr("two different numbers of bits"), HasSubstr("impossible bounds")));
  }
  return Outcome::kRefused;
}

// Not more bits than 20: to weigh its ways to code symbols, Draco's encoder takes memory for every symbol that could be.
TEST(DracoReader, AgreesWithDracoOnAnySmallCloud) {
  DracoReader reader;
  for (const std::size_t points : {1UL, 2UL, 3UL, 255UL, 256UL, 257UL, 700UL}) {
    for (const int position_bits : {1, 11, 16, 20}) {
      for (const int normal_bits : {2, 8, 10, 16}) {
        for (const int colours : {0, 3, 4}) {
          for (const int speed : {0, 5, 10}) {
            for (int kind = 0; kind < 3; ++kind) {
              const DracoCloudOptions options{.points = points,
                                              .position_bits = position_bits,
                                              .normal_bits = normal_bits,
                                              .colour_components = colours,
                                              .speed = speed,
                                              .all_equal = kind == 1,
                                              .scattered = kind == 2};
              ASSERT_EQ(read_both_ways(reader, draco_cloud(options)), Outcome::kEqual)
                  << points << " points, bits " << position_bits << ", " << normal_bits << ", " << colours << " colours, speed "
                  << speed << ", kind " << kind;
            }
          }
        }
      }
    }
  }
}

TEST(DracoReader, AgreesWithDracoOnLargeClouds) {
  DracoReader reader;
  for (const std::size_t points : {12'500UL, 50'000UL}) {
    int turn = 0;
    for (const int position_bits : {1, 11, 14, 16, 20}) {
      for (const int normal_bits : {2, 8, 10, 16}) {
        ++turn;
        const DracoCloudOptions options{.points = points,
                                        .position_bits = position_bits,
                                        .normal_bits = normal_bits,
                                        .colour_components = turn % 3 == 0 ? 3 : 0,
                                        .speed = turn % 3 * 5,
                                        .all_equal = turn % 8 == 7,
                                        .scattered = turn % 2 == 0};
        ASSERT_EQ(read_both_ways(reader, draco_cloud(options)), Outcome::kEqual)
            << points << " points, bits " << position_bits << ", " << normal_bits;
      }
    }
  }
}

TEST(DracoReader, ReadsValuesThatAreNotEntropyCoded) {
  DracoReader reader;
  for (const int bits : {2, 7, 11, 16, 24, 30}) {
    const DracoCloudOptions options{.position_bits = bits, .normal_bits = bits, .colour_components = 3, .entropy_coded = false};
    EXPECT_EQ(read_both_ways(reader, draco_cloud(options)), Outcome::kEqual) << bits;
  }
}

TEST(DracoReader, LeavesOtherCloudsToDraco) {
  DracoReader reader;
  for (const OtherCloud kind :
       {OtherCloud::kTree, OtherCloud::kFloats, OtherCloud::kTextured, OtherCloud::kTwoRadii, OtherCloud::kUnpredicted}) {
    const std::string bytes = other_draco_cloud(kind);
    EXPECT_EQ(read_both_ways(reader, bytes), Outcome::kLeftToDraco) << static_cast<int>(kind);
    const auto points = decode(bytes, kRadii);
    ASSERT_TRUE(points.ok()) << points.status();
    EXPECT_EQ(points->positions.size(), 500U);
    EXPECT_EQ(points->radii.size(), 500U);
  }
}

TEST(DracoReader, ReadsRadiiThatAreNotWanted) {
  const std::string bytes = draco_cloud({.points = 1000});
  const auto without = decode(bytes, {}), with = decode(bytes, kRadii);
  ASSERT_TRUE(without.ok() && with.ok());
  EXPECT_TRUE(without->radii.empty());
  EXPECT_EQ(without->positions, with->positions);
  EXPECT_EQ(with->radii.size(), 1000U);
}

TEST(DracoReader, RefusesPlacesThatAreNotFinite) {
  const std::string bytes = draco_cloud({.points = 10});
  constexpr std::size_t kNormalBits = 1, kPositionBits = 1;
  const std::size_t range = bytes.size() - kNormalBits - kPositionBits - sizeof(float);
  for (const float bad : {std::bit_cast<float>(0x7fc00000U), std::bit_cast<float>(0x7f800000U)}) {
    std::string changed = bytes;
    std::memcpy(&changed[range], &bad, sizeof bad);
    const absl::Status status = decode(changed, kRadii).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status));
    EXPECT_THAT(std::string(status.message()), HasSubstr("is not finite"));
  }
}

/// One cloud for every way to code symbols.
std::vector<std::string> small_clouds() {
  return {draco_cloud({.points = 60, .colour_components = 3}),
          draco_cloud({.points = 40, .position_bits = 20, .normal_bits = 14, .speed = 10, .scattered = true}),
          draco_cloud({.points = 30, .colour_components = 4, .entropy_coded = false}),
          draco_cloud({.points = 300, .position_bits = 9, .normal_bits = 6, .speed = 0})};
}

TEST(DracoReader, RefusesWhatIsCutShort) {
  DracoReader reader;
  for (const std::string& bytes : small_clouds()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_EQ(read_both_ways(reader, bytes.substr(0, size)), Outcome::kRefused) << size;
    }
  }
}

TEST(DracoReader, AgreesWithDracoOnEveryFlippedBit) {
  DracoReader reader;
  int equal = 0;
  for (const std::string& bytes : small_clouds()) {
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
      std::string flipped = bytes;
      flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
      equal += read_both_ways(reader, flipped) == Outcome::kEqual;
      ASSERT_FALSE(HasFailure()) << "bit " << bit << " of " << bytes.size() << " bytes";
    }
  }
  EXPECT_GT(equal, 1000);  // a flip in the symbols mostly gives other points
}

TEST(DracoReader, SurvivesRandomBytes) {
  DracoReader reader;
  std::mt19937 random(3);
  for (const std::string& bytes : small_clouds()) {
    const auto header = check_draco_header(bytes, kMaxPoints);
    ASSERT_TRUE(header.ok());
    for (int trial = 0; trial < 2000; ++trial) {
      std::string noise = bytes;
      // Mostly behind a few good bytes, so that something of it is understood.
      const std::size_t begin = header->size + random() % 64;
      for (std::size_t i = begin; i < noise.size(); ++i) noise[i] = static_cast<char>(random());
      read_both_ways(reader, noise);
      ASSERT_FALSE(HasFailure()) << trial;
    }
  }
}

}  // namespace
}  // namespace curvecast::client
