#include "core/mesh_io/mesh_io.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/support/real_mesh.h"

namespace curvecast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

absl::StatusOr<PolygonSoup> read(const std::string& name, const std::string& bytes) {
  return read_mesh({name, std::span<const char>(bytes.data(), bytes.size())});
}

std::string message_of(const absl::StatusOr<PolygonSoup>& soup) { return std::string(soup.status().message()); }

// What a mesh has to look like after reading.
void expect_same(const absl::StatusOr<PolygonSoup>& soup, const FileMesh& mesh, const std::string& what) {
  ASSERT_TRUE(soup.ok()) << what << ": " << soup.status();
  EXPECT_TRUE(soup->shares_vertices) << what;
  ASSERT_EQ(soup->positions.size(), mesh.vertices.size()) << what;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(soup->positions[i][axis], mesh.vertices[i][axis]) << what << ", vertex " << i;
  }
  ASSERT_EQ(soup->polygon_count(), mesh.faces.size()) << what;
  for (std::size_t p = 0; p < mesh.faces.size(); ++p) {
    const std::vector<int> corners(soup->indices.begin() + soup->polygon_begin[p],
                                   soup->indices.begin() + soup->polygon_begin[p + 1]);
    EXPECT_EQ(corners, mesh.faces[p]) << what << ", polygon " << p;
  }
}

// The corners of all polygons, in order: how formats that share no vertices are compared.
std::vector<std::array<double, 3>> corners_of(const PolygonSoup& soup) {
  std::vector<std::array<double, 3>> corners;
  for (std::uint32_t index : soup.indices) {
    const Vec3d& p = soup.positions[index];
    corners.push_back({p.x(), p.y(), p.z()});
  }
  return corners;
}

std::vector<std::array<double, 3>> corners_of(const FileMesh& mesh) {
  std::vector<std::array<double, 3>> corners;
  for (const auto& face : mesh.faces) {
    for (int index : face) corners.push_back(mesh.vertices[index]);
  }
  return corners;
}

std::string with_line_ends(std::string text, const std::string& line_end) {
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + line_end.size())) {
    text.replace(at, 1, line_end);
  }
  return text;
}

TEST(MeshIo, TheSameMeshInEveryFormatReadsToTheSameSoup) {
  const FileMesh mesh = pyramid();
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (bool extras : {false, true}) {
      expect_same(read("a.ply", ply_file(mesh, {.format = format, .extras = extras})), mesh, format);
    }
  }
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    expect_same(read("a.ply", with_line_ends(ply_file(mesh, {.format = "ascii"}), line_end)), mesh, "PLY line ends");
    expect_same(read("a.obj", with_line_ends(obj_file(mesh), line_end)), mesh, "OBJ line ends");
    expect_same(read("a.off", with_line_ends(off_file(mesh), line_end)), mesh, "OFF line ends");
  }
}

TEST(MeshIo, StlGivesEveryTriangleVerticesOfItsOwn) {
  const FileMesh mesh = tetrahedron();
  for (const std::string& file : {binary_stl_file(mesh), binary_stl_file(mesh, "solid but binary"), text_stl_file(mesh),
                                  text_stl_file(mesh) + text_stl_file({})}) {
    const absl::StatusOr<PolygonSoup> soup = read("a.stl", file);
    ASSERT_TRUE(soup.ok()) << soup.status();
    EXPECT_FALSE(soup->shares_vertices);
    EXPECT_EQ(soup->polygon_count(), 4U);
    EXPECT_EQ(soup->positions.size(), 12U);
    EXPECT_EQ(corners_of(*soup), corners_of(mesh));
  }
}

