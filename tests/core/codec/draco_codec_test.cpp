#include "core/codec/draco_codec.h"

#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/radius_ladder.h"
#include "core/sample/resample.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;

const DracoOptions kUnitBall = {.box_min = Vec3d(-1, -1, -1), .box_size = 2};

/// Points all over the unit ball, in no order, with radii over three powers of ten.
PointSet random_points(std::size_t n, std::uint64_t seed = 1) {
  PointSet points;
  std::uint64_t counter = 0;
  const auto random = [&] { return static_cast<float>(2 * random_unit(seed, counter++) - 1); };
  while (points.positions.size() < n) {
    const Vec3f p(random(), random(), random());
    if (p.norm() > 1 || p.norm() < 0.01f) continue;
    points.positions.push_back(p);
    points.normals.push_back(p.normalized());
    points.radii.push_back(std::pow(10.0f, 1.5f * random()));
    points.vertices.push_back(static_cast<std::uint32_t>(points.positions.size()));
  }
  return points;
}

struct Decoded {
  std::vector<Vec3f> positions, normals;
  std::vector<int> codes;
  std::vector<Rgba8> colours;  // opaque
};

Decoded decoded(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  auto result = draco::Decoder().DecodePointCloudFromBuffer(&buffer);
  EXPECT_TRUE(result.ok()) << result.status().error_msg_string();
  if (!result.ok()) return {};
  const draco::PointCloud& cloud = *result.value();
  const draco::PointAttribute* colour = cloud.GetNamedAttribute(draco::GeometryAttribute::COLOR);
  EXPECT_EQ(cloud.num_attributes(), colour == nullptr ? 3 : 4);
  const draco::PointAttribute* position = cloud.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  const draco::PointAttribute* normal = cloud.GetNamedAttribute(draco::GeometryAttribute::NORMAL);
  const draco::PointAttribute* radius = cloud.GetNamedAttribute(draco::GeometryAttribute::GENERIC);
  if (position == nullptr || normal == nullptr || radius == nullptr) {
    ADD_FAILURE() << "an attribute is missing";
    return {};
  }
  EXPECT_EQ(radius->data_type(), draco::DT_UINT8);
  EXPECT_EQ(radius->num_components(), 1);
  Decoded all;
  for (draco::PointIndex i(0); i < cloud.num_points(); ++i) {
    Vec3f p, n;
    std::uint8_t code = 0;
    position->GetMappedValue(i, p.data());
    normal->GetMappedValue(i, n.data());
    radius->GetMappedValue(i, &code);
    all.positions.push_back(p);
    all.normals.push_back(n);
    all.codes.push_back(code);
    if (colour == nullptr) continue;
    EXPECT_EQ(colour->num_components(), 3);
    Rgba8 rgb;
    colour->GetMappedValue(i, &rgb);
    all.colours.push_back(rgb);
  }
  return all;
}

struct Encoded {
  std::string bytes;
  float radius_min = -1, radius_max = -1;
};

Encoded encoded(const PointSet& points, const DracoOptions& options) {
  Encoded result;
  absl::StatusOr<std::string> bytes = encode_draco(points, options, &result.radius_min, &result.radius_max);
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  if (bytes.ok()) result.bytes = *std::move(bytes);
  return result;
}

void expect_refused(const PointSet& points, const DracoOptions& options, const std::string& message) {
  float low = 0, high = 0;
  const absl::StatusOr<std::string> bytes = encode_draco(points, options, &low, &high);
  ASSERT_FALSE(bytes.ok()) << message;
  EXPECT_EQ(bytes.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(bytes.status().message()), HasSubstr(message));
}

TEST(DracoCodec, KeepsPositionsInOrderWithinHalfALatticeStep) {
  const PointSet points = random_points(3000);
  for (const int bits : {1, 4, 8, 11, 16, 20, 30}) {
    DracoOptions options = kUnitBall;
    options.position_bits = bits;
    const Decoded back = decoded(encoded(points, options).bytes);
    ASSERT_EQ(back.positions.size(), points.size()) << bits;
    const double step = 2 / (std::exp2(bits) - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      ASSERT_LE((back.positions[i] - points.positions[i]).cwiseAbs().maxCoeff(), 0.5 * step + 5e-7)
          << bits << " bits, point " << i;
    }
  }
}

