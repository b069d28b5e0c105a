// Broken, truncated and hostile files: always an error that says where, never a crash, never memory by claimed counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/mesh_io.h"
#include "tests/core/mesh/gltf_writer.h"
#include "tests/core/mesh/mesh_writers.h"

namespace curvecast {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

absl::StatusOr<PolygonSoup> read(const std::string& name, const std::string& bytes) {
  const std::vector<char> exact(bytes.begin(), bytes.end());  // no terminator behind: reading past the end is found out
  return read_mesh({name, exact});
}

std::string message_of(const absl::StatusOr<PolygonSoup>& soup) { return std::string(soup.status().message()); }

// What read_mesh promises, for any bytes at all.
void expect_promise(const std::string& name, const std::string& bytes) {
  const absl::StatusOr<PolygonSoup> soup = read(name, bytes);
  if (!soup.ok()) {
    EXPECT_EQ(soup.status().code(), absl::StatusCode::kInvalidArgument) << soup.status();
    EXPECT_THAT(message_of(soup), StartsWith(name + ": "));
    return;
  }
  ASSERT_GE(soup->polygon_count(), 1U);
  ASSERT_EQ(soup->polygon_begin.front(), 0U);
  ASSERT_EQ(soup->polygon_begin.back(), soup->indices.size());
  for (std::size_t p = 0; p < soup->polygon_count(); ++p) ASSERT_GE(soup->polygon_begin[p + 1], soup->polygon_begin[p] + 3);
  for (std::uint32_t index : soup->indices) ASSERT_LT(index, soup->positions.size());
  for (const Vec3d& p : soup->positions) ASSERT_TRUE(p.allFinite());
  const MeshAttributes& attributes = soup->attributes;
  const auto fits = [](const auto& values, std::size_t count) { return values.empty() || values.size() == count; };
  EXPECT_TRUE(fits(attributes.colours, soup->positions.size()));
  EXPECT_TRUE(fits(attributes.normals, soup->positions.size()));
  EXPECT_TRUE(fits(attributes.uv, soup->indices.size()));
  EXPECT_TRUE(fits(attributes.face_colours, soup->polygon_count()));
  EXPECT_TRUE(fits(attributes.material_of_face, soup->polygon_count()));
  for (const ScalarAttribute& scalar : attributes.scalars) EXPECT_EQ(scalar.values.size(), soup->positions.size());
  for (const std::uint32_t material : attributes.material_of_face) {
    EXPECT_TRUE(material == MeshAttributes::kNoMaterial || material < attributes.materials.size());
  }
  const std::size_t memory = soup->positions.capacity() * sizeof(Vec3d) +
                             (soup->indices.capacity() + soup->polygon_begin.capacity()) * sizeof(std::uint32_t);
  EXPECT_LE(memory, 20 * bytes.size() + 1'000);
}

struct Sample {
  std::string name;
  std::string bytes;
};

std::string everything_ply() {
  std::string file = "ply\nformat binary_little_endian 1.0\ncomment TextureFile a.png\nelement vertex 3\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "s", "t", "quality"})
    file += std::string("property float ") + name + "\n";
  for (const char* name : {"red", "green", "blue"}) file += std::string("property uchar ") + name + "\n";
  file +=
      "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
  for (int v = 0; v < 3; ++v) {
    for (int i = 0; i < 9; ++i) append(file, static_cast<float>(v == i));
    file += "\x10\x20\x30";
  }
  for (int f = 0; f < 2; ++f) {
    file += '\3';
    for (int i = 0; i < 3; ++i) append(file, i);
    file += '\6';
    for (int i = 0; i < 6; ++i) append(file, 0.5F);
    append(file, f);
    file += "abc";
  }
  return file;
}

std::vector<Sample> samples() {
  const FileMesh mesh = pyramid();
  const FileMesh triangles = tetrahedron();
  return {{"ascii.ply", ply_file(mesh, {.format = "ascii"})},
          {"ascii-extras.ply", ply_file(mesh, {.format = "ascii", .extras = true})},
          {"little.ply", ply_file(mesh)},
          {"little-extras.ply", ply_file(mesh, {.count = "int", .index = "ushort", .extras = true})},
          {"big.ply", ply_file(mesh, {.format = "binary_big_endian", .coordinate = "double"})},
          {"strips.ply",
           "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
           "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n8 0 1 2 3 -1 0 1 2\n"},
          {"mesh.obj", obj_file(mesh) + "f 1/1/1 2//2 \\\n 3/3 -1\n"},
          {"mesh.off", off_file(mesh)},
          {"everything.obj",
           "mtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 9 9 9 9\nvt 0 0\nvt 1 1\nusemtl a\nf 1/1 2/2 3/-1\n"
           "usemtl b\nf 1/1 2/5 3\n"},
          {"everything.off",
           "STCNOFF\n3 2 0\n0 0 0 0 0 1 255 0 0 1 0 0\n1 0 0 0 0 1 1 1 1 0.5 0.5\n0 1 0 0 0 1 1 1 1 1 0 0\n"
           "3 0 1 2 255 0 0\n3 0 2 1 0.5 1 1 1\n"},
          {"everything.ply", everything_ply()},
          {"mesh.gltf", gltf_tetrahedron().embedded()},
          {"mesh.glb", gltf_tetrahedron().glb()},
          {"binary.stl", binary_stl_file(triangles)},
          {"solid.stl", binary_stl_file(triangles, "solid")},
          {"text.stl", text_stl_file(triangles)}};
}

TEST(MeshIoHostile, EveryPrefixIsAnErrorOrAValidSoup) {
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(read(sample.name, sample.bytes).ok()) << read(sample.name, sample.bytes).status();
    for (std::size_t length = 0; length < sample.bytes.size(); ++length) {
      SCOPED_TRACE(sample.name + " cut to " + std::to_string(length));
      expect_promise(sample.name, sample.bytes.substr(0, length));
    }
  }
}

TEST(MeshIoHostile, TruncatedFilesAreRefused) {
  const FileMesh triangles = tetrahedron();
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    const std::string file = ply_file(triangles, {.format = format});
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(read("a.ply", file.substr(0, length)).ok()) << length;
  }
  for (const std::string& file : {binary_stl_file(triangles), binary_stl_file(triangles, "solid")}) {
    for (std::size_t length = 0; length < file.size(); ++length)
      EXPECT_FALSE(read("a.stl", file.substr(0, length)).ok()) << length;
  }
  // Of a text, the last number may lose digits unseen; whole lines may not.
  for (const Sample& sample : {Sample{"a.ply", ply_file(triangles, {.format = "ascii"})}, Sample{"a.off", off_file(triangles)},
                               Sample{"a.stl", text_stl_file(triangles)}}) {
    for (std::size_t at = sample.bytes.find('\n'); at + 1 < sample.bytes.size(); at = sample.bytes.find('\n', at + 1)) {
      EXPECT_FALSE(read(sample.name, sample.bytes.substr(0, at + 1)).ok()) << sample.name << " cut to " << at + 1;
    }
  }
}