TEST(MeshIo, PlyTakesAnyScalarTypes) {
  FileMesh mesh = pyramid();
  for (auto& v : mesh.vertices) {
    for (double& coordinate : v) coordinate = std::abs(std::floor(coordinate));
  }
  const std::vector<std::string> integers = {"char", "uchar", "short", "ushort", "int", "uint"};
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    for (bool extras : {false, true}) {
      for (const char* coordinate : {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"}) {
        expect_same(read("a.ply", ply_file(mesh, {.format = format, .coordinate = coordinate, .extras = extras})), mesh,
                    coordinate);
      }
      for (const std::string& count : integers) {
        for (const std::string& index : integers) {
          const PlyStyle style{.format = format, .count = count, .index = index, .list = "vertex_index", .extras = extras};
          expect_same(read("a.ply", ply_file(mesh, style)), mesh, count + " " + index);
        }
      }
    }
  }
}

// The reader takes runs of triangles in one go: runs of every length, across the borders of its blocks, with polygons between.
TEST(MeshIo, PlyRunsOfTrianglesAreReadLikeSingleFaces) {
  FileMesh mesh = pyramid();
  mesh.faces.clear();
  for (int run = 0; run < 150; ++run) {
    for (int i = 0; i < run * 7 % 113; ++i) mesh.faces.push_back({i % 5, (i + run) % 5, (2 * i + 1) % 5});
    mesh.faces.push_back({0, 1, 2, 3, 4});
  }
  for (int i = 0; i < 140'000; ++i) mesh.faces.push_back({i % 5, (i / 5) % 5, (i / 25) % 5});
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    expect_same(read("a.ply", ply_file(mesh, {.format = format})), mesh, format);
    expect_same(read("a.ply", ply_file(mesh, {.format = format, .index = "uint"})), mesh, format);
  }
  mesh.faces[100'000][1] = 5;
  EXPECT_THAT(message_of(read("a.ply", ply_file(mesh))),
              HasSubstr("a.ply: face 100000: vertex index 5 is out of range (the file has 5 vertices)"));
  mesh.faces[100'000][1] = -2;
  EXPECT_THAT(message_of(read("a.ply", ply_file(mesh))), HasSubstr("face 100000: vertex index -2 is out of range"));
}

TEST(MeshIo, PlyTriangleStrips) {
  const std::string vertices = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string places = "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0\n";
  const auto file = [&](const std::string& type, const std::string& strip) {
    return "ply\nformat ascii 1.0\n" + vertices + "element tristrips 1\nproperty list int " + type +
           " vertex_indices\nend_header\n" + places + strip + "\n";
  };
  // The third and fourth entries repeat a corner: no triangle, yet they count for the orientation.
  for (const std::string& strip : {file("int", "12 0 1 2 3 -1 2 3 4 -1 0 1 1"), file("short", "12 0 1 2 3 -1 2 3 4 -1 0 1 1"),
                                   file("uint", "12 0 1 2 3 4294967295 2 3 4 4294967295 0 1 1")}) {
    const absl::StatusOr<PolygonSoup> soup = read("a.ply", strip);
    ASSERT_TRUE(soup.ok()) << soup.status();
    EXPECT_THAT(soup->indices, ElementsAre(0, 1, 2, 2, 1, 3, 2, 3, 4));
    EXPECT_THAT(soup->polygon_begin, ElementsAre(0, 3, 6, 9));
  }
  const absl::StatusOr<PolygonSoup> steered = read("a.ply", file("int", "6 0 1 2 2 3 4"));
  ASSERT_TRUE(steered.ok()) << steered.status();
  EXPECT_THAT(steered->indices, ElementsAre(0, 1, 2, 3, 2, 4));
  EXPECT_THAT(message_of(read("a.ply", file("int", "4 0 1 2 5"))), HasSubstr("line 11: vertex index 5 is out of range"));
  EXPECT_THAT(message_of(read("a.ply", file("int", "4 0 1 2 -2"))), HasSubstr("vertex index -2 is out of range"));
  EXPECT_FALSE(read("a.ply", file("int", "9 0 1 2 3")).ok());
  EXPECT_FALSE(read("a.ply", file("int", "-4 0 1 2 3")).ok());
}

TEST(MeshIo, ObjForms) {
  const std::string vertices = "v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\n  v +1 1e0 0 # a comment\nv 0 1. 0\n";
  for (const char* face :
       {"f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1//1 2//2 3//3 4//4", "f 1/1/1 2/2/1 3/3/1 4/4/1", "f -4 -3 -2 -1",
        "f -4/-1/-1 -3//-1 -2/7 -1", "f 1 2 \\\n 3 4", "f 1/1\\\n 2/2 3 \\\r\n4", "\tf\t1\t2 3  4  # comment",
        "f 1 2 3 4\nl 1 2\np 1\nvp 0 0\ncurv 0 1 1 2", "g a \\\nf 9 9 9\nf 1 2 3 4"}) {
    const absl::StatusOr<PolygonSoup> soup = read("a.obj", vertices + face);
    ASSERT_TRUE(soup.ok()) << face << ": " << soup.status();
    EXPECT_THAT(soup->indices, ElementsAre(0, 1, 2, 3)) << face;
    EXPECT_THAT(soup->polygon_begin, ElementsAre(0, 4)) << face;
    EXPECT_EQ(soup->positions[2], Vec3d(1, 1, 0)) << face;
  }
  const absl::StatusOr<PolygonSoup> forward = read("a.obj", "f 1 2 3\n" + vertices + "o other\nv 5 5 5\nf -1 1 2\n");
  ASSERT_TRUE(forward.ok()) << forward.status();
  EXPECT_THAT(forward->indices, ElementsAre(0, 1, 2, 4, 0, 1));
  for (const auto& [face, message] : std::vector<std::pair<std::string, std::string>>{
           {"f 1 2 5", "a.obj: line 5: vertex index 5 is out of range (the file has 4 vertices)"},
           {"f 1 2 3\nf 1 2 6\nf 1 2 7", "line 6: vertex index 6 is out of range"},
           {"f 1 2 -5", "line 5: vertex index -5 is out of range"},
           {"f 0 1 2", "line 5: vertex index 0 is out of range"},
           {"f 1 2 x", "line 5: expected a vertex index, found 'x'"},
           {"f 1 2 3.5", "line 5: expected a vertex index, found '3.5'"},
           {"f 1/a 2 3", "line 5: expected a vertex index such as"},
           {"f 1/1/1/1 2 3", "line 5: expected a vertex index such as"},
           {"f 1 2 99999999999999999999", "line 5: expected a vertex index"},
           {"v 1 2", "line 5: expected a coordinate of a vertex, but the file ends here"},
           {"v 1 2 \nf 1 2 3", "line 5: expected a coordinate of a vertex, but the line ends here"},
           {"v 1 nan 2", "line 5: a coordinate is not a finite number"},
           {"v 1 -inf 2", "line 5: a coordinate is not a finite number"},
           {"v 1 1e999 2", "line 5: a coordinate is not a finite number"},
           {"v 1 1.#INF 2", "line 5: expected a coordinate"}}) {
    EXPECT_THAT(message_of(read("a.obj", vertices + face)), HasSubstr(message)) << face;
  }
}

TEST(MeshIo, OffForms) {
  const auto faces = [](const std::string& behind) { return "3 0 1 2" + behind + "\n3 0 2 1" + behind + "\n"; };
  for (const std::string& file :
       {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n" + faces(""), "OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n" + faces(""),
        "OFF\n3 2\n0 0 0\n1 0 0\n0 1 0\n" + faces(""), "3 2 0\n0 0 0\n1 0 0\n0 1 0\n" + faces(""),
        "# a\n\nOFF # b\n# c\n\n3 2 0 # d\n\n0 0 0 # e\n# f\n1 0 0\n\n0 1 0\n# g\n" + faces(" # h"),
        "COFF\n3 2 0\n0 0 0 255 0 0 255\n1 0 0 1 1 1 1\n0 1 0 0 0 0 0\n" + faces(" 255 0 0"),
        "NOFF\n3 2 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n" + faces(" 0.5 0.5 0.5 1"),
        "STCNOFF\n3 2 0\n0 0 0 0 0 1 1 1 1 1 0.5 0.5\n1 0 0 0 0 1 1 1 1 1 0 0\n0 1 0 0 0 1 1 1 1 1 0 0\n" + faces(""),
        "4OFF\n3 2 0\n0 0 0 1\n2 0 0 2\n0 0.5 0 0.5\n" + faces("")}) {
    const absl::StatusOr<PolygonSoup> soup = read("a.off", file);
    ASSERT_TRUE(soup.ok()) << file << ": " << soup.status();
    EXPECT_EQ(soup->positions, (std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << file;
    EXPECT_THAT(soup->indices, ElementsAre(0, 1, 2, 0, 2, 1)) << file;
  }
}

TEST(MeshIo, PolygonsOfOneOrTwoCornersAreDropped) {
  FileMesh mesh = tetrahedron();
  mesh.faces = {{0}, {0, 1, 2}, {}, {1, 2}, {2, 1, 3}, {3, 3}};
  FileMesh kept = mesh;
  kept.faces = {{0, 1, 2}, {2, 1, 3}};
  for (const char* format : {"ascii", "binary_little_endian"})
    expect_same(read("a.ply", ply_file(mesh, {.format = format})), kept, format);
  expect_same(read("a.obj", obj_file(mesh)), kept, "OBJ");
  expect_same(read("a.off", off_file(mesh)), kept, "OFF");
  mesh.faces = {{0, 1}};
  for (const std::string& file : {ply_file(mesh), obj_file(mesh), off_file(mesh)}) {
    const absl::Status status = read("a", file).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("no faces"));
  }
}

TEST(MeshIo, FormatIsDetectedByContentThenByName) {
  const auto detect = [](const std::string& name, const std::string& bytes) {
    return detect_mesh_format(name, std::span<const char>(bytes.data(), bytes.size()));
  };
  const FileMesh mesh = tetrahedron();
  for (const char* name : {"", "upload", "mesh.ply", "mesh.OBJ", "mesh.off", "mesh.stl"}) {
    EXPECT_EQ(*detect(name, ply_file(mesh)), MeshFormat::kPly);
    EXPECT_EQ(*detect(name, obj_file(mesh)), MeshFormat::kObj);
    EXPECT_EQ(*detect(name, off_file(mesh)), MeshFormat::kOff);
    EXPECT_EQ(*detect(name, "# comment\nST" + off_file(mesh)), MeshFormat::kOff);
    EXPECT_EQ(*detect(name, text_stl_file(mesh)), MeshFormat::kStl);
    EXPECT_EQ(*detect(name, binary_stl_file(mesh)), MeshFormat::kStl);
  }
  EXPECT_EQ(*detect("dir.ply/a.OBJ", "?"), MeshFormat::kObj);
  EXPECT_EQ(*detect("a.Stl", "?"), MeshFormat::kStl);
  EXPECT_EQ(detect("a.txt", "?").status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(detect("a.txt", "?").status().message()), HasSubstr("a.txt: "));
  EXPECT_EQ(detect("", "").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(MeshIo, ReportsProgressAndStopsWhenCancelled) {
  FileMesh mesh = tetrahedron();
  mesh.vertices.resize(200'000, {1, 2, 3});
  for (int i = 0; i < 200'000; ++i) mesh.faces.push_back({0, 1, 2 + i % 3});
  for (const std::string& file : {ply_file(mesh), ply_file(mesh, {.format = "ascii"}), ply_file(mesh, {.extras = true}),
                                  obj_file(mesh), off_file(mesh), binary_stl_file(mesh), text_stl_file(mesh)}) {
    std::atomic<bool> cancel = false;
    std::vector<double> fractions;
    ExecutionContext context;
    context.cancel = &cancel;
    context.on_progress = [&](std::string_view stage, double fraction) {
      EXPECT_EQ(stage, "read");
      fractions.push_back(fraction);
    };
    const std::span<const char> bytes(file.data(), file.size());
    ASSERT_TRUE(read_mesh({"a", bytes}, context).ok());
    EXPECT_GE(fractions.size(), 4U);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    EXPECT_EQ(fractions.front(), 0);
    EXPECT_EQ(fractions.back(), 1);
    context.on_progress = [&](std::string_view, double fraction) { cancel = cancel || fraction > 0.3; };
    EXPECT_EQ(read_mesh({"a", bytes}, context).status().code(), absl::StatusCode::kCancelled);
    EXPECT_EQ(read_mesh({"a", bytes}, context).status().code(), absl::StatusCode::kCancelled);
  }
}

TEST(MeshIo, RealMeshes) {
  struct Expected {
    const char* name;
    std::size_t vertices;
    std::size_t polygons;
  };
  // One row holds for a mesh of the folder, the other for that which stands in for it.
  const std::vector<std::array<Expected, 2>> all = {
      {{{"igea.ply", 134'345, 268'686}, {"bunny00.off", 37'706, 75'408}}},
      {{{"squirrel.obj", 10'160, 20'336}, {"bear.off", 13'826, 27'648}}},
      {{{"stanford-bunny.obj", 35'947, 69'451}, {"elephant-with-holes.off", 2798, 4463}}},
      {{{"3holes.off", 3'596, 7'200}, {"double-torus-3-holes.off", 228, 201}}},
  };
  for (const std::array<Expected, 2>& either : all) {
    const testing::RealMesh file = testing::real_mesh(either[0].name);
    const Expected& expected = either[file.name == either[0].name ? 0 : 1];
    EXPECT_EQ(file.name, expected.name);
    const absl::StatusOr<PolygonSoup> soup = read(file.name.c_str(), file.bytes);
    ASSERT_TRUE(soup.ok()) << soup.status();
    EXPECT_EQ(soup->positions.size(), expected.vertices) << expected.name;
    EXPECT_EQ(soup->polygon_count(), expected.polygons) << expected.name;
  }
}

/// The triangles of a mesh as a PLY file in which each is a strip of its own.
std::string to_strips(const PolygonSoup& soup) {
  std::string ply = absl::StrCat("ply\nformat ascii 1.0\nelement vertex ", soup.positions.size(),
                                 "\nproperty double x\nproperty double y\nproperty double z\nelement tristrips 1\n"
                                 "property list int int vertex_indices\nend_header\n");
  for (const Vec3d& p : soup.positions) absl::StrAppendFormat(&ply, "%.17g %.17g %.17g\n", p.x(), p.y(), p.z());
  absl::StrAppend(&ply, soup.indices.size() / 3 * 4);
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) {
    absl::StrAppend(&ply, " ", soup.indices[i], " ", soup.indices[i + 1], " ", soup.indices[i + 2], " -1");
  }
  return ply + "\n";
}

// igea.ply was made from igea-tristrips.ply by another program.
TEST(MeshIo, RealTriangleStripsAreTheSameMesh) {
  const testing::RealMesh plain = testing::real_mesh("igea.ply"), strips = testing::real_mesh("igea-tristrips.ply");
  const absl::StatusOr<PolygonSoup> soup = read(plain.name.c_str(), plain.bytes);
  ASSERT_TRUE(soup.ok()) << soup.status();
  const bool are_a_pair = strips.name == "igea-tristrips.ply";
  const absl::StatusOr<PolygonSoup> same = read("strips.ply", are_a_pair ? strips.bytes : to_strips(*soup));
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_EQ(same->positions, soup->positions);
  EXPECT_EQ(same->indices, soup->indices);
}

}  // namespace
}  // namespace curvecast