// Draco's own decoder takes coordinates below 0, and gives what is near the centre as exactly as floats can.
TEST(DracoCodec, KeepsPositionsAboutACentreFarFinerThanFloatsOfTheBox) {
  for (const int bits : {11, 23, 29}) {
    const double step = 2e6 / (std::exp2(bits) - 1);
    for (const std::size_t n : {1u, 2u, 3000u}) {
      PointSet points = random_points(n);
      for (Vec3f& position : points.positions) position *= static_cast<float>(1000 * step);
      const Decoded back = decoded(
          encoded(points, {.position_bits = bits, .box_min = Vec3d(-1e6, -1e6, -1e6), .box_size = 2e6, .is_centred = true})
              .bytes);
      ASSERT_EQ(back.positions.size(), n);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_LE((back.positions[i] - points.positions[i]).cwiseAbs().maxCoeff(), 0.501 * step) << bits << ", point " << i;
      }
    }
  }
}

TEST(DracoCodec, KeepsNormalsWithinTheOctahedralStep) {
  const PointSet points = random_points(20'000);
  for (const int bits : {4, 6, 8, 10, 12, 16}) {
    DracoOptions options = kUnitBall;
    options.normal_bits = bits;
    const Decoded back = decoded(encoded(points, options).bytes);
    ASSERT_EQ(back.normals.size(), points.size());
    // Half a step h off in two of the three coordinates of |x| + |y| + |z| = 1 moves a point of the octahedron by up to
    // sqrt(6) h, and no point of it is nearer to the centre than 1 / sqrt(3).
    const double half_step = 0.5 / (std::exp2(bits - 1) - 1);
    const double bound = std::asin(std::sqrt(18.0) * half_step) + 1e-6;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d n = points.normals[i].cast<double>(), m = back.normals[i].cast<double>();
      ASSERT_NEAR(m.norm(), 1, 1e-5);
      ASSERT_GT(n.dot(m), 0);
      ASSERT_LE(n.cross(m).norm() / m.norm(), std::sin(bound)) << bits << " bits, point " << i;
    }
  }
}

TEST(DracoCodec, RoundsRadiiUpToTheLadder) {
  const PointSet points = random_points(5000);
  for (const double largest : {0.0, 40.0}) {
    DracoOptions options = kUnitBall;
    options.radius_max = largest;
    const Encoded message = encoded(points, options);
    EXPECT_EQ(message.radius_max, largest > 0 ? largest : *std::max_element(points.radii.begin(), points.radii.end()));
    const Decoded back = decoded(message.bytes);
    ASSERT_EQ(back.codes.size(), points.size());
    const double range = std::log(static_cast<double>(message.radius_max) / message.radius_min);
    const RadiusLadder ladder(message.radius_max);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double radius = message.radius_min * std::exp(range * back.codes[i] / 255);
      ASSERT_GE(radius, (1 - 2e-5) * points.radii[i]) << "point " << i;
      ASSERT_LT(radius, std::exp2(0.5) * points.radii[i]) << "point " << i;
      ASSERT_NEAR(radius, ladder.radius(ladder.rung(points.radii[i])), 1e-5 * radius) << "point " << i;
    }
  }
}

TEST(DracoCodec, KeepsColoursButNotAlpha) {
  PointSet points = random_points(3000);
  EXPECT_TRUE(decoded(encoded(points, kUnitBall).bytes).colours.empty());
  std::vector<Rgba8> opaque;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto channel = [&](std::uint64_t n) { return static_cast<std::uint8_t>(256 * random_unit(9, 4 * i + n)); };
    points.colours.push_back({channel(0), channel(1), channel(2), channel(3)});
    opaque.push_back({channel(0), channel(1), channel(2), 255});
  }
  EXPECT_EQ(decoded(encoded(points, kUnitBall).bytes).colours, opaque);
}

