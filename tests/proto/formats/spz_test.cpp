#include "proto/formats/spz.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

std::string gunzip(const std::string& bytes) {
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, 16 + MAX_WBITS), Z_OK);
  std::string out(64 << 20, '\0'), in = bytes;
  stream.next_in = reinterpret_cast<Bytef*>(in.data());
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  inflateEnd(&stream);
  return out;
}

struct Spz {
  std::vector<std::array<double, 3>> positions, colours, scales;
  std::vector<std::array<double, 4>> rotations;
};

Spz parse_spz(const std::string& file) {
  const std::string bytes = gunzip(file);
  ByteReader reader(bytes);
  EXPECT_EQ(reader.text(4), "NGSP");
  EXPECT_EQ(reader.next<std::uint32_t>(), 3U);
  const auto count = reader.next<std::uint32_t>();
  EXPECT_EQ(reader.next<std::uint8_t>(), 0);
  const int bits = reader.next<std::uint8_t>();
  EXPECT_EQ(reader.next<std::uint16_t>(), 0);
  Spz spz;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<double, 3> position;
    for (double& coordinate : position) {
      const int low = reader.next<std::uint8_t>(), middle = reader.next<std::uint8_t>(), high = reader.next<std::int8_t>();
      coordinate = std::ldexp(low + 256 * middle + 65536 * high, -bits);
    }
    spz.positions.push_back(position);
  }
  for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(reader.next<std::uint8_t>(), 254);
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<double, 3> colour;
    for (double& channel : colour) channel = 0.5 + 0.28209479177387814 * (reader.next<std::uint8_t>() / 255.0 - 0.5) / 0.15;
    spz.colours.push_back(colour);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    std::array<double, 3> scale;
    for (double& axis : scale) axis = std::exp(reader.next<std::uint8_t>() / 16.0 - 10);
    spz.scales.push_back(scale);
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    auto packed = reader.next<std::uint32_t>();
    const std::uint32_t largest = packed >> 30;
    std::array<double, 4> rotation{};
    double rest = 1;
    for (std::uint32_t k = 4; k-- > 0;) {
      if (k == largest) continue;
      rotation[k] = (packed & 511) / 511.0 / std::sqrt(2.0) * ((packed & 512) != 0 ? -1 : 1);
      rest -= rotation[k] * rotation[k];
      packed >>= 10;
    }
    rotation[largest] = std::sqrt(std::max(rest, 0.0));
    spz.rotations.push_back(rotation);
  }
  EXPECT_TRUE(reader.at_end());
  return spz;
}

TEST(Spz, HoldsSplatsInOrderOfRank) {
  SpherePoints sphere(3000);
  sphere.normals[0] = {0, 0, -1};
  const auto bytes = make_spz(sphere.columns());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Spz spz = parse_spz(*bytes);
  ASSERT_EQ(spz.positions.size(), 3000U);
  const Splats splats = *make_splats(sphere.columns());
  for (std::size_t i = 0; i < 3000; ++i) {
    const std::size_t point = sphere.with_rank(i);
    double alike = 0;
    for (int k = 0; k < 4; ++k) alike += spz.rotations[i][k] * splats.rotations[i][k];
    EXPECT_GT(std::abs(alike), 1 - 1e-5);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(spz.positions[i][k], sphere.positions[point][k], 1e-7);
      EXPECT_NEAR(spz.colours[i][k], sphere.colours[point][k] / 255.0, 0.004);
      const double scale = splats.widths[i] * (k == 2 ? 0.02 : 1);
      EXPECT_NEAR(std::log(spz.scales[i][k]), std::log(scale), 1.01 / 32);
    }
  }
}

TEST(Spz, PositionsAreAsFineAs24BitsAllow) {
  for (const double size : {1e-3, 0.37, 1.0, 900.0, 8e6}) {
    SpherePoints sphere(200);
    for (std::array<float, 3>& position : sphere.positions) {
      for (float& coordinate : position) coordinate = static_cast<float>(coordinate * size);
    }
    const auto bytes = make_spz(sphere.columns());
    ASSERT_TRUE(bytes.ok()) << bytes.status();
    const Spz spz = parse_spz(*bytes);
    const double step = std::max(size * std::ldexp(1.0, -22), std::ldexp(1.0, -30));
    for (std::size_t i = 0; i < 200; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_NEAR(spz.positions[i][axis], sphere.positions[sphere.with_rank(i)][axis], 0.5 * step) << size;
      }
    }
  }
}

TEST(Spz, RefusesWhatItCannotSay) {
  for (const double size : {1e-4, 1e5}) {
    SpherePoints sphere(20);
    for (float& radius : sphere.radii) radius = static_cast<float>(radius * size);
    if (size < 1) {
      for (float& radius : sphere.radii) radius /= 100;
    }
    EXPECT_TRUE(absl::IsInvalidArgument(make_spz(sphere.columns()).status())) << size;
  }
  SpherePoints far(20);
  far.positions[3][1] = 9e6F;
  EXPECT_TRUE(absl::IsInvalidArgument(make_spz(far.columns()).status()));
  PointColumns columns = far.columns();
  columns.normals = {};
  EXPECT_TRUE(absl::IsInvalidArgument(make_spz(columns).status()));
}

TEST(Spz, IsTheSameBytesAgain) {
  const SpherePoints sphere(300);
  EXPECT_EQ(*make_spz(sphere.columns()), *make_spz(sphere.columns()));
}

TEST(Spz, HoldsNoPointsToo) {
  const auto bytes = make_spz({});
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_TRUE(parse_spz(*bytes).positions.empty());
}

}  // namespace
}  // namespace curvecast::formats
