#include "proto/formats/npy.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <map>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

/// What stands before an array's numbers; the numbers follow.
struct Array {
  std::string header;
  std::string data;

  template <typename Number>
  Number at(std::size_t index) const {
    Number number{};
    EXPECT_LE((index + 1) * sizeof(Number), data.size());
    std::memcpy(&number, data.data() + index * sizeof(Number), sizeof(Number));
    return number;
  }
};

Array parse_npy(std::string_view bytes) {
  ByteReader reader(bytes);
  EXPECT_EQ(bytes.substr(0, 8), std::string_view("\x93NUMPY\x01\x00", 8));
  reader.skip(8);
  const auto length = reader.next<std::uint16_t>();
  EXPECT_EQ((10 + length) % 64, 0);
  Array array{std::string(bytes.substr(10, length)), std::string(bytes.substr(10 + length))};
  EXPECT_EQ(array.header.back(), '\n');
  return array;
}

/// The entries of an archive that are stored as they are, by its directory; their checksums have to be right.
std::map<std::string, std::string> parse_zip(std::string_view bytes) {
  std::map<std::string, std::string> entries;
  const std::size_t end = bytes.rfind("PK\x05\x06");
  EXPECT_NE(end, std::string_view::npos);
  ByteReader tail(bytes.substr(end + 10));
  const auto count = tail.next<std::uint16_t>();
  tail.skip(4);
  std::size_t at = tail.next<std::uint32_t>();
  for (int i = 0; i < count; ++i) {
    EXPECT_EQ(bytes.substr(at, 4), "PK\x01\x02");
    ByteReader entry(bytes.substr(at + 10));
    EXPECT_EQ(entry.next<std::uint16_t>(), 0) << "stored";
    EXPECT_EQ(entry.next<std::uint16_t>(), 0) << "midnight";
    EXPECT_EQ(entry.next<std::uint16_t>(), 0x21) << "of 1980-01-01";
    const auto checksum = entry.next<std::uint32_t>(), size = entry.next<std::uint32_t>(), plain = entry.next<std::uint32_t>();
    EXPECT_EQ(size, plain);
    const auto name = entry.next<std::uint16_t>(), extra = entry.next<std::uint16_t>(), comment = entry.next<std::uint16_t>();
    entry.skip(8);
    const std::size_t local = entry.next<std::uint32_t>();
    ByteReader lengths(bytes.substr(local + 26));
    const auto local_name = lengths.next<std::uint16_t>(), local_extra = lengths.next<std::uint16_t>();
    const std::string data(bytes.substr(local + 30 + local_name + local_extra, size));
    EXPECT_EQ(crc32(0, reinterpret_cast<const Bytef*>(data.data()), static_cast<uInt>(data.size())), checksum);
    entries[std::string(bytes.substr(at + 46, name))] = data;
    at += std::size_t{46} + name + extra + comment;
  }
  return entries;
}

TEST(Npy, HoldsPositionsInOrderOfRank) {
  const SpherePoints sphere(1000);
  const auto bytes = make_npy(sphere.columns());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Array array = parse_npy(*bytes);
  EXPECT_NE(array.header.find("'descr': '<f4', 'fortran_order': False, 'shape': (1000, 3)"), std::string::npos) << array.header;
  ASSERT_EQ(array.data.size(), 1000 * 3 * sizeof(float));
  for (std::size_t i = 0; i < 1000; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(array.at<float>(3 * i + axis), sphere.positions[sphere.with_rank(i)][axis]);
    }
  }
}

TEST(Npy, HoldsDoublesFarFromTheOrigin) {
  const SpherePoints sphere(100);
  PointColumns columns = sphere.columns();
  columns.origin = {4.5e6, -0.125, 1e9};
  const auto bytes = make_npy(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Array array = parse_npy(*bytes);
  EXPECT_NE(array.header.find("'<f8'"), std::string::npos);
  for (std::size_t i = 0; i < 100; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(array.at<double>(3 * i + axis), columns.origin[axis] + double{sphere.positions[sphere.with_rank(i)][axis]});
    }
  }
}