TEST(DracoCodec, EncodesOnePointAndEqualRadii) {
  for (const std::size_t n : {1u, 2u, 50u}) {
    PointSet points = random_points(n);
    std::fill(points.radii.begin(), points.radii.end(), 0.25f);
    const Encoded message = encoded(points, kUnitBall);
    EXPECT_EQ(message.radius_max, 0.25f);
    const Decoded back = decoded(message.bytes);
    EXPECT_EQ(back.positions.size(), n);
    EXPECT_EQ(std::count(back.codes.begin(), back.codes.end(), 255), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(DracoCodec, KeepsPointsAtTheSamePlaceApart) {
  PointSet points = random_points(1);
  for (int i = 0; i < 5; ++i) {
    points.positions.push_back(points.positions[0]);
    points.normals.push_back(points.normals[0]);
    points.radii.push_back(points.radii[0]);
  }
  EXPECT_EQ(decoded(encoded(points, kUnitBall).bytes).positions.size(), 6u);
}

TEST(DracoCodec, PutsAllFramesOnOneLattice) {
  // The same points among others, in other places of another message.
  const PointSet first = random_points(500, 1);
  PointSet second = random_points(300, 2);
  for (Vec3f& p : second.positions) p *= 0.2f;  // a box of its own
  for (std::size_t i = 0; i < first.size(); i += 5) {
    second.positions.push_back(first.positions[i]);
    second.normals.push_back(first.normals[i]);
    second.radii.push_back(first.radii[i]);
  }
  const Decoded a = decoded(encoded(first, kUnitBall).bytes), b = decoded(encoded(second, kUnitBall).bytes);
  ASSERT_EQ(a.positions.size(), first.size());
  ASSERT_EQ(b.positions.size(), second.size());
  for (std::size_t i = 0; i < first.size(); i += 5) {
    EXPECT_EQ(a.positions[i], b.positions[300 + i / 5]) << "point " << i;
    EXPECT_EQ(a.normals[i], b.normals[300 + i / 5]) << "point " << i;
  }
}

TEST(DracoCodec, ReachesAllSidesOfTheBox) {
  PointSet points = random_points(8);
  for (int i = 0; i < 8; ++i) points.positions[i] = Vec3f(i & 1 ? 5 : -3, i & 2 ? 5 : -3, i & 4 ? 5 : -3);
  // Just outside, as rounding has it.
  points.positions[0] *= 1 + 1e-7f;
  points.positions[7] *= 1 + 1e-7f;
  const Decoded back = decoded(encoded(points, {.position_bits = 12, .box_min = Vec3d(-3, -3, -3), .box_size = 8}).bytes);
  ASSERT_EQ(back.positions.size(), 8u);
  for (int i = 0; i < 8; ++i) EXPECT_LT((back.positions[i] - points.positions[i]).norm(), 1e-5f) << i;
}

TEST(DracoCodec, SurvivesPointsOutsideTheBox) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const float far : {3.0f, -1e3f, 1e20f, -1e38f, std::numeric_limits<float>::infinity(), kNaN}) {
    for (const int bits : {11, 30}) {
      PointSet points = random_points(200);
      for (std::size_t i = 0; i < points.size(); i += 2) points.positions[i].x() = far;
      DracoOptions options = kUnitBall;
      options.position_bits = bits;
      Encoded message;
      const absl::StatusOr<std::string> bytes = encode_draco(points, options, &message.radius_min, &message.radius_max);
      if (bytes.ok()) {
        EXPECT_EQ(decoded(*bytes).positions.size(), points.size()) << far;
      } else {
        EXPECT_EQ(bytes.status().code(), absl::StatusCode::kInvalidArgument) << far;
      }
    }
  }
}

TEST(DracoCodec, IsMuchSmallerThanRawInCurveOrder) {
  const std::string off = curvecast::testing::to_off(curvecast::testing::icosphere(4));
  const absl::StatusOr<Preprocessed> done = preprocess({"ball.off", off}, {.points = 10'000});
  ASSERT_TRUE(done.ok()) << done.status();
  const absl::StatusOr<PointSet> points = resample(*done->curve, {.points = 10'000});
  ASSERT_TRUE(points.ok()) << points.status();
  const double in_order = static_cast<double>(encoded(*points, kUnitBall).bytes.size()) / 10'000;
  constexpr double kRaw = 7 * sizeof(float);
  EXPECT_LT(in_order, kRaw / 5);
  EXPECT_LT(encoded(random_points(10'000), kUnitBall).bytes.size() / 10'000.0, kRaw / 2);
}

TEST(DracoCodec, IsDeterministic) {
  const PointSet points = random_points(1000);
  EXPECT_EQ(encoded(points, kUnitBall).bytes, encoded(points, kUnitBall).bytes);
}

TEST(DracoCodec, RefusesBadOptions) {
  const PointSet points = random_points(10);
  const auto with = [](auto change) {
    DracoOptions options = kUnitBall;
    change(options);
    return options;
  };
  expect_refused({}, kUnitBall, "no points");
  for (const int bits : {0, -1, 31, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    expect_refused(points, with([&](DracoOptions& o) { o.position_bits = bits; }), "position_bits");
  }
  for (const int bits : {1, 0, -5, 31}) {
    expect_refused(points, with([&](DracoOptions& o) { o.normal_bits = bits; }), "normal_bits");
  }
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double size : {0.0, -1.0, kNaN, kInfinity, 1e300, 1e-300}) {  // the last two are none as floats
    expect_refused(points, with([&](DracoOptions& o) { o.box_size = size; }), "box");
  }
  for (const double corner : {kNaN, kInfinity, 1e300}) {
    expect_refused(points, with([&](DracoOptions& o) { o.box_min.y() = corner; }), "box");
  }
}

}  // namespace
}  // namespace curvecast
