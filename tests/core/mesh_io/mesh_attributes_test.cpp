// Colours, normals, texture coordinates, materials and named values out of the files.
#include "core/mesh/mesh_attributes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "core/mesh_io/mesh_companions.h"
#include "core/mesh_io/mesh_io.h"
#include "tests/core/mesh_io/gltf_writer.h"
#include "tests/core/mesh_io/image_writers.h"
#include "tests/core/mesh_io/mesh_writers.h"
#include "tests/core/mesh_io/test_companions.h"
#include "tests/support/real_mesh.h"

namespace curvecast {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Property {
  std::string type, name;
  std::vector<double> values;  // of each vertex or face
};

/// The pyramid with more properties, a few of them behind its coordinates, some before.
std::string ply_with(const std::string& format, const std::vector<Property>& vertex, const std::vector<Property>& face,
                     bool texcoord = false, const std::string& comment = "") {
  const FileMesh mesh = pyramid();
  std::string header = "ply\nformat " + format + " 1.0\n" + comment, body;
  const auto put = [&](const std::string& type, double value) {
    if (format != "ascii") return append_as(body, type, value, format == "binary_big_endian");
    std::ostringstream number;
    number << value << ' ';
    body += number.str();
  };
  header += "element vertex 5\n";
  for (const Property& p : vertex) header += "property " + p.type + " " + p.name + "\n";
  header += "property double x\nproperty float y\nproperty float z\nelement face 5\n";
  for (const Property& p : face) header += "property " + p.type + " " + p.name + "\n";
  header += "property list uchar int vertex_indices\n";
  if (texcoord) header += "property list uchar float texcoord\n";
  for (std::size_t v = 0; v < 5; ++v) {
    for (const Property& p : vertex) put(p.type, p.values[v]);
    put("double", mesh.vertices[v][0]);
    put("float", mesh.vertices[v][1]);
    put("float", mesh.vertices[v][2]);
  }
  for (std::size_t f = 0; f < 5; ++f) {
    for (const Property& p : face) put(p.type, p.values[f]);
    put("uchar", static_cast<double>(mesh.faces[f].size()));
    for (const int index : mesh.faces[f]) put("int", index);
    if (!texcoord) continue;
    put("uchar", 2.0 * static_cast<double>(mesh.faces[f].size()));
    for (std::size_t i = 0; i < mesh.faces[f].size(); ++i) {
      put("float", static_cast<double>(f));
      put("float", 0.25 * static_cast<double>(i));
    }
  }
  return header + "end_header\n" + body;
}

constexpr const char* kPlyFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST(MeshAttributes, PlyVertices) {
  const std::vector<double> r = {0, 51, 102, 153, 255}, g = {1, 2, 3, 4, 5}, b = {9, 8, 7, 6, 5}, a = {255, 128, 0, 1, 2};
  for (const char* format : kPlyFormats) {
    for (const std::string prefix : {"", "diffuse_"}) {
      const PolygonSoup soup = soup_of(ply_with(format,
                                                {{"uchar", prefix + "red", r},
                                                 {"uchar", prefix + "green", g},
                                                 {"float", "quality", {0.5, 1, -2, 3, 4}},
                                                 {"uchar", prefix + "blue", b},
                                                 {"uchar", prefix + "alpha", a},
                                                 {"float", "nx", {1, 0, 0, 0, 0}},
                                                 {"double", "ny", {0, 1, 0, 0, 0}},
                                                 {"float", "nz", {0, 0, 1, 1, 1}},
                                                 {"short", "id", {-1, 2, 3, 4, 500}}},
                                                {}));
      const MeshAttributes& at = soup.attributes;
      ASSERT_EQ(at.colours.size(), 5u) << format;
      for (std::size_t v = 0; v < 5; ++v) {
        EXPECT_EQ(at.colours[v], (Rgba8{static_cast<std::uint8_t>(r[v]), static_cast<std::uint8_t>(g[v]),
                                        static_cast<std::uint8_t>(b[v]), static_cast<std::uint8_t>(a[v])}));
      }
      EXPECT_THAT(at.normals, ElementsAre(Vec3f(1, 0, 0), Vec3f(0, 1, 0), Vec3f(0, 0, 1), Vec3f(0, 0, 1), Vec3f(0, 0, 1)));
      ASSERT_EQ(at.scalars.size(), 2u);
      EXPECT_EQ(at.scalars[0].name, "quality");
      EXPECT_THAT(at.scalars[0].values, ElementsAre(0.5F, 1, -2, 3, 4));
      EXPECT_EQ(at.scalars[1].name, "id");
      EXPECT_THAT(at.scalars[1].values, ElementsAre(-1, 2, 3, 4, 500));
      EXPECT_EQ(soup.positions[4], Vec3d(0.75, 1, 3.5));
      EXPECT_THAT(soup.warnings, IsEmpty());
    }
  }
}

TEST(MeshAttributes, PlyColoursOfOtherTypes) {
  for (const char* format : kPlyFormats) {
    const PolygonSoup floats = soup_of(ply_with(
        format,
        {{"float", "red", {0, 0.2, 0.5, 1, 7}}, {"double", "green", {1, 1, 1, 1, -1}}, {"float", "blue", {0, 0, 0, 0, 0}}}, {}));
    EXPECT_THAT(floats.attributes.colours, ElementsAre(Rgba8{0, 255, 0, 255}, Rgba8{51, 255, 0, 255}, Rgba8{128, 255, 0, 255},
                                                       Rgba8{255, 255, 0, 255}, Rgba8{255, 0, 0, 255}));
    const PolygonSoup wide = soup_of(ply_with(
        format, {{"ushort", "r", {0, 65535, 257, 32768, 0}}, {"int", "g", {-5, 300, 7, 8, 9}}, {"uchar", "b", {1, 2, 3, 4, 5}}},
        {}));
    EXPECT_THAT(wide.attributes.colours, ElementsAre(Rgba8{0, 0, 1, 255}, Rgba8{255, 255, 2, 255}, Rgba8{1, 7, 3, 255},
                                                     Rgba8{128, 8, 4, 255}, Rgba8{0, 9, 5, 255}));
    EXPECT_THAT(wide.attributes.scalars, IsEmpty());
    // A colour that lacks a channel is three scalars less one.
    EXPECT_EQ(soup_of(ply_with(format, {{"uchar", "red", {1, 2, 3, 4, 5}}}, {})).attributes.scalars.size(), 1u);
  }
}

TEST(MeshAttributes, PlyFaces) {
  const Image wood = plain_image(2, 2, 1, 2, 3);
  const Companions companions = {{"wood 1.png", png_file(wood)}};
  const std::string comment = "comment TextureFile missing.png\ncomment TextureFile wood 1.png\n";
  for (const char* format : kPlyFormats) {
    const std::string file = ply_with(format, {{"float", "s", {0, 0, 0, 0, 0}}, {"float", "t", {0, 0, 0, 0, 0}}},
                                      {{"uchar", "red", {10, 20, 30, 40, 50}},
                                       {"uchar", "green", {1, 1, 1, 1, 1}},
                                       {"int", "texnumber", {1, 0, 1, -1, 7}},
                                       {"uchar", "blue", {2, 2, 2, 2, 2}}},
                                      true, comment);
    const PolygonSoup soup = soup_of(file, companions);
    const MeshAttributes& at = soup.attributes;
    EXPECT_THAT(at.face_colours, ElementsAre(Rgba8{10, 1, 2, 255}, Rgba8{20, 1, 2, 255}, Rgba8{30, 1, 2, 255},
                                             Rgba8{40, 1, 2, 255}, Rgba8{50, 1, 2, 255}));
    ASSERT_EQ(at.uv.size(), soup.indices.size());
    for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
      for (std::uint32_t i = soup.polygon_begin[p]; i < soup.polygon_begin[p + 1]; ++i) {
        EXPECT_EQ(at.uv[i], Vec2f(static_cast<float>(p), 0.25F * static_cast<float>(i - soup.polygon_begin[p]))) << format;
      }
    }
    ASSERT_EQ(at.materials.size(), 2u);
    EXPECT_EQ(at.materials[0].texture, nullptr);
    ASSERT_NE(at.materials[1].texture, nullptr);
    EXPECT_EQ(at.materials[1].texture->rgba, wood.rgba);
    EXPECT_THAT(at.material_of_face, ElementsAre(1, 0, 1, MeshAttributes::kNoMaterial, MeshAttributes::kNoMaterial));
    EXPECT_THAT(soup.warnings, ElementsAre("line 3: the texture 'missing.png' is not there, so it is left out."));
    EXPECT_THAT(*mesh_companions(mesh_file("a.ply", file, companions)), ElementsAre("missing.png"));
  }
}