TEST(MeshIoHostile, DamagedBytesAreAnErrorOrAValidSoup) {
  std::mt19937 random(7);
  const std::string likely = std::string("\0\xff\x7f\x80 \n\r-+.0919eE/\\#nan", 22);
  for (const Sample& sample : samples()) {
    for (int round = 0; round < 4'000; ++round) {
      std::string bytes = sample.bytes;
      for (std::uint32_t damages = 1 + random() % 3; damages > 0; --damages) {
        const std::size_t at = random() % bytes.size();
        const char byte = random() % 2 != 0 ? likely[random() % likely.size()] : static_cast<char>(random() % 256);
        const std::uint32_t kind = random() % 4;
        if (kind == 0) bytes.erase(at, 1 + random() % 4);
        if (kind == 1) bytes.insert(at, 1, byte);
        if (kind >= 2) bytes[at] = byte;
        if (bytes.empty()) bytes.assign(1, 'x');
      }
      SCOPED_TRACE(sample.name + " round " + std::to_string(round));
      expect_promise(sample.name, bytes);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(MeshIoHostile, CoordinatesThatAreNotFiniteAreRefused) {
  FileMesh mesh = tetrahedron();
  for (double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    mesh.vertices[2][1] = bad;
    for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
      for (const char* type : {"float", "double"}) {
        for (bool extras : {false, true}) {
          EXPECT_THAT(message_of(read("a.ply", ply_file(mesh, {.format = format, .coordinate = type, .extras = extras}))),
                      HasSubstr("a.ply: vertex 2: a coordinate is not a finite number"));
        }
      }
    }
    EXPECT_THAT(message_of(read("a.ply", ply_file(mesh, {.format = "ascii"}))),
                HasSubstr("a.ply: line 14: a coordinate is not a finite number"));
    EXPECT_THAT(message_of(read("a.obj", obj_file(mesh))), HasSubstr("a.obj: line 6: a coordinate is not a finite"));
    EXPECT_THAT(message_of(read("a.off", off_file(mesh))), HasSubstr("a.off: line 5: a coordinate is not a finite"));
    EXPECT_THAT(message_of(read("a.stl", binary_stl_file(mesh))), HasSubstr("a.stl: triangle 0: a coordinate is not"));
    EXPECT_THAT(message_of(read("a.stl", text_stl_file(mesh))), HasSubstr("a.stl: line 5: a coordinate is not a finite"));
  }
}

TEST(MeshIoHostile, IndicesOutOfRangeAreRefused) {
  FileMesh mesh = pyramid();
  mesh.faces[3][1] = 99;
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    for (bool extras : {false, true}) {
      EXPECT_THAT(message_of(read("bunny.ply", ply_file(mesh, {.format = format, .extras = extras}))),
                  HasSubstr("bunny.ply: face 3: vertex index 99 is out of range (the file has 5 vertices)"));
    }
  }
  EXPECT_THAT(message_of(read("a.ply", ply_file(mesh, {.format = "ascii"}))),
              HasSubstr("a.ply: line 20: vertex index 99 is out of range (the file has 5 vertices)"));
  EXPECT_THAT(message_of(read("a.off", off_file(mesh))),
              HasSubstr("a.off: line 11: vertex index 99 is out of range (the file has 5 vertices)"));
}

TEST(MeshIoHostile, HeadersThatClaimOrSayNonsense) {
  const std::string ply = "ply\nformat binary_little_endian 1.0\n";
  const std::string text_ply = "ply\nformat ascii 1.0\n";
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  std::string stl(84, '\0');
  for (int i = 80; i < 84; ++i) stl[i] = '\x7f';
  const std::vector<std::array<std::string, 3>> cases = {
      {"a.ply", "", "the file is empty"},
      {"a.ply", "ply", "'end_header' is missing"},
      {"a.ply", "plywood\n", "line 1: a PLY file begins with a line 'ply'"},
      {"a.ply", ply, "'end_header' is missing"},
      {"a.ply", "ply\nend_header\n", "no line 'format'"},
      {"a.ply", "ply\nformat text 1.0\nend_header\n", "line 2: expected ascii, binary_little_endian or binary_big_endian"},
      {"a.ply", ply + "end_header\n", "no element 'vertex'"},
      {"a.ply", ply + "property float x\nend_header\n", "line 3: a property stands before the first element"},
      {"a.ply", ply + "element vertex\nend_header\n", "line 3: expected the number of elements"},
      {"a.ply", ply + "element vertex -1\nend_header\n", "line 3: the number of elements is negative"},
      {"a.ply", ply + "element vertex 99999999999999999999\nend_header\n", "line 3: expected the number of elements"},
      {"a.ply", ply + "element vertex 1\nproperty half x\nend_header\n", "line 4: expected a type"},
      {"a.ply", ply + "element vertex 1\nproperty list float int x\nend_header\n", "line 4: the length of a list"},
      {"a.ply", ply + "element vertex 1\nsurprise\x01\nend_header\n", "line 4: unknown keyword in the header: 'surprise\\x01'"},
      {"a.ply", ply + "element vertex 1\nproperty float x\nproperty float y\nend_header\n0123456789ab", "has no property 'z'"},
      {"a.ply", ply + "element vertex 5\nend_header\n", "no properties x, y and z"},
      {"a.ply", ply + "element vertex 0\n" + xyz + "element vertex 0\n" + xyz + "end_header\n", "more than one element 'vertex'"},
      {"a.ply", ply + "element vertex 0\n" + xyz + "element face 0\n" + list + "end_header\n", "no faces"},
      {"a.ply", ply + "element vertex 0\n" + xyz + "end_header\n", "no faces"},
      {"a.ply", ply + "element vertex 1000000000\n" + xyz + "end_header\n0123456789ab",
       "vertex 1: the file ends here at the latest"},
      {"a.ply", ply + "element vertex 9223372036854775807\n" + xyz + "end_header\n", "more than 4294967295 vertices"},
      {"a.ply", ply + "element face 1000000000\n" + list + "element vertex 0\n" + xyz + "end_header\n\x03",
       "face 1: the file ends"},
      {"a.ply", ply + "element face 1\n" + list + "element vertex 9\n" + xyz + "end_header\n\xff", "face 0: the file ends here"},
      {"a.ply", ply + "element a 9223372036854775807\nproperty double b\nelement vertex 1\n" + xyz + "end_header\n",
       "a 0: the file"},
      {"a.ply", ply + "element a 1\nproperty list uint double b\nelement vertex 1\n" + xyz + "end_header\n\xff\xff\xff\xff",
       "a 0: "},
      {"a.ply", ply + "element a 1\nproperty list char uchar b\nelement vertex 1\n" + xyz + "end_header\n\xff",
       "negative length -1"},
      {"a.ply", text_ply + "element vertex 1000000000\n" + xyz + "end_header\n" + three, "the file ends here at the latest"},
      {"a.ply", text_ply + "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n" + three + "1000000000 0 1 2\n",
       "expected a number of face 0 of 1, but the file ends here"},
      {"a.ply", text_ply + "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n" + three + "-3 0 1 2\n",
       "line 13: a list has the negative length -3"},
      {"a.ply",
       text_ply + "element vertex 3\n" + xyz + "element face 1\nproperty list uchar float vertex_indices\nend_header\n" + three,
       "has no list 'vertex_indices'"},
      {"a.ply", text_ply + "element vertex 3\n" + xyz + "element face 1\n" + list + "end_header\n0 0 0\n1 0 zero\n0 1 0\n",
       "line 11: expected a number of vertex 1 of 3, found 'zero'"},
      {"a.obj", "hello\n", "no faces"},
      {"a.obj", "v 0 0 0\n", "no faces"},
      {"a.obj", std::string(1000, '\0'), "no faces"},
      {"a.off", "OFF BINARY\n", "line 1: binary OFF is not supported"},
      {"a.off", "nOFF\n3\n3 1 0\n", "OFF in n dimensions is not supported"},
      {"a.off", "OFF\n", "expected the number of vertices, but the file ends here"},
      {"a.off", "OFF\n-3 1 0\n", "line 2: the number of vertices is negative"},
      {"a.off", "OFF\n1000000000 1000000000 0\n" + three,
       "line 2: the number of vertices is 1000000000, but the file is too short"},
      {"a.off", "OFF\n3 1000000000 0\n" + three, "line 2: the number of faces is 1000000000, but the file is too short"},
      {"a.off", "OFF\n3 1 0\n" + three + "1000000000 0 1 2\n", "expected a vertex index of face 0 of 1, but the file ends here"},
      {"a.off", "OFF\n3 1 0\n" + three + "-3 0 1 2\n", "line 6: face 0 has a negative number of corners"},
      {"a.off", "OFF\n3 0 0\n" + three, "no faces"},
      {"a.off", "4OFF\n3 1 0\n0 0 0 1\n1 0 0 0\n0 1 0 1\n3 0 1 2\n", "line 4: a coordinate is not a finite number"},
      {"a.stl", stl, "triangle 0: the file ends here, but its header claims 2139062143 triangles"},
      {"a.stl", std::string(84, '\0'), "no faces"},
      {"a.stl", "short", "within the header of a binary STL"},
      {"a.stl", "solid a\nfacet normal 0 0 1\nouter ring\n", "line 3: expected loop, found 'ring'"},
      {"a.stl", "solid a\nendsolid\n", "no faces"},
      {"a.stl", "solid a\nfacets\n", "line 2: expected facet or endsolid, found 'facets'"},
      {"a.txt", "hello", "give a PLY, OBJ, OFF, STL, glTF or GLB file"}};
  for (const auto& [name, bytes, message] : cases) {
    SCOPED_TRACE(bytes.substr(0, 200));
    const absl::StatusOr<PolygonSoup> soup = read(name, bytes);
    EXPECT_EQ(soup.status().code(), absl::StatusCode::kInvalidArgument) << soup.status();
    EXPECT_THAT(message_of(soup), StartsWith(name + ": "));
    EXPECT_THAT(message_of(soup), HasSubstr(message));
  }
}

// Sizes of the order of the square of the file must not come from long words, lines or lists.
TEST(MeshIoHostile, LongWordsAndLinesTakeLinearTime) {
  const std::string digits(2'000'000, '9');
  const std::string word(2'000'000, 'x');
  for (const std::string& line : {digits, word, "f " + digits, "v " + digits + " 0 0", "v 0.0" + digits + " 0 0", "f 1/" + digits,
                                  "# " + word, "usemtl " + word, std::string(2'000'000, '\\'), std::string(2'000'000, ' ')}) {
    for (const char* name : {"a.obj", "a.off", "a.stl", "a.ply"}) expect_promise(name, line + "\n");
  }
}

}  // namespace
}  // namespace curvecast