TEST(Npz, HoldsEveryColumnUnderItsName) {
  const SpherePoints sphere(500);
  const auto bytes = make_npz(sphere.columns());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const std::map<std::string, std::string> entries = parse_zip(*bytes);
  const std::map<std::string, std::string> wanted = {
      {"positions.npy", "'<f4', 'fortran_order': False, 'shape': (500, 3)"},
      {"normals.npy", "'<f4', 'fortran_order': False, 'shape': (500, 3)"},
      {"radii.npy", "'<f4', 'fortran_order': False, 'shape': (500,)"},
      {"colours.npy", "'|u1', 'fortran_order': False, 'shape': (500, 3)"},
      {"curvatures.npy", "'<f4', 'fortran_order': False, 'shape': (500, 2)"},
      {"ranks.npy", "'<u4', 'fortran_order': False, 'shape': (500,)"},
      {"faces.npy", "'<u4', 'fortran_order': False, 'shape': (500,)"},
      {"barycentric.npy", "'<f4', 'fortran_order': False, 'shape': (500, 2)"},
      {"directions.npy", "'<f4', 'fortran_order': False, 'shape': (500, 3)"},
      {"scalar height.npy", "'<f4', 'fortran_order': False, 'shape': (500,)"},
  };
  ASSERT_EQ(entries.size(), wanted.size());
  for (const auto& [name, header] : wanted) {
    ASSERT_TRUE(entries.contains(name)) << name;
    EXPECT_NE(parse_npy(entries.at(name)).header.find(header), std::string::npos) << name;
  }
  const Array ranks = parse_npy(entries.at("ranks.npy")), faces = parse_npy(entries.at("faces.npy")),
              colours = parse_npy(entries.at("colours.npy")), heights = parse_npy(entries.at("scalar height.npy")),
              places = parse_npy(entries.at("barycentric.npy"));
  for (std::size_t i = 0; i < 500; ++i) {
    const std::size_t point = sphere.with_rank(i);
    ASSERT_EQ(ranks.at<std::uint32_t>(i), i);
    ASSERT_EQ(faces.at<std::uint32_t>(i), sphere.faces[point]);
    ASSERT_EQ(colours.at<std::uint8_t>(3 * i + 1), sphere.colours[point][1]);
    ASSERT_EQ(places.at<float>(2 * i + 1), sphere.barycentric[point][1]);
    const float height = sphere.heights[point];
    ASSERT_TRUE(heights.at<float>(i) == height || (std::isnan(height) && std::isnan(heights.at<float>(i))));
  }
}

TEST(Npz, HoldsNoColumnThatIsNotThere) {
  const SpherePoints sphere(10);
  PointColumns columns;
  columns.positions = sphere.positions;
  const auto bytes = make_npz(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const std::map<std::string, std::string> entries = parse_zip(*bytes);
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(entries.begin()->first, "positions.npy");
}

TEST(Npz, MakesNamesOfScalarsHarmless) {
  const SpherePoints sphere(10);
  PointColumns columns;
  columns.positions = sphere.positions;
  columns.scalars = {{"../a b", sphere.heights}, {".._a\xC3", sphere.heights}, {".._a_b", sphere.heights}};
  const auto bytes = make_npz(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const std::map<std::string, std::string> entries = parse_zip(*bytes);
  EXPECT_EQ(entries.size(), 4U);
  for (const char* name : {"scalar .._a_b.npy", "scalar .._a_.npy", "scalar .._a_b_2.npy"})
    EXPECT_TRUE(entries.contains(name)) << name;
}

TEST(Npz, IsTheSameBytesAgain) {
  const SpherePoints sphere(300);
  EXPECT_EQ(*make_npz(sphere.columns()), *make_npz(sphere.columns()));
}

TEST(Npy, HoldsNoPointsToo) {
  const auto npy = make_npy({}), npz = make_npz({});
  ASSERT_TRUE(npy.ok() && npz.ok());
  EXPECT_NE(parse_npy(*npy).header.find("(0, 3)"), std::string::npos);
  EXPECT_EQ(parse_zip(*npz).size(), 1U);
}

TEST(Npy, RefusesBrokenColumns) {
  SpherePoints sphere(10);
  sphere.radii.pop_back();
  EXPECT_TRUE(absl::IsInvalidArgument(make_npy(sphere.columns()).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(make_npz(sphere.columns()).status()));
}

}  // namespace
}  // namespace curvecast::formats