TEST(MeshAttributes, PlyTextureCoordinatesOfVerticesGoToTheirCorners) {
  for (const auto& [u, v] : {std::pair{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}) {
    const PolygonSoup soup =
        soup_of(ply_with("binary_little_endian", {{"float", u, {0, 1, 2, 3, 4}}, {"float", v, {5, 6, 7, 8, 9}}}, {}));
    ASSERT_EQ(soup.attributes.uv.size(), soup.indices.size());
    for (std::size_t i = 0; i < soup.indices.size(); ++i) {
      EXPECT_EQ(soup.attributes.uv[i], Vec2f(static_cast<float>(soup.indices[i]), static_cast<float>(soup.indices[i] + 5)));
    }
  }
}

constexpr const char* kQuads =
    "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1 0.5\nv 0 0 1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

TEST(MeshAttributes, ObjColoursAndTextureCoordinates) {
  const PolygonSoup soup = soup_of(std::string(kQuads) + "f 1/1 2/2 3/3 4/4\nf 1 2 5\nf 2/-3/1 3/-2 5/-1\nf 1/1 2/9 5/1\n");
  EXPECT_THAT(soup.attributes.colours, ElementsAre(Rgba8{255, 0, 0, 255}, Rgba8{0, 255, 0, 255}, Rgba8{0, 0, 255, 255},
                                                   Rgba8{255, 255, 255, 128}, Rgba8{}));
  EXPECT_THAT(soup.attributes.uv,
              ElementsAre(Vec2f(0, 0), Vec2f(1, 0), Vec2f(1, 1), Vec2f(0, 1), Vec2f(0, 0), Vec2f(0, 0), Vec2f(0, 0), Vec2f(1, 0),
                          Vec2f(1, 1), Vec2f(0, 1), Vec2f(0, 0), Vec2f(0, 0), Vec2f(0, 0)));
  EXPECT_THAT(soup.warnings, ElementsAre(HasSubstr("1 corners have texture coordinates that are not in the file (it has 4)")));
  const PolygonSoup bytes = soup_of("v 0 0 0 255 0 51\nv 1 0 0 0 1 0\nv 0 1 0 0 0 0\nf 1 2 3\n");
  EXPECT_THAT(bytes.attributes.colours, ElementsAre(Rgba8{255, 0, 51, 255}, Rgba8{0, 1, 0, 255}, Rgba8{0, 0, 0, 255}));
  EXPECT_THAT(bytes.attributes.uv, IsEmpty());
}

TEST(MeshAttributes, ObjNormalsAndGroupsTellSharpEdges) {
  // Two squares that meet at 90 degrees, and a third at 30 to the second.
  const std::string folded =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\nv 1.5 0 1.866\nv 1.5 1 1.866\nvn 0 0 1\nvn -1 0 0\nvn -1 0 0.2\n";
  const auto meant = [&](const std::string& faces) { return soup_of(folded + faces).crease_degrees; };
  EXPECT_EQ(meant("f 1//1 2//1 3//1 4//1\nf 3//2 2//2 5//3 6//3\nf 6//3 5//3 7//3 8//3\n"), 40);
  EXPECT_EQ(meant("f 1//-3 2//-3 3//-3 4//-3\nf 3/7/-2 2//-2 5//-1 6//-1\nf 6//-1 5//-1 7//3 8//3\n"), 40);
  EXPECT_EQ(meant("f 1//2 2//2 3//2 4//2\nf 3//2 2//2 5//3 6//3\nf 6//3 5//3 7//3 8//3\n"), 180);
  EXPECT_EQ(meant("f 1//1 2//1 3//1 4//1\nf 3//2 2//2 5//2 6//2\nf 6//3 5//3 7//3 8//3\n"), 40)
      << "normals that differ by less than half of the 30 degrees are smooth";
  EXPECT_EQ(meant("s 1\nf 1 2 3 4\ns 2\nf 3 2 5 6\nf 6 5 7 8\n"), 40);
  EXPECT_EQ(meant("s 1\nf 1 2 3 4\nf 3 2 5 6\nf 6 5 7 8\n"), 180);
  EXPECT_EQ(meant("s off\nf 1 2 3 4\nf 3 2 5 6\nf 6 5 7 8\n"), 0);
  for (const char* silent : {"f 1 2 3 4\nf 3 2 5 6\nf 6 5 7 8\n", "f 1//9 2//9 3//9 4//9\nf 3//-9 2//0 5//-9 6//-9\n",
                             "f 1//99999999999999999999 2 3 4\nf 3// 2// 5// 6//\n"}) {
    EXPECT_EQ(meant(silent), std::nullopt) << silent;
  }
  EXPECT_EQ(soup_of("vn\nvn nan 0 1\nvn 1e300 1 0\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1//1 2//1 3//1\nf 2//2 1//2 4//3\n")
                .crease_degrees,
            std::nullopt);
}

// Spot's file has a normal for each of its 23,062 faces: it is not meant to be seen flat.
TEST(MeshAttributes, NormalsOfFacesOfAFineMeshTellNothing) {
  const testing::RealMesh spot = testing::real_mesh("spot.obj");
  const absl::StatusOr<PolygonSoup> soup = read_mesh({spot.name, spot.bytes});
  ASSERT_TRUE(soup.ok()) << soup.status();
  EXPECT_EQ(soup->crease_degrees, std::nullopt);
}

TEST(MeshAttributes, ObjMaterials) {
  const std::string file =
      "mtllib sub/a.mtl\n" + std::string(kQuads) +
      "f 1 2 5\nusemtl red\nf 1/1 2/2 3/3\nusemtl wood\nf 1/1 3/3 4/4\nf 1 2\nusemtl red\nf 3 4 5\nusemtl none\nf 2 3 5\n";
  const std::string library = "newmtl red\nKd 1 0 0\nnewmtl wood\nmap_Kd wood.jpg\nnewmtl unused\nmap_Kd other.png\n";
  Companions companions;
  const auto ask = [&] { return *mesh_companions(mesh_file("a.obj", file, companions)); };
  EXPECT_THAT(ask(), ElementsAre("sub/a.mtl"));
  PolygonSoup soup = soup_of(file, companions);
  EXPECT_THAT(soup.warnings, ElementsAre("line 1: the material library 'sub/a.mtl' is not there, so its materials are white."));
  ASSERT_EQ(soup.attributes.materials.size(), 3u);

  companions["sub/a.mtl"] = library;
  EXPECT_THAT(ask(), ElementsAre("sub/wood.jpg", "sub/other.png"));
  soup = soup_of(file, companions);
  EXPECT_THAT(soup.warnings, ElementsAre("line 4 of sub/a.mtl: the texture 'sub/wood.jpg' is not there, so it is left out.",
                                         HasSubstr("the material 'none' is in none of the material libraries")));
  companions["sub/wood.jpg"] = "not a picture";
  EXPECT_THAT(soup_of(file, companions).warnings[0], HasSubstr("the texture 'sub/wood.jpg' is neither PNG, JPEG nor WebP"));
  companions["sub/wood.jpg"] = jpeg_file(plain_image(8, 8, 200, 100, 50));
  companions["sub/other.png"] = "";
  EXPECT_THAT(ask(), IsEmpty());
  soup = soup_of(file, companions);
  const MeshAttributes& at = soup.attributes;
  constexpr std::uint32_t kNo = MeshAttributes::kNoMaterial;
  EXPECT_THAT(at.material_of_face, ElementsAre(kNo, 0, 1, 0, 2));
  EXPECT_EQ(at.materials[0].name, "red");
  EXPECT_EQ(at.materials[0].colour, (Rgba8{255, 0, 0, 255}));
  ASSERT_NE(at.materials[1].texture, nullptr);
  EXPECT_EQ(at.materials[1].texture->width, 8);
  EXPECT_EQ(at.materials[2].colour, Rgba8{});
}

TEST(MeshAttributes, OffOfAllKinds) {
  const std::string faces = "3 0 1 2 255 0 0\n3 0 2 1\n";
  const auto vertices = [](const std::string& behind) {
    return "3 2 0\n0 0 0 " + behind + "\n1 0 0 " + behind + "\n0 1 0 " + behind + "\n";
  };
  const Rgba8 orange = {255, 128, 0, 255};
  for (const char* colour : {"255 128 0", "255 128 0 255", "1 0.5 0", "1.0 0.5 0.0 1.0"}) {
    const MeshAttributes at = soup_of("COFF\n" + vertices(colour) + faces).attributes;
    EXPECT_THAT(at.colours, ElementsAre(orange, orange, orange)) << colour;
    EXPECT_THAT(at.face_colours, ElementsAre(Rgba8{255, 0, 0, 255}, Rgba8{}));
  }
  for (const char* keyword : {"STCNOFF", "STNCOFF"}) {
    const MeshAttributes all =
        soup_of(std::string(keyword) + "\n" + vertices("0 0 1 255 128 0 255 0.25 0.75") + faces).attributes;
    EXPECT_THAT(all.colours, ElementsAre(orange, orange, orange));
    EXPECT_THAT(all.normals, ElementsAre(Vec3f(0, 0, 1), Vec3f(0, 0, 1), Vec3f(0, 0, 1)));
    EXPECT_THAT(all.uv, ::testing::Each(Vec2f(0.25, 0.75)));
    EXPECT_EQ(all.uv.size(), 6u);
  }
  EXPECT_THAT(soup_of("OFF\n" + vertices("255 128 0") + faces).attributes.colours, IsEmpty());
  const PolygonSoup lacking = soup_of("NOFF\n" + vertices("") + faces);
  EXPECT_THAT(lacking.attributes.normals, IsEmpty());
  EXPECT_THAT(lacking.warnings, ElementsAre(HasSubstr("line 3: this vertex lacks some of the normal")));
}

TEST(MeshAttributes, CompanionsOfGltf) {
  GltfWriter writer = gltf_tetrahedron();
  writer.json["images"] = {
      {{"uri", "my%20tex.png"}}, {{"uri", "normals.png"}}, {{"uri", "data:image/png;base64,AAAA"}}, {{"uri", "../up.png"}}};
  writer.json["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 2}}, {{"source", 3}}};
  writer.json["materials"] = nlohmann::json::array();
  for (const int texture : {0, 2, 3, 0}) {
    writer.json["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}, {"normalTexture", {{"index", 1}}}});
  }
  const Companions none, some = {{"a.bin", writer.bytes}};
  const std::string file = writer.text("a.bin");
  EXPECT_THAT(*mesh_companions(mesh_file("a", file, none)), ElementsAre("a.bin", "my tex.png", "up.png"));
  EXPECT_THAT(*mesh_companions(mesh_file("a", file, some)), ElementsAre("my tex.png", "up.png"));
  EXPECT_THAT(*mesh_companions({"a.stl", std::span<const char>("solid", 5)}), IsEmpty());
  EXPECT_FALSE(mesh_companions({"a", std::span<const char>("?", 1)}).ok());
}

TEST(MeshAttributes, CompanionsAreLimited) {
  std::string file = "v 0 0 0\n";
  for (int i = 0; i < 2'000; ++i) file += "mtllib " + std::to_string(i) + ".mtl\n# mtllib no.mtl\nxmtllib no.mtl\n";
  const Companions none;
  EXPECT_EQ(mesh_companions(mesh_file("a.obj", file, none))->size(), kMaxCompanions);
}

}  // namespace
}  // namespace curvecast
